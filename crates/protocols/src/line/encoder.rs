//! Building lines, parameter by parameter.
//!
//! What is sent is strict (page "Ozeki Line Protocol", section "Rules"): names are of `[A-Za-z0-9_]`, as boards use them,
//! values encoded, and a command is no longer than the serial buffer of the device that it is for.

use super::checksum::fletcher16;
use super::integer::Integer;
use crate::bytes::zeros;
use crate::decimal::{self, DECIMALS_MAX};
use core::mem::take;

/// Bytes of the longest line that a PC sends, with its checksum and its end.
pub const COMMAND_MAX: usize = 64;

/// The bits that infinities and NaNs have in common.
const INFINITE: u32 = 0x7F80_0000;

/// Why a line can't be built. The numbers are those of C's codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum EncodeError {
    /// It was given up.
    Aborted = 1,
    /// What was said to be encoded is not.
    Malformed = 8,
    /// The line is longer than may be sent, or than there is room.
    TooLong = 9,
    /// A float is not finite, or is to have too many decimals.
    Range = 10,
    /// A name is empty or not of `[A-Za-z0-9_]`, or a parameter's is `s`: boards take the first `s` for the checksum.
    Name = 13,
}

/// A line that is being built in a buffer.
///
/// Each call adds a parameter, but none after one that fails: [`finish`](Self::finish) says why.
#[derive(Debug)]
pub struct Encoder<'a> {
    room: &'a mut [u8],
    length: usize,
    error: Option<EncodeError>,
}

impl<'a> Encoder<'a> {
    /// Begins a line which may be as long as the buffer, its end included: what a device sends.
    #[inline(always)]
    pub fn begin(room: &'a mut [u8], command: &[u8]) -> Self {
        let mut encoder = Self { room, length: 0, error: None };
        encoder.start(command);
        encoder
    }

    /// Adds the beginning of an empty line.
    pub fn start(&mut self, command: &[u8]) {
        if !is_name(command) {
            self.fail(EncodeError::Name);
        }
        self.put_all(b"c=");
        self.put_all(command);
    }

    /// Begins a line which may have [`COMMAND_MAX`] bytes, its end included, if the buffer has them: what a PC sends.
    pub fn command(room: &'a mut [u8], command: &[u8]) -> Self {
        let limit = room.len().min(COMMAND_MAX);
        Self::begin(room.get_mut(..limit).unwrap_or_default(), command)
    }

    /// Goes on with a line of which so many bytes are in the buffer. If it has fewer, nothing can be added.
    #[inline(always)]
    pub const fn resume(room: &'a mut [u8], length: usize) -> Self {
        Self { room, length, error: None }
    }

    /// Number of bytes so far.
    pub const fn length(&self) -> usize {
        self.length
    }

    /// What went wrong so far.
    pub const fn error(&self) -> Option<EncodeError> {
        self.error
    }

    /// Adds a text, encoded: all bytes but `[A-Za-z0-9._-]` as `%` and two hexadecimal digits.
    pub fn text(&mut self, name: &[u8], text: &[u8]) -> &mut Self {
        self.name(name);
        for byte in text {
            if is_plain(*byte) {
                self.put(*byte);
            } else {
                self.put(b'%');
                self.put_digits(*byte, b'A');
            }
        }
        self
    }

    /// Adds a value that is encoded already, such as one of a received line.
    ///
    /// Fails when a line with it would not be read as it was meant: `&`, LF or CR in it, or a `%` without its digits.
    pub fn raw(&mut self, name: &[u8], value: &[u8]) -> &mut Self {
        self.name(name);
        let mut rest = value;
        while let Some((byte, behind)) = rest.split_first() {
            let digits = matches!(behind, [high, low, ..] if high.is_ascii_hexdigit() && low.is_ascii_hexdigit());
            if matches!(byte, b'&' | b'\n' | b'\r') || *byte == b'%' && !digits {
                self.fail(EncodeError::Malformed);
            }
            rest = behind;
        }
        self.put_all(value);
        self
    }

    /// Adds an integer.
    pub fn int<T: Integer>(&mut self, name: &[u8], value: T) -> &mut Self {
        self.text(name, value.write(&mut zeros()))
    }

    /// Adds an integer of at most 16 bits, such as `t`.
    pub fn word(&mut self, name: &[u8], value: u16) -> &mut Self {
        self.text(name, b"");
        self.number(b"", value.into());
        self
    }

