//! What is known of a robot, and telling it to those who watch.

use std::sync::Arc;

use deltarobot_protocols::deltarobot::Report;
use deltarobot_protocols::deltarobot::host;
use tokio::sync::oneshot;

use super::{Begun, Robot};
use crate::event::{Event, What};
use crate::lease::Driver;
use crate::locked;
use crate::state::{End, Health, Link, Motion, Operation, State, stamp};

/// The robot's state as its thread keeps it.
#[derive(Debug)]
pub(super) struct View {
    pub(super) robot: Arc<Robot>,
    pub(super) state: State,
    /// Of the sessions before this one.
    health: Health,
    operations: u64,
    /// Who waits for the end of the motion.
    ended: Option<oneshot::Sender<Operation>>,
}

impl View {
    pub(super) fn new(robot: Arc<Robot>) -> Self {
        let mut state = State::clone(&robot.snapshot());
        state.geometry.clone_from(&locked(&robot.geometry));
        Self { robot, state, health: Health::default(), operations: 0, ended: None }
    }

    pub(super) fn publish(&mut self) {
        self.state.seq += 1;
        self.state.time = stamp();
        self.state.record_error = self.robot.all.records.error();
        let state = Arc::new(self.state.clone());
        self.robot.state.send_replace(Arc::clone(&state));
        self.emit(What::State(state));
    }

    fn emit(&self, what: What) {
        self.robot.publish(Event::new(Arc::clone(self.robot.name()), what));
    }

    pub(super) fn is_open(&mut self) {
        self.state.link = Link::Up;
        self.state.link_error = None;
        self.publish();
    }

    /// The port can't be opened.
    pub(super) fn is_closed(&mut self, error: String) {
        if self.state.link_error.as_ref() != Some(&error) {
            crate::complain(&format!("{}: {error}; trying again", self.robot.name()));
            self.state.link_error = Some(error);
            self.publish();
        }
    }

    /// The port was open.
    pub(super) fn is_lost(&mut self, error: &str, session: &host::Health) {
        self.health = self.health.plus(session);
        self.health.reconnects += 1;
        self.state.health = self.health;
        self.state.link = Link::Lost;
        self.state.become_stale();
        self.end(End::Lost, Some(error.to_owned()));
        self.is_closed(error.to_owned());
    }

    pub(super) fn report(&mut self, report: &Report, session: &host::Health) {
        self.state.report(report);
        self.state.health = self.health.plus(session);
        self.publish();
    }

    /// Nothing was answered.
    pub(super) fn becomes_stale(&mut self, session: &host::Health) {
        if !self.state.stale {
            self.state.health = self.health.plus(session);
            self.state.become_stale();
            self.publish();
        }
    }

    /// A motion has begun.
    pub(super) fn begin(&mut self, kind: Motion, target: Option<[f32; 3]>, by: String) -> Begun {
        self.operations += 1;
        let operation =
            Operation { id: self.operations, kind, target, since: stamp(), by, outcome: None, reason: None };
        let (ended, end) = oneshot::channel();
        self.ended = Some(ended);
        self.state.operation = Some(operation.clone());
        self.state.target = target;
        self.publish();
        Begun { operation, ended: end }
    }

    /// The motion has ended, if there was one.
    pub(super) fn end(&mut self, outcome: End, reason: Option<String>) {
        let Some(operation) = self.state.operation.as_mut().filter(|operation| operation.outcome.is_none()) else {
            return;
        };
        (operation.outcome, operation.reason) = (Some(outcome), reason);
        let operation = operation.clone();
        self.state.target = None;
        self.publish();
        if let Some(ended) = self.ended.take() {
            // Who asked for it may not wait.
            let _ = ended.send(operation.clone());
        }
        self.emit(What::Ended { time: stamp(), operation });
    }

    /// Looks at what may have been changed by others: who drives, and the geometry. Returns whether somebody does not
    /// drive any more, and nobody else does.
    pub(super) fn look_around(&mut self) -> bool {
        let geometry = locked(&self.robot.geometry).clone();
        let driver = self.robot.leases.driver();
        let (before, same_geometry) = (self.state.driver.clone(), geometry == self.state.geometry);
        if driver == before && same_geometry {
            return false;
        }
        self.state.driver.clone_from(&driver);
        if !same_geometry {
            self.state.geometry = geometry;
            self.state.find_pose();
        }
        self.publish();
        let client = |driver: &Option<Driver>| driver.as_ref().map(|driver| driver.client.clone());
        let is_abandoned = before.is_some() && driver.is_none();
        if client(&driver) != client(&before) {
            self.emit(What::Driver { time: stamp(), driver });
        }
        is_abandoned
    }
}
