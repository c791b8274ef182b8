//! The host's end of the link: requests go in, outcomes come out.
//!
//! A [`Host`] does no I/O: it is fed the bytes that were received and the time, and asked for the bytes to send and for
//! events. It keeps no queue but the ring: [`poll`](Host::poll) takes one frame out at a time, and the next only when
//! all that the last one meant has been told.
//!
//! # What can be relied on
//!
//! The protocol numbers nothing: an ack says which opcode it answers, not which request. So what a frame means depends
//! on when it was sent, and that is known from two properties of a serial line: it keeps the order of bytes, and what
//! it delivers at all it delivers soon, the answer to a request within [`Settings::guard_ms`]. Where both hold, and no
//! damaged frame passes for an intact one (with a checksum of 8 bits one in some hundred does), each request ends
//! exactly once, and as finished only if it was carried out. One gap remains: that homing was ended by an error, which
//! was cleared while no report got through, shows only if the position is unknown then.
//!
//! # A request
//!
//! is sent, and again when no answer came in [`Settings::ack_ms`], up to [`attempts`](field@Settings::attempts) times.
//! The specification asks for this "depending on the opcode". Here every request is repeated, since carrying one out
//! twice is no harm: a move goes to an absolute position, homing and cancelling end in one state, asking changes
//! nothing. But an operation is not repeated any more once its cancelling was requested, or an error was reported: that
//! would move the robot against the user's will.
//!
//! - Accepted: its ack came. What was received before belongs to an older operation and ends nothing.
//! - Refused: its nack came. After a repeat that may be because the first request, whose ack was lost, is being carried
//!   out: then the state decides.
//! - Unanswered: it has timed out, unless reports of homing or moving, or of standing at the target after having stood
//!   elsewhere, have shown that only the answers are lost. Then it counts as accepted, but its end is believed from
//!   status reports alone.
//!
//! A next operation waits until no answer to the last can come any more, unless that was sent once and accepted and the
//! line does not double frames ([`Settings::doubles`]). A cancel request waits for nothing; answers that may be those
//! of an older one are ignored, and it is repeated.
//!
//! # An accepted operation
//!
//! ends by
//!
//! - `h` or `m` (the specification);
//! - a report of IDLE (shipped firmware), if homing or moving was reported since the ack, or [`Settings::settle_ms`]
//!   has passed: directly behind the ack the motors may not run yet. The operation is finished if the position is known
//!   and, of a move, the target; else it has failed (a controller that was reset is idle too);
//! - a report of ERROR, or `e`: it has failed;
//! - its cancelling: cancelled, as soon as IDLE is reported;
//! - silence, or by lasting too long: timed out.
//!
//! IDLE, `h` and `m` are not believed while a repeat of the request may still be on its way, as that
//! would start the operation again. No harm is done by ignoring an `h`: the status is asked for until the end.
//!
//! ```
//! use deltarobot_protocols::deltarobot::Opcode;
//! use deltarobot_protocols::deltarobot::host::{Event, Host, Outcome, REQUEST_MAX, Settings};
//!
//! let mut host = Host::new(Settings::new());
//! host.home().unwrap();
//! let (mut room, mut payload) = ([0; REQUEST_MAX], [0; 32]);
//! assert_eq!(host.poll(0, &mut payload), None);
//! let length = host.output(&mut room, REQUEST_MAX, 0);
//! assert_eq!(room[..length], *b"$H\0\xA6:");
//!
//! host.receive(b"$A\x01H\xE8:$h\0\xC6:", 5);
//! assert_eq!(host.poll(5, &mut payload), Some(Event::Accepted(Opcode::HOMING)));
//! assert_eq!(host.poll(5, &mut payload), Some(Event::Ended(Opcode::HOMING, Outcome::Finished)));
//! ```

mod event;
mod health;
mod link;
mod operation;
mod request;
mod settings;
mod timers;

use core::ffi::{c_int, c_uchar, c_ulong};

use crate::clock::stamp;
use crate::counter::count;
pub use event::{Event, Outcome};
use event::{TELL_CANCEL_ENDED, TELL_ENDED, TELL_MESSAGE, TELL_STATUS_ENDED};
pub use health::Health;
pub use link::Link;
pub use request::Request;
use request::{FREE, QUEUED};
pub use settings::Settings;

use super::{FRAME_OVERHEAD, Layout, Message, Opcode, PAYLOAD_MAX, POSITION_SIZE, Place, Position, Report};

