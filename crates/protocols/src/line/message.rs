//! A line as a list of parameters: `c=<command>&name=value&name=value` (page "Ozeki Line Protocol", section "Rules").
//!
//! What is received is judged leniently: names may consist of any bytes, a parameter may lack its `=`, an empty piece
//! between two `&` is no parameter. The command's own name is a value like any other.

use super::checksum::fletcher16;
use super::value::{Value, digit};
use crate::bytes::before_less;

/// A line that can be read, seen where it lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message<'a> {
    /// The line without its end.
    pub line: &'a [u8],
    /// Number of parameters, the command and a checksum among them: 1 at least.
    pub count: usize,
    /// The Fletcher-16 of the line, up to the `&s=` if it has a checksum: what an ack of it repeats.
    pub sum: u16,
    /// Whether the line has a checksum, and the right one.
    pub checksum: Checksum,
}

/// What a line says about its intactness by the first `s`, its last parameter, as boards do ("Link Setup command").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Checksum {
    /// Nothing.
    #[default]
    None,
    /// The line is as it was sent.
    Right,
    /// It is not: behind `&s=` there is something else than the four hexadecimal digits of the sum.
    Wrong,
}

/// Why a line can't be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Malformed {
    /// The first parameter is not `c`, or there is none.
    Command,
    /// A `%` without two hexadecimal digits behind it.
    Escape,
    /// A line feed which is not at the end.
    LineFeed,
}

/// A parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Param<'a> {
    /// Its name as received.
    pub name: &'a [u8],
    /// Its value; empty when it lacks the `=`.
    pub value: Value<'a>,
}

impl<'a> Param<'a> {
    fn of(piece: &'a [u8]) -> Self {
        let name = before(piece, b'=');
        Self { name, value: Value::new(behind(piece, name)) }
    }
}

impl<'a> Message<'a> {
    /// Reads a line, with or without its end (LF or CR LF). A wrong checksum is no error: see [`checksum`](Self::checksum).
    pub fn parse(line: &'a [u8]) -> Result<Self, Malformed> {
        let line = without_end(line);
        if !matches!(line, [b'c'] | [b'c', b'=' | b'&', ..]) {
            return Err(Malformed::Command);
        }

        let (mut count, mut sum_at) = (0_usize, None);
        let (mut at, mut begins) = (0_usize, true);
        while let Some(rest @ [first, ..]) = line.get(at..) {
            if begins && *first != b'&' {
                count = count.wrapping_add(1);
                if matches!(rest, [b's'] | [b's', b'=', ..]) {
                    sum_at = sum_at.or(Some(at.wrapping_sub(1)));
                }
            }
            // All that matters is below that.
            at = at.wrapping_add(before_less(rest, b'&' + 1));
            begins = false;
            at = at.wrapping_add(match line.get(at..) {
                Some([b'&', ..]) => {
                    begins = true;
                    1
                }
                Some([b'%', high, low, ..]) if digit(*high).is_some() && digit(*low).is_some() => 3,
                Some([b'%', ..]) => return Err(Malformed::Escape),
                Some([b'\n', ..]) => return Err(Malformed::LineFeed),
                _ => 1,
            });
        }

        let (summed, behind) = line.split_at_checked(sum_at.unwrap_or(line.len())).unwrap_or_default();
        let sum = fletcher16(summed);
        let checksum = match behind {
            [] => Checksum::None,
            [b'&', b's', b'=', told @ ..] if Value::new(told).hex() == Some(sum) => Checksum::Right,
            _ => Checksum::Wrong,
        };
        Ok(Self { line, count, sum, checksum })
    }

    /// What the line is about: the value of the first parameter. It may be empty.
    pub fn command(&self) -> Value<'a> {
        self.text(b"c")
    }

    /// The parameters in their order, the command first, a checksum last.
    pub const fn params(&self) -> Params<'a> {
        Params::of(self.line)
    }

    /// The value of the first parameter of a name.
    pub fn get(&self, name: &[u8]) -> Option<Value<'a>> {
        self.params().value(name, 0)
    }

    /// The same; nothing when there is none.
    pub fn text(&self, name: &[u8]) -> Value<'a> {
        self.get(name).unwrap_or_default()
    }
}

/// The parameters of a line, in their order.
#[derive(Clone, Debug)]
pub struct Params<'a> {
    rest: &'a [u8],
}

impl<'a> Params<'a> {
    /// Those of a line without its end.
    pub const fn of(line: &'a [u8]) -> Self {
        Self { rest: line }
    }

    /// The parameter of a name that has `occurrence` others of that name before it. The command is the first `c`.
    pub fn find_named(self, name: &[u8], occurrence: usize) -> Option<Param<'a>> {
        self.piece(name, occurrence).map(Param::of)
    }

    /// The value of what [`find_named`](Self::find_named) finds.
    pub fn value(self, name: &[u8], occurrence: usize) -> Option<Value<'a>> {
        self.piece(name, occurrence).map(|piece| Value::new(behind(piece, name)))
    }

    /// The text of a parameter. Inlined, as mostly the value alone is wanted: it takes 300 bytes less on AVR.
    #[inline(always)]
    fn piece(self, name: &[u8], mut occurrence: usize) -> Option<&'a [u8]> {
        let mut rest = self.rest;
        loop {
            let piece = before(rest, b'&');
            if !piece.is_empty() && same(before(piece, b'='), name) {
                if occurrence == 0 {
                    return Some(piece);
                }
                occurrence = occurrence.wrapping_sub(1);
            }
            if piece.len() == rest.len() {
                return None;
            }
            rest = behind(rest, piece);
        }
    }
}

