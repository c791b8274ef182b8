//! What is written as text: words and digits.

use super::{DIGITS, LETTER, Receiver, SIGN, Step, WORDS};
use crate::gx::message::{Fault, Kind};
use crate::gx::packed::{PERIOD_MAX, VELOCITY_MAX, is_position};

/// The bit of `R` among the words of an ASCII command.
const MASK_REPORTING: u8 = 0x80;
/// The number of the word behind those of the axes.
const WORD_VELOCITY: u8 = 6;

impl<const NOTICES: bool> Receiver<NOTICES> {
    /// A byte of an ASCII vector, or of what asks for reports.
    pub(super) fn text(&mut self, byte: u8) -> Step {
        let state = self.state;
        if state != WORDS {
            if byte.is_ascii_digit() {
                return self.digit(byte, DIGITS);
            }
            if state == LETTER && self.place < WORD_VELOCITY && matches!(byte, b'-' | b'+') {
                self.left = u8::from(byte == b'-');
                self.state = SIGN;
                return Step::Taken;
            }
            if state != DIGITS {
                return self.refuse(byte, Fault::Syntax, false);
            }
            if !self.keep() {
                return self.refuse(byte, Fault::Range, false);
            }
            self.state = WORDS;
        }
        match byte {
            b' ' => Step::Taken,
            b'\r' | b'\n' if NOTICES => self.end(Kind::Position),
            b'\r' | b'\n' if self.vector.mask & MASK_REPORTING != 0 => self.end(Kind::Reporting),
            b'\r' | b'\n' => self.end(Kind::Move),
            _ => self.word(byte),
        }
    }

    pub(super) fn first_word(&mut self, byte: u8) -> Step {
        self.start = 0;
        self.vector.mask = 0;
        self.word(byte)
    }

    /// The letter of a word.
    fn word(&mut self, byte: u8) -> Step {
        let Some(word) = word(byte).filter(|word| !NOTICES || *word <= WORD_VELOCITY) else {
            return self.refuse(byte, Fault::Syntax, false);
        };
        let flag = 1_u8.wrapping_shl(word.into());
        if self.vector.mask & flag != 0 {
            return self.refuse(byte, Fault::Repeated, false);
        }
        // Reporting stands alone.
        if self.vector.mask & MASK_REPORTING != 0 || flag == MASK_REPORTING && self.vector.mask != 0 {
            return self.refuse(byte, Fault::Syntax, false);
        }
        self.vector.mask |= flag;
        self.place = word;
        self.left = 0;
        self.state = LETTER;
        Step::Taken
    }

    /// The end of a word: keeps its value, if that is in its range.
    fn keep(&mut self) -> bool {
        if self.place >= WORD_VELOCITY {
            const _: () = assert!(VELOCITY_MAX == PERIOD_MAX);
            let value = self.decimal(VELOCITY_MAX);
            self.vector.velocity = value.unwrap_or_default();
            return value.is_some();
        }
        let size = self.value.cast_signed();
        let value = if self.left == 0 { size } else { size.wrapping_neg() };
        if let Some(place) = self.vector.axes.get_mut(usize::from(self.place)) {
            *place = value;
        }
        is_position(value)
    }

    /// A decimal digit, the first if this is another state. Values that are too large for anything stay so.
    pub(super) fn digit(&mut self, byte: u8, state: u8) -> Step {
        const TOO_LARGE: u32 = 1 << 27;
        let value = if self.state == state { self.value.min(TOO_LARGE) } else { 0 };
        self.value = value.wrapping_mul(10).wrapping_add(byte.wrapping_sub(b'0').into());
        self.state = state;
        Step::Taken
    }

    /// The decimal value, if it is not larger than this.
    pub(super) fn decimal(&self, limit: u16) -> Option<u16> {
        u16::try_from(self.value).ok().filter(|value| *value <= limit)
    }
}

/// Whether a line of ASCII ends here.
pub(super) const fn is_end(byte: u8) -> bool {
    matches!(byte, b'\r' | b'\n')
}

/// What a letter stands for: an axis, [`WORD_VELOCITY`] or, behind that, reporting.
pub(super) fn word(byte: u8) -> Option<u8> {
    let place = b"xyzabcVR".iter().position(|letter| *letter == byte)?;
    u8::try_from(place).ok()
}
