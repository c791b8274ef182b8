//! What has come, as an item.

use core::ffi::c_int;

use super::super::command::{COMPLETED, Fault, Format, Item, MALFORMED, MASK_AXES, MASK_VELOCITY, MOVE, POSITION};
use super::super::command::{REFUSED, REPORTING, STEP, bit};
use super::super::packed::{NUMBER_MAX, PERIOD_MAX, VELOCITY_MAX, low};
use super::Scanner;

impl Scanner {
    /// Tells what has come, in the format that its first byte told.
    pub(super) fn tell(&mut self, kind: c_int, item: &mut Item) {
        let is_ascii = if kind == COMPLETED { self.number_written() == Format::Ascii } else { self.start == 0 };
        let format = if is_ascii { Format::Ascii } else { Format::Binary };
        let mask = match kind {
            MOVE | STEP | POSITION => self.vector.mask & (MASK_AXES | MASK_VELOCITY),
            _ => 0,
        };
        self.write(kind, format, mask, item);
        match kind {
            REPORTING => item.period = self.vector.velocity & PERIOD_MAX,
            REFUSED => item.code = low(self.value),
            _ => {}
        }
        self.number_format = 0;
    }

    /// Tells a binary vector.
    #[inline(always)]
    pub(super) fn tell_vector(&mut self, kind: c_int, item: &mut Item) {
        self.write(kind, Format::Binary, self.vector.mask & (MASK_AXES | MASK_VELOCITY), item);
        self.number_format = 0;
    }

    pub(super) fn tell_malformed(&mut self, fault: Fault, format: Format, item: &mut Item) {
        self.write(MALFORMED, format, 0, item);
        item.code = fault as u8;
        self.number_format = 0;
    }

    /// Fills an item in. Whatever was in the memory of a C caller, no value is out of its range.
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    fn write(&self, kind: c_int, format: Format, mask: u8, item: &mut Item) {
        item.kind = kind;
        item.format = format as u8;
        item.number.format = match self.number_format {
            0 => 0,
            _ => self.number_written() as u8,
        };
        item.number.value = if item.number.format == 0 { 0 } else { self.number & NUMBER_MAX };
        item.code = 0;
        item.period = 0;
        item.vector.mask = mask;
        item.vector.velocity = if mask & MASK_VELOCITY == 0 { 0 } else { self.vector.velocity & VELOCITY_MAX };
        for (axis, (place, value)) in item.vector.axes.iter_mut().zip(&self.vector.axes).enumerate() {
            *place = if mask & bit(axis) == 0 { 0 } else { value.wrapping_shl(4).wrapping_shr(4) };
        }
    }
}
