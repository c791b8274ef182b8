//! Floats with a given number of decimals, as `printf("%.*f")` writes them.

use super::{BASE, LIMB_DIGITS, LIMBS, UNITS, WHOLE, digit, expand};

/// Most decimals that can be asked for.
pub const DECIMALS_MAX: u8 = 9;

/// Writes the float of these bits, which is finite, with so many decimals, [`DECIMALS_MAX`] at most. It is rounded to
/// the nearest; a tie goes to the even digit.
pub fn write_fixed(bits: u32, decimals: u8, put: &mut dyn FnMut(u8)) {
    if bits >> 31 == 1 {
        put(b'-');
    }
    let fraction = bits & 0x7F_FFFF;
    let mut limbs = [0; LIMBS];
    match bits >> 23 & 0xFF {
        0 => expand(&mut limbs, fraction, -149),
        exponent => expand(&mut limbs, fraction | 0x80_0000, exponent.cast_signed().wrapping_sub(150)),
    }
    round(&mut limbs, decimals);

    let mut begun = false;
    for limb in limbs.iter().take(WHOLE) {
        write_limb(*limb, LIMB_DIGITS.cast_unsigned(), &mut |byte| {
            begun |= byte != b'0';
            if begun {
                put(byte);
            }
        });
    }
    if !begun {
        put(b'0');
    }
    if decimals > 0 {
        put(b'.');
        write_limb(limbs.get(WHOLE).copied().unwrap_or_default(), decimals.into(), put);
    }
}

/// Rounds to the first digits of the limb behind the point, or to none.
fn round(limbs: &mut [u32; LIMBS], decimals: u8) {
    let (whole, behind) = limbs.split_at_mut(WHOLE);
    let [limb, beyond @ ..] = behind else { return };
    let unit = (decimals..DECIMALS_MAX).fold(1_u32, |unit, _| unit.wrapping_mul(10));
    // With no decimals the unit is the whole limb, and the last digit that stays is the units'.
    let rest = limb.checked_rem(unit).unwrap_or_default();
    let kept = if decimals == 0 {
        whole.get(UNITS).copied().unwrap_or_default()
    } else {
        limb.checked_div(unit).unwrap_or_default()
    };
    let twice = rest.wrapping_mul(2);
    let zeros_beyond = beyond.iter().all(|limb| *limb == 0);
    *limb = limb.wrapping_sub(rest);
    // A unit of 1 has no half; what lies beyond it is half a unit from 500000000 on.
    let up = if unit == 1 {
        let [first, others @ ..] = beyond else { return };
        let half = BASE / 2;
        *first > half || *first == half && (kept & 1 == 1 || others.iter().any(|limb| *limb != 0))
    } else {
        twice > unit || twice == unit && (kept & 1 == 1 || !zeros_beyond)
    };
    if up {
        *limb = limb.wrapping_add(unit);
        let mut carry = *limb >= BASE;
        if carry {
            *limb = limb.wrapping_sub(BASE);
        }
        for limb in whole.iter_mut().rev() {
            *limb = limb.wrapping_add(carry.into());
            carry = *limb >= BASE;
            if carry {
                *limb = 0;
            }
        }
    }
}

/// Writes the first digits of a limb.
fn write_limb(limb: u32, digits: u32, put: &mut dyn FnMut(u8)) {
    let mut rest = limb;
    for _ in 0..digits {
        put(digit(rest / (BASE / 10)));
        rest = (rest % (BASE / 10)).wrapping_mul(10);
    }
}

#[cfg(test)]
mod tests {
    use super::{DECIMALS_MAX, write_fixed};
    use std::string::String;

    fn text(value: f32, decimals: u8) -> String {
        let mut text = String::new();
        write_fixed(value.to_bits(), decimals, &mut |byte| text.push(char::from(byte)));
        text
    }

    #[test]
    fn known_texts() {
        for (value, decimals, expected) in [
            (3343.73, 2, "3343.73"),
            (110.44, 2, "110.44"),
            (-1000.0, 2, "-1000.00"),
            (0.0, 0, "0"),
            (-0.0, 1, "-0.0"),
            (-0.001, 2, "-0.00"),
            (0.5, 0, "0"),
            (1.5, 0, "2"),
            (2.5, 0, "2"),
            (2.500_001, 0, "3"),
            (0.125, 2, "0.12"),
            (0.375, 2, "0.38"),
            (9.999, 2, "10.00"),
            (999_999.94, 1, "999999.9"),
            (999_999_940.0, 0, "999999936"),
            (f32::MAX, 1, "340282346638528859811704183484516925440.0"),
            (f32::MIN_POSITIVE, 9, "0.000000000"),
            (1e-9, 9, "0.000000001"),
            (6e-10, 9, "0.000000001"),
            (4.999e-10, 9, "0.000000000"),
        ] {
            assert_eq!(text(value, decimals), expected);
        }
    }

    #[test]
    fn as_the_standard_librarys() {
        let edges = (0..=0x1FF).flat_map(|top: u32| [0, 1, 0x3F_FFFF, 0x40_0000, 0x7F_FFFF].map(|low| top << 23 | low));
        let spread = (0..20_000_u32).map(|step| step.wrapping_mul(0x9E37_79B9));
        // Ties at each number of decimals: few bits behind the point.
        let ties = (0..4096_u16).map(|steps| (f32::from(steps) / 1024.0).to_bits());
        for bits in edges.chain(spread).chain(ties) {
            let value = f32::from_bits(bits);
            if value.is_finite() {
                for decimals in 0..=DECIMALS_MAX {
                    assert_eq!(
                        text(value, decimals),
                        std::format!("{value:.*}", usize::from(decimals)),
                        "{bits:#010x}"
                    );
                }
            }
        }
    }
}
