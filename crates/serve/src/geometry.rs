//! Where the platform is when its arms have some displacements, and the other way round.

use deltarobot_cli::path::{self, Machine};
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
    /// The least displacement, if there is a limit...
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<f32>,
    /// ...and the largest one.
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<f32>,
}

impl Default for Arm {
    fn default() -> Self {
        Self { offset: 0.0, scale: 1.0, min: None, max: None }
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
        let limits = |arm: &Arm| (arm.min.unwrap_or(f32::MIN), arm.max.unwrap_or(f32::MAX));
        // Not so where one of them is no number.
        if !self.arms.iter().map(limits).all(|(min, max)| min < max) {
            return impossible("an arm's min has to be less than its max");
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

    /// That of a file that `deltarobot path` takes.
    pub(crate) fn of(machine: &Machine) -> Self {
        let path::Arms { a, b, c } = &machine.arms;
        let arm = |arm: &path::Arm| Arm {
            offset: single(arm.offset),
            scale: single(arm.scale),
            min: Some(single(arm.min)),
            max: Some(single(arm.max)),
        };
        let joints = [machine.a1, machine.a2, machine.a3];
        Self { joints, edge: machine.edge, offset: machine.offset, arms: [arm(a), arm(b), arm(c)] }
    }

    /// What paths are planned for: arms without limits can't be checked.
    pub(crate) fn machine(&self) -> Result<Machine, Problem> {
        let impossible = |text: &str| Problem::new(Kind::Impossible, text);
        let arm = |arm: &Arm| {
            let (min, max) = arm.min.zip(arm.max).ok_or_else(|| {
                Problem::new(Kind::Impossible, "paths need the least and the largest displacement of each arm")
            })?;
            let [scale, offset, min, max] = [arm.scale, arm.offset, min, max].map(f64::from);
            path::Arm::new(scale, offset, min, max).map_err(impossible)
        };
        let [a, b, c] = &self.arms;
        let arms = path::Arms { a: arm(a)?, b: arm(b)?, c: arm(c)? };
        Machine::new(self.joints, self.edge, self.offset, arms).map_err(impossible)
    }

    const fn measures(&self) -> kinematics::Geometry {
        kinematics::Geometry { joints: self.joints, edge: self.edge, offset: self.offset }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "it rounds")]
const fn single(number: f64) -> f32 {
    number as f32
}

#[cfg(test)]
mod tests {
    use super::{Arm, Geometry};

    #[test]
    fn paths_are_planned_for_machines_that_make_sense() {
        let arm = Arm { min: Some(0.0), max: Some(300.0), ..Arm::default() };
        let joints = [[0.12, 0.0, 0.10], [0.38, 0.0, 0.25], [0.12, 0.0, 0.40]];
        let good = Geometry { joints, edge: 0.15, offset: 0.08, arms: [arm; 3] };
        assert!(good.check().is_ok() && good.machine().is_ok());
        let [a1, _, a3] = joints;
        let in_line = [a1, [0.12, 0.0, 0.25], a3];
        for bad in [
            Geometry { joints: in_line, ..good.clone() },
            Geometry { edge: -0.15, ..good.clone() },
            Geometry { arms: [Arm { scale: 1e-20, ..arm }; 3], ..good.clone() },
            Geometry { arms: [Arm { max: None, ..arm }; 3], ..good.clone() },
        ] {
            assert!(bad.check().is_ok() && bad.machine().is_err(), "{bad:?}");
        }
    }
}
