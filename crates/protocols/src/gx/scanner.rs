//! The bytes of either direction, one after the other.
//!
//! The proposal fixes the binary forms. What it leaves open is decided here:
//!
//! - Space, CR and LF outside a command mean nothing. ESC forgets what has come, without a word.
//! - A byte without the high bit where a packed one is due ends the command, as malformed; the byte is looked at again,
//!   as it may be the first of the next. `!`, `*`, `#` and `~` (of notices: `#`, `=` and `?`) do the same in the middle
//!   of anything: they stand nowhere else.
//! - Malformed ASCII is told at the byte that is wrong, and skipped up to the end of the line. Behind malformed binary
//!   (or stray packed bytes), packed bytes are skipped.
//! - A broken number is told as malformed at the byte that breaks it, and the rest of the line skipped with it. `!`,
//!   `*` and the others that stand nowhere else clear it as they clear anything, so what begins there is delivered,
//!   without a number.
//! - ASCII: words in any order, spaces between them; a sign before the digits of an axis; any number of leading zeros,
//!   and so lines of any length, as nothing of them is kept.

use core::ffi::{c_int, c_uchar};

use super::command::{COMPLETED, Fault, Format, Item, MASK_VELOCITY, REFUSED, Vector};
use super::packed::{CODE_MAX, HIGH};
use crate::config::FAST;

mod ascii;
mod number;
mod packed;
mod quick;
mod tell;

use ascii::{is_end, word};

pub(super) const ESC: u8 = 0x1B;

// States. Any other byte is taken for IDLE: memory of C callers may hold anything.
/// Between commands.
pub(super) const IDLE: u8 = 0;
/// Behind a number.
pub(super) const NUMBERED: u8 = 1;
/// Behind `#`, behind the first of two packed bytes, in digits.
const NUMBER: u8 = 2;
const NUMBER_PACKED: u8 = 3;
const NUMBER_DIGITS: u8 = 4;
/// The mask is due; the packed bytes of a value.
const MASK: u8 = 5;
const VALUE: u8 = 6;
/// In ASCII: between words, behind a letter, behind a sign, in digits.
const WORDS: u8 = 7;
const LETTER: u8 = 8;
const SIGN: u8 = 9;
const DIGITS: u8 = 10;
/// Behind `=`.
const REPORT: u8 = 11;
/// Behind `?`, and in digits.
const CODE: u8 = 12;
const CODE_DIGITS: u8 = 13;
/// Behind a malformed command.
const SKIP_PACKED: u8 = 14;
const SKIP_LINE: u8 = 15;

/// What has come of a command or notice. All zero: nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Scanner {
    /// Axes and velocity so far; as the velocity, the period of reports too.
    vector: Vector,
    /// The value that is being read: packed groups or decimal digits.
    value: u32,
    /// The number of the command, and its format; 0: none.
    number: u16,
    pub(super) number_format: c_uchar,
    pub(super) state: c_uchar,
    /// The first byte of what is binary; 0: it is ASCII.
    start: c_uchar,
    /// Flags of the binary values still to come. In ASCII: 1 behind a minus.
    left: c_uchar,
    /// Packed bytes of the value still to come. In ASCII: the number of the word.
    place: c_uchar,
}

/// What became of a byte.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// It was taken.
    Taken,
    /// It was taken and completes this.
    Done(c_int),
    /// It is not part of this, which ends before it.
    Before(c_int),
    /// It was taken, or not, and makes this malformed.
    Malformed(Fault, Format, bool),
    /// It is to be looked at in the state that is now.
    Again,
    /// It has no place here.
    Refused(Fault, Format),
}

impl Scanner {
    pub(super) const fn new() -> Self {
        Self { vector: Vector::new(), value: 0, number: 0, number_format: 0, state: IDLE, start: 0, left: 0, place: 0 }
    }

    /// Takes bytes up to the end of an item, and tells how many. Notices are read if `HOST`, else commands.
    #[cfg_attr(target_pointer_width = "64", inline(never))]
    pub(super) fn scan<const HOST: bool>(&mut self, bytes: &[u8], item: &mut Item) -> usize {
        if !FAST {
            return self.scan_each::<HOST>(bytes, bytes, item);
        }
        let (rest, kind) = self.quick::<HOST>(bytes);
        if kind != 0 {
            self.tell_vector(kind, item);
        } else if rest.is_empty() {
            item.kind = 0;
        } else {
            return self.scan_each::<HOST>(bytes, rest, item);
        }
        bytes.len().wrapping_sub(rest.len())
    }

