//! One frame: `$`, opcode, length, payload, checksum, `:` (specification, section "Message Frame Structure").

use core::mem::MaybeUninit;

use super::Opcode;
use crate::config::DP_DATA_MAX_SIZE;

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

/// A frame that was found intact, seen where it lies in the ring.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// What the frame is: always a known opcode.
    pub opcode: Opcode,
    /// What it carries, at most [`DP_DATA_MAX_SIZE`] bytes.
    pub payload: Payload<'a>,
}

/// The payload of a received frame: two slices, since it may lie across the ring's end.
#[derive(Clone, Copy, Debug)]
pub struct Payload<'a> {
    pub(super) front: &'a [u8],
    pub(super) back: &'a [u8],
}

impl Payload<'_> {
    /// Number of bytes.
    #[inline]
    #[must_use]
    pub const fn len(&self) -> usize {
        // Both are parts of one ring: the sum is at most its size.
        self.front.len().wrapping_add(self.back.len())
    }

    /// Whether there is no payload.
    #[inline]
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The bytes in their order.
    pub fn iter(&self) -> impl Iterator<Item = u8> {
        self.front.iter().chain(self.back).copied()
    }

    /// Copies as many bytes as fit, and leaves the rest of `out` as it is.
    #[inline]
    pub fn copy_to(&self, out: &mut [MaybeUninit<u8>]) {
        // Two plain loops: a chained iterator would cost a branch for each byte.
        let mut out = out.iter_mut();
        for (to, &from) in self.front.iter().zip(&mut out).map(|(from, to)| (to, from)) {
            to.write(from);
        }
        for (&from, to) in self.back.iter().zip(out) {
            to.write(from);
        }
    }
}

/// Sum modulo 256 of a frame's bytes other than the checksum itself (specification, section "Checksum
/// Calculation"): `$` and `:` are part of it.
#[inline(always)]
pub(super) fn checksum(opcode: Opcode, length: u8, payload: Payload<'_>) -> u8 {
    let mut sum = const { FRAME_START.wrapping_add(FRAME_END) }.wrapping_add(opcode.0).wrapping_add(length);
    for byte in payload.front {
        sum = sum.wrapping_add(*byte);
    }
    for byte in payload.back {
        sum = sum.wrapping_add(*byte);
    }
    sum
}

/// Writes the frame of `opcode` and `payload` to the beginning of `out` and tells its length in bytes, 5 to
/// [`FRAME_MAX`]; `None` when the payload is longer than [`DP_DATA_MAX_SIZE`].
#[inline(always)]
pub fn encode(opcode: Opcode, payload: &[u8], out: &mut [MaybeUninit<u8>; FRAME_MAX]) -> Option<usize> {
    let length = u8::try_from(payload.len()).ok().filter(|_| payload.len() <= DP_DATA_MAX_SIZE)?;
    let sum = checksum(opcode, length, Payload { front: payload, back: &[] });
    let mut places = out.iter_mut();
    for byte in [FRAME_START, opcode.0, length] {
        places.next()?.write(byte);
    }
    for (byte, place) in payload.iter().zip(&mut places) {
        place.write(*byte);
    }
    for byte in [sum, FRAME_END] {
        places.next()?.write(byte);
    }
    Some(payload.len().wrapping_add(FRAME_OVERHEAD))
}
