//! Where the platform is when its arms have some displacements, and the other way round.

use deltarobot_protocols::kinematics::{self, Error, forward, inverse};
use serde::{Deserialize, Serialize};

use crate::problem::{Kind, Problem};

/// The robot's measures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Geometry {
    joints: [[f32; 3]; 3],
    edge: f32,
    offset: f32,
    #[serde(default)]
    arms: [Arm; 3],
}

/// What the displacement of an arm means for its leg: `length = offset + scale * displacement`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Arm {
    offset: f32,
    scale: f32,
}

impl Default for Arm {
    fn default() -> Self {
        Self { offset: 0.0, scale: 1.0 }
    }
}

impl Geometry {
    /// Refuses one that has poses for nothing.
    pub(crate) fn check(&self) -> Result<(), Problem> {
        let impossible = |text: &str| Err(Problem::new(Kind::Impossible, text));
        let is_usable = |arm: &Arm| arm.offset.is_finite() && arm.scale.is_finite() && arm.scale != 0.0;
        if !self.arms.iter().all(is_usable) {
            return impossible("the offsets and scales of the arms have to be finite, and no scale may be 0");
        }
        // No pose says more than that the geometry is in order.
        match inverse::<f64>(&self.measures(), [0.0; 3]) {
            Err(Error::Input) => impossible("no geometry: numbers that are not finite or too large, or A1 equal to A3"),
            Ok(_) | Err(Error::NoPose) => Ok(()),
        }
    }

    /// Where the platform is.
    pub(crate) fn pose(&self, displacements: [f32; 3]) -> Option<[f32; 3]> {
        let mut lengths = displacements;
        for (length, arm) in lengths.iter_mut().zip(&self.arms) {
            *length = arm.offset + arm.scale * *length;
        }
        forward::<f64>(&self.measures(), lengths).ok()
    }

    /// Displacements that take the platform there.
    pub(crate) fn displacements(&self, pose: [f32; 3]) -> Option<[f32; 3]> {
        let mut lengths = inverse::<f64>(&self.measures(), pose).ok()?;
        for (length, arm) in lengths.iter_mut().zip(&self.arms) {
            *length = (*length - arm.offset) / arm.scale;
        }
        lengths.iter().all(|length| length.is_finite()).then_some(lengths)
    }

    const fn measures(&self) -> kinematics::Geometry {
        kinematics::Geometry { joints: self.joints, edge: self.edge, offset: self.offset }
    }
}
