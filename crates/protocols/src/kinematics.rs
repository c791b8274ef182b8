//! The platform's geometry: the legs' lengths at a pose, and the pose that has given lengths.
//!
//! Three prismatic legs (two UPR, one SPR) carry the platform. Legs 1 and 3 and the platform's edge B1B3 lie in one plane,
//! which turns about the line A1A3 of their joints on the base; a pose is the place of E, the edge's middle. B2, where
//! leg 2 ends, stands off that plane on the side of its joint A2. Leg 2's revolute axis lies along the edge, so the edge
//! is perpendicular to what is seen of leg 2 in the plane. There, with A1A3's middle O as the origin:
//!
//! ```text
//!   w ^      B1..
//!     |          ''..E..             A2' is A2 seen in the plane: at (xa, mw), and
//!     |             /   ''..B3       A2 is mn in front of it
//!     |            /                 A2'E has the length g, and k is its angle to w
//! A1--O---------A3/-----------> a
//!               A2'
//! ```
//!
//! Angles are only ever needed as sine and cosine, which square roots give.
#![expect(clippy::arithmetic_side_effects, reason = "of floats, which can't panic")]
#![expect(clippy::many_single_char_names, clippy::similar_names, reason = "the names that the geometry has above")]

use core::cmp::Ordering;

#[cfg(test)]
mod tests;
mod vector;

pub use vector::Real;

use vector::{add, cross, dot, finite, norm, scale, size, sub};

/// The robot's measures, all in the unit that poses and lengths have.
#[derive(Clone, Copy, Debug)]
pub struct Geometry {
    /// A1, A2 and A3, where the legs are joined to the base.
    pub joints: [[f32; 3]; 3],
    /// The length of the platform's edge B1B3.
    pub edge: f32,
    /// The distance of B2 from the plane of legs 1 and 3.
    pub offset: f32,
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// A number that is not finite or too large to compute with, or a geometry without a line A1A3.
    Input,
    /// No pose: E on the line A1A3, leg 2 perpendicular to the plane, or lengths that no pose has.
    NoPose,
}

/// The lengths of the legs when E is at `pose`.
pub fn inverse<R: Real>(geometry: &Geometry, pose: [f32; 3]) -> Result<[f32; 3], Error> {
    let base = Base::<R>::of(geometry)?;
    let e = finite(pose)?;
    let from_origin = sub(e, base.origin);
    let x = dot(from_origin, base.a);
    let across = sub(from_origin, scale(base.a, x));
    let r = norm(across);
    let least = base.least(size(e));
    if r <= least {
        return Err(Error::NoPose);
    }
    let w = scale(across, R::ONE / r);
    let n = cross(w, base.a);
    let place = Place { x, r, mw: dot(base.m, w), mn: dot(base.m, n).abs() };
    let plane = base.plane(place);
    if plane.g.abs() <= least {
        return Err(Error::NoPose);
    }
    let lengths = plane.squares.map(|square| square.sqrt().to_f32());
    if lengths.iter().all(|length| length.is_finite()) { Ok(lengths) } else { Err(Error::Input) }
}

