//! Floating-point numbers of either width, and vectors of three.

use core::ops::{Add, Div, Mul, Neg, Sub};

use super::Error;

/// A floating-point number: of 64 bits, or 32 where a processor has no more.
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

pub(super) fn add<R: Real>([ax, ay, az]: [R; 3], [bx, by, bz]: [R; 3]) -> [R; 3] {
    [ax + bx, ay + by, az + bz]
}

pub(super) fn sub<R: Real>([ax, ay, az]: [R; 3], [bx, by, bz]: [R; 3]) -> [R; 3] {
    [ax - bx, ay - by, az - bz]
}

pub(super) fn scale<R: Real>([x, y, z]: [R; 3], by: R) -> [R; 3] {
    [x * by, y * by, z * by]
}

pub(super) fn dot<R: Real>([ax, ay, az]: [R; 3], [bx, by, bz]: [R; 3]) -> R {
    ax * bx + ay * by + az * bz
}

pub(super) fn cross<R: Real>([ax, ay, az]: [R; 3], [bx, by, bz]: [R; 3]) -> [R; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

pub(super) fn norm<R: Real>(vector: [R; 3]) -> R {
    dot(vector, vector).sqrt()
}

/// The sum of the components without their signs; a NaN when one is.
pub(super) fn size<R: Real>([x, y, z]: [R; 3]) -> R {
    x.abs() + y.abs() + z.abs()
}

/// The same numbers in the width to compute with, if they are numbers.
pub(super) fn finite<R: Real>(vector: [f32; 3]) -> Result<[R; 3], Error> {
    if vector.iter().all(|component| component.is_finite()) { Ok(vector.map(R::from)) } else { Err(Error::Input) }
}
