//! A microcontroller with a heater, a switch and a button behind the link of the line protocol.

mod board;

use std::time::Duration;

use deltarobot_protocols::line::device::{self, Fault, LINE_MAX, LINK_LINE_MAX, LinkLine, Setup, is_setup};
use deltarobot_protocols::line::{Encoder, Message, Received, Receiver};

use super::{Machine, above_zero, milliseconds};
use board::{Board, MANAGER};

/// Most commands that may be unanswered.
const WINDOW: u8 = 8;
/// Bytes of the longest answer.
const REPLY_MAX: usize = 128;

type DeviceLink = device::DeviceLink<{ WINDOW as usize }, REPLY_MAX>;

/// From the opening of the device, which resets such a microcontroller, to the first welcome. A real one takes longer.
const BOOT: Duration = Duration::from_millis(100);
/// Bytes that wait meanwhile.
const WAITING_MAX: usize = 4096;

/// Options of the devices.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Options of --protocol line")]
pub(super) struct DevicesOptions {
    /// Has a linksetup event follow the welcomes, which puts acks in force
    #[arg(long)]
    ack: bool,
    /// Has a linksetup event follow the welcomes, which puts checksums in force
    #[arg(long)]
    checksum: bool,
    /// Has a linksetup event follow the welcomes, which lets so many commands be unanswered at a time
    #[arg(long, value_name = "COMMANDS")]
    window: Option<u16>,
    /// Presses the button that often; every 10 seconds by default
    #[arg(long, value_name = "SECONDS", value_parser = above_zero)]
    press: Option<f64>,
}

impl DevicesOptions {
    /// The first of them that was given.
    pub(super) fn given(&self) -> Option<&'static str> {
        let given = [
            ("--ack", self.ack),
            ("--checksum", self.checksum),
            ("--window", self.window.is_some()),
            ("--press", self.press.is_some()),
        ];
        given.into_iter().find_map(|(option, is_given)| is_given.then_some(option))
    }

    /// The setup that the devices begin with, if not with the default.
    fn setup(&self) -> Option<Setup> {
        let is_given = self.ack || self.checksum || self.window.is_some();
        let window = self.window.map_or(1, |window| u8::try_from(window).unwrap_or(WINDOW).min(WINDOW));
        is_given.then(|| Setup::new(self.ack, self.checksum, window))
    }
}

pub(super) struct Devices {
    link: DeviceLink,
    receiver: Receiver<{ LINE_MAX + 1 }>,
    board: Board,
    setup: Option<Setup>,
    /// When it will have booted.
    boots_until: Option<Duration>,
    /// What has come until then.
    waiting: Vec<u8>,
}

impl Devices {
    pub(super) fn new(options: &DevicesOptions) -> Self {
        Self {
            link: DeviceLink::default(),
            receiver: Receiver::new(),
            board: Board::new(Duration::from_secs_f64(options.press.unwrap_or(10.0))),
            setup: options.setup(),
            boots_until: None,
            waiting: Vec::new(),
        }
    }

    fn greet(&mut self, out: &mut Vec<u8>) {
        let mut room = [0; REPLY_MAX];
        for (place, device) in (1..).zip(board::DEVICES) {
            let mut line = Encoder::begin(&mut room, b"welcome");
            device.welcome(place, &mut line);
            let length = line.finish(false).unwrap_or_default();
            add(out, &room, length);
        }
        if let Some(setup) = self.setup {
            self.link.set_up(setup);
            let length = self.link.write(LinkLine::Setup, MANAGER, &mut room);
            add(out, &room, length);
        }
    }

