//! The moves that were requested and whose ends were not told yet.

use core::ffi::{c_uchar, c_ushort};

use super::event::Outcome;
use crate::config::GX_WINDOW_MAX;
use crate::gx::{MASK_AXES, MASK_VELOCITY, NUMBER_MAX, Vector};

/// A requested move. Its fields are private.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Requested {
    /// Where all axes are after it and the velocity then in force, as far as the mask says that they are known.
    target: Vector,
    /// The mask of what was requested.
    named: c_uchar,
    /// Whether it was sent as absolute positions.
    absolute: c_uchar,
    /// 0, or how it ended and why.
    outcome: c_uchar,
    code: c_uchar,
}

/// The requested moves, the oldest first: some that were sent, then some that were not. Its fields are private.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Window {
    moves: [Requested; GX_WINDOW_MAX],
    /// Where the last move that is not among them any more leads to.
    base: Vector,
    /// The number of the oldest, if that was sent.
    first: c_ushort,
    head: c_uchar,
    count: c_uchar,
    /// How many have been sent in this session, and have their numbers.
    sent: c_uchar,
}

impl Window {
    pub(super) const fn new() -> Self {
        const NONE: Requested = Requested { target: Vector::new(), named: 0, absolute: 0, outcome: 0, code: 0 };
        Self { moves: [NONE; GX_WINDOW_MAX], base: Vector::new(), first: 0, head: 0, count: 0, sent: 0 }
    }

    pub(super) fn has_room(&self) -> bool {
        usize::from(self.count) < GX_WINDOW_MAX
    }

    pub(super) const fn sent(&self) -> u8 {
        self.sent
    }

    /// Puts a move behind the others. There has to be room.
    pub(super) fn push(&mut self, target: &Vector) {
        let place = self.place(self.count);
        if let Some(requested) = self.moves.get_mut(place) {
            requested.target.copy(target);
            (requested.named, requested.absolute) = (target.mask, 0);
            (requested.outcome, requested.code) = (0, 0);
            self.count = self.count.wrapping_add(1);
        }
    }

    /// Nothing is known any more of where the machine is: the moves that come are the first of a session, which has
    /// begun with this number.
    pub(super) fn begin(&mut self, number: u16) {
        self.base.mask = 0;
        self.first = number.wrapping_add(1) & NUMBER_MAX;
        self.sent = 0;
    }

    /// The number of a move that was sent.
    pub(super) fn number(&self, index: u8) -> u16 {
        self.first.wrapping_add(index.into()) & NUMBER_MAX
    }

    /// Which of the moves that were sent has that number; none if it is an old one's.
    pub(super) fn find(&self, number: u16) -> Option<u8> {
        let index = number.wrapping_sub(self.first) & NUMBER_MAX;
        u8::try_from(index).ok().filter(|index| *index < self.sent)
    }

    /// The oldest move that was sent and has not ended.
    pub(super) fn oldest(&self) -> Option<u8> {
        (0..self.sent).find(|index| self.at(*index).is_some_and(|requested| requested.outcome == 0))
    }

    /// Whether a move waits to be sent, nothing before it having gone wrong.
    pub(super) fn has_next(&self) -> bool {
        self.sent < self.count && self.at(self.sent).is_some_and(|requested| requested.outcome == 0)
    }

    /// Whether no end is to be told of the oldest move, and it was not sent.
    pub(super) fn waits(&self) -> bool {
        self.sent == 0 && self.has_next()
    }

    /// What a move that is sent for the first time is to be written as: without a velocity that is in force already.
    pub(super) fn command(&self, index: u8, out: &mut Vector) {
        let Some(requested) = self.at(index) else { return };
        out.copy(&requested.target);
        out.mask = requested.named;
        let before = self.before(index);
        if out.mask & MASK_AXES != 0 && out.velocity() == before.velocity() {
            out.mask &= MASK_AXES;
        }
    }

