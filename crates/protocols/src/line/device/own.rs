//! The lines that the link has to say itself.

use super::{DeviceLink, Fault, Request, Setup};
use crate::line::encoder::Encoder;
use crate::line::message::Message;

/// Room for any of them.
pub const OWN_LINE_MAX: usize = 80;

impl DeviceLink {
    /// Writes the ack of a command, if commands are acked: 0 if not.
    pub fn ack(&self, request: &Request, id: &[u8], room: &mut [u8]) -> usize {
        if !self.setup.acks() {
            return 0;
        }
        let mut line = Encoder::begin(room, b"ack");
        if self.setup.checks() {
            line.hex(b"checksum", request.sum);
        } else {
            line.text(b"checksum", b"null");
        }
        end(&mut line, request.t, id)
    }

    /// Writes what answers a linksetup, which may have asked for a window.
    pub fn setup_answer(&mut self, message: &Message, id: &[u8], room: &mut [u8]) -> usize {
        let with_window = self.setup.window() != 1 || message.get(b"windowsize").is_some();
        let mut line = Encoder::begin(room, b"linksetup_resp");
        self.setup.write(&mut line, with_window);
        let length = line.text(b"id", id).int(b"t", self.next.into()).finish(false).unwrap_or(0);
        self.advance(1);
        length
    }

    /// Puts a setup in force, and writes the event that tells so.
    pub fn setup_event(&mut self, setup: Setup, id: &[u8], room: &mut [u8]) -> usize {
        self.setup = setup;
        self.answers.forget();
        let mut line = Encoder::begin(room, b"linksetup");
        setup.write(&mut line, true);
        let length = end(&mut line, Some(self.next), id);
        self.advance(1);
        length
    }

    /// Writes an `onerror`; `request` is the command that a final one answers.
    pub fn fault(&mut self, fault: Fault, request: Option<&Request>, id: &[u8], room: &mut [u8]) -> usize {
        self.count(fault);
        let t = request.map_or(Some(self.next), |request| request.t);
        let length = write_fault(fault, t, id, room);
        if request.is_none() {
            self.advance(1);
        }
        length
    }
}

pub(super) fn write_fault(fault: Fault, t: Option<u8>, id: &[u8], room: &mut [u8]) -> usize {
    end(Encoder::begin(room, b"onerror").text(b"code", fault.code()), t, id)
}

/// Ends a line by t and id, those that there are.
fn end(line: &mut Encoder, t: Option<u8>, id: &[u8]) -> usize {
    if let Some(t) = t {
        line.int(b"t", t.into());
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
    fn every_own_line_fits_its_room() {
        let id = [b'x'; ID_MAX];
        let setup = Setup::new(false, true, u16::MAX);
        let mut device = DeviceLink { next: 255, setup: Setup::new(true, true, 1), ..DeviceLink::default() };
        let mut room = [0; OWN_LINE_MAX];
        let request = Request { t: Some(255), sum: 0xFFFF, place: None };
        assert_ne!(device.ack(&request, &id, &mut room), 0);
        assert_ne!(device.setup_event(setup, &id, &mut room), 0);
        device.next = 255;
        let message = Message::parse(b"c=linksetup&windowsize=1").unwrap();
        assert_ne!(device.setup_answer(&message, &id, &mut room), 0);
        for fault in [
            Fault::Checksum,
            Fault::Overflow,
            Fault::Malformed,
            Fault::UnknownId,
            Fault::UnknownCommand,
            Fault::Refused,
            Fault::TooLong,
        ] {
            assert_ne!(device.fault(fault, Some(&request), &id, &mut room), 0);
            // In place of an answer, whatever that may have.
            assert_ne!(device.fault(fault, Some(&request), &id, &mut [0; 64]), 0);
        }
    }
}
