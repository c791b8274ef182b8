//! What is said: vectors, their numbers, and what a receiver makes of the bytes.

use core::ffi::{c_int, c_uchar};

use super::packed::POSITIONS;

/// The axes: x, y, z, a, b, c.
pub const AXES: usize = 6;
/// The bits of a mask that flag axes: bit i is axis i.
pub const MASK_AXES: u8 = 0x3F;
/// The bit of a mask that flags a velocity.
pub const MASK_VELOCITY: u8 = 0x40;

/// How something is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Format {
    /// Bytes with the high bit set behind a start byte.
    Binary = 1,
    /// Text, up to the end of the line.
    Ascii = 2,
}

const ASCII: u8 = Format::Ascii as u8;

/// The number of a command, `#` in front of it. It is sent back in the format in which it came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Number {
    /// 0 to [`NUMBER_MAX`](super::NUMBER_MAX).
    pub value: u16,
    /// Of the number, which need not be that of its command.
    pub format: Format,
}

/// What is wrong with a command: the code of the error notice that answers it. Codes from 64 on are left to users.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// No command begins like that.
    Unknown = 1,
    /// The number in front of the command is none, or too large. An ASCII command behind it is skipped; one that begins
    /// with `!`, `*` or `~` clears it and is delivered, without a number.
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
}

/// Axes and velocity: a target, the deltas of a step, or a position. The layout is the proposal's `CPVectorCommand`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(C)]
pub struct Vector {
    /// Along the vector, in steps per second: 0 to 16383.
    pub velocity: u16,
    /// Which of the values mean something: bit i is `axes[i]`, bit 6 `velocity`.
    pub mask: c_uchar,
    /// x, y, z, a, b, c in steps: positions are -134217728 to 134217727.
    pub axes: [i32; AXES],
}

impl Vector {
    /// No axis and no velocity.
    #[must_use]
    pub const fn new() -> Self {
        Self { velocity: 0, mask: 0, axes: [0; AXES] }
    }

    /// The value of an axis, 0 to 5, if it has one.
    #[must_use]
    pub fn axis(&self, axis: usize) -> Option<i32> {
        self.axes.get(axis).copied().filter(|_| self.has(axis))
    }

    /// Whether an axis has a value.
    #[must_use]
    pub const fn has(&self, axis: usize) -> bool {
        axis < AXES && self.mask >> axis & 1 == 1
    }

    /// The velocity, if it has one. Without it, that of the last vector holds.
    #[must_use]
    pub const fn velocity(&self) -> Option<u16> {
        if self.mask & MASK_VELOCITY == 0 { None } else { Some(self.velocity) }
    }

    /// Gives an axis, 0 to 5, a value.
    pub fn set(&mut self, axis: usize, value: i32) {
        if let Some(place) = self.axes.get_mut(axis) {
            *place = value;
            self.mask |= bit(axis);
        }
    }

    /// Gives it a velocity.
    pub const fn set_velocity(&mut self, velocity: u16) {
        self.velocity = velocity;
        self.mask |= MASK_VELOCITY;
    }

    /// Makes it another's copy. Field by field, which never becomes a call of memcpy.
    pub fn copy(&mut self, from: &Self) {
        self.velocity = from.velocity;
        self.mask = from.mask;
        for (place, value) in self.axes.iter_mut().zip(&from.axes) {
            *place = *value;
        }
    }

    /// Takes a position, whose mask tells the known axes, along where a command leads: [`Message::Move`] and
    /// [`Message::Position`] tell where that is, [`Message::Step`] how far. The velocity goes with it. Other messages
    /// lead nowhere.
    ///
    /// # Errors
    ///
    /// A step can't be taken; nothing has changed then.
    pub fn follow(&mut self, message: &Message<'_>) -> Result<(), Lost> {
        let (vector, is_step) = match message {
            Message::Move(vector) | Message::Position(vector) => (*vector, false),
            Message::Step(vector) => (*vector, true),
            _ => return Ok(()),
        };
        // All of it or nothing: first a look, then the steps. (A copy of the axes would be a call of memcpy on some
        // targets.)
        for axis in 0..AXES {
            self.reached(axis, vector, is_step)?;
        }
        for axis in 0..AXES {
            let reached = self.reached(axis, vector, is_step)?;
            if let Some(place) = self.axes.get_mut(axis) {
                *place = reached;
            }
        }
        self.mask |= vector.mask;
        if vector.velocity().is_some() {
            self.velocity = vector.velocity;
        }
        Ok(())
    }

