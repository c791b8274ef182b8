//! Values: urlencoded text (page "Ozeki Line Protocol", section "Rules"), which may be a number.
//!
//! `%` and two hexadecimal digits of either case stand for any byte, a `+` for a space, other bytes for themselves.
//! Numbers are decimal and may have spaces around them, as programs write them that fill up columns.

use super::integer::Integer;
use crate::decimal;

/// A value as received.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Value<'a>(&'a [u8]);

/// Why a value can't be read as a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberError {
    /// It is none.
    Malformed,
    /// It is one that the type does not have.
    Range,
}

impl<'a> Value<'a> {
    /// A value, as it stands in a line.
    pub const fn new(raw: &'a [u8]) -> Self {
        Self(raw)
    }

    /// The value as it stands in the line, encoded.
    pub const fn raw(self) -> &'a [u8] {
        self.0
    }

    /// Whether it is no text at all.
    pub const fn is_empty(self) -> bool {
        self.0.is_empty()
    }

    /// The decoded text. It may be any bytes, 0 among them, though the protocol means UTF-8.
    pub const fn bytes(self) -> Decoded<'a> {
        Decoded { rest: self.0 }
    }

    /// Number of bytes of the decoded text.
    pub fn len(self) -> usize {
        self.bytes().count()
    }

    /// Whether that is the decoded text.
    pub fn is(self, text: &[u8]) -> bool {
        let mut own = self.bytes();
        for byte in text {
            // Most bytes need no decoding.
            match own.rest {
                [first, rest @ ..] if first == byte && !matches!(first, b'%' | b'+') => own.rest = rest,
                _ => {
                    if own.next() != Some(*byte) {
                        return false;
                    }
                }
            }
        }
        own.rest.is_empty()
    }

    /// Reads an integer: an optional sign and digits.
    pub fn int<T: Integer>(self) -> Result<T, NumberError> {
        T::read(self.bytes())
    }

    /// Reads an integer of 0 to 255, such as `t`.
    pub fn byte(self) -> Option<u8> {
        let [byte, 0] = self.word()?.to_le_bytes() else { return None };
        Some(byte)
    }

    /// Reads an integer of 0 to 65535, such as a window size.
    pub fn word(self) -> Option<u16> {
        let [low, high, 0, 0] = self.int::<i32>().ok()?.to_le_bytes() else { return None };
        Some(u16::from_le_bytes([low, high]))
    }

    /// Reads four hexadecimal digits of either case: a checksum.
    pub fn hex(self) -> Option<u16> {
        if self.0.len() != 4 {
            return None;
        }
        self.0.iter().try_fold(0, |word, byte| Some(word << 4 | u16::from(digit(*byte)?)))
    }

    /// Reads a decimal number, such as `-1000.00` or `1e3`, as the nearest `f32`; a tie goes to the even one.
    /// Infinities and NaNs have no decimal digits; what is so large that an infinity would be nearest is out of range.
    pub fn float(self) -> Result<f32, NumberError> {
        let (negative, digits) = signed(self.bytes());
        let (bits, rest) = decimal::read_float(digits).ok_or(NumberError::Malformed)?;
        if !only_spaces(rest) {
            return Err(NumberError::Malformed);
        }
        let bits = bits.ok_or(NumberError::Range)?;
        Ok(f32::from_bits(bits | u32::from(negative) << 31))
    }
}

/// The bytes of a value, decoded.
#[derive(Clone, Debug)]
pub struct Decoded<'a> {
    rest: &'a [u8],
}

impl Iterator for Decoded<'_> {
    type Item = u8;

    fn next(&mut self) -> Option<u8> {
        let (first, mut rest) = self.rest.split_first()?;
        let mut byte = *first;
        if byte == b'+' {
            byte = b' ';
        } else if byte == b'%'
            && let [high, low, behind @ ..] = rest
            && let (Some(high), Some(low)) = (digit(*high), digit(*low))
        {
            byte = high << 4 | low;
            rest = behind;
        }
        self.rest = rest;
        Some(byte)
    }
}

/// Spaces and a sign are passed over; whether that is a minus.
pub(super) fn signed(mut text: Decoded<'_>) -> (bool, Decoded<'_>) {
    loop {
        let at = text.clone();
        match text.next() {
            Some(b' ') => (),
            Some(b'-') => return (true, text),
            Some(b'+') => return (false, text),
            _ => return (false, at),
        }
    }
}

pub(super) fn only_spaces(mut text: Decoded<'_>) -> bool {
    text.all(|byte| byte == b' ')
}

/// The value of a hexadecimal digit.
pub(super) const fn digit(byte: u8) -> Option<u8> {
    match byte {
        b'0'..=b'9' => Some(byte.wrapping_sub(b'0')),
        b'a'..=b'f' => Some(byte.wrapping_sub(b'a').wrapping_add(10)),
        b'A'..=b'F' => Some(byte.wrapping_sub(b'A').wrapping_add(10)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::{NumberError, Value};

    fn value(raw: &str) -> Value<'_> {
        Value::new(raw.as_bytes())
    }

    #[test]
    fn text() {
        for (raw, decoded) in [
            ("", &b""[..]),
            ("a+b%20c", b"a b c"),
            ("%00%fF%Ff", b"\0\xFF\xFF"),
            ("%2B+", b"+ "),
            // None of a line that was parsed: they stand for themselves.
            ("%", b"%"),
            ("%4", b"%4"),
            ("%4g%41", b"%4gA"),
        ] {
            let value = value(raw);
            assert_eq!(value.bytes().collect::<Vec<_>>(), decoded, "{raw}");
            assert_eq!(value.len(), decoded.len());
            assert!(value.is(decoded));
            assert!(!value.is(&[decoded, b"x"].concat()));
            assert!(decoded.is_empty() || !value.is(&decoded[1..]) && !value.is(&decoded[..decoded.len() - 1]));
        }
    }

    #[test]
    fn small_integers() {
        assert_eq!(["0", "255", "256", "-1", "x"].map(|raw| value(raw).byte()), [Some(0), Some(255), None, None, None]);
        assert_eq!(["0", "65535", "65536", "-1"].map(|raw| value(raw).word()), [Some(0), Some(65535), None, None]);
        let hex = ["d293", "D29f", "d29", "0d293", "null", ""].map(|raw| value(raw).hex());
        assert_eq!(hex, [Some(0xd293), Some(0xd29f), None, None, None, None]);
    }

    #[test]
    fn floats() {
        for raw in ["110.44", "-1000.00", "-0.0", "1e-50", "-1e-50", ".5", "5."] {
            let number: f32 = raw.parse().unwrap();
            assert_eq!(value(raw).float().map(f32::to_bits), Ok(number.to_bits()), "{raw}");
        }
        let decoded = ["  3.50", "+1.5+", "%2B1.5", "1e%2B3", "1e+3"].map(|raw| value(raw).float());
        assert_eq!(decoded, [3.5, 1.5, 1.5, 1000.0, 1000.0].map(Ok));
        for raw in ["", ".", "-", "nan", "inf", "1e", "1e+", "1.5x", "1.5.", "1,5", "- 1", "0x1p3", "1e99x"] {
            assert_eq!(value(raw).float(), Err(NumberError::Malformed), "{raw}");
        }
        for raw in ["1e39", "-1e39", "340282356779733661637539395458142568448"] {
            assert_eq!(value(raw).float(), Err(NumberError::Range), "{raw}");
        }
        assert_eq!(value("340282356779733661637539395458142568447").float(), Ok(f32::MAX));
    }
}
