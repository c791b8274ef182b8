//! `deltarobot send`: commands of the other two protocols, seen through to their ends by sessions.

mod gx;
mod line;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::clock::{Clock, SLICE};
use crate::operation::driver::{Wait, wait};
use crate::port::{Device, Opening, PortOptions, positive_seconds};
use crate::protocol::{Protocol, Spoken};
use crate::screen::{Screen, complain};
use crate::signals::Signals;
use crate::status::{Failure, Status};

/// How long a device may take to be ready.
const READY_TIME: Duration = Duration::from_secs(30);

#[derive(Debug, clap::Args)]
#[command(
    after_help = "With --protocol line a command is the beginning of a line, such as `c=setswitch&state=1`: `t`, `id` \
    and, where it is in force, the checksum are added. One follows the other. With --protocol gx it is a move in \
    ASCII, such as `V1000x400y300`; several are under way at a time, and when one fails, those behind it are dropped; \
    Ctrl-C stops the machine. `hold`, `resume`, `stop` and `query` stand alone: they pause, go on, stop and \
    forget all moves, and ask how much room there is, if the machine knows these extensions."
)]
pub(crate) struct Arguments {
    /// The device
    port: PathBuf,
    /// What to send, in this order
    #[arg(required = true)]
    commands: Vec<String>,
    #[command(flatten)]
    spoken: Spoken,
    /// One JSON object for each command
    #[arg(long)]
    json: bool,
    /// Waits after opening: so many seconds, or until the device has said anything, such as its welcome
    #[arg(long, value_name = "SECONDS|ready", value_parser = wait)]
    wait: Option<Wait>,
    /// How long an answer may take before the command is sent again, in seconds
    #[arg(long, value_name = "SECONDS", value_parser = positive_seconds)]
    answer_time: Option<f64>,
    /// How often a command is sent until it is answered; by default 4 times, with --protocol gx 8 times
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u8).range(1..))]
    attempts: Option<u8>,
    #[command(flatten)]
    line: line::LineOptions,
    #[command(flatten)]
    gx: gx::GxOptions,
    #[command(flatten)]
    options: PortOptions,
}

impl Arguments {
    /// How long an answer may take, in milliseconds.
    fn answer_ms(&self, device: &Device) -> u32 {
        let time = self.answer_time.map_or_else(|| device.answer_time(), Duration::from_secs_f64);
        u32::try_from(time.as_millis()).unwrap_or(u32::MAX)
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let mut report = Report { screen: Screen::new(), json: arguments.json, began: Instant::now() };
    send(arguments, &mut report).inspect_err(|failure| report.failed(failure))
}

fn send(arguments: &Arguments, report: &mut Report) -> Result<Status, Failure> {
    let protocol = arguments.spoken.protocol;
    let given = [(Protocol::Line, arguments.line.given()), (Protocol::Gx, arguments.gx.given())];
    protocol.refuse_others(&given)?;
    let commands = match protocol {
        Protocol::Deltarobot => {
            let text = "it takes --protocol line or gx; for a delta robot there are home, move, status and cancel";
            return Err(Failure::Usage(text.into()));
        }
        Protocol::Line => None,
        Protocol::Gx => Some(gx::Commands::parse(&arguments.commands)?),
    };
    arguments.line.check(protocol)?;
    let signals = Signals::catch()?;
    let opening = Opening::new(&arguments.port, &arguments.options, false);
    let Some(device) = opening.open(|| signals.is_raised())? else { return Ok(Status::Cancelled) };
    let mut link = Link { device, clock: Clock::new(), received: Vec::new(), signals: &signals };
    if !link.get_ready(arguments.wait)? {
        return Ok(Status::Cancelled);
    }
    match commands {
        Some(commands) => gx::send(arguments, commands, &mut link, report),
        None => line::send(arguments, &mut link, report),
    }
}

/// What a session does, whichever it is.
trait Session {
    /// Handles what has happened; returns whether all is done.
    fn handle(&mut self, now: u32, report: &mut Report) -> Option<Status>;
    /// The next bytes to send.
    fn output(&mut self, room: &mut [u8], now: u32) -> usize;
    fn receive(&mut self, bytes: &[u8], now: u32) -> usize;
    /// Ends what it can, for Ctrl-C. Returns whether there is nothing to wait for.
    fn interrupt(&mut self) -> bool;
    /// Milliseconds until there is something to do.
    fn next_deadline(&self, now: u32) -> Option<u32>;
}

/// An open port, and what came from it.
struct Link<'a> {
    device: Device,
    clock: Clock,
    received: Vec<u8>,
    signals: &'a Signals,
}

