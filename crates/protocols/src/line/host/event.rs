//! The events of a session.

use zerocopy::TryFromBytes;

use super::{Link, Listed, Message, Session, Slot};
use crate::session::flags;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, TryFromBytes)]
#[repr(u8)]
pub enum Outcome {
    /// The device has carried it out and answered.
    Answered = 1,
    /// The device did not carry it out, and says so.
    Refused = 2,
    /// What was to come back did not. Whether it was executed is not known; if it was acknowledged, it was received.
    TimedOut = 3,
    /// The device has restarted. Whether it was executed before that is not known.
    Restarted = 4,
    /// It was never sent: since it was queued, checksums came into force, with which it is too long.
    TooLong = 5,
}

/// Why a line was dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dropped {
    /// It is longer than a receiver takes.
    TooLong,
    /// It can't be read.
    Malformed,
}

/// What has happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event<'a> {
    /// A device has signed in by this line.
    Welcome(Listed, Message<'a>),
    /// This is in force from now on.
    Linksetup(Link),
    /// The command of this handle was acknowledged.
    Acked(u16),
    /// The command of this handle has ended; with the line that says so, where it was answered or refused.
    Ended(u16, Outcome, Option<Message<'a>>),
    /// Any other line from the device.
    Line(Message<'a>),
    /// So many messages of the device's were lost.
    Lost(u8),
    /// The device reports an error. It concerns the command of this handle, or 0.
    Error(u16, Message<'a>),
    /// A line was lost.
    Dropped(Dropped),
}

flags! {
    /// What is to be reported, in this order.
    pub(super) enum Pending {
        Lost,
        TooLong,
        Malformed,
        Error,
        Linksetup,
        Acked,
        /// Of the commands that their slots say have ended.
        Ended,
        Welcome,
        Line,
    }
}

impl<const WINDOW: usize, const DEVICES: usize> Session<WINDOW, DEVICES> {
    /// Takes the next pending event; `line` is the one that was received, or empty.
    pub(super) fn next_event<'a>(&mut self, line: &'a [u8]) -> Option<Event<'a>> {
        let first = self.pending.first()?;
        let message = Message::parse(line).ok();
        if first == Pending::Ended {
            let ended = Self::oldest(&mut self.slots, self.order, Slot::has_ended);
            let ended = ended.map(|slot| (slot.handle, slot.release()));
            if !self.slots.iter().any(Slot::has_ended) {
                self.pending.clear(first);
            }
            // Without one, the session's memory was overwritten.
            let Some((handle, outcome)) = ended else { return self.next_event(line) };
            let has_line = matches!(outcome, Outcome::Answered | Outcome::Refused);
            return Some(Event::Ended(handle, outcome, message.filter(|_| has_line)));
        }
        self.pending.clear(first);
        Some(match first {
            Pending::Lost => Event::Lost(self.lost),
            Pending::TooLong => Event::Dropped(Dropped::TooLong),
            Pending::Malformed => Event::Dropped(Dropped::Malformed),
            Pending::Error => Event::Error(self.concerned, message?),
            Pending::Linksetup => Event::Linksetup(self.link),
            Pending::Acked => Event::Acked(self.concerned),
            Pending::Welcome => Event::Welcome(self.devices.listed(&message?), message?),
            Pending::Ended | Pending::Line => Event::Line(message?),
        })
    }
}
