//! The machine: its geometry, and what its arms can do. A file has, in TOML,
//!
//! ```toml
//! A1 = [0.12, 0.0, 0.10]    # the joints of the legs on the base, in metres
//! A2 = [0.38, 0.0, 0.25]
//! A3 = [0.12, 0.0, 0.40]
//! d_B1B3 = 0.15             # the platform's edge
//! d_e = 0.08                # how far leg 2's end is from the plane of legs 1 and 3
//!
//! [arms.A]                  # leg 1
//! scale = 0.001             # metres that its leg gets longer by a unit of displacement
//! offset = 0.2              # how long its leg is at displacement 0
//! min = 0                   # the least and the largest displacement; -inf and inf where there is none
//! max = 600
//! # [arms.B] for leg 2 and [arms.C] for leg 3 have the same
//! ```

use std::fmt::{self, Display, Formatter};

use deltarobot_protocols::kinematics::{Geometry, forward, inverse};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Error;
use super::vector::{cross, distance, norm, sub};

/// A machine with three legs, whose lengths its arms set. Deserialized, its numbers make sense.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, try_from = "File")]
pub struct Machine {
    /// Where leg 1 is joined to the base, in metres.
    #[serde(rename = "A1")]
    pub a1: [f32; 3],
    /// The same for leg 2.
    #[serde(rename = "A2")]
    pub a2: [f32; 3],
    /// The same for leg 3.
    #[serde(rename = "A3")]
    pub a3: [f32; 3],
    /// The length of the platform's edge B1B3.
    #[serde(rename = "d_B1B3")]
    pub edge: f32,
    /// The distance of B2 from the plane of legs 1 and 3.
    #[serde(rename = "d_e")]
    pub offset: f32,
    /// The arms.
    pub arms: Arms,
}

/// What a file has, before it is known to make sense.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(rename = "A1", deserialize_with = "point")]
    a1: [f32; 3],
    #[serde(rename = "A2", deserialize_with = "point")]
    a2: [f32; 3],
    #[serde(rename = "A3", deserialize_with = "point")]
    a3: [f32; 3],
    #[serde(rename = "d_B1B3", deserialize_with = "length")]
    edge: f32,
    #[serde(rename = "d_e", deserialize_with = "length")]
    offset: f32,
    arms: Arms,
}

/// The arms, named as the displacements DA, DB and DC of the protocol.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Arms {
    /// That of leg 1.
    #[serde(rename = "A")]
    pub a: Arm,
    /// That of leg 2.
    #[serde(rename = "B")]
    pub b: Arm,
    /// That of leg 3.
    #[serde(rename = "C")]
    pub c: Arm,
}

