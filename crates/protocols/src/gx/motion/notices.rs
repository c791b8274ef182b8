//! What is to be told besides the ends of queued moves: errors, and ends that are told again.

use core::ffi::{c_uchar, c_ushort};

use crate::gx::{Format, Number};

/// A notice, its command's number and format packed. Its fields are private.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Notice {
    number: c_ushort,
    /// What `pack` made of the number's format.
    numbered: c_uchar,
    format: c_uchar,
    /// 0: completed.
    code: c_uchar,
}

/// A few notices, the oldest first. Its fields are private.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Notices {
    list: [Notice; 4],
    count: c_uchar,
}

/// A number as structs hold it.
pub(super) const fn pack(number: Option<Number>) -> (c_ushort, c_uchar) {
    match number {
        None => (0, 0),
        Some(Number { value, format }) => (value, format as c_uchar),
    }
}

pub(super) const fn unpack(number: c_ushort, numbered: c_uchar) -> Option<Number> {
    match numbered {
        0 => None,
        _ => Some(Number { value: number, format: format_of(numbered) }),
    }
}

pub(super) const fn format_of(stored: c_uchar) -> Format {
    if stored == Format::Ascii as c_uchar { Format::Ascii } else { Format::Binary }
}

impl Notice {
    pub(super) fn number(self) -> Option<Number> {
        unpack(self.number, self.numbered)
    }

    pub(super) fn format(self) -> Format {
        format_of(self.format)
    }

    pub(super) fn code(self) -> u8 {
        self.code
    }
}

impl Notices {
    pub(super) const fn new() -> Self {
        Self { list: [Notice { number: 0, numbered: 0, format: 0, code: 0 }; 4], count: 0 }
    }

    /// Whether there is room for what one command brings about, and one more.
    pub(super) const fn has_room(&self) -> bool {
        self.count <= 2
    }

    pub(super) const fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds a notice, 0 being the code of one that says completed.
    pub(super) fn push(&mut self, number: Option<Number>, format: Format, code: u8) {
        if let Some(place) = self.list.get_mut(usize::from(self.count)) {
            let (number, numbered) = pack(number);
            *place = Notice { number, numbered, format: format as c_uchar, code };
            self.count = self.count.wrapping_add(1);
        }
    }

    pub(super) fn first(&self) -> Option<Notice> {
        if self.count == 0 { None } else { self.list.first().copied() }
    }

    pub(super) fn pop(&mut self) {
        let [first, second, third, fourth] = &mut self.list;
        *first = *second;
        *second = *third;
        *third = *fourth;
        self.count = self.count.min(4).saturating_sub(1);
    }
}
