//! The receiver of frames: a buffer of one maximal frame.

use core::cell::Cell;

use zerocopy::{FromBytes, Immutable, KnownLayout};

use super::frame::{FRAME_HEAD, FRAME_OVERHEAD, FRAME_START, Frame, NoFrame, Verdict, judge};
use super::{Fault, Opcode};
use crate::bytes;

/// Bytes that fit behind a maximal frame that was not fetched yet.
const SPARE: usize = 5;

/// The parameter of a [`Receiver`] of frames with payloads of at most `longest` bytes, 1 to 255.
pub const fn receiver_room(longest: usize) -> usize {
    longest.wrapping_add(const { FRAME_OVERHEAD.wrapping_add(SPARE) })
}

/// A receiver of frames, with a buffer of `ROOM` bytes: see [`receiver_room`].
///
/// Bytes are stored, and judged only when as many are there as a judgement needs. Every intact frame is found: behind
/// a byte that begins none, the search goes on with the next one; what may become a frame is waited for, and never
/// overtaken by a frame that stands inside it.
///
/// Any contents are safe, and all zero is a new receiver.
///
/// ```
/// use deltarobot_protocols::deltarobot::{Frame, Opcode, Receiver, receiver_room};
///
/// let mut receiver = Receiver::<{ receiver_room(32) }>::new();
/// for byte in *b"noise$A\x01M\xED:" {
///     if receiver.byte(byte).unwrap() {
///         while let Ok(frame) = receiver.next() {
///             assert_eq!(frame, Frame { opcode: Opcode::ACK, payload: b"M" });
///         }
///     }
/// }
/// ```
#[derive(Clone, Debug, FromBytes, Immutable, KnownLayout)]
pub struct Receiver<const ROOM: usize> {
    /// How many bytes are in the buffer.
    have: Count,
    /// One less than `have` must be for the next look.
    last: Count,
    /// Where in the buffer the unread ones begin.
    at: Count,
    buffer: [u8; ROOM],
}

/// There is no room for the byte, which was not taken: frames have to be fetched first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;

/// Learns what a receiver throws away; `()` is not interested, which costs nothing.
pub trait Observer {
    /// So many bytes belong to no frame.
    fn skipped(&mut self, bytes: usize);
    /// A frame was whole but for its checksum. Its bytes are skipped too.
    fn bad_checksum(&mut self);
}

impl Observer for () {
    #[inline(always)]
    fn skipped(&mut self, _: usize) {}
    #[inline(always)]
    fn bad_checksum(&mut self) {}
}

/// A frame in the buffer: what it is, where its payload begins and how long that is.
type Found = (Opcode, usize, usize);

impl<const ROOM: usize> Receiver<ROOM> {
    /// Longest payload of a frame that is received.
    pub const LONGEST: usize = {
        assert!(receiver_room(1) <= ROOM && ROOM <= receiver_room(255), "ROOM must be a receiver_room(1..=255)");
        ROOM.wrapping_sub(receiver_room(0))
    };

    /// One that has received nothing.
    pub const fn new() -> Self {
        Self { have: Count::ZERO, last: Count::ZERO, at: Count::ZERO, buffer: [0; ROOM] }
    }

    /// Forgets what it has received.
    #[inline(always)]
    pub const fn clear(&mut self) {
        self.have.set::<ROOM>(0);
        self.last.set::<ROOM>(const { FRAME_OVERHEAD.wrapping_sub(1) });
        self.at.set::<ROOM>(0);
    }

    /// Whether nothing is there that may be part of a frame.
    pub fn is_empty(&self) -> bool {
        let unread = self.buffer.get(self.at.get::<ROOM>()..self.have.get::<ROOM>());
        unread.unwrap_or_default().is_empty()
    }

    /// Takes a byte, and says whether [`next`](Self::next) is to be called. [`Full`] when that was not done, and a
    /// few bytes have come since.
    #[inline(always)]
    pub fn byte(&mut self, byte: u8) -> Result<bool, Full> {
        let have = self.have.get::<ROOM>();
        let Some(place) = self.buffer.get_mut(have) else { return Err(self.full()) };
        *place = byte;
        self.have.set::<ROOM>(have.wrapping_add(1));
        Ok(have >= self.last.get::<ROOM>())
    }

    /// Waits no more, whatever was waited for.
    #[cold]
    #[inline(never)]
    const fn full(&mut self) -> Full {
        self.last.set::<ROOM>(0);
        Full
    }

