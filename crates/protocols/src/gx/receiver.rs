//! The receivers of both ends: bytes in any portions go in, commands or notices come out.
//!
//! The proposal fixes the binary forms. What it leaves open is decided here:
//!
//! - Space, CR and LF outside a command mean nothing. ESC forgets what has come, without a word.
//! - A byte without the high bit where a packed one is due ends the command, as malformed; the byte is looked at again,
//!   as it may be the first of the next. `!`, `*`, `#`, `~` and `%` (of notices: `#`, `=`, `?`, `&` and `%`), which
//!   begin something and stand nowhere else, do the same in the middle of anything.
//! - Malformed ASCII, a broken number too, is reported at the byte that is wrong, and skipped up to the end of the line
//!   or such a first byte. Behind malformed binary (or stray packed bytes), packed bytes are skipped.
//! - ASCII: words in any order, spaces between them; a sign before the digits of an axis; any number of leading zeros,
//!   and so lines of any length, as nothing of them is kept.

use zerocopy::{FromBytes, Immutable, KnownLayout};

use super::message::{Fault, Format, Kind, Number, Numbered};
use super::packed::{HIGH, NUMBER_MAX, halves, low};
use super::vector::{MASK_VELOCITY, Vector};

mod binary;
mod text;

use text::{is_end, word};

pub(super) const ESC: u8 = 0x1B;

// States: what is being received, with the flags below. Any other byte stands for IDLE too.
/// Between commands.
const IDLE: u8 = 0;
/// Behind a malformed command.
const SKIP_LINE: u8 = 1;
const SKIP_PACKED: u8 = 2;
/// Behind a number.
const NUMBERED: u8 = 3;
/// In ASCII, between words.
const WORDS: u8 = 4;
/// Behind `=`.
const REPORT: u8 = 5;
/// Behind a letter.
const WORD: u8 = 6;
/// Behind `#`.
const NUMBER: u8 = 7;
/// Behind `?`, `%` or `&`.
const CODE: u8 = 8;
/// Packed bytes: the mask, and those of values.
const MASK: u8 = 9;
const VALUE: u8 = 10;

// Flags.
/// Packed bytes may come: the bit that these have.
const PACKED: u8 = HIGH;
/// Digits may come.
const DIGITS: u8 = 0x40;
/// There was a digit.
const BEGUN: u8 = 0x20;
const FLAGS: u8 = PACKED | DIGITS | BEGUN;

const MASK_DUE: u8 = MASK | PACKED;
const VALUE_DUE: u8 = VALUE | PACKED;

/// Receives commands: the motion side's.
pub type CommandReceiver = Receiver<false>;
/// Receives notices: the host's.
pub type NoticeReceiver = Receiver<true>;

/// What has come of a command or notice. All zero is a new receiver.
#[derive(Clone, Debug, Default, PartialEq, Eq, FromBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Receiver<const NOTICES: bool> {
    /// One of the states above.
    state: u8,
    /// The first byte of what is binary, or of a code; 0: it is ASCII.
    start: u8,
    /// Flags of the binary values still to come. In ASCII: 1 behind a minus, 2 behind a plus.
    left: u8,
    /// Packed bytes of the value still to come. In ASCII: the number of the word.
    place: u8,
    pub(super) number: Numbered,
    /// The value that is being read, packed groups or decimal digits; then the code.
    value: u32,
    /// Axes and velocity so far; as the velocity, the period of reports too.
    vector: Vector,
}

/// What became of a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// It was taken.
    Taken,
    /// It was taken and completes this.
    Done(Kind),
    /// It is not part of this, which ends before it.
    Before(Kind),
}

impl<const NOTICES: bool> Receiver<NOTICES> {
    /// A receiver that has received nothing.
    pub const fn new() -> Self {
        Self { vector: Vector::new(), value: 0, number: Numbered::NONE, state: IDLE, start: 0, left: 0, place: 0 }
    }

