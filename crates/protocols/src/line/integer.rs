//! Integers in decimal, in the two sizes that C's `long` has.

use super::value::{Decoded, NumberError, only_spaces, signed};
use crate::bytes::divide_by_ten;
use zerocopy::IntoBytes;

/// Room for the text of any integer.
pub type IntegerText = [u16; 10];

/// An integer that values can say: `i32` or `i64`.
pub trait Integer: Copy {
    /// Reads an optional sign and digits, perhaps with spaces around them.
    fn read(text: Decoded<'_>) -> Result<Self, NumberError>;

    /// Writes it to the end of the room: a minus if needed, and the digits.
    fn write(self, room: &mut IntegerText) -> &[u8];
}

macro_rules! integer {
    ($type:ty) => {
        impl Integer for $type {
            fn read(text: Decoded<'_>) -> Result<Self, NumberError> {
                let mut bytes = [0; size_of::<Self>()];
                read_number(text, &mut bytes)?;
                Ok(Self::from_le_bytes(bytes))
            }

            fn write(self, room: &mut IntegerText) -> &[u8] {
                write_digits(self < 0, &mut self.unsigned_abs().to_le_bytes(), room)
            }
        }
    };
}
integer!(i32);
integer!(i64);

/// Reads an integer of so many bytes, which are zero, the lowest first.
fn read_number(text: Decoded<'_>, number: &mut [u8]) -> Result<(), NumberError> {
    let (negative, mut text) = signed(text);
    let (mut begun, mut beyond) = (false, false);
    let end = loop {
        let end = text.next();
        let Some(digit @ b'0'..=b'9') = end else { break end };
        begun = true;
        beyond |= append_digit(number, digit.wrapping_sub(b'0'));
    };
    if !begun || end.is_some_and(|byte| byte != b' ') || !only_spaces(text) {
        return Err(NumberError::Malformed);
    }
    let mut fits = !is_below_zero(number);
    if negative {
        negate(number);
        // There is one more negative number than there are others.
        fits |= is_below_zero(number);
    }
    if beyond || !fits { Err(NumberError::Range) } else { Ok(()) }
}

/// Multiplies by ten and adds a digit; whether that is beyond the number's bytes.
fn append_digit(number: &mut [u8], digit: u8) -> bool {
    let mut carry = digit;
    for byte in number {
        [*byte, carry] = u16::from(*byte).wrapping_mul(10).wrapping_add(carry.into()).to_le_bytes();
    }
    carry != 0
}

fn negate(number: &mut [u8]) {
    let mut carry = true;
    for byte in number {
        (*byte, carry) = (!*byte).overflowing_add(carry.into());
    }
}

fn is_below_zero(number: &[u8]) -> bool {
    number.last().is_some_and(|top| *top >= 0x80)
}

fn write_digits<'a>(negative: bool, amount: &mut [u8], room: &'a mut IntegerText) -> &'a [u8] {
    let room = room.as_mut_bytes();
    let mut at = room.len();
    let mut put = |byte| {
        at = at.wrapping_sub(1);
        if let Some(place) = room.get_mut(at) {
            *place = byte;
        }
    };
    loop {
        put(b'0'.wrapping_add(divide_by_ten(amount)));
        if amount.iter().all(|byte| *byte == 0) {
            break;
        }
    }
    if negative {
        put(b'-');
    }
    room.get(at..).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::Integer;
    use crate::line::{Encoder, NumberError, Value};
    use std::fmt::{Debug, Display};

    fn check<T: Integer + PartialEq + Debug + Display + TryFrom<i128>>(min: i128, max: i128) {
        let read = |text: &str| Value::new(text.as_bytes()).int::<T>();
        let edges = (0..20).flat_map(|exponent| [-1, 0, 1].map(|by| 10_i128.pow(exponent) + by));
        let near = (0..12).flat_map(|by| [min - by, min + by, max - by, max + by, min / 10 - by, max / 10 + by]);
        for number in edges.clone().chain(edges.map(|edge| -edge)).chain(near).chain([min * 10, max * 10]) {
            for text in [format!("{number}"), format!("  {number} "), format!("{number:030}")] {
                assert_eq!(read(&text), T::try_from(number).map_err(|_| NumberError::Range), "{text}");
            }
            if let Ok(fits) = T::try_from(number) {
                let mut room = [0; 32];
                let length = Encoder::begin(&mut room, b"x").int(b"v", fits).finish(false).unwrap();
                assert_eq!(room[..length], *format!("c=x&v={fits}\n").as_bytes());
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