    /// Deals with the line that was received, if there is one.
    fn serve(&mut self, now: Duration, out: &mut Vec<u8>) {
        let message = match self.receiver.received() {
            Received::Nothing => return,
            Received::Line(line) => Message::parse(line).map_err(|_| Fault::Malformed),
            Received::TooLong => Err(Fault::Overflow),
        };
        let accepted = message.and_then(|message| self.link.accept(&message, milliseconds(now)).map(|()| message));
        match accepted {
            Ok(message) => answer(&mut self.link, &mut self.board, &message, out),
            Err(fault) => {
                let mut room = [0; LINK_LINE_MAX];
                let length = self.link.write(LinkLine::Event(fault), MANAGER, &mut room);
                add(out, &room, length);
            }
        }
        self.receiver.release();
    }
}

/// Answers a command that was received intact: first the ack, then the response or an error in its place.
fn answer(link: &mut DeviceLink, board: &mut Board, message: &Message, out: &mut Vec<u8>) {
    let mut room = [0; REPLY_MAX];
    let asked = message.text(b"id");
    let known = board::DEVICES.iter().map(|device| device.id).find(|id| asked.is(id));
    let id = known.unwrap_or(asked.raw());
    let is_setup = known.is_some() && is_setup(message);
    if is_setup {
        link.change_setup(message);
    }
    let length = link.write(LinkLine::Ack, id, &mut room);
    add(out, &room, length);

    let answer = match known {
        None => LinkLine::Answer(Fault::UnknownId),
        Some(_) if is_setup => LinkLine::SetupAnswer,
        Some(id) => {
            if let Some(again) = link.repeated() {
                return out.extend_from_slice(again);
            }
            if let Some(command) = board::command(id, message) {
                let mut said = Encoder::begin(&mut room, b"x");
                let begun = said.length();
                let result = board.execute(command, message, &mut said);
                let length = said.length();
                return finish(link, command, id, result.map(|()| room.get(begun..length).unwrap_or_default()), out);
            }
            LinkLine::Answer(Fault::UnknownCommand)
        }
    };
    let length = link.write(answer, id, &mut room);
    add(out, &room, length);
}

/// Finishes the answer to a command, which has these parameters.
fn finish(link: &mut DeviceLink, command: &[u8], id: &[u8], params: Result<&[u8], Fault>, out: &mut Vec<u8>) {
    let begun = link.begin(command);
    let written = params.and_then(|params| {
        let end = begun + params.len();
        link.room().get_mut(begun..end).ok_or(Fault::TooLong)?.copy_from_slice(params);
        Ok(end)
    });
    let (length, _) = link.finish(written.unwrap_or_default(), written.err(), id);
    add(out, link.room(), length);
}

fn add(out: &mut Vec<u8>, room: &[u8], length: usize) {
    out.extend_from_slice(room.get(..length).unwrap_or_default());
}

impl Machine for Devices {
    fn connected(&mut self, now: Duration) {
        self.link = DeviceLink::default();
        self.receiver.clear();
        self.board.reset(now);
        self.boots_until = Some(now + BOOT);
        self.waiting.clear();
    }

    fn receive(&mut self, bytes: &[u8], now: Duration, out: &mut Vec<u8>) {
        if self.boots_until.is_some() {
            self.waiting.extend(bytes.iter().take(WAITING_MAX.saturating_sub(self.waiting.len())));
            return;
        }
        self.link.tick(milliseconds(now));
        let mut rest = bytes;
        while !rest.is_empty() {
            let taken = self.receiver.take(rest);
            rest = rest.get(taken..).unwrap_or_default();
            self.serve(now, out);
        }
    }

    fn turn(&mut self, now: Duration, out: &mut Vec<u8>) {
        if self.boots_until.is_some_and(|until| now >= until) {
            self.boots_until = None;
            self.greet(out);
            let waiting = std::mem::take(&mut self.waiting);
            self.receive(&waiting, now, out);
        }
        let events = self.board.turn(now);
        if self.boots_until.is_some() {
            return;
        }
        self.link.tick(milliseconds(now));
        for event in events {
            let mut room = [0; REPLY_MAX];
            let mut line = Encoder::begin(&mut room, event.name);
            event.write(&mut line);
            let length = self.link.finish_event(&mut line, event.id);
            add(out, &room, length);
        }
    }
}
