//! What is in the channels of a robot.

use std::collections::BTreeMap;
use std::time::Duration;

/// One of a robot's channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Channel {
    /// The bytes on the line.
    Bytes,
    /// The messages that they are.
    Messages,
    /// What the robot is doing, and where.
    State,
    /// What happened besides.
    Events,
}

impl Channel {
    /// As the topic ends.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bytes => "bytes",
            Self::Messages => "messages",
            Self::State => "state",
            Self::Events => "events",
        }
    }

    /// The topic of a robot's channel. Names may have any letters, but topics are split at `/`.
    #[must_use]
    pub fn topic(self, robot: &str) -> String {
        format!("/{}/{}", robot.replace('/', "_"), self.name())
    }

    /// What messages are called.
    pub(crate) const fn schema_name(self) -> &'static str {
        match self {
            Self::Bytes => "deltarobot.Bytes",
            Self::Messages => "deltarobot.Message",
            Self::State => "deltarobot.State",
            Self::Events => "deltarobot.Event",
        }
    }

    /// Their JSON schema.
    pub(crate) const fn schema(self) -> &'static str {
        match self {
            Self::Bytes => include_str!("schemas/bytes.json"),
            Self::Messages => include_str!("schemas/message.json"),
            Self::State => include_str!("schemas/state.json"),
            Self::Events => include_str!("schemas/event.json"),
        }
    }
}

/// What is the same in all of a robot's record.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Robot {
    /// The robot's name.
    pub name: String,
    /// The silence that ends a message on its line.
    pub gap: Option<Duration>,
    /// Whether log times are dates; else they begin at 0.
    pub is_dated: bool,
}

impl Robot {
    pub(crate) fn metadata(&self) -> BTreeMap<String, String> {
        let gap = self.gap.map(|gap| ("gap", gap.as_secs_f64().to_string()));
        let dated = if self.is_dated { "yes" } else { "no" };
        let members = [("robot", self.name.clone()), ("dated", dated.to_owned())].into_iter().chain(gap);
        members.map(|(name, value)| (name.to_owned(), value)).collect()
    }

    pub(crate) fn from_metadata(metadata: &BTreeMap<String, String>) -> Option<Self> {
        let gap = metadata.get("gap").and_then(|gap| gap.parse().ok());
        Some(Self {
            name: metadata.get("robot")?.clone(),
            gap: gap.and_then(|gap| Duration::try_from_secs_f64(gap).ok()),
            is_dated: metadata.get("dated").is_none_or(|dated| dated != "no"),
        })
    }
}
