//! Decimal numbers read as the nearest float.

use super::{Digits, SIZE, WHOLE};
use crate::bytes::zeros;

/// Exponents beyond that are as good as that: no text has so many digits that it matters.
const EXPONENT_MAX: i32 = 1_000_000;

/// Reads digits, perhaps with a point in or around them and an exponent behind (`12`, `.5`, `1.`, `1e-3`): the bits of
/// the nearest float, of two the even one, or `None` when an infinity would be nearest; and what stands behind the
/// number. `None` instead of both when no number stands there.
pub fn read_float<T: Iterator<Item = u8> + Clone>(text: T) -> Option<(Option<u32>, T)> {
    let mut whole = 0_i32;
    let mut count = 0_i32;
    let mut point = false;
    let mut rest = text.clone();
    let mut ahead = text.clone();
    loop {
        match ahead.next() {
            Some(b'0'..=b'9') => {
                count = count.saturating_add(1);
                whole = whole.saturating_add(i32::from(!point));
            }
            Some(b'.') if !point => point = true,
            _ => break,
        }
        rest = ahead.clone();
    }
    if count == 0 {
        return None;
    }
    let (exponent, rest) = exponent(rest.clone()).unwrap_or((0, rest));

    let digits =
        text.filter(|byte| *byte != b'.').map(|byte| byte.wrapping_sub(b'0')).take(count.unsigned_abs() as usize);
    Some((nearest(digits, whole.saturating_add(exponent)), rest))
}

/// An `e`, perhaps a sign, and digits. A space is a plus too: what becomes of `1e+06` in a value that nobody encoded.
fn exponent<T: Iterator<Item = u8> + Clone>(mut text: T) -> Option<(i32, T)> {
    if !matches!(text.next(), Some(b'e' | b'E')) {
        return None;
    }
    let mut ahead = text.clone();
    let sign = ahead.next();
    if matches!(sign, Some(b'-' | b'+' | b' ')) {
        text = ahead.clone();
    } else {
        ahead = text.clone();
    }
    let mut size = None;
    while let Some(digit @ b'0'..=b'9') = ahead.next() {
        let more = size.unwrap_or(0_i32).saturating_mul(10).saturating_add(i32::from(digit.wrapping_sub(b'0')));
        size = Some(more.min(EXPONENT_MAX));
        text = ahead.clone();
    }
    let size = size?;
    Some((if sign == Some(b'-') { size.wrapping_neg() } else { size }, text))
}

/// The float that is nearest to these digits with a point behind the first `whole` ones, wherever that is.
fn nearest(digits: impl Iterator<Item = u8>, whole: i32) -> Option<u32> {
    let mut room = zeros();
    let mut number = Digits::zero(&mut room);
    let mut place = i32::try_from(WHOLE).unwrap_or_default().saturating_sub(whole);
    for digit in digits {
        if digit != 0 {
            let at = usize::try_from(place).ok()?;
            match number.digit.get_mut(at) {
                Some(place) => {
                    *place = digit;
                    number.first = number.first.min(at);
                    number.end = number.end.max(at.wrapping_add(1)).min(SIZE);
                }
                None => number.more = true,
            }
        }
        place = place.saturating_add(1);
    }

    // Scaled so that the units are the significand's. What the digits lack is less than a unit of their last place,
    // and halfway between two floats there is always a multiple of that: so `more` need not be multiplied.
    let mut exponent = 0_i16;
    let mut significand = number.whole();
    while significand >= 1 << 24 {
        let bits = if significand >= 1 << 28 { 4 } else { 1 };
        number.divide(bits);
        exponent = exponent.wrapping_add(bits.into());
        significand = number.whole();
    }
    while significand < 1 << 23 && exponent > -149 {
        let bits = if significand < 1 << 19 && exponent >= -145 { 4 } else { 1 };
        number.multiply(bits, 0);
        exponent = exponent.wrapping_sub(bits.into());
        significand = number.whole();
    }

    let up = number.rounds_up(WHOLE);
    // A significand that is rounded up to 2^24 carries into the exponent's bits, one below 2^23 leaves them 0.
    let bits = u32::try_from(exponent.wrapping_add(149)).ok()?;
    let bits = bits.wrapping_shl(23).wrapping_add(significand).wrapping_add(u32::from(up));
    (bits < 0x7F80_0000).then_some(bits)
}

