//! The motion side: takes commands, queues moves for the firmware, tells how they end.
//!
//! A [`Motion`] does no I/O: it is fed the bytes that were received and the time, and asked for moves and for the bytes
//! to send. The firmware takes the [`next`](Motion::next) move, as many ahead as it plans with, and says when the
//! oldest it took is [`done`](Motion::done).
//!
//! # Numbers
//!
//! are the host's, as the proposal has it: any command may have one or none, the same one may come again, and when a
//! command that has one is completed, it is sent back in its own format. So it is from power-up on.
//!
//! # Sessions
//!
//! That alone helps little on a line that loses bytes: deltas behind a lost command lead elsewhere, and a host that
//! repeats a command has it carried out twice. So a host can begin a session, in which numbers are in order; that takes
//! nothing but what the proposal has:
//!
//! - It begins with two *numbered* requests for position reports (period 0: none) without another command between them,
//!   the second number 5461 behind the first: nobody sends that by chance. The first is answered by its number, as any
//!   numbered command is; the second by that of the first and its own, so that the host can tell that both came. Ends
//!   of moves that were queued before are not told any more.
//! - From there on each move carries the next number, 0 following 16383. Any other is refused, as [`ORDER`]; so is one
//!   without a number, as [`NUMBERLESS`]: it may have lost it. Nothing lost goes unnoticed then, and no delta is added
//!   to the wrong position.
//! - A number that was taken before means a repeat: it is not carried out again. If that move has ended, its end is
//!   told again; else the position is reported, as a sign of life.
//! - When a move is refused, those behind it are too, and only the first of them is told, until what was
//!   refused comes again.
//! - A numbered request for position reports begins a new session, by itself.
//! - When the machine [stops](Motion::stop), the session is over, but the host may have sent more moves before it hears
//!   of that: they are refused, as [`CLOSED`], until it begins a new one.
//!
//! ESC ESC, which no host sends that begins sessions, ends one for good: moves are taken with any number or none again,
//! from a person at a terminal, say.
//!
//! A motion side that was switched off and on, or reset, does not know of the session it was in, and takes what comes
//! as from any host. Where that may happen unseen by a host that relies on its session,
//! [`Settings::only_in_order`] has it refuse all moves, as [`CLOSED`], until a session begins; for which one
//! request is enough then.
//!
//! # What can't be relied on
//!
//! Commands have no checksum. A flipped bit in a number, mask, velocity or position makes another command, which is
//! carried out if its number is the next. A lost byte is noticed in binary, unless it is the mask: then the next byte
//! is taken for that. Of several lost in a row, the rests of two commands may make one. In ASCII a lost digit is never
//! noticed.

mod event;
mod health;
mod incoming;
mod notices;
mod order;
mod queue;
mod reports;
mod settings;

use core::ffi::{c_uchar, c_ulong};

use super::scanner::ESC;
use super::{CommandReceiver, ENCODED_MAX, Item, Number, POSITION_MAX, POSITION_MIN, Vector};
use super::{fitting, write_completed, write_position, write_refused};
use crate::clock::{left, stamp};
use crate::counter::count;
pub use event::{Event, Untold};
pub use health::Health;
pub use notices::{Notice, Notices};
pub use order::Order;
pub(super) use order::STRIDE;
pub use queue::{Queue, Queued};
pub use reports::Reports;
pub use settings::Settings;

// Codes of error notices, behind those of receivers.

/// The number is not the next.
pub const ORDER: u8 = 16;
/// A session is over, or none has begun and moves are taken in sessions only.
pub const CLOSED: u8 = 17;
/// A move without a number where numbers are in order.
pub const NUMBERLESS: u8 = 18;
/// The machine does not have that axis.
pub const AXIS: u8 = 19;
/// The machine has stopped: this move was not finished, those behind it are dropped.
pub const STOPPED: u8 = 20;
/// The first of the codes that firmware may use as it likes, instead of [`STOPPED`].
pub const CODE_FREE: u8 = 64;

