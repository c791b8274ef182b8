//! Frames of the deltarobot message format.

use std::collections::VecDeque;
use std::time::Duration;

use deltarobot_protocols::config::{DP_BUFSIZE, DP_DATA_MAX_SIZE};
use deltarobot_protocols::deltarobot::{FRAME_END, FRAME_OVERHEAD, FRAME_START, Opcode, Ring};
use serde_json::json;

use super::{Decoder, GARBAGE_MAX, Kind, Lanes, Piece, QUIET, Terms};
use crate::hex::hex;
use crate::recording::Side;
use crate::words;

pub(crate) const TERMS: Terms = Terms {
    messages: "frames",
    by_kind: "frames_by_opcode",
    damaged: "wrong checksums",
    damaged_member: "checksum_failures",
};

/// Finds frames as the library does, and keeps what it throws away.
#[derive(Default)]
pub(crate) struct Frames {
    lanes: Lanes<Lane>,
}

impl Decoder for Frames {
    fn feed(&mut self, from: Option<Side>, bytes: &[u8]) -> Vec<Piece> {
        self.lanes.of(from).feed(bytes).iter().map(|found| found.piece(from)).collect()
    }

    fn idle(&mut self, from: Option<Side>, silence: Duration) -> Vec<Piece> {
        let found = if silence < QUIET { Vec::new() } else { self.lanes.of(from).idle() };
        found.iter().map(|found| found.piece(from)).collect()
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Found {
    Frame { opcode: Opcode, payload: Vec<u8>, bytes: Vec<u8> },
    Garbage { bytes: Vec<u8> },
}

impl Found {
    fn piece(&self, from: Option<Side>) -> Piece {
        match self {
            Self::Frame { opcode, payload, bytes } => {
                let mut json = words::json(*opcode, payload);
                if let Some(json) = json.as_object_mut() {
                    json.insert("bytes".into(), hex(bytes).into());
                }
                let kind = Kind::Message(words::name(*opcode).into());
                Piece::new(from.or_else(|| sender(*opcode)), kind, words::text(*opcode, payload), json)
            }
            Self::Garbage { bytes } => {
                let failures = checksum_failures(bytes);
                let kind = Kind::Garbage { bytes: bytes.len(), damaged: failures.len() };
                let json = json!({ "garbage": hex(bytes), "checksum_failures": failures.len() });
                let failures: Vec<_> = failures
                    .iter()
                    .map(|(is, should)| format!(" (checksum {is:02X} instead of {should:02X})"))
                    .collect();
                Piece::new(from, kind, format!("garbage: {}{}", hex(bytes), failures.concat()), json)
            }
        }
    }
}

/// Who must have sent it: most opcodes go one way only.
const fn sender(opcode: Opcode) -> Option<Side> {
    match opcode.0 {
        b'H' | b'S' | b'M' | b'C' => Some(Side::Host),
        b'h' | b's' | b'm' | b'e' => Some(Side::Controller),
        _ => None,
    }
}

/// The bytes of one direction.
#[derive(Default)]
struct Lane {
    ring: Ring,
    /// The bytes in the ring.
    waiting: VecDeque<u8>,
    garbage: Vec<u8>,
}

impl Lane {
    fn feed(&mut self, input: &[u8]) -> Vec<Found> {
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
    fn idle(&mut self) -> Vec<Found> {
        let mut found = Vec::new();
        self.search(true, &mut found);
        self.tell_garbage(&mut found);
        found
    }

    fn search(&mut self, idle: bool, found: &mut Vec<Found>) {
        loop {
            let frame = if idle { self.ring.next_frame_idle() } else { self.ring.next_frame() };
            let frame = frame.ok().map(|frame| (frame.opcode, frame.payload.iter().collect::<Vec<_>>()));
            let gone = self.waiting.len() + self.ring.room() - DP_BUFSIZE;
            let size = frame.as_ref().map_or(0, |(_, payload)| payload.len() + FRAME_OVERHEAD);
            self.garbage.extend(self.waiting.drain(..gone - size));
            let Some((opcode, payload)) = frame else { return };
            self.tell_garbage(found);
            found.push(Found::Frame { opcode, payload, bytes: self.waiting.drain(..size).collect() });
        }
    }

    fn tell_garbage(&mut self, found: &mut Vec<Found>) {
        if !self.garbage.is_empty() {
            found.push(Found::Garbage { bytes: std::mem::take(&mut self.garbage) });
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

#[cfg(test)]
mod tests {
    use super::{Found, Lane, checksum_failures};
    use deltarobot_protocols::deltarobot::Opcode;

    fn status() -> Found {
        Found::Frame { opcode: Opcode::STATUS, payload: vec![], bytes: b"$S\0\xB1:".to_vec() }
    }

    fn garbage(bytes: &[u8]) -> Found {
        Found::Garbage { bytes: bytes.to_vec() }
    }

    #[test]
    fn every_byte_is_told_in_its_order() {
        let mut lane = Lane::default();
        assert_eq!(lane.feed(b"xy$S\0"), []);
        assert_eq!(lane.feed(b"\xB1:z$S\0\xB1:$M\x0C$S\0\xB1:"), [garbage(b"xy"), status(), garbage(b"z"), status()]);
        assert_eq!(lane.idle(), [garbage(b"$M\x0C"), status()]);
        assert_eq!(lane.idle(), []);
        assert_eq!(lane.feed(&[7; 1000]), [garbage(&[7; 1000])]);
        assert_eq!(lane.feed(b"$$S\0\xB1:"), [garbage(b"$"), status()]);
    }

    #[test]
    fn checksums_that_are_wrong() {
        assert_eq!(checksum_failures(b"x$S\0\xB2:$A\x01H\x00:"), [(0xB2, 0xB1), (0x00, 0xE8)]);
        assert_eq!(checksum_failures(b"$S\0\xB2;"), []);
        assert_eq!(checksum_failures(b"$S"), []);
    }
}
