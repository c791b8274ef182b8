//! Short ways for what happens most, on hosts: bytes that come one by one, frames that lie in one piece. Each does what the
//! long way in `ring.rs` would have done, or declines and changes nothing.
//!
//! What they know comes from the fields as they are, in range or not, and from bytes that may be stale. So each answer rests
//! on a check of `used` that leaves no other reading.

use super::frame::{FRAME_END, FRAME_HEAD, FRAME_OVERHEAD, FRAME_START, Frame, Payload};
use super::ring::{NoFrame, Ring, int, wrap};
use super::{Opcode, bytes};
use crate::config::{DP_BUFSIZE, DP_DATA_MAX_SIZE};

/// What the length byte of a frame has to be below, by opcode: 0 for bytes that are none.
#[expect(
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    reason = "evaluated by the compiler, for 0 to 255"
)]
static LIMITS: [u32; 256] = {
    let mut limits = [0; 256];
    let mut byte = 0;
    while byte < limits.len() {
        if Opcode(byte as u8).is_known() {
            limits[byte] = DP_DATA_MAX_SIZE as u32 + 1;
        }
        byte += 1;
    }
    limits
};

/// A frame by its head and size. Whether it is intact, and the ring's fields are in range, [`Ring::take`] knows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whole {
    pub(crate) start: usize,
    pub(crate) used: usize,
    pub(crate) opcode: u8,
    pub(crate) length: usize,
}

/// The entry of [`LIMITS`] for an opcode: in place of [`Opcode::is_known`], which compares with one after the other.
#[inline(always)]
pub(super) fn limit(opcode: Opcode) -> usize {
    LIMITS.get(usize::from(opcode.0)).map_or(0, |limit| *limit as usize)
}

impl Ring {
    /// Adds a byte, if there is room for it.
    #[inline(always)]
    pub(crate) fn push(&mut self, byte: u8) -> bool {
        let start = self.start.cast_unsigned() as usize;
        let used = self.used.cast_unsigned() as usize;
        if start < DP_BUFSIZE
            && used < DP_BUFSIZE
            && let Some(place) = self.bytes.get_mut(wrap(start.wrapping_add(used)))
        {
            *place = byte;
            self.used = self.used.wrapping_add(1);
            true
        } else {
            false
        }
    }

    /// Judges the head at the start; `None` when it takes more than a glance.
    #[inline(always)]
    pub(crate) fn glance(&mut self) -> Option<Result<Whole, NoFrame>> {
        let start = self.start.cast_unsigned() as usize;
        let used = self.used.cast_unsigned() as usize;
        if start > const { DP_BUFSIZE.wrapping_sub(FRAME_HEAD) } {
            return None;
        }
        let &[first, opcode, length] = self.bytes.get(start..)?.first_chunk()?;
        if first == FRAME_START {
            let (limit, length) = (limit(Opcode(opcode)), usize::from(length));
            if length < limit {
                // Right for 0 to 2 bytes too: what is there of the head is right, and stale bytes let it wait for the rest.
                if used < length.wrapping_add(FRAME_OVERHEAD) {
                    return Some(Err(NoFrame::Waiting));
                }
                return Some(Ok(Whole { start, used, opcode, length }));
            }
            if used == 1 || used == 2 && limit != 0 {
                return Some(Err(NoFrame::Waiting));
            }
        }
        match used {
            0 => Some(Err(NoFrame::Waiting)),
            1 => {
                (self.start, self.used) = (int(start.wrapping_add(1)), 0);
                Some(Err(NoFrame::Garbage))
            }
            _ => None,
        }
    }

    /// Throws away the beginning of a frame that the last byte has shown to be none. Of its bytes only the last can begin
    /// another.
    #[inline(always)]
    pub(crate) fn drop_head(&mut self) -> bool {
        let start = self.start.cast_unsigned() as usize;
        let used = self.used.cast_unsigned() as usize;
        let Some(&[FRAME_START, opcode, length]) = self.bytes.get(start..).and_then(<[u8]>::first_chunk) else {
            return false;
        };
        let limit = limit(Opcode(opcode));
        let last = match used {
            2 if limit == 0 => opcode,
            3 if limit != 0 && usize::from(length) >= limit => length,
            _ => return false,
        };
        let left = usize::from(last == FRAME_START);
        (self.start, self.used) = (int(wrap(start.wrapping_add(used).wrapping_sub(left))), int(left));
        true
    }

