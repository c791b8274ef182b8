//! Position reports.

use core::ffi::{c_uchar, c_ulong, c_ushort};

use super::notices::format_of;
use crate::clock::{left, stamp};
use crate::gx::Format;

/// When the position is to be reported. Its fields are private.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Reports {
    sent_at: c_ulong,
    /// In milliseconds; 0: none are wanted.
    period: c_ushort,
    format: c_uchar,
    /// One is due now.
    due: c_uchar,
}

impl Reports {
    pub(super) const fn new() -> Self {
        Self { sent_at: 0, period: 0, format: 0, due: 0 }
    }

    /// A host asks for reports.
    pub(super) fn switch(&mut self, period: u16, format: Format) {
        self.period = period;
        self.format = format as c_uchar;
        self.due = c_uchar::from(period != 0);
    }

    /// One report, whatever was asked for. `format` if nothing ever was.
    pub(super) fn one(&mut self, format: Format) {
        self.due = 1;
        if self.format == 0 {
            self.format = format as c_uchar;
        }
    }

    pub(super) fn left(&self, now: u32) -> Option<u32> {
        match (self.due, self.period) {
            (0, 0) => None,
            (0, period) => Some(left(now, self.sent_at, period.into())),
            _ => Some(0),
        }
    }

    pub(super) fn format(&self) -> Format {
        format_of(self.format)
    }

    pub(super) fn sent(&mut self, now: u32) {
        self.due = 0;
        self.sent_at = stamp(now);
    }
}
