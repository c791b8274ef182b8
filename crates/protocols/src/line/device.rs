//! The device's end of the link: what to do about a line, and what to answer.
//!
//! A [`DeviceLink`] judges lines and writes the answers; it calls nothing. Firmware goes through a line in steps:
//! [`accept`](DeviceLink::accept) says whether it is intact, [`LinkLine::Ack`] is what comes first,
//! [`repeated`](DeviceLink::repeated) has the answer to send again when the command was executed before. If not, the
//! firmware executes it, writes the answer into the room that [`begin`](DeviceLink::begin) made and has it finished by
//! [`finish`](DeviceLink::finish). In between nothing is borrowed: the link knows the command accepted last.
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
mod link_lines;
mod setup;

use zerocopy::{FromBytes, Immutable, IntoBytes};

use super::encoder::{Encoder, is_plain};
use super::message::{Checksum, Message};
use crate::session::{count, span};
use answers::Answers;
use link_lines::Lines;
pub use link_lines::{Fault, LINK_LINE_MAX, LinkLine};
pub use setup::Setup;

/// Bytes of the longest id that a device behind a link may have.
pub const ID_MAX: usize = 10;
/// Bytes of the longest command that a device receives, without its end: a full `linksetup` is longer than 64.
pub const LINE_MAX: usize = 79;
/// The command that the link itself executes.
const LINKSETUP: &[u8] = b"linksetup";
/// For how many milliseconds after a command its repeats are expected, by default.
pub const REPEAT_MS: u32 = 5000;

/// What an intact command says about itself.
#[derive(Clone, Copy, Debug, Default, FromBytes)]
#[repr(C)]
struct Request {
    /// Its t, if it has one: if not, it is executed as often as it comes.
    t: u8,
    has_t: u8,
    /// Where the answer is, when it was executed before; else no place there is.
    place: u8,
    /// Its checksum, whether it stands in it or not.
    sum: u16,
}

/// How the link does. The counters wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromBytes, IntoBytes, Immutable)]
#[repr(C)]
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
/// that has just been connected, but expects no repeats.
#[derive(Clone, Debug, FromBytes)]
// In this order: on AVR what lies within 64 bytes takes shorter instructions.
#[repr(C)]
pub struct DeviceLink<const WINDOW: usize, const REPLY: usize> {
    lines: Lines,
    /// Sum of the linksetup refused last for lack of a checksum; 0, which no line has, when another came after it.
    refused_setup: u16,
    /// The time that the answers know.
    now: u32,
    /// For how many milliseconds repeats are expected.
    repeat_ms: u32,
    answers: Answers<WINDOW, REPLY>,
    health: Health,
}

impl<const WINDOW: usize, const REPLY: usize> DeviceLink<WINDOW, REPLY> {
    /// A link that has just been connected.
    pub const fn new() -> Self {
        let health = Health { commands: 0, repeats: 0, checksums: 0, malformed: 0, overflows: 0, refused: 0 };
        Self { lines: Lines::new(), refused_setup: 0, now: 0, repeat_ms: REPEAT_MS, health, answers: Answers::new() }
    }

    /// For a new link: for how many milliseconds repeats are expected, 0 standing for [`REPEAT_MS`].
    pub const fn expect_repeats_for(&mut self, repeat_ms: u32) {
        self.repeat_ms = span(repeat_ms, REPEAT_MS);
    }

    /// The settings in force.
    pub const fn setup(&self) -> Setup {
        self.lines.setup
    }

    /// How the link does.
    pub const fn health(&self) -> &Health {
        &self.health
    }

    /// It is `now`, in milliseconds. To be called first, at least when the link [`is_behind`](Self::is_behind).
    pub fn tick(&mut self, now: u32) {
        self.now = now;
        self.answers.settle(now);
        self.advance(0);
    }

    /// Whether a [`tick`](Self::tick) is due: behind an answer, and each quarter of a second.
    #[inline(always)]
    pub fn is_behind(&self, now: u32) -> bool {
        // Forgetting answers that late costs the less for each byte.
        let ([_, coarse, ..], [_, known, ..]) = (now.to_le_bytes(), self.now.to_le_bytes());
        self.answers.fresh != 0 || coarse != known
    }

