//! Position reports, and the status.

use zerocopy::{FromBytes, Immutable, KnownLayout};

use crate::gx::Format;
use crate::session::left;

/// The time that is left until something that does not come.
pub(super) const NEVER: u32 = u32::MAX;

/// When the position is to be reported.
#[derive(Clone, Debug, FromBytes, Immutable, KnownLayout)]
#[repr(C)]
pub(super) struct Reports {
    /// A [`Format`]; 0: nothing was ever asked for.
    format: u8,
    /// One is due now.
    pub(super) due: u8,
    /// The status is due now.
    pub(super) status_due: u8,
    /// In milliseconds; 0: none are wanted.
    pub(super) period: u16,
    pub(super) sent_at: u32,
}

impl Reports {
    /// A host asks for reports.
    pub(super) fn switch(&mut self, period: u16, format: Format) {
        self.period = period;
        self.format = format as u8;
        self.due = (period != 0).into();
    }

    /// One report, whatever was asked for. `format` if nothing ever was.
    pub(super) fn one(&mut self, format: Format) {
        self.due = 1;
        if self.format == 0 {
            self.format = format as u8;
        }
    }

    /// What is asked for past the queue is answered in this format, by the status if it `wants_status`.
    pub(super) const fn answer(&mut self, format: Format, wants_status: bool) {
        self.format = format as u8;
        self.status_due = wants_status as u8;
    }

    /// How long until one is due, or [`NEVER`].
    pub(super) fn left(&self, now: u32) -> u32 {
        if self.due != 0 {
            0
        } else if self.period == 0 {
            NEVER
        } else {
            left(now, self.sent_at, self.period.into())
        }
    }

    /// Whether any are wanted.
    pub(super) const fn is_on(&self) -> bool {
        self.due != 0 || self.period != 0
    }

    pub(super) fn format(&self) -> Format {
        if self.format == Format::Ascii as u8 { Format::Ascii } else { Format::Binary }
    }
}
