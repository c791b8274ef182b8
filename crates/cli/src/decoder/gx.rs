//! Commands and notices of the GX protocol.

#[cfg(test)]
mod tests;
mod words;

use std::time::Duration;

use deltarobot_protocols::gx::{self, CommandReceiver, Item, Message, NoticeReceiver};
use serde_json::json;

use super::{Decoder, GARBAGE_MAX, Kind, Lanes, Piece, Terms};
use crate::hex::hex;
use crate::recording::Side;
use words::piece;
pub(crate) use words::{control_name, position, position_json, reason};

/// What is incomplete is given up after so long: somebody may be typing.
const PAUSE: Duration = Duration::from_secs(1);
/// No number needs more bytes, `#` included, unless zeros come first.
const NUMBER_LONGEST: usize = 16;
const ESC: u8 = 0x1B;
/// The least of packed bytes.
const PACKED: u8 = 0x80;

pub(crate) const TERMS: Terms =
    Terms { messages: "messages", by_kind: "messages_by_kind", damaged: "malformed", damaged_member: "malformed" };

/// Finds commands and notices as the library does, and keeps what it throws away.
#[derive(Default)]
pub(crate) struct Items {
    lanes: Lanes<Lane>,
}

impl Decoder for Items {
    fn feed(&mut self, from: Option<Side>, bytes: &[u8]) -> Vec<Piece> {
        let mut found = Vec::new();
        let lane = self.lanes.of(from);
        for byte in bytes {
            lane.take(from, *byte, &mut found);
            if lane.garbage.len() >= GARBAGE_MAX {
                lane.emit_garbage(from, &mut found);
            }
        }
        found
    }

    fn idle(&mut self, from: Option<Side>, silence: Duration, gap: Duration) -> Vec<Piece> {
        let mut found = Vec::new();
        if silence >= gap {
            self.lanes.of(from).idle(from, silence >= PAUSE.max(gap), &mut found);
        }
        found
    }
}

/// The receiver of either end.
#[derive(Clone)]
enum Reader {
    Motion(CommandReceiver),
    Host(NoticeReceiver),
}

impl Reader {
    /// What reads the bytes that this side sends.
    const fn of(from: Side) -> Self {
        match from {
            Side::Host => Self::Motion(CommandReceiver::new()),
            Side::Controller => Self::Host(NoticeReceiver::new()),
        }
    }

    const fn side(&self) -> Side {
        match self {
            Self::Motion(_) => Side::Host,
            Self::Host(_) => Side::Controller,
        }
    }

    /// Whether the byte was taken, and what it completes or ends.
    fn take(&mut self, byte: u8) -> (bool, Option<Item>) {
        let (taken, kind) = match self {
            Self::Motion(receiver) => receiver.receive(&[byte]),
            Self::Host(receiver) => receiver.receive(&[byte]),
        };
        (taken == 1, kind.map(|kind| self.item(kind)))
    }

    fn idle(&mut self) -> Option<Item> {
        let kind = match self {
            Self::Motion(receiver) => receiver.idle(),
            Self::Host(receiver) => receiver.idle(),
        };
        kind.map(|kind| self.item(kind))
    }

    fn item(&self, kind: gx::Kind) -> Item {
        match self {
            Self::Motion(receiver) => receiver.item(kind),
            Self::Host(receiver) => receiver.item(kind),
        }
    }

    /// What it would report if nothing followed.
    fn pending(&self) -> Option<Message> {
        self.clone().idle().map(|item| item.message)
    }
}

/// The bytes of one direction, or of both.
struct Lane {
    reader: Reader,
    /// A `#` and what follows, as long as it does not show who sends it.
    undecided: Vec<u8>,
    /// The bytes of what is not complete.
    bytes: Vec<u8>,
    garbage: Vec<u8>,
    /// What is wrong with it.
    codes: Vec<u8>,
    /// What was malformed may go on.
    is_skipping: bool,
}

impl Default for Lane {
    fn default() -> Self {
        Self {
            reader: Reader::of(Side::Host),
            undecided: Vec::new(),
            bytes: Vec::new(),
            garbage: Vec::new(),
            codes: Vec::new(),
            is_skipping: false,
        }
    }
}

impl Lane {
    fn take(&mut self, from: Option<Side>, byte: u8, found: &mut Vec<Piece>) {
        if self.undecided.is_empty() {
            self.begin_or_go_on(from, byte, found);
            return;
        }
        self.undecided.push(byte);
        if let Some(side) = sender_of_numbered(&self.undecided) {
            self.decide(from, side, found);
        }
    }

    /// Reads what was undecided as what that side sends.
    fn decide(&mut self, from: Option<Side>, side: Side, found: &mut Vec<Piece>) {
        self.expect(side);
        for byte in std::mem::take(&mut self.undecided) {
            self.read(from, byte, found);
        }
    }