    /// Whether a line is a command that was received intact; if so, the link goes on with that command. Else what is
    /// wrong.
    pub fn accept(&mut self, message: &Message, now: u32) -> Result<(), Fault> {
        let sum = message.sum;
        match message.checksum {
            Checksum::Wrong => return Err(Fault::Checksum),
            Checksum::None if self.lines.setup.checks() => {
                let again = self.refused_setup == sum;
                self.refused_setup = if is_setup(message) { sum } else { 0 };
                if self.refused_setup == 0 || !again {
                    return Err(Fault::Checksum);
                }
            }
            _ => (),
        }
        let mut request = Request { t: 0, has_t: 0, place: u8::MAX, sum };
        if let Some(t) = message.get(b"t") {
            request.t = t.byte().ok_or(Fault::Malformed)?;
            request.has_t = 1;
        }
        self.refused_setup = 0;
        count(&mut self.health.commands);
        if request.has_t != 0 {
            self.tick(now);
            if let Some(place) = self.answers.find(request.t, sum, now) {
                request.place = place;
                count(&mut self.health.repeats);
            } else {
                let steps = request.t.wrapping_add(1).wrapping_sub(self.lines.next);
                if steps < 128 {
                    self.advance(steps);
                }
            }
        }
        self.lines.request = request;
        Ok(())
    }

    /// Puts a setup in force, after which nothing received before is taken for repeated.
    pub fn set_up(&mut self, setup: Setup) {
        self.lines.setup = setup;
        self.lines.has_window = 1;
        self.answers.forget();
    }

    /// Carries out a linksetup.
    pub fn change_setup(&mut self, message: &Message) {
        #[expect(clippy::cast_possible_truncation, reason = "at most 64")]
        let has_window = self.lines.setup.change(message, WINDOW as u8);
        self.set_up(self.lines.setup);
        self.lines.has_window = has_window.into();
    }

    /// The answer to the command, if it was executed before.
    pub fn repeated(&self) -> Option<&[u8]> {
        self.answers.get(self.lines.request.place)
    }

    /// Room for a line as long as an answer may be, before there are any; then that of the last answer.
    pub fn room(&mut self) -> &mut [u8; REPLY] {
        self.answers.room()
    }

    /// Begins the command's answer, `c=<command>_resp`, in room of its own. Its length; 0 when even that does not fit.
    pub fn begin(&mut self, command: &[u8]) -> usize {
        let mut line = Encoder::resume(self.answers.begin(self.lines.setup.window()), 0);
        line.put_all(b"c=");
        line.put_all(command);
        line.put_all(b"_resp");
        line.length()
    }

    /// Finishes the answer of which so many bytes are in its room, by this id and t, or puts an `onerror` in its place, for
    /// the `fault` there is or because it is too long; keeps it for repeats of the command. Its length, and the fault
    /// that it reports.
    pub fn finish(&mut self, length: usize, mut fault: Option<Fault>, id: &[u8]) -> (usize, Option<Fault>) {
        let request = self.lines.request;
        let room = self.answers.room();
        let mut written = 0;
        if fault.is_none() {
            written = self.lines.end_with_t(&mut Encoder::resume(room, length), id);
            if written == 0 {
                fault = Some(Fault::TooLong);
            }
        }
        if let Some(fault) = fault {
            written = self.lines.write_fault(fault, true, id, room);
            self.count(fault);
        } else {
            self.advance(1);
        }
        self.answers.keep(request.t, if request.has_t == 0 { 0 } else { request.sum }, written);
        (written, fault)
    }

    /// Ends an event by id, t and the line's end. Its length; 0, and it does not count, when there is an error in it.
    pub fn finish_event(&mut self, event: &mut Encoder, id: &[u8]) -> usize {
        let length = self.lines.end_with_t(event, id);
        if length != 0 {
            self.advance(1);
        }
        length
    }

    fn count(&mut self, fault: Fault) {
        count(match fault {
            Fault::Checksum => &mut self.health.checksums,
            Fault::Overflow => &mut self.health.overflows,
            Fault::Malformed => &mut self.health.malformed,
            _ => &mut self.health.refused,
        });
    }

    /// The counter moves on by so many steps, and answers that have become too old are forgotten.
    #[inline(never)]
    fn advance(&mut self, steps: u8) {
        self.answers.forget_old(self.now, self.repeat_ms, self.lines.next, steps);
        self.lines.next = self.lines.next.wrapping_add(steps);
    }
}

impl<const WINDOW: usize, const REPLY: usize> Default for DeviceLink<WINDOW, REPLY> {
    fn default() -> Self {
        Self::new()
    }
}

/// Whether a device behind a link may have that id: one to [`ID_MAX`] of `[0-9A-Za-z._-]`, which need no encoding.
pub fn is_id(id: &[u8]) -> bool {
    !id.is_empty() && id.len() <= ID_MAX && id.iter().all(|byte| is_plain(*byte))
}

