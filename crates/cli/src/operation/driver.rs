//! A session with the controller of a robot, in which requests are made one after the other.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use deltarobot_protocols::deltarobot::host::{self, Event, Health, Outcome, REQUEST_MAX, Settings};
use deltarobot_protocols::deltarobot::{Layout, Opcode, Position, Report, State, receiver_room};

use super::SessionOptions;
use super::report::Reporter;
use super::seen::Seen;
use crate::clock::{Clock, SLICE};
use crate::port::{Device, Opening, PortOptions, positive_seconds, seconds};
use crate::screen::complain;
use crate::signals::Signals;
use crate::status::Failure;
use crate::system::tapped_device;

/// How long a controller may take to be ready, unless the user says how long.
const READY_TIME: Duration = Duration::from_secs(30);
/// How long it is tried to cancel a motion where the port has disappeared.
const RESCUE_TIME: Duration = Duration::from_secs(3);

/// The session, with the room for frames of the longest payload that boards send.
type Host = host::Host<{ receiver_room(32) }>;

/// How long things may take.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct Timing {
    /// Gives a request up after so many seconds. By default after 120 for `home` and `move`; sooner when nothing answers,
    /// as --answer-time and --attempts say
    #[arg(long, value_name = "SECONDS", value_parser = positive_seconds)]
    timeout: Option<f64>,
    /// How long an answer may take before the request is sent again, in seconds; 0.25 by default, at a network port 1
    #[arg(long, value_name = "SECONDS", value_parser = positive_seconds)]
    answer_time: Option<f64>,
    /// How often a request is sent until it is answered; by default 4 times, or as often as fits into --timeout
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u8).range(1..))]
    attempts: Option<u8>,
    /// How the controller lays out its status reports
    #[arg(long, value_enum, default_value_t = Reports::Auto)]
    layout: Reports,
}

/// Layouts of status reports.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Reports {
    Auto,
    Spec,
    Firmware,
}

/// What is waited for after opening.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Wait {
    Time(Duration),
    Ready,
}

pub(crate) fn wait(text: &str) -> Result<Wait, String> {
    if text == "ready" {
        return Ok(Wait::Ready);
    }
    let seconds = seconds(text).map_err(|error| format!("{error}, nor `ready`"))?;
    Ok(Wait::Time(Duration::from_secs_f64(seconds)))
}

impl Timing {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most a day's milliseconds")]
    fn settings(&self, device: &Device) -> Settings {
        let ms = |time: f64| (time * 1000.0).ceil() as u32;
        let mut answer_ms = self.answer_time.map_or_else(|| ms(device.answer_time().as_secs_f64()), ms);
        let mut attempts = self.attempts.unwrap_or(4);
        let timeout = self.timeout.map(ms);
        if let (Some(timeout), None) = (timeout, self.attempts) {
            answer_ms = answer_ms.max(timeout.div_ceil(255));
            attempts = timeout.div_ceil(answer_ms).try_into().unwrap_or(255);
        }
        let mut settings = session_settings(device, Duration::from_millis(answer_ms.into()));
        settings.attempts = attempts.into();
        if let Some(timeout) = timeout {
            settings.operation_ms = timeout;
            settings.silence_ms = settings.silence_ms.max(timeout);
        }
        settings.layout = match self.layout {
            Reports::Auto => Layout::Auto,
            Reports::Spec => Layout::Spec,
            Reports::Firmware => Layout::Firmware,
        } as _;
        settings
    }
}

/// Those of a session at this port, when an answer may take so long.
pub fn session_settings(device: &Device, answer: Duration) -> Settings {
    let ms = |time: Duration| u32::try_from(time.as_micros().div_ceil(1000)).unwrap_or(u32::MAX);
    let ack_ms = ms(answer);
    Settings {
        ack_ms,
        guard_ms: ack_ms.saturating_mul(2).max(500),
        silence_ms: ack_ms.saturating_mul(4).max(3000),
        gap_ms: ms(device.gap()),
        ..Settings::default()
    }
}

/// A request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Request {
    Home,
    Move(Position),
    Status,
    Cancel,
}

impl Request {
    const fn opcode(self) -> Opcode {
        match self {
            Self::Home => Opcode::HOMING,
            Self::Move(_) => Opcode::MOVE,
            Self::Status => Opcode::STATUS,
            Self::Cancel => Opcode::CANCEL,
        }
    }