    /// Takes bytes, as many as there is room for, and says how many. [`next`](Self::next) is to be called then.
    pub fn take(&mut self, input: &[u8]) -> usize {
        if self.is_empty() {
            self.clear();
        }
        self.move_to_front();
        let taken = self.store(input);
        self.last.set::<ROOM>(0);
        taken
    }

    /// Whether [`next`](Self::next) is to be called.
    #[inline(always)]
    pub const fn is_due(&self) -> bool {
        self.have.get::<ROOM>() > self.last.get::<ROOM>()
    }

    /// Fetches the next frame: to be called until there is none.
    #[inline(always)]
    #[expect(clippy::should_implement_trait, reason = "what it returns borrows from the receiver")]
    pub fn next(&mut self) -> Result<Frame<'_>, NoFrame> {
        self.next_observed(&mut ())
    }

    /// The same, for callers that have asked [`is_due`](Self::is_due) before.
    #[inline(always)]
    pub fn next_due(&mut self) -> Result<Frame<'_>, NoFrame> {
        let found = self.look(false, &mut ())?;
        self.frame(found)
    }

    /// The same, and the observer learns what is thrown away.
    #[inline(always)]
    pub fn next_observed(&mut self, observer: &mut impl Observer) -> Result<Frame<'_>, NoFrame> {
        if !self.is_due() {
            return Err(NoFrame::Waiting);
        }
        let found = self.look(false, observer)?;
        self.frame(found)
    }

    /// Like [`next`](Self::next) for a line that has been quiet for longer than a frame takes: what is incomplete will
    /// stay so, and is passed over. When there is no frame, the receiver is empty then.
    #[inline(always)]
    pub fn next_idle(&mut self, observer: &mut impl Observer) -> Result<Frame<'_>, NoFrame> {
        let found = self.look(true, observer)?;
        self.frame(found)
    }

    /// Fetches the next frame of what has been received and of the input behind it, which becomes what is left of it:
    /// nothing when there is no frame. Frames that lie in the input are not copied.
    #[inline(always)]
    pub fn next_of<'a, 'b: 'a>(&'a mut self, input: &mut &'b [u8]) -> Result<Frame<'a>, NoFrame> {
        self.next_of_observed(input, &mut ())
    }

    /// The same, and the observer learns what is thrown away.
    #[inline(always)]
    pub fn next_of_observed<'a, 'b: 'a>(
        &'a mut self,
        input: &mut &'b [u8],
        observer: &mut impl Observer,
    ) -> Result<Frame<'a>, NoFrame> {
        let mut none = NoFrame::Waiting;
        if self.last.get::<ROOM>() >= ROOM {
            // No state that this code leaves.
            self.last.set::<ROOM>(0);
        }
        while !self.is_empty() {
            if self.is_due() {
                match self.look(false, observer) {
                    Ok(found) => return self.frame(found),
                    Err(NoFrame::Garbage) => none = NoFrame::Garbage,
                    Err(NoFrame::Waiting) => {}
                }
            } else {
                if input.is_empty() {
                    return Err(none);
                }
                let missing = self.last.get::<ROOM>().wrapping_sub(self.have.get::<ROOM>()).wrapping_add(1);
                let (now, later) = input.split_at_checked(missing).unwrap_or((*input, &[]));
                // There is room: look() sees to that.
                self.store(now);
                *input = later;
            }
        }
        loop {
            match judge(*input, Self::LONGEST) {
                Verdict::Frame { opcode, length } => {
                    let (frame, behind) =
                        input.split_at_checked(length.wrapping_add(FRAME_OVERHEAD)).unwrap_or_default();
                    *input = behind;
                    let payload = frame.get(FRAME_HEAD..FRAME_HEAD.wrapping_add(length)).unwrap_or_default();
                    return Ok(Frame { opcode, payload });
                }
                Verdict::Needs(bytes) => {
                    self.clear();
                    self.store(input);
                    *input = &[];
                    self.last.set::<ROOM>(bytes.wrapping_sub(1));
                    return Err(none);
                }
                Verdict::Fault(fault) => {
                    *input = input.get(pass_over(input, fault, observer)..).unwrap_or_default();
                }
            }
            none = NoFrame::Garbage;
        }
    }

    /// Looks for a frame in the buffer, whether or not as many bytes are there as that needs.
    #[inline(always)]
    fn look(&mut self, idle: bool, observer: &mut impl Observer) -> Result<Found, NoFrame> {
        let mut none = NoFrame::Waiting;
        let have = self.have.get::<ROOM>();
        let mut at = self.at.get::<ROOM>();
        let needed = loop {
            // Fields out of range are those of an empty receiver.
            let unread = self.buffer.get(at..have).unwrap_or_default();
            if unread.is_empty() {
                self.clear();
                return Err(none);
            }
            let fault = match judge(unread, Self::LONGEST) {
                Verdict::Frame { opcode, length } => {
                    if unread.len() == length.wrapping_add(FRAME_OVERHEAD) {
                        self.clear();
                    } else {
                        self.last.set::<ROOM>(0);
                        self.at.set::<ROOM>(at.wrapping_add(length).wrapping_add(FRAME_OVERHEAD));
                    }
                    return Ok((opcode, at.wrapping_add(FRAME_HEAD), length));
                }
                Verdict::Needs(bytes) if !idle => break bytes,
                Verdict::Needs(_) => Fault::Start,
                Verdict::Fault(fault) => fault,
            };
            at = at.wrapping_add(pass_over(unread, fault, observer));
            none = NoFrame::Garbage;
        };
        self.wait_at(at, needed);
        Err(none)
    }

    /// The frame that was found in the buffer.
    #[inline(always)]
    fn frame(&self, (opcode, begin, length): Found) -> Result<Frame<'_>, NoFrame> {
        let payload = self.buffer.get(begin..begin.wrapping_add(length)).ok_or(NoFrame::Waiting)?;
        Ok(Frame { opcode, payload })
    }

    /// Leaves the bytes from `at` on unread, until there are so many. Where these would not fit, they are moved to the
    /// front.
    #[inline(always)]
    fn wait_at(&mut self, at: usize, bytes: usize) {
        let end = at.wrapping_add(bytes);
        // What does not fit a count is right again, modulo its range, when the bytes have been moved.
        self.last.set::<ROOM>(end.wrapping_sub(1));
        self.at.set::<ROOM>(at);
        if end > ROOM {
            self.move_to_front();
        }
    }

    #[inline(never)]
    fn move_to_front(&mut self) {
        let cells = Cell::from_mut(self.buffer.as_mut_slice()).as_slice_of_cells();
        // Not by copy_within, which is a call of memmove.
        let Some(unread) = cells.get(self.at.get::<ROOM>()..self.have.get::<ROOM>()) else { return self.clear() };
        for (to, from) in cells.iter().zip(unread) {
            to.set(from.get());
        }
        let at = self.at.get::<ROOM>();
        self.have.set::<ROOM>(self.have.get::<ROOM>().wrapping_sub(at));
        self.last.set::<ROOM>(self.last.get::<ROOM>().wrapping_sub(at));
        self.at.set::<ROOM>(0);
    }

    /// Stores as many bytes behind the others as there is room for.
    #[inline(always)]
    fn store(&mut self, input: &[u8]) -> usize {
        let have = self.have.get::<ROOM>();
        let room = self.buffer.get_mut(have..).unwrap_or_default();
        let stored = input.len().min(room.len());
        bytes::copy(input, room, |byte| byte);
        self.have.set::<ROOM>(have.wrapping_add(stored));
        stored
    }
}

