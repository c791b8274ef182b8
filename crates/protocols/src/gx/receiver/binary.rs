//! The packed bytes of a vector.

use super::{CODE, DIGITS, FLAGS, MASK_DUE, NUMBER, NUMBERED, Receiver, Step, VALUE_DUE};
use crate::bytes::WIDE;
use crate::gx::message::{Fault, Format, Kind, Numbered};
use crate::gx::packed::{HIGH, push, signed7, signed28, unsigned14};
use crate::gx::vector::{MASK_AXES, MASK_VELOCITY};

impl<const NOTICES: bool> Receiver<NOTICES> {
    /// The mask behind the first byte.
    pub(super) fn mask(&mut self, byte: u8) -> Step {
        let mask = byte & !HIGH;
        if mask == 0 {
            return self.refuse(byte, Fault::Empty, true);
        }
        self.vector.mask = mask;
        self.left = mask;
        self.place = if mask & MASK_VELOCITY != 0 { 2 } else { self.groups() };
        self.state = VALUE_DUE;
        Step::Taken
    }

    /// On hosts, takes the values of axes that lie in one piece and are due.
    #[inline(always)]
    pub(super) fn whole_values(&mut self, bytes: &mut &[u8]) -> Step {
        if WIDE && self.state == VALUE_DUE && self.left & MASK_VELOCITY == 0 && self.place == self.groups() {
            *bytes = self.vector.unpack(&mut self.left, bytes, self.start == b'*');
            if self.left == 0 {
                return self.vector_ends();
            }
        }
        Step::Taken
    }

    /// Packed bytes of an axis.
    const fn groups(&self) -> u8 {
        if self.start == b'*' { 1 } else { 4 }
    }

    /// A packed byte that is due.
    #[inline]
    pub(super) fn packed(&mut self, byte: u8) -> Step {
        if self.state == MASK_DUE {
            return self.mask(byte);
        }
        self.value = push(self.value, byte);
        self.place = self.place.wrapping_sub(1) & 3;
        if self.place == 0 {
            return self.value_ends(byte);
        }
        self.state &= !DIGITS;
        Step::Taken
    }

    /// The end of a value, with its last byte.
    fn value_ends(&mut self, byte: u8) -> Step {
        let value = unsigned14(self.value);
        match self.state & !FLAGS {
            NUMBER => {
                self.number = Numbered::new(value, Format::Binary);
                self.state = NUMBERED;
                return Step::Taken;
            }
            CODE => {
                self.value = if self.start == b'?' { value >> 7 } else { value }.into();
                return self.end(self.code_kind());
            }
            _ => {}
        }
        if self.left & MASK_VELOCITY != 0 {
            self.left &= MASK_AXES;
            self.vector.velocity = value;
        } else {
            let axis = self.left.trailing_zeros();
            let value = if self.start == b'*' { signed7(byte) } else { signed28(self.value) };
            self.left &= self.left.wrapping_sub(1);
            if let Some(place) = self.vector.axes.get_mut(axis as usize) {
                *place = value;
            }
        }
        if self.left != 0 {
            self.place = self.groups();
            return Step::Taken;
        }
        self.vector_ends()
    }

    /// The end of something binary.
    fn vector_ends(&mut self) -> Step {
        self.end(match self.start {
            b'*' => Kind::Step,
            b'=' => Kind::Position,
            b'~' => Kind::Reporting,
            _ => Kind::Move,
        })
    }
}
