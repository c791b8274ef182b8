//! A position of the platform: the displacements of its three arms.

use zerocopy::{FromBytes, Immutable, KnownLayout, transmute};

/// Bytes of a position on the wire.
pub const POSITION_SIZE: usize = 12;

/// Displacements of the arms A, B and C as the bit patterns of IEEE-754 floats.
///
/// Bits and not floats: a position nobody knows travels as a signalling NaN, 0x7F800001, and a processor may turn that
/// into another NaN when it only loads it. Nothing here needs floating-point arithmetic, which small controllers lack.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromBytes, Immutable, KnownLayout)]
pub struct Position(pub [u32; 3]);

impl Position {
    /// What shipped firmware reports before homing.
    pub const UNKNOWN: Self = Self([0x7F80_0001; 3]);

    /// The position at the beginning of these bytes from the wire, if there are enough.
    #[inline]
    pub(super) fn read(bytes: &[u8]) -> Option<Self> {
        let [a, b, c]: [_; 3] = transmute!(*bytes.first_chunk::<POSITION_SIZE>()?);
        Some(Self([u32::from_le_bytes(a), u32::from_le_bytes(b), u32::from_le_bytes(c)]))
    }

    /// The bytes for the wire.
    #[inline]
    pub const fn to_wire(self) -> [u8; POSITION_SIZE] {
        let [a, b, c] = self.0;
        transmute!([a.to_le_bytes(), b.to_le_bytes(), c.to_le_bytes()])
    }

    /// Whether the bits are the same. Unlike `==`, this never becomes a call of memcmp.
    #[inline]
    pub const fn is_same(self, other: Self) -> bool {
        let ([this_a, this_b, this_c], [a, b, c]) = (self.0, other.0);
        this_a == a && this_b == b && this_c == c
    }

    /// Whether no displacement is a NaN. An unknown position asks for homing (specification, "Status Report").
    pub fn is_known(self) -> bool {
        self.0.iter().all(|bits| magnitude(*bits) <= INFINITY)
    }

    /// Whether every displacement is a number that a platform could move to: neither a NaN nor infinite.
    pub fn is_finite(self) -> bool {
        self.0.iter().all(|bits| magnitude(*bits) < INFINITY)
    }

    /// Whether no displacement differs from the other position's by more than `tolerance`, the bits of a finite float;
    /// a difference that is beyond it by no more than the rounding of a float may count as near. Not for positions that
    /// are not finite.
    pub fn is_near(self, other: Self, tolerance: u32) -> bool {
        self.0.iter().zip(other.0).all(|(one, other)| {
            let largest = magnitude(*one).max(magnitude(other)).max(magnitude(tolerance));
            let units = |bits| units(bits, largest);
            let allowed = units(tolerance).unsigned_abs().wrapping_add(1);
            largest < INFINITY && units(*one).abs_diff(units(other)) <= allowed
        })
    }
}

const INFINITY: u32 = 0x7F80_0000;

/// The bits without the sign's.
const fn magnitude(bits: u32) -> u32 {
    bits & 0x7FFF_FFFF
}

/// A float's value, rounded towards zero, in units so small that the largest float there is has 30 bits.
// Three copies of it are larger.
#[inline(never)]
fn units(bits: u32, largest: u32) -> i32 {
    let exponent = |bits| magnitude(bits) >> 23;
    let significand = bits & 0x7F_FFFF | 0x80_0000;
    let shift = exponent(largest).wrapping_sub(exponent(bits));
    let units = significand.wrapping_shl(6).checked_shr(shift).unwrap_or_default().cast_signed();
    if bits == magnitude(bits) { units } else { units.wrapping_neg() }
}

#[cfg(test)]
mod tests {
    use super::Position;
    use proptest::{prelude::Rng, test_runner::TestRunner};

    fn at(a: f32, b: f32, c: f32) -> Position {
        Position([a.to_bits(), b.to_bits(), c.to_bits()])
    }

    #[test]
    fn nan_is_unknown_and_infinity_is_not_finite() {
        assert!(at(0.0, -1.5, f32::MAX).is_known() && at(0.0, -1.5, f32::MAX).is_finite());
        for nan in [0x7F80_0001, 0xFF80_0001, 0x7FC0_0000, 0xFFFF_FFFF] {
            for bits in [[nan, 0, 0], [0, nan, 0], [0, 0, nan]] {
                assert!(!Position(bits).is_known() && !Position(bits).is_finite());
            }
        }
        assert!(at(0.0, f32::NEG_INFINITY, 0.0).is_known());
        assert!(!at(0.0, f32::NEG_INFINITY, 0.0).is_finite());
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
        assert!(at(1e9, -3e38, 1e-40).is_near(at(1e9, -3e38, 0.0), tolerance));
        assert!(!at(1e9, 0.0, 0.0).is_near(at(1e9 + 64.0, 0.0, 0.0), tolerance));
        assert!(target.is_near(at(1e9, -3e38, 0.0), f32::MAX.to_bits()));
        assert!(!at(f32::INFINITY, 0.0, 0.0).is_near(at(f32::INFINITY, 0.0, 0.0), f32::MAX.to_bits()));
    }

    #[test]
    fn near_is_exact_but_for_rounding() {
        let mut random = TestRunner::deterministic().new_rng();
        // Exponents that are near each other, so that it is a close call.
        let mut float = || f32::from_bits(random.random::<u32>() & 0x83FF_FFFF | 0x4000_0000);
        let mut near = 0;
        for _ in 0..30_000 {
            let (one, other, tolerance) = (float(), float(), float().abs());
            let apart = (f64::from(one) - f64::from(other)).abs();
            let largest = f64::from(one.abs().max(other.abs()).max(tolerance));
            let is_near = at(0.0, one, 0.0).is_near(at(0.0, other, 0.0), tolerance.to_bits());
            let allowed = f64::from(tolerance);
            assert!(is_near || apart > allowed, "{one} {other} {tolerance}");
            assert!(!is_near || apart <= allowed + largest * f64::from(f32::EPSILON), "{one} {other} {tolerance}");
            near += u32::from(is_near);
        }
        assert!((5_000..25_000).contains(&near), "{near}");
    }
}
