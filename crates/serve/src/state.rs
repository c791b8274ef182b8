//! What is known of a robot, as it is shown.

use std::sync::Arc;

use chrono::{SecondsFormat, Utc};
use deltarobot_cli::path::Machine;
use deltarobot_protocols::deltarobot::host::{self, Outcome};
use deltarobot_protocols::deltarobot::{Report, State as Reported};
use serde::Serialize;

use crate::lease::Driver;

/// The time now, as it is shown.
pub(crate) fn stamp() -> String {
    Utc::now().to_rfc3339_opts(SecondsFormat::Millis, true)
}

/// How the port is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Link {
    /// Not open yet.
    Opening,
    /// Open.
    Up,
    /// It was open, and is tried again.
    Lost,
}

/// What the robot does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Doing {
    /// It has not answered lately.
    Unknown,
    /// Nothing.
    Idle,
    /// Homing.
    Homing,
    /// Moving.
    Moving,
    /// Waiting for an error to be cleared.
    Error,
}

impl Doing {
    /// What was reported.
    pub(crate) const fn of(state: Reported) -> Self {
        match state {
            Reported::Idle => Self::Idle,
            Reported::Homing => Self::Homing,
            Reported::Moving => Self::Moving,
            Reported::Error => Self::Error,
        }
    }

    /// Whether its arms move.
    pub(crate) const fn moves(self) -> bool {
        matches!(self, Self::Homing | Self::Moving)
    }
}

/// A robot's state; openapi.json describes it.
#[derive(Clone, Debug, Serialize)]
#[expect(clippy::struct_field_names, reason = "they are those of the JSON")]
pub(crate) struct State {
    pub(crate) name: Arc<str>,
    pub(crate) port: Arc<str>,
    pub(crate) link: Link,
    pub(crate) link_error: Option<String>,
    pub(crate) time: String,
    pub(crate) seq: u64,
    pub(crate) state: Doing,
    pub(crate) stale: bool,
    pub(crate) reported: Option<String>,
    pub(crate) position_known: bool,
    pub(crate) displacements: Option<[f32; 3]>,
    pub(crate) end_stops: Vec<&'static str>,
    pub(crate) pose: Option<[f32; 3]>,
    pub(crate) geometry: Option<Arc<Machine>>,
    pub(crate) operation: Option<Operation>,
    pub(crate) target: Option<[f32; 3]>,
    pub(crate) driver: Option<Driver>,
    pub(crate) health: Health,
    pub(crate) record_error: Option<String>,
}

impl State {
    /// That of a robot whose port was never open.
    pub(crate) fn new(name: Arc<str>, port: Arc<str>) -> Self {
        Self {
            name,
            port,
            link: Link::Opening,
            link_error: None,
            time: stamp(),
            seq: 0,
            state: Doing::Unknown,
            stale: true,
            reported: None,
            position_known: false,
            displacements: None,
            end_stops: Vec::new(),
            pose: None,
            geometry: None,
            operation: None,
            target: None,
            driver: None,
            health: Health::default(),
            record_error: None,
        }
    }

    /// Takes in what the robot reports.
    pub(crate) fn report(&mut self, report: &Report) {
        self.state = Doing::of(report.state());
        self.stale = false;
        self.reported = Some(stamp());
        self.position_known = report.position.is_known();
        self.displacements = displacements(report);
        self.end_stops = end_stops(report);
        self.find_pose();
    }

    /// The pose of the displacements.
    pub(crate) fn find_pose(&mut self) {
        self.pose = self.geometry.as_ref().zip(self.displacements).and_then(|(geometry, at)| geometry.pose(at));
    }

    /// What was reported last may no longer be so.
    pub(crate) fn become_stale(&mut self) {
        self.stale = true;
        self.state = Doing::Unknown;
    }
}

/// Displacements, if they are known.
pub(crate) fn displacements(report: &Report) -> Option<[f32; 3]> {
    report.position.is_finite().then(|| report.position.0.map(f32::from_bits))
}

/// The arms that are at their end stops.
pub(crate) fn end_stops(report: &Report) -> Vec<&'static str> {
    let stops = [(4, "A"), (8, "B"), (16, "C")];
    stops.into_iter().filter_map(|(bit, arm)| (report.stat() & bit != 0).then_some(arm)).collect()
}

/// Kinds of motions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Motion {
    /// To the end stops.
    Home,
    /// To a target.
    Move,
}

/// How a motion ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum End {
    Finished,
    Refused,
    Failed,
    Cancelled,
    TimedOut,
    /// The port went away.
    Lost,
}

impl From<Outcome> for End {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Finished => Self::Finished,
            Outcome::Refused => Self::Refused,
            Outcome::Failed => Self::Failed,
            Outcome::Cancelled => Self::Cancelled,
            Outcome::TimedOut => Self::TimedOut,
        }
    }
}

/// A motion that goes on, or has ended.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Operation {
    pub(crate) id: u64,
    pub(crate) kind: Motion,
    pub(crate) target: Option<[f32; 3]>,
    pub(crate) since: String,
    pub(crate) by: String,
    pub(crate) outcome: Option<End>,
    pub(crate) reason: Option<String>,
}

/// How well the line works.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Health {
    pub(crate) frames: u64,
    pub(crate) malformed: u64,
    pub(crate) strays: u64,
    pub(crate) garbage_bytes: u64,
    pub(crate) checksum_failures: u64,
    pub(crate) timeouts: u64,
    pub(crate) retransmissions: u64,
    pub(crate) reconnects: u64,
    pub(crate) round_trip_ms: Option<u32>,
}

impl Health {
    /// With what a session has counted since the port was opened.
    pub(crate) fn plus(self, session: &host::Health) -> Self {
        Self {
            frames: self.frames.saturating_add(session.frames.into()),
            malformed: self.malformed.saturating_add(session.malformed.into()),
            strays: self.strays.saturating_add(session.strays.into()),
            garbage_bytes: self.garbage_bytes.saturating_add(session.garbage_bytes.into()),
            checksum_failures: self.checksum_failures.saturating_add(session.checksum_failures.into()),
            timeouts: self.timeouts.saturating_add(session.timeouts.into()),
            retransmissions: self.retransmissions.saturating_add(session.retransmissions.into()),
            reconnects: self.reconnects,
            round_trip_ms: session.round_trips.sum.checked_div(session.round_trips.count).or(self.round_trip_ms),
        }
    }
}
