//! What watchers get.

use std::sync::{Arc, OnceLock};

use axum::extract::ws::Utf8Bytes;
use deltarobot_cli::decoder::Piece;
use deltarobot_cli::recording::Side;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::lease::Driver;
use crate::state::{Operation, State};
use crate::trace::Run;

/// Something that has happened to a robot.
#[derive(Debug)]
pub(crate) struct Event {
    /// The robot's name.
    pub(crate) robot: Arc<str>,
    /// What has happened.
    pub(crate) what: What,
    json: OnceLock<Utf8Bytes>,
}

/// Kinds of events.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub(crate) enum What {
    /// Something about its state is another than before, or was reported again.
    State(Arc<State>),
    /// A message has passed.
    Message(Message),
    /// A motion has ended.
    Ended {
        /// When.
        time: String,
        /// Which, and how.
        operation: Operation,
    },
    /// Somebody else drives.
    Driver {
        /// When.
        time: String,
        /// Who.
        driver: Option<Driver>,
    },
    /// A path is traced.
    Path {
        /// When.
        time: String,
        /// How far.
        run: Run,
    },
}

/// A message on the line, or what is none.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Message {
    /// When it was received or sent.
    pub(crate) time: String,
    /// Who sent it.
    pub(crate) from: Option<&'static str>,
    /// In words.
    pub(crate) text: String,
    /// In hexadecimal digits.
    pub(crate) bytes: String,
    /// What it says.
    pub(crate) json: Map<String, Value>,
}

impl Message {
    /// What a decoder has found.
    pub(crate) fn new(time: String, mut piece: Piece) -> Self {
        let bytes = ["bytes", "garbage"].iter().find_map(|name| piece.json.get(*name)?.as_str().map(str::to_owned));
        piece.json.remove("bytes");
        let from = piece.from.map(Side::name);
        Self { time, from, text: piece.text, bytes: bytes.unwrap_or_default(), json: piece.json }
    }
}

impl Event {
    /// An event of that robot.
    pub(crate) const fn new(robot: Arc<str>, what: What) -> Self {
        Self { robot, what, json: OnceLock::new() }
    }

    /// As it is sent. It is made once, however many watch.
    pub(crate) fn json(&self) -> Utf8Bytes {
        #[derive(Serialize)]
        struct Sent<'a> {
            robot: &'a str,
            #[serde(flatten)]
            what: &'a What,
        }
        let make = || serde_json::to_string(&Sent { robot: &self.robot, what: &self.what }).unwrap_or_default().into();
        self.json.get_or_init(make).clone()
    }

    /// Counts the states of a robot.
    pub(crate) fn seq(&self) -> Option<u64> {
        match &self.what {
            What::State(state) => Some(state.seq),
            _ => None,
        }
    }
}
