//! What the time brings about: beginning, asking again, giving up.

use core::ffi::c_ulong;

use super::{DRAINING, Host, IDLE, OPEN, Outcome};
use super::{IS_BACK, IS_BUSY, IS_HELD, IS_REPORTING, IS_WARY, SEND_OPENING, SEND_PROBE, SEND_REPORTING};
use crate::clock::{left, stamp};
use crate::counter::count;

impl Host {
    /// How many milliseconds may pass until [`poll`](Self::poll) has something to do without having received anything;
    /// `None` when only receiving or a request brings anything about. To be asked when there are no events left.
    #[must_use]
    pub fn next_deadline(&self, now: u32) -> Option<u32> {
        if self.tell != 0 || self.window.has_ended() || self.has_output() {
            return Some(0);
        }
        [self.gap_left(now), self.session_left(now), self.reports_left(now)].into_iter().flatten().min()
    }

    fn has_output(&self) -> bool {
        self.send & (SEND_OPENING | SEND_REPORTING) != 0 || self.to_repeat().is_some() || self.may_send()
    }

    /// Does what is due. Nothing that was received is left to be looked at.
    pub(super) fn look_at_the_time(&mut self, now: u32) {
        if self.session_left(now) == Some(0) {
            match self.stage {
                OPEN | DRAINING => self.look_after(now),
                _ if self.is_opening() => self.ask_again(),
                _ => {
                    self.doubts = 0;
                    self.begin();
                }
            }
        }
        if self.reports_left(now) == Some(0) {
            count(&mut self.health.timeouts);
            self.send |= SEND_REPORTING;
        }
    }

    pub(super) fn gap_left(&self, now: u32) -> Option<u32> {
        (self.is & IS_BUSY != 0).then(|| left(now, self.arrived_at, self.settings.gap()))
    }

    pub(super) fn answer_left(&self, now: u32, since: c_ulong) -> u32 {
        left(now, since, self.settings.answer())
    }

    fn session_left(&self, now: u32) -> Option<u32> {
        match self.stage {
            OPEN | DRAINING if self.window.oldest().is_some() => {
                let patience = left(now, self.progressed_at, self.settings.patience());
                let due = [self.back_left(now), self.hold_left(now), self.probe_left(now)];
                due.into_iter().flatten().min().map_or(Some(patience), |due| Some(due.min(patience)))
            }
            OPEN => None,
            DRAINING => Some(0),
            _ if self.is_opening() => (self.send & SEND_OPENING == 0).then(|| self.answer_left(now, self.asked_at)),
            _ => self.window.waits().then_some(0),
        }
    }

    /// How long until moves may be sent again because of an error: it may be about what was sent again just before.
    fn back_left(&self, now: u32) -> Option<u32> {
        let wary = self.is & IS_WARY != 0;
        (self.is & IS_BACK != 0).then(|| if wary { self.answer_left(now, self.went_back_at) } else { 0 })
    }

    fn hold_left(&self, now: u32) -> Option<u32> {
        (self.is & IS_HELD != 0).then(|| self.answer_left(now, self.held_at))
    }

    fn probe_left(&self, now: u32) -> Option<u32> {
        let waits = self.to_repeat().is_none() && self.is & IS_HELD == 0;
        waits.then(|| {
            let span = self.settings.probe();
            left(now, self.asked_at, span).max(left(now, self.progressed_at, span))
        })
    }

    fn look_after(&mut self, now: u32) {
        let Some(oldest) = self.window.oldest() else {
            // Nothing that was accepted is left.
            self.stage = IDLE;
            return;
        };
        if self.hold_left(now) == Some(0) {
            self.is &= !IS_HELD;
        }
        let is_over = if left(now, self.progressed_at, self.settings.patience()) == 0 {
            true
        } else if self.back_left(now) == Some(0) {
            self.is &= !IS_BACK;
            self.is |= IS_WARY;
            self.went_back_at = stamp(now);
            self.cursor = oldest;
            self.gives_up()
        } else if self.probe_left(now) == Some(0) {
            self.send |= SEND_PROBE;
            self.gives_up()
        } else {
            false
        };
        if is_over {
            self.end_session(Outcome::TimedOut, 0);
        }
    }

    fn reports_left(&self, now: u32) -> Option<u32> {
        let waits = self.is & IS_REPORTING != 0 && self.period != 0 && self.send & (SEND_REPORTING | SEND_OPENING) == 0;
        waits.then(|| left(now, self.reports_at, self.settings.answer().saturating_add(self.period.into())))
    }

    /// Something has no answer: counts that, and tells whether it was asked for often enough.
    pub(super) fn gives_up(&mut self) -> bool {
        count(&mut self.health.timeouts);
        self.unanswered = self.unanswered.saturating_add(1);
        !self.settings.allows(self.unanswered)
    }
}
