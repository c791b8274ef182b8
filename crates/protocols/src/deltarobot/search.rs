//! The search for frames on hosts, which finds what the plain one in `ring.rs` does, with fewer instructions and in a
//! time that grows with the ring's size alone.

use super::frame::{FRAME_END, FRAME_HEAD, FRAME_OVERHEAD, FRAME_START};
use super::ring::{Payload, Ring, RingFrame, int, pieces, wrap};
use super::sums::Sums;
use super::{NoFrame, Opcode};
use crate::bytes;
use crate::config::{DP_BUFSIZE, DP_DATA_MAX_SIZE};

/// How many bytes a candidate needs to be judged, by the bytes of its head; in place of [`Opcode::is_known`], which
/// compares with one opcode after the other.
struct Needs {
    /// All ones for an opcode, so that only the length counts; [`WRONG_OPCODE`] for other bytes.
    by_opcode: [u32; 256],
    /// The size of a frame of that length, or [`WRONG_LENGTH`].
    by_length: [u32; 256],
}

/// So many bytes show that the opcode is wrong, or the length.
const WRONG_OPCODE: u32 = 2;
const WRONG_LENGTH: u32 = 3;

#[expect(
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    reason = "evaluated by the compiler, for 0 to 255"
)]
static NEEDS: Needs = {
    let mut needs = Needs { by_opcode: [WRONG_OPCODE; 256], by_length: [WRONG_LENGTH; 256] };
    let mut byte = 0;
    while byte < 256 {
        if Opcode(byte as u8).is_known() {
            needs.by_opcode[byte] = u32::MAX;
        }
        if byte <= DP_DATA_MAX_SIZE {
            needs.by_length[byte] = byte.wrapping_add(FRAME_OVERHEAD) as u32;
        }
        byte += 1;
    }
    needs
};

/// The opcode and the size of what may be a frame but for its checksum, or why there is none.
pub type Judgement = Result<(Opcode, usize), NoFrame>;

/// How many bytes it takes to judge a candidate with such a head: 2 or 0 when the opcode is wrong.
#[inline(always)]
pub(super) fn needed(opcode: u8, length: u8) -> usize {
    (entry(&NEEDS.by_opcode, opcode) & entry(&NEEDS.by_length, length)) as usize
}

#[inline(always)]
fn entry(table: &[u32; 256], byte: u8) -> u32 {
    table.get(usize::from(byte)).copied().unwrap_or_default()
}

impl Ring {
    /// Judges what the ring starts with, wherever that lies. `None` when the start is out of range. More bytes than a
    /// ring has are waited for by nobody, and refused by who takes them.
    #[inline(always)]
    pub fn look(&self) -> Option<(usize, Judgement)> {
        let start = self.start.cast_unsigned() as usize;
        (start < DP_BUFSIZE).then(|| (start, self.judge_fast(start, self.used.cast_unsigned() as usize)))
    }

