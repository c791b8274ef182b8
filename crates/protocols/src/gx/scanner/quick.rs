//! The way of hosts through packed bytes, many at once: what it takes, [`Scanner::step`] would take in the same way. It
//! matters for the commands that come in two parts.

use core::ffi::c_int;

use super::super::command::{AXES, MASK_VELOCITY, MOVE, POSITION, STEP};
use super::super::packed::{FOUR_HIGH, HIGH, push, signed, unpack28};
use super::{IDLE, MASK, NUMBER, NUMBER_PACKED, NUMBERED, Scanner, Step, VALUE};

impl Scanner {
    /// Takes what `bytes` begin with of a binary command, up to its end or a byte that is for [`step`](Self::step).
    /// Tells what that leaves, and the kind of what is complete, or 0.
    #[inline(always)]
    pub(super) fn quick<'a, const HOST: bool>(&mut self, bytes: &'a [u8]) -> (&'a [u8], c_int) {
        let (mut rest, mut state) = (bytes, self.state);
        if !HOST && state < VALUE {
            if state == IDLE
                && let [b'#', behind @ ..] = rest
            {
                (rest, state) = (behind, NUMBER);
            }
            if state == NUMBER
                && let [byte @ HIGH..=0xFF, behind @ ..] = rest
            {
                self.value = push(0, *byte);
                (rest, state) = (behind, NUMBER_PACKED);
            }
            if state == NUMBER_PACKED
                && let [byte @ HIGH..=0xFF, behind @ ..] = rest
            {
                self.value = push(self.value, *byte);
                self.whole_number();
                (rest, state) = (behind, NUMBERED);
            }
            if matches!(state, IDLE | NUMBERED)
                && let [start @ (b'!' | b'*'), behind @ ..] = rest
            {
                self.enter(*start);
                (rest, state) = (behind, MASK);
            }
            if state == MASK
                && let [mask @ 0x81..=0xFF, behind @ ..] = rest
            {
                self.vector.mask = *mask & !HIGH;
                self.left = *mask & !HIGH;
                self.place = self.first_groups();
                (rest, state) = (behind, VALUE);
            }
            self.state = state;
        }
        if state != VALUE || self.start == b'~' {
            return (rest, 0);
        }
        while self.left & MASK_VELOCITY != 0 {
            let [byte @ HIGH..=0xFF, behind @ ..] = rest else { return (rest, 0) };
            rest = behind;
            if let Step::Done(kind) = self.packed(*byte) {
                return (rest, kind);
            }
        }
        if self.start == b'*' { self.deltas(rest) } else { self.positions::<HOST>(bytes, rest) }
    }

    /// Packed bytes of deltas.
    #[inline(always)]
    fn deltas<'a>(&mut self, bytes: &'a [u8]) -> (&'a [u8], c_int) {
        let (mut rest, mut left) = (bytes, self.left);
        while let [byte @ HIGH..=0xFF, behind @ ..] = rest {
            put(&mut self.vector.axes, left, i32::from((*byte << 1).cast_signed() >> 1));
            rest = behind;
            left &= left.wrapping_sub(1);
            if left == 0 {
                self.state = IDLE;
                return (rest, STEP);
            }
        }
        self.left = left;
        (rest, 0)
    }

    /// Packed bytes of positions, which are the last ones of `bytes`.
    #[inline(always)]
    fn positions<'a, const HOST: bool>(&mut self, bytes: &'a [u8], values: &'a [u8]) -> (&'a [u8], c_int) {
        let (mut rest, mut left) = (values, self.left);
        // The one of which some bytes have come.
        if let place @ 1..=3 = self.place {
            let Some(word) = rest.first_chunk() else { return (rest, 0) };
            let come = u32::from(place) << 3;
            let groups =
                self.value.wrapping_shr(come) | u32::from_le_bytes(*word).wrapping_shl(32_u32.wrapping_sub(come));
            if groups & FOUR_HIGH != FOUR_HIGH {
                return (rest, 0);
            }
            put(&mut self.vector.axes, left, signed(unpack28(groups), false));
            left &= left.wrapping_sub(1);
            self.place = 4;
            rest = rest.get(usize::from(place)..).unwrap_or_default();
        }
        while left != 0 {
            let Some((groups, behind)) = rest.split_first_chunk() else { break };
            let groups = u32::from_le_bytes(*groups);
            if groups & FOUR_HIGH != FOUR_HIGH {
                break;
            }
            put(&mut self.vector.axes, left, signed(unpack28(groups), false));
            left &= left.wrapping_sub(1);
            rest = behind;
        }
        self.left = left;
        if left == 0 {
            self.state = IDLE;
            return (rest, if HOST { POSITION } else { MOVE });
        }
        // The beginning of one: the last bytes are the highest.
        let (place, highs) = match rest {
            [_] => (3, 0x8000_0000),
            [_, _] => (2, 0x8080_0000),
            [_, _, _] => (1, 0x8080_8000),
            _ => return (rest, 0),
        };
        let Some(last) = bytes.last_chunk() else { return (rest, 0) };
        let value = u32::from_le_bytes(*last);
        if value & highs != highs {
            return (rest, 0);
        }
        (self.value, self.place) = (value, place);
        (&[], 0)
    }
}

/// Gives the first of these axes its value.
#[inline(always)]
fn put(places: &mut [i32; AXES], axes: u8, value: i32) {
    if let Some(place) = places.get_mut(axes.trailing_zeros() as usize) {
        *place = value;
    }
}
