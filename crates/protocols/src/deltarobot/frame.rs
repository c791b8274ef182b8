//! The grammar of frames: `$`, opcode, length, payload, checksum, `:` (specification, section "Message Frame
//! Structure"). The checksum is the sum modulo 256 of all bytes of the frame but itself (section "Checksum
//! Calculation").

use core::mem::MaybeUninit;

use super::Opcode;
use crate::bytes::{self, Bytes};

/// The first byte of every frame.
pub const FRAME_START: u8 = b'$';
/// The last byte of every frame.
pub const FRAME_END: u8 = b':';
/// Bytes of a frame before its payload: start, opcode, length.
pub const FRAME_HEAD: usize = 3;
/// Bytes of a frame that are not payload: the head, checksum and end. The shortest frame has no more.
pub const FRAME_OVERHEAD: usize = 5;

/// A frame that was found intact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// What the frame is: always a known opcode.
    pub opcode: Opcode,
    /// What it carries.
    pub payload: &'a [u8],
}

/// What stands at a place in a stream of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It may be a frame: to decide takes so many bytes, counted from the place.
    Needs(usize),
    /// A frame of `length + FRAME_OVERHEAD` bytes, of which `length` are payload.
    Frame {
        /// What the frame is.
        opcode: Opcode,
        /// Bytes of its payload.
        length: usize,
    },
    /// No frame starts there.
    Fault(Fault),
}

/// Why no frame starts at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The byte is not [`FRAME_START`].
    Start,
    /// The opcode is unknown.
    Opcode,
    /// The payload would be too long.
    Length,
    /// The byte behind the checksum is not [`FRAME_END`].
    End,
    /// All is right but the checksum.
    Checksum,
}

/// Why there is no frame to deliver: more bytes are needed, and...
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoFrame {
    /// ...all that are there may be part of a frame.
    Waiting,
    /// ...some that can't be part of a frame were thrown away.
    Garbage,
}

/// Judges what the bytes begin with, where a payload has at most `longest` bytes. A candidate is given up as soon as a
/// byte of it is wrong; but for its checksum, which costs much and is looked at when all else is right.
///
/// ```
/// use deltarobot_protocols::deltarobot::{Fault, Opcode, Verdict, judge};
///
/// let judge = |bytes: &[u8]| judge(bytes, 32);
/// assert_eq!(judge(b"$"), Verdict::Needs(5));
/// assert_eq!(judge(b"$A\x01M"), Verdict::Needs(6));
/// assert_eq!(judge(b"$A\x01M\xED:..."), Verdict::Frame { opcode: Opcode::ACK, length: 1 });
/// assert_eq!(judge(b"$A\x01M\xEE:"), Verdict::Fault(Fault::Checksum));
/// assert_eq!(judge(b"$a"), Verdict::Fault(Fault::Opcode));
/// ```
#[inline(always)]
pub fn judge<B: Bytes + ?Sized>(bytes: &B, longest: usize) -> Verdict {
    match judge_head(bytes, longest) {
        Verdict::Frame { opcode, length } => judge_tail(bytes, opcode, length),
        verdict => verdict,
    }
}

/// The first half of [`judge`]: whether the bytes begin as a frame does, and as many are there as that takes.
#[inline(always)]
pub fn judge_head<B: Bytes + ?Sized>(bytes: &B, longest: usize) -> Verdict {
    // Bytes that are not there yet may be anything: what is wrong with them is no fault, and when nothing is, there are
    // too few to decide.
    let have = bytes.len();
    if bytes.byte(0) != FRAME_START {
        return if have > 0 { Verdict::Fault(Fault::Start) } else { Verdict::Needs(FRAME_OVERHEAD) };
    }
    let (place, fault) = 'fault: {
        let opcode = Opcode(bytes.byte(1));
        if !opcode.is_known() {
            break 'fault (1, Fault::Opcode);
        }
        let length = usize::from(bytes.byte(2));
        if length > longest {
            break 'fault (2, Fault::Length);
        }
        let size = length.wrapping_add(FRAME_OVERHEAD);
        if have < size {
            return Verdict::Needs(if have < FRAME_HEAD { FRAME_OVERHEAD } else { size });
        }
        return Verdict::Frame { opcode, length };
    };
    if have > place { Verdict::Fault(fault) } else { Verdict::Needs(FRAME_OVERHEAD) }
}

/// The second half: whether what begins as a frame ends as one.
#[inline(always)]
pub fn judge_tail<B: Bytes + ?Sized>(bytes: &B, opcode: Opcode, length: usize) -> Verdict {
    let place_of_sum = length.wrapping_add(FRAME_HEAD);
    if bytes.byte(place_of_sum.wrapping_add(1)) != FRAME_END {
        return Verdict::Fault(Fault::End);
    }
    let sum = bytes.add_up(sum_of_head(opcode, length), FRAME_HEAD, length);
    if bytes.byte(place_of_sum) != sum {
        return Verdict::Fault(Fault::Checksum);
    }
    Verdict::Frame { opcode, length }
}

/// What start, opcode, length and end of a frame add to its checksum.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the length is a byte of the frame")]
const fn sum_of_head(opcode: Opcode, length: usize) -> u8 {
    const { FRAME_START.wrapping_add(FRAME_END) }.wrapping_add(opcode.0).wrapping_add(length as u8)
}

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

/// Writes the frame of `opcode` and `payload` to the beginning of `out` and returns its length in bytes; `None` when it
/// does not fit or the payload is longer than 255 bytes. The opcode is not checked.
#[inline(always)]
pub fn encode<P: Place>(opcode: Opcode, payload: &[u8], out: &mut [P]) -> Option<usize> {
    let length = u8::try_from(payload.len()).ok()?;
    let [place_of_start, place_of_opcode, place_of_length, rest @ ..] = out else { return None };
    (*place_of_start, *place_of_opcode, *place_of_length) = (P::of(FRAME_START), P::of(opcode.0), P::of(length));
    let mut sum = sum_of_head(opcode, payload.len());
    let (places, behind) = rest.split_at_mut_checked(payload.len())?;
    let [place_of_sum, place_of_end, ..] = behind else { return None };
    sum = bytes::copy_and_add_up(sum, payload, places, P::of);
    (*place_of_sum, *place_of_end) = (P::of(sum), P::of(FRAME_END));
    Some(payload.len().wrapping_add(FRAME_OVERHEAD))
}