impl Digits<'_> {
    /// What stands before the point, or 2^28 when that is more.
    fn whole(&self) -> u32 {
        let mut sum = 0_u32;
        for digit in self.digit.iter().take(WHOLE).skip(self.first) {
            sum = sum.wrapping_mul(10).wrapping_add(u32::from(*digit));
            if sum >= 1 << 28 {
                return 1 << 28;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::read_float;
    use proptest::prelude::*;

    /// The bits, and how many bytes were read.
    fn read(text: &str) -> Option<(Option<u32>, usize)> {
        read_float(text.bytes()).map(|(bits, rest)| (bits, text.len() - rest.len()))
    }

    /// Against the standard library.
    fn check(text: &str) {
        let value: f32 = text.parse().unwrap();
        let expected = value.is_finite().then_some(value.to_bits());
        assert_eq!(read(text), Some((expected, text.len())), "{text}");
    }

    #[test]
    fn known_numbers() {
        let all = "0 0.0 110.44 3343.73 1000.00 .5 1. 16777216 16777217 16777219 0.1 1e3 1E+3 1e-3 1e38 3.4028235e38 \
            3.4028235677973366e38 3.4028235677973362e38 1e39 1e-45 7.006492321624085e-46 7.006492321624086e-46 1e-46 \
            1e-400 0e999999999999 1.17549435e-38 1e99999999999999 33554435 33554437 9999999e10 9999999e-10 1e10 1e11 \
            00000000001.5";
        for text in all.split_whitespace() {
            check(text);
        }
    }

    #[test]
    fn halfway_between_floats_the_last_digit_decides() {
        for bits in [0_u32, 1, 2, 0x7F_FFFF, 0x80_0000, 0x3F80_0000, 0x3F80_0001, 0x4B7F_FFFF, 0x7F7F_FFFE] {
            // The exact middle between this one and the next.
            let middle = f64::midpoint(f32::from_bits(bits).into(), f32::from_bits(bits + 1).into());
            let text = format!("{middle:.160}");
            check(&text);
            check(&format!("{text}{}1", "0".repeat(100)));
            let below = text.trim_end_matches('0');
            let last = below.chars().last().unwrap();
            if last != '.' {
                let last = char::from(u8::try_from(last).unwrap() - 1);
                check(&format!("{}{last}{}", &below[..below.len() - 1], "9".repeat(120)));
            }
        }
    }

    #[test]
    fn what_is_behind_is_left() {
        // A bar where the number ends.
        for text in "1| ;1.5|.;1|e;1|e+;1|ex;2e5|e;1|-;1e 2|;1|e  2;1|e ".split(';') {
            let (number, behind) = text.split_once('|').unwrap();
            let read = read(&[number, behind].concat());
            assert_eq!(read.map(|(_, length)| length), Some(number.len()), "{text}");
        }
        for text in ["", ".", "e5", ".e5", "-1", "nan", "inf", "x"] {
            assert_eq!(read(text), None, "{text}");
        }
    }

    proptest! {
        #[test]
        fn any_number(whole in "[0-9]{0,60}", fraction in "[0-9]{0,180}", exponent in -330..330_i32) {
            let text = format!("0{whole}.{fraction}");
            check(&text);
            check(&format!("{text}e{exponent}"));
        }

        #[test]
        fn any_float(bits in 0..0x7F80_0000_u32) {
            let value = f32::from_bits(bits);
            for text in [format!("{value}"), format!("{value:e}"), format!("{value:.2}"), format!("{value:.149}")] {
                check(&text);
            }
        }
    }
}
