//! The lines that the link itself sends: acks, `linksetup`, `linksetup_resp` and `onerror`.

use super::{DeviceLink, Fault, Request, Setup};
use crate::line::encoder::Encoder;
use crate::line::message::Message;

/// Room for any of them.
pub const LINK_LINE_MAX: usize = 80;

/// One of these lines.
#[derive(Clone, Copy, Debug)]
pub enum LinkLine<'a> {
    /// The ack of a command, if commands are acked.
    Ack(&'a Request),
    /// The event by which the device puts a setup in force.
    Setup(Setup),
    /// The answer to a linksetup, which may have asked for a window.
    SetupAnswer(&'a Message<'a>),
    /// An `onerror`; final for the command, if there is one.
    Fault(Fault, Option<&'a Request>),
}

impl<const WINDOW: usize, const REPLY: usize> DeviceLink<WINDOW, REPLY> {
    /// Writes such a line and returns its length, 0 when there is none to be sent.
    // The room lies in its caller's frame, and on AVR what lies behind the first 64 bytes of one takes five
    // instructions to reach.
    #[cfg_attr(target_pointer_width = "16", inline(never))]
    pub fn write(&mut self, line: LinkLine<'_>, id: &[u8], room: &mut [u8]) -> usize {
        let next = Some(self.next);
        if let LinkLine::Ack(request) = line {
            if !self.setup.acks() {
                return 0;
            }
            let mut out = Encoder::begin(room, b"ack");
            if self.setup.checks() {
                out.hex(b"checksum", request.sum);
            } else {
                out.text(b"checksum", b"null");
            }
            return end(&mut out, request.t, id);
        }
        if let LinkLine::Fault(fault, request) = line {
            self.count(fault);
            if request.is_none() {
                self.advance(1);
            }
            return write_fault(fault, request.map_or(next, |request| request.t), id, room);
        }
        let mut name = &b"linksetup"[..];
        let mut with_window = true;
        if let LinkLine::SetupAnswer(message) = line {
            name = b"linksetup_resp";
            with_window = self.setup.window() != 1 || message.get(b"windowsize").is_some();
        } else if let LinkLine::Setup(setup) = line {
            self.setup = setup;
            self.answers.forget();
        }
        let mut out = Encoder::begin(room, name);
        self.setup.write(&mut out, with_window);
        self.advance(1);
        if let LinkLine::SetupAnswer(_) = line {
            out.text(b"id", id);
            return end(&mut out, next, b"");
        }
        end(&mut out, next, id)
    }
}

pub(super) fn write_fault(fault: Fault, t: Option<u8>, id: &[u8], room: &mut [u8]) -> usize {
    end(Encoder::begin(room, b"onerror").text(b"code", fault.code()), t, id)
}

/// Ends a line by t and id, those that there are.
fn end(line: &mut Encoder, t: Option<u8>, id: &[u8]) -> usize {
    if let Some(t) = t {
        line.word(b"t", t.into());
    }
    if !id.is_empty() {
        line.text(b"id", id);
    }
    line.finish(false).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::device::ID_MAX;

    #[test]
    fn every_line_of_the_link_fits_its_room() {
        let id = [b'x'; ID_MAX];
        let setup = Setup::new(false, true, u8::MAX);
        let mut device = DeviceLink::<1, 64> { next: 255, setup: Setup::new(true, true, 1), ..DeviceLink::new() };
        let mut room = [0; LINK_LINE_MAX];
        let request = Request { t: Some(255), sum: 0xFFFF, place: None };
        assert_ne!(device.write(LinkLine::Ack(&request), &id, &mut room), 0);
        assert_ne!(device.write(LinkLine::Setup(setup), &id, &mut room), 0);
        device.next = 255;
        let message = Message::parse(b"c=linksetup&windowsize=1").unwrap();
        assert_ne!(device.write(LinkLine::SetupAnswer(&message), &id, &mut room), 0);
        for fault in [
            Fault::Checksum,
            Fault::Overflow,
            Fault::Malformed,
            Fault::UnknownId,
            Fault::UnknownCommand,
            Fault::Refused,
            Fault::TooLong,
        ] {
            assert_ne!(device.write(LinkLine::Fault(fault, Some(&request)), &id, &mut room), 0);
            // In place of an answer, whatever that may have.
            assert_ne!(device.write(LinkLine::Fault(fault, Some(&request)), &id, &mut [0; 64]), 0);
        }
    }
}
