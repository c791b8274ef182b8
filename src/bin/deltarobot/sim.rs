//! `deltarobot sim`: a controller on a pseudo-terminal, with a simulated robot and faults to order.

mod faults;
mod robot;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use deltarobot::deltarobot::{Dispatcher, Judgement, Layout, Message, Order, PAYLOAD_MAX};

use crate::decoder::{Decoder, Piece, QUIET_MS};
use crate::monitor::piece_text;
use crate::pty::{Input, Pty};
use crate::recording::Side;
use crate::screen::Screen;
use crate::signals::Signals;
use crate::status::{Failure, Status};
use crate::wire::frame;
use faults::Faults;
use robot::Robot;

/// How often the robot is moved on, in milliseconds.
const TICK_MS: u32 = 5;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Prints the path of its device, and runs until Ctrl-C. A move beyond an end stop, which is where a \
    displacement is 0, is an error: from then on, as in shipped firmware, everything but a status request is refused."
)]
pub(crate) struct Arguments {
    /// A symbolic link to make to the device
    #[arg(long, value_name = "PATH")]
    link: Option<PathBuf>,
    /// What to answer like: `firmware` sends status reports of 16 bytes with the reserved bits set, `spec` of 13 bytes, and
    /// HOMING_REPLY, MOVE_REPLY and GENERAL_ERROR besides
    #[arg(long, value_enum, default_value_t = Kind::Firmware)]
    layout: Kind,
    /// Displacement of the fastest arm in a second
    #[arg(long, value_name = "UNITS", default_value_t = 50.0, value_parser = speed)]
    speed: f64,
    /// Probability of each byte, in both directions, to be lost
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = probability)]
    lose: f64,
    /// Probability of each byte, in both directions, to have one bit flipped
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = probability)]
    flip: f64,
    /// Sends neither ACK nor NACK
    #[arg(long)]
    no_ack: bool,
    /// Takes the device away so many seconds after the first byte was received, and ends
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    disconnect_after: Option<f64>,
    /// Makes the faults the same each time
    #[arg(long, value_name = "NUMBER")]
    seed: Option<u64>,
    /// Prints each frame
    #[arg(short, long)]
    verbose: bool,
}

/// What the controller answers like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Kind {
    Spec,
    Firmware,
}

fn probability(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(probability) if (0.0..=1.0).contains(&probability) => Ok(probability),
        _ => Err("not a probability from 0 to 1".into()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if (0.0..=1e6).contains(&number) => Ok(number),
        _ => Err("not a number from 0 to a million".into()),
    }
}

fn speed(text: &str) -> Result<f64, String> {
    positive(text).and_then(|speed| if speed > 0.0 { Ok(speed) } else { Err("nothing would move".into()) })
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let signals = Signals::catch()?;
    let pty = Pty::new(arguments.link.as_deref())?;
    let mut screen = Screen::new();
    screen.line(&pty.path().display().to_string())?;
    let now = Instant::now();
    Sim {
        kind: arguments.layout,
        no_ack: arguments.no_ack,
        verbose: arguments.verbose.then_some(screen),
        heard_by: Decoder::new(),
        pty,
        faults: Faults::new(arguments.lose, arguments.flip, arguments.seed),
        dispatcher: Dispatcher::new(),
        robot: Robot::new(arguments.speed),
        began: now,
        heard: now,
    }
    .run(&signals, arguments.disconnect_after.map(Duration::from_secs_f64))
}

struct Sim {
    kind: Kind,
    no_ack: bool,
    /// Where frames are shown.
    verbose: Option<Screen>,
    /// What is received, for being shown.
    heard_by: Decoder,
    pty: Pty,
    faults: Faults,
    dispatcher: Dispatcher,
    robot: Robot,
    began: Instant,
    /// When anything came last.
    heard: Instant,
}

impl Sim {
    fn run(&mut self, signals: &Signals, disconnect_after: Option<Duration>) -> Result<Status, Failure> {
        let mut room = [0; 256];
        let mut moved = Instant::now();
        let mut disconnect_at = None;
        while !signals.came() {
            match self.pty.read(&mut room, TICK_MS)? {
                Input::Bytes(0) => (),
                Input::Bytes(count) => {
                    self.heard = Instant::now();
                    disconnect_at = disconnect_at.or(disconnect_after.map(|after| self.heard + after));
                    self.receive(room.get(..count).unwrap_or_default())?;
                }
                // Waiting for somebody, which poll(2) does not do.
                Input::Nobody => std::thread::sleep(Duration::from_millis(TICK_MS.into())),
            }
            if disconnect_at.is_some_and(|at| at <= Instant::now()) {
                break;
            }
            if self.heard.elapsed() >= Duration::from_millis(QUIET_MS.into()) {
                let pieces = self.heard_by.idle();
                self.show(Side::Host, &pieces)?;
                self.serve(true)?;
            }
            let now = Instant::now();
            if now - moved >= Duration::from_millis(TICK_MS.into()) {
                self.turn(now - moved)?;
                moved = now;
            }
        }
        Ok(Status::Finished)
    }