impl<const ROOM: usize> Default for Receiver<ROOM> {
    fn default() -> Self {
        Self::new()
    }
}

/// How many bytes to pass over where the first begins no frame: those up to the next start.
#[inline(always)]
fn pass_over(bytes: &[u8], fault: Fault, observer: &mut impl Observer) -> usize {
    if fault == Fault::Checksum {
        observer.bad_checksum();
    }
    let rest = bytes.get(1..).unwrap_or_default();
    let skipped = rest.iter().position(|byte| *byte == FRAME_START).unwrap_or(rest.len()).wrapping_add(1);
    observer.skipped(skipped);
    skipped
}

/// A place in the buffer or a number of bytes in it. Where one byte holds all of them, the high one is left alone: two
/// take AVR twice as long.
#[derive(Clone, Copy, Debug, FromBytes, Immutable, KnownLayout)]
struct Count {
    low: u8,
    high: u8,
}

impl Count {
    const ZERO: Self = Self { low: 0, high: 0 };

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "at most receiver_room(255)")]
    const fn set<const ROOM: usize>(&mut self, count: usize) {
        self.low = count as u8;
        if ROOM > 0xFF {
            self.high = (count >> 8) as u8;
        }
    }

    #[inline(always)]
    const fn get<const ROOM: usize>(self) -> usize {
        u16::from_le_bytes([self.low, if ROOM <= 0xFF { 0 } else { self.high }]) as usize
    }
}

#[cfg(test)]
mod tests;
