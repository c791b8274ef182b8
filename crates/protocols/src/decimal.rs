//! Floats as text, and back: exact and without floating-point arithmetic.
//!
//! A float is an integer times a power of two, so its decimal digits end: at most 39 before the point and 149 behind
//! it. They are all worked out, nine to a word, and then rounded: here to six significant digits, as `printf("%g")` and
//! C++ streams do.

mod fixed;
mod read;

pub use fixed::{DECIMALS_MAX, write_fixed};
pub use read::read_float;

/// A limb holds nine decimal digits.
const BASE: u32 = 1_000_000_000;
const LIMB_DIGITS: i32 = 9;
/// Limbs before the point...
const WHOLE: usize = 5;
/// ...the last of them...
const UNITS: usize = WHOLE.wrapping_sub(1);
/// ...and in all.
const LIMBS: usize = WHOLE + 17;
/// The power of ten of the first digit of them all.
const FIRST_PLACE: i32 = 44;

/// Significant digits of the text.
const DIGITS: u32 = 6;

/// Six significant digits of a number.
struct Rounded {
    /// 100000 to 999999.
    digits: u32,
    /// The power of ten of the first.
    exponent: i32,
}

/// Writes the float of these bits.
pub fn write_float(bits: u32, put: &mut dyn FnMut(u8)) {
    if bits >> 31 == 1 {
        put(b'-');
    }
    let exponent = bits >> 23 & 0xFF;
    let fraction = bits & 0x7F_FFFF;
    let special: &[u8] = match (exponent, fraction) {
        (0, 0) => b"0",
        (0xFF, 0) => b"inf",
        (0xFF, _) => b"nan",
        (0, _) => return write_rounded(&round(fraction, -149), put),
        _ => return write_rounded(&round(fraction | 0x80_0000, exponent.cast_signed().wrapping_sub(150)), put),
    };
    for byte in special {
        put(*byte);
    }
}

/// Works out the digits of `significand` * 2^`exponent` in limbs that are zero.
fn expand(limbs: &mut [u32; LIMBS], significand: u32, exponent: i32) {
    if let Some(units) = limbs.get_mut(UNITS) {
        *units = significand;
    }
    for _ in 0..exponent {
        double(limbs);
    }
    let mut halvings = exponent.wrapping_neg();
    while halvings > 0 {
        // A limb's lowest nine bits are what 10^9 can be divided by.
        let now = halvings.min(9);
        halve(limbs, now.cast_unsigned());
        halvings = halvings.wrapping_sub(now);
    }
}

/// Rounds `significand` * 2^`exponent`, which is not zero, to the nearest; a tie goes to the even digit.
fn round(significand: u32, exponent: i32) -> Rounded {
    let mut limbs = [0; LIMBS];
    expand(&mut limbs, significand, exponent);

    let (mut digits, mut count, mut exponent) = (0_u32, 0_u32, 0);
    let (mut next, mut beyond) = (0, false);
    let mut place = FIRST_PLACE;
    for limb in limbs {
        let mut rest = limb;
        for _ in 0..LIMB_DIGITS {
            let digit = rest / (BASE / 10);
            rest = (rest % (BASE / 10)).wrapping_mul(10);
            if count == 0 && digit != 0 {
                exponent = place;
            }
            if count > 0 || digit != 0 {
                match count {
                    0..DIGITS => digits = digits.wrapping_mul(10).wrapping_add(digit),
                    DIGITS => next = digit,
                    _ => beyond |= digit != 0,
                }
                count = count.wrapping_add(1);
            }
            place = place.wrapping_sub(1);
        }
    }
    if next > 5 || next == 5 && (beyond || digits & 1 == 1) {
        digits = digits.wrapping_add(1);
    }
    if digits == 1_000_000 {
        Rounded { digits: 100_000, exponent: exponent.wrapping_add(1) }
    } else {
        Rounded { digits, exponent }
    }
}

fn double(limbs: &mut [u32; LIMBS]) {
    let mut carry = 0;
    for limb in limbs.iter_mut().rev() {
        let twice = limb.wrapping_mul(2).wrapping_add(carry);
        carry = u32::from(twice >= BASE);
        *limb = if twice >= BASE { twice.wrapping_sub(BASE) } else { twice };
    }
}