impl Link<'_> {
    /// Returns false when it was interrupted.
    fn get_ready(&mut self, wait: Option<Wait>) -> Result<bool, Failure> {
        let (time, until_heard) = match wait {
            None => return Ok(true),
            Some(Wait::Time(time)) => (time, false),
            Some(Wait::Ready) => (READY_TIME, true),
        };
        let began = Instant::now();
        while began.elapsed() < time && (!until_heard || self.received.is_empty()) {
            if self.signals.is_raised() {
                return Ok(false);
            }
            self.listen(time.saturating_sub(began.elapsed()))?;
        }
        // The rest of what it has to say first.
        while until_heard && self.listen(self.device.gap())? {}
        Ok(true)
    }

    /// Takes what comes within a time; returns whether anything came. A [`SLICE`] at a time is waited.
    fn listen(&mut self, time: Duration) -> Result<bool, Failure> {
        let began = Instant::now();
        loop {
            let left = time.saturating_sub(began.elapsed());
            let device = &mut self.device;
            if self.clock.receive(left, |time| device.receive(time))?.is_some() {
                self.received.extend_from_slice(self.device.bytes());
                return Ok(true);
            }
            if began.elapsed() >= time || self.signals.is_raised() {
                return Ok(false);
            }
        }
    }

    /// Runs a session until all is done.
    fn run(&mut self, session: &mut impl Session, report: &mut Report) -> Result<Status, Failure> {
        let mut room = [0; 256];
        loop {
            let now = self.clock.now_ms();
            if let Some(status) = session.handle(now, report) {
                return Ok(status);
            }
            loop {
                let length = session.output(&mut room, now);
                if length == 0 {
                    break;
                }
                self.device.write(room.get(..length).unwrap_or_default())?;
            }
            if self.received.is_empty() {
                let left = session.next_deadline(now).map_or(SLICE, |left| Duration::from_millis(left.into()));
                self.listen(left.min(SLICE))?;
            }
            let taken = session.receive(&self.received, self.clock.now_ms());
            self.received.drain(..taken);
            if self.signals.came() && session.interrupt() {
                complain("interrupted: what was sent is not cancelled");
                return Ok(Status::Cancelled);
            }
        }
    }
}

/// What is said about commands.
struct Report {
    screen: Screen,
    json: bool,
    began: Instant,
}

impl Report {
    /// What is under way can't be followed to its end.
    fn failed(&mut self, failure: &Failure) {
        if self.json {
            let value = json!({ "outcome": "error", "error": failure.to_string() });
            let _ = self.screen.put_json(&value).and_then(|()| self.screen.flush());
        }
    }

    /// A command has ended. What is wrong with standard output changes nothing about that.
    fn ended(&mut self, command: &str, outcome: &str, said: Option<&str>, mut more: Value) {
        let seconds = self.began.elapsed().as_secs_f64();
        let result = if self.json {
            if let Some(object) = more.as_object_mut() {
                object.insert("command".into(), command.into());
                object.insert("outcome".into(), outcome.replace(' ', "_").into());
                object.insert("seconds".into(), json!((seconds * 1000.0).round() / 1000.0));
            }
            self.screen.put_json(&more)
        } else {
            let said = said.map_or(String::new(), |said| format!(": {said}"));
            self.screen.put(&format!("{command} {outcome} after {seconds:.1} s{said}"))
        };
        let _ = result.and_then(|()| self.screen.flush());
    }
}
