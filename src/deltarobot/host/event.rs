//! What a session tells.

use core::ffi::{c_int, c_uchar};

use super::Host;
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
                Some(Event::Message(Opcode(self.message_opcode), length))
            }
            TELL_STATUS => self.last_report().map(Event::Status),
            TELL_STATE => self.last_report().map(Event::State),
            TELL_ERROR => Some(Event::GeneralError),
            TELL_STATUS_ENDED => Some(Event::Ended(Opcode::STATUS, outcome(self.status_outcome))),
            TELL_CANCEL_ENDED => Some(Event::Ended(Opcode::CANCEL, outcome(self.cancel_outcome))),
            TELL_ACCEPTED => Some(Event::Accepted(Opcode(self.opcode))),
            TELL_ENDED => Some(Event::Ended(Opcode(self.opcode), outcome(self.operation_outcome))),
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