    /// What [`search`](Ring::search) does, in a time that grows with the ring's size alone.
    #[inline(always)]
    pub(super) fn search_fast(&mut self, idle: bool) -> Result<RingFrame<'_>, NoFrame> {
        let (mut start, all) = self.healed();
        let mut used = all;
        let mut sums = Sums::default();
        loop {
            match self.judge_fast(start, used) {
                Ok((opcode, size)) if sums.prove(self, start, used, opcode, size) => {
                    return Ok(self.take_out(start, used, opcode, size));
                }
                Err(NoFrame::Waiting) if !idle || used == 0 => break,
                Ok(_) | Err(_) => {}
            }
            (start, used) = (wrap(start.wrapping_add(1)), used.wrapping_sub(1));
        }
        (self.start, self.used) = (int(start), int(used));
        Err(if used == all { NoFrame::Waiting } else { NoFrame::Garbage })
    }

    /// What [`judge`](Ring::judge) does but for the checksum, which costs much and can be left for what else is right.
    #[inline(always)]
    fn judge_fast(&self, start: usize, used: usize) -> Judgement {
        if used == 0 {
            return Err(NoFrame::Waiting);
        }
        if self.byte(start) != FRAME_START {
            return Err(NoFrame::Garbage);
        }
        if used == 1 {
            return Err(NoFrame::Waiting);
        }
        let opcode = self.byte(start.wrapping_add(1));
        if entry(&NEEDS.by_opcode, opcode) == WRONG_OPCODE {
            return Err(NoFrame::Garbage);
        }
        let size = entry(&NEEDS.by_length, self.byte(start.wrapping_add(2))) as usize;
        if used < size {
            Err(NoFrame::Waiting)
        } else if size >= FRAME_OVERHEAD && self.byte(start.wrapping_add(size).wrapping_sub(1)) == FRAME_END {
            Ok((Opcode(opcode), size))
        } else {
            Err(NoFrame::Garbage)
        }
    }

    /// Takes the frame at `start` out of the ring, which has `used` bytes from there on.
    #[inline(always)]
    fn take_out(&mut self, start: usize, used: usize, opcode: Opcode, size: usize) -> RingFrame<'_> {
        let length = size.wrapping_sub(FRAME_OVERHEAD);
        (self.start, self.used) = (int(wrap(start.wrapping_add(size))), int(used.wrapping_sub(size)));
        RingFrame {
            opcode,
            payload: Payload { ring: &self.bytes, begin: wrap(start.wrapping_add(FRAME_HEAD)), length },
        }
    }

    /// Whether the checksum of a complete candidate is right.
    #[inline(always)]
    pub(super) fn is_right(&self, start: usize, opcode: Opcode, size: usize) -> bool {
        match self.bytes.get(start..start.wrapping_add(size)) {
            Some(candidate) => summed(candidate, opcode).is_some(),
            None => self.is_right_across(start, opcode, size),
        }
    }

    #[inline(never)]
    fn is_right_across(&self, start: usize, opcode: Opcode, size: usize) -> bool {
        let length = size.wrapping_sub(FRAME_OVERHEAD);
        let begin = wrap(start.wrapping_add(FRAME_HEAD));
        let (first, rest) = pieces(&self.bytes, begin, length);
        self.byte(begin.wrapping_add(length)) == bytes::add_up(bytes::add_up(sum_of_head(opcode, length), first), rest)
    }

    /// Passes over the byte at the start, known to begin no frame, and over what is garbage behind it, as far as no
    /// checksum is needed for that. Where one is, it has changed nothing, and tells how many bytes are to be
    /// [skipped](Self::skip), and the opcode and size of what stands behind them. `None` when there are more bytes than
    /// a ring has.
    #[inline(always)]
    pub fn pass(&mut self) -> Option<Result<(usize, Opcode, usize), NoFrame>> {
        let all = self.used.cast_unsigned() as usize;
        if all > DP_BUFSIZE {
            return None;
        }
        let (mut start, mut used) = (wrap((self.start.cast_unsigned() as usize).wrapping_add(1)), all.wrapping_sub(1));
        loop {
            match self.judge_fast(start, used) {
                Ok((opcode, size)) => return Some(Ok((all.wrapping_sub(used), opcode, size))),
                Err(NoFrame::Waiting) => break,
                Err(NoFrame::Garbage) => {}
            }
            (start, used) = (wrap(start.wrapping_add(1)), used.wrapping_sub(1));
        }
        (self.start, self.used) = (int(start), int(used));
        Some(Err(NoFrame::Garbage))
    }

    /// Drops bytes from the ring's start, and tells where it starts now.
    #[inline(always)]
    pub fn skip(&mut self, passed: usize) -> usize {
        let start = wrap((self.start.cast_unsigned() as usize).wrapping_add(passed));
        (self.start, self.used) = (int(start), self.used.wrapping_sub(int(passed)));
        start
    }
}

/// What start, opcode, length and end of a frame add to its checksum.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the length is a byte of the frame")]
const fn sum_of_head(opcode: Opcode, length: usize) -> u8 {
    const { FRAME_START.wrapping_add(FRAME_END) }.wrapping_add(opcode.0).wrapping_add(length as u8)
}

/// The payload of a candidate in one piece that begins as a frame does, if it ends so and its checksum is right.
#[inline(always)]
pub(super) fn intact(candidate: &[u8], opcode: Opcode) -> Option<&[u8]> {
    if candidate.last() == Some(&FRAME_END) { summed(candidate, opcode) } else { None }
}

/// The same, whatever it ends with.
#[inline(always)]
fn summed(candidate: &[u8], opcode: Opcode) -> Option<&[u8]> {
    let (summed, &[sum, _]) = candidate.split_last_chunk()?;
    let (_, payload) = summed.split_first_chunk::<FRAME_HEAD>()?;
    // The length was looked at before. Here the compiler learns that it is no larger.
    let is_right =
        payload.len() <= DP_DATA_MAX_SIZE && sum == bytes::add_up(sum_of_head(opcode, payload.len()), payload);
    is_right.then_some(payload)
}
