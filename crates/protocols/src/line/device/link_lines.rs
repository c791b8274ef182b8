//! The lines that the link itself sends: acks, `linksetup`, `linksetup_resp` and `onerror`.

use super::{DeviceLink, Fault};

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

impl<const WINDOW: usize, const REPLY: usize> DeviceLink<WINDOW, REPLY> {
    /// Writes such a line and returns its length, 0 when there is none to be sent.
    // The room lies in its caller's frame, and on AVR what lies behind the first 64 bytes of one takes five
    // instructions to reach.
    #[cfg_attr(target_pointer_width = "16", inline(never))]
    pub fn write(&mut self, line: LinkLine, room: &mut [u8]) -> usize {
        let mut steps = 0;
        let length = match line {
            LinkLine::Ack if !self.lines.setup.acks() => 0,
            LinkLine::Ack => self.lines.write_ack(room),
            LinkLine::Setup | LinkLine::SetupAnswer => {
                steps = 1;
                self.lines.write_setup(matches!(line, LinkLine::SetupAnswer), room)
            }
            LinkLine::Answer(fault) => self.write_fault(fault, true, room),
            LinkLine::Event(fault) => {
                steps = 1;
                self.write_fault(fault, false, room)
            }
        };
        self.advance(steps);
        length
    }

    #[cfg_attr(target_pointer_width = "16", inline(never))]
    fn write_fault(&mut self, fault: Fault, answers: bool, room: &mut [u8]) -> usize {
        self.count(fault);
        self.lines.write_fault(fault, answers, room)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::device::{ID_MAX, LINK_LINE_MAX, Request, Setup};

    #[test]
    fn every_line_of_the_link_fits_its_room() {
        let id = [b'x'; ID_MAX];
        let mut device = DeviceLink::<1, 64>::new();
        device.set_up(Setup::new(true, true, 1));
        device.speak_for(&id);
        device.lines.next = 255;
        let mut room = [0; LINK_LINE_MAX];
        device.lines.request = Request { t: 255, has_t: 1, place: 255, sum: 0xFFFF };
        assert_ne!(device.write(LinkLine::Ack, &mut room), 0);
        device.set_up(Setup::new(false, true, u8::MAX));
        assert_ne!(device.write(LinkLine::Setup, &mut room), 0);
        device.lines.next = 255;
        assert_ne!(device.write(LinkLine::SetupAnswer, &mut room), 0);
        for fault in [
            Fault::Checksum,
            Fault::Overflow,
            Fault::Malformed,
            Fault::UnknownId,
            Fault::UnknownCommand,
            Fault::Refused,
            Fault::TooLong,
        ] {
            assert_ne!(device.write(LinkLine::Answer(fault), &mut room), 0);
            // In place of an answer, whatever that may have.
            assert_ne!(device.write(LinkLine::Answer(fault), &mut [0; 64]), 0);
        }
    }
}
