//! What a bad line does to bytes.

use std::time::{SystemTime, UNIX_EPOCH};

/// Loses and damages bytes at random.
pub(super) struct Faults {
    lose: f64,
    flip: f64,
    state: u64,
}

impl Faults {
    /// Each byte is lost or has a bit flipped with these probabilities.
    #[expect(clippy::cast_possible_truncation, reason = "the lower bits of the time are those that vary")]
    pub(super) fn new(lose: f64, flip: f64, seed: Option<u64>) -> Self {
        let time = || SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_nanos() as u64);
        Self { lose, flip, state: seed.unwrap_or_else(time) }
    }

    pub(super) fn spoil(&mut self, bytes: &mut Vec<u8>) {
        if self.lose > 0.0 {
            bytes.retain(|_| self.fraction() >= self.lose);
        }
        if self.flip > 0.0 {
            for byte in bytes {
                if self.fraction() < self.flip {
                    *byte ^= 1 << (self.next() >> 61);
                }
            }
        }
    }

    /// Bytes that mean nothing.
    pub(super) fn rubbish(&mut self) -> [u8; 3] {
        let [first, second, third, ..] = self.next().to_le_bytes();
        [first, second, third]
    }

    /// From 0 to below 1.
    #[expect(clippy::cast_precision_loss, reason = "32 bits are exact")]
    fn fraction(&mut self) -> f64 {
        (self.next() >> 32) as f64 / (1_u64 << 32) as f64
    }

    /// `SplitMix64`.
    const fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.state;
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ mixed >> 31
    }
}

#[cfg(test)]
mod tests {
    use super::Faults;

    #[test]
    fn as_many_as_ordered() {
        let spoilt = |lose, flip| {
            let mut bytes = vec![0; 100_000];
            Faults::new(lose, flip, Some(1)).spoil(&mut bytes);
            (bytes.len(), bytes.iter().filter(|byte| **byte != 0).count())
        };
        assert_eq!(spoilt(0.0, 0.0), (100_000, 0));
        assert_eq!(spoilt(1.0, 0.0), (0, 0));
        assert_eq!(spoilt(0.0, 1.0), (100_000, 100_000));
        let (left, damaged) = spoilt(0.25, 0.1);
        assert!((74_000..76_000).contains(&left) && (7_000..8_000).contains(&damaged), "{left} {damaged}");
        assert_eq!(spoilt(0.25, 0.1), (left, damaged));
    }
}