/// The pose at which the legs have these `lengths`, met to within a hundred-thousandth of their sum.
///
/// A pose mirrored at the plane A1A2A3 has the same lengths: the one on the side that (A3 - A1) × (A2 - A1) points to is
/// returned. Near the base there can be more of them on that side: then it is the one that Newton's method finds from
/// far out, nearly always the farthest.
pub fn forward<R: Real>(geometry: &Geometry, lengths: [f32; 3]) -> Result<[f32; 3], Error> {
    let base = Base::<R>::of(geometry)?;
    let [q1, q2, q3] = finite::<R>(lengths)?;
    let m = norm(base.m);
    // On a line, the joints define no side: the platform turns about it as it likes.
    if m <= base.least(R::ZERO) || lengths.iter().any(|length| *length < 0.0) {
        return Err(Error::NoPose);
    }
    let found = STARTS.iter().find_map(|(distance, tangent)| {
        let r = (q1 + q2 + q3) * R::from(*distance);
        let (mw, mn) = rotated((R::ZERO, m), R::from(*tangent));
        base.solve([q1, q2, q3], Place { x: R::ZERO, r, mw, mn })
    });
    let Place { x, r, mw, mn } = found.ok_or(Error::NoPose)?;
    let w = scale(add(scale(base.m, mw), scale(cross(base.a, base.m), mn)), R::ONE / (m * m));
    let pose = add(base.origin, add(scale(base.a, x), scale(w, r))).map(R::to_f32);
    // Where leg 2 is nearly perpendicular to the plane, rounding a pose can turn the edge.
    let met = inverse::<R>(geometry, pose)?.map(R::from);
    let is_met = size(sub(met, [q1, q2, q3])) <= size([q1, q2, q3]) * R::from(1e-5);
    if is_met { Ok(pose) } else { Err(Error::NoPose) }
}

/// Where Newton's method starts, until it gets somewhere: r, in sums of the lengths, and the tangent of the angle by
/// which w is turned away from being perpendicular to A2's direction. All poses but some close to the base are found
/// from the first.
const STARTS: [(f32, f32); 4] = [(1.0, 0.0), (0.1, 1.0), (0.2, -1.0), (0.05, 0.0)];
/// Steps of Newton's method from one start. Six to nine are usual.
const STEPS: usize = 30;

/// The base in a frame of its own.
struct Base<R> {
    /// O, the middle of A1A3.
    origin: [R; 3],
    /// The unit vector from A1 to A3.
    a: [R; 3],
    /// Half the distance of A1 and A3.
    l: R,
    /// A2 from O along a...
    xa: R,
    /// ...and the rest of the way.
    m: [R; 3],
    /// Half the edge B1B3.
    h: R,
    offset: R,
    /// That of the largest of the joints' coordinates.
    size: R,
}

/// A pose, seen in the plane.
#[derive(Clone, Copy)]
struct Place<R> {
    /// E.
    x: R,
    r: R,
    /// A2's place along w, and in front of the plane.
    mw: R,
    mn: R,
}

/// What lies in the plane.
struct Plane<R> {
    /// The sine and cosine of k, which is above -90° and at most 90°.
    s: R,
    c: R,
    /// From A2' to E along k; negative when E is nearer to A1A3 than A2'.
    g: R,
    /// B1 from A1, and B3 from A3.
    leg1: (R, R),
    leg3: (R, R),
    /// B2 in front of A2.
    gap: R,
    /// The legs' lengths, squared.
    squares: [R; 3],
}

impl<R: Real> Base<R> {
    fn of(geometry: &Geometry) -> Result<Self, Error> {
        let [a1, a2, a3] = geometry.joints;
        let [a1, a2, a3]: [[R; 3]; 3] = [finite(a1)?, finite(a2)?, finite(a3)?];
        let [edge, offset, _] = finite([geometry.edge, geometry.offset, 0.0])?;
        let half = R::from(0.5);
        let line = sub(a3, a1);
        let length = norm(line);
        let origin = scale(add(a1, a3), half);
        let a = scale(line, R::ONE / length);
        let second = sub(a2, origin);
        let xa = dot(second, a);
        let m = sub(second, scale(a, xa));
        let base = Self {
            origin,
            a,
            l: length * half,
            xa,
            m,
            h: edge * half,
            offset,
            size: size(a1).max(size(a2)).max(size(a3)),
        };
        if length > base.least(R::ZERO) { Ok(base) } else { Err(Error::Input) }
    }

    /// The least distance that is more than the rounding of coordinates.
    fn least(&self, size: R) -> R {
        self.size.max(size) * R::from(f32::EPSILON * 2.0)
    }

