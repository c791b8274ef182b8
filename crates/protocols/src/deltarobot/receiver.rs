//! The receiver of frames: a buffer of one maximal frame.

use zerocopy::{FromBytes, Immutable, KnownLayout};

use super::frame::{FRAME_HEAD, FRAME_OVERHEAD, FRAME_START, Frame, NoFrame, Verdict, judge};
use super::{Fault, Opcode};
use crate::bytes;

/// Bytes that fit behind a maximal frame that was not fetched yet.
const SPARE: usize = 5;

/// The parameter of a [`Receiver`] of frames with payloads of at most `longest` bytes, 1 to 255.
#[must_use]
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
///
/// let mut input = b"$H\0\xA6:$M".as_slice();
/// assert_eq!(receiver.next_of(&mut input).unwrap().opcode, Opcode::HOMING);
/// assert!(receiver.next_of(&mut input).is_err() && input.is_empty());
/// ```
#[derive(Clone, Debug, FromBytes, Immutable, KnownLayout)]
pub struct Receiver<const ROOM: usize> {
    /// How many bytes are in the buffer.
    have: u16,
    /// One less than `have` must be for the next look.
    last: u16,
    /// Where in the buffer the unread ones begin.
    at: u16,
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

/// Where in some bytes a frame was found: its opcode, the place of its payload and the length of that.
type Found = (Opcode, usize, usize);

impl<const ROOM: usize> Receiver<ROOM> {
    /// Longest payload of a frame that is received.
    pub const LONGEST: usize = {
        assert!(receiver_room(1) <= ROOM && ROOM <= receiver_room(255), "ROOM must be a receiver_room(1..=255)");
        ROOM.wrapping_sub(receiver_room(0))
    };

    /// One that has received nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self { have: 0, last: 0, at: 0, buffer: [0; ROOM] }
    }

    /// Forgets what it has received.
    #[inline(always)]
    pub const fn clear(&mut self) {
        (self.have, self.last, self.at) = (0, const { short(FRAME_OVERHEAD.wrapping_sub(1)) }, 0);
    }

