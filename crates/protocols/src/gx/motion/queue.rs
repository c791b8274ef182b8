//! The moves that wait, are carried out, or have ended without their host knowing yet.

use zerocopy::{FromBytes, Immutable};

use crate::bytes::wrap;
use crate::gx::{AXES, Lost, MASK_AXES, Numbered, Vector};

/// A queued move.
#[derive(Clone, Copy, Debug, FromBytes, Immutable)]
#[repr(C)]
struct Queued {
    /// The number whose end a host waits for.
    number: Numbered,
    /// Of a session, what the host compares with its plan.
    check: u8,
    /// Where all axes are to be after it, the velocity in force, and which axes it names.
    target: Vector,
}

const REPORTED: u8 = 0x80;

/// The queue of a motion side: first the moves that have ended, then those that are carried out, then those that wait.
#[derive(Clone, Debug, FromBytes, Immutable)]
#[repr(C)]
pub(super) struct Queue<const SIZE: usize> {
    head: u8,
    count: u8,
    /// How many of them the firmware has taken, and how many of these it has done.
    begun: u8,
    done: u8,
    /// The axes, and the velocity, that were named in this session.
    named: u8,
    /// The check of the move whose end was reported last in this session, and [`REPORTED`]; 0: there was none.
    reported: u8,
    /// Where the last of them leads to; the mask flags the axes whose place is known.
    pub(super) last: Vector,
    moves: [Queued; SIZE],
}

impl<const SIZE: usize> Queue<SIZE> {
    #[expect(clippy::cast_possible_truncation, reason = "at most 255")]
    const CAPACITY: u8 = SIZE as u8;

    pub(super) const fn new() -> Self {
        const NONE: Queued = Queued { target: Vector::new(), number: Numbered::NONE, check: 0 };
        Self { moves: [NONE; SIZE], last: Vector::new(), head: 0, count: 0, begun: 0, done: 0, named: 0, reported: 0 }
    }

    /// How many moves have not ended.
    pub(super) const fn unfinished(&self) -> u8 {
        self.count.saturating_sub(self.done)
    }

    /// The number of the oldest of them whose end a host waits for: of those with this number, if it is one.
    pub(super) fn awaited(&self, wanted: Numbered) -> Numbered {
        for index in self.done..self.count {
            let number = self.at(index).map_or(Numbered::NONE, |queued| queued.number);
            if number.is_some() && (!wanted.is_some() || number.value() == wanted.value()) {
                return number;
            }
        }
        Numbered::NONE
    }

    /// Puts a move behind the others. There has to be room. When it leads nowhere, nothing changes.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub(super) fn push(&mut self, vector: &Vector, is_step: bool, number: Numbered) -> Result<(), Lost> {
        self.last.follow(vector, is_step)?;
        self.named |= vector.mask;
        let place = self.place(self.count);
        if let Some(queued) = self.moves.get_mut(place) {
            queued.target.copy(&self.last);
            queued.target.mask = self.last.mask & !MASK_AXES | vector.mask & MASK_AXES;
            queued.number = number;
            queued.check = self.last.check(self.named, number.value());
            self.count = self.count.wrapping_add(1);
        }
        self.tidy();
        Ok(())
    }

    /// The next move to carry out, which is taken.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub(super) fn next(&mut self) -> Option<(&Vector, Numbered)> {
        // Those that only set the velocity are nothing to carry out.
        while self.begun < self.count && self.at(self.begun).is_some_and(|queued| !queued.moves()) {
            self.begun = self.begun.wrapping_add(1);
        }
        if self.begun >= self.count {
            return None;
        }
        let index = self.begun;
        self.begun = index.wrapping_add(1);
        self.at(index).map(|queued| (&queued.target, queued.number))
    }

    /// The oldest move that was taken has ended; `false` when there is none.
    pub(super) fn end(&mut self) -> bool {
        let ended = self.done < self.begun && self.begun <= self.count;
        if ended {
            self.done = self.done.wrapping_add(1);
            self.tidy();
        }
        ended
    }

    /// The number and the check of the oldest move that has ended, to be reported.
    pub(super) fn ended(&self) -> Option<(Numbered, u8)> {
        self.at(0).filter(|_| self.has_ended()).map(|queued| (queued.number, queued.check))
    }

    /// Whether there is one.
    pub(super) const fn has_ended(&self) -> bool {
        self.done > 0 && self.count > 0
    }

    /// That was reported, with this check.
    pub(super) fn pop_ended(&mut self, check: u8) {
        self.reported = check | REPORTED;
        self.drop_first();
        self.tidy();
    }

    /// The check of the move whose end was reported last.
    pub(super) const fn reported(&self) -> Option<u8> {
        if self.reported & REPORTED == 0 { None } else { Some(self.reported & !REPORTED) }
    }

    /// How many more moves there is room for.
    pub(super) const fn free(&self) -> u8 {
        Self::CAPACITY.saturating_sub(self.count)
    }

    /// No ends are reported any more of the moves that are queued by now.
    pub(super) fn begin_session(&mut self) {
        (self.named, self.reported) = (0, 0);
        for queued in &mut self.moves {
            queued.number = Numbered::NONE;
        }
        self.tidy();
    }

    /// Drops the moves that have not ended. Where the machine is then is not known.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub(super) fn drop_unfinished(&mut self) {
        self.count = self.done.min(self.count);
        self.begun = self.count;
        self.last.mask &= !MASK_AXES;
    }

    /// The axes that nobody knows the place of are there.
    pub(super) fn starts_at(&mut self, position: &[i32; AXES]) {
        let mut known = self.last.mask;
        for (place, value) in self.last.axes.iter_mut().zip(position) {
            if known & 1 == 0 {
                *place = *value;
            }
            known >>= 1;
        }
        self.last.mask |= MASK_AXES;
    }

    /// What has ended, and nobody waits for, is gone; what only sets the velocity ends with the moves before it.
    fn tidy(&mut self) {
        while self.done < self.count && self.at(self.done).is_some_and(|queued| !queued.moves()) {
            self.done = self.done.wrapping_add(1);
            self.begun = self.begun.max(self.done);
        }
        while self.has_ended() && self.at(0).is_some_and(|queued| !queued.number.is_some()) {
            self.drop_first();
        }
    }

    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    fn drop_first(&mut self) {
        self.head = u8::try_from(self.place(1)).unwrap_or_default();
        self.count = self.count.saturating_sub(1);
        self.begun = self.begun.saturating_sub(1);
        self.done = self.done.saturating_sub(1);
    }

    fn place(&self, index: u8) -> usize {
        wrap::<SIZE>(usize::from(self.head).wrapping_add(index.into()))
    }

    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    fn at(&self, index: u8) -> Option<&Queued> {
        self.moves.get(self.place(index))
    }
}

impl Queued {
    const fn moves(&self) -> bool {
        self.target.mask & MASK_AXES != 0
    }
}