    /// What a place means for the rest of the plane. Where g is 0, k is not defined.
    fn plane(&self, Place { x, r, mw, mn }: Place<R>) -> Plane<R> {
        let (p, t) = (x - self.xa, r - mw);
        let distance = (p * p + t * t).sqrt();
        let g = if t < R::ZERO { -distance } else { distance };
        // At 90° the sine is 1, whichever way E lies.
        let (s, c) = if t == R::ZERO { (R::ONE, R::ZERO) } else { (p / g, t / g) };
        let leg1 = (x - self.h * c + self.l, r + self.h * s);
        let leg3 = (x + self.h * c - self.l, r - self.h * s);
        let gap = self.offset - mn;
        let square = |(x, y): (R, R)| x * x + y * y;
        Plane { s, c, g, leg1, leg3, gap, squares: [square(leg1), p * p + t * t + gap * gap, square(leg3)] }
    }

    /// Newton's method: a place with these lengths.
    fn solve(&self, lengths: [R; 3], start: Place<R>) -> Option<Place<R>> {
        let squares = lengths.map(|q| q * q);
        let accepted = size(lengths) * R::from(1e-6);
        // An error of the square is so much longer than one of the length.
        let factors = lengths.map(|q| R::from(0.5) / q.max(accepted));
        let mut place = start;
        let mut best = (R::from(f32::MAX), start);
        for _ in 0..STEPS {
            let plane = self.plane(place);
            let errors = sub(plane.squares, squares);
            let error = dot(errors.map(R::abs), factors);
            // As near as rounding allows.
            if best.0 <= accepted && (error + error).partial_cmp(&best.0) != Some(Ordering::Less) {
                break;
            }
            if error < best.0 {
                best = (error, place);
            }
            place = self.step(place, &plane, errors);
        }
        (best.0 <= accepted).then_some(best.1)
    }

    /// A step of Newton's method: by the derivatives with respect to x, r and the angle of w, halved.
    fn step(&self, place: Place<R>, plane: &Plane<R>, errors: [R; 3]) -> Place<R> {
        let Place { x, r, mw, mn } = place;
        let &Plane { s, c, g, leg1, leg3, gap, .. } = plane;
        let turn = [c / g, -s / g, -s / g * mn];
        let along = |[x, r, angle]: [R; 3], by: R| {
            let [dx, dr, da] = scale(turn, by * self.h);
            [x + dx, r + dr, angle + da]
        };
        let row1 = along([leg1.0, leg1.1, R::ZERO], leg1.0 * s + leg1.1 * c);
        let row2 = [x - self.xa, r - mw, (r - mw) * mn - gap * mw];
        let row3 = along([leg3.0, leg3.1, R::ZERO], -(leg3.0 * s + leg3.1 * c));
        let [e1, e2, e3] = scale(errors, R::from(-0.5));
        let (c23, c31, c12) = (cross(row2, row3), cross(row3, row1), cross(row1, row2));
        let [dx, dr, turned] = scale(add(add(scale(c23, e1), scale(c31, e2)), scale(c12, e3)), R::ONE / dot(row1, c23));

        // Not farther than half the way and half a radian.
        let reach = (x.abs() + r) * R::from(0.5);
        let excess = (dx.abs().max(dr.abs()) / reach).max(turned.abs() * R::from(2.0)).max(R::ONE);
        let [dx, dr, turned] = [dx / excess, dr / excess, turned / excess];

        let (mw, mn) = rotated((mw, mn), turned);
        let r = r + dr;
        // Beyond the line A1A3, w points the other way; behind the mirror plane lies the mirror image.
        Place { x: x + dx, r: r.abs(), mw: if r < R::ZERO { -mw } else { mw }, mn: mn.abs() }
    }
}

/// A vector turned by the angle that has this tangent.
fn rotated<R: Real>((x, y): (R, R), tangent: R) -> (R, R) {
    let cosine = R::ONE / (R::ONE + tangent * tangent).sqrt();
    ((x - y * tangent) * cosine, (y + x * tangent) * cosine)
}