    /// Where an axis is when a vector was followed.
    fn reached(&self, axis: usize, vector: &Self, is_step: bool) -> Result<i32, Lost> {
        let here = self.axes.get(axis).copied().unwrap_or_default();
        let Some(value) = vector.axis(axis) else { return Ok(here) };
        if is_step && !self.has(axis) {
            return Err(Lost::Unknown);
        }
        let sum = if is_step { here.checked_add(value) } else { Some(value) };
        sum.filter(|sum| POSITIONS.contains(sum)).ok_or(Lost::Range)
    }
}

/// The bit of an axis.
#[inline(always)]
pub const fn bit(axis: usize) -> u8 {
    if axis < AXES { 1 << axis } else { 0 }
}

/// Why a position can't be taken along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lost {
    /// It would leave the positions that 28 bits hold.
    Range,
    /// A delta of an axis whose position is not known.
    Unknown,
}

/// What was received: see [`Item::message`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message<'a> {
    /// Command: go there. Positions, by the long form or in ASCII. If it names no axis, it is the velocity of the moves
    /// to come.
    Move(&'a Vector),
    /// Command: go on by so much. Deltas of -64 to 63 steps, by the short form.
    Step(&'a Vector),
    /// Command: report the position each so many milliseconds; 0: never.
    Reporting(u16),
    /// What came is none of these. The code is a [`Fault`]'s.
    Malformed(u8),
    /// Notice: the command with this number was carried out.
    Completed,
    /// Notice: the command, with this number if it has one, was not. The code is a [`Fault`]'s or one of the
    /// controller's own, 0 to 127.
    Refused(u8),
    /// Notice: the position.
    Position(&'a Vector),
}

// The kinds of items.
pub const MOVE: c_int = 1;
pub const STEP: c_int = 2;
pub const REPORTING: c_int = 3;
pub const MALFORMED: c_int = 4;
pub const COMPLETED: c_int = 5;
pub const REFUSED: c_int = 6;
pub const POSITION: c_int = 7;

/// The number of a command as C has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(C)]
pub struct NumberField {
    /// 0 to 16383.
    pub value: u16,
    /// How it is written: `GX_BINARY` or `GX_ASCII`; 0: there is none.
    pub format: c_uchar,
}

/// What a receiver tells: a command, a notice, a malformed one, or nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(C)]
pub struct Item {
    /// What it is: `GX_NONE`, `GX_MOVE` ...
    pub kind: c_int,
    /// The number of the command; its format is 0 when it has none.
    pub number: NumberField,
    /// `GX_BINARY` or `GX_ASCII`: how the command or notice was written.
    pub format: c_uchar,
    /// Of `GX_MALFORMED`: `GX_FAULT_*`. Of `GX_REFUSED`: one of these, or the controller's own, 0 to 127.
    pub code: c_uchar,
    /// Of `GX_REPORTING`: milliseconds between two reports, 0 to 16383; 0: none are wanted.
    pub period: u16,
    /// Of `GX_MOVE` and `GX_POSITION`: positions. Of `GX_STEP`: deltas, to be added to the positions. Values that
    /// its mask does not flag are 0.
    pub vector: Vector,
}

impl Item {
    /// Nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            kind: 0,
            number: NumberField { value: 0, format: 0 },
            format: 0,
            code: 0,
            period: 0,
            vector: Vector::new(),
        }
    }

    /// What was received, if anything.
    #[inline]
    #[must_use]
    pub const fn message(&self) -> Option<Message<'_>> {
        Some(match self.kind {
            MOVE => Message::Move(&self.vector),
            STEP => Message::Step(&self.vector),
            REPORTING => Message::Reporting(self.period),
            MALFORMED => Message::Malformed(self.code),
            COMPLETED => Message::Completed,
            REFUSED => Message::Refused(self.code),
            POSITION => Message::Position(&self.vector),
            _ => return None,
        })
    }

    /// How it was written.
    #[must_use]
    pub const fn format(&self) -> Format {
        if self.format == ASCII { Format::Ascii } else { Format::Binary }
    }

    /// The number that stood in front of it.
    #[must_use]
    pub const fn number(&self) -> Option<Number> {
        let format = match self.number.format {
            0 => return None,
            ASCII => Format::Ascii,
            _ => Format::Binary,
        };
        Some(Number { value: self.number.value, format })
    }
}
