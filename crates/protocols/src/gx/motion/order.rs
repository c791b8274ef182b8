//! Which numbered command is the next, if numbers are in order at all.

use zerocopy::{FromBytes, Immutable, KnownLayout};

use crate::gx::{Fault, NUMBER_MAX, Numbered};

/// How far the numbers of the two requests that begin a session lie apart: a third of all numbers, which is more than
/// those of left-over notices do, whichever way round.
pub(in crate::gx) const STRIDE: u16 = 5461;

/// The order of numbers at the motion side; all zero: none is kept.
#[derive(Clone, Debug, FromBytes, Immutable, KnownLayout)]
#[repr(C)]
pub(super) struct Order {
    /// One of the stages below.
    stage: u8,
    /// Whether nothing was taken since the last one was refused.
    refusing: u8,
    /// Whether the last request for reports came directly behind the one whose number lies a stride before.
    paired: u8,
    /// One more than the number of that request; 0: another command has come since.
    asked: u16,
    /// The number that the next command has to have.
    next: u16,
    /// The number that was refused last.
    refused: u16,
}

/// Numbers mean nothing.
const FREE: u8 = 0;
/// A session: they are in order.
const OPEN: u8 = 1;
/// A session has ended, and its host may not know yet. (Anything else is that too.)
const OVER: u8 = 2;

/// What a number says about a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// It is the next.
    Next,
    /// It was taken before.
    Repeat,
    /// It can't be taken, for this reason.
    Refuse(Fault),
}

/// What a numbered request for reports begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Begun {
    /// Nothing.
    None,
    /// A session; what came before this request is not known.
    Alone,
    /// A session, behind a request with this number.
    Behind(u16),
}

impl Order {
    /// A host asks for reports, with a number. Where an order is kept already, or has to be (`only`), that begins a
    /// session by itself.
    pub(super) fn ask(&mut self, number: u16, only: bool) -> Begun {
        let before = number.wrapping_sub(STRIDE) & NUMBER_MAX;
        // It may be asked for again, when the answer was lost.
        let again = self.asked == number.wrapping_add(1) && self.paired != 0;
        let paired = again || self.asked == before.wrapping_add(1);
        self.asked = number.wrapping_add(1);
        self.paired = paired.into();
        if !paired && !only && self.stage == FREE {
            return Begun::None;
        }
        self.next = number.wrapping_add(1) & NUMBER_MAX;
        self.stage = OPEN;
        self.refusing = 0;
        if paired { Begun::Behind(before) } else { Begun::Alone }
    }

    /// Whether a session was begun that nobody has closed.
    pub(super) const fn is_session(&self) -> bool {
        self.stage != FREE
    }

    /// Whether that is the number that was taken last.
    pub(super) const fn was_last(&self, number: Numbered) -> bool {
        number.is_some() && self.ahead(number.value()) == NUMBER_MAX
    }

    /// Something else has come.
    pub(super) const fn forget(&mut self) {
        self.asked = 0;
    }

    /// A session can't go on. What its host has sent meanwhile is not to be taken for anything else.
    pub(super) const fn stop(&mut self) {
        if self.stage == OPEN {
            self.stage = OVER;
        }
    }

    /// No order is kept any more.
    pub(super) const fn close(&mut self) {
        self.asked = 0;
        self.stage = FREE;
    }

    /// `only`: moves are taken in a session only.
    pub(super) const fn judge(&self, number: Numbered, only: bool) -> Verdict {
        if self.stage == FREE && !only {
            return Verdict::Next;
        }
        if !number.is_some() {
            return Verdict::Refuse(Fault::Numberless);
        }
        if self.stage != OPEN {
            return Verdict::Refuse(Fault::Closed);
        }
        match self.ahead(number.value()) {
            0 => Verdict::Next,
            // Of the two ways round, the shorter one.
            ahead if ahead <= NUMBER_MAX / 2 => Verdict::Refuse(Fault::Order),
            _ => Verdict::Repeat,
        }
    }

    /// The next command was taken.
    pub(super) const fn taken(&mut self) {
        self.next = self.next.wrapping_add(1) & NUMBER_MAX;
        self.refusing = 0;
    }

