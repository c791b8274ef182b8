//! The lines that the link itself sends: acks, `linksetup`, `linksetup_resp` and `onerror`.

use zerocopy::FromBytes;

use super::{DeviceLink, LINKSETUP, Request, Setup, is_id};
use crate::line::encoder::Encoder;

/// Room for any of them.
pub const LINK_LINE_MAX: usize = 80;

/// One of these lines.
#[derive(Clone, Copy, Debug)]
pub enum LinkLine {
    /// The ack of the command, if commands are acked.
    Ack,
    /// The event that reports the setup in force.
    Setup,
    /// The answer to the command, a linksetup.
    SetupAnswer,
    /// An `onerror` as an event.
    Event(Fault),
    /// An `onerror` in place of the command's answer: final.
    Answer(Fault),
}

/// Why a line is not answered as wished: an `onerror`'s code. Repeating a command helps against the first three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The line's checksum is wrong, or there is none and should be.
    Checksum,
    /// The line is longer than a command may be.
    Overflow,
    /// The line has no `c` in front, a damaged escape, or a t that is none.
    Malformed,
    /// No device of that id is here.
    UnknownId,
    /// The device has no command of that name.
    UnknownCommand,
    /// The device refused to execute the command.
    Refused,
    /// The command was executed, but the answer is too long to be sent.
    TooLong,
}

impl Fault {
    /// The code in words of the protocol.
    pub const fn code(self) -> &'static [u8] {
        match self {
            Self::Checksum => b"checksum",
            Self::Overflow => b"overflow",
            Self::Malformed => b"malformed",
            Self::UnknownId => b"unknownid",
            Self::UnknownCommand => b"unknowncommand",
            Self::Refused => b"refused",
            Self::TooLong => b"toolong",
        }
    }
}

impl<const WINDOW: usize, const REPLY: usize> DeviceLink<WINDOW, REPLY> {
    /// Writes such a line of the device of this id, if one can have it. Its length, 0 when there is none to be sent.
    pub fn write(&mut self, line: LinkLine, id: &[u8], room: &mut [u8]) -> usize {
        let lines = &self.lines;
        let (length, steps) = match line {
            LinkLine::Ack if !lines.setup.acks() => (0, 0),
            LinkLine::Ack => (lines.write_ack(id, room), 0),
            LinkLine::Setup | LinkLine::SetupAnswer => {
                (lines.write_setup(matches!(line, LinkLine::SetupAnswer), id, room), 1)
            }
            LinkLine::Event(fault) | LinkLine::Answer(fault) => {
                let answers = matches!(line, LinkLine::Answer(_));
                let length = lines.write_fault(fault, answers, id, room);
                self.count(fault);
                (length, u8::from(!answers))
            }
        };
        self.advance(steps);
        length
    }
}

/// What lines are written from.
#[derive(Clone, Debug, FromBytes)]
#[repr(C)]
pub(super) struct Lines {
    /// The t of the next message.
    pub(super) next: u8,
    pub(super) setup: Setup,
    /// Not 0: lines about the setup have the window even if that is 1.
    pub(super) has_window: u8,
    /// The command that was accepted last.
    pub(super) request: Request,
}

impl Lines {
    pub(super) const fn new() -> Self {
        let request = Request { t: 0, has_t: 0, place: 0, sum: 0 };
        let setup = Setup::new(false, false, 0);
        Self { next: 0, setup, has_window: 0, request }
    }

    /// Ends a line by id and t.
    pub(super) fn end_with_t(&self, line: &mut Encoder, id: &[u8]) -> usize {
        add_id(line, id);
        line.number(b"&t=", self.next.into());
        line.finish(false).unwrap_or(0)
    }

    /// Ends a line by t, the command's if it answers one that has one, and id.
    fn end_with_id(&self, line: &mut Encoder, answers: bool, id: &[u8]) -> usize {
        let t = if answers { self.request.t } else { self.next };
        if !answers || self.request.has_t != 0 {
            line.number(b"&t=", t.into());
        }
        add_id(line, id);
        line.finish(false).unwrap_or(0)
    }

    /// Writes an ack.
    fn write_ack(&self, id: &[u8], room: &mut [u8]) -> usize {
        let mut line = Encoder::resume(room, 0);
        line.put_all(b"c=ack&checksum=");
        if self.setup.checks() {
            line.put_hex(self.request.sum);
        } else {
            line.put_all(b"null");
        }
        self.end_with_id(&mut line, true, id)
    }

    /// Writes an `onerror`, which answers the command or is an event.
    pub(super) fn write_fault(&self, fault: Fault, answers: bool, id: &[u8], room: &mut [u8]) -> usize {
        let mut line = Encoder::resume(room, 0);
        line.put_all(b"c=onerror&code=");
        line.put_all(fault.code());
        self.end_with_id(&mut line, answers, id)
    }

    /// Writes which setup is in force.
    fn write_setup(&self, answers: bool, id: &[u8], room: &mut [u8]) -> usize {
        let mut line = Encoder::resume(room, 0);
        line.put_all(b"c=");
        line.put_all(LINKSETUP);
        if answers {
            line.put_all(b"_resp");
        }
        if self.has_window != 0 || self.setup.window() != 1 {
            line.word(b"windowsize", self.setup.window().into());
        }
        line.text(b"ack", if self.setup.acks() { b"on" } else { b"off" });
        line.text(b"checksum", if self.setup.checks() { b"fletcher16" } else { b"none" });
        if answers { self.end_with_t(&mut line, id) } else { self.end_with_id(&mut line, false, id) }
    }
}

fn add_id(line: &mut Encoder, id: &[u8]) {
    if is_id(id) {
        line.put_all(b"&id=");
        line.put_all(id);
    }
}

#[cfg(test)]
mod tests {
    use super::Fault::{Checksum, Malformed, Overflow, Refused, TooLong, UnknownCommand, UnknownId};
    use super::*;
    use crate::line::device::ID_MAX;

    #[test]
    fn every_line_of_the_link_fits_its_room() {
        let id = [b'x'; ID_MAX];
        let mut device = DeviceLink::<1, 64>::new();
        device.set_up(Setup::new(true, true, 1));
        device.lines.next = 255;
        let mut room = [0; LINK_LINE_MAX];
        device.lines.request = Request { t: 255, has_t: 1, place: 255, sum: 0xFFFF };
        assert_ne!(device.write(LinkLine::Ack, &id, &mut room), 0);
        device.set_up(Setup::new(false, true, u8::MAX));
        assert_ne!(device.write(LinkLine::Setup, &id, &mut room), 0);
        device.lines.next = 255;
        assert_ne!(device.write(LinkLine::SetupAnswer, &id, &mut room), 0);
        for fault in [Checksum, Overflow, Malformed, UnknownId, UnknownCommand, Refused, TooLong] {
            assert_ne!(device.write(LinkLine::Answer(fault), &id, &mut room), 0);
            // In place of an answer, whatever room that may have.
            assert_ne!(device.write(LinkLine::Answer(fault), &id, &mut [0; 64]), 0);
        }
    }
}
