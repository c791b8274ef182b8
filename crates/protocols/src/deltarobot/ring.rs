//! The ring that bytes from the wire wait in, and the search for frames in it.

use core::ffi::c_int;
use core::mem::{align_of, offset_of, size_of};

use super::NoFrame;
use super::Opcode;
use super::frame::{FRAME_END, FRAME_HEAD, FRAME_OVERHEAD, FRAME_START, Place};
use crate::bytes;
use crate::config::{DP_BUFSIZE, DP_DATA_MAX_SIZE, FAST};

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
    pub(super) bytes: [RingByte; DP_BUFSIZE],
    /// Where the first unread byte is, 0 to `DP_BUFSIZE` - 1.
    pub(super) start: c_int,
    /// Number of unread bytes, 0 to `DP_BUFSIZE`.
    pub(super) used: c_int,
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

/// Bytes of the longest frame.
pub const FRAME_MAX: usize = DP_DATA_MAX_SIZE.wrapping_add(FRAME_OVERHEAD);

/// A frame that was found intact, seen where it lies in the ring.
#[derive(Clone, Copy, Debug)]
pub struct RingFrame<'a> {
    /// What the frame is: always a known opcode.
    pub opcode: Opcode,
    /// What it carries, at most [`DP_DATA_MAX_SIZE`] bytes.
    pub payload: Payload<'a>,
}

/// The payload of a received frame, which may lie across the ring's end.
#[derive(Clone, Copy, Debug)]
pub struct Payload<'a> {
    pub(super) ring: &'a [u8; DP_BUFSIZE],
    pub(super) begin: usize,
    pub(super) length: usize,
}

impl Payload<'_> {
    /// Number of bytes.
    #[inline]
    #[must_use]
    pub const fn len(&self) -> usize {
        self.length
    }

    /// Whether there is no payload.
    #[inline]
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// The bytes in their order.
    #[inline(always)]
    pub fn iter(&self) -> impl Iterator<Item = u8> {
        (0..self.length).map(|offset| self.ring.get(wrap(self.begin.wrapping_add(offset))).copied().unwrap_or_default())
    }

    /// Copies as many bytes as fit, and leaves the rest of `out` as it is.
    #[inline(always)]
    pub fn copy_to<P: Place>(&self, out: &mut [P]) {
        if FAST {
            if let Some(payload) = self.ring.get(self.begin..self.begin.wrapping_add(self.length)) {
                return bytes::copy(payload, out, P::of);
            }
            let (first, rest) = pieces(self.ring, self.begin, self.length);
            bytes::copy(first, out, P::of);
            return bytes::copy(rest, out.get_mut(first.len()..).unwrap_or_default(), P::of);
        }
        for (place, byte) in out.iter_mut().zip(self.iter()) {
            *place = P::of(byte);
        }
    }
}

/// Bytes were lost for want of room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overflow;

impl Ring {
    /// An empty ring.
    #[must_use]
    pub const fn new() -> Self {
        Self { bytes: [0; DP_BUFSIZE], start: 0, used: 0 }
    }

    /// Makes it all zero, whatever it was.
    pub fn clear(&mut self) {
        for byte in &mut self.bytes {
            *byte = 0;
        }
        (self.start, self.used) = (0, 0);
    }

    /// Number of bytes that fit without loss.
    #[must_use]
    pub fn room(&self) -> usize {
        if self.is_sound() { DP_BUFSIZE.wrapping_sub(self.used.cast_unsigned() as usize) } else { DP_BUFSIZE }
    }

    /// Adds bytes at the end. Where they don't fit, the oldest make room for them; of more bytes than the whole ring
    /// holds the first are taken.
    ///
    /// # Errors
    ///
    /// [`Overflow`] when a byte was lost, old or new.
    #[inline(always)]
    pub fn append(&mut self, input: &[u8]) -> Result<(), Overflow> {
        let (start, used) = self.healed();
        let mut end = wrap(start.wrapping_add(used));
        let taken = input.get(..DP_BUFSIZE).unwrap_or(input);
        if FAST {
            let (front, back) = self.bytes.split_at_mut_checked(end).unwrap_or_default();
            match taken.split_at_checked(back.len()) {
                None => bytes::copy(taken, back, |byte| byte),
                Some((first, rest)) => {
                    bytes::copy(first, back, |byte| byte);
                    bytes::copy(rest, front, |byte| byte);
                }
            }
            end = wrap(end.wrapping_add(taken.len()));
        } else {
            for byte in taken {
                if let Some(place) = self.bytes.get_mut(end) {
                    *place = *byte;
                }
                end = wrap(end.wrapping_add(1));
            }
        }
        let wanted = used.wrapping_add(input.len());
        if wanted > DP_BUFSIZE {
            // A full ring starts where it ends.
            (self.start, self.used) = (int(end), const { int(DP_BUFSIZE) });
            return Err(Overflow);
        }
        self.used = int(wanted);
        Ok(())
    }

