//! Decimal text of floats.

use super::{Digits, SIZE, WHOLE, tenth};
use crate::bytes::zeros;

/// Most decimals that [`write_fixed`] can be asked for.
pub const DECIMALS_MAX: u8 = 9;

/// Significant digits of [`write_float`].
const SIGNIFICANT: usize = 6;

/// Writes the float of these bits with six significant digits, as `printf("%g")` and C++ streams do.
pub fn write_float(bits: u32, put: &mut dyn FnMut(u8)) {
    if bits >> 31 == 1 {
        put(b'-');
    }
    let special: &[u8] = match bits << 1 {
        0 => b"0",
        0xFF00_0000 => b"inf",
        0xFF00_0001.. => b"nan",
        _ => b"",
    };
    if !special.is_empty() {
        return special.iter().for_each(|byte| put(*byte));
    }
    let mut room = zeros();
    let mut digits = Digits::zero(&mut room);
    digits.set(bits);
    digits.round(digits.first.wrapping_add(SIGNIFICANT));
    // Where the units are, if the number is written without an exponent: -4 to 5.
    let (first, units) = (digits.first, WHOLE.wrapping_sub(1));
    let fixed = first <= units.wrapping_add(4) && first > units.wrapping_sub(SIGNIFICANT);
    let units = if fixed { units } else { first };
    let mut end = first.wrapping_add(SIGNIFICANT);
    while end > units.wrapping_add(1) && digits.get(end.wrapping_sub(1)) == 0 {
        end = end.wrapping_sub(1);
    }
    digits.put(first.min(units), units, end.max(units.wrapping_add(1)), put);
    if !fixed {
        put(b'e');
        let small = first >= WHOLE;
        put(if small { b'-' } else { b'+' });
        let units = WHOLE.wrapping_sub(1);
        let exponent = u8::try_from(first.abs_diff(units)).unwrap_or_default();
        let tens = tenth(exponent);
        put(b'0'.wrapping_add(tens));
        put(b'0'.wrapping_add(exponent.wrapping_sub(tens.wrapping_mul(10))));
    }
}

/// Writes the float of these bits, which is finite, with so many decimals, [`DECIMALS_MAX`] at most, as
/// `printf("%.*f")` does: rounded to the nearest; a tie goes to the even digit.
pub fn write_fixed(bits: u32, decimals: u8, put: &mut dyn FnMut(u8)) {
    if bits >> 31 == 1 {
        put(b'-');
    }
    let mut room = zeros();
    let mut digits = Digits::zero(&mut room);
    digits.set(bits);
    let end = WHOLE.wrapping_add(decimals.into());
    digits.round(end);
    let units = WHOLE.wrapping_sub(1);
    digits.put(digits.first.min(units), units, end, put);
}