/// Whether a command is the one that the link itself executes.
pub fn is_setup(message: &Message) -> bool {
    message.command().is(LINKSETUP)
}

#[cfg(test)]
mod tests {
    use super::*;

    type Link = DeviceLink<4, 96>;

    const ID: &[u8] = b"9o5qzg";

    fn text(bytes: &[u8]) -> String {
        String::from_utf8(bytes.to_vec()).unwrap()
    }

    fn written(device: &mut Link, line: LinkLine) -> String {
        let mut room = [0; LINK_LINE_MAX];
        let length = device.write(line, ID, &mut room);
        text(&room[..length])
    }

    /// Takes a command through its steps; "state=1" is what it answers. A command of any name is executed.
    fn answers(device: &mut Link, line: &[u8], now: u32) -> String {
        device.tick(now);
        let message = Message::parse(line).unwrap();
        if let Err(fault) = device.accept(&message, now) {
            return written(device, LinkLine::Event(fault));
        }
        if is_setup(&message) {
            device.change_setup(&message);
            return written(device, LinkLine::Ack) + &written(device, LinkLine::SetupAnswer);
        }
        let sent = written(device, LinkLine::Ack);
        if let Some(answer) = device.repeated() {
            return sent + "again " + &text(answer);
        }
        let begun = device.begin(message.command().raw());
        device.room()[begun..begun + 8].copy_from_slice(b"&state=1");
        let (length, _) = device.finish(begun + 8, None, ID);
        sent + &text(&device.room()[..length])
    }

    #[test]
    fn commands_are_answered_and_repeats_too() {
        let mut device = Link::new();
        let line = b"c=setswitch&state=1&t=11&id=9o5qzg\n";
        assert_eq!(answers(&mut device, line, 0), "c=setswitch_resp&state=1&id=9o5qzg&t=12\n");
        assert_eq!(answers(&mut device, line, 10), "again c=setswitch_resp&state=1&id=9o5qzg&t=12\n");
        let without_t = b"c=setswitch&state=1&id=9o5qzg\n";
        assert_eq!(answers(&mut device, without_t, 20), "c=setswitch_resp&state=1&id=9o5qzg&t=13\n");
        // That was the last command, and one is remembered.
        assert_eq!(answers(&mut device, line, 30), "c=setswitch_resp&state=1&id=9o5qzg&t=14\n");
        assert_eq!((device.health().repeats, device.health().commands), (1, 4));
    }

    #[test]
    fn the_counter_never_goes_back() {
        let mut device = Link::new();
        for (t, answer) in [(0, 1), (1, 2), (0, 3), (100, 101), (50, 102), (228, 229), (101, 230), (0, 1), (255, 2)] {
            let line = format!("c=x&t={t}\n");
            assert!(answers(&mut device, line.as_bytes(), t * 10_000).ends_with(&format!("t={answer}\n")), "{t}");
        }
    }

    #[test]
    fn a_setup_without_checksum_is_accepted_the_second_time() {
        let mut device = Link::new();
        device.set_up(Setup::new(true, true, 1));
        let asked = b"c=linksetup&ack=off&checksum=none&t=0&id=9o5qzg\n";
        let refused = "c=onerror&code=checksum&t=";
        let (command, other) = (b"c=setswitch&t=0\n", b"c=linksetup&ack=off&checksum=none&t=1&id=9o5qzg\n");
        for line in [&asked[..], command, asked, other, asked] {
            assert!(answers(&mut device, line, 0).starts_with(refused));
        }
        assert_eq!(answers(&mut device, asked, 0), "c=linksetup_resp&ack=off&checksum=none&id=9o5qzg&t=5\n");
        assert_eq!(device.setup(), Setup::new(false, false, 1));
    }

    #[test]
    fn answers_without_room_are_errors() {
        let mut device = Link::new();
        device.lines.request = Request { t: 200, has_t: 1, sum: 1, ..Request::default() };
        for fill in 96 - 30..=96 {
            let begun = device.begin(b"x");
            device.room()[begun..fill].fill(b'y');
            let fits = fill + "&id=9o5qzg&t=0\n".len() <= 96;
            let (length, fault) = device.finish(fill, None, ID);
            let answer = text(&device.room()[..length]);
            assert_eq!(fault, (!fits).then_some(Fault::TooLong));
            assert_eq!(answer.starts_with("c=x_respy"), fits, "{fill}");
            assert_eq!(answer == "c=onerror&code=toolong&t=200&id=9o5qzg\n", !fits, "{fill}");
            device.lines.next = 0;
        }
    }
}
