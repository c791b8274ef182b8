//! What is asked of a robot.

use std::time::Instant;

use deltarobot_protocols::deltarobot::Position;
use serde::Deserialize;
use tokio::sync::oneshot;

use super::Begun;
use crate::problem::{Kind, Problem};
use crate::state::State;

/// A motion that is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Command {
    /// To the end stops.
    Home,
    /// To a place.
    Move(Goal),
}

/// Where to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Goal {
    /// The place.
    pub(crate) place: Place,
    /// Whether it is counted from where the robot is.
    pub(crate) is_relative: bool,
}

/// A place.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Place {
    /// Of the arms.
    Displacements([f32; 3]),
    /// Of the platform, by the geometry.
    Position([f32; 3]),
}

impl Goal {
    /// Of a request, which names one of both places.
    pub(crate) fn new(
        displacements: Option<[f32; 3]>,
        position: Option<[f32; 3]>,
        is_relative: bool,
    ) -> Result<Self, Problem> {
        let place = match (displacements, position) {
            (Some(displacements), None) => Place::Displacements(displacements),
            (None, Some(position)) => Place::Position(position),
            _ => return Err(Problem::new(Kind::Malformed, "either `displacements` or `position` is needed")),
        };
        Ok(Self { place, is_relative })
    }

    /// The displacements there.
    pub(super) fn resolve(&self, state: &State) -> Result<[f32; 3], Problem> {
        let impossible = |text: &str| Problem::new(Kind::Impossible, text);
        let target = match self.place {
            Place::Displacements(by) => {
                self.add(by, state.displacements, state).ok_or_else(|| impossible("where the robot is is not known"))?
            }
            Place::Position(by) => {
                let geometry = state.geometry.as_ref().ok_or_else(|| impossible("the robot has no geometry"))?;
                let pose =
                    self.add(by, state.pose, state).ok_or_else(|| impossible("where the platform is is not known"))?;
                geometry.displacements(pose.map(f64::from)).map_err(|reason| impossible(&reason.to_string()))?
            }
        };
        if Position(target.map(f32::to_bits)).is_finite() {
            Ok(target)
        } else {
            Err(impossible("a displacement must be a finite number"))
        }
    }

    fn add(&self, mut by: [f32; 3], at: Option<[f32; 3]>, state: &State) -> Option<[f32; 3]> {
        if self.is_relative {
            for (by, at) in by.iter_mut().zip(at.filter(|_| !state.stale)?) {
                *by += at;
            }
        }
        Some(by)
    }
}

/// A motion that somebody wants.
#[derive(Debug)]
pub(super) struct Order {
    pub(super) command: Command,
    /// The lease's.
    pub(super) word: String,
    /// Not to be begun later.
    pub(super) expires: Option<Instant>,
    pub(super) reply: oneshot::Sender<Result<Begun, Problem>>,
}

/// Bytes that somebody wants to send.
#[derive(Debug)]
pub(super) struct Raw {
    pub(super) bytes: Vec<u8>,
    pub(super) word: String,
    pub(super) reply: oneshot::Sender<Result<(), Problem>>,
}
