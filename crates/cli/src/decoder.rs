//! What passes on a line, taken apart: messages, and what lies between them. A file for each protocol.

pub mod deltarobot;
pub(crate) mod gx;
pub(crate) mod line;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::time::Duration;

use serde_json::{Map, Value, json};

use crate::recording::Side;

/// What is certain to be garbage is shown after so much silence.
const QUIET: Duration = Duration::from_millis(50);

/// A run of garbage without an end is reported in pieces of about this many bytes.
const GARBAGE_MAX: usize = 64;

/// Kinds of messages that are counted each for itself: some protocols let who sends make up names.
const KINDS_MAX: usize = 100;
/// What the others are counted as.
const OTHERS: &str = "(others)";

/// Takes the bytes of a line apart.
pub trait Decoder {
    /// Takes bytes of which it is known, or not, who sent them, and gives back what is certain by then.
    fn feed(&mut self, from: Option<Side>, bytes: &[u8]) -> Vec<Piece>;

    /// That side has been silent for so long: gives back what is certain, and what is given up when that is the gap
    /// which ends messages on this line.
    fn idle(&mut self, from: Option<Side>, silence: Duration, gap: Duration) -> Vec<Piece>;

    /// Nothing will follow from that side.
    fn end(&mut self, from: Option<Side>) -> Vec<Piece> {
        self.idle(from, Duration::MAX, Duration::ZERO)
    }
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Who sent it, where that is known or the message says.
    pub from: Option<Side>,
    /// What it counts as.
    pub kind: Kind,
    /// In words.
    pub text: String,
    /// As JSON.
    pub json: Map<String, Value>,
}

/// What it counts as.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A message of this name.
    Message(Cow<'static, str>),
    /// No message, in so many bytes, and how many would be one if something in them were right.
    Garbage {
        /// Bytes of it.
        bytes: usize,
        /// How many messages would be in it.
        damaged: usize,
    },
}

impl Piece {
    /// `json` is an object.
    fn new(from: Option<Side>, kind: Kind, text: String, json: Value) -> Self {
        let json = if let Value::Object(json) = json { json } else { Map::new() };
        Self { from, kind, text, json }
    }

    /// Whether it is a message and no garbage.
    pub const fn is_message(&self) -> bool {
        matches!(self.kind, Kind::Message(_))
    }

    /// What the robot is doing, and where, if the message says that.
    pub fn state(&self) -> Option<Value> {
        let member = |name| Some(self.json.get(name)?.clone());
        Some(json!({ "state": member("state")?, "position": member("position")?, "stops": member("stops")? }))
    }

    /// As JSON, between the other members of an object.
    pub fn add_to(&self, mut object: Value) -> Value {
        if let Some(object) = object.as_object_mut() {
            object.extend(self.json.clone());
        }
        object
    }
}

/// Who may have sent something: nobody knows, or one of the two.
pub const SENDERS: [Option<Side>; 3] = [None, Some(Side::Host), Some(Side::Controller)];

/// One of them for each sender.
#[derive(Debug, Default)]
pub struct Lanes<T>([T; SENDERS.len()]);

impl<T> Lanes<T> {
    /// That one's.
    pub const fn of(&mut self, from: Option<Side>) -> &mut T {
        let Self([unknown, host, controller]) = self;
        match from {
            None => unknown,
            Some(Side::Host) => host,
            Some(Side::Controller) => controller,
        }
    }
}

/// How statistics name things.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Terms {
    /// Messages, such as `frames`, and the member of the object that counts each kind.
    pub(crate) messages: &'static str,
    pub(crate) by_kind: &'static str,
    /// What is damaged, in words and as a member of the object.
    pub(crate) damaged: &'static str,
    pub(crate) damaged_member: &'static str,
}

/// What has passed.
#[derive(Debug)]
pub(crate) struct Statistics {
    terms: Terms,
    bytes: usize,
    garbage_bytes: usize,
    damaged: usize,
    /// How many messages there were of each kind.
    messages: BTreeMap<Cow<'static, str>, usize>,
}

impl Statistics {
    pub(crate) const fn new(terms: Terms) -> Self {
        Self { terms, bytes: 0, garbage_bytes: 0, damaged: 0, messages: BTreeMap::new() }
    }

    /// Bytes have come, whatever they are.
    pub(crate) const fn count_bytes(&mut self, bytes: &[u8]) {
        self.bytes += bytes.len();
    }

    pub(crate) fn count(&mut self, piece: &Piece) {
        match &piece.kind {
            Kind::Message(name) => {
                let is_counted = self.messages.len() < KINDS_MAX || self.messages.contains_key(name);
                let name = if is_counted { name.clone() } else { OTHERS.into() };
                *self.messages.entry(name).or_default() += 1;
            }
            Kind::Garbage { bytes, damaged } => {
                self.garbage_bytes += bytes;
                self.damaged += damaged;
            }
        }
    }

    fn messages(&self) -> usize {
        self.messages.values().sum()
    }

    /// On one line, and over how long.
    pub(crate) fn text(&self, time: Duration) -> String {
        let kinds: Vec<_> = self.messages.iter().map(|(name, count)| format!("{count} {name}")).collect();
        let kinds = if kinds.is_empty() { String::new() } else { format!(" ({})", kinds.join(", ")) };
        format!(
            "{} bytes in {:.3} s: {} {}{kinds}, {} bytes of garbage, {} {}",
            self.bytes,
            time.as_secs_f64(),
            self.messages(),
            self.terms.messages,
            self.garbage_bytes,
            self.damaged,
            self.terms.damaged
        )
    }

    pub(crate) fn json(&self, time: Duration) -> Value {
        json!({ "statistics": {
            "seconds": seconds(time),
            "bytes": self.bytes,
            (self.terms.messages): self.messages(),
            (self.terms.by_kind): self.messages,
            "garbage_bytes": self.garbage_bytes,
            (self.terms.damaged_member): self.damaged,
        } })
    }
}

/// In microseconds' precision.
pub fn seconds(time: Duration) -> Value {
    format!("{:.6}", time.as_secs_f64()).parse::<f64>().map_or(Value::Null, Value::from)
}

#[cfg(test)]
mod tests {
    use super::{KINDS_MAX, Kind, OTHERS, Piece, Statistics, line};

    #[test]
    fn names_without_end_are_counted_as_one() {
        let mut statistics = Statistics::new(line::TERMS);
        for round in 0..2 {
            for number in 0..3 * KINDS_MAX {
                let kind = Kind::Message(format!("c{number}").into());
                statistics.count(&Piece::new(None, kind, String::new(), serde_json::Value::Null));
            }
            assert_eq!(statistics.messages.len(), KINDS_MAX + 1);
            assert_eq!(
                (statistics.messages["c7"], statistics.messages[OTHERS]),
                (round + 1, (round + 1) * 2 * KINDS_MAX)
            );
        }
    }
}
