//! The machine: its geometry, and what its arms can do. In TOML, lengths in one unit, which is metres for
//! `deltarobot path`:
//!
//! ```toml
//! joints = [[0.12, 0.0, 0.10], [0.38, 0.0, 0.25], [0.12, 0.0, 0.40]] # where legs 1, 2 and 3 are joined to the base
//! edge = 0.15               # d_B1B3: the platform's edge
//! offset = 0.08             # d_e: how far leg 2's end is from the plane of legs 1 and 3
//!
//! [[arms]]                  # A, of leg 1; B of leg 2 and C of leg 3 follow
//! scale = 0.001             # how much longer a unit of displacement makes its leg; 1 by default
//! offset = 0.2              # how long its leg is at displacement 0; 0 by default
//! min = 0                   # the least and the largest displacement, which paths need; -inf and inf: there is none
//! max = 600
//! ```
//!
//! and the same names in JSON.

use std::fmt::{self, Display, Formatter};
use std::ops::RangeInclusive;

use deltarobot_protocols::kinematics::{Geometry, forward, inverse};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Error;
use super::vector::{cross, distance, norm, sub};

/// A machine with three legs, whose lengths its arms set. Deserialized, its numbers make sense.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Where legs 1, 2 and 3 are joined to the base.
    #[serde(deserialize_with = "joints")]
    joints: [[f32; 3]; 3],
    /// The length of the platform's edge B1B3.
    #[serde(deserialize_with = "length")]
    edge: f32,
    /// The distance of B2 from the plane of legs 1 and 3.
    #[serde(deserialize_with = "length")]
    offset: f32,
    /// Those of legs 1, 2 and 3, with the displacements DA, DB and DC of the protocol.
    #[serde(default, deserialize_with = "arms")]
    arms: [Arm; 3],
}

/// An arm: how its displacement sets the length of its leg, `offset + scale * displacement`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
struct Arm {
    scale: f64,
    offset: f64,
    /// The least displacement; infinite where it is known that there is none.
    #[serde(skip_serializing_if = "is_none")]
    min: Option<f64>,
    /// The largest displacement, likewise.
    #[serde(skip_serializing_if = "is_none")]
    max: Option<f64>,
}

/// Why the platform can't be somewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// The geometry has no pose there.
    NoPose,
    /// The same lengths put the platform somewhere else: behind the base, or close to it.
    Ambiguous,
    /// An arm would have to go beyond its limit.
    Arm {
        /// Its name: A, B or C.
        arm: char,
        /// Where it would have to go...
        displacement: f64,
        /// ...and how far it can.
        limit: f64,
    },
}

impl Reason {
    /// Whether it is the same obstacle.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Arm { arm, displacement, limit }, Self::Arm { arm: name, displacement: also, limit: end }) => {
                arm == name && (displacement > limit) == (also > end)
            }
            _ => self == other,
        }
    }

    /// By how much an arm would be beyond its limit.
    pub(super) fn excess(&self) -> f64 {
        if let Self::Arm { displacement, limit, .. } = self { (displacement - limit).abs() } else { 0.0 }
    }
}

impl Display for Reason {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPose => f.write_str("the platform can't be there, whatever the legs' lengths"),
            Self::Ambiguous => f.write_str("with legs of these lengths the platform would be elsewhere"),
            Self::Arm { arm, displacement, limit } => {
                let end = if displacement > limit { "most" } else { "least" };
                // So exactly that a number never looks like the limit.
                let places = if (displacement - limit).abs() < 0.05 { 6 } else { 1 };
                write!(f, "D{arm} would have to be {displacement:.places$}, at {end} {limit} is possible")
            }
        }
    }
}

impl Serialize for Reason {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl Machine {
    /// Reads a file in TOML.
    ///
    /// # Errors
    ///
    /// No TOML; keys that are missing or unknown; numbers that make no machine.
    pub fn read(text: &str) -> Result<Self, Error> {
        toml::from_str(text).map_err(|error| {
            let line =
                error.span().and_then(|span| text.get(..span.start)).map(|before| 1 + before.matches('\n').count());
            Error { line, message: error.message().replace('\n', ", ") }
        })
    }

    /// The displacements that put the platform there.
    ///
    /// # Errors
    ///
    /// Why it can't be there.
    pub fn displacements(&self, pose: [f64; 3]) -> Result<[f32; 3], Reason> {
        let single = pose.map(single);
        let lengths = inverse::<f64>(&self.geometry(), single).map_err(|_| Reason::NoPose)?;
        let back = forward::<f64>(&self.geometry(), lengths).map_err(|_| Reason::Ambiguous)?;
        let size: f64 = lengths.into_iter().map(f64::from).sum();
        if distance(back.map(f64::from), pose) > 1e-4 * size {
            return Err(Reason::Ambiguous);
        }
        let [a, b, c] = lengths;
        let [arm_a, arm_b, arm_c] = &self.arms;
        Ok([arm_a.displacement('A', a)?, arm_b.displacement('B', b)?, arm_c.displacement('C', c)?])
    }

