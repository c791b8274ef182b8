//! Commands and notices as bytes.

use super::command::{AXES, Format, MASK_AXES, MASK_VELOCITY, Number, Vector, bit};
use super::packed::{CODE_MAX, DELTAS, HIGH, NUMBER_MAX, PERIOD_MAX, POSITIONS, VELOCITY_MAX, pack7, pack14, pack28};

/// Room that anything fits in: the longest is an ASCII vector of all axes and a velocity, with a number.
pub const ENCODED_MAX: usize = 96;

/// The letters of the axes.
const LETTERS: [u8; AXES] = *b"xyzabc";

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

/// Writes a vector of positions: the long form, or ASCII. Returns its length in bytes.
///
/// # Errors
///
/// See [`EncodeError`]; what was in the room is then lost.
pub fn write_move(
    format: Format,
    number: Option<Number>,
    target: &Vector,
    room: &mut [u8],
) -> Result<usize, EncodeError> {
    check(target, false)?;
    let mut out = Out::new(room);
    out.number(number)?;
    out.long(format, target);
    out.length()
}

/// Writes the short form, which says how far to go on: -63 to 63 steps an axis. Returns its length in bytes.
///
/// # Errors
///
/// See [`EncodeError`]; what was in the room is then lost.
pub fn write_step(number: Option<Number>, deltas: &Vector, room: &mut [u8]) -> Result<usize, EncodeError> {
    check(deltas, true)?;
    let mut out = Out::new(room);
    out.number(number)?;
    out.head(b'*', deltas);
    for axis in 0..AXES {
        if let Some(delta) = deltas.axis(axis) {
            out.byte(pack7(delta));
        }
    }
    out.length()
}

/// Writes the shortest command that leads from a position, whose mask tells the known axes, to a target: the short
/// form if it can, and no axis that stays where it is. Returns its length in bytes.
///
/// If no axis moves the first one named is written all the same, so that there is one command for each call.
///
/// # Errors
///
/// See [`EncodeError`]; what was in the room is then lost.
pub fn write_shortest(
    number: Option<Number>,
    target: &Vector,
    from: &Vector,
    room: &mut [u8],
) -> Result<usize, EncodeError> {
    check(target, false)?;
    let mut out = Out::new(room);
    out.number(number)?;
    let mut shape = Shape::new(target, from);
    shape.keep_one(target);
    if shape.is_short {
        out.head_of(b'*', shape.mask, target.velocity);
    } else {
        out.head_of(b'!', shape.mask, target.velocity);
    }
    for axis in 0..AXES {
        if shape.mask & bit(axis) != 0 {
            let value = target.axis(axis).unwrap_or_default();
            if shape.is_short {
                out.byte(pack7(value.wrapping_sub(from.axis(axis).unwrap_or_default())));
            } else {
                out.bytes(&pack28(value));
            }
        }
    }
    out.length()
}

/// What the shortest command names.
struct Shape {
    mask: u8,
    is_short: bool,
}

impl Shape {
    /// The axes that are not known to be there already. (Positions are in their range.)
    fn new(target: &Vector, from: &Vector) -> Self {
        let mut shape = Self { mask: target.mask & MASK_VELOCITY, is_short: true };
        for axis in 0..AXES {
            let Some(value) = target.axis(axis) else { continue };
            // The base may be anything.
            let delta = from.axis(axis).and_then(|base| value.checked_sub(base));
            if delta != Some(0) {
                shape.mask |= bit(axis);
                shape.is_short &= delta.is_some_and(|delta| DELTAS.contains(&delta));
            }
        }
        shape
    }

    /// A target that was reached already is named by one axis, which does not move.
    const fn keep_one(&mut self, target: &Vector) {
        let named = target.mask & MASK_AXES;
        if self.mask & MASK_AXES == 0 {
            self.mask |= named & named.wrapping_neg();
        }
    }
}

/// Writes a command to report the position each so many milliseconds, 0 to 16383; 0: never. Returns its length in
/// bytes.
///
/// # Errors
///
/// See [`EncodeError`]; what was in the room is then lost.
pub fn write_reporting(
    format: Format,
    number: Option<Number>,
    period: u16,
    room: &mut [u8],
) -> Result<usize, EncodeError> {
    in_range(period <= PERIOD_MAX)?;
    let mut out = Out::new(room);
    out.number(number)?;
    match format {
        Format::Binary => {
            out.byte(b'~');
            out.bytes(&pack14(period));
        }
        Format::Ascii => {
            out.byte(b'R');
            out.decimal(period.into());
            out.byte(b'\n');
        }
    }
    out.length()
}

/// Writes the notice that the command with this number was carried out. Returns its length in bytes.
///
/// # Errors
///
/// See [`EncodeError`]; what was in the room is then lost.
pub fn write_completed(number: Number, room: &mut [u8]) -> Result<usize, EncodeError> {
    let mut out = Out::new(room);
    out.number(Some(number))?;
    if number.format == Format::Ascii {
        out.byte(b'\n');
    }
    out.length()
}

