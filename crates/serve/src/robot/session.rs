//! What goes on at a port while it is open: the protocol's session, and whoever takes part in it.

use std::time::{Duration, Instant};

use deltarobot_cli::clock::{Clock, SLICE};
use deltarobot_cli::port::Device;
use deltarobot_cli::recording::Side;
use deltarobot_cli::session_settings;
use deltarobot_cli::status::Failure;
use deltarobot_cli::system::Wake;
use deltarobot_cli::wait::wait_for_any;
use deltarobot_protocols::deltarobot::host::{self, Event, Health, Outcome, REQUEST_MAX};
use deltarobot_protocols::deltarobot::{Opcode, Position, receiver_room};
use rustix::fd::AsFd;
use tokio::sync::oneshot;

use super::order::{Command, Order, Raw};
use super::tap::Tap;
use super::view::View;
use super::worker::drain;
use super::{Begun, Settings};
use crate::locked;
use crate::problem::{Kind, Problem};
use crate::state::{Doing, End, Motion};

/// The status is asked for when nothing was reported for this long.
const STATUS_AFTER: Duration = Duration::from_secs(1);
/// The end of the program waits so long for a robot to stand.
const END_TIME: Duration = Duration::from_secs(3);

type Host = host::Host<{ receiver_room(32) }>;

pub(super) struct Session<'a> {
    view: &'a mut View,
    woken: &'a Wake,
    device: Device,
    host: Host,
    clock: Clock,
    tap: Tap,
    /// What was received and is not in the protocol's session yet.
    received: Vec<u8>,
    cancels: Vec<oneshot::Sender<Result<End, Problem>>>,
    /// When something was last reported, or asked for.
    asked: Instant,
    /// When somebody sent bytes past the session, since it last began a motion.
    raw_sent: Option<Instant>,
    /// When the program's end was noticed.
    ending: Option<Instant>,
}

impl<'a> Session<'a> {
    pub(super) fn new(device: Device, view: &'a mut View, woken: &'a Wake) -> Self {
        let mut host = Host::new(settings(&view.robot.settings, &device));
        // The first thing to know; there is nothing else going on yet.
        let _ = host.status();
        Self {
            tap: Tap::new(&view.robot, device.gap()),
            view,
            woken,
            device,
            host,
            clock: Clock::new(),
            received: Vec::new(),
            cancels: Vec::new(),
            asked: Instant::now(),
            raw_sent: None,
            ending: None,
        }
    }

    pub(super) fn health(&self) -> Health {
        self.host.health().clone()
    }

    /// Whether the robot moves, as far as is known: by the session, or by whoever sends bytes past it, of which the last
    /// may not show yet.
    pub(super) fn is_in_motion(&self) -> bool {
        let sends = |sent: Instant| sent.elapsed() < STATUS_AFTER;
        self.host.is_busy() || self.raw_sent.is_some_and(|sent| self.view.state.state.moves() || sends(sent))
    }

    /// Has the robot stand.
    pub(super) fn cancel(&mut self) {
        // It may be on its way already.
        let _ = self.host.cancel();
    }

    /// Goes on until the port is gone, or the program ends.
    pub(super) fn run(&mut self) -> Result<(), Failure> {
        loop {
            let now = self.clock.now_ms();
            while let Some(event) = self.host.poll(now, &mut [0; 0]) {
                self.handle(event);
            }
            self.send(now)?;
            if self.take_orders()? {
                continue;
            }
            if self.view.look_around() && self.view.robot.settings.cancels_abandoned && self.is_in_motion() {
                self.cancel();
                continue;
            }
            if self.is_ended() {
                return Ok(());
            }
            self.ask();
            self.receive(now)?;
        }
    }

    /// What happened on the line.
    fn handle(&mut self, event: Event) {
        match event {
            Event::Status => {
                self.asked = Instant::now();
                if let Some(report) = self.host.last_report() {
                    self.view.report(report, self.host.health());
                }
            }
            Event::Ended(Opcode::CANCEL, outcome) => {
                for reply in self.cancels.drain(..) {
                    // Who asked may not wait.
                    let _ = reply.send(Ok(outcome.into()));
                }
            }
            Event::Ended(Opcode::STATUS, Outcome::Finished)
            | Event::Message(..)
            | Event::State
            | Event::GeneralError
            | Event::Accepted(_) => (),
            Event::Ended(Opcode::STATUS, _) => self.view.becomes_stale(self.host.health()),
            Event::Ended(_, outcome) => {
                let reason = self.reason(outcome);
                self.view.end(outcome.into(), reason);
                // The report of where it stands may come later than what said that it does.
                let _ = self.host.status();
            }
        }
    }

    fn reason(&self, outcome: Outcome) -> Option<String> {
        let reason = match outcome {
            Outcome::Finished | Outcome::Cancelled => return None,
            Outcome::TimedOut => "the robot did not answer in time",
            Outcome::Failed => "the robot stopped before it was there",
            Outcome::Refused if self.view.state.state == Doing::Error => "the robot is in state ERROR",
            Outcome::Refused if !self.view.state.position_known => {
                "the robot does not know its position, and has to home first"
            }
            Outcome::Refused => "the robot refused",
        };
        Some(reason.to_owned())
    }