    /// Adds an integer behind `&`, a name that needs no check, and `=`, which are given as one.
    pub fn number(&mut self, name: &[u8], value: i32) {
        self.put_all(name);
        self.put_all(value.write(&mut zeros()));
    }

    /// Adds a float as `printf("%.*f")` writes it: with up to [`DECIMALS_MAX`] decimals, a tie to the even digit.
    pub fn float(&mut self, name: &[u8], value: f32, decimals: u8) -> &mut Self {
        self.text(name, b"").fixed(value, decimals)
    }

    /// Adds a float so written to the value that the line ends with.
    pub fn fixed(&mut self, value: f32, decimals: u8) -> &mut Self {
        if value.to_bits() & INFINITE == INFINITE || decimals > DECIMALS_MAX {
            self.fail(EncodeError::Range);
        } else {
            decimal::write_fixed(value.to_bits(), decimals, &mut |byte| self.put(byte));
        }
        self
    }

    /// Adds four hexadecimal digits in lower case: a checksum.
    pub fn hex(&mut self, name: &[u8], value: u16) -> &mut Self {
        self.text(name, b"").put_hex(value);
        self
    }

    /// Adds these digits to the value that the line ends with.
    pub fn put_hex(&mut self, value: u16) {
        let [high, low] = value.to_be_bytes();
        self.put_digits(high, b'a');
        self.put_digits(low, b'a');
    }

    /// Ends the line, with its checksum if wanted, and returns the length of the whole, or the first error there
    /// was. The buffer's first byte is 0 then.
    pub fn finish(&mut self, checksum: bool) -> Result<usize, EncodeError> {
        if checksum {
            let sum = fletcher16(self.room.get(..self.length).unwrap_or_default());
            self.put_all(b"&s=");
            self.put_hex(sum);
        }
        self.put(b'\n');
        self.error.map_or(Ok(self.length), Err)
    }

    fn name(&mut self, name: &[u8]) {
        if !is_param_name(name) {
            self.fail(EncodeError::Name);
        }
        self.put(b'&');
        self.put_all(name);
        self.put(b'=');
    }

    #[inline(never)]
    pub(super) fn put_all(&mut self, bytes: &[u8]) {
        match self.room.get_mut(self.length..).and_then(|room| room.get_mut(..bytes.len())) {
            Some(room) => {
                for (place, byte) in room.iter_mut().zip(bytes) {
                    *place = *byte;
                }
                self.length = self.length.wrapping_add(bytes.len());
            }
            None => self.fail(EncodeError::TooLong),
        }
    }

    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub(super) fn put(&mut self, byte: u8) {
        match self.room.get_mut(self.length) {
            Some(place) => {
                *place = byte;
                self.length = self.length.wrapping_add(1);
            }
            None => self.fail(EncodeError::TooLong),
        }
    }

    /// Adds the two hexadecimal digits of a byte; `ten` is the one of 10.
    fn put_digits(&mut self, byte: u8, ten: u8) {
        self.put(digit(byte >> 4, ten));
        self.put(digit(byte & 0xF, ten));
    }

    /// Empties the line: it can't be finished. From here on there is no room, so that nothing more is added.
    pub fn fail(&mut self, error: EncodeError) {
        self.error = self.error.or(Some(error));
        self.length = 0;
        // Nothing that could be sent by mistake.
        if let Some(first) = take(&mut self.room).first_mut() {
            *first = 0;
        }
    }
}

/// Whether a command may have that name.
pub(super) fn is_name(name: &[u8]) -> bool {
    !name.is_empty() && name.iter().all(|byte| is_plain(*byte) && !matches!(byte, b'.' | b'-'))
}

/// Whether a parameter may have that name.
pub(super) fn is_param_name(name: &[u8]) -> bool {
    is_name(name) && !matches!(name, [b's'])
}

/// Whether a byte of a text needs no encoding.
pub(super) const fn is_plain(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'_' | b'-')
}

/// The hexadecimal digit of 0 to 15; `ten` is the one of 10.
const fn digit(value: u8, ten: u8) -> u8 {
    if value < 10 { b'0'.wrapping_add(value) } else { ten.wrapping_add(value).wrapping_sub(10) }
}

#[cfg(test)]
mod tests {
    use super::{EncodeError, Encoder};
    use crate::line::{Checksum, Message};
    use proptest::prelude::*;

    /// The line that is built in a buffer of 256 bytes.
    fn built(
        checksum: bool,
        build: impl for<'l, 'a> FnOnce(&'l mut Encoder<'a>) -> &'l mut Encoder<'a>,
    ) -> Result<String, EncodeError> {
        let mut room = [0; 256];
        let length = build(&mut Encoder::begin(&mut room, b"x")).finish(checksum)?;
        Ok(String::from_utf8(room[..length].to_vec()).unwrap())
    }

