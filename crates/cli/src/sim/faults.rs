//! What a bad line does to bytes.

use super::random::Random;

/// Loses and damages bytes at random.
pub(super) struct Faults {
    lose: f64,
    flip: f64,
    random: Random,
}

impl Faults {
    /// Each byte is lost or has a bit flipped with these probabilities.
    pub(super) const fn new(lose: f64, flip: f64, random: Random) -> Self {
        Self { lose, flip, random }
    }

    pub(super) fn spoil(&mut self, bytes: &mut Vec<u8>) {
        if self.lose > 0.0 {
            bytes.retain(|_| self.random.fraction() >= self.lose);
        }
        if self.flip > 0.0 {
            for byte in bytes {
                if self.random.fraction() < self.flip {
                    *byte ^= 1 << (self.random.next() >> 61);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Faults, Random};

    #[test]
    fn as_many_as_ordered() {
        let spoilt = |lose, flip| {
            let mut bytes = vec![0; 100_000];
            Faults::new(lose, flip, Random::new(Some(1))).spoil(&mut bytes);
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
