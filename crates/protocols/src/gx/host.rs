//! The host's end of the link: moves go in, how they ended comes out.
//!
//! A [`Host`] does no I/O: it is fed the bytes that were received and the time, and asked for the bytes to send and for
//! events. How the motion side sees it is told in [`motion`](super::motion).
//!
//! # A session
//!
//! begins before the first move: a request for position reports is sent with a number, until that comes back, and once
//! more with a number far from the first. A notice left over from an earlier session can be taken for the one answer or
//! the other, not for both, so when the second has come, no older notice can come any more. A motion side that has had
//! both keeps numbers in order from there on, and says so: before the second number it sends the first one back again.
//! If that does not come, the request before may have got lost, and all begins anew with other numbers. Else the motion
//! side expects the next number, and from here on the moves are numbered. (Where the first request was sent more than
//! once, a late answer to it could pass for that. Then the second is sent again behind its answer, and what comes
//! behind that counts.)
//!
//! # A move
//!
//! is sent in the shortest form that leads to it from the one before, as soon as fewer than the settings' `window`
//! are unfinished. The motion side takes moves in the order of their numbers only, and ends them in that order. So
//!
//! - a completion says that all moves up to this one are finished; a lost one is made up for by the next;
//! - an error notice that is no final refusal has all unfinished moves sent again, in order, in absolute positions,
//!   since it is not known which one was lost: none is carried out twice, as the motion side knows those it has taken;
//! - the same when notices and commands were lost: when nothing ends for [`Settings::probe_ms`], the newest move is
//!   sent again. If one before it was lost, it is refused; if it was finished, that is told again; else the position is
//!   reported.
//!
//! Ends are told in the order of the requests, exactly once each. A move that is refused for good takes those behind it
//! along, which never were accepted; the next request begins a new session.
//!
//! # What can be relied on
//!
//! All this takes a motion side that keeps the numbers in order, as [`Motion`](super::motion::Motion) does. With one
//! that only sends them back no session begins, and the moves time out, unsent.
//!
//! Whatever the line loses, delays or splits, and when the machine stops or this session is begun anew on the same
//! line: a move that is reported as finished was carried out once, after those before it, and one that was refused or
//! dropped was not. There are two exceptions:
//!
//! - A motion side that is switched off and on, or reset, in a session, has to refuse what comes then, which takes
//!   [`only_in_order`](super::motion::Settings::only_in_order); the moves are reported as lost. By default it takes
//!   moves from anybody: it carries out again what is sent again, and deltas from where it believes to be.
//! - Notices and commands that are forged. There are no checksums: where bits flip, or a mask, an ASCII digit or
//!   several bytes in a row are lost, another number or position may come of it, which nobody can tell from a true one.

mod event;
mod health;
mod incoming;
mod opening;
mod output;
mod settings;
mod timers;
mod window;

use core::ffi::{c_uchar, c_ulong, c_ushort};

use super::encoder::check;
use super::{Item, Message, NoticeReceiver, Vector};
use crate::clock::stamp;
use crate::counter::count;
pub use event::{Event, Outcome};
use event::{TELL_BEGUN, TELL_ERROR, TELL_REPORT};
pub use health::Health;
pub use settings::Settings;
pub use window::{Requested, Window};

