//! A position of the platform: the displacements of its three arms.

use core::ffi::c_uchar;

/// Bytes of a position on the wire.
pub const POSITION_SIZE: usize = 12;

/// Displacements of the arms A, B and C as the bit patterns of IEEE-754 floats.
///
/// Bits and not floats: a position nobody knows travels as a signalling NaN, 0x7F800001, and a processor may turn that
/// into another NaN when it only loads it. Nothing here needs floating-point arithmetic, which small controllers lack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position(pub [u32; 3]);

impl Position {
    /// What shipped firmware reports before homing.
    pub const UNKNOWN: Self = Self([0x7F80_0001; 3]);

    /// The position that 12 bytes from the wire stand for.
    #[inline]
    #[must_use]
    pub const fn from_wire(bytes: &[c_uchar; POSITION_SIZE]) -> Self {
        let &[a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3] = bytes;
        Self([
            u32::from_le_bytes([a0, a1, a2, a3]),
            u32::from_le_bytes([b0, b1, b2, b3]),
            u32::from_le_bytes([c0, c1, c2, c3]),
        ])
    }

    /// The bytes for the wire.
    #[inline]
    #[must_use]
    pub const fn to_wire(self) -> [c_uchar; POSITION_SIZE] {
        let [a, b, c] = self.0;
        let ([a0, a1, a2, a3], [b0, b1, b2, b3], [c0, c1, c2, c3]) =
            (a.to_le_bytes(), b.to_le_bytes(), c.to_le_bytes());
        [a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3]
    }

    /// Whether the bits are the same. Unlike `==`, this never becomes a call of memcmp.
    #[inline]
    #[must_use]
    pub const fn is_same(self, other: Self) -> bool {
        let ([this_a, this_b, this_c], [a, b, c]) = (self.0, other.0);
        this_a == a && this_b == b && this_c == c
    }

    /// Whether no displacement is a NaN. An unknown position asks for homing (specification, "Status Report").
    #[must_use]
    pub fn is_known(self) -> bool {
        self.0.iter().all(|bits| magnitude(*bits) <= INFINITY)
    }

    /// Whether every displacement is a number that a platform could move to: neither a NaN nor infinite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.0.iter().all(|bits| magnitude(*bits) < INFINITY)
    }

    /// Whether no displacement differs from the other position's by more than `tolerance`, a float's bits. Worked out
    /// in units of 1/1024, so up to 1/512 may be added to the tolerance. Not for unknown positions, nor from
    /// half a million on.
    #[must_use]
    pub fn is_near(self, other: Self, tolerance: u32) -> bool {
        let allowed = fixed(tolerance).unwrap_or_default().unsigned_abs().wrapping_add(1);
        self.0.iter().zip(other.0).all(|(one, other)| match (fixed(*one), fixed(other)) {
            (Some(one), Some(other)) => one.abs_diff(other) <= allowed,
            _ => false,
        })
    }
}

const INFINITY: u32 = 0x7F80_0000;

/// The bits without the sign's.
const fn magnitude(bits: u32) -> u32 {
    bits & 0x7FFF_FFFF
}

/// A float's value in units of 1/1024, rounded towards zero; `None` from 2^19 on.
fn fixed(bits: u32) -> Option<i32> {
    /// The biased exponent of a float whose significand, seen as an integer, counts the units.
    const UNITS: u32 = 127 + 23 - 10;
    let significand = bits & 0x7F_FFFF | 0x80_0000;
    let exponent = magnitude(bits) >> 23;
    let units = match exponent.checked_sub(UNITS) {
        None => significand.checked_shr(UNITS.wrapping_sub(exponent)).unwrap_or_default(),
        Some(shift @ 0..=5) => significand.wrapping_shl(shift),
        Some(_) => return None,
    };
    let units = i32::try_from(units).ok()?;
    Some(if bits == magnitude(bits) { units } else { units.wrapping_neg() })
}

#[cfg(test)]
mod tests {
    use super::{Position, fixed};

    fn at(a: f32, b: f32, c: f32) -> Position {
        Position([a.to_bits(), b.to_bits(), c.to_bits()])
    }

    #[test]
    fn bytes_of_the_wire_are_little_endian_and_keep_a_signalling_nan() {
        let wire = [0, 0, 0x80, 0x3F, 1, 0, 0x80, 0x7F, 0, 0, 0x60, 0xC0];
        let position = Position::from_wire(&wire);
        assert_eq!(position, Position([0x3F80_0000, 0x7F80_0001, 0xC060_0000]));
        assert_eq!(position.to_wire(), wire);
    }

    #[test]
    fn nan_is_unknown_and_infinity_is_not_finite() {
        assert!(at(0.0, -1.5, f32::MAX).is_known() && at(0.0, -1.5, f32::MAX).is_finite());
        for nan in [0x7F80_0001, 0xFF80_0001, 0x7FC0_0000, 0xFFFF_FFFF] {
            for place in 0..3 {
                let mut bits = [0; 3];
                bits[place] = nan;
                assert!(!Position(bits).is_known() && !Position(bits).is_finite());
            }
        }
        assert!(at(0.0, f32::NEG_INFINITY, 0.0).is_known());
        assert!(!at(0.0, f32::NEG_INFINITY, 0.0).is_finite());
    }

    #[test]
    fn fixed_is_the_value_cut_to_units() {
        for value in
            [0.0_f32, -0.0, 1e-40, 0.0009, 0.001, 0.126, 1.0, -1.0, 2.5, -37.25, 1024.3, 524_287.9, -524_287.97]
        {
            #[expect(clippy::cast_possible_truncation, reason = "what is compared with")]
            let units = (f64::from(value) * 1024.0) as i32;
            assert_eq!(fixed(value.to_bits()), Some(units), "{value}");
        }
        for value in [524_288.0_f32, -1e9, f32::MAX, f32::INFINITY, f32::NAN] {
            assert_eq!(fixed(value.to_bits()), None, "{value}");
        }
    }

    #[test]
    fn near_means_every_arm_within_the_tolerance() {
        let tolerance = 0.126_f32.to_bits();
        let target = at(1.0, -2.0, 30.0);
        assert!(target.is_near(target, 0));
        assert!(at(1.12, -2.12, 29.88).is_near(target, tolerance));
        assert!(!at(1.13, -2.0, 30.0).is_near(target, tolerance));
        assert!(!at(1.0, -2.13, 30.0).is_near(target, tolerance));
        assert!(!at(1.0, 2.0, 30.0).is_near(target, tolerance));
        assert!(!at(1.0, -2.0, 32.5).is_near(target, tolerance));
        assert!(!Position::UNKNOWN.is_near(target, tolerance));
        assert!(!at(1e9, 0.0, 0.0).is_near(at(1e9, 0.0, 0.0), tolerance));
    }
}