    fn begin_or_go_on(&mut self, from: Option<Side>, byte: u8, found: &mut Vec<Piece>) {
        if self.bytes.is_empty() {
            match (from, byte) {
                (Some(side), _) => self.expect(side),
                (None, b'#') => {
                    self.undecided.push(byte);
                    return;
                }
                (None, b'=' | b'?') => self.expect(Side::Controller),
                (None, _) if self.is_skipping || byte.is_ascii_whitespace() => (),
                (None, _) => self.expect(Side::Host),
            }
        }
        self.read(from, byte, found);
    }

    fn expect(&mut self, side: Side) {
        if self.reader.side() != side {
            self.reader = Reader::of(side);
        }
    }

    fn read(&mut self, from: Option<Side>, byte: u8, found: &mut Vec<Piece>) {
        let (is_taken, item) = self.reader.take(byte);
        if !is_taken {
            self.emit(from, item, found);
            // What ends one thing begins another, of which nothing is known.
            self.begin_or_go_on(from, byte, found);
            return;
        }
        self.bytes.push(byte);
        if item.is_some() {
            self.emit(from, item, found);
        } else if byte == ESC {
            self.emit_garbage(from, found);
            let json = json!({ "kind": "clear", "bytes": hex(&self.bytes) });
            found.push(Piece::new(from, Kind::Message("clear".into()), "clear".into(), json));
            self.bytes.clear();
            self.is_skipping = false;
        } else if self.reader.pending().is_none() {
            // What belongs to nothing: the rest of what was malformed, or what separates two things.
            let ends_line = matches!(byte, b'\r' | b'\n');
            if ends_line || self.garbage.is_empty() && byte.is_ascii_whitespace() {
                self.bytes.pop();
            }
            self.garbage.append(&mut self.bytes);
            self.is_skipping &= !ends_line;
        }
    }

    fn idle(&mut self, from: Option<Side>, gives_up: bool, found: &mut Vec<Piece>) {
        // A packed number is a notice if nothing follows.
        if !self.undecided.is_empty() && (gives_up || matches!(self.undecided.as_slice(), [_, PACKED..=0xFF, _])) {
            self.decide(from, Side::Controller, found);
        }
        if gives_up || self.reader.pending() == Some(Message::Completed) {
            let item = self.reader.idle();
            self.emit(from, item, found);
        }
        self.emit_garbage(from, found);
    }

    /// Emits what the bytes until here are.
    fn emit(&mut self, from: Option<Side>, item: Option<Item>, found: &mut Vec<Piece>) {
        let bytes = std::mem::take(&mut self.bytes);
        let Some(item) = item else { return };
        if let Message::Malformed(code) = item.message {
            self.garbage.extend(bytes);
            self.codes.push(code);
            self.is_skipping = true;
            return;
        }
        self.emit_garbage(from, found);
        self.is_skipping = false;
        found.push(piece(self.reader.side(), &item, &bytes));
    }

    fn emit_garbage(&mut self, from: Option<Side>, found: &mut Vec<Piece>) {
        if self.garbage.is_empty() {
            return;
        }
        let bytes = std::mem::take(&mut self.garbage);
        let reasons: Vec<_> = std::mem::take(&mut self.codes).into_iter().map(reason).collect();
        let kind = Kind::Garbage { bytes: bytes.len(), damaged: reasons.len() };
        let json = json!({ "garbage": hex(&bytes), "malformed": reasons });
        let reasons = if reasons.is_empty() { String::new() } else { format!(" ({})", reasons.join(", ")) };
        let text = format!("garbage: {}{reasons}", hex(&bytes));
        found.push(Piece::new(from, kind, text, json));
    }
}

/// Who sends what begins with `#` and these bytes; `None` as long as that does not show.
fn sender_of_numbered(bytes: &[u8]) -> Option<Side> {
    let (is_packed, behind) = match bytes {
        [] | [_] | [_, PACKED..=0xFF] => return None,
        [_, PACKED..=0xFF, _, behind @ ..] => (true, behind),
        [_, behind @ ..] => {
            let digits = behind.iter().take_while(|byte| byte.is_ascii_digit()).count();
            (false, behind.get(digits..).unwrap_or_default())
        }
    };
    match behind.first() {
        None if bytes.len() > NUMBER_LONGEST => Some(Side::Host),
        None => None,
        Some(b'?' | b'\r' | b'\n') => Some(Side::Controller),
        // A number that is reported, and the next notice behind it.
        Some(b'#' | b'=') if is_packed => Some(Side::Controller),
        Some(_) => Some(Side::Host),
    }
}
