//! Vectors: the values of up to six axes, and a velocity.

use zerocopy::{FromBytes, Immutable, KnownLayout};

use super::packed::{HIGH, POSITION_MIN, is_position, push, signed7, signed28};

/// The axes: x, y, z, a, b, c.
pub const AXES: usize = 6;
/// The bits of a mask that flag axes: bit i is axis i.
pub const MASK_AXES: u8 = 0x3F;
/// The bit of a mask that flags a velocity.
pub const MASK_VELOCITY: u8 = 0x40;

/// Axes and velocity: a target, the deltas of a step, or a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, FromBytes, Immutable, KnownLayout)]
#[repr(C)]
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
    pub const fn new() -> Self {
        Self { velocity: 0, mask: 0, axes: [0; AXES] }
    }

    /// The value of an axis, 0 to 5, if it has one.
    pub fn axis(&self, axis: usize) -> Option<i32> {
        self.axes.get(axis).copied().filter(|_| self.has(axis))
    }

    /// Whether an axis has a value.
    pub const fn has(&self, axis: usize) -> bool {
        axis < AXES && self.mask >> axis & 1 == 1
    }

    /// The velocity, if it has one. Without it, that of the last vector holds.
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

    /// Reads packed values of axes, of 4 bytes or of 1, as far as they lie in one piece. Clears their flags, and returns
    /// what is behind them.
    #[inline(always)]
    pub(super) fn unpack<'a>(&mut self, flags: &mut u8, bytes: &'a [u8], is_short: bool) -> &'a [u8] {
        let (mut rest, mut left) = (bytes, *flags);
        while let Some(place) = self.axes.get_mut(left.trailing_zeros() as usize) {
            if is_short {
                let Some((&byte @ HIGH.., behind)) = rest.split_first() else { break };
                *place = signed7(byte);
                rest = behind;
            } else {
                let Some((&groups, behind)) = rest.split_first_chunk() else { break };
                if u32::from_ne_bytes(groups) & 0x8080_8080 != 0x8080_8080 {
                    break;
                }
                *place = signed28(groups.into_iter().fold(0, push));
                rest = behind;
            }
            left &= left.wrapping_sub(1);
        }
        *flags = left;
        rest
    }

    /// Makes it another's copy. Field by field, which never becomes a call of memcpy.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
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
    /// are deltas. The velocity goes with it. When it can't be followed, nothing changes.
    pub fn follow(&mut self, vector: &Self, is_step: bool) -> Result<(), Lost> {
        // All of it or nothing: the first round only looks.
        let mut writes = false;
        loop {
            let (mut flags, mut known) = (vector.mask & MASK_AXES, self.mask);
            for (place, value) in self.axes.iter_mut().zip(&vector.axes) {
                if flags == 0 {
                    break;
                }
                if flags & 1 != 0 {
                    let mut value = *value;
                    if is_step {
                        if known & 1 == 0 {
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
                flags >>= 1;
                known >>= 1;
            }
            if writes {
                break;
            }
            writes = true;
        }
        self.mask |= vector.mask;
        if vector.mask & MASK_VELOCITY != 0 {
            self.velocity = vector.velocity;
        }
        Ok(())
    }

    /// A checksum of 7 bits of a move's number and of the values that `named` flags: a residue modulo 127, which differs
    /// for values that are a power of two apart, as one flipped bit makes them.
    pub fn check(&self, named: u8, number: u16) -> u8 {
        let velocity = if named & MASK_VELOCITY == 0 { 0 } else { self.velocity };
        let mut sum = add(add(0, number.into()), velocity.into());
        let mut flags = named;
        for value in &self.axes {
            // From 0 on: the sign of two's complement would be worth 16.
            sum = add(sum, if flags & 1 == 0 { 0 } else { value.wrapping_sub(POSITION_MIN).cast_unsigned() });
            flags >>= 1;
        }
        if sum >= 127 { sum.wrapping_sub(127) } else { sum }
    }
}

/// The residue modulo 127 (up to 178) of a number to which 32 bits are appended.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
fn add(sum: u8, value: u32) -> u8 {
    // 256 is 2 modulo 127, and 128 is 1.
    let [first, second, third, fourth] = value.to_le_bytes();
    let append = |sum: u16, byte: u8| sum.wrapping_mul(2).wrapping_add(byte.into());
    let wide = append(append(append(append(sum.into(), fourth), third), second), first);
    let [low, high] = wide.wrapping_add(wide).to_le_bytes();
    (low >> 1).wrapping_add(high)
}

/// The bit of an axis.
#[inline(always)]
pub(super) const fn bit(axis: usize) -> u8 {
    if axis < AXES { 1 << axis } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_of_two_changes_the_check() {
        let vector = Vector { velocity: 1000, mask: 0x43, axes: [-3, 70_000_000, 5, 6, 7, 8] };
        let check = |change: &dyn Fn(&mut Vector)| {
            let mut changed = vector;
            change(&mut changed);
            changed.check(vector.mask, 77)
        };
        let before = check(&|_| ());
        assert!(before < 127);
        for (bit, axis, sign) in (0..27).flat_map(|bit| [(bit, 0, 1), (bit, 0, -1), (bit, 1, 1), (bit, 1, -1)]) {
            if is_position(vector.axes[axis] + (sign << bit)) {
                assert_ne!(check(&|vector| vector.axes[axis] += sign << bit), before, "bit {bit} of axis {axis}");
            }
        }
        for bit in 0..14 {
            assert_ne!(check(&|vector| vector.velocity ^= 1 << bit), before);
            assert_ne!(vector.check(vector.mask, 77 + (1 << bit)), before);
        }
        assert_eq!(check(&|vector| vector.axes[2] = 9), before);
        assert_ne!(check(&|vector| vector.axes.swap(0, 1)), before);
    }
}
