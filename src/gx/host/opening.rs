//! How a session begins: see [`host`](super).

use core::ffi::c_uchar;

use super::event::{Outcome, TELL_BEGUN};
use super::{Host, IS_BACK, IS_HELD, IS_USED, IS_WARY, OPEN, SEND_OPENING, SEND_PROBE};
use crate::counter::count;
use crate::gx::NUMBER_MAX;
use crate::gx::motion::STRIDE;

// Stages of a host, besides those that it names itself.

/// The number of the first request is waited for.
pub(super) const FIRST: c_uchar = 3;
/// That of the first again, and behind it that of the second.
pub(super) const SECOND: c_uchar = 4;
/// That of the first has come again, and no other since.
pub(super) const ECHOED: c_uchar = 5;

impl Host {
    pub(super) const fn is_opening(&self) -> bool {
        matches!(self.stage, FIRST..=ECHOED)
    }

    /// Asks for a session, with a number that was not used lately.
    pub(super) fn begin(&mut self) {
        let number = match self.is & IS_USED {
            0 => self.settings.first_number(),
            _ => self.opening.wrapping_add(STRIDE),
        };
        self.is |= IS_USED;
        self.ask(FIRST, number);
    }

    fn ask(&mut self, stage: c_uchar, number: u16) {
        self.stage = stage;
        self.opening = number & NUMBER_MAX;
        self.unanswered = 0;
        self.send |= SEND_OPENING;
    }

    /// There was no answer.
    pub(super) fn ask_again(&mut self) {
        if self.gives_up() {
            self.never_opens();
        } else {
            self.send |= SEND_OPENING;
        }
    }

    /// A number came back; `false` if it says nothing.
    pub(super) fn echoed(&mut self, number: u16) -> bool {
        let is_this = number == self.opening;
        match self.stage {
            FIRST if is_this => self.ask(SECOND, number.wrapping_add(STRIDE)),
            ECHOED if is_this => self.opens(),
            SECOND if is_this => self.doubts_order(),
            SECOND | ECHOED if number == self.opening.wrapping_sub(STRIDE) & NUMBER_MAX => self.stage = ECHOED,
            ECHOED => {
                self.stage = SECOND;
                return false;
            }
            _ => return false,
        }
        true
    }

    fn opens(&mut self) {
        self.stage = OPEN;
        self.window.begin(self.opening);
        (self.cursor, self.unanswered) = (0, 0);
        self.is &= !(IS_BACK | IS_HELD | IS_WARY);
        self.send &= !SEND_PROBE;
        self.tell |= TELL_BEGUN;
        count(&mut self.health.sessions);
    }

    /// The motion side has not had the first request, or keeps no order.
    fn doubts_order(&mut self) {
        self.doubts = self.doubts.saturating_add(1);
        if self.settings.allows(self.doubts) {
            self.begin();
        } else {
            self.never_opens();
        }
    }

    /// No session can be had.
    fn never_opens(&mut self) {
        self.window.end(0, self.window.len(), Outcome::TimedOut, 0);
        self.end_session(Outcome::TimedOut, 0);
    }
}
