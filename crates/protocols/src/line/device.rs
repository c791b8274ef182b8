//! The device's end of the link: what to do about a line, and what to answer.
//!
//! A [`DeviceLink`] judges lines and writes the answers; it calls nothing. Firmware goes through a line in steps:
//! [`accept`](DeviceLink::accept) says whether it is intact, [`LinkLine::Ack`] is what comes first,
//! [`repeated`](DeviceLink::repeated) has the answer that is to be sent again when the command was executed before. If
//! it was not, the firmware executes the command, writes the answer into the room that [`begin`](DeviceLink::begin)
//! made and has it finished by [`finish`](DeviceLink::finish). In between nothing is borrowed.
//!
//! What the page "Ozeki Line Protocol" leaves open is decided so:
//!
//! - `t` counts the messages of both ends: one that is sent has the next, one that is received moves the counter
//!   forward, never back. Acks have their command's t, welcomes none.
//! - An `onerror` in place of an answer has its command's t and id, which say what it answers. Any other is an event
//!   like others.
//! - A command may have a checksum when none is in force; a wrong one is never executed.
//! - A host that was restarted does not know that checksums are in force. Its `linksetup` without one is accepted when
//!   it comes twice in the same words: a damaged line does not.

mod answers;
mod fault;
mod link_lines;
mod setup;
mod welcome;

use zerocopy::FromBytes;

use super::encoder::{EncodeError, Encoder};
use super::message::{Checksum, Message};
use crate::session::{count, span};
use answers::Answers;
pub use fault::Fault;
use link_lines::write_fault;
pub use link_lines::{LINK_LINE_MAX, LinkLine};
pub use setup::Setup;
pub use welcome::{Welcome, is_id};

/// Bytes of the longest id that a device behind a link may have.
pub const ID_MAX: usize = 10;
/// Bytes of the longest command that a device receives, without its end: more than a PC sends by the page's rule, which
/// its own full `linksetup` breaks.
pub const LINE_MAX: usize = 79;
/// For how many milliseconds after a command its repeats are expected, by default.
pub const REPEAT_MS: u32 = 5000;

/// What an intact command says about itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// Its t. A command without is executed as often as it comes.
    pub t: Option<u8>,
    /// Its checksum, whether it stands in it or not.
    pub sum: u16,
    /// Where the answer is, when it was executed before.
    place: Option<usize>,
}

/// How the link does. The counters wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromBytes)]
pub struct Health {
    /// Commands that were received intact, repeats among them.
    pub commands: u32,
    /// Commands that came again and were only answered again.
    pub repeats: u32,
    /// Lines whose checksum was wrong or missing.
    pub checksums: u32,
    /// Lines that could not be read.
    pub malformed: u32,
    /// Lines that were too long.
    pub overflows: u32,
    /// Commands that were refused: by their function, or because nobody knows their id or name.
    pub refused: u32,
}

/// The state of a link whose window is at most `WINDOW`, and whose answers have at most `REPLY` bytes. All zero is one
/// that has just been connected.
#[derive(Clone, Debug, FromBytes)]
// In this order: on AVR what lies within 64 bytes takes shorter instructions.
#[repr(C)]
pub struct DeviceLink<const WINDOW: usize, const REPLY: usize> {
    /// The t of the next message.
    next: u8,
    setup: Setup,
    /// Bits 8 to 15 of the time that the answers know.
    coarse: u8,
    /// The checksum of the linksetup that was refused last for lack of one; 0, which no line has, when another came
    /// after it.
    refused_setup: u16,
    /// For how many milliseconds repeats are expected; 0 stands for 5000.
    repeat_ms: u32,
    health: Health,
    answers: Answers<WINDOW, REPLY>,
}

impl<const WINDOW: usize, const REPLY: usize> DeviceLink<WINDOW, REPLY> {
    /// A link that has just been connected.
    #[must_use]
    pub const fn new() -> Self {
        let health = Health { commands: 0, repeats: 0, checksums: 0, malformed: 0, overflows: 0, refused: 0 };
        let setup = Setup::new(false, false, 0);
        Self { answers: Answers::new(), health, repeat_ms: 0, refused_setup: 0, setup, next: 0, coarse: 0 }
    }

    /// Repeats are expected for so many milliseconds, 0 standing for [`REPEAT_MS`]. For a link that has just been
    /// connected.
    pub const fn expect_repeats_for(&mut self, repeat_ms: u32) {
        self.repeat_ms = repeat_ms;
    }

    /// The settings in force.
    #[must_use]
    pub const fn setup(&self) -> Setup {
        self.setup
    }

    /// How the link does.
    #[must_use]
    pub const fn health(&self) -> &Health {
        &self.health
    }

