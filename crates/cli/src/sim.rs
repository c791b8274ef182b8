//! `deltarobot sim`: a machine at the far end of a device, and faults to order. A file for each protocol's machine.

pub mod deltarobot;
mod faults;
mod gx;
mod line;
pub mod random;

use std::time::Duration;

use crate::clock::Clock;
use crate::decoder::{Decoder, Piece};
use crate::far_end::{FarEnd, Input, Place};
use crate::port::GAP_DIRECT;
use crate::protocol::{Protocol, Spoken};
use crate::recording::Side;
use crate::screen::Screen;
use crate::signals::Signals;
use crate::status::{Failure, Status};
use faults::Faults;
use random::Random;

/// How often a machine is moved on.
pub const TICK: Duration = Duration::from_millis(5);

/// What is at the other end of the line. Times are since the simulation began.
pub trait Machine {
    /// A program has opened the device.
    fn connected(&mut self, _now: Duration) {}

    /// Takes what came from the host, and adds what it answers.
    fn receive(&mut self, bytes: &[u8], now: Duration, out: &mut Vec<u8>);

    /// Goes on, and adds what it has to say.
    fn turn(&mut self, now: Duration, out: &mut Vec<u8>);
}

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Prints the path of its device, and runs until Ctrl-C. A delta robot's end stops are where a \
    displacement is 0.",
    allow_negative_numbers = true
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    spoken: Spoken,
    #[command(flatten)]
    place: Place,
    /// Probability of each byte, in both directions, to be lost
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = probability)]
    lose: f64,
    /// Probability of each byte, in both directions, to have one bit flipped
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = probability)]
    flip: f64,
    /// Takes the device away so many seconds after the first byte was received, and ends
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    disconnect_after: Option<f64>,
    /// Makes the faults the same each time
    #[arg(long, value_name = "NUMBER")]
    seed: Option<u64>,
    /// Prints each message
    #[arg(short, long)]
    verbose: bool,
    #[command(flatten)]
    deltarobot: deltarobot::ControllerOptions,
    #[command(flatten)]
    line: line::DevicesOptions,
    #[command(flatten)]
    gx: gx::AxesOptions,
}

impl Arguments {
    /// # Errors
    ///
    /// When options of another protocol are given.
    fn machine(&self) -> Result<Box<dyn Machine>, Failure> {
        let spoken = self.spoken.protocol;
        let given = [
            (Protocol::Deltarobot, self.deltarobot.given()),
            (Protocol::Line, self.line.given()),
            (Protocol::Gx, self.gx.given()),
        ];
        spoken.refuse_others(&given)?;
        Ok(match spoken {
            Protocol::Deltarobot => Box::new(deltarobot::Controller::new(&self.deltarobot, Random::new(self.seed))),
            Protocol::Line => Box::new(line::Devices::new(&self.line)),
            Protocol::Gx => Box::new(gx::Axes::new(&self.gx)),
        })
    }
}

fn probability(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(probability) if (0.0..=1.0).contains(&probability) => Ok(probability),
        _ => Err("not a probability from 0 to 1".into()),
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if (0.0..=1e6).contains(&number) => Ok(number),
        _ => Err("not a number from 0 to a million".into()),
    }
}

fn above_zero(text: &str) -> Result<f64, String> {
    seconds(text).and_then(|number| if number > 0.0 { Ok(number) } else { Err("nothing would happen".into()) })
}

/// As sessions count time: it wraps.
#[expect(clippy::cast_possible_truncation, reason = "that is the point")]
const fn milliseconds(now: Duration) -> u32 {
    now.as_millis() as u32
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let machine = arguments.machine()?;
    let signals = Signals::catch()?;
    let far_end = arguments.place.make(None)?;
    let mut screen = Screen::new();
    screen.line(&far_end.path().display().to_string())?;
    let watcher = arguments.verbose.then(|| Watcher {
        screen,
        decoder: arguments.spoken.protocol.decoder(),
        heard: Duration::ZERO,
    });
    Sim {
        machine,
        watcher,
        far_end,
        faults: Faults::new(arguments.lose, arguments.flip, Random::new(arguments.seed)),
        clock: Clock::new(),
    }
    .run(&signals, arguments.disconnect_after.map(Duration::from_secs_f64))
}

