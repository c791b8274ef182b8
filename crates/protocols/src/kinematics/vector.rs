//! Vectors of three numbers.

use super::{Error, Real};

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