    /// It is `now`, in milliseconds: to be called before anything else that happens then.
    #[cfg_attr(target_pointer_width = "16", inline(never))]
    pub fn tick(&mut self, now: u32) {
        // Answers are forgotten within a quarter of a second: that costs the less for each byte.
        let [_, coarse, ..] = now.to_le_bytes();
        if self.answers.is_fresh() || coarse != self.coarse {
            self.coarse = coarse;
            self.answers.tick(now, span(self.repeat_ms, REPEAT_MS));
        }
    }

    /// Whether a line is a command that was received intact, and executed before.
    ///
    /// # Errors
    ///
    /// If it is not intact, what is wrong.
    pub fn accept(&mut self, message: &Message, now: u32) -> Result<Request, Fault> {
        let sum = message.sum();
        match message.checksum() {
            Checksum::Wrong => return Err(Fault::Checksum),
            Checksum::None if self.setup.checks() => {
                let again = self.refused_setup == sum;
                self.refused_setup = if is_setup(message) { sum } else { 0 };
                if self.refused_setup == 0 || !again {
                    return Err(Fault::Checksum);
                }
            }
            _ => (),
        }
        let t = match message.get(b"t") {
            Some(t) => Some(t.byte().ok_or(Fault::Malformed)?),
            None => None,
        };
        self.refused_setup = 0;
        count(&mut self.health.commands);
        let mut place = None;
        if let Some(t) = t {
            self.answers.tick(now, span(self.repeat_ms, REPEAT_MS));
            place = self.answers.find(t, sum, self.setup.window(), now);
            let steps = t.wrapping_add(1).wrapping_sub(self.next);
            if place.is_some() {
                count(&mut self.health.repeats);
            } else if steps < 128 {
                self.advance(steps);
            }
        }
        Ok(Request { t, sum, place })
    }

    /// Carries out a linksetup, after which nothing received before is taken for repeated.
    pub fn change_setup(&mut self, message: &Message) {
        #[expect(clippy::cast_possible_truncation, reason = "at most 64")]
        self.setup.change(message, WINDOW as u8);
        self.answers.forget();
    }

    /// The answer to a command that was executed before.
    #[must_use]
    pub fn repeated(&self, request: &Request) -> Option<&[u8]> {
        self.answers.get(request.place?)
    }

    /// Room for a line as long as an answer may be, before there are any.
    pub fn room(&mut self) -> &mut [u8; REPLY] {
        self.answers.room()
    }

    /// Makes room for an answer, and begins it: `c=<command>_resp`. Its length so far; 0 when even that does not fit.
    pub fn begin(&mut self, command: &[u8]) -> (&mut [u8; REPLY], usize) {
        let room = self.answers.begin();
        let mut line = Encoder::resume(room, 0);
        line.put_all(b"c=");
        line.put_all(command);
        line.put_all(b"_resp");
        let length = line.length();
        (room, length)
    }

    /// Finishes the answer of which so many bytes are in its room, by id and t, or puts an `onerror` in its place;
    /// keeps it for repeats of the command and returns it, and the fault that it reports.
    pub fn finish(&mut self, request: &Request, id: &[u8], answer: Result<usize, Fault>) -> (&[u8], Option<Fault>) {
        let next = self.next;
        let written = answer.and_then(|length| {
            let mut line = Encoder::resume(self.answers.room(), length);
            line.text(b"id", id).word(b"t", next.into()).finish(false).map_err(|_| Fault::TooLong)
        });
        let length = match written {
            Ok(length) => {
                self.advance(1);
                length
            }
            Err(fault) => {
                self.count(fault);
                write_fault(fault, request.t, id, self.answers.room())
            }
        };
        if let Some(t) = request.t {
            self.answers.keep(t, request.sum, length);
        }
        (self.answers.room().get(..length).unwrap_or_default(), written.err())
    }

    /// Ends an event: adds id, t and the end of the line.
    ///
    /// # Errors
    ///
    /// The first error there was in it; then it does not count.
    pub fn finish_event(&mut self, event: &mut Encoder, id: &[u8]) -> Result<usize, EncodeError> {
        let length = event.text(b"id", id).word(b"t", self.next.into()).finish(false)?;
        self.advance(1);
        Ok(length)
    }

    fn count(&mut self, fault: Fault) {
        count(match fault {
            Fault::Checksum => &mut self.health.checksums,
            Fault::Overflow => &mut self.health.overflows,
            Fault::Malformed => &mut self.health.malformed,
            _ => &mut self.health.refused,
        });
    }

    #[inline(never)]
    fn advance(&mut self, steps: u8) {
        self.answers.age(self.next, steps);
        self.next = self.next.wrapping_add(steps);
    }
}

impl<const WINDOW: usize, const REPLY: usize> Default for DeviceLink<WINDOW, REPLY> {
    fn default() -> Self {
        Self::new()
    }
}