    /// [`scan`](Self::scan), which has come to `rest`.
    #[cfg_attr(target_pointer_width = "64", inline(never))]
    fn scan_each<const HOST: bool>(&mut self, bytes: &[u8], rest: &[u8], item: &mut Item) -> usize {
        let mut rest = rest;
        item.kind = 0;
        while let Some((byte, behind)) = rest.split_first() {
            let mut ends = true;
            match self.step::<HOST>(*byte) {
                // The last two are dealt with where they arise.
                Step::Taken | Step::Again | Step::Refused(..) => {
                    rest = behind;
                    ends = false;
                }
                Step::Done(kind) => {
                    rest = behind;
                    self.tell(kind, item);
                }
                Step::Before(kind) => self.tell(kind, item),
                Step::Malformed(fault, format, taken) => {
                    if taken {
                        rest = behind;
                    }
                    self.tell_malformed(fault, format, item);
                }
            }
            if ends {
                break;
            }
            if FAST && self.state <= VALUE {
                let kind;
                (rest, kind) = self.quick::<HOST>(rest);
                if kind != 0 {
                    self.tell_vector(kind, item);
                    break;
                }
            }
        }
        bytes.len().wrapping_sub(rest.len())
    }

    /// Gives up what is not complete.
    pub(super) fn idle<const HOST: bool>(&mut self, item: &mut Item) {
        let binary = self.number_format == Format::Binary as u8;
        let format = match self.state {
            NUMBERED if HOST && binary => return self.finish(COMPLETED, item),
            NUMBERED if binary => Format::Binary,
            NUMBER_PACKED | MASK | VALUE => Format::Binary,
            NUMBER..=CODE_DIGITS | NUMBERED => Format::Ascii,
            _ => {
                self.forget();
                item.kind = 0;
                return;
            }
        };
        self.state = IDLE;
        self.tell_malformed(Fault::Interrupted, format, item);
    }

    fn finish(&mut self, kind: c_int, item: &mut Item) {
        self.state = IDLE;
        self.tell(kind, item);
    }

    /// Forgets what has come.
    pub(super) fn forget(&mut self) {
        self.state = IDLE;
        self.number_format = 0;
    }

    #[cfg_attr(target_pointer_width = "64", inline(never))]
    fn step<const HOST: bool>(&mut self, byte: u8) -> Step {
        if byte == ESC {
            self.forget();
            return Step::Taken;
        }
        // A byte that ends one thing is looked at as part of the next, which never leads back.
        loop {
            let state = self.state;
            let step = match state {
                NUMBER | NUMBER_PACKED | NUMBER_DIGITS => self.numbering(byte),
                NUMBERED if HOST => self.noticed(byte),
                NUMBERED => self.numbered(byte),
                MASK if byte >= HIGH => self.flagged(byte),
                VALUE if byte >= HIGH => self.packed(byte),
                MASK | VALUE => Step::Refused(Fault::Syntax, Format::Binary),
                WORDS | LETTER | SIGN | DIGITS => self.ascii::<HOST>(byte),
                REPORT => self.reported(byte),
                CODE | CODE_DIGITS => self.coded(byte),
                SKIP_LINE if !is_end(byte) && !is_start::<HOST>(byte) => Step::Taken,
                SKIP_PACKED if self.skips_packed::<HOST>(byte) => Step::Taken,
                _ => {
                    self.state = IDLE;
                    if byte == b' ' || is_end(byte) { Step::Taken } else { self.begin::<HOST>(byte) }
                }
            };
            match step {
                Step::Again => {}
                Step::Refused(fault, format) => return self.refuse::<HOST>(byte, fault, format),
                step => return step,
            }
        }
    }

    /// A byte behind the number of a command.
    fn numbered(&mut self, byte: u8) -> Step {
        match byte {
            b' ' => Step::Taken,
            b'#' => Step::Refused(Fault::Interrupted, self.number_written()),
            b'\r' | b'\n' => Step::Refused(Fault::Empty, Format::Ascii),
            _ => self.begin::<false>(byte),
        }
    }