struct Sim {
    machine: Box<dyn Machine>,
    watcher: Option<Watcher>,
    far_end: Box<dyn FarEnd>,
    faults: Faults,
    clock: Clock,
}

impl Sim {
    fn run(&mut self, signals: &Signals, disconnect_after: Option<Duration>) -> Result<Status, Failure> {
        let mut room = [0; 256];
        let mut is_open = false;
        let mut turned = Duration::ZERO;
        let mut disconnect_at = None;
        while !signals.came() {
            let was_open = is_open;
            let received = self.clock.receive(TICK, |time| match self.far_end.read(&mut room, time)? {
                Input::Bytes(count) => {
                    is_open = true;
                    Ok((count > 0).then_some(count))
                }
                Input::Nobody => {
                    is_open = false;
                    Ok(None)
                }
            })?;
            let now = self.clock.now();
            if is_open && !was_open {
                self.machine.connected(now);
            }
            if let Some(count) = received {
                disconnect_at = disconnect_at.or(disconnect_after.map(|after| now + after));
                self.receive(room.get(..count).unwrap_or_default(), now)?;
            }
            if disconnect_at.is_some_and(|at| at <= now) {
                break;
            }
            if now.saturating_sub(turned) >= TICK {
                turned = now;
                let mut out = Vec::new();
                self.machine.turn(now, &mut out);
                self.send(out, now)?;
                if let Some(watcher) = &mut self.watcher {
                    watcher.idle(now)?;
                }
            }
        }
        Ok(Status::Finished)
    }

    fn receive(&mut self, bytes: &[u8], now: Duration) -> Result<(), Failure> {
        let mut bytes = bytes.to_vec();
        self.faults.spoil(&mut bytes);
        self.show(Side::Host, &bytes, now)?;
        let mut out = Vec::new();
        self.machine.receive(&bytes, now, &mut out);
        self.send(out, now)
    }

    fn send(&mut self, mut bytes: Vec<u8>, now: Duration) -> Result<(), Failure> {
        if bytes.is_empty() {
            return Ok(());
        }
        self.show(Side::Controller, &bytes, now)?;
        self.faults.spoil(&mut bytes);
        self.far_end.write(&bytes)
    }

    fn show(&mut self, from: Side, bytes: &[u8], now: Duration) -> Result<(), Failure> {
        self.watcher.as_mut().map_or(Ok(()), |watcher| watcher.watch(from, bytes, now))
    }
}

/// Shows what passes: what the machine hears, and what it says.
struct Watcher {
    screen: Screen,
    decoder: Box<dyn Decoder>,
    heard: Duration,
}

impl Watcher {
    fn watch(&mut self, from: Side, bytes: &[u8], now: Duration) -> Result<(), Failure> {
        let mut pieces = self.decoder.feed(Some(from), bytes);
        match from {
            Side::Host => self.heard = now,
            // It says nothing by halves.
            Side::Controller => pieces.extend(self.decoder.end(Some(from))),
        }
        self.show(&pieces, now)
    }

    /// What the host said by halves may have ended.
    fn idle(&mut self, now: Duration) -> Result<(), Failure> {
        let pieces = self.decoder.idle(Some(Side::Host), now.saturating_sub(self.heard), GAP_DIRECT);
        self.show(&pieces, self.heard)
    }

    fn show(&mut self, pieces: &[Piece], time: Duration) -> Result<(), Failure> {
        for piece in pieces {
            let arrow = piece.from.map_or(' ', Side::arrow);
            self.screen.line(&format!("{:10.3} {arrow} {}", time.as_secs_f64(), piece.text))?;
        }
        Ok(())
    }
}
