//! `deltarobot home`, `move`, `status` and `cancel`: one request, seen through to its end.

mod teller;

use std::env;
use std::path::PathBuf;

use deltarobot_protocols::config::DP_DATA_MAX_SIZE;
use deltarobot_protocols::deltarobot::host::{Event, Host, Outcome, REQUEST_MAX, Settings};
use deltarobot_protocols::deltarobot::{Layout, Opcode, POSITION_SIZE, Position, State, receiver_room};

use crate::port::{Device, Speed};
use crate::screen::complain;
use crate::signals::Signals;
use crate::status::{Failure, Status};
use teller::Teller;

/// Of the session's receiver.
const ROOM: usize = receiver_room(DP_DATA_MAX_SIZE);

/// The longest that is waited without looking whether the user wants to end.
const TURN_MS: u32 = 100;

#[derive(Debug, clap::Args)]
pub(crate) struct Home {
    #[command(flatten)]
    operation: Operation,
    #[command(flatten)]
    common: Common,
}

/// A request that needs to know no more.
#[derive(Debug, clap::Args)]
pub(crate) struct Plain {
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub(crate) struct Move {
    /// Displacement of arm A
    a: f32,
    /// Displacement of arm B
    b: f32,
    /// Displacement of arm C
    c: f32,
    #[command(flatten)]
    operation: Operation,
    #[command(flatten)]
    common: Common,
}

/// What takes its time.
#[derive(Clone, Copy, Debug, clap::Args)]
struct Operation {
    /// Seconds after which the operation is given up
    #[arg(long, value_name = "SECONDS", default_value_t = 120.0, value_parser = seconds)]
    timeout: f64,
    /// Ends as soon as the controller has accepted, so that `cancel` can be used
    #[arg(long)]
    no_wait: bool,
}

#[derive(Debug, clap::Args)]
struct Common {
    /// The device that the controller is at; by default what the environment's variable DELTAROBOT_PORT says
    port: Option<PathBuf>,
    /// The same, by an option
    #[arg(id = "option", short = 'p', long = "port", value_name = "PORT", conflicts_with = "port")]
    option: Option<PathBuf>,
    /// How the controller lays out its status reports
    #[arg(long, value_enum, default_value_t = Reports::Auto)]
    layout: Reports,
    /// One JSON object at the end instead of lines
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    speed: Speed,
}

impl Common {
    /// (Not by clap, for which a variable is as good as an option, and would be at odds with the argument.)
    fn port(&self) -> Result<PathBuf, Failure> {
        let given = self.port.as_ref().or(self.option.as_ref()).cloned();
        let in_environment = || env::var_os("DELTAROBOT_PORT").filter(|port| !port.is_empty()).map(PathBuf::from);
        given.or_else(in_environment).ok_or_else(|| Failure::Usage("a <PORT> is needed; try --help".into()))
    }
}

/// Layouts of status reports.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Reports {
    Auto,
    Spec,
    Firmware,
}

/// A time from a tenth of a second to a day.
fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (0.1..=86_400.0).contains(&seconds) => Ok(seconds),
        _ => Err("not a number of seconds from 0.1 to 86400".into()),
    }
}

pub(crate) fn home(arguments: &Home) -> Result<Status, Failure> {
    request(&arguments.common, Some(arguments.operation), Opcode::HOMING, |host| host.home().is_ok())
}

pub(crate) fn move_to(arguments: &Move) -> Result<Status, Failure> {
    let target = Position([arguments.a, arguments.b, arguments.c].map(f32::to_bits));
    if !target.is_finite() {
        return Err(Failure::Usage("a displacement must be a finite number".into()));
    }
    if DP_DATA_MAX_SIZE < POSITION_SIZE {
        return Err(Failure::Usage("this build's frames are too short for a position".into()));
    }
    request(&arguments.common, Some(arguments.operation), Opcode::MOVE, |host| host.move_to(target).is_ok())
}

pub(crate) fn status(arguments: &Plain) -> Result<Status, Failure> {
    request(&arguments.common, None, Opcode::STATUS, |host| host.status().is_ok())
}

pub(crate) fn cancel(arguments: &Plain) -> Result<Status, Failure> {
    request(&arguments.common, None, Opcode::CANCEL, |host| host.cancel().is_ok())
}

fn request(
    common: &Common,
    operation: Option<Operation>,
    opcode: Opcode,
    start: impl FnOnce(&mut Host<ROOM>) -> bool,
) -> Result<Status, Failure> {
    let port = common.port()?;
    let signals = Signals::catch()?;
    let device = Device::open(&port, common.speed)?;
    let mut session = Session {
        opcode,
        host: Host::new(settings(common, operation)),
        device,
        teller: Teller::new(common.json),
        ends_when_accepted: operation.is_some_and(|operation| operation.no_wait),
        was_interrupted: false,
        outcome: None,
    };
    start(&mut session.host);
    session.run(&signals)
}