    fn receive(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let mut bytes = bytes.to_vec();
        self.faults.spoil(&mut bytes);
        if self.verbose.is_some() {
            let pieces = self.heard_by.feed(&bytes);
            self.show(Side::Host, &pieces)?;
        }
        // In pieces that fit, or requests would be lost.
        let mut rest = bytes.as_slice();
        while !rest.is_empty() {
            let (now, later) = rest.split_at(rest.len().min(self.dispatcher.ring().room()).max(1));
            let _ = self.dispatcher.ring().append(now);
            rest = later;
            self.serve(false)?;
        }
        Ok(())
    }

    /// Moves the robot on.
    fn turn(&mut self, time: Duration) -> Result<(), Failure> {
        let stepped = self.robot.turn(time.as_secs_f64());
        let now = self.robot.report(self.kind == Kind::Firmware);
        if let Some(end) = self.dispatcher.ended(&now) {
            if let Some(end) = end.filter(|_| self.kind == Kind::Spec) {
                self.send(&end)?;
            }
            self.report()?;
        } else if stepped {
            self.report()?;
        }
        Ok(())
    }

    /// Answers all requests.
    fn serve(&mut self, idle: bool) -> Result<(), Failure> {
        while let Some(order) = self.dispatcher.order(idle) {
            self.answer(&order)?;
        }
        Ok(())
    }

    fn answer(&mut self, order: &Order) -> Result<(), Failure> {
        let now = self.robot.report(self.kind == Kind::Firmware);
        let judgement = self.dispatcher.judge(order, &now);
        let accepted = match judgement {
            Judgement::Home => self.robot.home(),
            Judgement::Move(target) => self.robot.move_to(target),
            Judgement::Cancel => self.robot.cancel(),
            Judgement::Repeated => true,
            Judgement::Report | Judgement::Refuse | Judgement::RefuseOnly => false,
        };
        if accepted {
            self.dispatcher.began(&judgement);
        }
        if judgement != Judgement::Report && !self.no_ack {
            self.send(&if accepted { Message::Ack(order.opcode) } else { Message::Nack(order.opcode) })?;
        }
        if judgement != Judgement::RefuseOnly {
            self.report()?;
            let now = self.robot.report(self.kind == Kind::Firmware);
            self.dispatcher.reports(&now);
        }
        Ok(())
    }

    fn report(&mut self) -> Result<(), Failure> {
        let report = self.robot.report(self.kind == Kind::Firmware);
        self.send(&Message::StatusReport(report))
    }

    fn send(&mut self, message: &Message) -> Result<(), Failure> {
        let layout = if self.kind == Kind::Spec { Layout::Spec } else { Layout::Firmware };
        let mut payload = [0; PAYLOAD_MAX];
        let length = message.write(layout, &mut payload);
        if let (Message::StatusReport(_), Kind::Firmware) = (message, self.kind) {
            // Shipped firmware: the reserved bits are 1, the padding is whatever was there.
            let [.., stat, first, second, third] = &mut payload;
            *stat |= 0xE0;
            [*first, *second, *third] = self.faults.rubbish();
        }
        let payload = payload.get(..length).unwrap_or_default();
        let Some(mut bytes) = frame(message.opcode(), payload) else {
            return Err(Failure::Usage("this build's frames are too short for that".into()));
        };
        let piece = Piece::Frame { opcode: message.opcode(), payload: payload.to_vec(), bytes: bytes.clone() };
        self.show(Side::Controller, &[piece])?;
        self.faults.spoil(&mut bytes);
        self.pty.write(&bytes)
    }

    fn show(&mut self, from: Side, pieces: &[Piece]) -> Result<(), Failure> {
        let time = self.began.elapsed().as_secs_f64();
        for piece in pieces {
            if let Some(screen) = &mut self.verbose {
                screen.line(&format!("{time:10.3} {} {}", from.arrow(), piece_text(piece)))?;
            }
        }
        Ok(())
    }
}