    /// Its name as a subcommand.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Home => "home",
            Self::Move(_) => "move",
            Self::Status => "status",
            Self::Cancel => "cancel",
        }
    }

    const fn moves(self) -> bool {
        matches!(self, Self::Home | Self::Move(_))
    }

    /// (Never busy: one follows the other.)
    fn start(self, host: &mut Host) -> bool {
        match self {
            Self::Home => host.home(),
            Self::Move(target) => host.move_to(target),
            Self::Status => host.status(),
            Self::Cancel => host.cancel(),
        }
        .is_ok()
    }
}

/// How a request ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Outcome(Outcome),
    /// It was accepted, which is enough.
    Accepted,
    /// The user does not want to wait for its outcome.
    Interrupted,
}

pub(crate) struct Driver<'a> {
    path: &'a Path,
    options: &'a SessionOptions,
    signals: &'a Signals,
    device: Device,
    /// Where the controller is, if the port is another program's tap.
    tapped: Option<PathBuf>,
    host: Host,
    clock: Clock,
    /// What was received and is not in the session yet.
    received: Vec<u8>,
    seen: Seen,
}

impl<'a> Driver<'a> {
    /// `None` when it is interrupted before the port is there.
    pub(crate) fn open(
        path: &'a Path,
        options: &'a SessionOptions,
        signals: &'a Signals,
    ) -> Result<Option<Self>, Failure> {
        let opening = Opening::new(path, &options.port, false);
        let Some(device) = opening.open(|| signals.is_raised())? else { return Ok(None) };
        let host = Host::new(options.timing.settings(&device));
        Ok(Some(Self {
            path,
            options,
            signals,
            device,
            tapped: tapped_device(path),
            host,
            clock: Clock::new(),
            received: Vec::new(),
            seen: Seen::default(),
        }))
    }

    pub(crate) fn last_report(&self) -> Option<Report> {
        self.host.last_report().copied()
    }

    pub(crate) fn health(&self) -> &Health {
        self.host.health()
    }

    pub(crate) const fn seen(&self) -> &Seen {
        &self.seen
    }

    /// Waits as the user wants. The outcome is finished, or why nothing can be requested.
    pub(crate) fn get_ready(&mut self) -> Result<End, Failure> {
        let finished = End::Outcome(Outcome::Finished);
        match self.options.wait {
            None => Ok(finished),
            Some(Wait::Time(time)) => Ok(if self.pause(time)? { finished } else { End::Interrupted }),
            Some(Wait::Ready) => {
                let (began, mut reporter) = (Instant::now(), Reporter::silent());
                let time = self.options.timing.timeout.map_or(READY_TIME, Duration::from_secs_f64);
                loop {
                    match self.perform(Request::Status, false, &mut reporter)? {
                        End::Outcome(Outcome::TimedOut) if began.elapsed() < time => (),
                        // Requests made after that end without an answer.
                        End::Outcome(_) => return Ok(finished),
                        end => return Ok(end),
                    }
                }
            }
        }
    }

    /// Lets time pass. Returns false when the user ended it.
    pub(crate) fn pause(&mut self, time: Duration) -> Result<bool, Failure> {
        let began = Instant::now();
        loop {
            let left = time.saturating_sub(began.elapsed());
            if self.signals.came() {
                return Ok(false);
            }
            if left.is_zero() {
                return Ok(true);
            }
            // What is reported meanwhile is no answer to anything.
            if self.clock.receive(left, |time| self.device.receive(time))?.is_some() {
                self.seen.received(self.device.bytes());
            }
        }
    }

    /// Makes a request, and waits for its end.
    pub(crate) fn perform(&mut self, request: Request, no_wait: bool, reporter: &mut Reporter) -> Result<End, Failure> {
        self.seen = Seen::default();
        request.start(&mut self.host);
        let mut turn = Turn { request, no_wait, was_interrupted: false, outcome: None };
        match self.follow(&mut turn, reporter) {
            Err(failure @ Failure::Device(_)) if request.moves() => Err(self.rescue(&failure)),
            result => result,
        }
    }

    fn follow(&mut self, turn: &mut Turn, reporter: &mut Reporter) -> Result<End, Failure> {
        loop {
            let now = self.clock.now_ms();
            while let Some(event) = self.host.poll(now, &mut [0; 0]) {
                if let Some(end) = turn.handle(event, &mut self.host, reporter) {
                    return Ok(end);
                }
            }
            self.send(now)?;
            if self.received.is_empty() {
                let left = self.host.next_deadline(now).map_or(SLICE, |left| Duration::from_millis(left.into()));
                if self.clock.receive(left, |time| self.device.receive(time))?.is_some() {
                    self.received.extend_from_slice(self.device.bytes());
                    self.seen.received(self.device.bytes());
                }
            }
            // What does not fit into the session's ring waits until that was polled.
            let taken = self.host.receive(&self.received, self.clock.now_ms());
            self.received.drain(..taken);
            if self.signals.came() && turn.interrupt(&mut self.host) {
                return Ok(End::Interrupted);
            }
        }
    }

