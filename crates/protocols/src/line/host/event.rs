//! The events of a session.

use super::{Link, Listed, Message, Session, Slot};
use crate::session::flags;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Outcome {
    /// The device has carried it out and answered.
    Answered = 1,
    /// The device did not carry it out, and says so.
    Refused = 2,
    /// What was to come back did not come. Whether it was executed is not known, unless it was acknowledged: then
    /// the device has it.
    TimedOut = 3,
    /// The device has restarted. Whether it was executed before that is not known.
    Restarted = 4,
    /// It was never sent: since it was queued, checksums came into force, with which it is too long.
    TooLong = 5,
}

impl Outcome {
    pub(super) const fn of(stored: u8) -> Self {
        match stored {
            1 => Self::Answered,
            2 => Self::Refused,
            4 => Self::Restarted,
            5 => Self::TooLong,
            _ => Self::TimedOut,
        }
    }
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

/// The part of an event that does not lie in the line.
#[derive(Clone, Copy, Debug)]
pub(super) enum Happened {
    Welcome,
    Linksetup,
    Acked,
    Ended(u16, Outcome),
    Line,
    Lost,
    Error,
    Dropped(Dropped),
}

impl<const WINDOW: usize, const DEVICES: usize> Session<WINDOW, DEVICES> {
    /// Takes the next pending event.
    pub(super) fn next_event(&mut self) -> Option<Happened> {
        let first = self.pending.first()?;
        if first == Pending::Ended {
            let ended = Self::oldest(&mut self.slots, self.order, Slot::has_ended);
            let happened = ended.map(|slot| Happened::Ended(slot.handle(), slot.release()));
            if !self.slots.iter().any(Slot::has_ended) {
                self.pending.clear(first);
            }
            // Without one, the session's memory was overwritten.
            return happened.or_else(|| self.next_event());
        }
        self.pending.clear(first);
        Some(match first {
            Pending::Lost => Happened::Lost,
            Pending::TooLong => Happened::Dropped(Dropped::TooLong),
            Pending::Malformed => Happened::Dropped(Dropped::Malformed),
            Pending::Error => Happened::Error,
            Pending::Linksetup => Happened::Linksetup,
            Pending::Acked => Happened::Acked,
            Pending::Welcome => Happened::Welcome,
            Pending::Ended | Pending::Line => Happened::Line,
        })
    }

    /// The event, now that the line is at hand.
    pub(super) fn event<'a>(&self, happened: Happened, line: &'a [u8]) -> Option<Event<'a>> {
        let message = Message::parse(line).ok();
        Some(match happened {
            Happened::Welcome => Event::Welcome(self.listed(), message?),
            Happened::Linksetup => Event::Linksetup(self.link),
            Happened::Acked => Event::Acked(self.concerned),
            Happened::Ended(handle, outcome) => {
                let has_line = matches!(outcome, Outcome::Answered | Outcome::Refused);
                Event::Ended(handle, outcome, message.filter(|_| has_line))
            }
            Happened::Line => Event::Line(message?),
            Happened::Lost => Event::Lost(self.lost),
            Happened::Error => Event::Error(self.concerned, message?),
            Happened::Dropped(why) => Event::Dropped(why),
        })
    }

    pub(super) fn set_listed(&mut self, listed: Listed) {
        let (kind, index) = match listed {
            Listed::Whole(index) => (0, index),
            Listed::Cut(index) => (1, index),
            Listed::Full => (2, 0),
            Listed::IdTooLong => (3, 0),
            Listed::NoId => (4, 0),
        };
        self.listed = kind;
        self.listed_at = u8::try_from(index).unwrap_or_default();
    }

    fn listed(&self) -> Listed {
        // The session's memory may have been overwritten.
        let index = Some(usize::from(self.listed_at)).filter(|index| *index < DEVICES);
        match (self.listed, index) {
            (0, Some(index)) => Listed::Whole(index),
            (1, Some(index)) => Listed::Cut(index),
            (2, _) => Listed::Full,
            (3, _) => Listed::IdTooLong,
            _ => Listed::NoId,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Listed;
    use crate::line::host::{Host, Settings};

    #[test]
    fn a_place_that_does_not_exist_is_not_reported() {
        let mut session = Host::<81, 2, 16>::new(Settings::new()).session;
        session.set_listed(Listed::Cut(15));
        assert_eq!(session.listed(), Listed::Cut(15));
        for place in [16, 255] {
            session.listed_at = place;
            assert_eq!(session.listed(), Listed::NoId);
        }
    }
}
