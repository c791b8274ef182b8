//! What a notice means.

use core::ffi::c_uchar;

use super::event::{Outcome, TELL_ERROR, TELL_REPORT};
use super::{DRAINING, Host, IDLE, IS_BACK, IS_HELD, IS_REPORTING, OPEN, SEND_OPENING, SEND_PROBE, SEND_REPORTING};
use crate::clock::stamp;
use crate::counter::count;
use crate::gx::motion::{AXIS, CLOSED, CODE_FREE, STOPPED};
use crate::gx::{Fault, Item, Message};

const BUSY: u8 = Fault::Busy as u8;
const LIMIT: u8 = Fault::Limit as u8;

impl Host {
    /// Deals with what was received, if anything.
    pub(super) fn look_at(&mut self, item: &Item, now: u32) -> Option<()> {
        let number = item.number().map(|number| number.value);
        match item.message()? {
            Message::Completed => self.completed(number.unwrap_or_default(), now),
            Message::Refused(code) => {
                count(&mut self.health.errors);
                self.error_code = code;
                self.error_numbered = c_uchar::from(number.is_some());
                self.error_number = number.unwrap_or_default();
                self.tell |= TELL_ERROR;
                if matches!(self.stage, OPEN | DRAINING) {
                    self.refused(number, code, now);
                }
            }
            Message::Position(position) => {
                count(&mut self.health.reports);
                self.position.copy(position);
                self.tell |= TELL_REPORT;
                if !self.is_opening() {
                    self.unanswered = 0;
                }
                self.reported(now);
            }
            Message::Malformed(_) => count(&mut self.health.malformed),
            _ => (),
        }
        Some(())
    }

    fn completed(&mut self, number: u16, now: u32) {
        count(&mut self.health.completions);
        let is_expected = if self.is_opening() { self.echoed(number) } else { self.finished(number, now) };
        if !is_expected {
            count(&mut self.health.strays);
        }
    }

    /// The moves up to the one with this number have been carried out; `false` if none has it.
    fn finished(&mut self, number: u16, now: u32) -> bool {
        let (OPEN | DRAINING, Some(index)) = (self.stage, self.find_unfinished(number)) else { return false };
        self.window.end(0, index.wrapping_add(1), Outcome::Finished, 0);
        self.progressed_at = stamp(now);
        self.unanswered = 0;
        self.is &= !IS_HELD;
        true
    }

    /// Which of the moves that were sent and have not ended has that number.
    fn find_unfinished(&self, number: u16) -> Option<u8> {
        let oldest = self.window.oldest()?;
        self.window.find(number).filter(|index| *index >= oldest)
    }

    fn refused(&mut self, number: Option<u16>, code: u8, now: u32) {
        let Some(number) = number else {
            self.is |= IS_BACK;
            return;
        };
        let Some(index) = self.find_unfinished(number) else {
            count(&mut self.health.strays);
            return;
        };
        match code {
            BUSY => {
                // It has taken those before, so it is there.
                self.unanswered = 0;
                self.cursor = index;
                self.held_at = stamp(now);
                self.is |= IS_HELD;
            }
            CLOSED => self.end_session(Outcome::Lost, code),
            STOPPED | CODE_FREE.. => {
                self.window.end(0, index, Outcome::Finished, 0);
                self.window.end(index, index.wrapping_add(1), Outcome::Failed, code);
                self.end_session(Outcome::Dropped, code);
            }
            AXIS => self.refuse(index, code),
            LIMIT if self.window.is_absolute(index) => self.refuse(index, code),
            _ => self.is |= IS_BACK,
        }
    }

    fn refuse(&mut self, index: u8, code: u8) {
        self.window.refuse(index, code);
        self.cursor = self.cursor.min(self.window.sent());
        self.stage = DRAINING;
    }

    /// Nothing more is known of what was sent.
    pub(super) fn end_session(&mut self, outcome: Outcome, code: u8) {
        self.window.end_all(outcome, code);
        self.stage = IDLE;
        self.cursor = 0;
        self.send &= !(SEND_OPENING | SEND_PROBE);
    }

    /// A report came.
    fn reported(&mut self, now: u32) {
        if self.period != 0 {
            self.reports_at = stamp(now);
        } else if self.is & IS_REPORTING != 0 && self.answer_left(now, self.reports_at) == 0 {
            self.send |= SEND_REPORTING;
        }
    }
}

/// Whether a packed byte stands directly behind a number: then an error notice has lost its `?`, and says anything but
/// that the move was carried out.
pub(super) fn is_torn(read: &[u8], unread: &[u8]) -> bool {
    !matches!(read, [.., b'\r' | b'\n']) && unread.first().is_some_and(|byte| *byte >= 0x80)
}