    /// Takes bytes up to the end of a command or notice; returns how many, and its kind. All of them are taken if none
    /// ends there. A malformed command, one [`Kind::Malformed`] with its number if that was complete, may end before the
    /// first of them, so call again as long as bytes are left, also if none was taken. A packed number is a whole
    /// notice, but may begin an error notice too: it is reported when the next byte has come, or the line is
    /// [`idle`](Self::idle).
    #[inline]
    pub fn receive(&mut self, bytes: &[u8]) -> (usize, Option<Kind>) {
        let mut rest = bytes;
        self.begin_call();
        while let Some((byte, mut behind)) = rest.split_first() {
            let step = self.step(*byte);
            let step = if step == Step::Taken { self.whole_values(&mut behind) } else { step };
            match step {
                Step::Taken => rest = behind,
                Step::Done(kind) => return (bytes.len().wrapping_sub(behind.len()), Some(kind)),
                Step::Before(kind) => return (bytes.len().wrapping_sub(rest.len()), Some(kind)),
            }
        }
        (bytes.len(), None)
    }

    /// [`receive`](Self::receive) of one byte.
    pub(super) fn receive_byte(&mut self, byte: u8) -> Step {
        self.begin_call();
        self.step(byte)
    }

    /// To be called when the line has been quiet for longer than a command takes: what is incomplete is given up and
    /// reported as malformed; of notices, a number that could have become an error notice is a completion.
    pub fn idle(&mut self) -> Option<Kind> {
        let (is_inside, is_packed) = (self.is_inside(), self.is_packed());
        let is_numbered = self.state == NUMBERED;
        self.state = IDLE;
        if !is_inside {
            return None;
        }
        if NOTICES && is_numbered && is_packed {
            return Some(Kind::Completed);
        }
        Some(self.malformed(Fault::Interrupted, is_packed))
    }

    /// The values of what was found: positions, deltas, or a velocity alone. Only those that its mask flags count.
    pub const fn vector(&self) -> &Vector {
        &self.vector
    }

    /// The number in front of what was found.
    pub const fn number(&self) -> Option<Number> {
        self.number.get()
    }

    /// How it was written; not that of a completion, which is its number's.
    pub const fn format(&self) -> Format {
        if self.start == 0 { Format::Ascii } else { Format::Binary }
    }

    /// The code of what is [`Refused`](Kind::Refused) or [`Malformed`](Kind::Malformed).
    pub const fn code(&self) -> u8 {
        low(self.value)
    }

    /// The 14 bits of a [`Control`](Kind::Control) or a [`Status`](Kind::Status).
    #[expect(clippy::cast_possible_truncation, reason = "14 bits")]
    pub const fn bits(&self) -> u16 {
        self.value as u16 & NUMBER_MAX
    }

    /// Of what is [`Confirmed`](Kind::Confirmed), the lowest bits of the number, and the check.
    pub const fn confirmed(&self) -> (u8, u8) {
        let [number, check] = halves(self.bits());
        (number, check)
    }

    /// The period of reports that is asked for, in milliseconds.
    pub const fn period(&self) -> u16 {
        self.vector.velocity
    }

    /// The number of what was found before is held until then.
    #[inline]
    const fn begin_call(&mut self) {
        if !self.is_inside() {
            self.number = Numbered::NONE;
        }
    }

    /// Whether something has begun that is neither complete nor malformed.
    const fn is_inside(&self) -> bool {
        self.state >= NUMBERED
    }

    /// Whether what came last of it is packed.
    const fn is_packed(&self) -> bool {
        match self.state {
            NUMBERED => matches!(self.number.format(), Format::Binary),
            state => state & (PACKED | DIGITS) == PACKED,
        }
    }

    /// A byte, wherever it comes.
    #[inline(always)]
    fn step(&mut self, byte: u8) -> Step {
        match self.state {
            state if state & byte & HIGH != 0 => self.packed(byte),
            IDLE => self.begin(byte),
            _ => self.plain(byte),
        }
    }

