//! How long to wait for an ack or an answer: the estimator of RFC 6298, in milliseconds.

use zerocopy::FromBytes;

/// Smoothed round-trip time, its variation, and the backoff.
#[derive(Clone, Debug, Default, FromBytes)]
pub(super) struct Estimator {
    /// 8 times the smoothed time; 0 when none was measured.
    smoothed: u32,
    /// 4 times the smoothed deviation.
    deviation: u32,
    /// How often the timeout was doubled since a time was measured.
    backoff: u8,
}

/// A round trip that counts for no more: an hour.
const LONGEST: u32 = 3_600_000;
/// Doublings that a timeout of 1 ms needs to become an hour.
const BACKOFF_MAX: u8 = 22;

impl Estimator {
    /// A round trip was measured, by a command that was sent once: of others it is not known which line was answered.
    pub(super) fn add(&mut self, time: u32) {
        // 0 stands for no measurement.
        let time = time.clamp(1, LONGEST);
        if self.smoothed == 0 {
            self.smoothed = time.wrapping_mul(8);
            self.deviation = time.wrapping_mul(2);
        } else {
            let error = time.abs_diff(self.smoothed >> 3);
            self.deviation = self.deviation.wrapping_sub(self.deviation >> 2).wrapping_add(error);
            self.smoothed = self.smoothed.wrapping_sub(self.smoothed >> 3).wrapping_add(time);
        }
        self.backoff = 0;
    }

    /// Nothing came in time.
    pub(super) const fn back_off(&mut self) {
        self.backoff = self.backoff.saturating_add(1);
    }

    /// How long to wait: `least` at least, and by backoff alone not beyond `most`.
    pub(super) fn timeout(&self, least: u32, most: u32) -> u32 {
        let measured = (self.smoothed >> 3).saturating_add(self.deviation.max(1));
        let timeout = if self.smoothed == 0 { least } else { measured.max(least) };
        let doubled = u64::from(timeout) << self.backoff.min(BACKOFF_MAX);
        u32::try_from(doubled).unwrap_or(u32::MAX).min(most.max(timeout))
    }
}

#[cfg(test)]
mod tests {
    use super::Estimator;

    #[test]
    fn follows_the_round_trip_and_its_variation() {
        let mut estimator = Estimator::default();
        assert_eq!(estimator.timeout(500, 2000), 500);
        estimator.add(800);
        // RFC 6298: the time and 4 times a half of it.
        assert_eq!(estimator.timeout(500, 2000), 2400);
        (0..100).for_each(|_| estimator.add(800));
        assert!((800..=830).contains(&estimator.timeout(500, 2000)), "{}", estimator.timeout(500, 2000));
        (0..100).for_each(|step| estimator.add(if step % 2 == 0 { 700 } else { 900 }));
        assert!((1150..1250).contains(&estimator.timeout(500, 2000)), "{}", estimator.timeout(500, 2000));
        (0..200).for_each(|_| estimator.add(3));
        assert_eq!((estimator.timeout(500, 2000), estimator.timeout(1, 9) < 20), (500, true));
    }

    #[test]
    fn backs_off_until_the_next_measurement() {
        let mut estimator = Estimator::default();
        let doubled = [(); 4].map(|()| {
            estimator.back_off();
            estimator.timeout(500, 3000)
        });
        assert_eq!(doubled, [1000, 2000, 3000, 3000]);
        assert_eq!(estimator.timeout(4000, 3000), 4000);
        (0..300).for_each(|_| estimator.back_off());
        assert_eq!(estimator.timeout(500, u32::MAX), 500 << 22);
        estimator.add(100);
        assert_eq!(estimator.timeout(500, 3000), 500);
    }

    #[test]
    fn any_contents_do_no_harm() {
        for fill in [1, 0x7FFF_FFFF, u32::MAX] {
            let mut estimator = Estimator { smoothed: fill, deviation: fill, backoff: 255 };
            assert!(estimator.timeout(1, 2) >= 1);
            estimator.add(fill);
            estimator.back_off();
            assert!(estimator.timeout(1, 2) >= 1);
        }
    }
}