/// A motion side. Its fields are private; all zero is a new one with default settings.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Motion {
    settings: Settings,
    health: Health,
    queue: Queue,
    /// What is reported.
    position: Vector,
    reports: Reports,
    notices: Notices,
    order: Order,
    untold: Untold,
    receiver: CommandReceiver,
    /// When the last bytes came.
    arrived_at: c_ulong,
    /// Whether the line was not quiet since.
    busy: c_uchar,
    /// Whether the last byte was ESC.
    escaped: c_uchar,
}

impl Motion {
    /// A motion side that has just begun.
    #[must_use]
    pub const fn new(settings: Settings) -> Self {
        Self {
            settings,
            health: Health::new(),
            queue: Queue::new(),
            position: Vector::new(),
            reports: Reports::new(),
            notices: Notices::new(),
            order: Order::new(),
            untold: Untold::new(),
            receiver: CommandReceiver::new(),
            arrived_at: 0,
            busy: 0,
            escaped: 0,
        }
    }

    /// Replaces the settings. For a motion side that has just begun.
    pub fn set(&mut self, settings: &Settings) {
        self.settings.gap_ms = settings.gap_ms;
        self.settings.axes = settings.axes;
        self.settings.only_in_order = settings.only_in_order;
    }

    /// Takes received bytes, and tells how many: fewer than all when an event or notices have to be fetched first.
    pub fn receive(&mut self, input: &[u8], now: u32) -> usize {
        let mut rest = input;
        while let Some(first) = rest.first() {
            if !self.has_room() {
                break;
            }
            if *first == ESC {
                // Byte by byte, as receivers don't tell.
                if self.escaped != 0 {
                    self.order.close();
                }
                self.escaped = 1;
                self.receiver.reset();
                rest = rest.get(1..).unwrap_or_default();
                continue;
            }
            self.escaped = 0;
            let portion = rest.iter().position(|byte| *byte == ESC).and_then(|end| rest.get(..end)).unwrap_or(rest);
            let mut item = Item::new();
            let taken = self.receiver.receive(portion, &mut item);
            rest = rest.get(taken..).unwrap_or_default();
            if self.look_at(&item).is_none() && taken == 0 {
                break;
            }
        }
        let taken = input.len().wrapping_sub(rest.len());
        if taken != 0 {
            self.arrived_at = stamp(now);
            self.busy = 1;
        }
        taken
    }

    /// The next event; `None` when nothing has happened.
    pub fn poll(&mut self, now: u32) -> Option<Event> {
        if self.busy != 0 && self.has_room() && left(now, self.arrived_at, self.settings.gap()) == 0 {
            self.busy = 0;
            let mut item = Item::new();
            self.receiver.idle(&mut item);
            self.look_at(&item);
        }
        self.untold.take()
    }

    /// Takes the next move to carry out, if there is one: the mask tells which axes it names, and whether a velocity
    /// was ever set; where the others are to stay is filled in too.
    #[expect(clippy::should_implement_trait, reason = "what it returns is borrowed")]
    pub fn next(&mut self) -> Option<(&Vector, Option<Number>)> {
        self.queue.next()
    }

    /// The oldest of the moves taken has been carried out. `false`: none was taken.
    pub fn done(&mut self) -> bool {
        self.queue.end()
    }

    /// How many moves are queued or being carried out.
    #[must_use]
    pub fn unfinished(&self) -> u8 {
        self.queue.unfinished()
    }

    /// The machine has stopped and will not go on: drops all moves. The oldest of them that has a number is told with
    /// this code, a session is over (moves are refused until another begins), and where the machine is has to be
    /// [told](Self::set_position) before it is moved by deltas again.
    pub fn stop(&mut self, code: u8) {
        if let Some(number) = self.queue.awaited().next() {
            self.notices.push(Some(number), number.format, code);
        }
        self.queue.drop_unfinished();
        self.order.stop();
    }

