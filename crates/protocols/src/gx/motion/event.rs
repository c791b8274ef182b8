//! What a motion side reports to its firmware.

use zerocopy::{FromBytes, Immutable, KnownLayout};

use crate::gx::{Number, Numbered};

/// Something that happened at the motion side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A move was queued.
    Queued(Option<Number>),
    /// A move that was queued before came again. Nothing is to be done.
    Repeated(Option<Number>),
    /// A command was refused, with this code.
    Refused(Option<Number>, u8),
    /// A host has begun a session with this number.
    Begun(Option<Number>),
    /// The position is to be reported each so many milliseconds; 0: not any more. (The library does that.)
    Reporting(u16),
    /// A host wants the machine to hold, that is, to stop for now: no further moves are handed out.
    Hold,
    /// A host wants the machine to go on.
    Resume,
    /// The machine is to stop, for good: by a host's wish, as [`Fault::Stopped`](crate::gx::Fault::Stopped), or since
    /// it is silent, as [`Fault::Silent`](crate::gx::Fault::Silent). No moves are handed out; when it stands,
    /// [`stop`](super::Motion::stop) has to be called.
    Stop(u8),
}

pub(super) const QUEUED: u8 = 1;
pub(super) const REPEATED: u8 = 2;
pub(super) const REFUSED: u8 = 3;
pub(super) const BEGUN: u8 = 4;
pub(super) const REPORTING: u8 = 5;
pub(super) const HOLD: u8 = 6;
pub(super) const RESUME: u8 = 7;
pub(super) const STOP: u8 = 8;

/// The event that was not fetched yet.
#[derive(Clone, Debug, FromBytes, Immutable, KnownLayout)]
pub(super) struct Pending {
    number: Numbered,
    period: u16,
    code: u8,
    /// One of the above; else there is none.
    kind: u8,
}

impl Pending {
    pub(super) const fn new() -> Self {
        Self { number: Numbered::NONE, period: 0, code: 0, kind: 0 }
    }

    pub(super) const fn is_none(&self) -> bool {
        self.kind == 0
    }

    pub(super) const fn set(&mut self, kind: u8, number: Numbered, code: u8) {
        (self.kind, self.number, self.code) = (kind, number, code);
    }

    pub(super) const fn set_reporting(&mut self, period: u16) {
        (self.kind, self.period) = (REPORTING, period);
    }

    pub(super) const fn take(&mut self) -> Option<Event> {
        let (kind, number) = (self.kind, self.number.get());
        self.kind = 0;
        Some(match kind {
            QUEUED => Event::Queued(number),
            REPEATED => Event::Repeated(number),
            REFUSED => Event::Refused(number, self.code),
            BEGUN => Event::Begun(number),
            REPORTING => Event::Reporting(self.period),
            HOLD => Event::Hold,
            RESUME => Event::Resume,
            STOP => Event::Stop(self.code),
            _ => return None,
        })
    }
}
