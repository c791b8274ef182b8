//! What the time brings about: sending, repeating, polling, giving up.

use super::operation::{CANCELLED, ERRED, EVIDENT};
use super::request::{ACCEPTED, DOUBTED, QUEUED, SENT};
use super::{Host, Outcome, SEND_CANCEL, SEND_OPERATION, SEND_STATUS};
use crate::clock::{left, stamp};
use crate::counter::count;

impl Host {
    /// How many milliseconds may pass until [`poll`](Self::poll) has something to do without having received anything;
    /// `None` when only receiving or a request brings anything about. To be asked when there are no events left.
    #[must_use]
    pub fn next_deadline(&self, now: u32) -> Option<u32> {
        if self.send != 0 || self.tell != 0 {
            return Some(0);
        }
        let gap = self.link.gap_left(now, self.settings.gap());
        let all = [gap, self.cancel_left(now), self.operation_left(now), self.status_left(now)];
        all.into_iter().flatten().min()
    }

    /// Does what is due. Nothing that was received is left to be looked at.
    pub(super) fn look_at_the_time(&mut self, now: u32) {
        if self.cancel_left(now) == Some(0) {
            self.cancel_due(now);
        }
        if self.operation_left(now) == Some(0) {
            self.operation_due(now);
        }
        if self.status_left(now) == Some(0) {
            self.status_due(now);
        }
    }

    fn cancel_left(&self, now: u32) -> Option<u32> {
        match self.cancel.stage() {
            QUEUED => Some(0),
            SENT => Some(self.cancel.left(now, self.settings.ack())),
            _ => None,
        }
    }

    fn cancel_due(&mut self, now: u32) {
        if self.cancel.loose_left(now, self.settings.guard()) > 0 {
            self.cancel.send_uncounted(now);
        } else if self.cancel.stage() == SENT && self.gives_up(self.cancel.sent()) {
            // It may have been received all the same.
            self.known |= CANCELLED;
            self.end_cancel(Outcome::TimedOut);
            return;
        } else {
            self.cancel.send(now);
        }
        self.send |= SEND_CANCEL;
        // Behind the cancel request, it would start the operation again.
        self.send &= !SEND_OPERATION;
    }

    fn operation_left(&self, now: u32) -> Option<u32> {
        let settings = &self.settings;
        match self.operation.stage() {
            // Behind the answer to a cancel request that has nothing to do with it.
            QUEUED | SENT if !self.cancel.is_free() => None,
            QUEUED => Some(self.operation.loose_left(now, settings.guard())),
            SENT => Some(self.operation.left(now, settings.ack())),
            DOUBTED => {
                let poll = left(now, self.polled_at, settings.poll());
                Some(poll.min(self.doubt_left(now)))
            }
            ACCEPTED => {
                let poll = left(now, self.polled_at, settings.poll());
                Some(poll.min(self.patience_left(now)))
            }
            _ => None,
        }
    }

    /// How long a report may take that says what a nack meant.
    fn doubt_left(&self, now: u32) -> u32 {
        let settings = &self.settings;
        self.operation.left(now, settings.guard().saturating_add(settings.ack()).saturating_add(settings.poll()))
    }

    fn patience_left(&self, now: u32) -> u32 {
        let silence = left(now, self.heard_at, self.settings.silence());
        silence.min(left(now, self.started_at, self.settings.operation()))
    }

    fn operation_due(&mut self, now: u32) {
        match self.operation.stage() {
            QUEUED => {
                self.started_at = stamp(now);
                self.known = 0;
                self.send_operation(now);
            }
            SENT if self.known & ERRED != 0 => self.end_operation(Outcome::Failed),
            SENT if self.known & CANCELLED != 0 => self.end_operation(Outcome::TimedOut),
            SENT if !self.gives_up(self.operation.sent()) => self.send_operation(now),
            SENT if self.known & EVIDENT != 0 => self.accept_by_evidence(now),
            SENT => self.end_operation(Outcome::TimedOut),
            DOUBTED if self.doubt_left(now) == 0 => self.end_operation(Outcome::TimedOut),
            ACCEPTED if self.patience_left(now) == 0 => self.end_operation(Outcome::TimedOut),
            _ => self.ask_for_the_state(now),
        }
    }

    fn send_operation(&mut self, now: u32) {
        self.operation.send(now);
        self.send |= SEND_OPERATION;
    }

    fn status_left(&self, now: u32) -> Option<u32> {
        match self.status.stage() {
            QUEUED => Some(0),
            SENT => Some(self.status.left(now, self.settings.ack())),
            _ => None,
        }
    }

    fn status_due(&mut self, now: u32) {
        if self.status.stage() == SENT && self.gives_up(self.status.sent()) {
            self.end_status(Outcome::TimedOut);
            return;
        }
        self.status.send(now);
        self.send |= SEND_STATUS;
    }

    /// An answer is overdue: counts that, and the repeat unless the request was sent often enough.
    fn gives_up(&mut self, sent: u8) -> bool {
        count(&mut self.health.timeouts);
        let enough = sent >= self.settings.attempts();
        if !enough {
            count(&mut self.health.repeats);
        }
        enough
    }
}

#[cfg(test)]
mod tests {
    use crate::deltarobot::Opcode;
    use crate::deltarobot::host::{Event, Host, Outcome, REQUEST_MAX, Settings};

    #[test]
    fn a_request_is_repeated_until_it_has_timed_out() {
        let mut host = Host::new(Settings { ack_ms: 100, attempts: 3, ..Settings::new() });
        assert_eq!(host.next_deadline(7), None);
        assert_eq!(host.home(), Ok(()));
        // Late in the clock's turn, so that it wraps in between.
        let start = u32::MAX.wrapping_sub(149);
        for now in [start, start.wrapping_add(100), start.wrapping_add(200)] {
            assert_eq!(host.poll(now.wrapping_sub(1), &mut [0; 0]), None);
            assert_eq!(host.poll(now, &mut [0; 0]), None);
            assert_eq!(host.next_deadline(now), Some(0));
            let mut frame = [0; REQUEST_MAX];
            assert_eq!(host.output(&mut frame, 5, now), 5);
            assert_eq!(frame[..5], *b"$H\0\xA6:");
            assert_eq!(host.next_deadline(now), Some(100));
        }
        let end = start.wrapping_add(300);
        assert_eq!(host.poll(end, &mut [0; 0]), Some(Event::Ended(Opcode::HOMING, Outcome::TimedOut)));
        assert_eq!((host.health().timeouts, host.health().repeats), (3, 2));
        assert_eq!((host.poll(end, &mut [0; 0]), host.next_deadline(end)), (None, None));
    }
}