/// A host session. Its fields are private; all zero is a new session with default settings.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Host {
    settings: Settings,
    health: Health,
    window: Window,
    /// The last report.
    position: Vector,
    receiver: NoticeReceiver,
    /// When the last bytes came.
    arrived_at: c_ulong,
    /// When the first of what has no answer yet was sent; when a move has ended, or the first was sent; when moves were
    /// sent again because of an error; since when the motion side has no room.
    asked_at: c_ulong,
    progressed_at: c_ulong,
    went_back_at: c_ulong,
    held_at: c_ulong,
    /// When reports were asked for, or the last came.
    reports_at: c_ulong,
    /// The number of the request that begins a session.
    opening: c_ushort,
    /// How often the position is to be reported, in milliseconds.
    period: c_ushort,
    /// The number in the last error notice.
    error_number: c_ushort,
    /// Its code, and whether it has a number.
    error_code: c_uchar,
    error_numbered: c_uchar,
    /// One of the stages below, or of those in which a session is begun.
    stage: c_uchar,
    /// What is to be sent, and what is to be told: bits of `SEND_*` and `TELL_*`.
    send: c_uchar,
    tell: c_uchar,
    /// What else is the case: bits of `IS_*`.
    is: c_uchar,
    /// The next of the sent moves to be sent again; as many as were sent if there is none.
    cursor: c_uchar,
    /// How often something was sent since the last answer.
    unanswered: c_uchar,
    /// How often in a row the second of the requests that begin a session was answered, and the first not again.
    doubts: c_uchar,
}

/// Why a move was not queued.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QueueError {
    /// As many moves as can be kept have not ended, or their end was not fetched.
    Busy,
    /// It names nothing, or something that is out of its range.
    Range,
}

/// No session. (Anything that is none of the others is that too.)
const IDLE: c_uchar = 0;
const OPEN: c_uchar = 1;
/// Something was refused: what was accepted before is waited for.
const DRAINING: c_uchar = 2;

const SEND_OPENING: c_uchar = 1;
const SEND_REPORTING: c_uchar = 2;
const SEND_PROBE: c_uchar = 4;

/// The line was not quiet since bytes came.
const IS_BUSY: c_uchar = 1;
/// Moves are to be sent again.
const IS_BACK: c_uchar = 2;
/// The motion side has no room.
const IS_HELD: c_uchar = 4;
/// Reports were asked for, or not any more.
const IS_REPORTING: c_uchar = 8;
/// A session was begun before.
const IS_USED: c_uchar = 16;
/// Moves were sent again because of an error in this session.
const IS_WARY: c_uchar = 32;
/// The request that begins a session was sent more than once.
const IS_REPEATED: c_uchar = 64;
/// Not all bytes were taken, so that it is too early to look at the time.
const IS_PARTIAL: c_uchar = 128;

impl Host {
    /// A session that has just begun.
    #[must_use]
    pub const fn new(settings: Settings) -> Self {
        Self {
            settings,
            health: Health::new(),
            window: Window::new(),
            position: Vector::new(),
            receiver: NoticeReceiver::new(),
            arrived_at: 0,
            asked_at: 0,
            progressed_at: 0,
            went_back_at: 0,
            held_at: 0,
            reports_at: 0,
            opening: 0,
            period: 0,
            error_number: 0,
            error_code: 0,
            error_numbered: 0,
            stage: IDLE,
            send: 0,
            tell: 0,
            is: 0,
            cursor: 0,
            unanswered: 0,
            doubts: 0,
        }
    }

    /// Replaces the settings. For a session that has just begun.
    pub fn set(&mut self, settings: &Settings) {
        self.settings.answer_ms = settings.answer_ms;
        self.settings.probe_ms = settings.probe_ms;
        self.settings.move_ms = settings.move_ms;
        self.settings.gap_ms = settings.gap_ms;
        self.settings.attempts = settings.attempts;
        self.settings.window = settings.window;
        self.settings.ascii = settings.ascii;
        self.settings.first_number = settings.first_number;
    }

    /// Requests a move behind those requested before. Axes that it does not name stay where they are; without a
    /// velocity, that of the move before holds.
    ///
    /// # Errors
    ///
    /// See [`QueueError`].
    pub fn move_to(&mut self, target: &Vector) -> Result<(), QueueError> {
        check(target, false).map_err(|_| QueueError::Range)?;
        if !self.window.has_room() {
            return Err(QueueError::Busy);
        }
        self.window.push(target);
        Ok(())
    }