    /// What it is to be written as again: with the velocity, if that is known.
    pub(super) fn command_again(&self, index: u8, out: &mut Vector) {
        let Some(requested) = self.at(index) else { return };
        out.copy(&requested.target);
        out.mask = requested.named | requested.target.mask & MASK_VELOCITY;
    }

    /// Where the move before this one leads to, and the velocity then.
    pub(super) fn before(&self, index: u8) -> &Vector {
        match index.checked_sub(1) {
            Some(before) => self.at(before).map_or(&self.base, |requested| &requested.target),
            None => &self.base,
        }
    }

    /// A move is sent as absolute positions.
    pub(super) fn make_absolute(&mut self, index: u8) {
        let place = self.place(index);
        if let Some(requested) = self.moves.get_mut(place) {
            requested.absolute = 1;
        }
    }

    /// Whether it was, in case.
    pub(super) fn is_absolute(&self, index: u8) -> bool {
        self.at(index).is_some_and(|requested| requested.absolute != 0)
    }

    /// The next move has been sent.
    pub(super) fn advance(&mut self) {
        // What it does not name stays where the move before leads to.
        let mut base = Vector::new();
        base.copy(self.before(self.sent));
        let place = self.place(self.sent);
        if let Some(requested) = self.moves.get_mut(place) {
            for (axis, value) in base.axes.iter().enumerate() {
                if requested.named >> axis & 1 == 0 && base.has(axis) {
                    requested.target.set(axis, *value);
                }
            }
            if let Some(velocity) = base.velocity().filter(|_| requested.named & MASK_VELOCITY == 0) {
                requested.target.set_velocity(velocity);
            }
        }
        self.sent = self.sent.wrapping_add(1);
    }

    /// The moves from one on to before another have ended, those of them that had not yet.
    pub(super) fn end(&mut self, from: u8, to: u8, outcome: Outcome, code: u8) {
        for index in from..to.min(self.count) {
            let place = self.place(index);
            if let Some(requested) = self.moves.get_mut(place).filter(|requested| requested.outcome == 0) {
                (requested.outcome, requested.code) = (outcome as c_uchar, code);
            }
        }
    }

    /// All moves that have not ended have: those sent like this, the others are dropped.
    pub(super) fn end_all(&mut self, outcome: Outcome, code: u8) {
        self.end(0, self.sent, outcome, code);
        self.end(self.sent, self.count, Outcome::Dropped, code);
        self.sent = 0;
    }

    /// A move was refused: it and those behind it have not been sent any more.
    pub(super) fn refuse(&mut self, index: u8, code: u8) {
        self.end(index, index.wrapping_add(1), Outcome::Refused, code);
        self.end(index, self.count, Outcome::Dropped, code);
        self.sent = index;
    }

    /// Whether an end is to be told.
    pub(super) fn has_ended(&self) -> bool {
        self.count > 0 && self.at(0).is_some_and(|oldest| oldest.outcome != 0)
    }

    /// Takes the oldest move away if it has ended, and tells how.
    pub(super) fn take_ended(&mut self) -> Option<(Outcome, u8)> {
        let oldest = self.at(0).filter(|_| self.count > 0)?;
        let ended = (Outcome::of(oldest.outcome)?, oldest.code);
        if self.sent > 0 {
            let place = self.place(0);
            if let Some(oldest) = self.moves.get(place) {
                self.base.copy(&oldest.target);
            }
            self.first = self.first.wrapping_add(1) & NUMBER_MAX;
            self.sent = self.sent.wrapping_sub(1);
        }
        self.head = u8::try_from(self.place(1)).unwrap_or_default();
        self.count = self.count.wrapping_sub(1);
        Some(ended)
    }

    pub(super) const fn len(&self) -> u8 {
        self.count
    }

    fn place(&self, index: u8) -> usize {
        let place = usize::from(self.head).wrapping_add(usize::from(index));
        if place < GX_WINDOW_MAX { place } else { place.wrapping_sub(GX_WINDOW_MAX) }
    }

    fn at(&self, index: u8) -> Option<&Requested> {
        self.moves.get(self.place(index))
    }
}
