//! One frame: `$`, opcode, length, payload, checksum, `:` (specification, section "Message Frame Structure").
//!
//! The checksum is the sum modulo 256 of all bytes of the frame but itself (section "Checksum Calculation").

use core::mem::MaybeUninit;

use super::{Opcode, bytes, ring};
use crate::config::{DP_BUFSIZE, DP_DATA_MAX_SIZE, FAST};

/// The first byte of every frame.
pub const FRAME_START: u8 = b'$';
/// The last byte of every frame.
pub const FRAME_END: u8 = b':';
/// Bytes of a frame before its payload: start, opcode, length.
pub const FRAME_HEAD: usize = 3;
/// Bytes of a frame that are not payload: the head, checksum and end.
pub const FRAME_OVERHEAD: usize = 5;
/// Bytes of the longest frame.
pub const FRAME_MAX: usize = DP_DATA_MAX_SIZE.wrapping_add(FRAME_OVERHEAD);

/// A byte of the memory that frames and payloads are written to, which need not be initialised.
pub trait Place: Copy {
    /// That byte, in such memory.
    fn of(byte: u8) -> Self;
}

impl Place for u8 {
    #[inline(always)]
    fn of(byte: u8) -> Self {
        byte
    }
}

impl Place for MaybeUninit<u8> {
    #[inline(always)]
    fn of(byte: u8) -> Self {
        Self::new(byte)
    }
}

/// A frame that was found intact, seen where it lies in the ring.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
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
        (0..self.length).map(|offset| {
            self.ring.get(super::ring::wrap(self.begin.wrapping_add(offset))).copied().unwrap_or_default()
        })
    }

    /// Copies as many bytes as fit, and leaves the rest of `out` as it is.
    #[inline(always)]
    pub fn copy_to<P: Place>(&self, out: &mut [P]) {
        if FAST {
            if let Some(payload) = self.ring.get(self.begin..self.begin.wrapping_add(self.length)) {
                return bytes::copy(payload, out, P::of);
            }
            let (first, rest) = ring::pieces(self.ring, self.begin, self.length);
            bytes::copy(first, out, P::of);
            return bytes::copy(rest, out.get_mut(first.len()..).unwrap_or_default(), P::of);
        }
        for (place, byte) in out.iter_mut().zip(self.iter()) {
            *place = P::of(byte);
        }
    }
}

/// Writes the frame of `opcode` and `payload` to the beginning of `out` and tells its length in bytes, 5 to
/// [`FRAME_MAX`]; `None` when it does not fit or the payload is longer than [`DP_DATA_MAX_SIZE`].
#[inline(always)]
pub fn encode<P: Place>(opcode: Opcode, payload: &[u8], out: &mut [P]) -> Option<usize> {
    let length = u8::try_from(payload.len()).ok().filter(|_| payload.len() <= DP_DATA_MAX_SIZE)?;
    let [place_of_start, place_of_opcode, place_of_length, rest @ ..] = out else { return None };
    (*place_of_start, *place_of_opcode, *place_of_length) = (P::of(FRAME_START), P::of(opcode.0), P::of(length));
    let mut sum = const { FRAME_START.wrapping_add(FRAME_END) }.wrapping_add(opcode.0).wrapping_add(length);
    let (places, behind) = rest.split_at_mut_checked(payload.len())?;
    let [place_of_sum, place_of_end, ..] = behind else { return None };
    if FAST {
        // Most frames have none.
        if !payload.is_empty() {
            sum = bytes::add_up(sum, payload);
            bytes::copy(payload, places, P::of);
        }
    } else {
        for (place, byte) in places.iter_mut().zip(payload) {
            *place = P::of(*byte);
            sum = sum.wrapping_add(*byte);
        }
    }
    (*place_of_sum, *place_of_end) = (P::of(sum), P::of(FRAME_END));
    Some(payload.len().wrapping_add(FRAME_OVERHEAD))
}
