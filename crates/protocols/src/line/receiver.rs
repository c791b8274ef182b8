//! Lines out of a stream of bytes.
//!
//! A line ends with LF, and a CR before that belongs to the end. Empty lines are passed over. A line that is too long
//! is thrown away up to its end, where it is reported.

use core::ffi::c_int;
use core::mem::{align_of, offset_of, size_of};

use crate::config::OLP_LINE_MAX;

/// A byte of a line; C calls it `char`.
pub type LineByte = u8;

/// Bytes that a receiver keeps: the longest line and a CR.
pub const LINE_SIZE: usize = OLP_LINE_MAX + 1;

/// How far a line has been received. All zero is: not at all.
///
/// The bytes lie in storage that is handed to each call, the same each time. It is one byte longer than the longest
/// line, for the CR.
///
/// The fields are never trusted: no contents do any harm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Assembly {
    /// Number of bytes of the line that are in the storage.
    used: c_int,
    /// Whether the line was too long.
    overlong: c_int,
}

/// What received bytes were.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received {
    /// No end of a line yet.
    Nothing,
    /// A line of so many bytes, one at least. Until the next bytes are taken it lies at the beginning of the storage.
    Line(usize),
    /// The end of a line that was too long and is lost.
    Overlong,
}

impl Assembly {
    /// Takes bytes up to the end of the next line, and tells how many those were.
    pub fn take(&mut self, storage: &mut [u8], bytes: &[u8]) -> (usize, Received) {
        let mut used = usize::try_from(self.used).ok().filter(|used| *used <= storage.len()).unwrap_or_default();
        let mut overlong = self.overlong != 0;
        let mut taken = 0_usize;
        let mut received = Received::Nothing;
        for byte in bytes {
            taken = taken.wrapping_add(1);
            if *byte != b'\n' {
                match storage.get_mut(used) {
                    Some(place) => {
                        *place = *byte;
                        used = used.wrapping_add(1);
                    }
                    None => overlong = true,
                }
                continue;
            }
            let length = match storage.get(..used) {
                Some([line @ .., b'\r']) => line.len(),
                _ => used,
            };
            used = 0;
            if overlong || length > 0 && length == storage.len() {
                received = Received::Overlong;
            } else if length > 0 {
                received = Received::Line(length);
            }
            overlong = false;
            if received != Received::Nothing {
                break;
            }
        }
        // No more than the storage has: a slice that C's int can't describe does not occur.
        self.used = c_int::try_from(used).unwrap_or_default();
        self.overlong = c_int::from(overlong);
        (taken, received)
    }

    /// Forgets the line that is being received: what comes next begins one.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

/// A receiver of lines up to `OLP_LINE_MAX` bytes. All zero is an empty one.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Receiver {
    /// How far a line has been received.
    assembly: Assembly,
    /// The line, with room for a CR.
    line: [LineByte; LINE_SIZE],
}

// The layout of C's structs; C tests assert the same numbers.
#[expect(clippy::arithmetic_side_effects, reason = "done by the compiler")]
const _: () = {
    const INT: usize = size_of::<c_int>();
    assert!(offset_of!(Assembly, used) == 0 && offset_of!(Assembly, overlong) == INT);
    assert!(size_of::<Assembly>() == 2 * INT);
    assert!(offset_of!(Receiver, assembly) == 0 && offset_of!(Receiver, line) == 2 * INT);
    assert!(size_of::<Receiver>() == 2 * INT + (OLP_LINE_MAX + 1).next_multiple_of(align_of::<c_int>()));
};

impl Receiver {
    /// An empty receiver.
    #[must_use]
    pub const fn new() -> Self {
        Self { assembly: Assembly { used: 0, overlong: 0 }, line: [0; LINE_SIZE] }
    }

    /// Takes bytes up to the end of the next line, and tells how many those were. A line has a zero byte behind it.
    pub fn take(&mut self, bytes: &[u8]) -> (usize, Received) {
        let (taken, received) = self.assembly.take(&mut self.line, bytes);
        if let Received::Line(length) = received
            && let Some(behind) = self.line.get_mut(length)
        {
            *behind = 0;
        }
        (taken, received)
    }

