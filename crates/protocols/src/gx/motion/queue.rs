//! The moves that wait, are carried out, or have ended without their host knowing yet.

use core::ffi::{c_uchar, c_ushort};

use super::notices::{pack, unpack};
use crate::config::GX_QUEUE_MAX;
use crate::gx::{Lost, MASK_AXES, Message, Number, Vector};

/// A queued move. Its fields are private.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Queued {
    /// Where all axes are to be after it, the velocity in force, and which axes it names.
    target: Vector,
    number: c_ushort,
    numbered: c_uchar,
}

/// The queue of a motion side: first the moves that have ended, then those that are carried out, then those that wait.
/// Its fields are private.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Queue {
    moves: [Queued; GX_QUEUE_MAX],
    /// Where the last of them leads to; the mask tells the axes whose place is known.
    last: Vector,
    head: c_uchar,
    count: c_uchar,
    /// How many of them the firmware has taken, and how many of these it has done.
    begun: c_uchar,
    done: c_uchar,
}

impl Queue {
    pub(super) const fn new() -> Self {
        const NONE: Queued = Queued { target: Vector::new(), number: 0, numbered: 0 };
        Self { moves: [NONE; GX_QUEUE_MAX], last: Vector::new(), head: 0, count: 0, begun: 0, done: 0 }
    }

    pub(super) fn has_room(&self) -> bool {
        usize::from(self.count) < GX_QUEUE_MAX
    }

    /// How many moves have not ended.
    pub(super) const fn unfinished(&self) -> u8 {
        self.count.saturating_sub(self.done)
    }

    /// The numbers of those of them whose end a host waits for, the oldest first.
    pub(super) fn awaited(&self) -> impl Iterator<Item = Number> {
        (self.done..self.count).filter_map(|index| self.at(index)?.number())
    }

    /// Puts a move behind the others. There has to be room.
    ///
    /// # Errors
    ///
    /// When it leads nowhere: nothing changes then.
    pub(super) fn push(&mut self, message: &Message<'_>, named: u8, number: Option<Number>) -> Result<(), Lost> {
        self.last.follow(message)?;
        let place = self.place(self.count);
        if let Some(queued) = self.moves.get_mut(place) {
            queued.target.copy(&self.last);
            queued.target.mask &= !MASK_AXES;
            queued.target.mask |= named & MASK_AXES;
            (queued.number, queued.numbered) = pack(number);
            self.count = self.count.wrapping_add(1);
        }
        self.tidy();
        Ok(())
    }

    /// The next move to carry out, which is taken.
    pub(super) fn next(&mut self) -> Option<(&Vector, Option<Number>)> {
        // Those that only set the velocity are nothing to carry out.
        while self.begun < self.count && self.at(self.begun).is_some_and(|queued| !queued.moves()) {
            self.begun = self.begun.wrapping_add(1);
        }
        if self.begun >= self.count {
            return None;
        }
        let index = self.begun;
        self.begun = index.wrapping_add(1);
        self.at(index).map(|queued| (&queued.target, queued.number()))
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

    /// The number of the oldest move that has ended, to be told.
    pub(super) fn ended(&self) -> Option<Number> {
        self.at(0).filter(|_| self.done > 0 && self.count > 0)?.number()
    }

    /// That was told.
    pub(super) fn told(&mut self) {
        self.drop_first();
        self.tidy();
    }

    /// No ends are told any more of the moves that are queued by now.
    pub(super) fn silence(&mut self) {
        for queued in &mut self.moves {
            queued.numbered = 0;
        }
        self.tidy();
    }

    /// Drops the moves that have not ended. Where the machine is then is not known.
    pub(super) fn drop_unfinished(&mut self) {
        self.count = self.done.min(self.count);
        self.begun = self.count;
        self.last.mask &= !MASK_AXES;
    }

    /// The axes that nobody knows the place of are there.
    pub(super) fn starts_at(&mut self, position: &[i32; 6]) {
        for (axis, value) in position.iter().enumerate() {
            if !self.last.has(axis) {
                self.last.set(axis, *value);
            }
        }
    }

    /// What has ended, and nobody waits for, is gone; what only sets the velocity ends with the moves before it.
    fn tidy(&mut self) {
        while self.done < self.count && self.at(self.done).is_some_and(|queued| !queued.moves()) {
            self.done = self.done.wrapping_add(1);
            self.begun = self.begun.max(self.done);
        }
        while self.done > 0 && self.count > 0 && self.at(0).is_some_and(|queued| queued.numbered == 0) {
            self.drop_first();
        }
    }

    fn drop_first(&mut self) {
        self.head = u8::try_from(self.place(1)).unwrap_or_default();
        self.count = self.count.saturating_sub(1);
        self.begun = self.begun.saturating_sub(1);
        self.done = self.done.saturating_sub(1);
    }

    fn place(&self, index: u8) -> usize {
        let place = usize::from(self.head).wrapping_add(usize::from(index));
        if place < GX_QUEUE_MAX { place } else { place.wrapping_sub(GX_QUEUE_MAX) }
    }

    fn at(&self, index: u8) -> Option<&Queued> {
        self.moves.get(self.place(index))
    }
}

impl Queued {
    /// The number that its host waits for.
    const fn number(&self) -> Option<Number> {
        unpack(self.number, self.numbered)
    }

    const fn moves(&self) -> bool {
        self.target.mask & MASK_AXES != 0
    }
}