    /// Whether nothing is there that may be part of a frame.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.unread().is_empty()
    }

    /// Takes a byte, and says whether [`next`](Self::next) is to be called.
    ///
    /// # Errors
    ///
    /// [`Full`] when [`next`](Self::next) was not called in spite of that, and five bytes have come or more since.
    #[inline(always)]
    pub fn byte(&mut self, byte: u8) -> Result<bool, Full> {
        let have = self.have;
        *self.buffer.get_mut(usize::from(have)).ok_or(Full)? = byte;
        self.have = have.wrapping_add(1);
        Ok(have >= self.last)
    }

    /// Takes bytes, as many as there is room for, and says how many. [`next`](Self::next) is to be called then.
    pub fn take(&mut self, input: &[u8]) -> usize {
        let (at, have) = self.sound();
        self.wait_at(at, have, ROOM);
        let have = usize::from(self.have);
        let room = self.buffer.get_mut(have..).unwrap_or_default();
        let taken = input.len().min(room.len());
        bytes::copy(input, room, |byte| byte);
        (self.have, self.last) = (short(have.wrapping_add(taken)), 0);
        taken
    }

    /// Fetches the next frame: to be called until there is none.
    ///
    /// # Errors
    ///
    /// [`NoFrame`] when more bytes are needed.
    #[inline(always)]
    pub fn next(&mut self) -> Result<Frame<'_>, NoFrame> {
        self.next_observed(&mut ())
    }

    /// The same, and the observer learns what is thrown away.
    ///
    /// # Errors
    ///
    /// As [`next`](Self::next).
    #[inline(always)]
    pub fn next_observed(&mut self, observer: &mut impl Observer) -> Result<Frame<'_>, NoFrame> {
        let found = self.find(false, observer)?;
        Ok(frame(&self.buffer, found))
    }

    /// Like [`next`](Self::next) for a line that has been quiet for longer than a frame takes: what is incomplete will
    /// stay so, and is passed over.
    ///
    /// # Errors
    ///
    /// [`NoFrame`] when there is no frame; the receiver is empty now.
    #[inline(always)]
    pub fn next_idle(&mut self, observer: &mut impl Observer) -> Result<Frame<'_>, NoFrame> {
        let found = self.find(true, observer)?;
        Ok(frame(&self.buffer, found))
    }

    /// Fetches the next frame of what has been received and of the input behind it, which becomes what is left of it:
    /// nothing when there is no frame. Frames that lie in the input are not copied.
    ///
    /// # Errors
    ///
    /// As [`next`](Self::next).
    #[inline(always)]
    pub fn next_of<'a, 'b: 'a>(&'a mut self, input: &mut &'b [u8]) -> Result<Frame<'a>, NoFrame> {
        self.next_of_observed(input, &mut ())
    }

    /// The same, and the observer learns what is thrown away.
    ///
    /// # Errors
    ///
    /// As [`next`](Self::next).
    #[inline(always)]
    pub fn next_of_observed<'a, 'b: 'a>(
        &'a mut self,
        input: &mut &'b [u8],
        observer: &mut impl Observer,
    ) -> Result<Frame<'a>, NoFrame> {
        let mut none = NoFrame::Waiting;
        while !self.is_empty() {
            match self.find(false, observer) {
                Ok(found) => return Ok(frame(&self.buffer, found)),
                Err(NoFrame::Garbage) => none = NoFrame::Garbage,
                Err(NoFrame::Waiting) if input.is_empty() => return Err(none),
                Err(NoFrame::Waiting) => {
                    let missing = usize::from(self.last.wrapping_sub(self.have)).wrapping_add(1);
                    let (now, later) = input.split_at_checked(missing).unwrap_or((*input, &[]));
                    let have = usize::from(self.have);
                    bytes::copy(now, self.buffer.get_mut(have..).unwrap_or_default(), |byte| byte);
                    self.have = short(have.wrapping_add(now.len()));
                    *input = later;
                }
            }
        }
        loop {
            let skipped = match judge(*input, Self::LONGEST) {
                Verdict::Frame { opcode, length } => {
                    let (now, later) = input.split_at_checked(length.wrapping_add(FRAME_OVERHEAD)).unwrap_or_default();
                    *input = later;
                    return Ok(frame(now, (opcode, FRAME_HEAD, length)));
                }
                Verdict::Needs(bytes) => {
                    self.clear();
                    if !input.is_empty() {
                        bytes::copy(input, &mut self.buffer, |byte| byte);
                        self.have = short(input.len());
                        self.last = short(bytes.max(FRAME_OVERHEAD).wrapping_sub(1));
                        *input = &[];
                    }
                    return Err(none);
                }
                Verdict::Fault(fault) => passed(input, fault, observer),
            };
            *input = input.get(skipped..).unwrap_or_default();
            none = NoFrame::Garbage;
        }
    }

    /// Looks for a frame in the buffer, once as many bytes are there as that needs.
    #[inline(always)]
    fn find(&mut self, idle: bool, observer: &mut impl Observer) -> Result<Found, NoFrame> {
        if self.have <= self.last && usize::from(self.have) < ROOM && !idle {
            return Err(NoFrame::Waiting);
        }
        self.search(idle, observer)
    }

    fn search(&mut self, idle: bool, observer: &mut impl Observer) -> Result<Found, NoFrame> {
        let (mut at, have) = self.sound();
        let mut none = NoFrame::Waiting;
        loop {
            let unread = self.buffer.get(at..have).unwrap_or_default();
            let skipped = match judge(unread, Self::LONGEST) {
                Verdict::Frame { opcode, length } => {
                    self.wait_at(at.wrapping_add(length).wrapping_add(FRAME_OVERHEAD), have, 0);
                    return Ok((opcode, at.wrapping_add(FRAME_HEAD), length));
                }
                Verdict::Needs(bytes) if !idle || unread.is_empty() => {
                    self.wait_at(at, have, bytes.max(FRAME_OVERHEAD));
                    return Err(none);
                }
                Verdict::Needs(_) => passed(unread, Fault::Start, observer),
                Verdict::Fault(fault) => passed(unread, fault, observer),
            };
            at = at.wrapping_add(skipped);
            none = NoFrame::Garbage;
        }
    }

    /// Leaves the bytes from `at` on unread, until there are so many. Where these would not fit, they are moved to the
    /// front.
    #[inline(always)]
    fn wait_at(&mut self, at: usize, have: usize, bytes: usize) {
        if at == have {
            return self.clear();
        }
        let end = at.wrapping_add(bytes);
        (self.have, self.last, self.at) = (short(have), short(end.wrapping_sub(1)), short(at));
        if bytes == 0 {
            self.last = 0;
        } else if at != 0 && end > ROOM.wrapping_sub(SPARE) {
            let left = have.wrapping_sub(at);
            for to in 0..left {
                // Not by copy_within, which is a call of memmove.
                if let Some(byte) = self.buffer.get(at.wrapping_add(to)).copied()
                    && let Some(place) = self.buffer.get_mut(to)
                {
                    *place = byte;
                }
            }
            (self.have, self.last, self.at) = (short(left), short(bytes.wrapping_sub(1)), 0);
        }
    }

    /// Where the unread bytes begin and end. Fields out of range become those of an empty receiver.
    #[inline(always)]
    fn sound(&self) -> (usize, usize) {
        let (at, have) = (usize::from(self.at), usize::from(self.have));
        if at <= have && have <= ROOM { (at, have) } else { (0, 0) }
    }

    #[inline(always)]
    fn unread(&self) -> &[u8] {
        let (at, have) = self.sound();
        self.buffer.get(at..have).unwrap_or_default()
    }
}