    /// A command is refused: whether that needs an error notice. Those that follow a refused one in a session don't, as
    /// none of them can be taken; unless the host has gone back already, and this one is out of order again.
    pub(super) const fn refuses(&mut self, number: u16) -> bool {
        let needs_notice = self.refusing == 0 || self.stage != OPEN || self.ahead(number) <= self.ahead(self.refused);
        self.refusing = 1;
        self.refused = number;
        needs_notice
    }

    const fn ahead(&self, number: u16) -> u16 {
        number.wrapping_sub(self.next) & NUMBER_MAX
    }
}

#[cfg(test)]
mod tests {
    use super::Verdict::{self, Next, Refuse, Repeat};
    use super::{Begun, Order};
    use crate::gx::{Fault, Format, Numbered};
    use zerocopy::FromZeros;

    fn judge<const N: usize>(order: &Order, only: bool, numbers: [Option<u16>; N]) -> [Verdict; N] {
        let number = |value| Numbered::new(value, Format::Ascii);
        numbers.map(|value| order.judge(value.map_or(Numbered::NONE, number), only))
    }

    /// A session whose first move has the number behind this one.
    fn begun(number: u16) -> Order {
        let mut order = Order::new_zeroed();
        assert_eq!(order.ask(number, true), Begun::Alone);
        order
    }

    #[test]
    fn numbers_count_once_begun_and_wrap() {
        let [order_error, closed, numberless] = [Fault::Order, Fault::Closed, Fault::Numberless].map(Refuse);
        let mut order = begun(16382);
        let verdicts = judge(&order, false, [None, Some(16383), Some(0), Some(16382)]);
        assert_eq!(verdicts, [numberless, Next, order_error, Repeat]);
        order.taken();
        let verdicts = judge(&order, false, [0, 16383, 16380, 8191, 8192].map(Some));
        assert_eq!(verdicts, [Next, Repeat, Repeat, order_error, Repeat]);
        order.stop();
        assert_eq!(judge(&order, false, [Some(0), None]), [closed, numberless]);
        order.close();
        assert_eq!(judge(&order, false, [Some(0), None]), [Next, Next]);
        assert_eq!(judge(&order, true, [Some(0), None]), [closed, numberless]);
        order.stop();
        assert_eq!(judge(&order, false, [Some(0)]), [Next]);
    }

    #[test]
    fn two_requests_begin() {
        let mut order = Order::new_zeroed();
        for (number, begun) in [
            (12, Begun::None),
            (12, Begun::None),
            (5474, Begun::None),
            (13, Begun::None),
            (5474, Begun::Behind(13)),
            (5474, Begun::Behind(13)),
            // In a session one is enough.
            (5474 + 5460, Begun::Alone),
            (11, Begun::Behind(10934)),
        ] {
            assert_eq!(order.ask(number, false), begun, "{number}");
            assert_eq!(judge(&order, false, [Some(number + 1)]), [Next], "{number}");
        }
        order.close();
        assert_eq!(order.ask(5472, false), Begun::None);
        order.forget();
        assert_eq!(order.ask(10933, false), Begun::None);
        assert_eq!(judge(&order, false, [None]), [Next]);
        assert_eq!(order.ask(10, false), Begun::Behind(10933));
        // After a stop, one is enough too: no other host has come so far.
        order.stop();
        order.forget();
        assert_eq!(order.ask(100, false), Begun::Alone);
        assert_eq!(judge(&order, false, [Some(101)]), [Next]);
    }

    #[test]
    fn of_a_run_of_refused_commands_the_first_is_answered() {
        let mut order = begun(9);
        // The host goes back, and 10 is lost again; then it asks with its newest one.
        let numbers = [11, 12, 14, 11, 12, 12];
        assert_eq!(numbers.map(|number| order.refuses(number)), [true, false, false, true, false, true]);
        order.taken();
        assert!(order.refuses(12));
        order.close();
        assert!(order.refuses(12) && order.refuses(13) && order.refuses(14));
    }
}
