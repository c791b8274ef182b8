//! What commands and notices are made of besides vectors: numbers, formats, kinds and codes.

use zerocopy::{FromBytes, Immutable, KnownLayout, TryFromBytes};

use super::packed::{NUMBER_MAX, halves};

/// How something is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Format {
    /// Bytes with the high bit set behind a start byte.
    Binary = 1,
    /// Text, up to the end of the line.
    Ascii = 2,
}

/// The number of a command, `#` in front of it. It is sent back in the format in which it came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Number {
    /// 0 to [`NUMBER_MAX`].
    pub value: u16,
    /// Of the number, which need not be that of its command.
    pub format: Format,
}

/// A number or none, as state keeps it: the format in the two bits above the value, 0 for none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromBytes, Immutable, KnownLayout)]
pub struct Numbered(u16);

impl Numbered {
    /// No number.
    pub const NONE: Self = Self(0);

    /// A number of that format; the lowest 14 bits of `value` count.
    pub const fn new(value: u16, format: Format) -> Self {
        Self(value & NUMBER_MAX | (format as u16) << 14)
    }

    /// Whether there is a number.
    pub const fn is_some(self) -> bool {
        self.0 != 0
    }

    /// Its value; 0 without one.
    pub const fn value(self) -> u16 {
        self.0 & NUMBER_MAX
    }

    /// Its format; ASCII without one.
    pub const fn format(self) -> Format {
        if self.0 >> 14 == Format::Binary as u16 { Format::Binary } else { Format::Ascii }
    }

    /// The number, if there is one.
    pub const fn get(self) -> Option<Number> {
        if self.is_some() { Some(Number { value: self.value(), format: self.format() }) } else { None }
    }
}

impl From<Option<Number>> for Numbered {
    fn from(number: Option<Number>) -> Self {
        number.map_or(Self::NONE, |number| Self::new(number.value, number.format))
    }
}

/// What a receiver found. The receiver holds the details until its next call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// Command: go to the vector's positions (long form or ASCII); without axes, its velocity is that of moves to come.
    Move = 1,
    /// Command: go on by the deltas of the vector, -64 to 63 steps each, by the short form.
    Step = 2,
    /// Command: report the position each so many milliseconds; 0: never.
    Reporting = 3,
    /// What came is none of these; the code is a [`Fault`]'s.
    Malformed = 4,
    /// Notice: the command with this number was carried out.
    Completed = 5,
    /// Notice: the command, with this number if any, was not; the code, 0 to 127, is a [`Fault`]'s or the controller's.
    Refused = 6,
    /// Notice: the position is the vector's; with a velocity, the machine was stopped there, and that one is in force.
    Position = 7,
    /// Notice: in a session, the move whose number ends so was carried out; see [`check`](super::Vector::check).
    Confirmed = 8,
    /// Command: one of [`Control`], or others that are not known.
    Control = 9,
    /// Notice: what [`Status`] says.
    Status = 10,
}

/// What a host asks for past the queue: an extension, which a motion side that does not know it refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, TryFromBytes)]
#[repr(u8)]
pub enum Control {
    /// The status.
    Query = 0,
    /// To hold now: the move that is carried out, too.
    Hold = 1,
    /// To go on.
    Resume = 2,
    /// To stop now and forget all moves.
    Stop = 3,
}

impl Control {
    /// As it is written, in 14 bits: the code and its complement, so that no flipped bit makes one of another command.
    pub const fn bits(self) -> u16 {
        127_u16.wrapping_mul((self as u16).wrapping_add(1))
    }

    /// What was written asks for.
    pub fn of(bits: u16) -> Option<Self> {
        let [complement, code] = halves(bits);
        if code ^ complement == 0x7F { Self::try_read_from_bytes(&[code]).ok() } else { None }
    }
}

/// How a motion side is, in 14 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status {
    /// How many more moves it has room for.
    pub free: u8,
    /// Whether it holds: bit 8.
    pub is_held: bool,
}

impl Status {
    /// As it is written.
    pub const fn bits(self) -> u16 {
        self.free as u16 | (self.is_held as u16) << 8
    }

    /// Of what was written; bits that mean nothing are ignored.
    pub const fn of(bits: u16) -> Self {
        let [free, flags] = bits.to_le_bytes();
        Self { free, is_held: flags & 1 != 0 }
    }
}

/// What is wrong with a command: the code of the error notice that answers it. Codes from 64 on are left to users.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// No command begins like that.
    Unknown = 1,
    /// No number from 0 to 16383. Text behind it is skipped; `!`, `*` or `~` begins a command without a number.
    Number = 2,
    /// Another command began before this one was complete, or the line fell silent.
    Interrupted = 3,
    /// A byte that has no place there.
    Syntax = 4,
    /// It names no axis and no velocity.
    Empty = 5,
    /// It names an axis, or the velocity, twice.
    Repeated = 6,
    /// A value does not fit.
    Range = 7,
    /// A step leads out of the positions that 28 bits hold, or starts where the position is not known.
    Limit = 8,
    /// There is no room for another command.
    Busy = 9,
    /// The number is not the next of its session.
    Order = 16,
    /// A session is over, or none has begun and moves are taken in sessions only.
    Closed = 17,
    /// A move without a number where numbers are in order.
    Numberless = 18,
    /// The machine does not have that axis.
    Axis = 19,
    /// The machine has stopped: this move was not finished, those behind it are dropped.
    Stopped = 20,
    /// The host was silent for too long.
    Silent = 21,
}

/// The first of the codes that firmware may use as it likes, instead of [`Fault::Stopped`].
pub const CODE_FREE: u8 = 64;
