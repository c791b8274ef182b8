//! What recordings of all formats are made of.

use std::io;
use std::path::Path;
use std::time::Duration;

use chrono::{DateTime, Utc};
use deltarobot_cli::recording::Side;
use deltarobot_cli::status::Failure;
use serde_json::Value;

/// How a robot is called whose recording has no name for it.
pub(super) const NAMELESS: &str = "robot";

/// A format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Format {
    /// What `deltarobot record` writes
    Text,
    /// Chunks with an index, for Foxglove, ROS 2 and others
    Mcap,
    /// A table, for spreadsheets
    Csv,
}

impl Format {
    /// What a file's extension says.
    pub(super) fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "txt" => Some(Self::Text),
            "mcap" => Some(Self::Mcap),
            "csv" => Some(Self::Csv),
            _ => None,
        }
    }
}

/// What was recorded at a time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Record {
    pub(super) robot: String,
    /// Since the recording began.
    pub(super) time: Duration,
    /// By the clock on the wall, where it was noted.
    pub(super) date: Option<DateTime<Utc>>,
    /// The silence that ends messages, where it was noted.
    pub(super) gap: Option<Duration>,
    pub(super) content: Content,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Content {
    Bytes(Side, Vec<u8>),
    /// What happened besides.
    Event(Value),
}

/// Where records go.
pub(super) trait Sink {
    /// Writes a record.
    fn put(&mut self, record: &Record) -> Result<(), Failure>;
    /// Nothing has come for a while.
    fn idle(&mut self) -> Result<(), Failure>;
    /// Nothing follows.
    fn finish(&mut self) -> Result<(), Failure>;
}

/// What is the matter with a file or a stream.
pub(super) fn failure(name: &Path, error: &io::Error) -> Failure {
    if error.kind() == io::ErrorKind::BrokenPipe {
        // Who reads it has seen enough.
        return Failure::Output(io::Error::from(io::ErrorKind::BrokenPipe));
    }
    Failure::of_file(name.display(), error)
}
