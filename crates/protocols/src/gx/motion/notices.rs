//! What is to be sent besides the ends of queued moves: error notices, and ends that are sent again.

use zerocopy::{FromBytes, Immutable, KnownLayout};

use crate::gx::{Format, Numbered};

/// A notice.
#[derive(Clone, Copy, Debug, FromBytes, Immutable, KnownLayout)]
pub(super) struct Notice {
    pub(super) number: Numbered,
    /// The code, 0 for a completion; the high bit is set where the command was in ASCII.
    code: u8,
}

impl Notice {
    pub(super) const fn format(self) -> Format {
        if self.code & ASCII == 0 { Format::Binary } else { Format::Ascii }
    }

    pub(super) const fn code(self) -> u8 {
        self.code & !ASCII
    }
}

const ASCII: u8 = 0x80;
const ROOM: usize = 4;

/// A few notices, the oldest first.
#[derive(Clone, Debug, FromBytes, Immutable, KnownLayout)]
#[repr(C)]
pub(super) struct Notices {
    count: u8,
    list: [Notice; ROOM],
}

impl Notices {
    /// Whether there is room for what one command brings about, and one more.
    pub(super) const fn has_room(&self) -> bool {
        self.count <= 2
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.count == 0
    }

    pub(super) const fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds a notice, 0 being the code of a completion.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub(super) fn push(&mut self, number: Numbered, format: Format, code: u8) {
        if let Some(place) = self.list.get_mut(usize::from(self.count)) {
            let ascii = if format == Format::Ascii { ASCII } else { 0 };
            *place = Notice { number, code: code & !ASCII | ascii };
            self.count = self.count.wrapping_add(1);
        }
    }

    pub(super) fn first(&self) -> Option<Notice> {
        if self.is_empty() { None } else { self.list.first().copied() }
    }

    pub(super) fn pop(&mut self) {
        let [first, second, third, fourth] = &mut self.list;
        (*first, *second, *third) = (*second, *third, *fourth);
        self.count = self.count.saturating_sub(1);
    }
}
