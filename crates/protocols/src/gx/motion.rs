//! The motion side: takes commands, queues moves for the firmware, reports how they end.
//!
//! A [`Motion`] does no I/O: it is fed the bytes that were received and the time, and asked for moves and for the bytes
//! to send. The firmware takes the [`next`](Motion::next) move, as many ahead as it plans with, and says when the
//! oldest it took is [`done`](Motion::done).
//!
//! # Numbers and sessions
//!
//! From power-up on numbers are the host's: any command may have one or none, the same one may come again, and when a
//! command that has one is completed, it is sent back in its own format. But deltas behind a lost command lead
//! elsewhere, and a command that is sent again is carried out twice. So a host can begin a session, in which numbers are
//! in order; that takes nothing but what the proposal has:
//!
//! - It begins with two *numbered* requests for position reports (period 0: none) without another command between them,
//!   the second number 5461 behind the first: nobody sends that by chance. The first is answered by its number; the
//!   second by that of the first and its own, so that the host knows that both came. Ends of moves that were queued
//!   before are not reported any more. Another numbered request begins a new session, by itself.
//! - From there on each move carries the next number, 0 following 16383. Any other is refused, as [`Fault::Order`]; so
//!   is one without, as [`Fault::Numberless`]: it may have lost it.
//! - A number that was taken before is not carried out again. If that move has ended, its end is sent again; else the
//!   position is reported, as a sign of life.
//! - When a move is refused, those behind it are too, and only the first of them gets an error notice, until what was
//!   refused comes again.
//! - When the machine [stops](Motion::stop), the session is over, but the host may have sent more moves before it hears
//!   of that: they are refused, as [`Fault::Closed`], until it begins a new one.
//! - ESC ESC, which no host sends that begins sessions, ends one for good: moves are taken with any number or none
//!   again, from a person at a terminal, say.
//!
//! A motion side that was switched off and on, or reset, does not know of the session it was in. Where a host may not
//! notice that, [`Settings::only_in_order`] has it refuse all moves, as [`Fault::Closed`], until a session begins; for
//! which one request is enough then.
//!
//! Commands have no checksum. A flipped bit in a number, mask, velocity or position makes another command, which is
//! carried out if its number is the next; so may a lost mask, several bytes lost in a row, or a lost digit in ASCII.

mod commands;
mod event;
mod notices;
mod order;
mod queue;
mod reports;
mod settings;

use zerocopy::{FromBytes, Immutable, transmute};

use super::encoder::{Out, confirmation};
use super::message::{Fault, Numbered, Status};
use super::packed::is_position;
use super::receiver::{CommandReceiver, ESC, Step};
use super::vector::{AXES, MASK_VELOCITY, Vector};
use crate::session::{count, left, span};
use event::Pending;
pub use event::{Event, EventKind};
use notices::Notices;
use order::Order;
pub(super) use order::STRIDE;
use queue::Queue;
use reports::{NEVER, Reports};
pub use settings::{Health, Settings};

/// A motion side that queues up to `QUEUE` moves, 1 to 255. All zero is a new one with default settings.
#[derive(Clone, Debug, FromBytes, Immutable)]
#[repr(C)]
pub struct Motion<const QUEUE: usize> {
    // What is small comes first, the queue last: small machines reach what is near with less code.
    pending: Pending,
    /// Whether the line was not quiet since bytes came.
    busy: u8,
    /// Whether the last byte was ESC.
    escaped: u8,
    /// Why no moves are handed out: [`HELD`] or [`STOPPING`]; 0: they are.
    halt: u8,
    order: Order,
    reports: Reports,
    settings: Settings,
    /// When the last bytes came.
    arrived_at: u32,
    receiver: CommandReceiver,
    notices: Notices,
    health: Health,
    /// What is reported.
    position: Vector,
    queue: Queue<QUEUE>,
}

/// Until a host lets it go on.
const HELD: u8 = 1;
/// Until the machine stands.
const STOPPING: u8 = 2;

impl<const QUEUE: usize> Motion<QUEUE> {
    /// A motion side that has just begun, with default settings.
    pub const fn new() -> Self {
        const { assert!(1 <= QUEUE && QUEUE <= 255, "the queue must hold 1 to 255 moves") };
        Self {
            settings: transmute!([0_u8; size_of::<Settings>()]),
            health: transmute!([0_u8; size_of::<Health>()]),
            queue: Queue::new(),
            position: Vector::new(),
            reports: transmute!([0_u8; size_of::<Reports>()]),
            notices: transmute!([0_u8; size_of::<Notices>()]),
            order: transmute!([0_u8; size_of::<Order>()]),
            pending: transmute!([0_u8; size_of::<Pending>()]),
            receiver: CommandReceiver::new(),
            arrived_at: 0,
            busy: 0,
            escaped: 0,
            halt: 0,
        }
    }

