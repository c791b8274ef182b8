//! The ring that bytes from the wire wait in, and the search for frames in it.

use core::ffi::c_int;
use core::mem::{align_of, offset_of, size_of};

use super::frame::{FRAME_END, FRAME_HEAD, FRAME_OVERHEAD, FRAME_START, Frame, Payload, checksum};
use super::Opcode;
use crate::config::{DP_BUFSIZE, DP_DATA_MAX_SIZE};

/// A byte of the ring; C calls it `char`.
pub type RingByte = u8;

/// A ring buffer for bytes from the wire; all zero is an empty one.
///
/// The fields can be read at any time. They are never trusted: a ring whose `m_idx` or `m_sz` is out of range counts as
/// empty, so an uninitialised one does no harm.
///
/// cbindgen:field-names=[m_buf, m_idx, m_sz]
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Ring {
    /// Storage of the ring.
    bytes: [RingByte; DP_BUFSIZE],
    /// Where the first unread byte is, 0 to `DP_BUFSIZE` - 1.
    start: c_int,
    /// Number of unread bytes, 0 to `DP_BUFSIZE`.
    used: c_int,
}

// The layout of C's struct; C tests assert the same numbers.
const _: () = {
    const INT: usize = size_of::<c_int>();
    const STORAGE: usize = DP_BUFSIZE.next_multiple_of(align_of::<c_int>());
    assert!(offset_of!(Ring, bytes) == 0);
    assert!(offset_of!(Ring, start) == STORAGE);
    assert!(offset_of!(Ring, used) == STORAGE + INT);
    assert!(size_of::<Ring>() == STORAGE + 2 * INT && align_of::<Ring>() == align_of::<c_int>());
};

/// Bytes were lost for want of room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overflow;

/// Why there is no frame: more bytes are needed, and...
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoFrame {
    /// ...all that are there may be part of a frame.
    Waiting,
    /// ...some that can't be part of a frame were thrown away.
    Garbage,
}

/// What stands at a place in the ring.
enum Candidate {
    /// A frame, this long its payload.
    Intact(usize),
    /// The beginning of a frame, or nothing at all.
    Incomplete,
    /// A byte no frame begins with.
    Garbage,
}

impl Ring {
    /// An empty ring.
    #[must_use]
    pub const fn new() -> Self {
        Self { bytes: [0; DP_BUFSIZE], start: 0, used: 0 }
    }

    /// Number of bytes that fit without loss.
    #[must_use]
    pub fn room(&self) -> usize {
        DP_BUFSIZE.wrapping_sub(self.position().1)
    }

    /// Adds bytes at the end. Where they don't fit, the oldest make room for them; of more bytes than the whole ring
    /// holds the first are taken.
    ///
    /// # Errors
    ///
    /// [`Overflow`] when a byte was lost, old or new.
    #[inline(always)]
    pub fn append(&mut self, input: &[u8]) -> Result<(), Overflow> {
        let (start, used) = self.position();
        let taken = input.get(..DP_BUFSIZE).unwrap_or(input);
        let lost = used.wrapping_add(taken.len()).saturating_sub(DP_BUFSIZE);

        let end = wrap(start.wrapping_add(used));
        let (front, back) = self.bytes.split_at_mut_checked(end).unwrap_or_default();
        let (first, rest) = taken.split_at_checked(back.len()).unwrap_or((taken, &[]));
        for (place, byte) in back.iter_mut().zip(first) {
            *place = *byte;
        }
        for (place, byte) in front.iter_mut().zip(rest) {
            *place = *byte;
        }
        self.set_position(wrap(start.wrapping_add(lost)), used.wrapping_add(taken.len()).wrapping_sub(lost));
        if lost == 0 && taken.len() == input.len() { Ok(()) } else { Err(Overflow) }
    }

