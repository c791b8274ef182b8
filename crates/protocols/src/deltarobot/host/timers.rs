//! What is due: sending, retransmitting, polling the status, giving up.

use super::Session;
use super::operation::Fact;
use super::request::{Outcome, Request, Stage};
use crate::session::{Flags, count, left, span, times};

/// The time left where nothing is due. Other times are shorter.
pub(super) const NEVER: u32 = u32::MAX;

impl Session {
    /// How long until [`on_timer`](Self::on_timer) has something to do, or 0 when events or frames are to be fetched.
    pub(super) fn time_left(&self, now: u32) -> u32 {
        let requests = [&self.cancel, &self.operation, &self.status];
        if !self.notices.is_empty()
            || requests.iter().any(|request| request.is_to_send() || request.stage() == Stage::Ended)
        {
            return 0;
        }
        self.request_left(&self.cancel, now).min(self.operation_left(now)).min(self.request_left(&self.status, now))
    }

    /// Does what is due. Nothing that was received is left to be handled.
    pub(super) fn on_timer(&mut self, now: u32) {
        if self.request_left(&self.cancel, now) == 0 {
            self.cancel_due(now);
        }
        if self.operation_left(now) == 0 {
            self.operation_due(now);
        }
        if self.request_left(&self.status, now) == 0 {
            self.status_due(now);
        }
    }

    /// How long until a cancel or status request is due.
    fn request_left(&self, request: &Request, now: u32) -> u32 {
        match request.stage() {
            Stage::Queued => 0,
            Stage::Sent => request.transmission.left(now, self.settings.ack()),
            _ => NEVER,
        }
    }

    fn cancel_due(&mut self, now: u32) {
        if self.cancel.previous_left(now, self.settings.guard()) > 0 {
            self.cancel.send_uncounted(now);
        } else if self.cancel.stage() == Stage::Sent && !self.may_retransmit(self.cancel.transmission.sent) {
            // It may have been received all the same.
            self.facts.set(Fact::Cancelled);
            self.cancel.end(Outcome::TimedOut);
            return;
        } else {
            self.cancel.send(now);
        }
        // Behind the cancel request, it would start the operation again.
        self.operation.withhold();
    }

    fn operation_left(&self, now: u32) -> u32 {
        let settings = &self.settings;
        let poll = left(now, self.polled_at, settings.poll());
        match self.operation.stage() {
            // Behind the answer to a cancel request that has nothing to do with it.
            Stage::Queued | Stage::Sent if self.cancel.is_going_on() => NEVER,
            Stage::Queued => self.operation.previous_left(now, settings.guard()),
            Stage::Sent => self.operation.transmission.left(now, settings.ack()),
            Stage::NackAfterRetry => poll.min(self.resolution_left(now)),
            Stage::Accepted => poll.min(self.timeout_left(now)),
            Stage::Free | Stage::Ended => NEVER,
        }
    }

    /// How long until a nack after a retransmission is not resolved any more.
    fn resolution_left(&self, now: u32) -> u32 {
        let settings = &self.settings;
        self.operation
            .transmission
            .left(now, settings.guard().saturating_add(settings.ack()).saturating_add(settings.poll()))
    }

    /// How long until an accepted operation is given up.
    fn timeout_left(&self, now: u32) -> u32 {
        let silence = left(now, self.heard_at, span(self.settings.silence_ms, 3000));
        silence.min(left(now, self.started_at, span(self.settings.operation_ms, 120_000)))
    }

    fn operation_due(&mut self, now: u32) {
        match self.operation.stage() {
            Stage::Queued => {
                self.started_at = now;
                self.facts = Flags::default();
                self.operation.send(now);
            }
            Stage::Sent if self.facts.has(Fact::ErrorReported) => self.operation.end(Outcome::Failed),
            Stage::Sent if self.facts.has(Fact::Cancelled) => self.operation.end(Outcome::TimedOut),
            Stage::Sent if self.may_retransmit(self.operation.transmission.sent) => self.operation.send(now),
            Stage::Sent if self.facts.has(Fact::SeenRunning) => self.accept_by_reports(now),
            Stage::Sent => self.operation.end(Outcome::TimedOut),
            Stage::NackAfterRetry if self.resolution_left(now) == 0 => self.operation.end(Outcome::TimedOut),
            Stage::Accepted if self.timeout_left(now) == 0 => self.operation.end(Outcome::TimedOut),
            _ => self.ask_status(now),
        }
    }

    fn status_due(&mut self, now: u32) {
        if self.status.stage() == Stage::Sent && !self.may_retransmit(self.status.transmission.sent) {
            self.status.end(Outcome::TimedOut);
        } else {
            self.status.send(now);
        }
    }

    /// An answer is overdue: counts that, and the retransmission unless the request was sent often enough.
    fn may_retransmit(&mut self, sent: u8) -> bool {
        count(&mut self.health.timeouts);
        let may = sent < times(self.settings.attempts, 4, 1);
        if may {
            count(&mut self.health.retransmissions);
        }
        may
    }
}

#[cfg(test)]
mod tests {
    use crate::deltarobot::host::{Event, Host, Outcome, REQUEST_MAX, Settings};
    use crate::deltarobot::{Opcode, receiver_room};

    #[test]
    fn a_request_is_retransmitted_until_it_has_timed_out() {
        let settings = Settings { ack_ms: 100, attempts: 3, ..Settings::default() };
        let mut host = Host::<{ receiver_room(16) }>::new(settings);
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
        assert_eq!((host.health().timeouts, host.health().retransmissions), (3, 2));
        assert_eq!((host.poll(end, &mut [0; 0]), host.next_deadline(end)), (None, None));
    }
}
