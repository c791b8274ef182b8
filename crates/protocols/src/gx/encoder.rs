//! Commands and notices as bytes.
//!
//! Each function writes to the beginning of `room` and returns the length in bytes. After an error the room's contents
//! mean nothing.

use super::message::{Control, Format, Number, Numbered, Status};
use super::packed::low;
use super::packed::{CODE_MAX, HIGH, NUMBER_MAX, PERIOD_MAX, VELOCITY_MAX, is_delta, is_position};
use super::vector::{AXES, MASK_AXES, MASK_VELOCITY, Vector, bit};

/// Room that anything fits in: the longest is an ASCII vector of all axes and a velocity, with a number.
pub const ENCODED_MAX: usize = 96;

/// Why something can't be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncodeError {
    /// A value, the number or the mask is out of its range.
    Range,
    /// It does not fit the room.
    Room,
    /// It would say nothing: no axis and no velocity.
    Empty,
}

/// The length of what was written, in bytes.
pub type Written = Result<usize, EncodeError>;

/// A vector of positions: the long form, or ASCII.
pub fn write_move(format: Format, number: Option<Number>, target: &Vector, room: &mut [u8]) -> Written {
    check(target, false)?;
    let mut out = Out::numbered(number, room)?;
    out.positions(format, target);
    out.length()
}

/// The short form, which says how far to go on: -63 to 63 steps an axis.
pub fn write_step(number: Option<Number>, deltas: &Vector, room: &mut [u8]) -> Written {
    check(deltas, true)?;
    let mut out = Out::numbered(number, room)?;
    out.head(b'*', deltas.mask, deltas.velocity);
    for delta in (0..AXES).filter_map(|axis| deltas.axis(axis)) {
        out.groups(delta.cast_unsigned(), 1);
    }
    out.length()
}

/// The shortest command that leads from a position, whose mask flags the known axes, to a target: the short form if it
/// can, and no axis that stays where it is, but for the first one named if none moves.
pub fn write_shortest(number: Option<Number>, target: &Vector, from: &Vector, room: &mut [u8]) -> Written {
    check(target, false)?;
    let mut out = Out::numbered(number, room)?;
    // The base may be anything.
    let delta = |axis| target.axis(axis)?.checked_sub(from.axis(axis)?);
    let (mut mask, mut is_short) = (target.mask & MASK_VELOCITY, true);
    for axis in (0..AXES).filter(|axis| target.has(*axis) && delta(*axis) != Some(0)) {
        mask |= bit(axis);
        is_short &= delta(axis).is_some_and(is_delta);
    }
    if mask & MASK_AXES == 0 {
        // The lowest bit.
        let named = target.mask & MASK_AXES;
        mask |= named & named.wrapping_neg();
    }
    out.head(if is_short { b'*' } else { b'!' }, mask, target.velocity);
    for axis in (0..AXES).filter(|axis| mask & bit(*axis) != 0) {
        if is_short {
            out.groups(delta(axis).unwrap_or_default().cast_unsigned(), 1);
        } else {
            out.groups(target.axis(axis).unwrap_or_default().cast_unsigned(), 4);
        }
    }
    out.length()
}

/// A command to report the position each so many milliseconds, 0 to 16383; 0: never.
pub fn write_reporting(format: Format, number: Option<Number>, period: u16, room: &mut [u8]) -> Written {
    in_range(period <= PERIOD_MAX)?;
    let mut out = Out::numbered(number, room)?;
    out.word(if format == Format::Binary { b'~' } else { b'R' }, period, format);
    out.length()
}

/// The notice that the command with this number was carried out.
pub fn write_completed(number: Number, room: &mut [u8]) -> Written {
    let mut out = Out::numbered(Some(number), room)?;
    out.end(number.format);
    out.length()
}

/// The notice that a command, with this number if it had one, was not carried out; the format is the command's, the code
/// 0 to 127. Without a number it begins with a line end: behind a packed number of the notice before, it would be about
/// that command.
pub fn write_refused(format: Format, number: Option<Number>, code: u8, room: &mut [u8]) -> Written {
    in_range(code <= CODE_MAX)?;
    in_number_range(number)?;
    let mut out = Out::new(room);
    out.refusal(number.into(), code, format);
    out.length()
}

/// A position report; with a velocity, the machine was stopped there, and that one is in force.
pub fn write_position(format: Format, position: &Vector, room: &mut [u8]) -> Written {
    check(position, false)?;
    let mut out = Out::new(room);
    out.byte(b'=');
    out.positions(format, position);
    out.length()
}

/// What a host asks for past the queue.
pub fn write_control(format: Format, number: Option<Number>, control: Control, room: &mut [u8]) -> Written {
    let mut out = Out::numbered(number, room)?;
    out.word(b'%', control.bits(), format);
    out.length()
}

/// The notice that the move with this number was carried out in a session, with its [check](Vector::check). Only the
/// lowest seven bits of the number are sent.
pub fn write_confirmed(number: Number, check: u8, room: &mut [u8]) -> Written {
    in_number_range(Some(number))?;
    in_range(check <= CODE_MAX)?;
    let mut out = Out::new(room);
    out.word(b'&', confirmation(number.value, check), number.format);
    out.length()
}

/// The notice that says how the motion side is.
pub fn write_status(format: Format, status: Status, room: &mut [u8]) -> Written {
    let mut out = Out::new(room);
    out.word(b'%', status.bits(), format);
    out.length()
}

/// The 14 bits of a confirmation.
pub(super) const fn confirmation(number: u16, check: u8) -> u16 {
    number & 0x7F | (check as u16) << 7
}

