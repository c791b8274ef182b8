//! What is written as text: words and digits; and what stands behind numbers and codes.

use super::{BEGUN, DIGITS, IDLE, NUMBERED, PACKED, Receiver, Step, WORD, WORDS};
use crate::gx::message::{Fault, Format, Kind, Numbered};
use crate::gx::packed::{CODE_MAX, NUMBER_MAX, PERIOD_MAX, VELOCITY_MAX, is_position};

/// The bit of `R` among the words of an ASCII command.
const MASK_REPORTING: u8 = 0x80;
/// The number of the word behind those of the axes.
const WORD_VELOCITY: u8 = 6;

impl<const NOTICES: bool> Receiver<NOTICES> {
    /// A byte behind the digits of a number, or one that can't be part of it.
    pub(super) fn number_ends(&mut self, byte: u8) -> Step {
        match self.decimal(NUMBER_MAX) {
            Some(number) if self.state & BEGUN != 0 => {
                self.number = Numbered::new(number, Format::Ascii);
                self.state = NUMBERED;
                self.behind_number(byte)
            }
            _ => self.refuse(byte, Fault::Number, self.state & DIGITS == 0),
        }
    }

    pub(super) fn behind_number(&mut self, byte: u8) -> Step {
        let is_packed = self.is_packed();
        match byte {
            b' ' if !NOTICES => Step::Taken,
            b'#' if !NOTICES => self.refuse(byte, Fault::Interrupted, is_packed),
            b'\r' | b'\n' if !NOTICES => self.refuse(byte, Fault::Empty, false),
            _ if !NOTICES => self.begin(byte),
            b'?' => self.begin(byte),
            b'\r' | b'\n' => self.end(Kind::Completed),
            _ if is_packed => {
                self.state = IDLE;
                Step::Before(Kind::Completed)
            }
            _ => self.refuse(byte, Fault::Syntax, false),
        }
    }

    /// A byte behind the digits of a code, or of two in one, or one that can't be part of it.
    pub(super) fn code_ends(&mut self, byte: u8) -> Step {
        if self.state & BEGUN == 0 || !is_end(byte) {
            return self.refuse(byte, Fault::Syntax, self.state & DIGITS == 0);
        }
        let most = if self.start == b'?' { CODE_MAX.into() } else { NUMBER_MAX };
        if self.decimal(most).is_none() {
            return self.refuse(byte, Fault::Range, false);
        }
        let kind = self.code_kind();
        self.start = 0;
        self.end(kind)
    }

    /// What the code is that begins with this byte.
    pub(super) const fn code_kind(&self) -> Kind {
        match self.start {
            b'?' => Kind::Refused,
            b'&' => Kind::Confirmed,
            _ if NOTICES => Kind::Status,
            _ => Kind::Control,
        }
    }

    /// A byte behind a letter or the digits of its value.
    pub(super) fn word_ends(&mut self, byte: u8) -> Step {
        if self.state & BEGUN == 0 {
            let is_sign = self.place < WORD_VELOCITY && self.left == 0 && matches!(byte, b'-' | b'+');
            if !is_sign {
                return self.refuse(byte, Fault::Syntax, false);
            }
            self.left = if byte == b'-' { 1 } else { 2 };
            return Step::Taken;
        }
        if !self.keep() {
            return self.refuse(byte, Fault::Range, false);
        }
        self.state = WORDS;
        self.words(byte)
    }

    /// A byte of an ASCII vector, or of what asks for reports, between words.
    pub(super) fn words(&mut self, byte: u8) -> Step {
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
        self.value = 0;
        self.state = WORD | DIGITS;
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
        let value = if self.left == 1 { size.wrapping_neg() } else { size };
        if let Some(place) = self.vector.axes.get_mut(usize::from(self.place)) {
            *place = value;
        }
        is_position(value)
    }

    /// A decimal digit. Values that are too large for anything stay so.
    pub(super) fn digit(&mut self, byte: u8) -> Step {
        const TOO_LARGE: u32 = 1 << 27;
        self.value = self.value.min(TOO_LARGE).wrapping_mul(10).wrapping_add(byte.wrapping_sub(b'0').into());
        self.state = self.state & !PACKED | BEGUN;
        Step::Taken
    }

    /// The decimal value, if it is not larger than this.
    fn decimal(&self, limit: u16) -> Option<u16> {
        u16::try_from(self.value).ok().filter(|value| *value <= limit)
    }
}

/// Whether a line of ASCII ends here.
pub(super) const fn is_end(byte: u8) -> bool {
    matches!(byte, b'\r' | b'\n')
}

/// What a letter stands for: an axis, [`WORD_VELOCITY`] or, behind that, reporting.
pub(super) fn word(byte: u8) -> Option<u8> {
    Some(match byte {
        b'x'..=b'z' => byte.wrapping_sub(b'x'),
        b'a'..=b'c' => byte.wrapping_sub(b'a').wrapping_add(3),
        b'V' => WORD_VELOCITY,
        b'R' => 7,
        _ => return None,
    })
}
