//! Frames, and what lies between them.

use std::collections::{BTreeMap, VecDeque};

use deltarobot::config::{DP_BUFSIZE, DP_DATA_MAX_SIZE};
use deltarobot::deltarobot::{FRAME_END, FRAME_OVERHEAD, FRAME_START, Opcode, Ring};

/// Milliseconds of silence after which an incomplete frame is given up.
pub(crate) const QUIET_MS: u32 = 50;

/// A run of garbage without an end is told in pieces of this many bytes.
const GARBAGE_MAX: usize = 64;

/// What was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Piece {
    Frame { opcode: Opcode, payload: Vec<u8>, bytes: Vec<u8> },
    Garbage { bytes: Vec<u8> },
}

/// Finds frames as the library does, and keeps what it throws away.
pub(crate) struct Decoder {
    ring: Ring,
    /// The bytes in the ring.
    waiting: VecDeque<u8>,
    garbage: Vec<u8>,
}

impl Decoder {
    pub(crate) const fn new() -> Self {
        Self { ring: Ring::new(), waiting: VecDeque::new(), garbage: Vec::new() }
    }

    /// Takes bytes, and gives back what is certain by then.
    pub(crate) fn feed(&mut self, input: &[u8]) -> Vec<Piece> {
        let mut found = Vec::new();
        let mut rest = input;
        while !rest.is_empty() {
            let (now, later) = rest.split_at(rest.len().min(self.ring.room()));
            // Can't overflow: there is room for them.
            let _ = self.ring.append(now);
            self.waiting.extend(now);
            rest = later;
            self.search(false, &mut found);
        }
        if self.garbage.len() >= GARBAGE_MAX {
            self.tell_garbage(&mut found);
        }
        found
    }

    /// Gives up what is incomplete.
    pub(crate) fn idle(&mut self) -> Vec<Piece> {
        let mut found = Vec::new();
        self.search(true, &mut found);
        self.tell_garbage(&mut found);
        found
    }

    fn search(&mut self, idle: bool, found: &mut Vec<Piece>) {
        loop {
            let frame = if idle { self.ring.next_frame_idle() } else { self.ring.next_frame() };
            let frame = frame.ok().map(|frame| (frame.opcode, frame.payload.iter().collect::<Vec<_>>()));
            let gone = self.waiting.len() + self.ring.room() - DP_BUFSIZE;
            let size = frame.as_ref().map_or(0, |(_, payload)| payload.len() + FRAME_OVERHEAD);
            self.garbage.extend(self.waiting.drain(..gone - size));
            let Some((opcode, payload)) = frame else { return };
            self.tell_garbage(found);
            found.push(Piece::Frame { opcode, payload, bytes: self.waiting.drain(..size).collect() });
        }
    }

    fn tell_garbage(&mut self, found: &mut Vec<Piece>) {
        if !self.garbage.is_empty() {
            found.push(Piece::Garbage { bytes: std::mem::take(&mut self.garbage) });
        }
    }
}

/// The frames in garbage that are whole but for their checksum: which it is, and which it should be.
pub(crate) fn checksum_failures(garbage: &[u8]) -> Vec<(u8, u8)> {
    let mut failures = Vec::new();
    let mut rest = garbage;
    while let [first, behind @ ..] = rest {
        rest = behind;
        let [opcode, length, ..] = behind else { break };
        let length = usize::from(*length);
        if *first != FRAME_START || !Opcode(*opcode).is_known() || length > DP_DATA_MAX_SIZE {
            continue;
        }
        // Opcode, length and payload.
        let Some((summed, [checksum, end, after @ ..])) = behind.split_at_checked(length + 2) else { continue };
        if *end == FRAME_END {
            let sum = summed.iter().fold(FRAME_START.wrapping_add(FRAME_END), |sum, byte| sum.wrapping_add(*byte));
            failures.push((*checksum, sum));
            rest = after;
        }
    }
    failures
}

/// What has passed.
#[derive(Debug, Default)]
pub(crate) struct Statistics {
    pub(crate) bytes: usize,
    pub(crate) garbage_bytes: usize,
    pub(crate) checksum_failures: usize,
    /// How many frames there were of each kind.
    pub(crate) frames: BTreeMap<&'static str, usize>,
}

impl Statistics {
    pub(crate) fn count(&mut self, piece: &Piece) {
        match piece {
            Piece::Frame { opcode, bytes, .. } => {
                self.bytes += bytes.len();
                *self.frames.entry(crate::words::name(*opcode)).or_default() += 1;
            }
            Piece::Garbage { bytes } => {
                self.bytes += bytes.len();
                self.garbage_bytes += bytes.len();
                self.checksum_failures += checksum_failures(bytes).len();
            }
        }
    }

    pub(crate) fn frames(&self) -> usize {
        self.frames.values().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::{Decoder, Piece, checksum_failures};
    use deltarobot::deltarobot::Opcode;

    fn status() -> Piece {
        Piece::Frame { opcode: Opcode::STATUS, payload: vec![], bytes: b"$S\0\xB1:".to_vec() }
    }

    fn garbage(bytes: &[u8]) -> Piece {
        Piece::Garbage { bytes: bytes.to_vec() }
    }

    #[test]
    fn every_byte_is_told_in_its_order() {
        let mut decoder = Decoder::new();
        assert_eq!(decoder.feed(b"xy$S\0"), []);
        assert_eq!(
            decoder.feed(b"\xB1:z$S\0\xB1:$M\x0C$S\0\xB1:"),
            [garbage(b"xy"), status(), garbage(b"z"), status()]
        );
        assert_eq!(decoder.idle(), [garbage(b"$M\x0C"), status()]);
        assert_eq!(decoder.idle(), []);
        assert_eq!(decoder.feed(&[7; 1000]), [garbage(&[7; 1000])]);
        assert_eq!(decoder.feed(b"$$S\0\xB1:"), [garbage(b"$"), status()]);
    }

    #[test]
    fn checksums_that_are_wrong() {
        assert_eq!(checksum_failures(b"x$S\0\xB2:$A\x01H\x00:"), [(0xB2, 0xB1), (0x00, 0xE8)]);
        assert_eq!(checksum_failures(b"$S\0\xB2;"), []);
        assert_eq!(checksum_failures(b"$S"), []);
    }
}
