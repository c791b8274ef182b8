//! Integers in decimal.

use core::ffi::c_ulong;

use super::Encoder;
use crate::config::FAST;

/// Digits that an integer has at most, one of 64 bits.
const DIGITS_MAX: usize = 20;
/// The exponent of the largest power of ten that a `long` holds.
#[expect(clippy::cast_possible_truncation, reason = "at most 19")]
const TEN_EXPONENT: u8 = c_ulong::MAX.ilog10() as u8;

impl Encoder<'_> {
    /// Adds the digits of an integer.
    pub(super) fn put_integer(&mut self, value: c_ulong) {
        if !FAST {
            self.put_slowly(value);
            return;
        }
        let mut rest = value;
        let mut digits = [0; DIGITS_MAX];
        let mut count = 0_usize;
        for place in digits.iter_mut().rev() {
            *place = b'0'.wrapping_add(u8::try_from(rest % 10).unwrap_or_default());
            count = count.wrapping_add(1);
            rest /= 10;
            if rest == 0 {
                break;
            }
        }
        self.put_all(digits.get(DIGITS_MAX.wrapping_sub(count)..).unwrap_or_default());
    }

    /// The same without a division, which takes a kilobyte of flash on some controllers.
    fn put_slowly(&mut self, mut rest: c_ulong) {
        let ten_to = |exponent: u8| (0..exponent).fold(1 as c_ulong, |power, _| power.wrapping_mul(10));
        let mut exponent = TEN_EXPONENT;
        while exponent > 0 && ten_to(exponent) > rest {
            exponent = exponent.wrapping_sub(1);
        }
        loop {
            let power = ten_to(exponent);
            let mut digit = b'0';
            while rest >= power {
                rest = rest.wrapping_sub(power);
                digit = digit.wrapping_add(1);
            }
            self.put(digit);
            match exponent.checked_sub(1) {
                Some(next) => exponent = next,
                None => return,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Encoder;
    use core::ffi::c_ulong;

    /// The way that only small targets take, checked here too.
    #[test]
    fn integers_without_division() {
        let edges = (0..20).filter_map(|exponent| 10_u64.checked_pow(exponent));
        for edge in edges.chain([0, 7, 255, 65_535, 1_234_567_890, c_ulong::MAX]) {
            for value in [edge.wrapping_sub(1), edge, edge.saturating_add(1)] {
                let value = value as c_ulong;
                let mut room = [0; 24];
                let mut encoder = Encoder::resume(&mut room, 0);
                encoder.put_slowly(value);
                let length = encoder.length();
                assert_eq!(room[..length], *std::format!("{value}").as_bytes());
            }
        }
    }
}
