//! Numbers, and codes with what is written like them.

use super::{CODE, CODE_DIGITS, CODE_PACKED, IDLE, NUMBER_DIGITS, NUMBER_PACKED, NUMBERED, Receiver, Step};
use crate::gx::message::{Fault, Format, Kind, Numbered};
use crate::gx::packed::{CODE_MAX, HIGH, NUMBER_MAX, low, push, unsigned14};

impl<const NOTICES: bool> Receiver<NOTICES> {
    /// A byte of a number.
    pub(super) fn number_byte(&mut self, byte: u8) -> Step {
        let state = self.state;
        if byte >= HIGH && state != NUMBER_DIGITS {
            self.value = push(self.value, byte);
            self.state = NUMBER_PACKED;
            if state == NUMBER_PACKED {
                self.number = Numbered::new(unsigned14(self.value), Format::Binary);
                self.state = NUMBERED;
            }
            return Step::Taken;
        }
        if byte.is_ascii_digit() && state != NUMBER_PACKED {
            return self.digit(byte, NUMBER_DIGITS);
        }
        match self.decimal(NUMBER_MAX) {
            Some(number) if state == NUMBER_DIGITS => {
                self.number = Numbered::new(number, Format::Ascii);
                self.state = NUMBERED;
                self.behind_number(byte)
            }
            _ => self.refuse(byte, Fault::Number, state == NUMBER_PACKED),
        }
    }

    pub(super) fn behind_number(&mut self, byte: u8) -> Step {
        let is_packed = self.number.format() == Format::Binary;
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

    /// A byte of a code, or of two of them in one.
    pub(super) fn code_byte(&mut self, byte: u8) -> Step {
        let state = self.state;
        let is_long = self.place != b'?';
        let kind = match self.place {
            b'?' => Kind::Refused,
            b'&' => Kind::Confirmed,
            _ if NOTICES => Kind::Status,
            _ => Kind::Control,
        };
        let most = if is_long { NUMBER_MAX } else { CODE_MAX.into() };
        match byte {
            HIGH.. if state != CODE_DIGITS => {
                self.value = push(self.value, byte);
                if is_long && state == CODE {
                    self.state = CODE_PACKED;
                    return Step::Taken;
                }
                self.value = if is_long { unsigned14(self.value).into() } else { low(byte.into()).into() };
                self.start = byte;
                self.end(kind)
            }
            b'0'..=b'9' if state != CODE_PACKED => self.digit(byte, CODE_DIGITS),
            b'\r' | b'\n' if state == CODE_DIGITS && self.decimal(most).is_some() => self.end(kind),
            b'\r' | b'\n' if state == CODE_DIGITS => self.refuse(byte, Fault::Range, false),
            _ => self.refuse(byte, Fault::Syntax, state == CODE_PACKED),
        }
    }
}