    fn send(&mut self, now: u32) -> Result<(), Failure> {
        let mut frame = [0; REQUEST_MAX];
        loop {
            let length = self.host.output(&mut frame, REQUEST_MAX, now);
            let frame = frame.get(..length).unwrap_or_default();
            if frame.is_empty() {
                return Ok(());
            }
            self.device.write(frame)?;
            self.tap.passed(Side::Host, frame);
        }
    }

    /// Does what was asked for, cancelling first. Returns whether there was anything.
    fn take_orders(&mut self) -> Result<bool, Failure> {
        let inbox = std::mem::take(&mut *locked(&self.view.robot.inbox));
        let is_cancelled = !inbox.cancels.is_empty();
        let is_empty = !is_cancelled && inbox.orders.is_empty() && inbox.raw.is_empty();
        if is_cancelled {
            self.cancel();
            self.cancels.extend(inbox.cancels);
        }
        for order in inbox.orders {
            let begun = if is_cancelled { Err(overtaken()) } else { self.begin(&order) };
            let _ = order.reply.send(begun);
        }
        for raw in inbox.raw {
            let is_sent = if is_cancelled { Err(overtaken()) } else { self.send_raw(&raw)? };
            let _ = raw.reply.send(is_sent);
        }
        Ok(!is_empty)
    }

    fn begin(&mut self, order: &Order) -> Result<Begun, Problem> {
        if self.ending.is_some() {
            return Err(Problem::new(Kind::Down, "the program is ending"));
        }
        if order.expires.is_some_and(|expires| expires <= Instant::now()) {
            return Err(Problem::new(Kind::Expired, "its time was over when it could be done"));
        }
        let by = self.view.robot.leases.holder(&order.word)?;
        let busy = |_| Problem::new(Kind::Busy, "it has not ended its last motion yet");
        let (kind, target) = match order.command {
            Command::Home => {
                self.host.home().map_err(busy)?;
                (Motion::Home, None)
            }
            Command::Move(goal) => {
                let target = goal.resolve(&self.view.state)?;
                self.host.move_to(Position(target.map(f32::to_bits))).map_err(busy)?;
                (Motion::Move, Some(target))
            }
        };
        self.raw_sent = None;
        // Who drives is published before what it does.
        self.view.look_around();
        Ok(self.view.begin(kind, target, by))
    }

    fn send_raw(&mut self, raw: &Raw) -> Result<Result<(), Problem>, Failure> {
        if let Err(problem) = self.view.robot.leases.holder(&raw.word) {
            return Ok(Err(problem));
        }
        self.raw_sent = Some(Instant::now());
        self.device.write(&raw.bytes)?;
        self.tap.passed(Side::Host, &raw.bytes);
        Ok(Ok(()))
    }

    /// Whether the program ends, and the robot stands or does not answer.
    fn is_ended(&mut self) -> bool {
        if !self.view.robot.is_ending() {
            return false;
        }
        let Some(began) = self.ending else {
            if !self.is_in_motion() {
                return true;
            }
            self.ending = Some(Instant::now());
            self.cancel();
            return false;
        };
        !self.is_in_motion() || began.elapsed() >= END_TIME
    }

    /// Asks for the status where none has come for a while: but not in the middle of what somebody else sends.
    fn ask(&mut self) {
        let is_quiet = self.raw_sent.is_none_or(|sent| sent.elapsed() >= STATUS_AFTER);
        if self.asked.elapsed() >= STATUS_AFTER && is_quiet && !self.host.is_busy() {
            self.asked = Instant::now();
            let _ = self.host.status();
        }
    }

    /// Waits for bytes, or for being woken up.
    fn receive(&mut self, now: u32) -> Result<(), Failure> {
        let Self { device, woken, clock, received, tap, .. } = self;
        if received.is_empty() {
            let left = self.host.next_deadline(now).map_or(SLICE, |left| Duration::from_millis(left.into()));
            let came = clock.receive(left, |time| {
                let (has_bytes, is_woken) = wait_for_both(device, woken, time)?;
                if is_woken {
                    drain(woken);
                }
                let has_bytes = has_bytes && device.receive(Duration::ZERO)?.is_some();
                Ok((has_bytes || is_woken).then_some(has_bytes))
            })?;
            if came == Some(true) {
                received.extend_from_slice(device.bytes());
                tap.passed(Side::Controller, device.bytes());
            }
            tap.idle();
        }
        // What does not fit into the session's ring waits until that was polled.
        let taken = self.host.receive(received, clock.now_ms());
        received.drain(..taken);
        Ok(())
    }
}

fn overtaken() -> Problem {
    Problem::new(Kind::Busy, "the robot was cancelled at the same time")
}

/// Whether the device has bytes or is gone, and whether the thread was woken up.
fn wait_for_both(device: &Device, woken: &Wake, time: Duration) -> Result<(bool, bool), Failure> {
    let happened = wait_for_any([device.as_fd(), woken.as_fd()], time);
    let [device, woken] = happened.map_err(|error| Failure::of_file("poll", &error.into()))?.map(|it| !it.is_empty());
    Ok((device, woken))
}

fn settings(robot: &Settings, device: &Device) -> host::Settings {
    host::Settings {
        operation_ms: robot.timeout.map_or(0, |timeout| u32::try_from(timeout.as_millis()).unwrap_or(u32::MAX)),
        layout: robot.layout as u8,
        ..session_settings(device, robot.answer_time.unwrap_or_else(|| device.answer_time()))
    }
}
