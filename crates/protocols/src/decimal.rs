//! Floats as decimal text and back: exact, without floating-point arithmetic and without division.
//!
//! A float is an integer times a power of two, so its decimal expansion ends: at most 39 digits before the point and
//! 149 behind it. All of them are worked out, then rounded.

use zerocopy::IntoBytes;

mod read;
mod write;

pub use read::read_float;
pub use write::{DECIMALS_MAX, write_fixed, write_float};

/// Digits before the point: the largest float has 39.
const WHOLE: usize = 40;
/// Digits in all. Half the smallest float has 150 behind the point.
const SIZE: usize = WHOLE + 150;

/// A decimal number with a fixed point.
struct Digits<'a> {
    /// One digit a byte; those outside of `first..end` are zero.
    digit: &'a mut [u8],
    first: usize,
    end: usize,
    /// Whether there is more than the digits say, less than a unit of the last.
    more: bool,
}

impl<'a> Digits<'a> {
    /// Zero, in room that is zero.
    fn zero(room: &'a mut [u16; SIZE / 2]) -> Self {
        Self { digit: room.as_mut_bytes(), first: WHOLE, end: WHOLE, more: false }
    }

    fn get(&self, place: usize) -> u8 {
        self.digit.get(place).copied().unwrap_or_default()
    }

    /// Multiplies by 2^`bits`, 4 at most, and adds `carry`, below 16, to the last digit there is.
    fn multiply(&mut self, bits: u8, mut carry: u8) {
        for digit in self.digit.get_mut(self.first..self.end).unwrap_or_default().iter_mut().rev() {
            let value = digit.wrapping_shl(bits.into()).wrapping_add(carry);
            carry = tenth(value);
            *digit = value.wrapping_sub(carry.wrapping_mul(10));
        }
        while carry > 0 {
            let next = tenth(carry);
            self.first = self.first.saturating_sub(1);
            if let Some(digit) = self.digit.get_mut(self.first) {
                *digit = carry.wrapping_sub(next.wrapping_mul(10));
            }
            carry = next;
        }
    }

    /// Divides by 2^`bits`, 4 at most.
    fn divide(&mut self, bits: u8) {
        let mut carry = 0_u8;
        for (place, digit) in self.digit.iter_mut().enumerate().skip(self.first) {
            if place >= self.end {
                if carry == 0 {
                    break;
                }
                self.end = place.wrapping_add(1);
            }
            let value = carry.wrapping_mul(10).wrapping_add(*digit);
            *digit = value.wrapping_shr(bits.into());
            carry = value.wrapping_sub(digit.wrapping_shl(bits.into()));
        }
        self.more |= carry != 0;
        while self.first < self.end && self.get(self.first) == 0 {
            self.first = self.first.wrapping_add(1);
        }
    }

    /// Whether the part from this place on is more than half a unit of the digit before, or half with that digit odd:
    /// whether to round up to that digit.
    fn rounds_up(&self, place: usize) -> bool {
        let behind = place.wrapping_add(1)..self.end;
        let more = self.more || self.digit.get(behind).unwrap_or_default().iter().any(|digit| *digit != 0);
        let odd = place > 0 && self.get(place.wrapping_sub(1)) & 1 == 1;
        self.get(place) > 5 || self.get(place) == 5 && (more || odd)
    }
}

/// A tenth of a number below 178, rounded down.
const fn tenth(value: u8) -> u8 {
    ((value as u16).wrapping_mul(103) >> 10) as u8
}
