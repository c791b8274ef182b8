//! A request on its way: what every kind of request has in common.

use zerocopy::{FromBytes, Immutable, KnownLayout, TryFromBytes};

use super::Busy;
use super::settings::Health;
use crate::session::{Flags, Transmission, flags, left};

/// One request at a time of each kind.
#[derive(Clone, Debug, Default, FromBytes, Immutable, KnownLayout)]
pub(super) struct Request {
    pub(super) transmission: Transmission,
    /// When its predecessor, of which answers may still come, was sent last.
    previous_at: u32,
    marks: Flags<Mark>,
    /// One of [`Stage`], and of [`Outcome`].
    pub(super) stage: u8,
    outcome: u8,
}

/// How far a request is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, TryFromBytes)]
#[repr(u8)]
pub(super) enum Stage {
    /// There is none.
    Free = 0,
    /// It waits for its turn.
    Queued = 1,
    /// It was sent and waits for the answer.
    Sent = 2,
    /// It was refused, but only after a retransmission: the first may have been accepted, and the second refused
    /// because of that.
    NackAfterRetry = 3,
    /// It was accepted.
    Accepted = 4,
    /// Its outcome is to be fetched.
    Ended = 5,
}

flags! {
    enum Mark {
        /// It was sent at all.
        Used,
        /// It was accepted by an ack.
        Acked,
        /// Answers to the predecessor may still come.
        PreviousInFlight,
        /// It is to be fetched by [`Host::output`](super::Host::output).
        ToSend,
    }
}

/// How a request ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, TryFromBytes)]
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

impl Request {
    pub(super) fn stage(&self) -> Stage {
        Stage::try_read_from_bytes(&[self.stage]).unwrap_or(Stage::Free)
    }

    pub(super) fn is_going_on(&self) -> bool {
        !matches!(self.stage(), Stage::Free | Stage::Ended)
    }

    /// It was sent, and not accepted yet.
    pub(super) fn is_unanswered(&self) -> bool {
        matches!(self.stage(), Stage::Sent | Stage::NackAfterRetry)
    }

    /// Begins a new request. Of the old one no answer can come any more if it was sent once and accepted: when such an
    /// operation ends, its ack is long gone by. Unless the line `duplicates` frames: then the request may have been
    /// carried out twice.
    pub(super) fn queue(&mut self, duplicates: bool) -> Result<(), Busy> {
        if self.stage() != Stage::Free {
            return Err(Busy);
        }
        if self.marks.has(Mark::Used) {
            let in_flight = duplicates || self.transmission.sent > 1 || !self.marks.has(Mark::Acked);
            self.marks.set_to(Mark::PreviousInFlight, in_flight);
            self.previous_at = self.transmission.sent_at;
        }
        self.transmission.sent = 0;
        self.marks.clear(Mark::Used);
        self.marks.clear(Mark::Acked);
        self.stage = Stage::Queued as u8;
        Ok(())
    }

    /// Something that was sent behind it was answered, so it was received, or is lost.
    pub(super) fn overtake(&mut self) {
        self.stage = Stage::Accepted as u8;
        self.marks.set(Mark::Acked);
        self.transmission.sent = 0;
    }

    /// Has it sent for the first time or again.
    pub(super) fn send(&mut self, now: u32) {
        self.transmission.send(now);
        self.sends();
    }

    /// Has it sent without counting that, since an answer would not be believed anyway.
    pub(super) fn send_uncounted(&mut self, now: u32) {
        self.transmission.sent_at = now;
        self.sends();
    }

    fn sends(&mut self) {
        self.marks.set(Mark::Used);
        self.stage = Stage::Sent as u8;
        self.ask();
    }

    /// Has its frame sent, whether or not there is such a request.
    pub(super) fn ask(&mut self) {
        self.marks.set(Mark::ToSend);
    }

    pub(super) fn withhold(&mut self) {
        self.marks.clear(Mark::ToSend);
    }

    pub(super) fn is_to_send(&self) -> bool {
        self.marks.has(Mark::ToSend)
    }

    /// Its frame was fetched for sending.
    pub(super) fn leaves(&mut self, now: u32) {
        self.withhold();
        self.transmission.sent_at = now;
    }

    /// It was answered, and accepted or refused by that.
    pub(super) fn answer(&mut self, accepted: bool, now: u32, health: &mut Health) {
        if self.transmission.sent == 1 && !self.marks.has(Mark::PreviousInFlight) {
            health.round_trips.add(self.transmission.elapsed(now));
        }
        self.marks.set_to(Mark::Acked, accepted);
    }

    /// It has ended.
    pub(super) fn end(&mut self, outcome: Outcome) {
        self.stage = Stage::Ended as u8;
        self.outcome = outcome as u8;
        self.withhold();
    }

    /// How it ended, when that was not fetched before.
    pub(super) fn take_outcome(&mut self) -> Option<Outcome> {
        if self.stage() != Stage::Ended {
            return None;
        }
        self.stage = Stage::Free as u8;
        Some(Outcome::try_read_from_bytes(&[self.outcome]).unwrap_or(Outcome::TimedOut))
    }

    /// How long answers to the predecessor may still come.
    pub(super) fn previous_left(&self, now: u32, guard: u32) -> u32 {
        if self.marks.has(Mark::PreviousInFlight) { left(now, self.previous_at, guard) } else { 0 }
    }

    /// Whether a retransmission may still be on its way, or its answer.
    pub(super) const fn is_retry_in_flight(&self, now: u32, guard: u32) -> bool {
        self.transmission.sent > 1 && self.transmission.left(now, guard) > 0
    }
}

#[cfg(test)]
mod tests {
    use super::{Health, Outcome, Request};

    #[test]
    fn answers_to_a_request_may_still_come_unless_it_was_sent_once_and_accepted() {
        let in_flight = |sent: u32, accepted: bool, duplicates: bool| {
            let (mut request, mut health) = (Request::default(), Health::default());
            request.queue(false).unwrap();
            (0..sent).for_each(|time| request.send(time));
            if accepted {
                request.answer(true, 10, &mut health);
            }
            // A request that is never sent does not change that.
            for _ in 0..2 {
                request.end(Outcome::Finished);
                assert_eq!((request.take_outcome(), request.take_outcome()), (Some(Outcome::Finished), None));
                request.queue(duplicates).unwrap();
            }
            request.previous_left(100, 500) > 0
        };
        assert!(!in_flight(0, false, true));
        assert!(!in_flight(1, true, false));
        assert!(in_flight(1, true, true));
        assert!(in_flight(1, false, false));
        assert!(in_flight(2, true, false));
    }
}