impl<const ROOM: usize> Default for Receiver<ROOM> {
    fn default() -> Self {
        Self::new()
    }
}

/// How many bytes can't be part of a frame, where the first begins none: up to the next start of one.
#[inline(always)]
fn passed(bytes: &[u8], fault: Fault, observer: &mut impl Observer) -> usize {
    if fault == Fault::Checksum {
        observer.bad_checksum();
    }
    let behind = bytes.get(1..).unwrap_or_default();
    let skipped = bytes::find(FRAME_START, behind).unwrap_or(behind.len()).wrapping_add(1);
    observer.skipped(skipped);
    skipped
}

#[inline(always)]
fn frame(bytes: &[u8], (opcode, begin, length): Found) -> Frame<'_> {
    let payload = bytes.get(begin..begin.wrapping_add(length)).unwrap_or_default();
    Frame { opcode, payload }
}

/// A place in the buffer or a number of bytes in it.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "at most receiver_room(255)")]
const fn short(bytes: usize) -> u16 {
    bytes as u16
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use proptest::prelude::*;
    use zerocopy::FromBytes;

    use super::{Full, Observer, Receiver, receiver_room};
    use crate::deltarobot::{Fault, Verdict, judge};

    type Messages = Vec<(u8, Vec<u8>)>;

    #[derive(Clone, Debug, Default, PartialEq, Eq)]
    struct Losses {
        skipped: usize,
        bad_checksums: usize,
    }

    impl Observer for Losses {
        fn skipped(&mut self, bytes: usize) {
            assert!(bytes > 0);
            self.skipped += bytes;
        }
        fn bad_checksum(&mut self) {
            self.bad_checksums += 1;
        }
    }

    /// The grammar, applied to a whole stream: the messages, the losses, and how many bytes wait for more.
    fn naive(mut stream: &[u8], longest: usize, idle: bool) -> (Messages, Losses, usize) {
        let (mut messages, mut losses) = (Vec::new(), Losses::default());
        loop {
            match judge(stream, longest) {
                Verdict::Frame { opcode, length } => {
                    messages.push((opcode.0, stream[3..length + 3].to_vec()));
                    stream = &stream[length + 5..];
                    continue;
                }
                Verdict::Needs(_) if !idle || stream.is_empty() => return (messages, losses, stream.len()),
                Verdict::Needs(_) => {}
                Verdict::Fault(fault) => losses.bad_checksums += usize::from(fault == Fault::Checksum),
            }
            losses.skipped += 1;
            stream = &stream[1..];
        }
    }

    /// Fetches all that is there.
    fn fetch<const ROOM: usize>(receiver: &mut Receiver<ROOM>, losses: &mut Losses, messages: &mut Messages) {
        while let Ok(frame) = receiver.next_observed(losses) {
            messages.push((frame.opcode.0, frame.payload.to_vec()));
        }
    }

    fn check<const ROOM: usize>(stream: &[u8], chunks: &[usize]) {
        let (expected, expected_losses, _) = naive(stream, Receiver::<ROOM>::LONGEST, true);
        let until_now = |upto: usize| naive(&stream[..upto], Receiver::<ROOM>::LONGEST, false).0.len();
        let mut chunks = chunks.iter().copied().cycle();

        let (mut receiver, mut losses, mut messages) = (Receiver::<ROOM>::new(), Losses::default(), Vec::new());
        for (place, byte) in stream.iter().enumerate() {
            if receiver.byte(*byte).unwrap() {
                fetch(&mut receiver, &mut losses, &mut messages);
            }
            assert_eq!(messages.len(), until_now(place + 1), "byte {place}");
        }
        while let Ok(frame) = receiver.next_idle(&mut losses) {
            messages.push((frame.opcode.0, frame.payload.to_vec()));
        }
        assert!(receiver.is_empty());
        assert_eq!((&messages, &losses), (&expected, &expected_losses), "byte by byte");

        // As long as there is room, nothing is fetched.
        let (mut receiver, mut losses, mut messages) = (Receiver::<ROOM>::new(), Losses::default(), Vec::new());
        for byte in stream {
            if receiver.byte(*byte) == Err(Full) {
                fetch(&mut receiver, &mut losses, &mut messages);
                receiver.byte(*byte).unwrap();
            }
        }
        while let Ok(frame) = receiver.next_idle(&mut losses) {
            messages.push((frame.opcode.0, frame.payload.to_vec()));
        }
        assert_eq!((&messages, &losses), (&expected, &expected_losses), "late");

        let (mut receiver, mut losses, mut messages) = (Receiver::<ROOM>::new(), Losses::default(), Vec::new());
        let (mut rest, mut given) = (stream, 0);
        while !rest.is_empty() {
            let (mut now, later) = rest.split_at(chunks.next().unwrap().clamp(1, rest.len()));
            given += now.len();
            rest = later;
            while let Ok(frame) = receiver.next_of_observed(&mut now, &mut losses) {
                messages.push((frame.opcode.0, frame.payload.to_vec()));
            }
            assert!(now.is_empty());
            assert_eq!(messages.len(), until_now(given), "{given} in chunks");
        }
        while let Ok(frame) = receiver.next_idle(&mut losses) {
            messages.push((frame.opcode.0, frame.payload.to_vec()));
        }
        assert_eq!((&messages, &losses), (&expected, &expected_losses), "in chunks");

        let (mut receiver, mut losses, mut messages) = (Receiver::<ROOM>::new(), Losses::default(), Vec::new());
        let mut rest = stream;
        while !rest.is_empty() {
            let size = chunks.next().unwrap().clamp(1, rest.len());
            let taken = receiver.take(&rest[..size]);
            rest = &rest[taken..];
            fetch(&mut receiver, &mut losses, &mut messages);
            assert_eq!(messages.len(), until_now(stream.len() - rest.len()), "taken");
        }
        while let Ok(frame) = receiver.next_idle(&mut losses) {
            messages.push((frame.opcode.0, frame.payload.to_vec()));
        }
        assert_eq!((&messages, &losses), (&expected, &expected_losses), "taken");
    }

    /// Frames, beginnings of frames, and noise.
    fn stream() -> impl Strategy<Value = Vec<u8>> {
        let opcode = prop_oneof![9 => prop::sample::select(b"ANHSMChsme".to_vec()), 1 => any::<u8>()];
        let payload = prop_oneof![4 => 0..6_usize, 1 => 0..40_usize].prop_flat_map(|length| {
            prop::collection::vec(
                prop_oneof![3 => any::<u8>(), 1 => prop::sample::select(b"$:A\0\x01".to_vec())],
                length,
            )
        });
        let frame = (opcode, payload, 0..20_u8).prop_map(|(opcode, payload, damage)| {
            let mut frame = [b"$".as_slice(), &[opcode, u8::try_from(payload.len()).unwrap()], &payload].concat();
            let sum = frame.iter().fold(b':', |sum, byte| sum.wrapping_add(*byte));
            frame.push(sum.wrapping_add(u8::from(damage == 0)));
            frame.push(if damage == 1 { b'$' } else { b':' });
            frame
        });
        let piece = prop_oneof![
            6 => frame,
            1 => prop::collection::vec(prop_oneof![Just(b'$'), Just(b'M'), any::<u8>()], 0..4),
            2 => prop::collection::vec(prop::sample::select(b"$MA:\0\x01\x02".to_vec()), 0..12),
            1 => (0..40_u8).prop_map(|length| [b'$', b'M', length, b':'].to_vec()),
        ];
        prop::collection::vec(piece, 0..12).prop_map(|pieces| pieces.concat())
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2_000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn it_finds_what_the_grammar_says(stream in stream(), chunks in prop::collection::vec(1..70_usize, 1..5)) {
            check::<{ receiver_room(1) }>(&stream, &chunks);
            check::<{ receiver_room(2) }>(&stream, &chunks);
            check::<{ receiver_room(12) }>(&stream, &chunks);
            check::<{ receiver_room(32) }>(&stream, &chunks);
            check::<{ receiver_room(255) }>(&stream, &chunks);
        }

        #[test]
        fn any_contents_are_safe(contents in prop::collection::vec(any::<u8>(), 18), small: bool, stream in stream()) {
            type Small = Receiver<{ receiver_room(2) }>;
            let mut contents = contents;
            if small {
                // Fields that may be in range.
                contents[..6].iter_mut().enumerate().for_each(|(place, byte)| *byte = if place % 2 == 0 { *byte % 20 } else { 0 });
            }
            for way in 0..3 {
                let mut receiver = Small::read_from_bytes(&contents).unwrap();
                let mut input = stream.as_slice();
                match way {
                    0 => while receiver.next_of(&mut input).is_ok() {},
                    1 => {
                        let taken = receiver.take(input);
                        assert!(taken <= input.len());
                        while receiver.next().is_ok() {}
                    }
                    _ => for byte in input {
                        if receiver.byte(*byte) != Ok(false) {
                            while receiver.next().is_ok() {}
                        }
                    },
                }
                while receiver.next_idle(&mut ()).is_ok() {}
                prop_assert!(receiver.is_empty());
                for byte in b"$S\0\xB1" {
                    prop_assert_eq!(receiver.byte(*byte), Ok(false));
                }
                prop_assert_eq!(receiver.byte(b':'), Ok(true));
                prop_assert_eq!(receiver.next().map(|frame| frame.opcode.0), Ok(b'S'));
            }
        }
    }
}
