//! The host's end of the link: requests go in, outcomes come out.
//!
//! A [`Host`] does no I/O: it is fed the bytes that were received and the time, and asked for the bytes to send and for
//! events.
//!
//! # What can be relied on
//!
//! The protocol numbers nothing: an ack names the opcode that it answers, not the request. So what a frame means depends
//! on when it was sent, and that is known from two properties of a serial line: it keeps the order of bytes, and what
//! it delivers at all it delivers soon, the answer to a request within [`Settings::guard_ms`]. Where both hold, and no
//! damaged frame passes for an intact one (with a checksum of 8 bits one in some hundred does), each request ends
//! exactly once, and as finished only if it was carried out. One gap remains: that homing was ended by an error, which
//! was cleared while no report got through, shows only if the position is unknown then.
//!
//! # A request
//!
//! is sent, and retransmitted when no answer came in [`Settings::ack_ms`], up to [`attempts`](field@Settings::attempts)
//! times altogether, whatever its opcode: carrying one out twice is no harm, as a move goes to an absolute position,
//! homing and cancelling end in one state, and asking changes nothing. But an operation is not retransmitted once its
//! cancelling was requested, or an error was reported: that would move the robot against the user's will.
//!
//! - Accepted: its ack came. What was received before belongs to an older operation and ends nothing.
//! - Refused: its nack came. After a retransmission that may be because the first request, whose ack was lost, is being
//!   carried out: then the state decides.
//! - Unanswered: it has timed out, unless reports of homing or moving, or of standing at the target after having stood
//!   elsewhere, have shown that only the answers are lost. Then its end is believed from status reports alone.
//!
//! The next operation waits until no answer to the last can come any more, unless that was sent once and accepted and
//! the line does not duplicate frames ([`Settings::duplicates`]). A cancel request waits for nothing; answers that may
//! be those of an older one are ignored, and it is retransmitted.
//!
//! An accepted operation ends by
//!
//! - `h` or `m` (the specification);
//! - a report of IDLE (shipped firmware), if homing or moving was reported since the ack, or [`Settings::settle_ms`]
//!   has passed: directly behind the ack the motors may not run yet. The operation is finished if the position is known
//!   and, of a move, the target; else it has failed (a controller that was reset is idle too);
//! - a report of ERROR, or `e`: it has failed;
//! - its cancelling: cancelled, as soon as IDLE is reported;
//! - silence, or by lasting too long: timed out.
//!
//! IDLE, `h` and `m` are not believed while a retransmission of the request may still be on its way, as that would
//! start the operation again. No harm is done by ignoring an `h`: the status is asked for until the end.
//!
//! ```
//! use deltarobot_protocols::deltarobot::host::{Event, Host, Outcome, REQUEST_MAX, Settings};
//! use deltarobot_protocols::deltarobot::{Opcode, receiver_room};
//!
//! let mut host = Host::<{ receiver_room(32) }>::new(Settings::default());
//! host.home().unwrap();
//! let (mut room, mut payload) = ([0; REQUEST_MAX], [0; 32]);
//! assert_eq!(host.poll(0, &mut payload), None);
//! let length = host.output(&mut room, REQUEST_MAX, 0);
//! assert_eq!(room[..length], *b"$H\0\xA6:");
//!
//! assert_eq!(host.receive(b"$A\x01H\xE8:$h\0\xC6:", 5), 11);
//! assert_eq!(host.poll(5, &mut payload), Some(Event::Accepted(Opcode::HOMING)));
//! assert_eq!(host.poll(5, &mut payload), Some(Event::Ended(Opcode::HOMING, Outcome::Finished)));
//! ```

mod operation;
mod request;
mod settings;
mod timers;

use zerocopy::{FromBytes, Immutable, KnownLayout};

use super::{
    FRAME_OVERHEAD, Layout, Message, Opcode, POSITION_SIZE, Place, Position, Receiver, Report, SeenLayout, encode,
};
use crate::session::{Flags, count, flags, left, span};
pub use request::Outcome;
use request::{Request, Stage};
pub use settings::{Health, Settings};
use timers::NEVER;

/// A host session with a [`Receiver`] of `ROOM` bytes. All zero is a new one with default settings.
#[derive(Clone, Debug, Default, FromBytes, Immutable, KnownLayout)]
pub struct Host<const ROOM: usize> {
    link: Link<ROOM>,
    session: Session,
}

/// What was received. Apart from the session, of which AVR then reaches more by short offsets.
#[derive(Clone, Debug, Default, FromBytes, Immutable, KnownLayout)]
struct Link<const ROOM: usize> {
    /// When the last bytes came.
    arrived_at: u32,
    receiver: Receiver<ROOM>,
    /// Not 0: not all of them were taken.
    has_more: u8,
}

