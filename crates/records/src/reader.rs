//! Reads MCAP, also what was not ended.

use std::collections::BTreeMap;
use std::io::{self, Read};
use std::time::Duration;

use deltarobot_cli::hex::from_hex;
use deltarobot_cli::recording::Side;
use mcap::McapError;
use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use serde_json::Value;

use crate::channels::{Channel, Robot};
use crate::writer::io_error;

/// A longer record or chunk is refused: it is held in memory.
const RECORD_MAX: usize = 1 << 26;

/// What was read.
#[derive(Debug, PartialEq)]
pub struct Message<'a> {
    /// Whose it is.
    pub robot: &'a Robot,
    /// Nanoseconds since 1970, or since the beginning of a record that has no dates.
    pub log_time: u64,
    /// What it says.
    pub content: Content,
}

/// What a message says.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// Bytes that passed on the line, and when since the recording began, if that is said.
    Bytes(Option<Duration>, Side, Vec<u8>),
    /// What happened besides.
    Event(Value),
}

/// How reading ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The file is whole.
    Whole,
    /// It ends behind its last chunk, or in a later one: its writer was killed, or still writes.
    Unended,
}

/// Reads a file or a stream to its end. Channels of others are passed over, as are those whose messages can be had from
/// the bytes.
pub fn read(mut input: impl Read, mut take: impl FnMut(&Message) -> io::Result<()>) -> io::Result<End> {
    let options = LinearReaderOptions::default().with_prevalidate_chunk_crcs(true).with_record_length_limit(RECORD_MAX);
    let mut reader = LinearReader::new_with_options(options);
    let mut channels = BTreeMap::new();
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(need)) => {
                let count = match input.read(reader.insert(need)) {
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                    result => result?,
                };
                reader.notify_read(count);
            }
            Ok(LinearReadEvent::Record { opcode, data }) => {
                match mcap::parse_record(opcode, data).map_err(io_error)? {
                    Record::Channel(channel) => {
                        let robot = Robot::from_metadata(&channel.metadata);
                        let kind = [Channel::Bytes, Channel::Events].into_iter().find(|kind| {
                            channel.message_encoding == "json" && channel.topic.ends_with(&format!("/{}", kind.name()))
                        });
                        if let (Some(robot), Some(kind)) = (robot, kind) {
                            channels.insert(channel.id, (robot, kind));
                        }
                    }
                    Record::Message { header, data } => {
                        if let Some((robot, kind)) = channels.get(&header.channel_id) {
                            let wrong = |error| {
                                let topic = kind.topic(&robot.name);
                                io::Error::other(format!("message {} of {topic}: {error}", header.sequence))
                            };
                            let content = content(*kind, &data).map_err(wrong)?;
                            take(&Message { robot, log_time: header.log_time, content })?;
                        }
                    }
                    _ => (),
                }
            }
            Err(McapError::UnexpectedEof) => return Ok(End::Unended),
            Err(McapError::UnsupportedCompression(name)) => {
                let text =
                    format!("compressed with {name}; `mcap compress --compression none` makes a file that is not");
                return Err(io::Error::other(text));
            }
            Err(error) => return Err(io_error(error)),
        }
    }
    Ok(End::Whole)
}

fn content(channel: Channel, json: &[u8]) -> Result<Content, String> {
    let value: Value = serde_json::from_slice(json).map_err(|error| error.to_string())?;
    if channel == Channel::Events {
        return Ok(Content::Event(value));
    }
    let from = match value.get("from").and_then(Value::as_str) {
        Some("host") => Side::Host,
        Some("controller") => Side::Controller,
        _ => return Err("`from` is neither host nor controller".into()),
    };
    let bytes = from_hex(value.get("bytes").and_then(Value::as_str).ok_or("there are no `bytes`")?)?;
    let time = match value.get("time").map(Value::as_f64) {
        None => None,
        Some(time) => Some(time.and_then(|time| Duration::try_from_secs_f64(time).ok()).ok_or("`time` is none")?),
    };
    Ok(Content::Bytes(time, from, bytes))
}

#[cfg(test)]
mod tests {
    use super::{End, Side, read};
    use crate::channels::{Channel, Robot};
    use crate::writer::Writer;

    fn file() -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut writer = Writer::new(&mut bytes).unwrap();
        let robot = Robot { name: "lab".into(), gap: None, is_dated: true };
        for time in 0..3 {
            writer.put(&robot, Channel::Bytes, time, br#"{"from":"host","bytes":"24 53"}"#).unwrap();
            writer.put(&robot, Channel::Events, time, br#"{"event":"x"}"#).unwrap();
            writer.flush().unwrap();
        }
        writer.finish().unwrap();
        bytes
    }

    fn count(bytes: &[u8]) -> (usize, Option<End>) {
        let mut count = 0;
        let end = read(bytes, |message| {
            assert_eq!(message.robot.name, "lab");
            assert!(!matches!(&message.content, super::Content::Bytes(_, from, _) if *from != Side::Host));
            count += 1;
            Ok(())
        });
        (count, end.ok())
    }

    #[test]
    fn each_beginning_of_a_file_is_read_up_to_its_last_chunk() {
        let file = file();
        assert_eq!(count(&file), (6, Some(End::Whole)));
        let mut last = 0;
        for length in 8..file.len() {
            let (count, end) = count(&file[..length]);
            assert!(end == Some(End::Unended) && count >= last && count % 2 == 0, "{length}: {count} {end:?}");
            last = count;
        }
        assert_eq!(last, 6);
    }

    #[test]
    fn whatever_is_in_a_file_reading_it_ends() {
        let file = file();
        for place in 0..file.len() {
            for flip in [1, 0x80, 0xFF] {
                let mut damaged = file.clone();
                damaged[place] ^= flip;
                let mut count = 0;
                let _ = read(damaged.as_slice(), |_| {
                    count += 1;
                    Ok(())
                });
                assert!(count <= 6, "{place}: {count}");
            }
        }
    }
}
