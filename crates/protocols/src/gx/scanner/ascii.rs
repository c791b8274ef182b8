//! What is written as text: words and digits.

use super::super::command::{Fault, Format, MOVE, POSITION, REPORTING};
use super::super::packed::{PERIOD_MAX, POSITIONS, VELOCITY_MAX};
use super::{DIGITS, LETTER, SIGN, Scanner, Step, WORDS};

/// The bit of `R` among the words of an ASCII command.
const MASK_REPORTING: u8 = 0x80;
/// The numbers of words behind those of the axes.
const WORD_VELOCITY: u8 = 6;
const WORD_REPORTING: u8 = 7;

impl Scanner {
    /// A byte of an ASCII vector, or of what asks for reports.
    pub(super) fn ascii<const HOST: bool>(&mut self, byte: u8) -> Step {
        match (self.state, byte) {
            (LETTER | SIGN | DIGITS, b'0'..=b'9') => return self.more_digits(byte, DIGITS),
            (LETTER, b'-' | b'+') if self.place < WORD_VELOCITY => {
                self.left = u8::from(byte == b'-');
                self.state = SIGN;
                return Step::Taken;
            }
            (LETTER | SIGN, _) => return Step::Refused(Fault::Syntax, Format::Ascii),
            (DIGITS, _) if !self.keep() => return Step::Refused(Fault::Range, Format::Ascii),
            _ => self.state = WORDS,
        }
        match byte {
            b' ' => Step::Taken,
            b'\r' | b'\n' if HOST => self.end(POSITION),
            b'\r' | b'\n' if self.vector.mask & MASK_REPORTING != 0 => self.end(REPORTING),
            b'\r' | b'\n' => self.end(MOVE),
            _ => self.ascii_word::<HOST>(byte),
        }
    }

    /// The letter of a word.
    pub(super) fn ascii_word<const HOST: bool>(&mut self, byte: u8) -> Step {
        let Some(word) = word(byte).filter(|word| !HOST || *word < WORD_VELOCITY) else {
            return Step::Refused(Fault::Syntax, Format::Ascii);
        };
        let flag = 1_u8.wrapping_shl(word.into());
        if self.vector.mask & flag != 0 {
            return Step::Refused(Fault::Repeated, Format::Ascii);
        }
        // Reporting stands alone.
        if self.vector.mask & MASK_REPORTING != 0 || flag == MASK_REPORTING && self.vector.mask != 0 {
            return Step::Refused(Fault::Syntax, Format::Ascii);
        }
        self.vector.mask |= flag;
        self.place = word;
        self.left = 0;
        self.state = LETTER;
        Step::Taken
    }

    /// The end of a word: keeps its value, if that is in its range.
    pub(super) fn keep(&mut self) -> bool {
        if self.place >= WORD_VELOCITY {
            let limit = if self.place == WORD_VELOCITY { VELOCITY_MAX } else { PERIOD_MAX };
            let value = self.decimal(limit);
            self.vector.velocity = value.unwrap_or_default();
            return value.is_some();
        }
        let size = self.value.cast_signed();
        let value = if self.left == 0 { size } else { size.wrapping_neg() };
        if let Some(place) = self.vector.axes.get_mut(usize::from(self.place)) {
            *place = value;
        }
        POSITIONS.contains(&value)
    }

    /// A decimal digit, the first if this is another state. Values that are too large for anything stay so.
    pub(super) fn more_digits(&mut self, byte: u8, state: u8) -> Step {
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

/// What a letter stands for: an axis, [`WORD_VELOCITY`] or [`WORD_REPORTING`].
pub(super) const fn word(byte: u8) -> Option<u8> {
    Some(match byte {
        b'x' => 0,
        b'y' => 1,
        b'z' => 2,
        b'a' => 3,
        b'b' => 4,
        b'c' => 5,
        b'V' => WORD_VELOCITY,
        b'R' => WORD_REPORTING,
        _ => return None,
    })
}