    fn send(&mut self, now: u32) -> Result<(), Failure> {
        let mut frame = [0; REQUEST_MAX];
        loop {
            let length = self.host.output(&mut frame, REQUEST_MAX, now);
            let frame = frame.get(..length).unwrap_or_default();
            if frame.is_empty() {
                return Ok(());
            }
            self.seen.sent(frame);
            self.device.write(frame)?;
        }
    }

    /// The port has gone while the robot moves, and nobody would see how that ends: it is to stop, if the port comes
    /// back, or the controller can be reached without the tap that it was reached through. Returns what became of that.
    fn rescue(&mut self, failure: &Failure) -> Failure {
        let path = self.tapped.clone().unwrap_or_else(|| self.path.to_owned());
        let said = match self.try_to_cancel(&path) {
            Ok(true) => format!("the motion was cancelled at {}", path.display()),
            Ok(false) => "the motion was not cancelled: no answer".to_owned(),
            Err(failure) => format!("the motion was not cancelled: {failure}"),
        };
        Failure::Device(format!("{failure}; {said}"))
    }

    fn try_to_cancel(&mut self, path: &Path) -> Result<bool, Failure> {
        let began = Instant::now();
        let options = PortOptions::clone(&self.options.port);
        self.device = loop {
            match Device::open(path, &options) {
                Ok(device) => break device,
                Err(failure) if began.elapsed() >= RESCUE_TIME => return Err(failure),
                Err(_) => std::thread::sleep(Duration::from_millis(50)),
            }
        };
        self.host = Host::new(self.options.timing.settings(&self.device));
        self.received.clear();
        Request::Cancel.start(&mut self.host);
        let mut turn = Turn { request: Request::Cancel, no_wait: false, was_interrupted: false, outcome: None };
        let end = self.follow(&mut turn, &mut Reporter::silent())?;
        Ok(matches!(end, End::Outcome(Outcome::Finished | Outcome::Cancelled)))
    }
}

/// A request that is going on.
struct Turn {
    request: Request,
    no_wait: bool,
    was_interrupted: bool,
    /// How it has ended, when only where the robot came to stand is not known yet.
    outcome: Option<Outcome>,
}

impl Turn {
    /// Returns how the request ended, if it did.
    fn handle(&mut self, event: Event, host: &mut Host, reporter: &mut Reporter) -> Option<End> {
        match event {
            Event::Accepted(_) if self.no_wait => return Some(End::Accepted),
            Event::State if self.request != Request::Status => {
                host.last_report().into_iter().for_each(|report| reporter.state(report));
            }
            Event::Status => host.last_report().into_iter().for_each(|report| reporter.progress(report)),
            Event::GeneralError => reporter.error(),
            Event::Ended(Opcode::STATUS, _) if self.outcome.is_some() => return self.outcome.map(End::Outcome),
            Event::Ended(opcode, outcome) if opcode == self.request.opcode() => return self.end_or_ask(outcome, host),
            Event::Ended(Opcode::CANCEL, Outcome::Refused | Outcome::TimedOut) if self.was_interrupted => {
                complain("the controller did not cancel");
            }
            _ => (),
        }
        None
    }

    /// Ctrl-C stops the robot; whoever presses it again, or where nothing moves, only wants to end. Returns whether
    /// that is so.
    fn interrupt(&mut self, host: &mut Host) -> bool {
        if !self.request.moves() || self.was_interrupted {
            return true;
        }
        self.was_interrupted = true;
        host.cancel().is_err()
    }

    /// The specification's `h`, `m` and `e` come before the report that says so, an ack to a cancel request alone, and
    /// so does the nack of a robot that does not know its position.
    fn end_or_ask(&mut self, outcome: Outcome, host: &mut Host) -> Option<End> {
        let stands = host.last_report().is_some_and(|it| matches!(it.state(), State::Idle | State::Error));
        if stands || outcome == Outcome::TimedOut || host.status().is_err() {
            return Some(End::Outcome(outcome));
        }
        self.outcome = Some(outcome);
        None
    }
}