    /// Takes the next frame out of the ring. An incomplete one at the start is waited for, never overtaken by one
    /// that stands inside it; after bytes that turn out to be no frame the search goes on right behind the first.
    ///
    /// # Errors
    ///
    /// [`NoFrame`] when more bytes are needed.
    #[inline(always)]
    pub fn next_frame(&mut self) -> Result<Frame<'_>, NoFrame> {
        self.search(false)
    }

    /// Like [`next_frame`](Self::next_frame) for a line that has been quiet for longer than a frame takes: what is
    /// incomplete will never be complete, so it is passed over.
    ///
    /// # Errors
    ///
    /// [`NoFrame`] when there is no frame in the ring, which is empty now.
    pub fn next_frame_idle(&mut self) -> Result<Frame<'_>, NoFrame> {
        self.search(true)
    }

    #[inline(always)]
    fn search(&mut self, idle: bool) -> Result<Frame<'_>, NoFrame> {
        let (mut start, mut used) = self.position();
        let before = used;
        loop {
            match self.candidate(start, used) {
                Candidate::Intact(length) => {
                    let opcode = Opcode(self.byte(start, 1));
                    let frame = length.wrapping_add(FRAME_OVERHEAD);
                    self.set_position(wrap(start.wrapping_add(frame)), used.wrapping_sub(frame));
                    return Ok(Frame { opcode, payload: self.payload(start, length) });
                }
                Candidate::Incomplete if !idle || used == 0 => break,
                Candidate::Incomplete | Candidate::Garbage => {
                    start = wrap(start.wrapping_add(1));
                    used = used.wrapping_sub(1);
                }
            }
        }
        if used == before {
            return Err(NoFrame::Waiting);
        }
        self.set_position(start, used);
        Err(NoFrame::Garbage)
    }

    /// Judges what stands at `start`, with `used` bytes there in all. A candidate is given up as soon as a byte of it
    /// is wrong, so that what follows it is not waited for in vain.
    #[inline(always)]
    fn candidate(&self, start: usize, used: usize) -> Candidate {
        if used == 0 {
            return Candidate::Incomplete;
        }
        if self.byte(start, 0) != FRAME_START {
            return Candidate::Garbage;
        }
        if used < 2 {
            return Candidate::Incomplete;
        }
        let opcode = Opcode(self.byte(start, 1));
        if !opcode.is_known() {
            return Candidate::Garbage;
        }
        if used < FRAME_HEAD {
            return Candidate::Incomplete;
        }
        let length = self.byte(start, 2);
        let payload = usize::from(length);
        if payload > DP_DATA_MAX_SIZE {
            return Candidate::Garbage;
        }
        if used < payload.wrapping_add(FRAME_OVERHEAD) {
            return Candidate::Incomplete;
        }
        if self.byte(start, payload.wrapping_add(4)) == FRAME_END
            && self.byte(start, payload.wrapping_add(3)) == checksum(opcode, length, self.payload(start, payload))
        {
            Candidate::Intact(payload)
        } else {
            Candidate::Garbage
        }
    }

    /// The payload of `length` bytes of the frame at `start`.
    #[inline(always)]
    fn payload(&self, start: usize, length: usize) -> Payload<'_> {
        let begin = wrap(start.wrapping_add(FRAME_HEAD));
        let (before, behind) = self.bytes.split_at_checked(begin).unwrap_or_default();
        match behind.get(..length) {
            Some(front) => Payload { front, back: &[] },
            None => Payload {
                front: behind,
                back: before.get(..length.wrapping_sub(behind.len())).unwrap_or_default(),
            },
        }
    }

    /// The byte `offset` behind the place `start`; both are below the ring's size.
    #[inline(always)]
    fn byte(&self, start: usize, offset: usize) -> u8 {
        self.bytes.get(wrap(start.wrapping_add(offset))).copied().unwrap_or_default()
    }

    /// Where the unread bytes start and how many they are; fields out of range are an empty ring's.
    #[inline(always)]
    fn position(&self) -> (usize, usize) {
        match (usize::try_from(self.start), usize::try_from(self.used)) {
            (Ok(start), Ok(used)) if start < DP_BUFSIZE && used <= DP_BUFSIZE => (start, used),
            _ => (0, 0),
        }
    }

    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        reason = "neither is above DP_BUFSIZE, which fits: src/config.rs"
    )]
    fn set_position(&mut self, start: usize, used: usize) {
        self.start = start as c_int;
        self.used = used as c_int;
    }
}

impl Default for Ring {
    fn default() -> Self {
        Self::new()
    }
}

/// A place that may be past the ring's end, by less than its size.
#[inline(always)]
const fn wrap(place: usize) -> usize {
    if DP_BUFSIZE.is_power_of_two() {
        place & DP_BUFSIZE.wrapping_sub(1)
    } else if place >= DP_BUFSIZE {
        place.wrapping_sub(DP_BUFSIZE)
    } else {
        place
    }
}
