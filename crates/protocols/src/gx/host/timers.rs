//! What is due by the clock: beginning, asking again, giving up.

use super::{DRAINING, Host, IDLE, Is, OPEN, Outcome, Send};
use crate::gx::Control;
use crate::session::{count, left};

impl<const WINDOW: usize> Host<WINDOW> {
    /// How many milliseconds may pass until [`poll`](Self::poll) has something to do without having received anything;
    /// `None` when only receiving or a request brings anything about. To be asked when there are no events left.
    pub fn next_deadline(&self, now: u32) -> Option<u32> {
        if !self.pending.is_empty() || self.window.has_ended() || self.has_output() {
            return Some(0);
        }
        let left = [self.gap_left(now), self.session_left(now), self.reports_left(now), self.control_left(now)];
        left.into_iter().flatten().min()
    }

    fn has_output(&self) -> bool {
        self.send.has(Send::Handshake)
            || self.send.has(Send::Reporting)
            || self.to_retransmit().is_some()
            || self.may_send()
    }

    /// Does what is due. Nothing that was received is left to be looked at.
    pub(super) fn on_timer(&mut self, now: u32) {
        if self.session_left(now) == Some(0) {
            match self.stage {
                OPEN | DRAINING => self.on_session_timer(now),
                _ if self.is_shaking_hands() => self.ask_again(),
                _ => {
                    self.failed_handshakes = 0;
                    self.begin();
                }
            }
        }
        if self.control_left(now) == Some(0) {
            count(&mut self.health.timeouts);
            if self.settings.allows(self.control_sent.sent) {
                self.send.set(Send::Control);
            } else {
                self.give_up_asking();
            }
        }
        if self.reports_left(now) == Some(0) {
            count(&mut self.health.timeouts);
            self.send.set(Send::Reporting);
        }
    }

    pub(super) fn gap_left(&self, now: u32) -> Option<u32> {
        (self.is.has(Is::Busy)).then(|| left(now, self.arrived_at, self.settings.gap()))
    }

    fn control_left(&self, now: u32) -> Option<u32> {
        let waits = self.is.has(Is::Asking) && !self.send.has(Send::Control);
        waits.then(|| self.control_sent.left(now, self.settings.answer()))
    }

    /// How long the move whose turn it is may still take; without end while the machine holds.
    fn move_left(&self, now: u32) -> Option<u32> {
        (!self.is.has(Is::Paused)).then(|| left(now, self.progressed_at, self.settings.move_timeout()))
    }

    pub(super) fn answer_left(&self, now: u32, since: u32) -> u32 {
        left(now, since, self.settings.answer())
    }

    fn session_left(&self, now: u32) -> Option<u32> {
        match self.stage {
            OPEN | DRAINING if self.window.oldest().is_some() => {
                let due = [self.move_left(now), self.back_left(now), self.hold_left(now), self.probe_left(now)];
                due.into_iter().flatten().min()
            }
            OPEN => None,
            DRAINING => Some(0),
            _ if self.is_shaking_hands() => {
                (!self.send.has(Send::Handshake)).then(|| self.answer_left(now, self.asked_at))
            }
            _ => {
                let waits = self.window.sent == 0 && self.window.has_next();
                (waits && self.asked() != Some(Control::Stop)).then_some(0)
            }
        }
    }

    /// How long until moves may be sent again because of an error: it may be about what was sent again just before.
    fn back_left(&self, now: u32) -> Option<u32> {
        let went_back = self.is.has(Is::WentBack);
        (self.is.has(Is::GoingBack)).then(|| if went_back { self.answer_left(now, self.went_back_at) } else { 0 })
    }

    fn hold_left(&self, now: u32) -> Option<u32> {
        (self.is.has(Is::Held)).then(|| self.answer_left(now, self.held_at))
    }

    fn probe_left(&self, now: u32) -> Option<u32> {
        let waits = self.to_retransmit().is_none() && !self.is.has(Is::Held);
        waits.then(|| {
            let span = self.settings.probe();
            left(now, self.asked_at, span).max(left(now, self.progressed_at, span))
        })
    }

    fn on_session_timer(&mut self, now: u32) {
        let Some(oldest) = self.window.oldest() else {
            // Nothing that was accepted is left.
            self.stage = IDLE;
            return;
        };
        if self.hold_left(now) == Some(0) {
            self.is.clear(Is::Held);
        }
        let is_over = if self.move_left(now) == Some(0) {
            true
        } else if self.back_left(now) == Some(0) {
            self.is.clear(Is::GoingBack);
            self.is.set(Is::WentBack);
            self.went_back_at = now;
            self.cursor = oldest;
            self.gives_up()
        } else if self.probe_left(now) == Some(0) {
            self.send.set(Send::Probe);
            // What only sends numbers back gives no other sign of life.
            self.gives_up() && self.settings.echo == 0
        } else {
            false
        };
        if is_over {
            self.end_session(Outcome::TimedOut, 0);
        }
    }

    fn reports_left(&self, now: u32) -> Option<u32> {
        let waits = self.is.has(Is::Reporting)
            && self.period != 0
            && !self.send.has(Send::Reporting)
            && !self.send.has(Send::Handshake);
        waits.then(|| left(now, self.reports_at, self.settings.answer().saturating_add(self.period.into())))
    }

    /// Something has no answer: counts that, and returns whether it was asked for often enough.
    pub(super) fn gives_up(&mut self) -> bool {
        count(&mut self.health.timeouts);
        self.unanswered = self.unanswered.saturating_add(1);
        !self.settings.allows(self.unanswered)
    }
}
