//! What a motion side reports to its firmware.

use core::mem::take;

use zerocopy::{FromBytes, Immutable, KnownLayout, TryFromBytes};

use crate::gx::Numbered;

/// What happened at the motion side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, TryFromBytes)]
#[repr(u8)]
pub enum EventKind {
    /// A move was queued.
    Queued = 1,
    /// A move that was queued before came again. Nothing is to be done.
    Repeated = 2,
    /// A command was refused.
    Refused = 3,
    /// A host has begun a session with this number.
    Begun = 4,
    /// The position is to be reported each so many milliseconds; 0: not any more. (The library does that.)
    Reporting = 5,
    /// A host wants the machine to hold, that is, to pause: no further moves are handed out.
    Hold = 6,
    /// A host wants the machine to go on.
    Resume = 7,
    /// The machine is to stop, for good. No moves are handed out; when it stands, [`stop`](super::Motion::stop) has to
    /// be called.
    Stop = 8,
}

/// Something that happened at the motion side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// What.
    pub kind: EventKind,
    /// The number of the command that brought it about; none from [`Reporting`](EventKind::Reporting) on.
    pub number: Numbered,
    /// Of [`Refused`](EventKind::Refused) and [`Stop`](EventKind::Stop), why: the code of a
    /// [`Fault`](crate::gx::Fault); 0 of others.
    pub code: u8,
    /// Of [`Reporting`](EventKind::Reporting), the period; 0 of others.
    pub period: u16,
}

/// The event that was not fetched yet.
#[derive(Clone, Debug, FromBytes, Immutable, KnownLayout)]
#[repr(C)]
pub(super) struct Pending {
    /// An [`EventKind`]; else there is none.
    kind: u8,
    code: u8,
    number: Numbered,
}

impl Pending {
    pub(super) const fn is_none(&self) -> bool {
        self.kind == 0
    }

    pub(super) fn set(&mut self, kind: Option<EventKind>, number: Numbered, code: u8) {
        (self.kind, self.number, self.code) = (kind.map_or(0, |kind| kind as u8), number, code);
    }

    /// `period` is that of reports.
    pub(super) fn take(&mut self, period: u16) -> Option<Event> {
        let kind = EventKind::try_read_from_bytes(&[take(&mut self.kind)]).ok()?;
        let number = if kind < EventKind::Reporting { self.number } else { Numbered::NONE };
        let period = if kind == EventKind::Reporting { period } else { 0 };
        Some(Event { kind, number, code: self.code, period })
    }
}
