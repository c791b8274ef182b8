//! Short ways for what happens most, on hosts: bytes that come one by one, frames that lie in one piece. Each does what
//! the long way in `ring.rs` would have done, or declines and changes nothing.
//!
//! What they know comes from the fields as they are, in range or not, and from bytes that may be stale. So each answer
//! rests on a check of `used` that leaves no other reading.

use super::Opcode;
use super::frame::{FRAME_END, FRAME_HEAD, FRAME_OVERHEAD, FRAME_START};
use super::ring::{FRAME_MAX, Ring, int, wrap};
use super::search::{intact, needed};
use crate::bytes;
use crate::config::DP_BUFSIZE;

/// What a ring starts with, when a glance is enough to tell.
#[derive(Clone, Copy, Debug)]
pub enum Glance {
    /// A head whose rest is waited for.
    Waiting,
    /// A head, and as many bytes in all as it asks for. Whether they are a frame, [`Ring::prove`] knows.
    Whole { start: usize, opcode: u8, size: usize },
    /// A byte that begins no frame, or nothing.
    NoStart,
    /// A start, behind which stands no head. Whether one may come, [`Ring::awaits_head`] knows.
    NoHead,
}

/// What is true of a candidate that [`Ring::glance`] saw whole.
#[derive(Clone, Copy, Debug)]
pub enum Proof<'a> {
    /// It is a frame, with this payload: [`Ring::drop_frame`] is to follow.
    Frame(&'a [u8]),
    /// It is none: its first byte is garbage.
    Garbage,
    /// That takes more to tell.
    Unclear,
}

impl Ring {
    /// Adds a byte behind the others, or tells the place past the ring's end where it would be, and how many there are.
    #[inline(always)]
    pub fn push(&mut self, byte: u8) -> Result<(), (usize, usize)> {
        let used = self.used.cast_unsigned() as usize;
        let end = used.wrapping_add(self.start.cast_unsigned() as usize);
        // When even the sum is in range, so are both.
        *self.bytes.get_mut(end).ok_or((end, used))? = byte;
        self.used = self.used.wrapping_add(1);
        Ok(())
    }

    /// Adds a byte in front of the others, which end there; unless the ring is full, or its fields are out of range.
    #[inline(always)]
    pub fn push_in_front(&mut self, end: usize, used: usize, byte: u8) -> bool {
        let start = self.start.cast_unsigned() as usize;
        let are_inside = if DP_BUFSIZE.is_power_of_two() {
            start | used < DP_BUFSIZE
        } else {
            start < DP_BUFSIZE && used < DP_BUFSIZE
        };
        match self.bytes.get_mut(wrap(end)) {
            Some(place) if are_inside => *place = byte,
            _ => return false,
        }
        self.used = self.used.wrapping_add(1);
        true
    }

    /// Judges what the ring starts with, if that is a head that lies in one piece.
    #[inline(always)]
    pub fn glance(&self) -> Option<Glance> {
        let start = self.start.cast_unsigned() as usize;
        if start > const { DP_BUFSIZE.wrapping_sub(FRAME_HEAD) } {
            return None;
        }
        let &[first, opcode, length] = self.bytes.get(start..)?.first_chunk()?;
        if first != FRAME_START {
            return Some(Glance::NoStart);
        }
        let size = needed(opcode, length);
        // Right for 0 to 2 bytes too: what is there of the head is right, and stale bytes let it wait for the rest, or
        // leave that to NoHead.
        if (self.used.cast_unsigned() as usize) < size {
            return Some(Glance::Waiting);
        }
        Some(if size >= FRAME_OVERHEAD { Glance::Whole { start, opcode, size } } else { Glance::NoHead })
    }

    /// Whether there is no byte.
    #[inline(always)]
    pub const fn is_empty(&self) -> bool {
        self.used == 0
    }

    /// Whether the head that [`glance`](Self::glance) missed has yet to come.
    #[inline(always)]
    pub const fn awaits_head(&self) -> bool {
        self.used.cast_unsigned() <= 1
    }