    /// Any other byte.
    #[inline(never)]
    fn plain(&mut self, byte: u8) -> Step {
        let state = self.state;
        if byte == ESC {
            self.state = IDLE;
            self.number = Numbered::NONE;
            return Step::Taken;
        }
        if byte.is_ascii_digit() && state & DIGITS != 0 {
            return self.digit(byte);
        }
        match state & !FLAGS {
            NUMBERED => self.behind_number(byte),
            NUMBER => self.number_ends(byte),
            CODE => self.code_ends(byte),
            WORD => self.word_ends(byte),
            WORDS => self.words(byte),
            MASK | VALUE => self.refuse(byte, Fault::Syntax, true),
            REPORT if NOTICES => self.report(byte),
            SKIP_PACKED | SKIP_LINE if self.skips(byte, state == SKIP_PACKED) => Step::Taken,
            _ => self.begin(byte),
        }
    }

    /// The first byte of a command or notice, behind its number if it has one; or one that means nothing there.
    fn begin(&mut self, byte: u8) -> Step {
        // Of digits; packed bytes shift out what was there before.
        self.value = 0;
        self.place = 2;
        let (start, state) = match byte {
            b' ' | b'\r' | b'\n' | ESC => (0, IDLE),
            b'#' => (0, NUMBER | DIGITS | PACKED),
            b'=' if NOTICES => (0, REPORT),
            b'?' | b'&' | b'%' if NOTICES || byte == b'%' => {
                if byte == b'?' {
                    self.place = 1;
                }
                (byte, CODE | DIGITS | PACKED)
            }
            b'!' | b'*' if !NOTICES => (byte, MASK_DUE),
            b'~' if !NOTICES => {
                self.left = MASK_VELOCITY;
                (byte, VALUE_DUE)
            }
            _ if !NOTICES && word(byte).is_some() => return self.first_word(byte),
            _ => return self.refuse(byte, Fault::Unknown, byte >= HIGH),
        };
        self.start = start;
        self.state = state;
        Step::Taken
    }

    /// A byte behind `=`.
    fn report(&mut self, byte: u8) -> Step {
        match byte {
            b'!' => {
                self.start = b'=';
                self.state = MASK_DUE;
                Step::Taken
            }
            b'\r' | b'\n' => self.refuse(byte, Fault::Empty, false),
            HIGH.. => self.refuse(byte, Fault::Syntax, true),
            _ => self.first_word(byte),
        }
    }

    /// The end of something, with its last byte.
    fn end(&mut self, kind: Kind) -> Step {
        self.state = IDLE;
        Step::Done(kind)
    }

    /// A byte that has no place where it is.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    fn refuse(&mut self, byte: u8, fault: Fault, is_packed: bool) -> Step {
        let taken = self.skips(byte, is_packed && fault != Fault::Number);
        let is_interrupted = !taken && fault == Fault::Syntax && is_start::<NOTICES>(byte);
        let kind = self.malformed(if is_interrupted { Fault::Interrupted } else { fault }, is_packed);
        if taken { Step::Done(kind) } else { Step::Before(kind) }
    }

    fn malformed(&mut self, fault: Fault, is_packed: bool) -> Kind {
        self.value = fault as u32;
        self.start = is_packed.into();
        Kind::Malformed
    }

    /// Whether a byte goes with something malformed (packed bytes, or a line of text) instead of beginning the next.
    fn skips(&mut self, byte: u8, is_packed: bool) -> bool {
        self.state = IDLE;
        if is_start::<NOTICES>(byte) || is_packed && !NOTICES && word(byte).is_some() {
            return false;
        }
        if !is_end(byte) {
            self.state = if is_packed && (byte >= HIGH || byte == b' ') { SKIP_PACKED } else { SKIP_LINE };
        }
        true
    }
}

/// Whether a byte stands nowhere but at the beginning of a command, or of a notice.
const fn is_start<const NOTICES: bool>(byte: u8) -> bool {
    if NOTICES {
        matches!(byte, b'#' | b'=' | b'?' | b'&' | b'%')
    } else {
        matches!(byte, b'!' | b'*' | b'#' | b'~' | b'%')
    }
}