    /// The line that was received last, of which [`take`](Self::take) told the length.
    #[must_use]
    pub fn line(&self, length: usize) -> &[u8] {
        self.line.get(..length).unwrap_or_default()
    }

    /// Forgets the line that is being received.
    pub fn clear(&mut self) {
        self.assembly.clear();
    }
}

impl Default for Receiver {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::{Assembly, OLP_LINE_MAX, Received, Receiver};
    use proptest::prelude::*;
    use std::vec;
    use std::vec::Vec;

    /// Lines, or `None` for those that were lost.
    fn lines(storage: usize, pieces: &[&[u8]]) -> Vec<Option<Vec<u8>>> {
        let mut storage = vec![0; storage];
        let mut assembly = Assembly::default();
        let mut lines = Vec::new();
        for piece in pieces {
            let mut rest = *piece;
            while !rest.is_empty() {
                let (taken, received) = assembly.take(&mut storage, rest);
                assert!(taken > 0);
                match received {
                    Received::Nothing => assert_eq!(taken, rest.len()),
                    Received::Line(length) => lines.push(Some(storage[..length].to_vec())),
                    Received::Overlong => lines.push(None),
                }
                rest = &rest[taken..];
            }
        }
        lines
    }

    #[test]
    fn ends_of_lines() {
        let line = |text: &[u8]| Some(text.to_vec());
        assert_eq!(
            lines(64, &[b"c=a\nc=b\r\n\n\r\n\r\r\nc=c\n\rc=d"]),
            [line(b"c=a"), line(b"c=b"), line(b"\r"), line(b"c=c")]
        );
    }

    #[test]
    fn the_longest_line_and_a_longer_one() {
        let line = |length| Some(vec![b'x'; length]);
        for end in [&b"\n"[..], b"\r\n"] {
            let of = |length: usize| [&vec![b'x'; length][..], end].concat();
            assert_eq!(lines(8, &[&of(7), &of(1)]), [line(7), line(1)]);
            for length in [8, 9, 10, 1000] {
                assert_eq!(lines(8, &[&of(7), &of(length), &of(7)]), [line(7), None, line(7)], "{length}");
            }
        }
        assert_eq!(lines(0, &[b"\n", b"x\n"]), [None]);
    }

    #[test]
    fn the_receiver_holds_the_line_that_its_size_says() {
        let mut receiver = Receiver::new();
        let mut bytes = vec![b'x'; OLP_LINE_MAX];
        bytes.extend(*b"\r\n");
        assert_eq!(receiver.take(&bytes), (OLP_LINE_MAX + 2, Received::Line(OLP_LINE_MAX)));
        assert_eq!(receiver.line(OLP_LINE_MAX), &bytes[..OLP_LINE_MAX]);
        assert_eq!(receiver.take(b"x"), (1, Received::Nothing));
        receiver.clear();
        assert_eq!(receiver.take(b"ab\nc"), (3, Received::Line(2)));
        assert_eq!(receiver.line(2), b"ab");
        bytes.insert(0, b'x');
        assert_eq!(receiver.take(&bytes), (bytes.len(), Received::Overlong));
    }

    proptest! {
        #[test]
        fn any_contents_do_no_harm(used: i32, overlong: i32, storage in 0..20_usize, bytes: Vec<u8>) {
            let mut storage = vec![0; storage];
            let (taken, received) = Assembly { used, overlong }.take(&mut storage, &bytes);
            prop_assert!(taken <= bytes.len());
            if let Received::Line(length) = received {
                prop_assert!(0 < length && length < storage.len());
            }
        }

        #[test]
        fn chunks_make_no_difference(
            bytes in prop::collection::vec(prop_oneof![Just(b'\n'), Just(b'\r'), Just(b'x'), any::<u8>()], 0..200),
            cuts in prop::collection::vec(1..9_usize, 200),
        ) {
            let mut pieces = Vec::new();
            let mut rest = &bytes[..];
            for cut in cuts {
                let (piece, behind) = rest.split_at(cut.min(rest.len()));
                pieces.push(piece);
                rest = behind;
            }
            prop_assert_eq!(lines(8, &[&bytes]), lines(8, &pieces));
        }
    }
}