    /// Proves a candidate that lies in one piece.
    #[inline(always)]
    pub fn prove(&self, start: usize, opcode: Opcode, size: usize) -> Proof<'_> {
        match self.bytes.get(start..start.wrapping_add(size)) {
            Some(candidate) => self.prove_bytes(candidate, opcode),
            None => Proof::Unclear,
        }
    }

    /// The same for one that lies across the ring's end: it is put together in `room`.
    #[inline(always)]
    pub fn prove_across<'a>(
        &self,
        start: usize,
        opcode: Opcode,
        size: usize,
        room: &'a mut [u8; FRAME_MAX],
    ) -> Proof<'a> {
        // Seen before anything is copied: most false starts end here.
        if self.byte(start.wrapping_add(size).wrapping_sub(1)) != FRAME_END {
            return Proof::Garbage;
        }
        let (front, back) = self.bytes.split_at_checked(start).unwrap_or_default();
        let Some(candidate) = room.get_mut(..size) else { return Proof::Unclear };
        let Some((first, rest)) = candidate.split_at_mut_checked(back.len()) else { return Proof::Unclear };
        bytes::copy(back, first, |byte| byte);
        bytes::copy(front, rest, |byte| byte);
        self.prove_bytes(candidate, opcode)
    }

    #[inline(always)]
    fn prove_bytes<'a>(&self, candidate: &'a [u8], opcode: Opcode) -> Proof<'a> {
        match intact(candidate, opcode) {
            None => Proof::Garbage,
            Some(_) if self.used.cast_unsigned() as usize > DP_BUFSIZE => Proof::Unclear,
            Some(payload) => Proof::Frame(payload),
        }
    }

    /// Drops a frame from the ring's start.
    #[inline(always)]
    pub fn drop_frame(&mut self, start: usize, size: usize) {
        (self.start, self.used) = (int(wrap(start.wrapping_add(size))), self.used.wrapping_sub(int(size)));
    }
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::{DP_BUFSIZE, FRAME_MAX, Glance, Opcode, Proof, Ring, int, wrap};
    use crate::config::DP_DATA_MAX_SIZE;
    use crate::deltarobot::{NoFrame, RingFrame};

    const FULL: i32 = super::int(DP_BUFSIZE);

    /// All of a ring that C can see, and what a call told: an opcode with its payload, or why there is none.
    type Outcome = (Result<(u8, Vec<u8>), NoFrame>, Vec<u8>, i32, i32);

    fn outcome(ring: &Ring, answer: Result<(u8, Vec<u8>), NoFrame>) -> Outcome {
        (answer, ring.bytes.to_vec(), ring.start, ring.used)
    }

    /// What the long way does.
    fn searched(mut ring: Ring) -> Outcome {
        let answer = unpacked(ring.search(false));
        outcome(&ring, answer)
    }

    fn unpacked(answer: Result<RingFrame<'_>, NoFrame>) -> Result<(u8, Vec<u8>), NoFrame> {
        answer.map(|frame| (frame.opcode.0, frame.payload.iter().collect()))
    }

    /// What the short ways do together, as dp_recv takes them, or `None` when they decline.
    fn short(mut ring: Ring) -> Option<Outcome> {
        let before = ring.clone();
        let mut room = [0; FRAME_MAX];
        let (start, opcode, size) = match before.glance() {
            Some(Glance::Waiting) => return Some(outcome(&ring, Err(NoFrame::Waiting))),
            Some(Glance::NoHead) if before.awaits_head() => {
                return Some(outcome(&ring, Err(NoFrame::Waiting)));
            }
            Some(Glance::NoStart) if before.is_empty() => return Some(outcome(&ring, Err(NoFrame::Waiting))),
            Some(Glance::NoHead | Glance::NoStart) => return Some(behind_garbage(ring)),
            Some(Glance::Whole { start, opcode, size }) => (start, Opcode(opcode), size),
            None => match before.look()? {
                (_, Err(NoFrame::Waiting)) => return Some(outcome(&ring, Err(NoFrame::Waiting))),
                (_, Err(NoFrame::Garbage)) => return Some(behind_garbage(ring)),
                (start, Ok((opcode, size))) => (start, opcode, size),
            },
        };
        let proof = match before.prove(start, opcode, size) {
            Proof::Unclear => before.prove_across(start, opcode, size, &mut room),
            proof => proof,
        };
        match proof {
            Proof::Frame(payload) => {
                ring.drop_frame(start, size);
                Some(outcome(&ring, Ok((opcode.0, payload.to_vec()))))
            }
            Proof::Garbage => Some(behind_garbage(ring)),
            Proof::Unclear => None,
        }
    }

    fn behind_garbage(mut ring: Ring) -> Outcome {
        let answer = match passed(&mut ring) {
            Some(Ok((start, opcode, size))) => match ring.clone().prove(start, opcode, size) {
                Proof::Frame(payload) => {
                    ring.drop_frame(start, size);
                    Ok((opcode.0, payload.to_vec()))
                }
                Proof::Garbage => match passed(&mut ring) {
                    Some(Err(none)) => Err(none),
                    Some(Ok(_)) | None => unpacked(ring.search(false)),
                },
                Proof::Unclear => unpacked(ring.search(false)),
            },
            Some(Err(none)) => Err(none),
            None => unpacked(ring.search(false)),
        };
        outcome(&ring, answer)
    }

    /// Passes over garbage, up to a candidate or something to wait for.
    fn passed(ring: &mut Ring) -> Option<Result<(usize, Opcode, usize), NoFrame>> {
        let before = ring.clone();
        let passed = ring.pass()?;
        Some(passed.map(|(passed, opcode, size)| {
            assert_eq!(outcome(ring, Err(NoFrame::Waiting)), outcome(&before, Err(NoFrame::Waiting)));
            (ring.skip(passed), opcode, size)
        }))
    }

    /// The long way, one byte after the other and without any of what is in this file.
    fn plain(mut ring: Ring, idle: bool) -> Outcome {
        let (mut start, mut used) = (ring.start.cast_unsigned() as usize, ring.used.cast_unsigned() as usize);
        if start >= DP_BUFSIZE || used > DP_BUFSIZE {
            (start, used) = (0, 0);
        }
        let mut unread: Vec<u8> = ring.bytes.iter().cycle().skip(start).take(used).copied().collect();
        let mut answer = Err(NoFrame::Waiting);
        while !unread.is_empty() {
            let known = unread.get(1).is_none_or(|opcode| Opcode(*opcode).is_known());
            let length = unread.get(2).map_or(0, |length| usize::from(*length));
            let garbage = unread[0] != b'$' || !known || length > DP_DATA_MAX_SIZE;
            if !garbage && unread.len() < length + 5 {
                if !idle {
                    break;
                }
            } else if !garbage {
                let sum = unread[..length + 3].iter().fold(b':', |sum, byte| sum.wrapping_add(*byte));
                if unread[length + 3..length + 5] == [sum, b':'] {
                    answer = Ok((unread[1], unread[3..length + 3].to_vec()));
                    unread.drain(..length + 5);
                    break;
                }
            }
            unread.remove(0);
            answer = Err(NoFrame::Garbage);
        }
        ring.start = int(wrap(start + used - unread.len()));
        ring.used = int(unread.len());
        outcome(&ring, answer)
    }

    /// Rings full of frames, beginnings of frames and noise, stale bytes included.
    fn storage() -> impl Strategy<Value = Vec<u8>> {
        let opcode = prop_oneof![9 => prop::sample::select(b"ANHSMChsme".to_vec()), 1 => any::<u8>()];
        let payload = 0..=u8::try_from(DP_DATA_MAX_SIZE).unwrap_or(u8::MAX);
        let payload =
            payload.prop_flat_map(|length| (Just(length), prop::collection::vec(any::<u8>(), usize::from(length))));
        let frame = (opcode, payload, 0..20_u8).prop_map(|(opcode, (length, payload), damage)| {
            let mut frame = [b"$".as_slice(), &[opcode, length], &payload].concat();
            let sum = frame.iter().fold(b':', |sum, byte| sum.wrapping_add(*byte));
            frame.push(sum.wrapping_add(u8::from(damage == 0)));
            frame.push(if damage == 1 { b'$' } else { b':' });
            frame
        });
        let piece = prop_oneof![
            4 => frame,
            // The second stands for candidates that overlap.
            1 => prop::collection::vec(prop_oneof![Just(b'$'), Just(b'M'), any::<u8>()], 0..4),
            2 => (0..=u8::try_from(DP_DATA_MAX_SIZE).unwrap_or(u8::MAX)).prop_map(|length| vec![b'$', b'M', length, b':']),
        ];
        prop::collection::vec(piece, DP_BUFSIZE.div_ceil(8)).prop_map(|pieces| {
            let mut bytes = pieces.concat();
            bytes.resize(DP_BUFSIZE, b'$');
            bytes
        })
    }

    fn field() -> impl Strategy<Value = i32> {
        prop_oneof![
            8 => 0..=FULL + 40,
            4 => 0..4,
            1 => any::<i32>(),
            1 => prop::sample::select([-3, -2, -1, i32::MIN, i32::MAX].to_vec()),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 4_000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn it_does_what_the_long_way_does_or_nothing(bytes in storage(), start in field(), used in field()) {
            let mut ring = Ring::new();
            ring.bytes.copy_from_slice(&bytes);
            ring.bytes.rotate_right(usize::try_from(start).unwrap_or(0) % DP_BUFSIZE);
            (ring.start, ring.used) = (start, used);
            let expected = searched(ring.clone());
            prop_assert_eq!(&expected, &plain(ring.clone(), false));
            let mut idle = ring.clone();
            let answer = unpacked(idle.search(true));
            prop_assert_eq!(outcome(&idle, answer), plain(ring.clone(), true));
            if let Some(outcome) = short(ring) {
                prop_assert_eq!(outcome, expected);
            }
        }

        #[test]
        fn a_byte_is_pushed_as_it_would_be_appended(start in field(), used in field(), byte: u8) {
            let mut ring = Ring::new();
            (ring.start, ring.used) = (start, used);
            let mut other = ring.clone();
            if ring.push(byte).map_or_else(|(end, used)| ring.push_in_front(end, used, byte), |()| true) {
                prop_assert_eq!(other.append(&[byte]), Ok(()));
            }
            prop_assert_eq!(outcome(&ring, Err(NoFrame::Waiting)), outcome(&other, Err(NoFrame::Waiting)));
        }
    }

    #[test]
    fn frames_in_one_piece_and_waiting_need_no_search() {
        let mut ring = Ring::new();
        assert_eq!(short(ring.clone()).map(|outcome| outcome.0), Some(Err(NoFrame::Waiting)));
        for (byte, frame) in [(b'$', None), (b'S', None), (0, None), (0xB1, None), (b':', Some((b'S', Vec::new())))] {
            assert_eq!(ring.append(&[byte]), Ok(()));
            assert_eq!(short(ring.clone()).map(|outcome| outcome.0), Some(frame.ok_or(NoFrame::Waiting)));
        }
    }

    #[test]
    fn a_wrong_length_is_no_frame_whatever_stands_behind_it() {
        for length in [0, 1, DP_DATA_MAX_SIZE, DP_DATA_MAX_SIZE + 1, usize::from(b':'), 255] {
            for behind in 0..=255 {
                let mut ring = Ring::new();
                ring.bytes.fill(behind);
                ring.bytes[..3].copy_from_slice(&[b'$', b'M', length.to_le_bytes()[0]]);
                ring.used = FULL;
                let expected = plain(ring.clone(), false);
                assert_eq!(searched(ring.clone()), expected, "{length} {behind}");
                assert!(short(ring).is_none_or(|outcome| outcome == expected), "{length} {behind}");
            }
        }
    }

    #[test]
    fn a_stale_frame_is_not_found_again() {
        let mut ring = Ring::new();
        assert_eq!(ring.append(b"$S\0\xB1:"), Ok(()));
        for used in [0, 1, 2, 3, 4, FULL + 1, FULL + 5, i32::MAX, -1, i32::MIN] {
            ring.used = used;
            assert!(short(ring.clone()).is_none_or(|outcome| outcome.0 == Err(NoFrame::Waiting)), "{used}");
            assert_eq!(searched(ring.clone()).0, Err(NoFrame::Waiting), "{used}");
        }
    }
}