/// All of a session but the bytes that it has received.
#[derive(Clone, Debug, Default, FromBytes, Immutable, KnownLayout)]
struct Session {
    settings: Settings,
    health: Health,
    operation: Request,
    cancel: Request,
    status: Request,
    /// When the operation was sent first, and when it was accepted.
    started_at: u32,
    accepted_at: u32,
    /// When a frame was received last.
    heard_at: u32,
    /// When the status was last reported or asked for.
    polled_at: u32,
    /// The target of the operation, if it is a move.
    target: Position,
    /// The last status report.
    report: Report,
    /// The layout of reports, as far as it was seen.
    seen_layout: SeenLayout,
    /// Opcode of the operation.
    opcode: u8,
    /// Not 0: there was a status report.
    has_report: u8,
    facts: Flags<operation::Fact>,
    notices: Flags<Notice>,
}

flags! {
    /// Events that are to be fetched, besides the ends of requests.
    enum Notice {
        Status,
        State,
        GeneralError,
        Accepted,
    }
}

/// What has happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A message was received (where [`Settings::messages`] asks for these), with this many bytes of payload.
    Message(Opcode, usize),
    /// A status report was received: [`Host::last_report`].
    Status,
    /// The platform's state is another one than in the report before.
    State,
    /// A general error was received.
    GeneralError,
    /// The operation was accepted.
    Accepted(Opcode),
    /// A request has ended.
    Ended(Opcode, Outcome),
}

/// A request of the kind is going on, or its outcome has not been fetched yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Busy;

/// Bytes of the longest frame that is sent: a move's.
pub const REQUEST_MAX: usize = POSITION_SIZE.wrapping_add(FRAME_OVERHEAD);

impl<const ROOM: usize> Host<ROOM> {
    /// A session that has just begun.
    pub fn new(settings: Settings) -> Self {
        Self { session: Session { settings, ..Session::default() }, ..Self::default() }
    }

    /// The settings, to be changed while nothing is going on.
    pub const fn settings(&mut self) -> &mut Settings {
        &mut self.session.settings
    }

    /// Requests homing.
    pub fn home(&mut self) -> Result<(), Busy> {
        self.session.start(Opcode::HOMING)
    }

    /// Requests a move. The position has to be finite: others are the caller's to refuse.
    pub fn move_to(&mut self, target: Position) -> Result<(), Busy> {
        self.session.start(Opcode::MOVE)?;
        self.session.target = target;
        Ok(())
    }

    /// Requests that the operation going on be cancelled. Without one it is requested all the same, since the
    /// controller may have got one from elsewhere.
    pub fn cancel(&mut self) -> Result<(), Busy> {
        let session = &mut self.session;
        session.cancel.queue(true)?;
        if session.operation.stage() == Stage::Queued {
            session.operation.end(Outcome::Cancelled);
        }
        Ok(())
    }

    /// Requests a status report.
    pub fn status(&mut self) -> Result<(), Busy> {
        self.session.status.queue(false)
    }

    /// Whether an operation is going on.
    pub fn is_busy(&self) -> bool {
        self.session.operation.stage() != Stage::Free
    }

    /// The last status report, if there was one.
    pub fn last_report(&self) -> Option<&Report> {
        (self.session.has_report != 0).then_some(&self.session.report)
    }

    /// How well the link works.
    pub const fn health(&self) -> &Health {
        &self.session.health
    }

    /// Takes received bytes, as many as there is room for, and returns how many. The others fit when
    /// [`poll`](Self::poll) has no more events. `now` is when they came.
    pub fn receive(&mut self, input: &[u8], now: u32) -> usize {
        let taken = self.link.receiver.take(input);
        if taken != 0 {
            self.link.arrived_at = now;
        }
        self.link.has_more = u8::from(taken < input.len());
        taken
    }

    /// The next event; `None` when there is none. Of [`Event::Message`], the payload is copied to `data` as far as that
    /// goes; other events change it too.
    pub fn poll<P: Place>(&mut self, now: u32, data: &mut [P]) -> Option<Event> {
        let is_quiet = self.link.has_more == 0 && self.gap_left(now) == 0;
        let Self { link: Link { receiver, has_more, .. }, session } = self;
        loop {
            if let Some(event) = session.next_event() {
                return Some(event);
            }
            let health = &mut session.health;
            let frame = if is_quiet { receiver.next_idle(health) } else { receiver.next_observed(health) };
            let Ok(frame) = frame else { break };
            count(&mut health.frames);
            for (place, byte) in data.iter_mut().zip(frame.payload) {
                *place = P::of(*byte);
            }
            session.heard_at = now;
            let layout = Layout::of(session.settings.layout);
            match Message::read_after(frame.opcode, frame.payload, layout, &mut session.seen_layout) {
                Some(message) => session.handle(&message, now),
                None => count(&mut session.health.malformed),
            }
            if session.settings.messages != 0 {
                return Some(Event::Message(frame.opcode, frame.payload.len()));
            }
        }
        // What was received already is no answer to what is sent next, and may end what would time out.
        if core::mem::replace(has_more, 0) == 0 {
            session.on_timer(now);
        }
        session.next_event()
    }