    /// The first byte of a command or notice.
    fn begin<const HOST: bool>(&mut self, byte: u8) -> Step {
        match byte {
            b'#' => self.state = NUMBER,
            b'=' if HOST => self.state = REPORT,
            b'?' if HOST => self.state = CODE,
            b'!' | b'*' if !HOST => return self.enter(byte),
            b'~' if !HOST => {
                self.start = byte;
                self.left = MASK_VELOCITY;
                self.place = 2;
                self.state = VALUE;
            }
            _ if !HOST && word(byte).is_some() => {
                self.start = 0;
                self.vector.mask = 0;
                return self.ascii_word::<HOST>(byte);
            }
            HIGH.. => return Step::Refused(Fault::Unknown, Format::Binary),
            _ => return Step::Refused(Fault::Unknown, Format::Ascii),
        }
        Step::Taken
    }

    /// A byte behind the number of a notice.
    fn noticed(&mut self, byte: u8) -> Step {
        let format = self.number_written();
        match byte {
            b'?' => {
                self.state = CODE;
                Step::Taken
            }
            b'\r' | b'\n' => self.end(COMPLETED),
            _ if format == Format::Binary => {
                self.state = IDLE;
                Step::Before(COMPLETED)
            }
            _ => Step::Refused(Fault::Syntax, Format::Ascii),
        }
    }

    /// A byte behind `=`.
    fn reported(&mut self, byte: u8) -> Step {
        match byte {
            b'!' => self.enter(b'='),
            b'\r' | b'\n' => Step::Refused(Fault::Empty, Format::Ascii),
            HIGH.. => Step::Refused(Fault::Syntax, Format::Binary),
            _ => {
                self.start = 0;
                self.vector.mask = 0;
                self.ascii_word::<true>(byte)
            }
        }
    }

    /// A byte of an error notice's code.
    fn coded(&mut self, byte: u8) -> Step {
        match byte {
            HIGH.. if self.state == CODE => {
                self.start = b'?';
                self.value = (byte & !HIGH).into();
                self.end(REFUSED)
            }
            b'0'..=b'9' => self.more_digits(byte, CODE_DIGITS),
            b'\r' | b'\n' if self.state == CODE_DIGITS => {
                self.start = 0;
                if self.value <= CODE_MAX.into() {
                    self.end(REFUSED)
                } else {
                    Step::Refused(Fault::Range, Format::Ascii)
                }
            }
            _ => Step::Refused(Fault::Syntax, Format::Ascii),
        }
    }

    /// The end of something, with its last byte.
    fn end(&mut self, kind: c_int) -> Step {
        self.state = IDLE;
        Step::Done(kind)
    }

    /// A byte that has no place where it is: where to go on.
    fn refuse<const HOST: bool>(&mut self, byte: u8, fault: Fault, format: Format) -> Step {
        self.state = IDLE;
        if is_start::<HOST>(byte) {
            let fault = if fault == Fault::Syntax { Fault::Interrupted } else { fault };
            return Step::Malformed(fault, format, false);
        }
        let taken = match format {
            Format::Binary if fault != Fault::Number => {
                self.state = SKIP_PACKED;
                self.skips_packed::<HOST>(byte)
            }
            _ => {
                self.state = if is_end(byte) { IDLE } else { SKIP_LINE };
                true
            }
        };
        if !taken {
            self.state = IDLE;
        }
        Step::Malformed(fault, format, taken)
    }

    /// Whether a byte behind malformed binary, or stray packed bytes, goes with them.
    fn skips_packed<const HOST: bool>(&mut self, byte: u8) -> bool {
        if is_end(byte) || is_start::<HOST>(byte) || !HOST && word(byte).is_some() {
            return false;
        }
        if byte < HIGH && byte != b' ' {
            self.state = SKIP_LINE;
        }
        true
    }
}

/// Whether a byte stands nowhere but at the beginning of a command, or of a notice.
const fn is_start<const HOST: bool>(byte: u8) -> bool {
    if HOST { matches!(byte, b'#' | b'=' | b'?') } else { matches!(byte, b'!' | b'*' | b'#' | b'~') }
}
