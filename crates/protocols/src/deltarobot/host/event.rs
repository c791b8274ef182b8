//! What a session tells.

use core::ffi::{c_int, c_uchar};

use super::Host;
use crate::config::DP_DATA_MAX_SIZE;
use crate::deltarobot::{Opcode, Report};

/// How a request ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Outcome {
    /// It was carried out.
    Finished = 1,
    /// The controller did not accept it.
    Refused = 2,
    /// The controller accepted it, and could not carry it out.
    Failed = 3,
    /// The operation was cancelled: before it was ever sent, or the platform stands now.
    Cancelled = 4,
    /// Nothing is known.
    TimedOut = 5,
}

/// What a session has to tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A message was received (where [`Settings::messages`](super::Settings::messages) asks for these), with this many
    /// bytes of payload.
    Message(Opcode, usize),
    /// A status report was received.
    Status(Report),
    /// The platform's state is another one than in the report before this one.
    State(Report),
    /// A general error was received.
    GeneralError,
    /// The operation was accepted.
    Accepted(Opcode),
    /// A request has ended.
    Ended(Opcode, Outcome),
}

// In the order in which they are told.
pub(super) const TELL_MESSAGE: c_int = 1;
pub(super) const TELL_STATUS: c_int = 1 << 1;
pub(super) const TELL_STATE: c_int = 1 << 2;
pub(super) const TELL_ERROR: c_int = 1 << 3;
pub(super) const TELL_STATUS_ENDED: c_int = 1 << 4;
pub(super) const TELL_CANCEL_ENDED: c_int = 1 << 5;
pub(super) const TELL_ACCEPTED: c_int = 1 << 6;
pub(super) const TELL_ENDED: c_int = 1 << 7;

impl Host {
    /// Takes the next event off the list.
    pub(super) fn event(&mut self) -> Option<Event> {
        // The lowest bit.
        let next = self.tell & self.tell.wrapping_neg();
        self.tell ^= next;
        match next {
            TELL_MESSAGE => {
                let length = usize::try_from(self.message_length).unwrap_or_default();
                let opcode = Opcode(self.message_opcode);
                // As received, but for a struct that something else has written to.
                opcode.is_known().then_some(Event::Message(opcode, length.min(DP_DATA_MAX_SIZE)))
            }
            TELL_STATUS => self.last_report().map(Event::Status),
            TELL_STATE => self.last_report().map(Event::State),
            TELL_ERROR => Some(Event::GeneralError),
            TELL_STATUS_ENDED => Some(Event::Ended(Opcode::STATUS, outcome(self.status_outcome))),
            TELL_CANCEL_ENDED => Some(Event::Ended(Opcode::CANCEL, outcome(self.cancel_outcome))),
            TELL_ACCEPTED => Some(Event::Accepted(self.operation_opcode())),
            TELL_ENDED => Some(Event::Ended(self.operation_opcode(), outcome(self.operation_outcome))),
            _ => None,
        }
    }
}

const fn outcome(stored: c_uchar) -> Outcome {
    match stored {
        1 => Outcome::Finished,
        2 => Outcome::Refused,
        3 => Outcome::Failed,
        4 => Outcome::Cancelled,
        _ => Outcome::TimedOut,
    }
}

#[cfg(test)]
mod tests {
    use super::{Event, Host, Opcode, Outcome, TELL_ACCEPTED, TELL_ENDED, TELL_MESSAGE};
    use crate::config::DP_DATA_MAX_SIZE;
    use crate::deltarobot::host::Settings;

    #[test]
    fn what_is_told_is_in_range_whatever_the_struct_holds() {
        let mut host = Host::new(Settings::new());
        let mut told = |opcode, length, tell| {
            (host.opcode, host.message_opcode, host.message_length, host.tell) = (opcode, opcode, length, tell);
            host.event()
        };
        assert_eq!(told(b'A', 1, TELL_MESSAGE), Some(Event::Message(Opcode::ACK, 1)));
        assert_eq!(told(b'A', -1, TELL_MESSAGE), Some(Event::Message(Opcode::ACK, 0)));
        assert_eq!(told(b'A', i32::MAX, TELL_MESSAGE), Some(Event::Message(Opcode::ACK, DP_DATA_MAX_SIZE)));
        assert_eq!(told(b'x', 1, TELL_MESSAGE), None);
        assert_eq!(told(b'M', 0, TELL_ACCEPTED), Some(Event::Accepted(Opcode::MOVE)));
        assert_eq!(told(b'x', 0, TELL_ACCEPTED), Some(Event::Accepted(Opcode::HOMING)));
        assert_eq!(told(b'x', 0, TELL_ENDED), Some(Event::Ended(Opcode::HOMING, Outcome::TimedOut)));
    }
}