    /// Where the machine is, for reports; and for moves by deltas as long as no move has told where an axis is.
    /// `false`: a value is out of range, and nothing has changed.
    pub fn set_position(&mut self, position: &[i32; 6]) -> bool {
        if !position.iter().all(|value| (POSITION_MIN..=POSITION_MAX).contains(value)) {
            return false;
        }
        for (axis, value) in position.iter().enumerate() {
            self.position.set(axis, *value);
        }
        self.queue.starts_at(position);
        true
    }

    /// Writes the next notice, if it fits in `room` bytes, and returns its length; 0 when there is none. To be called
    /// after [`poll`](Self::poll); `now` is when it leaves.
    pub fn output(&mut self, frame: &mut [u8; ENCODED_MAX], room: usize, now: u32) -> usize {
        if let Some(number) = self.queue.ended() {
            let length = fitting(write_completed(number, frame), room);
            if length != 0 {
                self.queue.told();
            }
            return length;
        }
        if let Some(notice) = self.notices.first() {
            let length = match (notice.code(), notice.number()) {
                (0, Some(number)) => write_completed(number, frame),
                (code, number) => write_refused(notice.format(), number, code & 0x7F, frame),
            };
            let length = fitting(length, room);
            if length != 0 {
                self.notices.pop();
            }
            return length;
        }
        if self.reports.left(now) == Some(0) {
            self.position.mask = self.settings.axes();
            let length = fitting(write_position(self.reports.format(), &self.position, frame), room);
            if length != 0 {
                self.reports.sent(now);
                count(&mut self.health.reports);
            }
            return length;
        }
        0
    }

    /// How many milliseconds may pass until [`poll`](Self::poll) or [`output`](Self::output) have something to do
    /// without anything being received or done; `None` when there is nothing to wait for.
    #[must_use]
    pub fn next_deadline(&self, now: u32) -> Option<u32> {
        if !self.untold.is_none() || self.queue.ended().is_some() || self.notices.first().is_some() {
            return Some(0);
        }
        let gap = (self.busy != 0).then(|| left(now, self.arrived_at, self.settings.gap()));
        [gap, self.reports.left(now)].into_iter().flatten().min()
    }

    /// What was seen so far.
    #[must_use]
    pub const fn health(&self) -> &Health {
        &self.health
    }

    /// Whether what one more command brings about can be kept.
    fn has_room(&self) -> bool {
        self.untold.is_none() && self.notices.has_room()
    }
}

#[cfg(test)]
mod tests {
    use super::{ENCODED_MAX, Motion, STOPPED, Settings};
    use std::vec::Vec;

    fn says(motion: &mut Motion, received: &[u8]) -> Vec<u8> {
        let mut rest = received;
        while !rest.is_empty() {
            rest = &rest[motion.receive(rest, 0)..];
            while motion.poll(0).is_some() {}
        }
        let (mut frame, mut said) = ([0; ENCODED_MAX], Vec::new());
        loop {
            match motion.output(&mut frame, ENCODED_MAX, 0) {
                0 => return said,
                length => said.extend(&frame[..length]),
            }
        }
    }

    /// A host that began anew while the machine still carried out moves of its last session, or of nobody's.
    #[test]
    fn a_stop_is_told_to_who_waits_for_a_later_move() {
        let mut motion = Motion::new(Settings::new());
        assert_eq!(says(&mut motion, b"#7x100\nx200\n#0R0\n#5461R0\n#5462x300\n#5463x400\n"), b"#0\n#5461\n");
        assert!(motion.next().is_some());
        motion.stop(STOPPED);
        assert_eq!(says(&mut motion, b""), b"#5462?20\n");
        assert_eq!(says(&mut motion, b"#5464x500\n"), b"#5464?17\n");
    }
}