    /// Replaces the settings. For a motion side that has just begun.
    pub const fn set(&mut self, settings: Settings) {
        self.settings = settings;
        self.settings.gap_ms = span(self.settings.gap_ms, 0);
        self.settings.host_ms = span(self.settings.host_ms, 0);
    }

    /// Takes received bytes; returns how many: fewer than all when an event or notices have to be fetched first.
    #[inline]
    pub fn receive(&mut self, input: &[u8], now: u32) -> usize {
        if !input.is_empty() {
            self.arrived_at = now;
            self.busy = 1;
        }
        let mut rest = input;
        while let Some((byte, behind)) = rest.split_first().filter(|_| self.has_room()) {
            if self.receive_byte(*byte) {
                rest = behind;
            }
        }
        input.len().wrapping_sub(rest.len())
    }

    /// Receives a byte, and deals with what it ends; returns whether it was taken. There has to be room.
    fn receive_byte(&mut self, byte: u8) -> bool {
        match self.receiver.receive_byte(byte) {
            Step::Taken => {}
            Step::Done(kind) => self.handle(kind),
            Step::Before(kind) => {
                self.handle(kind);
                return false;
            }
        }
        if byte != ESC {
            self.escaped = 0;
        } else if self.escaped == 0 {
            self.escaped = 1;
        } else {
            self.order.close();
        }
        true
    }

    /// The next event; `None` when nothing has happened.
    #[inline]
    pub fn poll(&mut self, now: u32) -> Option<Event> {
        // Right behind a byte, no time has passed.
        if now != self.arrived_at {
            self.on_timer(now);
        }
        if self.pending.is_none() { None } else { self.pending.take(self.reports.period) }
    }

    #[inline(never)]
    fn on_timer(&mut self, now: u32) {
        if self.busy != 0 && self.has_room() && left(now, self.arrived_at, self.gap()) == 0 {
            self.busy = 0;
            if let Some(kind) = self.receiver.idle() {
                self.handle(kind);
            }
        }
        if self.pending.is_none() && self.is_watching() && left(now, self.arrived_at, self.settings.host_ms) == 0 {
            self.halt = STOPPING;
            self.pending.set(Some(EventKind::Stop), Numbered::NONE, Fault::Silent as u8);
            self.reports.answer(self.reports.format(), false);
        }
    }

    /// Takes the next move to carry out, if there is one: the mask flags the axes that it names, and the velocity if
    /// one was ever set; where the others are to stay is filled in too.
    #[expect(clippy::should_implement_trait, reason = "what it returns is borrowed")]
    pub fn next(&mut self) -> Option<(&Vector, Numbered)> {
        if self.halt != 0 {
            return None;
        }
        self.queue.next()
    }

    /// The oldest of the moves taken has been carried out. `false`: none was taken.
    pub fn done(&mut self) -> bool {
        self.queue.end()
    }

    /// How many moves are queued or being carried out.
    pub const fn unfinished(&self) -> u8 {
        self.queue.unfinished()
    }

    /// The machine has stopped and will not go on: drops all moves. The oldest of them that has a number gets an error
    /// notice with this code, a session is over (moves are refused until another begins), and where the machine is has
    /// to be [set](Self::set_position) before it is moved by deltas again.
    ///
    /// If a host wanted that, the position follows, as it was set last, and the velocity that is in force.
    pub fn stop(&mut self, code: u8) {
        let number = self.queue.awaited(Numbered::NONE);
        if number.is_some() {
            self.notices.push(number, number.format(), code);
        }
        self.queue.drop_unfinished();
        self.order.stop();
        if self.halt == STOPPING {
            self.reports.one(self.reports.format());
            self.position.mask |= MASK_VELOCITY;
        }
        self.halt = 0;
    }

    /// Sets where the machine is: for reports, and for moves by deltas as long as no move has said where an axis is.
    /// `false`: a value is out of range, and nothing has changed.
    pub fn set_position(&mut self, position: &[i32; AXES]) -> bool {
        if !position.iter().all(|value| is_position(*value)) {
            return false;
        }
        for (place, value) in self.position.axes.iter_mut().zip(position) {
            *place = *value;
        }
        self.queue.starts_at(position);
        true
    }

    /// Writes the next notice to `room`, if it fits, and returns its length; 0 when there is none. To be called after
    /// [`poll`](Self::poll); `now` is when it leaves.
    #[inline]
    pub fn output(&mut self, room: &mut [u8], now: u32) -> usize {
        // Mostly there is none: that is found out without a call.
        if self.has_notice() || self.reports.is_on() { self.write_next(room, now) } else { 0 }
    }

