//! The vectors that are written with packed bytes.

use super::super::command::{Fault, Format, MASK_AXES, MASK_VELOCITY, MOVE, POSITION, REPORTING, STEP};
use super::super::packed::{HIGH, push, signed, unpack28, unsigned14};
use super::{MASK, Scanner, Step, VALUE};

impl Scanner {
    /// The first byte of a vector.
    #[inline]
    pub(super) fn enter(&mut self, start: u8) -> Step {
        self.start = start;
        self.state = MASK;
        Step::Taken
    }

    /// The mask of a vector.
    #[inline]
    pub(super) fn flagged(&mut self, byte: u8) -> Step {
        let mask = byte & !HIGH;
        if mask == 0 {
            return Step::Refused(Fault::Empty, Format::Binary);
        }
        if self.start == b'=' && mask & MASK_VELOCITY != 0 {
            return Step::Refused(Fault::Syntax, Format::Binary);
        }
        self.vector.mask = mask;
        self.left = mask;
        self.state = VALUE;
        self.place = self.first_groups();
        Step::Taken
    }

    /// Packed bytes of the first value.
    pub(super) const fn first_groups(&self) -> u8 {
        if self.vector.mask & MASK_VELOCITY != 0 { 2 } else { self.groups() }
    }

    /// Packed bytes of an axis.
    pub(super) const fn groups(&self) -> u8 {
        if self.start == b'*' { 1 } else { 4 }
    }

    /// A byte of a packed value.
    pub(super) fn packed(&mut self, byte: u8) -> Step {
        self.value = push(self.value, byte);
        self.place = self.place.wrapping_sub(1) & 3;
        if self.place == 0 { self.whole_value() } else { Step::Taken }
    }

    /// The end of a packed value.
    #[inline]
    pub(super) fn whole_value(&mut self) -> Step {
        if self.left & MASK_VELOCITY != 0 {
            self.left &= MASK_AXES;
            self.vector.velocity = unsigned14(unpack28(self.value));
        } else {
            let axis = self.left.trailing_zeros() as usize;
            self.left &= self.left.wrapping_sub(1);
            let value = signed(unpack28(self.value), self.start == b'*');
            if let Some(place) = self.vector.axes.get_mut(axis) {
                *place = value;
            }
        }
        if self.left != 0 {
            self.place = self.groups();
            return Step::Taken;
        }
        self.end(match self.start {
            b'*' => STEP,
            b'=' => POSITION,
            b'~' => REPORTING,
            _ => MOVE,
        })
    }
}
