//! The moves that were requested and whose ends were not fetched yet.

use zerocopy::{FromBytes, Immutable, KnownLayout, TryFromBytes};

use super::Outcome;
use crate::bytes::wrap;
use crate::gx::{AXES, MASK_AXES, MASK_VELOCITY, NUMBER_MAX, Vector};

/// A requested move.
#[derive(Clone, Copy, Debug, FromBytes, Immutable, KnownLayout)]
struct Requested {
    /// Where all axes are after it and the velocity then in force, as far as the mask says that they are known.
    target: Vector,
    /// The mask of what was requested.
    named: u8,
    /// Whether it was sent as absolute positions.
    absolute: u8,
    /// 0, or how it ended and why.
    outcome: u8,
    code: u8,
}

/// The requested moves, the oldest first: some that were sent, then some that were not.
#[derive(Clone, Debug, FromBytes, Immutable, KnownLayout)]
pub(super) struct Window<const SIZE: usize> {
    moves: [Requested; SIZE],
    /// Where the last move that is not among them any more leads to.
    base: Vector,
    /// The number of the oldest, if that was sent.
    first: u16,
    head: u8,
    pub(super) count: u8,
    /// How many have been sent in this session, and have their numbers.
    pub(super) sent: u8,
}

impl<const SIZE: usize> Window<SIZE> {
    /// Puts a move behind the others; `false` if there is no room.
    pub(super) fn push(&mut self, target: &Vector) -> bool {
        let has_room = usize::from(self.count) < SIZE;
        if let Some(requested) = self.at_mut(self.count).filter(|_| has_room) {
            requested.target.copy(target);
            (requested.named, requested.absolute) = (target.mask, 0);
            (requested.outcome, requested.code) = (0, 0);
            self.count = self.count.wrapping_add(1);
        }
        has_room
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

    /// Which of the moves that were sent and have not ended has a number with these lowest bits.
    pub(super) fn find(&self, number: u16, mask: u16) -> Option<u8> {
        let index = u8::try_from(number.wrapping_sub(self.first) & mask).ok()?;
        (self.oldest()?..self.sent).contains(&index).then_some(index)
    }

    /// The check of a move that was sent.
    pub(super) fn check(&self, index: u8) -> Option<u8> {
        let target = &self.at(index)?.target;
        Some(target.check(target.mask, self.number(index)))
    }

    /// Whether a reported position lies on the way: between where the moves that have not ended lead, axis by axis.
    pub(super) fn is_on_plan(&self, position: &Vector) -> bool {
        let start = self.oldest().unwrap_or(self.sent);
        let before = self.before(start);
        (0..AXES).all(|axis| {
            let (Some(at), Some(from)) = (position.axis(axis), before.axis(axis)) else { return true };
            let targets = (start..self.sent).filter_map(|index| self.at(index)?.target.axis(axis));
            let (least, most) = targets.fold((from, from), |(least, most), to| (least.min(to), most.max(to)));
            (least..=most).contains(&at)
        })
    }

    /// The oldest move that was sent and has not ended.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub(super) fn oldest(&self) -> Option<u8> {
        (0..self.sent).find(|index| self.at(*index).is_some_and(|requested| requested.outcome == 0))
    }

    /// Whether a move waits to be sent, nothing before it having gone wrong.
    pub(super) fn has_next(&self) -> bool {
        self.sent < self.count && self.at(self.sent).is_some_and(|requested| requested.outcome == 0)
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

    /// What corrects a deviation: the positions of all axes that are known, and the velocity.
    pub(super) fn command_for_all(&self, index: u8, out: &mut Vector) {
        out.copy(self.before(index));
        if let Some(requested) = self.at(index) {
            out.merge(&requested.target);
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
        if let Some(requested) = self.at_mut(index) {
            requested.absolute = 1;
        }
    }

    /// Whether it was, in case.
    pub(super) fn is_absolute(&self, index: u8) -> bool {
        self.at(index).is_some_and(|requested| requested.absolute != 0)
    }

    /// The next move has been sent: what it does not name stays where the move before leads to.
    pub(super) fn advance(&mut self) {
        let mut target = Vector::new();
        self.command_for_all(self.sent, &mut target);
        if let Some(requested) = self.at_mut(self.sent) {
            requested.target.copy(&target);
        }
        self.sent = self.sent.wrapping_add(1);
    }

    /// The moves from one on to before another have ended, those of them that had not yet.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub(super) fn end(&mut self, from: u8, to: u8, outcome: Outcome, code: u8) {
        for index in from..to.min(self.count) {
            if let Some(requested) = self.at_mut(index).filter(|requested| requested.outcome == 0) {
                (requested.outcome, requested.code) = (outcome as u8, code);
            }
        }
    }

    /// Whether the end of the oldest is to be fetched.
    pub(super) fn has_ended(&self) -> bool {
        self.count > 0 && self.at(0).is_some_and(|oldest| oldest.outcome != 0)
    }

    /// Takes the oldest move away if it has ended, and returns how.
    pub(super) fn take_ended(&mut self) -> Option<(Outcome, u8)> {
        let oldest = self.at(0).filter(|_| self.has_ended())?;
        let outcome = Outcome::try_read_from_bytes(&[oldest.outcome]).unwrap_or(Outcome::TimedOut);
        let code = oldest.code;
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
        Some((outcome, code))
    }

    fn place(&self, index: u8) -> usize {
        wrap::<SIZE>(usize::from(self.head).wrapping_add(index.into()))
    }

    fn at(&self, index: u8) -> Option<&Requested> {
        self.moves.get(self.place(index))
    }

    fn at_mut(&mut self, index: u8) -> Option<&mut Requested> {
        let place = self.place(index);
        self.moves.get_mut(place)
    }
}
