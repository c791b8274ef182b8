//! The host's end of the link: moves go in, how they ended comes out.
//!
//! A [`Host`] does no I/O: it is fed the bytes that were received and the time, and asked for the bytes to send and for
//! events. [`motion`](super::motion) is the other end.
//!
//! # A session
//!
//! begins before the first move: a request for position reports is sent with a number, and when that has come back,
//! again with a number far from the first. A notice left over from an earlier session can be taken for one answer, not
//! for both. A motion side that has had both keeps numbers in order from there on, and says so: before the second number
//! it sends the first one again. If that does not come, the handshake begins again with other numbers, as the request
//! before may have got lost. (Where the first request was sent more than once, a late answer to it could pass for that.
//! Then the second is sent again behind its answer, and what comes behind that counts.)
//!
//! # A move
//!
//! is sent in the shortest form that leads to it from the one before, with the next number, as soon as fewer than the
//! settings' `window` are unfinished. The motion side takes moves in the order of their numbers only, and ends them in
//! that order. So
//!
//! - a completion says that all moves up to this one are finished; a lost one is made up for by the next;
//! - an error notice that is no final refusal has all unfinished moves sent again, in order, in absolute positions,
//!   since it is not known which one was lost: none is carried out twice, as the motion side knows those it has taken;
//! - when nothing ends for [`Settings::probe_ms`], the newest move is sent again. If one before it was lost, it is
//!   refused; if it was finished, that is sent again; else the position is reported.
//!
//! Ends are reported in the order of the requests, exactly once each. A move that is refused for good takes those
//! behind it along, which never were accepted; the next request begins a new session.
//!
//! # What can be relied on
//!
//! With a motion side that keeps numbers in order, as [`Motion`](super::motion::Motion) does, whatever the line loses,
//! delays or splits, and when the machine stops or this session is begun again on the same line: a move that is
//! reported as finished was carried out once, after those before it, and one that was refused or dropped was not. (With
//! one that only sends numbers back no session begins, and the moves time out, unsent.) There are two exceptions:
//!
//! - A motion side that is switched off and on, or reset, in a session, has to refuse what comes then, which takes
//!   [`only_in_order`](super::motion::Settings::only_in_order); the moves are reported as lost. By default it carries
//!   out again what is sent again, and deltas from where it believes to be.
//! - There are no checksums: where bits flip, or a mask, an ASCII digit or several bytes in a row are lost, another
//!   number or position may come of it, which nothing distinguishes from a true one.

mod commands;
mod handshake;
mod notices;
mod settings;
mod timers;
mod window;

use zerocopy::{FromBytes, FromZeros, Immutable, KnownLayout, TryFromBytes};

use super::encoder::check;
use super::message::{Control, Kind, Numbered, Status};
use super::receiver::NoticeReceiver;
use super::vector::Vector;
use crate::session::{Flags, Transmission, count, flags};
pub use settings::{Health, Settings};
use window::Window;

/// A host session that keeps up to `WINDOW` moves, 1 to 255. All zero is a new session with default settings.
#[derive(Clone, Debug, FromBytes, Immutable, KnownLayout)]
pub struct Host<const WINDOW: usize> {
    settings: Settings,
    health: Health,
    window: Window<WINDOW>,
    /// The last report.
    position: Vector,
    receiver: NoticeReceiver,
    /// When the last bytes came.
    arrived_at: u32,
    /// When the first of what has no answer yet was sent.
    asked_at: u32,
    /// When a move has ended, or the first was sent.
    progressed_at: u32,
    /// When moves were retransmitted because of an error.
    went_back_at: u32,
    /// Since when the motion side has no room.
    held_at: u32,
    /// When reports were asked for, or the last came.
    reports_at: u32,
    /// The number of the handshake's request.
    handshake: u16,
    /// How often the position is to be reported, in milliseconds.
    period: u16,
    /// Number and code of the last error notice.
    error_number: Numbered,
    error_code: u8,
    /// One of the stages below, or of those of the handshake.
    stage: u8,
    pending: Flags<Pending>,
    send: Flags<Send>,
    is: Flags<Is>,
    /// The next of the sent moves to be retransmitted; as many as were sent if there is none.
    cursor: u8,
    /// How often something was sent since the last answer.
    unanswered: u8,
    /// How many handshakes in a row had the second of their requests answered, and the first not again.
    failed_handshakes: u8,
    /// How many moves were sent since the last that named all axes.
    since_absolute: u8,
    /// What is asked for past the queue, as it is written, and when and how often that was sent.
    control: u16,
    control_sent: Transmission,
    /// The last status, as it was written.
    status: u16,
}

