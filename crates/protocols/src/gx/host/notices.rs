//! What a notice means.

use super::{DRAINING, Host, IDLE, Is, OPEN, Outcome, Pending, Send};
use crate::gx::{CODE_FREE, Control, Fault, Kind, NUMBER_MAX, Status};
use crate::session::count;

const BUSY: u8 = Fault::Busy as u8;
const LIMIT: u8 = Fault::Limit as u8;
const CLOSED: u8 = Fault::Closed as u8;
const AXIS: u8 = Fault::Axis as u8;
const STOPPED: u8 = Fault::Stopped as u8;
const UNKNOWN: u8 = Fault::Unknown as u8;

impl<const WINDOW: usize> Host<WINDOW> {
    /// Deals with what the receiver has found.
    pub(super) fn handle(&mut self, kind: Kind, now: u32) {
        let number = self.receiver.number().map(|number| number.value);
        match kind {
            Kind::Completed | Kind::Confirmed => {
                count(&mut self.health.completions);
                let number = number.unwrap_or_default();
                let is_expected = if kind == Kind::Confirmed {
                    self.confirmed(now)
                } else if self.is_shaking_hands() {
                    self.echoed(number)
                } else {
                    self.finished(number, now)
                };
                if !is_expected {
                    count(&mut self.health.strays);
                }
            }
            Kind::Refused => {
                let code = self.receiver.code();
                count(&mut self.health.errors);
                self.error_code = code;
                self.error_number = self.receiver.number;
                self.pending.set(Pending::Error);
                if code == UNKNOWN && number.is_none() && self.asked().is_some() {
                    // A motion side that does not know the extension.
                    self.give_up_asking();
                } else if matches!(self.stage, OPEN | DRAINING) {
                    self.refused(number, code, now);
                }
            }
            Kind::Status => {
                self.status = self.receiver.bits();
                self.pending.set(Pending::Status);
                self.status_came(Status::of(self.status).is_held, now);
            }
            Kind::Position => {
                count(&mut self.health.reports);
                self.position.copy(self.receiver.vector());
                if !self.is_shaking_hands() {
                    self.unanswered = 0;
                }
                self.reported(now);
                if self.position.velocity().is_some() && self.asked() == Some(Control::Stop) {
                    self.is.clear(Is::Asking);
                    self.send.clear(Send::Control);
                    self.is.clear(Is::Paused);
                    self.pending.set(Pending::Stopped);
                    if matches!(self.stage, OPEN | DRAINING) {
                        self.end_session(Outcome::Lost, 0);
                    }
                } else if self.stage == OPEN && !self.is.has(Is::OffPlan) && !self.window.is_on_plan(&self.position) {
                    count(&mut self.health.deviations);
                    self.is.set(Is::OffPlan);
                    self.pending.set(Pending::Drift);
                } else {
                    self.pending.set(Pending::Report);
                }
            }
            // A receiver of notices finds nothing else.
            _ => count(&mut self.health.malformed),
        }
    }

    /// The moves up to the one with this number have been carried out; `false` if none has it.
    fn finished(&mut self, number: u16, now: u32) -> bool {
        let Some(index) = self.window.find(number, NUMBER_MAX) else { return false };
        self.ended(index, Outcome::Finished, Outcome::Finished, now);
        true
    }

    /// A move has ended, and before it those that had not.
    fn ended(&mut self, index: u8, before: Outcome, outcome: Outcome, now: u32) {
        self.window.end(0, index, before, 0);
        self.window.end(index, index.wrapping_add(1), outcome, 0);
        self.progressed_at = now;
        self.unanswered = 0;
        self.is.clear(Is::Held);
    }

    /// A move whose number ends in these bits was carried out, and led where the check says; `false` if none has it.
    fn confirmed(&mut self, now: u32) -> bool {
        let (number, check) = self.receiver.confirmed();
        let Some(index) = self.window.find(number.into(), 0x7F) else { return false };
        let fits = self.window.check(index) == Some(check);
        let was_suspect = self.is.has(Is::Suspect);
        if !fits {
            count(&mut self.health.deviations);
            self.is.set(Is::OffPlan);
            if self.window.oldest() != Some(index) && !was_suspect {
                // It may be the notice that was damaged. If not, the next one does not fit either.
                self.is.set(Is::Suspect);
                return true;
            }
        }
        self.is.clear(Is::Suspect);
        let before = if was_suspect { Outcome::Deviated } else { Outcome::Finished };
        self.ended(index, before, if fits { Outcome::Finished } else { Outcome::Deviated }, now);
        true
    }

    fn status_came(&mut self, is_held: bool, now: u32) {
        self.unanswered = 0;
        if !is_held && self.is.has(Is::Paused) {
            self.progressed_at = now;
            self.is.clear(Is::Paused);
        } else if is_held && self.asked() == Some(Control::Hold) {
            self.is.set(Is::Paused);
        }
        let is_answer = match self.asked() {
            Some(Control::Hold) => is_held,
            Some(Control::Resume) => !is_held,
            Some(Control::Query) => true,
            Some(Control::Stop) | None => false,
        };
        if is_answer {
            self.is.clear(Is::Asking);
            self.send.clear(Send::Control);
        }
    }

    pub(super) fn give_up_asking(&mut self) {
        self.is.clear(Is::Asking);
        self.send.clear(Send::Control);
        self.pending.set(Pending::Unanswered);
    }

    fn refused(&mut self, number: Option<u16>, code: u8, now: u32) {
        let Some(number) = number else {
            self.is.set(Is::GoingBack);
            return;
        };
        let Some(index) = self.window.find(number, NUMBER_MAX) else {
            count(&mut self.health.strays);
            return;
        };
        match code {
            BUSY => {
                // It has taken those before, so it is there.
                self.unanswered = 0;
                self.cursor = index;
                self.held_at = now;
                self.is.set(Is::Held);
            }
            CLOSED => self.end_session(Outcome::Lost, code),
            STOPPED | CODE_FREE.. => {
                self.window.end(0, index, Outcome::Finished, 0);
                self.window.end(index, index.wrapping_add(1), Outcome::Failed, code);
                self.end_session(Outcome::Dropped, code);
            }
            AXIS => self.refuse(index, code),
            LIMIT if self.window.is_absolute(index) => self.refuse(index, code),
            _ => self.is.set(Is::GoingBack),
        }
    }

    /// A move was refused for good: it and those behind it are taken for not sent.
    fn refuse(&mut self, index: u8, code: u8) {
        self.window.end(index, index.wrapping_add(1), Outcome::Refused, code);
        self.window.end(index, self.window.count, Outcome::Dropped, code);
        self.window.sent = index;
        self.cursor = self.cursor.min(index);
        self.stage = DRAINING;
    }

    /// Nothing more is known of what was sent, which ends like this; the other moves are dropped.
    pub(super) fn end_session(&mut self, outcome: Outcome, code: u8) {
        self.window.end(0, self.window.sent, outcome, code);
        self.window.end(self.window.sent, self.window.count, Outcome::Dropped, code);
        self.window.sent = 0;
        self.stage = IDLE;
        self.cursor = 0;
        self.send.clear(Send::Handshake);
        self.send.clear(Send::Probe);
    }

    /// A report came.
    fn reported(&mut self, now: u32) {
        if self.period != 0 {
            self.reports_at = now;
        } else if self.is.has(Is::Reporting) && self.answer_left(now, self.reports_at) == 0 {
            self.send.set(Send::Reporting);
        }
    }
}
