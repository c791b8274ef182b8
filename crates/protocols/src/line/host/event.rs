//! What a session tells.

use core::ffi::{c_int, c_uchar};

use super::{Link, Listed, Message, Session, Slot};
use crate::config::OLP_DEVICES_MAX;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Outcome {
    /// The device has carried it out and answered.
    Answered = 1,
    /// The device did not carry it out, and says so.
    Refused = 2,
    /// What was to come back did not come. Whether it was carried out is not known, unless it was acknowledged: then
    /// the device has it.
    TimedOut = 3,
    /// The device has started anew. Whether it was carried out before that is not known.
    Restarted = 4,
    /// It was never sent: since it was queued, checksums came into force, with which it is too long.
    TooLong = 5,
}

impl Outcome {
    pub(super) const fn of(stored: c_uchar) -> Self {
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
    Overlong,
    /// It can't be read.
    Malformed,
}

/// What a session has to tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event<'a> {
    /// A device has signed in with this line.
    Welcome(Listed, Message<'a>),
    /// This is in force from now on.
    Linksetup(Link),
    /// The command of this handle was acknowledged.
    Acked(c_int),
    /// The command of this handle has ended; with the line that says so, where it was answered or refused.
    Ended(c_int, Outcome, Option<Message<'a>>),
    /// Any other line from the device.
    Line(Message<'a>),
    /// So many messages of the device's were lost.
    Lost(u8),
    /// The device reports an error. It concerns the command of this handle, or 0.
    Error(c_int, Message<'a>),
    /// A line was lost.
    Dropped(Dropped),
}

// In the order in which they are told; TELL_ENDED stands for what the slots say.
pub(super) const TELL_LOST: c_int = 1;
pub(super) const TELL_OVERLONG: c_int = 1 << 1;
pub(super) const TELL_MALFORMED: c_int = 1 << 2;
pub(super) const TELL_ERROR: c_int = 1 << 3;
pub(super) const TELL_LINKSETUP: c_int = 1 << 4;
pub(super) const TELL_ACKED: c_int = 1 << 5;
pub(super) const TELL_ENDED: c_int = 1 << 6;
pub(super) const TELL_WELCOME: c_int = 1 << 7;
pub(super) const TELL_LINE: c_int = 1 << 8;

/// The part of an event that does not lie in the line.
#[derive(Clone, Copy, Debug)]
pub(super) enum Happened {
    Welcome,
    Linksetup,
    Acked,
    Ended(c_int, Outcome),
    Line,
    Lost,
    Error,
    Dropped(Dropped),
}

impl Session {
    /// Takes the next event off the list.
    pub(super) fn next_to_tell(&mut self) -> Option<Happened> {
        while self.tell != 0 {
            // The lowest bit.
            let next = self.tell & self.tell.wrapping_neg();
            if next == TELL_ENDED {
                let told = Self::oldest(&mut self.slots, self.order, Slot::has_ended)
                    .map(|slot| Happened::Ended(slot.handle(), slot.release()));
                if !self.slots.iter().any(Slot::has_ended) {
                    self.tell ^= TELL_ENDED;
                }
                if told.is_some() {
                    return told;
                }
                continue;
            }
            self.tell ^= next;
            match next {
                TELL_LOST => return Some(Happened::Lost),
                TELL_OVERLONG => return Some(Happened::Dropped(Dropped::Overlong)),
                TELL_MALFORMED => return Some(Happened::Dropped(Dropped::Malformed)),
                TELL_ERROR => return Some(Happened::Error),
                TELL_LINKSETUP => return Some(Happened::Linksetup),
                TELL_ACKED => return Some(Happened::Acked),
                TELL_WELCOME => return Some(Happened::Welcome),
                TELL_LINE => return Some(Happened::Line),
                _ => (),
            }
        }
        None
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

    pub(super) fn list(&mut self, listed: Listed) {
        let (kind, index) = match listed {
            Listed::Whole(index) => (0, index),
            Listed::Cut(index) => (1, index),
            Listed::Full => (2, 0),
            Listed::IdTooLong => (3, 0),
            Listed::NoId => (4, 0),
        };
        self.listed = kind;
        self.listed_at = c_int::try_from(index).unwrap_or_default();
    }

    fn listed(&self) -> Listed {
        // The session's memory may have been overwritten.
        let index = usize::try_from(self.listed_at).ok().filter(|index| *index < OLP_DEVICES_MAX);
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
    use super::{Listed, OLP_DEVICES_MAX, c_int};
    use crate::line::host::{Host, Settings};

    #[test]
    fn no_place_is_told_that_there_is_not() {
        let mut session = Host::new(Settings::new()).session;
        session.list(Listed::Cut(OLP_DEVICES_MAX - 1));
        assert_eq!(session.listed(), Listed::Cut(OLP_DEVICES_MAX - 1));
        for place in [OLP_DEVICES_MAX.try_into().unwrap(), c_int::MAX, c_int::MIN, -1] {
            session.listed_at = place;
            assert_eq!(session.listed(), Listed::NoId);
        }
    }
}