fn settings(common: &Common, operation: Option<Operation>) -> Settings {
    let mut settings = Settings::new();
    settings.layout = match common.layout {
        Reports::Auto => Layout::Auto,
        Reports::Spec => Layout::Spec,
        Reports::Firmware => Layout::Firmware,
    } as u8;
    if let Some(operation) = operation {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most a day's milliseconds")]
        let timeout = (operation.timeout * 1000.0) as u32;
        settings.operation_ms = timeout;
    }
    settings
}

struct Session {
    /// What is requested.
    opcode: Opcode,
    host: Host<ROOM>,
    device: Device,
    teller: Teller,
    ends_when_accepted: bool,
    was_interrupted: bool,
    /// How it has ended, when only where the robot came to stand is not known yet.
    outcome: Option<Outcome>,
}

/// Whether a session goes on.
enum Next {
    GoOn,
    End(Outcome),
    /// It goes on without us.
    Leave,
}

impl Session {
    fn run(&mut self, signals: &Signals) -> Result<Status, Failure> {
        let mut received = Vec::new();
        loop {
            let now = self.teller.now();
            while let Some(event) = self.host.poll(now, &mut [0; 0]) {
                match self.handle(event) {
                    Next::GoOn => (),
                    Next::End(outcome) => return Ok(self.end(outcome)),
                    Next::Leave => return Ok(Status::Finished),
                }
            }
            self.send(now)?;
            if received.is_empty() {
                let patience = self.host.next_deadline(now).unwrap_or(TURN_MS).min(TURN_MS);
                received.extend_from_slice(self.device.read(patience)?);
            }
            // What does not fit into the session waits until that was polled.
            let taken = self.host.receive(&received, self.teller.now());
            received.drain(..taken);
            if signals.came() && self.interrupt() {
                return Ok(Status::Cancelled);
            }
        }
    }

    fn send(&mut self, now: u32) -> Result<(), Failure> {
        let mut frame = [0; REQUEST_MAX];
        loop {
            match self.host.output(&mut frame, REQUEST_MAX, now) {
                0 => return Ok(()),
                length => self.device.write(frame.get(..length).unwrap_or_default())?,
            }
        }
    }

    fn handle(&mut self, event: Event) -> Next {
        match event {
            Event::Accepted(_) if self.ends_when_accepted => {
                self.teller.accepted(self.opcode);
                return Next::Leave;
            }
            Event::State(report) if self.opcode != Opcode::STATUS => self.teller.state(&report),
            Event::Status(report) => self.teller.progress(&report),
            Event::GeneralError => self.teller.error(),
            Event::Ended(Opcode::STATUS, _) if self.outcome.is_some() => {
                return self.outcome.map_or(Next::GoOn, Next::End);
            }
            Event::Ended(opcode, outcome) if opcode == self.opcode => return self.end_or_ask(outcome),
            Event::Ended(Opcode::CANCEL, Outcome::Refused | Outcome::TimedOut) if self.was_interrupted => {
                complain("the controller did not cancel");
            }
            _ => (),
        }
        Next::GoOn
    }

    /// Ctrl-C stops the robot; whoever presses it again, or where nothing moves, only wants to end. Returns whether
    /// that is so.
    fn interrupt(&mut self) -> bool {
        let moves = matches!(self.opcode, Opcode::HOMING | Opcode::MOVE);
        if !moves || self.was_interrupted {
            return true;
        }
        self.was_interrupted = true;
        self.host.cancel().is_err()
    }

    /// The specification's `h`, `m` and `e` come before the report that says so, and an ack to a cancel request alone.
    fn end_or_ask(&mut self, outcome: Outcome) -> Next {
        let stands = self.host.last_report().is_some_and(|it| matches!(it.state(), State::Idle | State::Error));
        if stands || matches!(outcome, Outcome::Refused | Outcome::TimedOut) || self.host.status().is_err() {
            return Next::End(outcome);
        }
        self.outcome = Some(outcome);
        Next::GoOn
    }

    fn end(&mut self, outcome: Outcome) -> Status {
        self.teller.ended(self.opcode, outcome, self.host.last_report(), self.host.health());
        match outcome {
            Outcome::Finished => Status::Finished,
            Outcome::Refused | Outcome::Failed => Status::NotDone,
            Outcome::Cancelled => Status::Cancelled,
            Outcome::TimedOut => Status::TimedOut,
        }
    }
}