/// Why a move was not queued.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QueueError {
    /// As many moves as can be kept have not ended, or their end was not fetched.
    Busy,
    /// It names nothing, or something that is out of its range.
    Range,
}

/// How a move ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, TryFromBytes)]
#[repr(u8)]
pub enum Outcome {
    /// It was carried out.
    Finished = 1,
    /// The motion side did not accept it. It was not carried out.
    Refused = 2,
    /// The motion side accepted it, and has stopped before it was carried out to its end.
    Failed = 3,
    /// It was not begun, since one before it was refused or has failed, or the session ended before it was sent.
    Dropped = 4,
    /// Nothing is known: no answer for too long, or it lasted too long.
    TimedOut = 5,
    /// Nothing is known: the motion side was restarted, or does not take this for a session any more.
    Lost = 6,
    /// A damaged command was carried out, says the check. The next is sent in positions of all axes, which corrects it.
    Deviated = 7,
}

/// Something that happened in a host session.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event<'a> {
    /// The position was reported.
    Report(&'a Vector),
    /// An error notice came, with this code, about the command with this number if it had one. The session handles it.
    Error(u8, Option<u16>),
    /// A session has begun.
    Begun,
    /// The oldest of the moves whose ends were not fetched has ended. The code is that of the error notice, or 0.
    Ended(Outcome, u8),
    /// A report that does not fit what was requested: the next move corrects that.
    Drift(&'a Vector),
    /// The status came: by request, or since the machine holds or goes on.
    Status(Status),
    /// The machine was stopped there, and forgot all moves; the velocity is the one in force.
    Stopped(&'a Vector),
    /// What was asked for past the queue got no answer, or was refused.
    Unanswered(Control),
}

/// No session. (Anything that is none of the others is that too.)
const IDLE: u8 = 0;
const OPEN: u8 = 1;
/// Something was refused: what was accepted before is waited for.
const DRAINING: u8 = 2;

flags! {
    /// The events that wait to be fetched before the ends of moves, in this order.
    enum Pending { Begun, Report, Drift, Stopped, Error, Status, Unanswered }
}

flags! {
    /// What is to be sent besides moves.
    enum Send { Handshake, Reporting, Probe, Control }
}

flags! {
    /// What else is the case.
    enum Is {
        /// The line was not quiet since bytes came.
        Busy,
        /// Not all bytes were taken, so that it is too early for timers.
        Partial,
        /// Moves are to be retransmitted because of an error.
        GoingBack,
        /// They were in this session, so that the next error may be about what was on its way then.
        WentBack,
        /// The motion side has no room.
        Held,
        /// Reports were asked for, or not any more.
        Reporting,
        /// A session was begun before.
        Used,
        /// The request of the handshake was sent more than once.
        Repeated,
        /// An answer to what was asked for past the queue is waited for.
        Asking,
        /// The machine holds.
        Paused,
        /// The machine is not where it should be, until the next move.
        OffPlan,
        /// A confirmation did not fit, and was not that of the oldest move.
        Suspect,
    }
}

impl<const WINDOW: usize> Host<WINDOW> {
    /// A session that has just begun.
    pub fn new(settings: Settings) -> Self {
        const { assert!(1 <= WINDOW && WINDOW <= 255, "the window must hold 1 to 255 moves") };
        Self { settings, ..Self::new_zeroed() }
    }

    /// Replaces the settings. For a session that has just begun.
    pub const fn set(&mut self, settings: Settings) {
        self.settings = settings;
    }

    /// Requests a move behind those requested before. Axes that it does not name stay where they are; without a
    /// velocity, that of the move before holds.
    pub fn move_to(&mut self, target: &Vector) -> Result<(), QueueError> {
        check(target, false).map_err(|_| QueueError::Range)?;
        if self.window.push(target) { Ok(()) } else { Err(QueueError::Busy) }
    }

    /// Requests that the position be reported each so many milliseconds; 0: not any more. If no reports come, they are
    /// asked for again.
    pub fn report(&mut self, period: u16) {
        self.period = period;
        self.is.set(Is::Reporting);
        self.send.set(Send::Reporting);
    }

    /// Asks for something past the queue, in place of what was asked for before, until it is answered: by
    /// [`Event::Status`] or, after a stop, [`Event::Stopped`]. A stop drops what was not sent; the other moves end when
    /// the motion side says how.
    pub fn control(&mut self, control: Control) {
        self.control = control.bits();
        self.control_sent.sent = 0;
        self.send.set(Send::Control);
        self.is.set(Is::Asking);
        if control == Control::Stop && !matches!(self.stage, OPEN | DRAINING) {
            self.end_session(Outcome::Dropped, 0);
        }
    }

    fn asked(&self) -> Option<Control> {
        Control::of(self.control).filter(|_| self.is.has(Is::Asking))
    }

    /// How many moves were requested whose ends were not fetched.
    pub const fn unfinished(&self) -> u8 {
        self.window.count
    }

    /// How the link does.
    pub const fn health(&self) -> &Health {
        &self.health
    }

    /// Takes received bytes; returns how many: fewer than all when events have to be fetched first.
    pub fn receive(&mut self, input: &[u8], now: u32) -> usize {
        let mut rest = input;
        while !rest.is_empty() && self.pending.is_empty() {
            let (taken, kind) = self.receiver.receive(rest);
            let (read, unread) = rest.split_at_checked(taken).unwrap_or((rest, &[]));
            rest = unread;
            match kind {
                Some(Kind::Completed) if is_torn(read, unread) => count(&mut self.health.malformed),
                Some(kind) => self.handle(kind, now),
                None => {}
            }
        }
        let taken = input.len().wrapping_sub(rest.len());
        if taken != 0 {
            self.arrived_at = now;
            self.is.set(Is::Busy);
        }
        self.is.set_to(Is::Partial, !rest.is_empty());
        taken
    }

    /// The next event; `None` when nothing has happened.
    pub fn poll(&mut self, now: u32) -> Option<Event<'_>> {
        if self.pending.is_empty() && self.gap_left(now) == Some(0) {
            self.is.clear(Is::Busy);
            if let Some(kind) = self.receiver.idle() {
                self.handle(kind, now);
            }
        }
        // What was received already may end what would time out.
        if self.pending.is_empty() && !self.is.has(Is::Partial) {
            self.on_timer(now);
        }
        let Some(pending) = self.pending.take_first() else {
            let Some((outcome, code)) = self.window.take_ended() else {
                self.is.clear(Is::Partial);
                return None;
            };
            self.cursor = self.cursor.saturating_sub(1);
            return Some(Event::Ended(outcome, code));
        };
        Some(match pending {
            Pending::Begun => Event::Begun,
            Pending::Report => Event::Report(&self.position),
            Pending::Drift => Event::Drift(&self.position),
            Pending::Stopped => Event::Stopped(&self.position),
            Pending::Error => Event::Error(self.error_code, self.error_number.get().map(|number| number.value)),
            Pending::Status => Event::Status(Status::of(self.status)),
            Pending::Unanswered => Event::Unanswered(Control::of(self.control).unwrap_or(Control::Query)),
        })
    }
}

/// Whether a packed byte stands directly behind a number: then an error notice has lost its `?`, and says anything but
/// that the move was carried out.
fn is_torn(read: &[u8], unread: &[u8]) -> bool {
    !matches!(read, [.., b'\r' | b'\n']) && unread.first().is_some_and(|byte| *byte >= 0x80)
}

#[cfg(test)]
mod tests {
    use super::{Event, Host, Outcome, Settings};
    use crate::gx::{ENCODED_MAX, Vector};

    /// The host was busy elsewhere until the move's time was over, and its end lies behind a report.
    #[test]
    fn time_is_not_over_while_bytes_are_left() {
        let mut host = Host::<4>::new(Settings { move_ms: 500, ..Settings::default() });
        for _ in 0..2 {
            assert_eq!(host.move_to(&Vector { mask: 1, ..Vector::new() }), Ok(()));
        }
        for answer in [&b""[..], b"#0\n", b"#0\n#5461\n"] {
            host.receive(answer, 0);
            while host.poll(0).is_some() {}
            while host.output(&mut [0; ENCODED_MAX], 0) != 0 {}
        }
        let (first, last) = (&b"#5462\n=x0\n"[..], &b"#5463\n"[..]);
        assert_eq!(host.receive(&[first, last].concat(), 600), first.len());
        assert!(matches!(host.poll(1200), Some(Event::Report(_))));
        assert_eq!(host.poll(1200), Some(Event::Ended(Outcome::Finished, 0)));
        assert_eq!(host.poll(1200), None);
        assert_eq!(host.receive(last, 1200), last.len());
        assert_eq!(host.poll(1200), Some(Event::Ended(Outcome::Finished, 0)));
        assert_eq!(host.poll(1200), None);
    }
}