    /// Where the platform is at these displacements; `None` where no pose has them.
    #[must_use]
    pub fn pose(&self, [a, b, c]: [f32; 3]) -> Option<[f32; 3]> {
        let [arm_a, arm_b, arm_c] = &self.arms;
        forward::<f64>(&self.geometry(), [arm_a.length(a), arm_b.length(b), arm_c.length(c)]).ok()
    }

    /// Whether it is known how far each arm can go.
    pub(super) fn has_limits(&self) -> bool {
        self.arms.iter().all(|arm| arm.min.is_some() && arm.max.is_some())
    }

    /// About how large it is.
    pub(super) fn size(&self) -> f64 {
        size(&self.joints)
    }

    const fn geometry(&self) -> Geometry {
        Geometry { joints: self.joints, edge: self.edge, offset: self.offset }
    }
}

impl Arm {
    fn displacement(&self, arm: char, length: f32) -> Result<f32, Reason> {
        let displacement = (f64::from(length) - self.offset) / self.scale;
        let range = self.range();
        if range.contains(&displacement) {
            return Ok(single(displacement));
        }
        Err(Reason::Arm { arm, displacement, limit: displacement.clamp(*range.start(), *range.end()) })
    }

    fn length(&self, displacement: f32) -> f32 {
        single(self.offset + self.scale * f64::from(displacement))
    }

    /// What it can do, within what the protocol can say.
    fn range(&self) -> RangeInclusive<f64> {
        let [min, max] = [f32::MIN, f32::MAX].map(f64::from);
        self.min.unwrap_or(min).max(min)..=self.max.unwrap_or(max).min(max)
    }

    fn check(&self) -> Result<(), &'static str> {
        if !(self.scale.abs() >= 1e-9 && self.scale.abs() < 1e9 && self.offset.abs() < 1e9) {
            return Err("scale must not be 0, and its numbers must be below a billion");
        }
        let is_in_order = self.min.unwrap_or(f64::NEG_INFINITY) < self.max.unwrap_or(f64::INFINITY);
        is_in_order.then_some(()).ok_or("min must be less than its max")
    }
}

impl Default for Arm {
    fn default() -> Self {
        Self { scale: 1.0, offset: 0.0, min: None, max: None }
    }
}

/// JSON has no infinite numbers.
#[expect(clippy::ref_option, reason = "as serde passes it")]
fn is_none(limit: &Option<f64>) -> bool {
    !limit.is_some_and(f64::is_finite)
}

/// The longest distance of two of the joints.
fn size(joints: &[[f32; 3]; 3]) -> f64 {
    let [a1, a2, a3] = joints.map(|joint| joint.map(f64::from));
    distance(a1, a2).max(distance(a2, a3)).max(distance(a1, a3))
}

#[expect(clippy::cast_possible_truncation, reason = "it rounds")]
const fn single(number: f64) -> f32 {
    number as f32
}

fn joints<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[[f32; 3]; 3], D::Error> {
    let joints = <[[f32; 3]; 3]>::deserialize(deserializer)?;
    if !joints.iter().flatten().all(|number| number.abs() < 1e6) {
        return Err(D::Error::custom("a joint must have coordinates below a million"));
    }
    let [a1, a2, a3] = joints.map(|joint| joint.map(f64::from));
    let area = norm(cross(sub(a2, a1), sub(a3, a1)));
    // Nearly in line, the platform turns nearly as it likes.
    let is_fine = area > 1e-6 * size(&joints) * size(&joints);
    is_fine.then_some(joints).ok_or_else(|| D::Error::custom("the joints A1, A2 and A3 lie in line"))
}

fn length<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f32, D::Error> {
    let length = f32::deserialize(deserializer)?;
    let is_fine = (0.0..1e6).contains(&length);
    is_fine.then_some(length).ok_or_else(|| D::Error::custom("a length must be from 0 to a million"))
}

fn arms<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[Arm; 3], D::Error> {
    let arms = <[Arm; 3]>::deserialize(deserializer)?;
    for (name, arm) in ['A', 'B', 'C'].into_iter().zip(&arms) {
        arm.check().map_err(|error| D::Error::custom(format_args!("arm {name}'s {error}")))?;
    }
    Ok(arms)
}

#[cfg(test)]
pub(super) mod tests;