/// Whether a vector can be written.
pub(super) fn check(vector: &Vector, is_step: bool) -> Result<(), EncodeError> {
    in_range(vector.mask & HIGH == 0)?;
    in_range(vector.velocity().is_none_or(|velocity| velocity <= VELOCITY_MAX))?;
    for value in (0..AXES).filter_map(|axis| vector.axis(axis)) {
        in_range(if is_step { is_delta(value) } else { is_position(value) })?;
    }
    if vector.mask == 0 { Err(EncodeError::Empty) } else { Ok(()) }
}

fn in_number_range(number: Option<Number>) -> Result<(), EncodeError> {
    in_range(number.is_none_or(|number| number.value <= NUMBER_MAX))
}

const fn in_range(fits: bool) -> Result<(), EncodeError> {
    if fits { Ok(()) } else { Err(EncodeError::Range) }
}

/// The room, and what has been written to it.
pub(super) struct Out<'a> {
    room: &'a mut [u8],
    /// More than the room has: it did not fit.
    length: usize,
}

impl<'a> Out<'a> {
    pub(super) const fn new(room: &'a mut [u8]) -> Self {
        Self { room, length: 0 }
    }

    /// With the number that comes first, if any.
    fn numbered(number: Option<Number>, room: &'a mut [u8]) -> Result<Self, EncodeError> {
        in_number_range(number)?;
        let mut out = Self::new(room);
        out.number(number.into());
        Ok(out)
    }

    /// Not inlined: there are many calls.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub(super) fn byte(&mut self, byte: u8) {
        if let Some(place) = self.room.get_mut(self.length) {
            *place = byte;
        }
        self.length = self.length.wrapping_add(1);
    }

    /// So many groups of seven bits of a value, the lowest first.
    fn groups(&mut self, value: u32, count: u8) {
        let mut rest = value;
        for _ in 0..count {
            self.byte(low(rest) | HIGH);
            rest >>= 7;
        }
    }

    fn number(&mut self, number: Numbered) {
        if number.is_some() {
            self.byte(b'#');
            self.value(number.value().into(), 2, number.format());
        }
    }

    /// A value as digits, or in so many groups.
    fn value(&mut self, value: u32, count: u8, format: Format) {
        match format {
            Format::Binary => self.groups(value, count),
            Format::Ascii => self.decimal(value),
        }
    }

    fn head(&mut self, start: u8, mask: u8, velocity: u16) {
        self.byte(start);
        self.byte(mask | HIGH);
        if mask & MASK_VELOCITY != 0 {
            self.groups(velocity.into(), 2);
        }
    }

    /// A vector of positions.
    pub(super) fn positions(&mut self, format: Format, vector: &Vector) {
        let is_ascii = format == Format::Ascii;
        if !is_ascii {
            self.byte(b'!');
            self.byte(vector.mask | HIGH);
        }
        if let Some(velocity) = vector.velocity() {
            if is_ascii {
                self.byte(b'V');
            }
            self.value(velocity.into(), 2, format);
        }
        let (mut flags, mut letter) = (vector.mask & MASK_AXES, b'x');
        for value in &vector.axes {
            if flags & 1 != 0 {
                let mut value = *value;
                if is_ascii {
                    self.byte(letter);
                    if value < 0 {
                        self.byte(b'-');
                        value = value.wrapping_neg();
                    }
                }
                self.value(value.cast_unsigned(), 4, format);
            }
            flags >>= 1;
            letter = if letter == b'z' { b'a' } else { letter.wrapping_add(1) };
        }
        self.end(format);
    }

    /// The end of what is written in that format.
    fn end(&mut self, format: Format) {
        if format == Format::Ascii {
            self.byte(b'\n');
        }
    }

    /// See [`write_refused`].
    pub(super) fn refusal(&mut self, number: Numbered, code: u8, format: Format) {
        if !number.is_some() {
            self.byte(b'\n');
        }
        self.number(number);
        self.byte(b'?');
        self.value(code.into(), 1, format);
        self.end(format);
    }

    /// Something that is 14 bits and no more.
    pub(super) fn word(&mut self, start: u8, value: u16, format: Format) {
        self.byte(start);
        self.value(value.into(), 2, format);
        self.end(format);
    }

    /// At most nine digits, as positions have. By bits of digits: small machines have neither a division nor a table to
    /// spare, and the compiler makes a division of a loop that subtracts.
    fn decimal(&mut self, value: u32) {
        let (mut rest, places) = if value < 100_000 { (value.wrapping_mul(10_000), 5_u8) } else { (value, 9) };
        let mut begun = false;
        for left in (0..places).rev() {
            let (mut digit, mut unit) = (0, 800_000_000);
            for _ in 0..4 {
                digit <<= 1;
                if rest >= unit {
                    rest = rest.wrapping_sub(unit);
                    digit |= 1;
                }
                unit >>= 1;
            }
            begun |= digit != 0 || left == 0;
            if begun {
                self.byte(b'0' | digit);
            }
            rest = rest.wrapping_mul(10);
        }
    }

    /// The length of what was written, which is taken for sent; 0 if it does not fit.
    pub(super) fn finish(self, sent: impl FnOnce()) -> usize {
        let length = self.length().unwrap_or(0);
        if length != 0 {
            sent();
        }
        length
    }

    /// The length of what was written, if it fits.
    const fn length(&self) -> Written {
        if self.length <= self.room.len() { Ok(self.length) } else { Err(EncodeError::Room) }
    }
}