    #[inline(never)]
    fn write_next(&mut self, room: &mut [u8], now: u32) -> usize {
        let mut out = Out::new(room);
        if let Some((number, check)) = self.queue.ended() {
            self.write_completed(&mut out, number, Some(check));
            return out.finish(|| self.queue.pop_ended(check));
        }
        if let Some(notice) = self.notices.first() {
            let (number, code) = (notice.number, notice.code());
            if code == 0 {
                self.write_completed(&mut out, number, self.queue.reported().filter(|_| self.order.was_last(number)));
            } else {
                out.refusal(number, code, notice.format());
            }
            return out.finish(|| self.notices.pop());
        }
        if self.reports.status_due != 0 {
            let status = Status { free: self.queue.free(), is_held: self.halt == HELD };
            out.word(b'%', status.bits(), self.reports.format());
            return out.finish(|| self.reports.status_due = 0);
        }
        if self.reports.left(now) != 0 {
            return 0;
        }
        self.position.mask = self.settings.axes() | self.position.mask & MASK_VELOCITY;
        self.position.velocity = self.queue.last.velocity;
        out.byte(b'=');
        out.positions(self.reports.format(), &self.position);
        out.finish(|| {
            (self.reports.due, self.reports.sent_at) = (0, now);
            self.position.mask = 0;
            count(&mut self.health.reports);
        })
    }

    /// The notice that the command with this number was carried out; `check` is that of a move, for the host of a
    /// session.
    fn write_completed(&self, out: &mut Out<'_>, number: Numbered, check: Option<u8>) {
        let (start, value) = match check {
            Some(check) if self.order.is_session() => (b'&', confirmation(number.value(), check)),
            _ => (b'#', number.value()),
        };
        out.word(start, value, number.format());
    }

    /// How many milliseconds may pass until [`poll`](Self::poll) or [`output`](Self::output) have something to do
    /// without anything being received or done; `None` when there is nothing to wait for.
    #[inline]
    pub fn next_deadline(&self, now: u32) -> Option<u32> {
        let due = self.due(now);
        (due != NEVER).then_some(due)
    }

    #[inline(never)]
    fn due(&self, now: u32) -> u32 {
        if !self.pending.is_none() || self.has_notice() {
            return 0;
        }
        let mut due = self.reports.left(now);
        if self.busy != 0 {
            due = due.min(left(now, self.arrived_at, self.gap()));
        }
        if self.is_watching() {
            due = due.min(left(now, self.arrived_at, self.settings.host_ms));
        }
        due
    }

    /// Whether there is something to send, reports aside.
    const fn has_notice(&self) -> bool {
        self.queue.has_ended() || !self.notices.is_empty() || self.reports.status_due != 0
    }

    /// After how long an incomplete command is given up.
    const fn gap(&self) -> u32 {
        if self.settings.gap_ms == 0 { 1000 } else { self.settings.gap_ms }
    }

    /// Whether the machine is to stop when its host is silent.
    const fn is_watching(&self) -> bool {
        self.settings.host_ms != 0 && self.halt != STOPPING && self.queue.unfinished() != 0
    }

    /// What was seen so far.
    pub const fn health(&self) -> &Health {
        &self.health
    }

    /// Whether what one more command brings about can be kept.
    const fn has_room(&self) -> bool {
        self.pending.is_none() && self.notices.has_room()
    }
}

impl<const QUEUE: usize> Default for Motion<QUEUE> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::Motion;
    use crate::gx::{ENCODED_MAX, Fault};

    /// What it sends when it has received this.
    pub(in crate::gx) fn says<const QUEUE: usize>(motion: &mut Motion<QUEUE>, received: &[u8], now: u32) -> Vec<u8> {
        let mut rest = received;
        while !rest.is_empty() {
            rest = &rest[motion.receive(rest, now)..];
            while motion.poll(now).is_some() {}
        }
        let (mut frame, mut said) = ([0; ENCODED_MAX], Vec::new());
        while let length @ 1.. = motion.output(&mut frame, now) {
            said.extend(&frame[..length]);
        }
        said
    }

    /// A host that began a new session while the machine still carried out moves of its last session, or of nobody's.
    #[test]
    fn a_stop_is_reported_to_who_waits_for_a_later_move() {
        let mut motion = Motion::<16>::new();
        assert_eq!(says(&mut motion, b"#7x100\nx200\n#0R0\n#5461R0\n#5462x300\n#5463x400\n", 0), b"#0\n#5461\n");
        assert!(motion.next().is_some());
        motion.stop(Fault::Stopped as u8);
        assert_eq!(says(&mut motion, b"", 0), b"#5462?20\n");
        assert_eq!(says(&mut motion, b"#5464x500\n", 0), b"#5464?17\n");
    }
}
