//! Lines out of a stream of bytes.
//!
//! A line ends with LF, and a CR before that belongs to the end. Empty lines are skipped. A line that is too long is
//! thrown away up to its end, where it is reported.

use zerocopy::FromBytes;

/// A receiver of lines. `SIZE` is one byte more than the longest line, for its CR. All zero is an empty one.
#[derive(Clone, Debug, FromBytes)]
// In this order: on AVR what lies within 64 bytes takes shorter instructions.
#[repr(C)]
pub struct Receiver<const SIZE: usize> {
    /// Bytes of the line in the buffer, or, once it has ended, its length.
    used: u16,
    /// One of the constants below.
    state: u8,
    line: [u8; SIZE],
}

/// The line goes on.
const RECEIVING: u8 = 0;
/// The line is too long and goes on.
const TOO_LONG: u8 = 1;
/// A line is complete.
const COMPLETE: u8 = 2;
/// The end of a line that was too long has come; so it has in any other state.
const LOST: u8 = 3;

/// What was received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received<'a> {
    /// No end of a line yet.
    Nothing,
    /// A line without its end, of one byte at least.
    Line(&'a [u8]),
    /// The end of a line that was too long and is lost.
    TooLong,
}

impl<const SIZE: usize> Receiver<SIZE> {
    /// An empty receiver.
    pub const fn new() -> Self {
        const { assert!(0 < SIZE && SIZE <= 0xFFFF) }
        Self { used: 0, state: RECEIVING, line: [0; SIZE] }
    }

    /// Takes bytes up to the next end of a line; how many, none before the last line's [`release`](Self::release).
    pub fn take(&mut self, bytes: &[u8]) -> usize {
        if self.has_ended() {
            return 0;
        }
        let mut used = usize::from(self.used);
        let mut taken = 0_usize;
        for byte in bytes {
            taken = taken.wrapping_add(1);
            if *byte != b'\n' {
                match self.line.get_mut(used) {
                    Some(place) => {
                        *place = *byte;
                        used = used.wrapping_add(1);
                    }
                    None => self.state = TOO_LONG,
                }
                continue;
            }
            let length = match self.line.get(..used) {
                Some([.., b'\r']) => used.wrapping_sub(1),
                _ => used,
            };
            let lost = self.state == TOO_LONG;
            (used, self.state) = (0, RECEIVING);
            match self.line.get_mut(length) {
                Some(behind) if !lost => {
                    // C programs want a zero byte there.
                    *behind = 0;
                    if length > 0 {
                        (used, self.state) = (length, COMPLETE);
                        break;
                    }
                }
                _ => {
                    self.state = LOST;
                    break;
                }
            }
        }
        self.used = u16::try_from(used).unwrap_or_default();
        taken
    }

    /// Whether there is something to [`release`](Self::release).
    #[inline(always)]
    pub const fn has_ended(&self) -> bool {
        self.state >= COMPLETE
    }

    /// What was received.
    pub fn received(&self) -> Received<'_> {
        match (self.state, self.line.get(..self.used.into())) {
            (COMPLETE, Some(line)) => Received::Line(line),
            (COMPLETE.., _) => Received::TooLong,
            _ => Received::Nothing,
        }
    }

    /// Drops the line that was received, to make room for the next.
    pub const fn release(&mut self) {
        if self.has_ended() {
            self.clear();
        }
    }

    /// Forgets all that was received: what comes next begins a line.
    pub const fn clear(&mut self) {
        (self.used, self.state) = (0, RECEIVING);
    }
}

impl<const SIZE: usize> Default for Receiver<SIZE> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::{Received, Receiver};
    use proptest::prelude::*;

    /// Lines, or `None` for those that were lost.
    fn lines<const SIZE: usize>(pieces: &[&[u8]]) -> Vec<Option<Vec<u8>>> {
        let mut receiver = Receiver::<SIZE>::new();
        let mut lines = Vec::new();
        for piece in pieces {
            let mut rest = *piece;
            while !rest.is_empty() {
                let taken = receiver.take(rest);
                assert!(taken > 0);
                match receiver.received() {
                    Received::Nothing => assert_eq!(taken, rest.len()),
                    Received::Line(line) => lines.push(Some(line.to_vec())),
                    Received::TooLong => lines.push(None),
                }
                assert!(receiver.received() == Received::Nothing || receiver.take(b"x") == 0);
                receiver.release();
                rest = &rest[taken..];
            }
        }
        lines
    }

    #[test]
    fn ends_of_lines() {
        let line = |text: &[u8]| Some(text.to_vec());
        let lines = lines::<64>(&[b"c=a\nc=b\r\n\n\r\n\r\r\nc=c\n\rc=d"]);
        assert_eq!(lines, [line(b"c=a"), line(b"c=b"), line(b"\r"), line(b"c=c")]);
    }

    #[test]
    fn the_longest_line_and_a_longer_one() {
        let line = |length| Some(vec![b'x'; length]);
        for end in [&b"\n"[..], b"\r\n"] {
            let of = |length: usize| [&vec![b'x'; length][..], end].concat();
            assert_eq!(lines::<8>(&[&of(7), &of(1)]), [line(7), line(1)]);
            for length in [8, 9, 10, 1000] {
                assert_eq!(lines::<8>(&[&of(7), &of(length), &of(7)]), [line(7), None, line(7)], "{length}");
            }
        }
        assert_eq!(lines::<1>(&[b"\n", b"x\n"]), [None]);
    }

    #[test]
    fn a_zero_byte_stands_behind_a_line() {
        let mut receiver = Receiver::<4>::new();
        receiver.take(b"abc\r\n");
        assert_eq!((receiver.received(), receiver.line), (Received::Line(b"abc"), *b"abc\0"));
        receiver.clear();
        receiver.release();
        assert_eq!((receiver.take(b"d\n"), receiver.received()), (2, Received::Line(b"d")));
    }

    proptest! {
        #[test]
        fn any_contents_do_no_harm(used: u16, state: u8, bytes: Vec<u8>) {
            let mut receiver = Receiver::<8> { used, state, line: [0; 8] };
            let _ = receiver.received();
            prop_assert!(receiver.take(&bytes) <= bytes.len());
            if let Received::Line(line) = receiver.received() {
                prop_assert!(line.len() <= 8);
            }
            receiver.release();
            receiver.take(b"\n");
            receiver.release();
            receiver.take(b"x\n");
            prop_assert_eq!(receiver.received(), Received::Line(b"x"));
        }

        #[test]
        fn chunks_make_no_difference(
            bytes in prop::collection::vec(prop_oneof![Just(b'\n'), Just(b'\r'), Just(b'x'), any::<u8>()], 0..200),
            cuts in prop::collection::vec(1..9_usize, 200),
        ) {
            let mut rest = &bytes[..];
            let pieces: Vec<_> = cuts.iter().filter_map(|cut| rest.split_off(..rest.len().min(*cut))).collect();
            prop_assert_eq!(lines::<8>(&[&bytes]), lines::<8>(&pieces));
        }
    }
}