impl Digits<'_> {
    /// Sets zero to a finite float, without its sign.
    fn set(&mut self, bits: u32) {
        let [low, middle, high, top] = bits.to_le_bytes();
        let exponent = top << 1 | high >> 7;
        let high = if exponent == 0 { high & 0x7F } else { high | 0x80 };
        for byte in [high, middle, low] {
            self.multiply(4, byte >> 4);
            self.multiply(4, byte & 0xF);
        }
        let exponent = exponent.max(1);
        let (up, mut left) =
            if exponent >= 150 { (true, exponent.wrapping_sub(150)) } else { (false, 150_u8.wrapping_sub(exponent)) };
        while left > 0 {
            let bits = left.min(4);
            if up {
                self.multiply(bits, 0);
            } else {
                self.divide(bits);
            }
            left = left.wrapping_sub(bits);
        }
    }

    /// Rounds to the digits before a place.
    fn round(&mut self, place: usize) {
        let mut up = self.rounds_up(place);
        let mut at = place;
        while up && at > 0 {
            at = at.wrapping_sub(1);
            let Some(digit) = self.digit.get_mut(at) else { break };
            up = *digit == 9;
            *digit = if up { 0 } else { digit.wrapping_add(1) };
            self.first = self.first.min(at);
        }
        self.end = place.min(SIZE);
    }

    /// Writes the digits of these places, with a point behind the units if any follow.
    fn put(&self, first: usize, units: usize, end: usize, put: &mut dyn FnMut(u8)) {
        for place in first..end {
            put(b'0'.wrapping_add(self.get(place)));
            if place == units && place.wrapping_add(1) < end {
                put(b'.');
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{DECIMALS_MAX, write_fixed, write_float};

    fn text(bits: u32) -> String {
        let mut text = String::new();
        write_float(bits, &mut |byte| text.push(char::from(byte)));
        text
    }

    /// %g by its definition in the C standard, on top of Rust's exact `{:e}`.
    fn percent_g(value: f32) -> String {
        if !value.is_finite() || value == 0.0 {
            let sign = if value.is_sign_negative() { "-" } else { "" };
            return format!("{sign}{}", value.abs()).to_lowercase();
        }
        let scientific = format!("{value:.5e}");
        let (digits, exponent) = scientific.split_once('e').unwrap();
        let exponent: i32 = exponent.parse().unwrap();
        let trim = |text: &str| String::from(text.trim_end_matches('0').trim_end_matches('.'));
        if (-4..6).contains(&exponent) {
            let decimals = usize::try_from(5 - exponent).unwrap();
            let fixed = format!("{value:.decimals$}");
            if decimals == 0 { fixed } else { trim(&fixed) }
        } else {
            let sign = if exponent < 0 { '-' } else { '+' };
            format!("{}e{sign}{:02}", trim(digits), exponent.abs())
        }
    }

    #[test]
    fn known_texts() {
        // Numbers that are written as they stand here, or as stands behind the arrow. Ties go to the even digit.
        for pair in "0 -0 1 -3.5 0.1 100000 999999 inf -inf 999999.5>1e+06 1e6>1e+06 123456790>1.23457e+08 0.0001 \
            0.00009999999>0.0001 0.000012345678>1.23457e-05 3.4028235e38>3.40282e+38 1.17549435e-38>1.17549e-38 \
            1000002.5>1e+06 100000.5>100000 100001.5>100002 1e-45>1.4013e-45"
            .split_whitespace()
        {
            let (value, expected) = pair.split_once('>').unwrap_or((pair, pair));
            assert_eq!(text(value.parse::<f32>().unwrap().to_bits()), expected);
        }
        assert_eq!(text(0x7F80_0001), "nan");
        assert_eq!(text(0xFFC0_0000), "-nan");
    }

    /// Floats at the edges of all exponents, and many others.
    fn floats() -> impl Iterator<Item = f32> {
        let edges = (0..=0x1FF).flat_map(|top: u32| [0, 1, 0x3F_FFFF, 0x40_0000, 0x7F_FFFF].map(|low| top << 23 | low));
        let spread = (0..20_000_u32).map(|step| step.wrapping_mul(0x9E37_79B9));
        edges.chain(spread).map(f32::from_bits)
    }

    #[test]
    fn as_percent_g() {
        for value in floats() {
            assert_eq!(text(value.to_bits()), percent_g(value), "{:#010x}", value.to_bits());
        }
    }

    #[test]
    fn as_the_standard_librarys() {
        // Ties at each number of decimals: few bits behind the point.
        let ties = (0..4096_u16).map(|steps| f32::from(steps) / 1024.0);
        let known = [3343.73, 110.44, 2.500_001, 9.999, 999_999.94, 999_999_940.0, 1e-9, 6e-10, 4.999e-10];
        for value in floats().chain(ties).chain(known).filter(|value| value.is_finite()) {
            for decimals in 0..=DECIMALS_MAX {
                let mut text = String::new();
                write_fixed(value.to_bits(), decimals, &mut |byte| text.push(char::from(byte)));
                assert_eq!(text, format!("{value:.*}", usize::from(decimals)), "{:#010x}", value.to_bits());
            }
        }
    }
}
