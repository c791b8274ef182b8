//! A controller with a robot that has three arms.

mod robot;

use std::time::Duration;

use deltarobot_protocols::deltarobot::controller::{Controller as Session, Decision, Request};
use deltarobot_protocols::deltarobot::{FRAME_OVERHEAD, Layout, Message, PAYLOAD_MAX, encode, receiver_room};

use super::random::Random;
use super::{Machine, above_zero};
use crate::port::GAP_DIRECT;
use robot::Robot;

/// Of the session's receiver, which takes frames as long as shipped firmware does.
const ROOM: usize = receiver_room(32);

/// Options of the controller.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Options of --protocol deltarobot")]
pub struct ControllerOptions {
    /// What to answer like: `firmware`, the default, sends status reports of 16 bytes with the reserved bits set;
    /// `spec` sends 13 bytes, and HOMING_REPLY, MOVE_REPLY and GENERAL_ERROR besides. With `spec` a move beyond an end
    /// stop is an error, from which nothing leads; with `firmware` the robot stops there and can be homed
    #[arg(long, value_enum)]
    layout: Option<Kind>,
    /// Displacement of the fastest arm in a second; 50 by default
    #[arg(long, value_name = "UNITS", value_parser = above_zero)]
    pub speed: Option<f64>,
    /// Sends neither ACK nor NACK
    #[arg(long)]
    no_ack: bool,
}

/// What the controller answers like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Kind {
    Spec,
    Firmware,
}

impl ControllerOptions {
    /// The first of them that was given.
    pub(super) fn given(&self) -> Option<&'static str> {
        let given = [("--layout", self.layout.is_some()), ("--speed", self.speed.is_some()), ("--no-ack", self.no_ack)];
        given.into_iter().find_map(|(option, is_given)| is_given.then_some(option))
    }
}

/// Such a controller.
pub struct Controller {
    is_firmware: bool,
    no_ack: bool,
    session: Session<ROOM>,
    robot: Robot,
    /// What is in the padding of reports.
    rubbish: Random,
    /// When anything came last.
    heard: Duration,
    turned: Duration,
}

impl Controller {
    /// One that was just switched on.
    pub fn new(options: &ControllerOptions, rubbish: Random) -> Self {
        let is_firmware = options.layout != Some(Kind::Spec);
        Self {
            is_firmware,
            no_ack: options.no_ack,
            session: Session::default(),
            robot: Robot::new(options.speed.unwrap_or(50.0), !is_firmware),
            rubbish,
            heard: Duration::ZERO,
            turned: Duration::ZERO,
        }
    }

    /// Answers all requests.
    fn serve(&mut self, idle: bool, out: &mut Vec<u8>) {
        while let Some(request) = self.session.request(idle) {
            self.answer(&request, out);
        }
    }

    fn answer(&mut self, request: &Request, out: &mut Vec<u8>) {
        let now = self.robot.report(self.is_firmware);
        let decision = self.session.decide(request, &now);
        let accepted = match decision {
            Decision::Home => self.robot.home(),
            Decision::Move(target) => self.robot.move_to(target),
            Decision::Cancel => self.robot.cancel(),
            Decision::Accept => true,
            Decision::Report | Decision::Refuse | Decision::RefuseOnly => false,
        };
        if accepted {
            self.session.started(&decision);
        }
        if decision != Decision::Report && !self.no_ack {
            self.say(&if accepted { Message::Ack(request.opcode) } else { Message::Nack(request.opcode) }, out);
        }
        if decision != Decision::RefuseOnly {
            self.report(out);
            let now = self.robot.report(self.is_firmware);
            self.session.reported(&now);
        }
    }

    fn report(&mut self, out: &mut Vec<u8>) {
        let report = self.robot.report(self.is_firmware);
        self.say(&Message::StatusReport(report), out);
    }

    fn say(&mut self, message: &Message, out: &mut Vec<u8>) {
        let layout = if self.is_firmware { Layout::Firmware } else { Layout::Spec };
        let mut payload = [0; PAYLOAD_MAX];
        let length = message.write(layout, &mut payload);
        if let (Message::StatusReport(_), true) = (message, self.is_firmware) {
            // Shipped firmware: the reserved bits are 1, the padding is whatever was there.
            let [.., stat, first, second, third] = &mut payload;
            *stat |= 0xE0;
            [*first, *second, *third, ..] = self.rubbish.next().to_le_bytes();
        }
        let mut frame = [0; PAYLOAD_MAX + FRAME_OVERHEAD];
        let length = encode(message.opcode(), payload.get(..length).unwrap_or_default(), &mut frame).unwrap_or(0);
        out.extend_from_slice(frame.get(..length).unwrap_or_default());
    }
}

impl Machine for Controller {
    fn receive(&mut self, bytes: &[u8], now: Duration, out: &mut Vec<u8>) {
        self.heard = now;
        let mut rest = bytes;
        while !rest.is_empty() {
            let taken = self.session.receive(rest);
            rest = rest.get(taken..).unwrap_or_default();
            self.serve(false, out);
        }
    }

    fn turn(&mut self, now: Duration, out: &mut Vec<u8>) {
        if now.saturating_sub(self.heard) >= GAP_DIRECT {
            self.serve(true, out);
        }
        let stepped = self.robot.turn(now.saturating_sub(self.turned).as_secs_f64());
        self.turned = now;
        let report = self.robot.report(self.is_firmware);
        if let Some(end) = self.session.ended(&report) {
            let end = end.filter(|_| !self.is_firmware).and_then(|end| Message::read(end, &[], Layout::Auto));
            if let Some(end) = end {
                self.say(&end, out);
            }
            self.report(out);
        } else if stepped {
            self.report(out);
        }
    }
}