    #[test]
    fn lines() {
        let line = built(false, |line| {
            let line = line.text(b"name", b"St\xC3\xA9p 1&=%+").int(b"t", 255);
            line.float(b"temp", 110.44, 2).hex(b"checksum", 0xd29)
        });
        assert_eq!(line.unwrap(), "c=x&name=St%C3%A9p%201%26%3D%25%2B&t=255&temp=110.44&checksum=0d29\n");
        let line = built(true, |line| line.raw(b"a", b"1").raw(b"b", b"%2f").raw(b"c", b"").raw(b"d", b"x=y z"));
        assert_eq!(line.unwrap(), "c=x&a=1&b=%2f&c=&d=x=y z&s=13ea\n");
    }

    #[test]
    fn what_is_refused() {
        for name in ["", "s", "a-b", "a b", "a=", "\u{e9}"] {
            assert_eq!(built(false, |line| line.int(name.as_bytes(), 1)), Err(EncodeError::Name), "{name}");
        }
        for value in ["&", "\n", "\r", "%", "%1", "%g0", "a%0", "x%4\n"] {
            assert_eq!(built(false, |line| line.raw(b"v", value.as_bytes())), Err(EncodeError::Malformed), "{value:?}");
        }
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(built(false, |line| line.float(b"v", value, 2)), Err(EncodeError::Range));
        }
        assert_eq!(built(false, |line| line.float(b"v", 1.0, 10)), Err(EncodeError::Range));
        // The first error stays.
        let line = built(true, |line| line.int(b"x y", 1).float(b"y", f32::NAN, 1).text(b"z", &[0; 100]));
        assert_eq!(line, Err(EncodeError::Name));
        let mut room = [0; 64];
        for command in ["", "g-o", "go!", "a&b"] {
            assert_eq!(Encoder::begin(&mut room, command.as_bytes()).finish(true), Err(EncodeError::Name), "{command}");
        }
        assert_eq!(Encoder::begin(&mut room, b"setpushinfo_resp").finish(false), Ok(19));
        assert_eq!(built(false, |line| line.int(b"Id", 1).int(b"num_blocks", 2)).unwrap(), "c=x&Id=1&num_blocks=2\n");
    }

    #[test]
    fn commands_have_64_bytes() {
        let mut room = [0; 200];
        for (checksum, around) in [(false, "c=x&y=\n".len()), (true, "c=x&y=&s=0123\n".len())] {
            for length in 55..70 {
                let text = &[b'y'; 100][..length - around];
                let finished = Encoder::command(&mut room, b"x").text(b"y", text).finish(checksum);
                assert_eq!(finished, if length <= 64 { Ok(length) } else { Err(EncodeError::TooLong) });
            }
        }
    }

    proptest! {
        #[test]
        fn what_is_built_is_read(
            text in prop::collection::vec(any::<u8>(), 0..60),
            int: i64,
            float in -1e6..1e6_f32,
            hex: u16,
            checksum: bool,
        ) {
            let line = built(checksum, |line| line.text(b"a", &text).int(b"b", int).float(b"d", float, 9).hex(b"e", hex));
            let line = line.unwrap();
            let message = Message::parse(line.as_bytes()).unwrap();
            prop_assert_eq!(message.checksum, if checksum { Checksum::Right } else { Checksum::None });
            prop_assert!(message.get(b"a").unwrap().is(&text));
            prop_assert_eq!(message.get(b"a").unwrap().bytes().collect::<Vec<_>>(), text);
            prop_assert_eq!(message.get(b"b").unwrap().int(), Ok(int));
            prop_assert!((message.get(b"d").unwrap().float().unwrap() - float).abs() <= 1e-9);
            prop_assert_eq!(message.get(b"e").unwrap().hex(), Some(hex));
        }

        #[test]
        fn no_room_is_overrun(size in 0..40_usize, text: Vec<u8>, raw: Vec<u8>, checksum: bool) {
            let mut room = vec![0; size];
            let mut line = Encoder::begin(&mut room, b"go");
            match line.text(b"a", &text).raw(b"b", &raw).finish(checksum) {
                Ok(length) => {
                    prop_assert!(length <= size);
                    prop_assert!(Message::parse(&room[..length]).is_ok());
                }
                Err(error) => prop_assert!(error == EncodeError::TooLong || !raw.is_empty()),
            }
        }
    }
}