/// A host session. Its fields are private; all zero is a new session with default settings.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Host {
    settings: Settings,
    health: Health,
    link: Link,
    /// The operation, cancel and status requests.
    operation: Request,
    cancel: Request,
    status: Request,
    /// When the operation was sent first, when it was accepted, when anything was heard last, and when the status was
    /// last reported or asked for.
    started_at: c_ulong,
    accepted_at: c_ulong,
    heard_at: c_ulong,
    polled_at: c_ulong,
    /// What is to be sent, and what is to be told: bits of `SEND_*` and `TELL_*`.
    send: c_int,
    tell: c_int,
    /// What is known of the operation: bits that operation.rs names.
    known: c_int,
    /// The length of the message to be told.
    message_length: c_int,
    /// Opcode and target of the operation.
    opcode: c_uchar,
    target: [c_uchar; 12],
    /// The last status report. `reported` is 0 before the first.
    reported: c_uchar,
    stat: c_uchar,
    position: [c_uchar; 12],
    /// Opcode of the message to be told, and outcomes of the requests to be told.
    message_opcode: c_uchar,
    operation_outcome: c_uchar,
    cancel_outcome: c_uchar,
    status_outcome: c_uchar,
}

/// A request of the kind is going on, or its outcome has not been fetched yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Busy;

/// Bytes of the longest frame that is sent: a move's.
pub const REQUEST_MAX: usize = POSITION_SIZE.wrapping_add(FRAME_OVERHEAD);

const SEND_CANCEL: c_int = 1;
const SEND_OPERATION: c_int = 2;
const SEND_STATUS: c_int = 4;

impl Host {
    /// A session that has just begun.
    #[must_use]
    pub const fn new(settings: Settings) -> Self {
        Self {
            settings,
            health: Health::new(),
            link: Link::new(),
            operation: Request::new(),
            cancel: Request::new(),
            status: Request::new(),
            started_at: 0,
            accepted_at: 0,
            heard_at: 0,
            polled_at: 0,
            send: 0,
            tell: 0,
            known: 0,
            message_length: 0,
            opcode: 0,
            target: [0; POSITION_SIZE],
            reported: 0,
            stat: 0,
            position: [0; POSITION_SIZE],
            message_opcode: 0,
            operation_outcome: 0,
            cancel_outcome: 0,
            status_outcome: 0,
        }
    }

    /// Requests homing.
    ///
    /// # Errors
    ///
    /// [`Busy`] while an operation is going on.
    pub fn home(&mut self) -> Result<(), Busy> {
        self.start(Opcode::HOMING)
    }

    /// Requests a move. The position has to be finite: others are the caller's to refuse.
    ///
    /// # Errors
    ///
    /// [`Busy`] while an operation is going on.
    pub fn move_to(&mut self, target: Position) -> Result<(), Busy> {
        self.start(Opcode::MOVE)?;
        self.target = target.to_wire();
        Ok(())
    }

    fn start(&mut self, opcode: Opcode) -> Result<(), Busy> {
        if !self.operation.is_free() || self.tell & TELL_ENDED != 0 {
            return Err(Busy);
        }
        self.opcode = opcode.0;
        self.known = 0;
        self.operation.queue(self.settings.doubles != 0);
        Ok(())
    }

    /// Requests that the operation going on be cancelled. Without one it is requested all the same, since the
    /// controller may have got one from elsewhere.
    ///
    /// # Errors
    ///
    /// [`Busy`] while this is being requested already.
    pub fn cancel(&mut self) -> Result<(), Busy> {
        if !self.cancel.is_free() || self.tell & TELL_CANCEL_ENDED != 0 {
            return Err(Busy);
        }
        self.cancel.queue(true);
        if self.operation.stage() == QUEUED {
            self.end_operation(Outcome::Cancelled);
        }
        Ok(())
    }

    /// Requests a status report.
    ///
    /// # Errors
    ///
    /// [`Busy`] while one is being requested already.
    pub fn status(&mut self) -> Result<(), Busy> {
        if !self.status.is_free() || self.tell & TELL_STATUS_ENDED != 0 {
            return Err(Busy);
        }
        self.status.queue(false);
        Ok(())
    }

