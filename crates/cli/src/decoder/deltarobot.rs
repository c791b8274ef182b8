//! Frames of the deltarobot message format.

use std::time::Duration;

use deltarobot_protocols::deltarobot::{FRAME_HEAD, FRAME_OVERHEAD, Fault, Opcode, Verdict, encode, judge};
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

/// Payloads are no longer, as the library's are by default.
const PAYLOAD_LONGEST: usize = 32;

/// Finds frames as the library does, and keeps what it throws away.
#[derive(Default)]
pub struct Frames {
    lanes: Lanes<Lane>,
}

impl Decoder for Frames {
    fn feed(&mut self, from: Option<Side>, bytes: &[u8]) -> Vec<Piece> {
        self.lanes.of(from).feed(bytes).iter().map(|found| found.piece(from)).collect()
    }

    fn idle(&mut self, from: Option<Side>, silence: Duration, gap: Duration) -> Vec<Piece> {
        let lane = self.lanes.of(from);
        let mut found = Vec::new();
        if silence >= gap {
            lane.search(true, &mut found);
        }
        if silence >= QUIET.min(gap) {
            lane.emit_garbage(&mut found);
        }
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
    /// What may be a frame, but more of it is needed.
    waiting: Vec<u8>,
    garbage: Vec<u8>,
}

impl Lane {
    fn feed(&mut self, input: &[u8]) -> Vec<Found> {
        let mut found = Vec::new();
        self.waiting.extend_from_slice(input);
        self.search(false, &mut found);
        if self.garbage.len() >= GARBAGE_MAX {
            self.emit_garbage(&mut found);
        }
        found
    }

    /// Takes out what is certain; with `gives_up`, everything.
    fn search(&mut self, gives_up: bool, found: &mut Vec<Found>) {
        let bytes = std::mem::take(&mut self.waiting);
        let mut rest = bytes.as_slice();
        while let [first, behind @ ..] = rest {
            match judge(rest, PAYLOAD_LONGEST) {
                Verdict::Needs(_) if !gives_up => break,
                Verdict::Needs(_) | Verdict::Fault(_) => {
                    self.garbage.push(*first);
                    rest = behind;
                }
                Verdict::Frame { opcode, length } => {
                    let (frame, behind) = rest.split_at(length + FRAME_OVERHEAD);
                    let payload = frame.get(FRAME_HEAD..FRAME_HEAD + length).unwrap_or_default().to_vec();
                    self.emit_garbage(found);
                    found.push(Found::Frame { opcode, payload, bytes: frame.to_vec() });
                    rest = behind;
                }
            }
        }
        self.waiting.extend_from_slice(rest);
    }

    fn emit_garbage(&mut self, found: &mut Vec<Found>) {
        if !self.garbage.is_empty() {
            found.push(Found::Garbage { bytes: std::mem::take(&mut self.garbage) });
        }
    }
}

/// The frames in garbage that are whole but for their checksum: which it is, and which it should be.
fn checksum_failures(garbage: &[u8]) -> Vec<(u8, u8)> {
    let mut failures = Vec::new();
    let mut rest = garbage;
    while let [_, behind @ ..] = rest {
        rest = behind_failure(rest, &mut failures).unwrap_or(behind);
    }
    failures
}

/// What follows such a frame, if one is here.
fn behind_failure<'a>(bytes: &'a [u8], failures: &mut Vec<(u8, u8)>) -> Option<&'a [u8]> {
    let Verdict::Fault(Fault::Checksum) = judge(bytes, PAYLOAD_LONGEST) else { return None };
    let ([_, opcode, length], behind) = bytes.split_first_chunk()?;
    let (payload, [checksum, _, behind @ ..]) = behind.split_at_checked((*length).into())? else { return None };
    let mut right = [0; PAYLOAD_LONGEST + FRAME_OVERHEAD];
    encode(Opcode(*opcode), payload, &mut right)?;
    failures.push((*checksum, *right.get(FRAME_HEAD + payload.len())?));
    Some(behind)
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
        let idle = |lane: &mut Lane| {
            let mut found = Vec::new();
            lane.search(true, &mut found);
            lane.emit_garbage(&mut found);
            found
        };
        assert_eq!(lane.feed(b"xy$S\0"), []);
        assert_eq!(lane.feed(b"\xB1:z$S\0\xB1:$M\x0C$S\0\xB1:"), [garbage(b"xy"), status(), garbage(b"z"), status()]);
        assert_eq!(idle(&mut lane), [garbage(b"$M\x0C"), status()]);
        assert_eq!(idle(&mut lane), []);
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
