//! Vectors: the values of up to six axes, and a velocity.

use zerocopy::{FromBytes, Immutable, KnownLayout};

use super::packed::is_position;

/// The axes: x, y, z, a, b, c.
pub const AXES: usize = 6;
/// The bits of a mask that flag axes: bit i is axis i.
pub const MASK_AXES: u8 = 0x3F;
/// The bit of a mask that flags a velocity.
pub const MASK_VELOCITY: u8 = 0x40;

/// Axes and velocity: a target, the deltas of a step, or a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, FromBytes, Immutable, KnownLayout)]
pub struct Vector {
    /// Along the vector, in steps per second: 0 to 16383.
    pub velocity: u16,
    /// Which of the values mean something: bit i is `axes[i]`, bit 6 `velocity`.
    pub mask: u8,
    /// x, y, z, a, b, c in steps: positions are -134217728 to 134217727.
    pub axes: [i32; AXES],
}

/// Why a vector can't be followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lost {
    /// It would leave the positions that 28 bits hold.
    Range,
    /// A delta of an axis whose position is not known.
    Unknown,
}

impl Vector {
    /// No axis and no velocity.
    #[must_use]
    pub const fn new() -> Self {
        Self { velocity: 0, mask: 0, axes: [0; AXES] }
    }

    /// The value of an axis, 0 to 5, if it has one.
    #[must_use]
    pub fn axis(&self, axis: usize) -> Option<i32> {
        self.axes.get(axis).copied().filter(|_| self.has(axis))
    }

    /// Whether an axis has a value.
    #[must_use]
    pub const fn has(&self, axis: usize) -> bool {
        axis < AXES && self.mask >> axis & 1 == 1
    }

    /// The velocity, if it has one. Without it, that of the last vector holds.
    #[must_use]
    pub const fn velocity(&self) -> Option<u16> {
        if self.mask & MASK_VELOCITY == 0 { None } else { Some(self.velocity) }
    }

    /// Gives an axis, 0 to 5, a value.
    pub fn set(&mut self, axis: usize, value: i32) {
        if let Some(place) = self.axes.get_mut(axis) {
            *place = value;
            self.mask |= bit(axis);
        }
    }

    /// Gives it a velocity.
    pub const fn set_velocity(&mut self, velocity: u16) {
        self.velocity = velocity;
        self.mask |= MASK_VELOCITY;
    }

    /// Makes it another's copy. Field by field, which never becomes a call of memcpy.
    pub fn copy(&mut self, from: &Self) {
        self.velocity = from.velocity;
        self.mask = from.mask;
        for (place, value) in self.axes.iter_mut().zip(&from.axes) {
            *place = *value;
        }
    }

    /// Takes over the values that another vector has, the velocity among them.
    pub fn merge(&mut self, from: &Self) {
        // All are positions already, so this can't fail.
        let _ = self.follow(from, false);
    }

    /// Moves a position, whose mask flags the known axes, to where a vector leads: to its values, or on by them if they
    /// are deltas. The velocity goes with it.
    ///
    /// # Errors
    ///
    /// See [`Lost`]; nothing has changed then.
    pub fn follow(&mut self, vector: &Self, is_step: bool) -> Result<(), Lost> {
        // All of it or nothing: the first round only looks.
        for writes in [false, true] {
            for (axis, place) in self.axes.iter_mut().enumerate() {
                if vector.mask & bit(axis) == 0 {
                    continue;
                }
                let mut value = vector.axes.get(axis).copied().unwrap_or_default();
                if is_step {
                    if self.mask & bit(axis) == 0 {
                        return Err(Lost::Unknown);
                    }
                    value = value.wrapping_add(*place);
                }
                if !is_position(value) {
                    return Err(Lost::Range);
                }
                if writes {
                    *place = value;
                }
            }
        }
        self.mask |= vector.mask;
        if vector.mask & MASK_VELOCITY != 0 {
            self.velocity = vector.velocity;
        }
        Ok(())
    }
}

/// The bit of an axis.
#[inline(always)]
pub(super) const fn bit(axis: usize) -> u8 {
    if axis < AXES { 1 << axis } else { 0 }
}
