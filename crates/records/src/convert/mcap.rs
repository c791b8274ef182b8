//! MCAP.

use std::fs::File;
use std::io::{self, BufReader, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use chrono::DateTime;
use deltarobot_cli::Protocol;
use deltarobot_cli::decoder::{Piece, seconds};
use deltarobot_cli::hex::hex;
use deltarobot_cli::recording::Side;
use deltarobot_cli::status::Failure;
use serde_json::json;

use super::formats::{Content, Record, Sink, failure};
use super::messages::Messages;
use crate::channels::{Channel, Robot};
use crate::reader::{self, End};
use crate::rotation::{Limits, Naming, Recorder};
use crate::writer::Writer;

/// Reads a file to its end, of all robots or of one. Returns what could not be read of it.
pub(super) fn read(
    input: &File,
    name: &Path,
    robot: Option<&str>,
    sink: &mut dyn Sink,
) -> Result<Option<String>, Failure> {
    let (mut first, mut given) = (None, Ok(()));
    let mut others = Vec::new();
    let ended = reader::read(BufReader::new(input), |message| {
        if robot.is_some_and(|robot| robot != message.robot.name) {
            if !others.contains(&message.robot.name) {
                others.push(message.robot.name.clone());
            }
            return Ok(());
        }
        given = sink.put(&record(message, *first.get_or_insert(message.log_time)));
        // The error is what `given` has.
        if given.is_ok() { Ok(()) } else { Err(io::ErrorKind::Other.into()) }
    });
    given?;
    let ended = ended.map_err(|error| failure(name, &error))?;
    if first.is_none() {
        let text = if others.is_empty() {
            "there is no robot of this program in it".into()
        } else {
            format!("that robot is not in it; it has {}", others.join(", "))
        };
        return Err(Failure::of(name.display(), text));
    }
    Ok((ended == End::Unended).then(|| "was not ended; what is there up to its last chunk was read".into()))
}

fn record(message: &reader::Message, first: u64) -> Record {
    let robot = message.robot;
    let since = Duration::from_nanos(message.log_time.saturating_sub(if robot.is_dated { first } else { 0 }));
    let (time, content) = match &message.content {
        reader::Content::Bytes(time, from, bytes) => (time.unwrap_or(since), Content::Bytes(*from, bytes.clone())),
        reader::Content::Event(event) => (since, Content::Event(event.clone())),
    };
    let date = i64::try_from(message.log_time).ok().map(DateTime::from_timestamp_nanos);
    Record { robot: robot.name.clone(), time, date: date.filter(|_| robot.is_dated), gap: robot.gap, content }
}

/// Where MCAP goes.
pub(super) enum Out {
    Files(Recorder),
    Stream(Option<Writer<Box<dyn Write>>>),
}

impl Out {
    fn put(&mut self, robot: &Robot, channel: Channel, time: u64, json: &[u8]) -> io::Result<()> {
        match self {
            Self::Files(files) => files.put(robot, channel, time, json),
            Self::Stream(stream) => stream.as_mut().map_or(Ok(()), |stream| stream.put(robot, channel, time, json)),
        }
    }

    fn flush_if_due(&mut self) -> io::Result<()> {
        match self {
            Self::Files(files) => files.flush_if_due(),
            Self::Stream(stream) => stream.as_mut().map_or(Ok(()), Writer::flush_if_due),
        }
    }

    fn finish(&mut self) -> io::Result<()> {
        match self {
            Self::Files(files) => files.finish(),
            Self::Stream(stream) => stream.take().map_or(Ok(()), |stream| stream.finish().map(drop)),
        }
    }
}

/// Writes it: of bytes also the messages that they are, and the states that those report.
pub(super) struct Mcap {
    out: Out,
    name: PathBuf,
    messages: Messages,
}

impl Mcap {
    /// Writes to a stream.
    pub(super) fn stream(out: Box<dyn Write>, name: &Path, protocol: Protocol) -> Result<Self, Failure> {
        let stream = Writer::new(out).map_err(|error| failure(name, &error))?;
        Ok(Self { out: Out::Stream(Some(stream)), name: name.to_owned(), messages: Messages::new(protocol) })
    }

    /// Writes files.
    pub(super) fn files(path: &Path, limits: Limits, protocol: Protocol) -> Result<Self, Failure> {
        let mut files = Recorder::new(Naming::Numbered(path.to_owned()), limits);
        files.begin().map_err(|error| failure(path, &error))?;
        Ok(Self { out: Out::Files(files), name: path.to_owned(), messages: Messages::new(protocol) })
    }

    fn found(out: &mut Out, record: &Record, piece: &Piece) -> io::Result<()> {
        let (robot, time) = of(record);
        let value = piece.add_to(json!({ "from": piece.from.map(Side::name), "text": piece.text }));
        out.put(&robot, Channel::Messages, time, value.to_string().as_bytes())?;
        match piece.state() {
            Some(state) => out.put(&robot, Channel::State, time, state.to_string().as_bytes()),
            None => Ok(()),
        }
    }
}

/// Whose it is, and when.
fn of(record: &Record) -> (Robot, u64) {
    let time = record.date.and_then(|date| u64::try_from(date.timestamp_nanos_opt()?).ok());
    let robot = Robot { name: record.robot.clone(), gap: record.gap, is_dated: time.is_some() };
    (robot, time.unwrap_or_else(|| u64::try_from(record.time.as_nanos()).unwrap_or(u64::MAX)))
}

impl Sink for Mcap {
    fn put(&mut self, record: &Record) -> Result<(), Failure> {
        let Self { out, name, messages } = self;
        let (robot, time) = of(record);
        let (channel, value) = match &record.content {
            Content::Bytes(from, bytes) => {
                (Channel::Bytes, json!({ "time": seconds(record.time), "from": from.name(), "bytes": hex(bytes) }))
            }
            Content::Event(event) => (Channel::Events, event.clone()),
        };
        let mut result = out.put(&robot, channel, time, value.to_string().as_bytes());
        messages.take(record, |record, piece| {
            if result.is_ok() {
                result = Self::found(out, record, piece);
            }
        });
        result.map_err(|error| failure(name, &error))
    }

    fn idle(&mut self) -> Result<(), Failure> {
        self.out.flush_if_due().map_err(|error| failure(&self.name, &error))
    }

    fn finish(&mut self) -> Result<(), Failure> {
        let Self { out, name, messages } = self;
        let mut result = Ok(());
        messages.end(|record, piece| {
            if result.is_ok() {
                result = Self::found(out, record, piece);
            }
        });
        result.and_then(|()| out.finish()).map_err(|error| failure(name, &error))
    }
}
