//! The width of the numbers: 64 bits, or 32 where a processor has no more.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// A floating-point number.
pub trait Real:
    Copy
    + PartialOrd
    + From<f32>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;

    /// The square root.
    #[must_use]
    fn sqrt(self) -> Self;

    /// The nearest float.
    #[must_use]
    fn to_f32(self) -> f32;

    /// Without its sign.
    #[must_use]
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }

    /// The larger one, or `other` when `self` is a NaN.
    #[must_use]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }

    #[expect(clippy::cast_possible_truncation, reason = "it rounds")]
    fn to_f32(self) -> f32 {
        self as f32
    }
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    fn sqrt(self) -> Self {
        libm::sqrtf(self)
    }

    fn to_f32(self) -> f32 {
        self
    }
}