    /// Whether an operation is going on.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        !self.operation.is_free() || self.tell & TELL_ENDED != 0
    }

    /// The last status report, if there was one.
    #[must_use]
    pub fn last_report(&self) -> Option<Report> {
        (self.reported != 0).then(|| Report::new(Position::from_wire(&self.position), self.stat))
    }

    /// How the link does.
    #[must_use]
    pub const fn health(&self) -> &Health {
        &self.health
    }

    /// Takes received bytes, as many as there is room for, and tells how many that were. [`poll`](Self::poll) makes
    /// room.
    pub fn receive(&mut self, input: &[u8], now: u32) -> usize {
        self.link.receive(input, now, &mut self.health)
    }

    /// The next event; `None` when nothing has happened. Of [`Event::Message`], the payload is copied to `data` as
    /// far as that goes; other events change it too.
    pub fn poll<P: Place>(&mut self, now: u32, data: &mut [P]) -> Option<Event> {
        loop {
            if let Some(event) = self.event() {
                return Some(event);
            }
            let layout = match self.settings.layout {
                1 => Layout::Spec,
                2 => Layout::Firmware,
                _ => Layout::Auto,
            };
            let mut head = [0; PAYLOAD_MAX];
            let gap = self.settings.gap();
            let Some((opcode, length)) = self.link.next(now, gap, &mut head, data, &mut self.health) else {
                // Only now: what is received already is no answer to what is sent next, and may end what would time
                // out.
                self.look_at_the_time(now);
                return self.event();
            };
            self.heard_at = stamp(now);
            if self.settings.messages != 0 {
                self.message_opcode = opcode.0;
                // A payload has at most 255 bytes.
                self.message_length = c_int::try_from(length).unwrap_or_default();
                self.tell |= TELL_MESSAGE;
            }
            match &Message::parse(opcode, &head, length, layout) {
                Some(message) => self.understand(message, now),
                None => count(&mut self.health.malformed),
            }
        }
    }

    /// Replaces the settings. For a session that has just begun.
    pub fn set(&mut self, settings: &Settings) {
        // One by one, which never becomes a call of memcpy.
        self.settings.ack_ms = settings.ack_ms;
        self.settings.guard_ms = settings.guard_ms;
        self.settings.settle_ms = settings.settle_ms;
        self.settings.poll_ms = settings.poll_ms;
        self.settings.silence_ms = settings.silence_ms;
        self.settings.operation_ms = settings.operation_ms;
        self.settings.gap_ms = settings.gap_ms;
        self.settings.tolerance = settings.tolerance;
        self.settings.attempts = settings.attempts;
        self.settings.layout = settings.layout;
        self.settings.messages = settings.messages;
        self.settings.doubles = settings.doubles;
    }

    /// Writes the frame of the next request that fits in `room` bytes, and returns its length; 0 when there is none:
    /// three (of 27 bytes together) at most at a time. To be called after [`poll`](Self::poll); `now` is when it
    /// leaves.
    pub fn output(&mut self, frame: &mut [u8; REQUEST_MAX], room: usize, now: u32) -> usize {
        let operation = match self.operation_opcode() {
            Opcode::MOVE => Message::Move(Position::from_wire(&self.target)),
            _ => Message::Homing,
        };
        for (flag, message, request) in [
            (SEND_CANCEL, Message::Cancel, &mut self.cancel),
            (SEND_OPERATION, operation, &mut self.operation),
            (SEND_STATUS, Message::Status, &mut self.status),
        ] {
            if self.send & flag == 0 {
                continue;
            }
            let length = message.encode(Layout::Auto, frame).unwrap_or_default();
            if length <= room {
                self.send ^= flag;
                request.put_out(now);
                return length;
            }
        }
        0
    }

    /// What the operation is, whatever the struct holds.
    const fn operation_opcode(&self) -> Opcode {
        match Opcode(self.opcode) {
            Opcode::MOVE => Opcode::MOVE,
            _ => Opcode::HOMING,
        }
    }

    fn end_operation(&mut self, outcome: Outcome) {
        self.operation.set_stage(FREE);
        self.operation_outcome = outcome as c_uchar;
        self.tell |= TELL_ENDED;
        self.send &= !SEND_OPERATION;
    }

    fn end_cancel(&mut self, outcome: Outcome) {
        self.cancel.set_stage(FREE);
        self.cancel_outcome = outcome as c_uchar;
        self.tell |= TELL_CANCEL_ENDED;
        self.send &= !SEND_CANCEL;
    }

    fn end_status(&mut self, outcome: Outcome) {
        self.status.set_stage(FREE);
        self.status_outcome = outcome as c_uchar;
        self.tell |= TELL_STATUS_ENDED;
    }
}