/// Writes the notice that a command, with this number if it had one, was not carried out; the format is the command's,
/// the code 0 to 127. Returns its length in bytes.
///
/// Without a number it begins with a line end: behind a packed number of the notice before, it would be about
/// that command.
///
/// # Errors
///
/// See [`EncodeError`]; what was in the room is then lost.
pub fn write_refused(format: Format, number: Option<Number>, code: u8, room: &mut [u8]) -> Result<usize, EncodeError> {
    in_range(code <= CODE_MAX)?;
    let mut out = Out::new(room);
    match number {
        Some(_) => out.number(number)?,
        None => out.byte(b'\n'),
    }
    out.byte(b'?');
    match format {
        Format::Binary => out.byte(code | HIGH),
        Format::Ascii => {
            out.decimal(code.into());
            out.byte(b'\n');
        }
    }
    out.length()
}

/// Writes a position report. Returns its length in bytes.
///
/// # Errors
///
/// See [`EncodeError`], `Range` also for a velocity; what was in the room is then lost.
pub fn write_position(format: Format, position: &Vector, room: &mut [u8]) -> Result<usize, EncodeError> {
    in_range(position.mask & MASK_VELOCITY == 0)?;
    check(position, false)?;
    let mut out = Out::new(room);
    out.byte(b'=');
    out.long(format, position);
    out.length()
}

/// Whether a vector can be written.
pub(super) fn check(vector: &Vector, is_step: bool) -> Result<(), EncodeError> {
    in_range(vector.mask & HIGH == 0)?;
    in_range(vector.velocity().is_none_or(|velocity| velocity <= VELOCITY_MAX))?;
    let range = if is_step { DELTAS } else { POSITIONS };
    for axis in 0..AXES {
        in_range(vector.axis(axis).is_none_or(|value| range.contains(&value)))?;
    }
    if vector.mask == 0 { Err(EncodeError::Empty) } else { Ok(()) }
}

/// The length of what was written, if it fits so many bytes; else 0.
pub(super) fn fitting(written: Result<usize, EncodeError>, room: usize) -> usize {
    written.ok().filter(|length| *length <= room).unwrap_or_default()
}

const fn in_range(fits: bool) -> Result<(), EncodeError> {
    if fits { Ok(()) } else { Err(EncodeError::Range) }
}

/// The room, and what has been written to it.
struct Out<'a> {
    room: &'a mut [u8],
    /// More than the room has: it did not fit.
    length: usize,
}

impl<'a> Out<'a> {
    const fn new(room: &'a mut [u8]) -> Self {
        Self { room, length: 0 }
    }

    fn byte(&mut self, byte: u8) {
        if let Some(place) = self.room.get_mut(self.length) {
            *place = byte;
        }
        self.length = self.length.wrapping_add(1);
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.byte(*byte);
        }
    }

    fn number(&mut self, number: Option<Number>) -> Result<(), EncodeError> {
        let Some(number) = number else { return Ok(()) };
        in_range(number.value <= NUMBER_MAX)?;
        self.byte(b'#');
        match number.format {
            Format::Binary => self.bytes(&pack14(number.value)),
            Format::Ascii => self.decimal(number.value.into()),
        }
        Ok(())
    }

    fn head(&mut self, start: u8, vector: &Vector) {
        self.head_of(start, vector.mask, vector.velocity);
    }

    fn head_of(&mut self, start: u8, mask: u8, velocity: u16) {
        self.byte(start);
        self.byte(mask | HIGH);
        if mask & MASK_VELOCITY != 0 {
            self.bytes(&pack14(velocity));
        }
    }

    /// A vector of positions.
    fn long(&mut self, format: Format, vector: &Vector) {
        if format == Format::Binary {
            self.head(b'!', vector);
        } else if let Some(velocity) = vector.velocity() {
            self.byte(b'V');
            self.decimal(velocity.into());
        }
        for (axis, letter) in LETTERS.iter().enumerate() {
            let Some(value) = vector.axis(axis) else { continue };
            if format == Format::Binary {
                self.bytes(&pack28(value));
            } else {
                self.byte(*letter);
                if value < 0 {
                    self.byte(b'-');
                }
                self.decimal(value.unsigned_abs());
            }
        }
        if format == Format::Ascii {
            self.byte(b'\n');
        }
    }

    fn decimal(&mut self, value: u32) {
        let mut unit = 100_000_000;
        let mut rest = value;
        while unit > 1 && rest < unit {
            unit /= 10;
        }
        while unit > 0 {
            // At most 9: positions have nine digits. Subtracting is what small machines do anyway.
            let mut digit = b'0';
            while rest >= unit {
                rest = rest.wrapping_sub(unit);
                digit = digit.wrapping_add(1);
            }
            self.byte(digit);
            unit /= 10;
        }
    }

    const fn length(&self) -> Result<usize, EncodeError> {
        if self.length <= self.room.len() { Ok(self.length) } else { Err(EncodeError::Room) }
    }
}