/// Divides by 2^`times`, 1 to 9; whether digits fell out behind the last limb.
fn halve(limbs: &mut [u32; LIMBS], times: u32) -> bool {
    let unit = BASE.wrapping_shr(times);
    let mask = 1_u32.wrapping_shl(times).wrapping_sub(1);
    let mut carry = 0;
    for limb in limbs {
        let low = *limb & mask;
        *limb = limb.wrapping_shr(times).wrapping_add(carry);
        carry = low.wrapping_mul(unit);
    }
    carry != 0
}

fn write_rounded(number: &Rounded, put: &mut dyn FnMut(u8)) {
    let fixed = -4 <= number.exponent && number.exponent < DIGITS.cast_signed();
    // How many digits are written before the point: none of 0.00123's, one of 1.23e+06's.
    let whole = if fixed { number.exponent.wrapping_add(1) } else { 1 };

    if whole <= 0 {
        put(b'0');
        put(b'.');
        (whole..0).for_each(|_| put(b'0'));
    }
    let mut rest = number.digits;
    let mut written = 0;
    while rest != 0 || written < whole {
        if written == whole && written > 0 {
            put(b'.');
        }
        put(digit(rest / 100_000));
        rest = (rest % 100_000).wrapping_mul(10);
        written = written.wrapping_add(1);
    }
    if !fixed {
        put(b'e');
        put(if number.exponent < 0 { b'-' } else { b'+' });
        let size = number.exponent.unsigned_abs();
        put(digit(size / 10));
        put(digit(size % 10));
    }
}

/// The character of a digit, 0 to 9.
#[expect(clippy::cast_possible_truncation, reason = "a digit")]
const fn digit(value: u32) -> u8 {
    b'0'.wrapping_add(value as u8)
}

#[cfg(test)]
mod tests {
    use super::write_float;
    use std::string::String;

    fn text(bits: u32) -> String {
        let mut text = String::new();
        write_float(bits, &mut |byte| text.push(char::from(byte)));
        text
    }

    /// %g by its definition in the C standard, on top of Rust's exact `{:e}`.
    fn percent_g(value: f32) -> String {
        if value.is_nan() || value.is_infinite() || value == 0.0 {
            let sign = if value.is_sign_negative() { "-" } else { "" };
            let name = if value.is_nan() {
                "nan"
            } else if value == 0.0 {
                "0"
            } else {
                "inf"
            };
            return std::format!("{sign}{name}");
        }
        let scientific = std::format!("{:.5e}", f64::from(value));
        let (digits, exponent) = scientific.split_once('e').unwrap();
        let exponent: i32 = exponent.parse().unwrap();
        let trim = |text: &str| String::from(text.trim_end_matches('0').trim_end_matches('.'));
        if (-4..6).contains(&exponent) {
            let decimals = usize::try_from(5 - exponent).unwrap();
            let fixed = std::format!("{:.decimals$}", f64::from(value));
            if decimals == 0 { fixed } else { trim(&fixed) }
        } else {
            let sign = if exponent < 0 { '-' } else { '+' };
            std::format!("{}e{sign}{:02}", trim(digits), exponent.abs())
        }
    }

    #[test]
    fn known_texts() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "-0"),
            (1.0, "1"),
            (-3.5, "-3.5"),
            (0.1, "0.1"),
            (100_000.0, "100000"),
            (999_999.0, "999999"),
            (999_999.5, "1e+06"),
            (1e6, "1e+06"),
            (123_456_790.0, "1.23457e+08"),
            (0.000_1, "0.0001"),
            (0.000_099_999_99, "0.0001"),
            (0.000_012_345_678, "1.23457e-05"),
            (f32::MAX, "3.40282e+38"),
            (f32::MIN_POSITIVE, "1.17549e-38"),
            (f32::INFINITY, "inf"),
            (f32::NEG_INFINITY, "-inf"),
            // Ties go to the even digit.
            (1_000_002.5, "1e+06"),
            (100_000.5, "100000"),
            (100_001.5, "100002"),
        ] {
            assert_eq!(text(f32::to_bits(value)), expected);
        }
        assert_eq!(text(1), "1.4013e-45");
        assert_eq!(text(0x7F80_0001), "nan");
        assert_eq!(text(0xFFC0_0000), "-nan");
    }

    #[test]
    fn as_percent_g() {
        let edges = (0..=0x1FF).flat_map(|top: u32| [0, 1, 0x3F_FFFF, 0x40_0000, 0x7F_FFFF].map(|low| top << 23 | low));
        let spread = (0..20_000_u32).map(|step| step.wrapping_mul(0x9E37_79B9));
        for bits in edges.chain(spread) {
            assert_eq!(text(bits), percent_g(f32::from_bits(bits)), "{bits:#010x}");
        }
    }
}
