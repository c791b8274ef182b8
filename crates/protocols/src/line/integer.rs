//! Integers in decimal, in the two sizes that C's `long` has. Without a division, which takes a kilobyte of flash on
//! some controllers.

use super::value::{Decoded, NumberError};

/// An integer that values can say: `i32` or `i64`.
pub trait Integer: Copy {
    /// Reads an optional sign and digits, perhaps with spaces around them.
    ///
    /// # Errors
    ///
    /// When it is none, or beyond what the type holds.
    fn read(text: Decoded<'_>) -> Result<Self, NumberError>;

    /// Writes it: a minus if needed, and the digits.
    fn write(self, put: &mut dyn FnMut(u8));
}

/// What of an integer was read last.
#[derive(Clone, Copy)]
enum Part {
    Spaces,
    Sign,
    Digits,
    /// Spaces behind it.
    End,
}

/// Both work on negative numbers, of which there is one more.
macro_rules! integer {
    ($type:ty, $digits_max:literal) => {
        impl Integer for $type {
            fn read(text: Decoded<'_>) -> Result<Self, NumberError> {
                let (mut sum, mut beyond, mut negative): (Self, _, _) = (0, false, false);
                let mut part = Part::Spaces;
                for byte in text {
                    part = match (byte, part) {
                        (b'0'..=b'9', Part::Spaces | Part::Sign | Part::Digits) => {
                            beyond |= sum < Self::MIN / 10;
                            let next = sum.wrapping_mul(10).checked_sub(Self::from(byte.wrapping_sub(b'0')));
                            beyond |= next.is_none();
                            sum = next.unwrap_or_default();
                            Part::Digits
                        }
                        (b'-' | b'+', Part::Spaces) => {
                            negative = byte == b'-';
                            Part::Sign
                        }
                        (b' ', Part::Spaces) => Part::Spaces,
                        (b' ', Part::Digits | Part::End) => Part::End,
                        _ => return Err(NumberError::Malformed),
                    };
                }
                if matches!(part, Part::Spaces | Part::Sign) {
                    return Err(NumberError::Malformed);
                }
                let number = if negative { Some(sum) } else { sum.checked_neg() };
                number.filter(|_| !beyond).ok_or(NumberError::Range)
            }

            fn write(self, put: &mut dyn FnMut(u8)) {
                let mut rest = self;
                if self < 0 {
                    put(b'-');
                } else {
                    rest = rest.wrapping_neg();
                }
                let mut power: Self = -1;
                let powers: [Self; $digits_max] = core::array::from_fn(|_| {
                    let this = power;
                    power = power.wrapping_mul(10);
                    this
                });
                let mut begun = false;
                for power in powers.iter().rev() {
                    let mut digit = b'0';
                    while rest <= *power {
                        rest = rest.wrapping_sub(*power);
                        digit = digit.wrapping_add(1);
                    }
                    begun |= digit != b'0' || *power == -1;
                    if begun {
                        put(digit);
                    }
                }
            }
        }
    };
}
integer!(i32, 10);
integer!(i64, 19);

#[cfg(test)]
mod tests {
    use super::Integer;
    use crate::line::{NumberError, Value};
    use std::fmt::Debug;
    use std::string::{String, ToString};

    fn check<T: Integer + PartialEq + Debug + ToString + TryFrom<i128>>(min: i128, max: i128) {
        let read = |text: &str| Value::new(text.as_bytes()).int::<T>();
        let edges = (0..20).flat_map(|exponent| [-1, 0, 1].map(|by| 10_i128.pow(exponent) + by));
        let near = (0..12).flat_map(|by| [min - by, min + by, max - by, max + by, min / 10 - by, max / 10 + by]);
        for number in edges.clone().chain(edges.map(|edge| -edge)).chain(near).chain([min * 10, max * 10]) {
            for text in [std::format!("{number}"), std::format!("  {number} "), std::format!("{number:030}")] {
                assert_eq!(read(&text), T::try_from(number).map_err(|_| NumberError::Range), "{text}");
            }
            if let Ok(fits) = T::try_from(number) {
                let mut text = String::new();
                fits.write(&mut |byte| text.push(char::from(byte)));
                assert_eq!(text, fits.to_string());
            }
        }
        for (raw, number) in [("+5", 5), ("%2B5", 5), ("%2D5+", -5), ("+-1", -1), ("-0", 0), ("%31", 1)] {
            assert_eq!(read(raw), T::try_from(number).map_err(|_| NumberError::Range), "{raw}");
        }
        for raw in ["", " ", "-", "--1", "1.0", "1x", "x1", "1 1", "- 1", "0x10", "1%00", "99999999999999999999x"] {
            assert_eq!(read(raw), Err(NumberError::Malformed), "{raw}");
        }
    }

    #[test]
    fn integers_of_both_sizes() {
        check::<i32>(i32::MIN.into(), i32::MAX.into());
        check::<i64>(i64::MIN.into(), i64::MAX.into());
    }
}
