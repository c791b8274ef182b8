//! Numbers, and codes with what is written like them.

use super::text::is_end;
use super::{BEGUN, DIGITS, IDLE, NUMBERED, Receiver, Step};
use crate::gx::message::{Fault, Format, Kind, Numbered};
use crate::gx::packed::{CODE_MAX, NUMBER_MAX};

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
}