/// An arm: how its displacement sets the length of its leg, `offset + scale * displacement`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, try_from = "ArmFile")]
pub struct Arm {
    /// How much longer a unit of displacement makes the leg, in metres.
    pub scale: f64,
    /// How long the leg is at displacement 0, in metres.
    pub offset: f64,
    /// The least displacement.
    pub min: f64,
    /// The largest displacement.
    pub max: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ArmFile {
    scale: f64,
    offset: f64,
    min: f64,
    max: f64,
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
    /// A machine with these joints on the base, edge B1B3, distance of B2 from the plane of legs 1 and 3, and arms.
    ///
    /// # Errors
    ///
    /// Numbers that make no machine.
    pub fn new(joints: [[f32; 3]; 3], edge: f32, offset: f32, arms: Arms) -> Result<Self, &'static str> {
        let is_fine = |number: &f32| number.abs() < 1e6;
        if !(joints.iter().flatten().all(is_fine) && [edge, offset].iter().all(|it| is_fine(it) && *it >= 0.0)) {
            return Err("coordinates must be below a million, and lengths not below zero");
        }
        let [a1, a2, a3] = joints;
        let machine = Self { a1, a2, a3, edge, offset, arms };
        let [a1, a2, a3] = joints.map(|joint| joint.map(f64::from));
        let area = norm(cross(sub(a2, a1), sub(a3, a1)));
        // Nearly in line, the platform turns nearly as it likes.
        if area > 1e-6 * machine.size() * machine.size() { Ok(machine) } else { Err("A1, A2 and A3 lie in line") }
    }

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
        let Arms { a: arm_a, b: arm_b, c: arm_c } = &self.arms;
        Ok([arm_a.displacement('A', a)?, arm_b.displacement('B', b)?, arm_c.displacement('C', c)?])
    }

    /// Where the platform is at these displacements; `None` where no pose has them.
    #[must_use]
    pub fn pose(&self, [a, b, c]: [f32; 3]) -> Option<[f64; 3]> {
        let arms = &self.arms;
        let lengths = [arms.a.length(a), arms.b.length(b), arms.c.length(c)];
        forward::<f64>(&self.geometry(), lengths).ok().map(|pose| pose.map(f64::from))
    }

    /// About how large it is: the longest distance of two of the base's joints.
    pub(super) fn size(&self) -> f64 {
        let [a1, a2, a3] = [self.a1, self.a2, self.a3].map(|joint| joint.map(f64::from));
        distance(a1, a2).max(distance(a2, a3)).max(distance(a1, a3))
    }

    const fn geometry(&self) -> Geometry {
        Geometry { joints: [self.a1, self.a2, self.a3], edge: self.edge, offset: self.offset }
    }
}

impl Arm {
    /// An arm whose leg is `offset + scale * displacement` long; displacements are from `min` to `max`, which may be
    /// infinite.
    ///
    /// # Errors
    ///
    /// Numbers that make no arm.
    pub fn new(scale: f64, offset: f64, min: f64, max: f64) -> Result<Self, &'static str> {
        if !(scale.abs() >= 1e-9 && scale.abs() < 1e9 && offset.abs() < 1e9) {
            return Err("an arm's scale must not be 0, and its numbers must be below a billion");
        }
        if min < max { Ok(Self { scale, offset, min, max }) } else { Err("an arm's min must be less than its max") }
    }

    fn displacement(&self, arm: char, length: f32) -> Result<f32, Reason> {
        let displacement = (f64::from(length) - self.offset) / self.scale;
        if (self.min..=self.max).contains(&displacement) {
            return Ok(single(displacement));
        }
        Err(Reason::Arm { arm, displacement, limit: displacement.clamp(self.min, self.max) })
    }

    fn length(&self, displacement: f32) -> f32 {
        single(self.offset + self.scale * f64::from(displacement))
    }
}

#[expect(clippy::cast_possible_truncation, reason = "it rounds")]
fn single(number: f64) -> f32 {
    number as f32
}

fn point<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f32; 3], D::Error> {
    let point = <[f32; 3]>::deserialize(deserializer)?;
    let is_fine = point.iter().all(|number| number.abs() < 1e6);
    is_fine.then_some(point).ok_or_else(|| serde::de::Error::custom("a point must have coordinates below a million"))
}

fn length<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f32, D::Error> {
    let length = f32::deserialize(deserializer)?;
    let is_fine = (0.0..1e6).contains(&length);
    is_fine.then_some(length).ok_or_else(|| serde::de::Error::custom("a length must be from 0 to a million"))
}

impl TryFrom<File> for Machine {
    type Error = &'static str;

    fn try_from(file: File) -> Result<Self, Self::Error> {
        let File { a1, a2, a3, edge, offset, arms } = file;
        Self::new([a1, a2, a3], edge, offset, arms)
    }
}

impl TryFrom<ArmFile> for Arm {
    type Error = &'static str;

    fn try_from(file: ArmFile) -> Result<Self, Self::Error> {
        let ArmFile { scale, offset, min, max } = file;
        Self::new(scale, offset, min, max)
    }
}

#[cfg(test)]
pub(super) mod tests;