impl<'a> Iterator for Params<'a> {
    type Item = Param<'a>;

    fn next(&mut self) -> Option<Param<'a>> {
        while !self.rest.is_empty() {
            let piece = before(self.rest, b'&');
            self.rest = behind(self.rest, piece);
            if !piece.is_empty() {
                return Some(Param::of(piece));
            }
        }
        None
    }
}

/// What stands before the first of these bytes.
fn before(bytes: &[u8], end: u8) -> &[u8] {
    let place = bytes.iter().position(|byte| *byte == end).unwrap_or(bytes.len());
    bytes.get(..place).unwrap_or_default()
}

/// What stands behind the byte that ended the beginning.
fn behind<'a>(bytes: &'a [u8], beginning: &[u8]) -> &'a [u8] {
    bytes.get(beginning.len().wrapping_add(1)..).unwrap_or_default()
}

/// Whether some bytes are equal; not by a call of memcmp.
pub(super) fn same(one: &[u8], other: &[u8]) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(one, other)| one == other)
}

/// A line without the LF or CR LF it may end with.
pub(super) const fn without_end(line: &[u8]) -> &[u8] {
    let ([line @ .., b'\r', b'\n'] | [line @ .., b'\n'] | line) = line;
    line
}

#[cfg(test)]
mod tests {
    use super::{Checksum, Malformed, Message, Value, fletcher16};

    fn parse(line: &[u8]) -> Message<'_> {
        Message::parse(line).unwrap_or_else(|error| panic!("{error:?}: {line:?}"))
    }

    #[test]
    fn names_repeat() {
        let line = b"c=go&x=10&y=10&z=10&a=50&b=50&c=50&spd=100&eas=1&t=0&id=IqlZci";
        let message = parse(line);
        assert_eq!((message.count, message.command().raw()), (11, &b"go"[..]));
        let c = [0, 1, 2].map(|occurrence| message.params().value(b"c", occurrence).map(Value::raw));
        assert_eq!(c, [Some(&b"go"[..]), Some(b"50"), None]);
        assert_eq!(message.params().find_named(b"id", 0), message.params().nth(10));
    }

    #[test]
    fn odd_lines_that_are_read() {
        for (line, params) in [
            ("c", &[("c", "")][..]),
            ("c=", &[("c", "")]),
            ("c&x", &[("c", ""), ("x", "")]),
            ("c=go&&&x=1&", &[("c", "go"), ("x", "1")]),
            ("c=go&=5&=", &[("c", "go"), ("", "5"), ("", "")]),
            ("c=go&a=b=c", &[("c", "go"), ("a", "b=c")]),
            ("c=onerror&p=Buffer overflow", &[("c", "onerror"), ("p", "Buffer overflow")]),
            ("c=x&Some_Name=!\0\r", &[("c", "x"), ("Some_Name", "!\0\r")]),
        ] {
            let message = parse(line.as_bytes());
            let text = |bytes| str::from_utf8(bytes).unwrap();
            let pairs: Vec<_> = message.params().map(|param| (text(param.name), text(param.value.raw()))).collect();
            assert_eq!((&pairs[..], message.count, message.checksum), (params, params.len(), Checksum::None), "{line}");
        }
        for end in [&b"\n"[..], b"\r\n"] {
            assert_eq!(parse(&[b"c=x&y=%0a", end].concat()).line, b"c=x&y=%0a");
        }
    }

    #[test]
    fn lines_that_are_not() {
        for line in ["", "\n", "\r\n", "x=1", "C=go", "cc=go", "&c=go", "=c", "id=1&c=go"] {
            assert_eq!(Message::parse(line.as_bytes()), Err(Malformed::Command), "{line:?}");
        }
        for line in ["c=%", "c=%4", "c=go&x=%4&y=1", "c=go&x=%0g", "c=go&x=%\n", "c=go&%x=1", "c=%%41"] {
            assert_eq!(Message::parse(line.as_bytes()), Err(Malformed::Escape), "{line:?}");
        }
        for line in ["c=go\nc=go", "c=go\n\n", "c=go\n\r\n"] {
            assert_eq!(Message::parse(line.as_bytes()), Err(Malformed::LineFeed), "{line:?}");
        }
    }

    #[test]
    fn checksums() {
        let check = |line: &str, checksum, sum| {
            let message = parse(line.as_bytes());
            assert_eq!((message.checksum, message.sum), (checksum, sum), "{line}");
        };
        for (checksum, ends) in [
            (Checksum::None, &[""][..]),
            (Checksum::Right, &["&s=a3d6", "&s=A3d6\r\n"]),
            (Checksum::Wrong, &["&s=a3d7", "&s=a3d", "&s=0a3d6", "&s=%613d6", "&s=", "&s"]),
        ] {
            for end in ends {
                check(&format!("c=setswitch&state=1&t=11&id=9o5qzg{end}"), checksum, 0xa3d6);
            }
        }
        let sum = fletcher16(b"c=x");
        for line in ["c=x&s=abcd&t=1", "c=x&s=abcd&", "c=x&s=abcd&s=", &format!("c=x&s={sum:04x}&t=1")] {
            check(line, Checksum::Wrong, sum);
        }
        for line in ["c=x&S=abcd", "c=x&ss=abcd", "c=s&x", "c=x", "c=x&s&y=1", &"c=x&".repeat(5000)] {
            check(line, Checksum::None, fletcher16(line.as_bytes()));
        }
    }
}