    /// Takes the next frame out of the ring. An incomplete one at the start is waited for, never overtaken by one
    /// that stands inside it; after bytes that turn out to be no frame the search goes on right behind the first.
    ///
    /// # Errors
    ///
    /// [`NoFrame`] when more bytes are needed.
    pub fn next_frame(&mut self) -> Result<RingFrame<'_>, NoFrame> {
        self.search(false)
    }

    /// Like [`next_frame`](Self::next_frame) for a line that has been quiet for longer than a frame takes: what is
    /// incomplete will never be complete, so it is passed over.
    ///
    /// # Errors
    ///
    /// [`NoFrame`] when there is no frame in the ring, which is empty now.
    pub fn next_frame_idle(&mut self) -> Result<RingFrame<'_>, NoFrame> {
        self.search(true)
    }

    /// Looks for the next frame.
    #[inline(always)]
    pub fn search(&mut self, idle: bool) -> Result<RingFrame<'_>, NoFrame> {
        if FAST {
            return self.search_fast(idle);
        }
        let mut none = NoFrame::Waiting;
        let (mut start, mut used) = self.healed();
        loop {
            let candidate = self.judge(start, used);
            let begin = wrap(start.wrapping_add(FRAME_HEAD));
            let taken = match candidate {
                Err(NoFrame::Waiting) if !idle || used == 0 => return Err(none),
                Err(_) => 1,
                Ok((_, length)) => length.wrapping_add(FRAME_OVERHEAD),
            };
            start = wrap(start.wrapping_add(taken));
            used = used.wrapping_sub(taken);
            (self.start, self.used) = (int(start), int(used));
            if let Ok((opcode, length)) = candidate {
                return Ok(RingFrame { opcode, payload: Payload { ring: &self.bytes, begin, length } });
            }
            none = NoFrame::Garbage;
        }
    }

    /// Judges what stands at `start`, with `used` bytes there in all. A candidate is given up as soon as a byte of it
    /// is wrong, so that what follows it is not waited for in vain. A frame's opcode and the length of its payload.
    #[inline(always)]
    fn judge(&self, start: usize, used: usize) -> Result<(Opcode, usize), NoFrame> {
        if used == 0 {
            return Err(NoFrame::Waiting);
        }
        if self.byte(start) != FRAME_START {
            return Err(NoFrame::Garbage);
        }
        if used == 1 {
            return Err(NoFrame::Waiting);
        }
        let opcode = Opcode(self.byte(start.wrapping_add(1)));
        if !opcode.is_known() {
            return Err(NoFrame::Garbage);
        }
        if used == 2 {
            return Err(NoFrame::Waiting);
        }
        let length = usize::from(self.byte(start.wrapping_add(2)));
        if length > DP_DATA_MAX_SIZE {
            return Err(NoFrame::Garbage);
        }
        let size = length.wrapping_add(FRAME_OVERHEAD);
        if used < size {
            return Err(NoFrame::Waiting);
        }
        if self.is_intact(start, size) { Ok((opcode, length)) } else { Err(NoFrame::Garbage) }
    }

    /// Whether the frame of `size` bytes at `start` ends as it should.
    #[inline(always)]
    fn is_intact(&self, start: usize, size: usize) -> bool {
        // A byte is summed when two more were read: so the last two, checksum and end, are not.
        let (mut sum, mut before, mut last) = (FRAME_END, 0_u8, 0_u8);
        for offset in 0..size {
            sum = sum.wrapping_add(before);
            before = last;
            last = self.byte(start.wrapping_add(offset));
        }
        before == sum && last == FRAME_END
    }

    #[inline(always)]
    pub(super) fn byte(&self, place: usize) -> u8 {
        self.bytes.get(wrap(place)).copied().unwrap_or_default()
    }

    /// Where the unread bytes start and how many they are. Fields out of range become an empty ring's.
    #[inline(always)]
    pub(super) fn healed(&mut self) -> (usize, usize) {
        if !self.is_sound() {
            (self.start, self.used) = (0, 0);
        }
        (self.start.cast_unsigned() as usize, self.used.cast_unsigned() as usize)
    }

    #[inline(always)]
    const fn is_sound(&self) -> bool {
        (self.start.cast_unsigned() as usize) < DP_BUFSIZE && self.used.cast_unsigned() as usize <= DP_BUFSIZE
    }
}

impl Default for Ring {
    fn default() -> Self {
        Self::new()
    }
}

/// A place that may be past the ring's end, by less than its size.
#[inline(always)]
pub(super) const fn wrap(place: usize) -> usize {
    if DP_BUFSIZE.is_power_of_two() {
        place & DP_BUFSIZE.wrapping_sub(1)
    } else if place >= DP_BUFSIZE {
        place.wrapping_sub(DP_BUFSIZE)
    } else {
        place
    }
}

/// A place or a number of bytes in the ring, as C has it.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "at most DP_BUFSIZE, which an int holds"
)]
pub(super) const fn int(bytes: usize) -> c_int {
    bytes as c_int
}

/// The part of the ring that begins there, in the order it is read in: two pieces when it lies across the ring's end.
#[inline(always)]
pub(super) fn pieces(ring: &[u8; DP_BUFSIZE], begin: usize, length: usize) -> (&[u8], &[u8]) {
    let (front, back) = ring.split_at_checked(begin).unwrap_or_default();
    match back.get(..length) {
        Some(whole) => (whole, &[]),
        None => (back, front.get(..length.wrapping_sub(back.len())).unwrap_or_default()),
    }
}