    /// Requests that the position be reported each so many milliseconds; 0: not any more. Holds until something else is
    /// requested: if no reports come, it is asked for again.
    pub fn report(&mut self, period: u16) {
        self.period = period;
        self.is |= IS_REPORTING;
        self.send |= SEND_REPORTING;
    }

    /// How many moves were requested whose ends have not been told.
    #[must_use]
    pub const fn unfinished(&self) -> u8 {
        self.window.len()
    }

    /// How the link does.
    #[must_use]
    pub const fn health(&self) -> &Health {
        &self.health
    }

    /// Takes received bytes, and tells how many: fewer than all when events have to be fetched first.
    pub fn receive(&mut self, input: &[u8], now: u32) -> usize {
        let mut rest = input;
        while !rest.is_empty() && self.tell == 0 {
            let mut item = Item::new();
            let taken = self.receiver.receive(rest, &mut item);
            let (read, unread) = rest.split_at_checked(taken).unwrap_or((rest, &[]));
            rest = unread;
            if item.message() == Some(Message::Completed) && incoming::is_torn(read, unread) {
                count(&mut self.health.malformed);
            } else if self.look_at(&item, now).is_none() && taken == 0 {
                break;
            }
        }
        let taken = input.len().wrapping_sub(rest.len());
        if taken != 0 {
            self.arrived_at = stamp(now);
            self.is |= IS_BUSY;
        }
        self.is &= !IS_PARTIAL;
        if !rest.is_empty() {
            self.is |= IS_PARTIAL;
        }
        taken
    }

    /// The next event; `None` when nothing has happened.
    pub fn poll(&mut self, now: u32) -> Option<Event<'_>> {
        if self.tell == 0 && self.gap_left(now) == Some(0) {
            self.is &= !IS_BUSY;
            let mut item = Item::new();
            self.receiver.idle(&mut item);
            self.look_at(&item, now);
        }
        // What was received already may end what would time out.
        if self.tell == 0 && self.is & IS_PARTIAL == 0 {
            self.look_at_the_time(now);
        }
        // The lowest bit.
        let next = self.tell & self.tell.wrapping_neg();
        self.tell ^= next;
        match next {
            TELL_BEGUN => Some(Event::Begun),
            TELL_REPORT => Some(Event::Report(&self.position)),
            TELL_ERROR => {
                let number = (self.error_numbered != 0).then_some(self.error_number);
                Some(Event::Error(self.error_code, number))
            }
            _ => {
                let Some((outcome, code)) = self.window.take_ended() else {
                    self.is &= !IS_PARTIAL;
                    return None;
                };
                self.cursor = self.cursor.saturating_sub(1);
                Some(Event::Ended(outcome, code))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Event, Host, Outcome, Settings};
    use crate::gx::{ENCODED_MAX, Vector};

    /// The host was busy elsewhere until the move's time was over, and its end lies behind a report.
    #[test]
    fn time_is_not_over_while_bytes_are_left() {
        let mut host = Host::new(Settings { move_ms: 500, ..Settings::new() });
        for _ in 0..2 {
            assert_eq!(host.move_to(&Vector { mask: 1, ..Vector::new() }), Ok(()));
        }
        for answer in [&b""[..], b"#0\n", b"#0\n#5461\n"] {
            host.receive(answer, 0);
            while host.poll(0).is_some() {}
            while host.output(&mut [0; ENCODED_MAX], ENCODED_MAX, 0) != 0 {}
        }
        let (first, last) = (&b"#5462\n=x1\n"[..], &b"#5463\n"[..]);
        assert_eq!(host.receive(&[first, last].concat(), 600), first.len());
        assert!(matches!(host.poll(1200), Some(Event::Report(_))));
        assert_eq!(host.poll(1200), Some(Event::Ended(Outcome::Finished, 0)));
        assert_eq!(host.poll(1200), None);
        assert_eq!(host.receive(last, 1200), last.len());
        assert_eq!(host.poll(1200), Some(Event::Ended(Outcome::Finished, 0)));
        assert_eq!(host.poll(1200), None);
    }
}
