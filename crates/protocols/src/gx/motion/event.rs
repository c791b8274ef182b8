//! What a motion side tells its firmware.

use core::ffi::{c_uchar, c_ushort};

use super::notices::{pack, unpack};
use crate::gx::Number;

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
}

/// An event that was not fetched yet. Its fields are private.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Untold {
    /// Number, or period.
    value: c_ushort,
    numbered: c_uchar,
    code: c_uchar,
    /// 0: none.
    kind: c_uchar,
}

impl Untold {
    pub(super) const fn new() -> Self {
        Self { value: 0, numbered: 0, code: 0, kind: 0 }
    }

    pub(super) const fn is_none(&self) -> bool {
        self.kind == 0
    }

    pub(super) fn put(&mut self, event: Event) {
        let (kind, number, code) = match event {
            Event::Queued(number) => (1, number, 0),
            Event::Repeated(number) => (2, number, 0),
            Event::Refused(number, code) => (3, number, code),
            Event::Begun(number) => (4, number, 0),
            Event::Reporting(_) => (5, None, 0),
        };
        (self.value, self.numbered) = pack(number);
        if let Event::Reporting(period) = event {
            self.value = period;
        }
        (self.kind, self.code) = (kind, code);
    }

    pub(super) fn take(&mut self) -> Option<Event> {
        let number = unpack(self.value, self.numbered);
        let event = match self.kind {
            1 => Event::Queued(number),
            2 => Event::Repeated(number),
            3 => Event::Refused(number, self.code),
            4 => Event::Begun(number),
            5 => Event::Reporting(self.value),
            _ => {
                self.kind = 0;
                return None;
            }
        };
        self.kind = 0;
        Some(event)
    }
}