/// Whether a command is the one that the link itself executes.
#[must_use]
pub fn is_setup(message: &Message) -> bool {
    message.command().is(b"linksetup")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::String;

    type Link = DeviceLink<4, 96>;

    const ID: &[u8] = b"9o5qzg";

    fn text(bytes: &[u8]) -> String {
        String::from_utf8(bytes.to_vec()).unwrap()
    }

    /// Takes a command through its steps; "state=1" is what it answers. A command of any name is executed.
    fn answers(device: &mut Link, line: &[u8], now: u32) -> String {
        let mut room = [0; LINK_LINE_MAX];
        let mut sent = String::new();
        device.tick(now);
        let message = Message::parse(line).map_err(|_| Fault::Malformed);
        let request = match message.and_then(|message| device.accept(&message, now)) {
            Ok(request) => request,
            Err(fault) => {
                let length = device.write(LinkLine::Fault(fault, None), ID, &mut room);
                return text(&room[..length]);
            }
        };
        let message = message.unwrap();
        if is_setup(&message) {
            device.change_setup(&message);
        }
        let length = device.write(LinkLine::Ack(&request), ID, &mut room);
        sent += &text(&room[..length]);
        if is_setup(&message) {
            let length = device.write(LinkLine::SetupAnswer(&message), ID, &mut room);
            return sent + &text(&room[..length]);
        }
        if let Some(answer) = device.repeated(&request) {
            return sent + "again " + &text(answer);
        }
        let (room, begun) = device.begin(message.command().raw());
        room[begun..begun + 8].copy_from_slice(b"&state=1");
        sent + &text(device.finish(&request, ID, Ok(begun + 8)).0)
    }

    #[test]
    fn commands_are_answered_and_repeats_too() {
        let mut device = Link::new();
        let line = b"c=setswitch&state=1&t=11&id=9o5qzg\n";
        assert_eq!(answers(&mut device, line, 0), "c=setswitch_resp&state=1&id=9o5qzg&t=12\n");
        assert_eq!(answers(&mut device, line, 10), "again c=setswitch_resp&state=1&id=9o5qzg&t=12\n");
        assert_eq!(
            answers(&mut device, b"c=setswitch&state=1&id=9o5qzg\n", 20),
            "c=setswitch_resp&state=1&id=9o5qzg&t=13\n"
        );
        // That was the last command, and one is remembered.
        assert_eq!(answers(&mut device, line, 30), "c=setswitch_resp&state=1&id=9o5qzg&t=14\n");
        assert_eq!(device.health().repeats, 1);
        assert_eq!(device.health().commands, 4);
    }

    #[test]
    fn the_counter_never_goes_back() {
        let mut device = Link::new();
        for (t, answer) in [(0, 1), (1, 2), (0, 3), (100, 101), (50, 102), (228, 229), (101, 230), (0, 1), (255, 2)] {
            let line = std::format!("c=x&t={t}\n");
            assert!(answers(&mut device, line.as_bytes(), t * 10_000).ends_with(&std::format!("t={answer}\n")), "{t}");
        }
    }

    #[test]
    fn a_setup_without_checksum_is_accepted_the_second_time() {
        let mut device = Link::new();
        device.write(LinkLine::Setup(Setup::new(true, true, 1)), ID, &mut [0; LINK_LINE_MAX]);
        let asked = b"c=linksetup&ack=off&checksum=none&t=0&id=9o5qzg\n";
        let refused = "c=onerror&code=checksum&t=";
        assert!(answers(&mut device, asked, 0).starts_with(refused));
        assert!(answers(&mut device, b"c=setswitch&t=0\n", 0).starts_with(refused));
        assert!(answers(&mut device, asked, 0).starts_with(refused));
        assert!(answers(&mut device, b"c=linksetup&ack=off&checksum=none&t=1&id=9o5qzg\n", 0).starts_with(refused));
        assert!(answers(&mut device, asked, 0).starts_with(refused));
        assert_eq!(answers(&mut device, asked, 0), "c=linksetup_resp&ack=off&checksum=none&id=9o5qzg&t=6\n");
        assert_eq!(device.setup(), Setup::new(false, false, 1));
    }

    #[test]
    fn answers_without_room_are_errors() {
        let mut device = Link::new();
        let request = Request { t: Some(200), sum: 1, place: None };
        for fill in 96 - 30..=96 {
            let (room, begun) = device.begin(b"x");
            room[begun..fill].fill(b'y');
            let fits = fill + "&id=9o5qzg&t=0\n".len() <= 96;
            let answer = text(device.finish(&request, ID, Ok(fill)).0);
            assert_eq!(answer.starts_with("c=x_respy"), fits, "{fill}");
            assert_eq!(answer == "c=onerror&code=toolong&t=200&id=9o5qzg\n", !fits, "{fill}");
            device.next = 0;
        }
    }
}