    /// Takes the frame that [`glance`](Self::glance) saw, if it is one and lies in one piece.
    #[inline(always)]
    pub(crate) fn take(&mut self, start: usize, used: usize, opcode: u8, length: usize) -> Option<Frame<'_>> {
        let size = length.wrapping_add(FRAME_OVERHEAD);
        let end = start.wrapping_add(size);
        // In one comparison: no byte of it is stale, and the ring holds no more than it can.
        if !is_intact(self.bytes.get(start..end)?, Opcode(opcode))
            || used.wrapping_sub(size) > DP_BUFSIZE.wrapping_sub(size)
        {
            return None;
        }
        (self.start, self.used) = (int(wrap(end)), int(used.wrapping_sub(size)));
        let begin = start.wrapping_add(FRAME_HEAD);
        Some(Frame { opcode: Opcode(opcode), payload: Payload { ring: &self.bytes, begin, length } })
    }
}

/// Whether a frame that begins as it should, and lies in one piece, ends as it should.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the length is a byte of the frame")]
pub(super) fn is_intact(frame: &[u8], opcode: Opcode) -> bool {
    let Some((summed, &[sum, end])) = frame.split_last_chunk() else { return false };
    let Some((_, payload)) = summed.split_first_chunk::<FRAME_HEAD>() else { return false };
    let head = const { FRAME_START.wrapping_add(FRAME_END) }.wrapping_add(opcode.0).wrapping_add(payload.len() as u8);
    end == FRAME_END && sum == bytes::add_up(head, payload)
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::{NoFrame, Ring, Whole};
    use crate::config::{DP_BUFSIZE, DP_DATA_MAX_SIZE};

    const FULL: i32 = super::int(DP_BUFSIZE);

    /// All of a ring that C can see, and what a call told: an opcode with its payload, or why there is none.
    type Outcome = (Result<(u8, Vec<u8>), NoFrame>, Vec<u8>, i32, i32);

    fn outcome(ring: &Ring, answer: Result<(u8, Vec<u8>), NoFrame>) -> Outcome {
        (answer, ring.bytes.to_vec(), ring.start, ring.used)
    }

    /// What the long way does.
    fn searched(mut ring: Ring) -> Outcome {
        let answer = ring.search(false).map(|frame| (frame.opcode.0, frame.payload.iter().collect()));
        outcome(&ring, answer)
    }

    /// What the short way does, or `None` when it declines.
    fn short(mut ring: Ring) -> Option<Outcome> {
        let before = outcome(&ring, Err(NoFrame::Waiting));
        let answer = match ring.glance() {
            Some(Ok(Whole { start, used, opcode, length })) => {
                ring.take(start, used, opcode, length).map(|frame| Ok((frame.opcode.0, frame.payload.iter().collect())))
            }
            Some(Err(none)) => Some(Err(none)),
            None => ring.drop_head().then_some(Err(NoFrame::Garbage)),
        };
        if answer.is_none() {
            assert_eq!(outcome(&ring, Err(NoFrame::Waiting)), before, "it declined and changed something");
        }
        answer.map(|answer| outcome(&ring, answer))
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
            1 => prop::collection::vec(prop_oneof![Just(b'$'), Just(b'M'), any::<u8>()], 0..4),
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
            if let Some(outcome) = short(ring) {
                prop_assert_eq!(outcome, expected);
            }
        }

        #[test]
        fn a_byte_is_pushed_as_it_would_be_appended(start in field(), used in field(), byte: u8) {
            let mut ring = Ring::new();
            (ring.start, ring.used) = (start, used);
            let mut other = ring.clone();
            if ring.push(byte) {
                prop_assert_eq!(other.append(&[byte]), Ok(()));
            }
            if ring.used != used {
                prop_assert_eq!(outcome(&ring, Err(NoFrame::Waiting)), outcome(&other, Err(NoFrame::Waiting)));
            }
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
