//! The number of a command or notice.

use super::super::command::{Fault, Format};
use super::super::packed::{HIGH, NUMBER_MAX, push, unpack28, unsigned14};
use super::{NUMBER, NUMBER_DIGITS, NUMBER_PACKED, NUMBERED, Scanner, Step};

impl Scanner {
    /// A byte of a number.
    pub(super) fn numbering(&mut self, byte: u8) -> Step {
        match (self.state, byte) {
            (NUMBER | NUMBER_PACKED, HIGH..) => {
                self.value = push(self.value, byte);
                if self.state == NUMBER {
                    self.state = NUMBER_PACKED;
                } else {
                    self.whole_number();
                }
                Step::Taken
            }
            (NUMBER | NUMBER_DIGITS, b'0'..=b'9') => self.more_digits(byte, NUMBER_DIGITS),
            (NUMBER_DIGITS, _) => {
                let Some(number) = self.decimal(NUMBER_MAX) else { return Step::Refused(Fault::Number, Format::Ascii) };
                self.number = number;
                self.number_format = Format::Ascii as u8;
                self.state = NUMBERED;
                Step::Again
            }
            (NUMBER_PACKED, _) => Step::Refused(Fault::Number, Format::Binary),
            _ => Step::Refused(Fault::Number, Format::Ascii),
        }
    }

    /// The end of a packed number.
    #[inline]
    pub(super) fn whole_number(&mut self) {
        self.number = unsigned14(unpack28(self.value));
        self.number_format = Format::Binary as u8;
        self.state = NUMBERED;
    }

    /// The format of the number; without one, ASCII.
    pub(super) const fn number_written(&self) -> Format {
        if self.number_format == Format::Binary as u8 { Format::Binary } else { Format::Ascii }
    }
}