    /// Writes the frame of the next request that fits in `room` bytes, and returns its length; 0 when there is none:
    /// three (of 27 bytes together) at most at a time. To be called after [`poll`](Self::poll); `now` is when it
    /// leaves.
    pub fn output(&mut self, frame: &mut [u8; REQUEST_MAX], room: usize, now: u32) -> usize {
        let session = &mut self.session;
        let (operation, target) = (session.operation_opcode(), session.target.to_wire());
        let payload = if operation == Opcode::MOVE { &target[..] } else { &[] };
        for (request, opcode, payload) in [
            (&mut session.cancel, Opcode::CANCEL, &[][..]),
            (&mut session.operation, operation, payload),
            (&mut session.status, Opcode::STATUS, &[]),
        ] {
            let length = payload.len().wrapping_add(FRAME_OVERHEAD);
            if request.is_to_send() && length <= room {
                request.leaves(now);
                return encode(opcode, payload, frame).unwrap_or_default();
            }
        }
        0
    }

    /// How many milliseconds may pass until [`poll`](Self::poll) has something to do without having received anything;
    /// `None` when only receiving or a request brings anything about. To be asked when there are no events left.
    pub fn next_deadline(&self, now: u32) -> Option<u32> {
        let gap = if self.link.receiver.is_empty() { NEVER } else { self.gap_left(now) };
        let left = gap.min(self.session.time_left(now));
        (left != NEVER).then_some(left)
    }

    /// How long until what is incomplete is given up.
    fn gap_left(&self, now: u32) -> u32 {
        left(now, self.link.arrived_at, span(self.session.settings.gap_ms, 50))
    }
}

impl Session {
    fn start(&mut self, opcode: Opcode) -> Result<(), Busy> {
        self.operation.queue(self.settings.duplicates != 0)?;
        self.opcode = opcode.0;
        self.facts = Flags::default();
        Ok(())
    }

    /// The opcode of the operation, whatever the state holds.
    const fn operation_opcode(&self) -> Opcode {
        match Opcode(self.opcode) {
            Opcode::MOVE => Opcode::MOVE,
            _ => Opcode::HOMING,
        }
    }

    fn next_event(&mut self) -> Option<Event> {
        match self.notices.take_first() {
            Some(Notice::Status) => return Some(Event::Status),
            Some(Notice::State) => return Some(Event::State),
            Some(Notice::GeneralError) => return Some(Event::GeneralError),
            Some(Notice::Accepted) => return Some(Event::Accepted(self.operation_opcode())),
            None => (),
        }
        let operation = self.operation_opcode();
        for (request, opcode) in
            [(&mut self.status, Opcode::STATUS), (&mut self.cancel, Opcode::CANCEL), (&mut self.operation, operation)]
        {
            if let Some(outcome) = request.take_outcome() {
                return Some(Event::Ended(opcode, outcome));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::{Event, Settings};
    use crate::deltarobot::receiver_room;

    type Host = super::Host<{ receiver_room(12) }>;

    fn host() -> Host {
        Host::new(Settings { messages: 1, ..Settings::default() })
    }

    /// The opcodes of the messages that are there.
    fn opcodes(host: &mut Host, now: u32) -> Vec<u8> {
        let events = core::iter::from_fn(|| host.poll(now, &mut [0; 0]));
        events.filter_map(|event| if let Event::Message(opcode, _) = event { Some(opcode.0) } else { None }).collect()
    }

    fn feed(host: &mut Host, mut bytes: &[u8]) -> Vec<u8> {
        let mut received = Vec::new();
        while !bytes.is_empty() {
            bytes = &bytes[host.receive(bytes, 0)..];
            assert_eq!(host.link.has_more != 0, !bytes.is_empty());
            received.extend(opcodes(host, 0));
        }
        received
    }

    #[test]
    fn garbage_and_checksum_failures_are_counted() {
        let stream = b"xy$S\0\xB1:z$S\0\xB2:$A\x01H\xE8:$A\x01H\xE9:$$h\0\xC6:";
        // In one piece, and byte by byte: a part of a frame is no garbage.
        for size in [stream.len(), 1] {
            let mut host = host();
            assert_eq!(stream.chunks(size).flat_map(|piece| feed(&mut host, piece)).collect::<Vec<_>>(), b"SAh");
            let health = host.health();
            assert_eq!((health.frames, health.garbage_bytes, health.checksum_failures), (3, 3 + 5 + 6 + 1, 2));
            assert_eq!(health.malformed, 0);
        }
    }

    #[test]
    fn what_is_incomplete_is_given_up_after_the_gap() {
        let mut host = host();
        assert_eq!(feed(&mut host, b"$M\x0C$S\0\xB1:"), b"");
        assert_eq!(host.next_deadline(20), Some(30));
        assert_eq!(opcodes(&mut host, 49), b"");
        host.link.has_more = 1;
        assert_eq!((host.poll(50, &mut [0; 0]), host.link.has_more), (None, 0));
        assert_eq!(opcodes(&mut host, 50), b"S");
        assert_eq!((host.health().garbage_bytes, host.next_deadline(50)), (3, None));
    }
}
