//! Where the coordinates of a file lie in space.

use super::vector::{add, cross, dot, norm, scale, sub};

/// A plane in space, with the length that the file's unit has there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    origin: [f64; 3],
    /// Unit vectors along the file's x and y, and towards its z.
    axes: [[f64; 3]; 3],
    scale: f64,
}

impl Plane {
    /// The plane through `origin`, where the file's x goes along `right` and its y along `up`, made perpendicular to that.
    /// What is drawn stands upright for who looks against the file's z, which is perpendicular to both.
    ///
    /// # Errors
    ///
    /// Directions that span no plane, a scale that is not above zero, and numbers that are not finite.
    pub fn new(origin: [f64; 3], right: [f64; 3], up: [f64; 3], scale_by: f64) -> Result<Self, String> {
        if !origin.iter().chain(&right).chain(&up).all(|number| number.is_finite()) {
            return Err("the plane has a number that is not finite".into());
        }
        if !(scale_by.is_finite() && scale_by > 0.0) {
            return Err("the scale must be above zero".into());
        }
        let unit = |vector| {
            let length = norm(vector);
            let unit = scale(vector, 1.0 / length);
            // Not where the square of the length is too large or too small for a number.
            (0.9..1.1).contains(&norm(unit)).then_some(unit)
        };
        let none = || "the plane's directions to the right and up must be two different ones".to_owned();
        let (right, up) = (unit(right).ok_or_else(none)?, unit(up).ok_or_else(none)?);
        let across = sub(up, scale(right, dot(up, right)));
        // Nearly the same direction leaves only what was rounded.
        if norm(across) < 1e-6 {
            return Err(none());
        }
        let up = unit(across).ok_or_else(none)?;
        Ok(Self { origin, axes: [right, up, cross(right, up)], scale: scale_by })
    }

    /// Where a point of the file is.
    #[must_use]
    pub fn place(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [right, up, out] = self.axes;
        let along = add(add(scale(right, x), scale(up, y)), scale(out, z));
        add(self.origin, scale(along, self.scale))
    }

    /// How far to the right and up a point in space is, seen on the plane.
    #[must_use]
    pub fn seen(&self, at: [f64; 3]) -> [f64; 2] {
        let [right, up, _] = self.axes;
        let from_origin = sub(at, self.origin);
        [dot(from_origin, right), dot(from_origin, up)]
    }
}

/// The least tolerance. Below that, the floats that the robot is sent begin to count.
const TOLERANCE_MIN: f64 = 1e-5;

/// How a file becomes a path in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    plane: Plane,
    tolerance: f64,
    lift: f64,
}

impl Placement {
    /// The path keeps to what the file has to within `tolerance`, and travels `lift` above the plane, where the file does
    /// not say how; both in metres, the unit of the machine's geometry.
    ///
    /// # Errors
    ///
    /// A tolerance below a hundredth of a millimetre, a lift below zero, and numbers that are not finite.
    pub fn new(plane: Plane, tolerance: f64, lift: f64) -> Result<Self, String> {
        if !(tolerance.is_finite() && tolerance >= TOLERANCE_MIN) {
            return Err(format!("the tolerance must be at least {TOLERANCE_MIN}"));
        }
        if !(lift.is_finite() && lift >= 0.0) {
            return Err("the lift can't be below zero".into());
        }
        Ok(Self { plane, tolerance, lift })
    }

    /// The plane.
    #[must_use]
    pub const fn plane(&self) -> &Plane {
        &self.plane
    }

    /// The tolerance.
    #[must_use]
    pub const fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// With only so much of the tolerance.
    pub(super) fn with_part(self, part: f64) -> Self {
        Self { tolerance: self.tolerance * part, ..self }
    }

    /// The tolerance in the file's unit.
    pub(super) fn file_tolerance(&self) -> f64 {
        self.tolerance / self.plane.scale
    }

    /// The lift in the file's unit.
    pub(super) fn file_lift(&self) -> f64 {
        self.lift / self.plane.scale
    }
}

#[cfg(test)]
mod tests {
    use super::Plane;

    #[test]
    fn points_are_placed_and_seen() {
        let plane = Plane::new([1.0, 2.0, 3.0], [2.0, 0.0, 0.0], [5.0, 0.0, 0.1], 0.001).unwrap();
        let at = plane.place([100.0, 50.0, 10.0]);
        for (is, wanted) in at.into_iter().zip([1.1, 1.99, 3.05]) {
            assert!((is - wanted).abs() < 1e-12, "{at:?}");
        }
        let [right, up] = plane.seen(at);
        assert!((right - 0.1).abs() < 1e-12 && (up - 0.05).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_plane_is_refused() {
        let (x, y) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        for (origin, right, up, scale) in [
            ([f64::NAN; 3], x, y, 1.0),
            ([0.0; 3], x, [-3.0, 0.0, 1e-9], 1.0),
            ([0.0; 3], [0.0; 3], y, 1.0),
            ([0.0; 3], [1e-320, 0.0, 0.0], y, 1.0),
            ([0.0; 3], [1e300, 0.0, 0.0], y, 1.0),
            ([0.0; 3], x, y, 0.0),
            ([0.0; 3], x, y, f64::INFINITY),
        ] {
            assert!(Plane::new(origin, right, up, scale).is_err(), "{origin:?} {right:?} {up:?} {scale}");
        }
    }
}
