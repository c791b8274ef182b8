//! The contract in the simplest words that say it exactly: no ring, no speed.

use std::ffi::c_int;

use deltarobot::protocol::{DP_RC_GARBAGE, DP_RC_NO_FRAME};
use deltarobot::sizes::{DP_BUFSIZE, DP_DATA_MAX_SIZE};

/// What stands at the beginning of some bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Standing {
    /// A whole frame: its opcode and payload.
    Intact(u8, Vec<u8>),
    /// The beginning of what may become a frame.
    Incomplete,
    /// What can't become a frame any more.
    Wrong,
}

/// The frame of a message; the payload has at most 255 bytes.
pub fn frame(opcode: u8, payload: &[u8]) -> Vec<u8> {
    let mut frame = vec![b'$', opcode, u8::try_from(payload.len()).unwrap()];
    frame.extend(payload);
    let sum = frame.iter().fold(b':', |sum, &byte| sum.wrapping_add(byte));
    frame.extend([sum, b':']);
    frame
}

pub fn standing(bytes: &[u8]) -> Standing {
    if bytes.first().is_some_and(|&start| start != b'$')
        || bytes.get(1).is_some_and(|opcode| !b"ANHMSChsme".contains(opcode))
        || bytes.get(2).is_some_and(|&length| usize::from(length) > DP_DATA_MAX_SIZE)
    {
        return Standing::Wrong;
    }
    let Some(&length) = bytes.get(2) else { return Standing::Incomplete };
    let size = usize::from(length) + 5;
    if bytes.len() < size {
        return Standing::Incomplete;
    }
    let payload = &bytes[3..size - 2];
    if bytes[..size] == frame(bytes[1], payload) {
        Standing::Intact(bytes[1], payload.to_vec())
    } else {
        Standing::Wrong
    }
}

/// What a ring holds: the unread bytes, and where the first of them is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ring {
    pub unread: Vec<u8>,
    pub idx: usize,
}

impl Ring {
    fn consume(&mut self, count: usize) {
        self.unread.drain(..count);
        self.idx = (self.idx + count) % DP_BUFSIZE;
    }

    /// `dp_process` with sound arguments: whether bytes were lost.
    pub fn process(&mut self, bytes: &[u8]) -> bool {
        let taken = &bytes[..bytes.len().min(DP_BUFSIZE)];
        let lost = (self.unread.len() + taken.len()).saturating_sub(DP_BUFSIZE);
        self.consume(lost);
        self.unread.extend(taken);
        lost > 0 || taken.len() < bytes.len()
    }

    /// `dp_recv`, or `dp_recv_idle`: the message, or the return code.
    pub fn recv(&mut self, idle: bool) -> Result<(u8, Vec<u8>), c_int> {
        let mut dropped = 0;
        while !self.unread.is_empty() {
            match standing(&self.unread) {
                Standing::Intact(opcode, payload) => {
                    self.consume(payload.len() + 5);
                    return Ok((opcode, payload));
                }
                Standing::Incomplete if !idle => break,
                _ => self.consume(1),
            }
            dropped += 1;
        }
        Err(if dropped > 0 { DP_RC_GARBAGE } else { DP_RC_NO_FRAME })
    }
}
