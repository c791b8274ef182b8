//! Writes MCAP.

use std::collections::BTreeMap;
use std::io::{self, BufWriter, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{McapError, WriteOptions};

use crate::channels::{Channel, Robot};

/// What comes is in the file at the latest when this time is over, if it is [looked](Writer::flush_if_due).
pub const FLUSH_TIME: Duration = Duration::from_secs(1);
/// Bytes after which a chunk ends, even if that time is not over.
const CHUNK_SIZE: u64 = 1 << 18;

/// Writes one file, or a stream.
pub struct Writer<W: Write> {
    mcap: mcap::Writer<NoSeek<BufWriter<Counting<W>>>>,
    written: Arc<Written>,
    /// The identifiers of channels that are known, and how many messages each has.
    channels: BTreeMap<(String, Channel), (u16, u32)>,
    /// What waits for the end of its chunk.
    waiting: u64,
    /// The length behind the last chunk.
    sound: u64,
    flushed: Instant,
}

/// What has become of what was written.
#[derive(Debug, Default)]
struct Written {
    length: AtomicU64,
    has_failed: AtomicBool,
}

/// Counts bytes; after an error nothing more is written, so that what is there ends where it did.
struct Counting<W> {
    out: W,
    written: Arc<Written>,
}

impl<W: Write> Write for Counting<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.written.has_failed.load(Ordering::Relaxed) {
            return Err(io::Error::other("an earlier write failed"));
        }
        match self.out.write(bytes) {
            Ok(count) => {
                self.written.length.fetch_add(u64::try_from(count).unwrap_or_default(), Ordering::Relaxed);
                Ok(count)
            }
            Err(error) => {
                let may_try_again = error.kind() == io::ErrorKind::Interrupted;
                self.written.has_failed.store(!may_try_again, Ordering::Relaxed);
                Err(error)
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl<W: Write> Writer<W> {
    /// Begins to write.
    pub fn new(out: W) -> io::Result<Self> {
        let options = WriteOptions::new()
            .compression(None)
            .library(concat!("deltarobot ", env!("CARGO_PKG_VERSION")))
            // It is `put` that ends chunks. They are put together in memory, with the right length from the beginning.
            .chunk_size(None)
            .disable_seeking(true);
        let written = Arc::<Written>::default();
        let out = Counting { out, written: Arc::clone(&written) };
        let out = NoSeek::new(BufWriter::with_capacity(1 << 16, out));
        let mut writer = Self {
            mcap: options.create(out).map_err(io_error)?,
            written,
            channels: BTreeMap::new(),
            waiting: 0,
            sound: 0,
            flushed: Instant::now(),
        };
        writer.flush()?;
        Ok(writer)
    }

    /// Writes a message, which is JSON. The time is in nanoseconds since 1970, or since the beginning of a record that
    /// has no dates.
    pub fn put(&mut self, robot: &Robot, channel: Channel, time: u64, json: &[u8]) -> io::Result<()> {
        let (channel_id, sequence) = self.channel(robot, channel)?;
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        self.mcap.write_to_known_channel(&header, json).map_err(io_error)?;
        self.waiting += u64::try_from(json.len()).unwrap_or_default() + 31;
        if self.waiting >= CHUNK_SIZE { self.flush() } else { self.flush_if_due() }
    }

    fn channel(&mut self, robot: &Robot, channel: Channel) -> io::Result<(u16, u32)> {
        let key = (robot.name.clone(), channel);
        if let Some((id, count)) = self.channels.get_mut(&key) {
            *count = count.wrapping_add(1);
            return Ok((*id, *count));
        }
        let schema = self.mcap.add_schema(channel.schema_name(), "jsonschema", channel.schema().as_bytes());
        let schema = schema.map_err(io_error)?;
        let id = self.mcap.add_channel(schema, &channel.topic(&robot.name), "json", &robot.metadata());
        let id = id.map_err(io_error)?;
        self.channels.insert(key, (id, 0));
        Ok((id, 0))
    }

    /// Ends a chunk that has waited for long enough.
    pub fn flush_if_due(&mut self) -> io::Result<()> {
        if self.waiting > 0 && self.flushed.elapsed() >= FLUSH_TIME { self.flush() } else { Ok(()) }
    }

    /// Ends the chunk: what was put is in the file.
    pub fn flush(&mut self) -> io::Result<()> {
        self.mcap.flush().map_err(io_error)?;
        (self.waiting, self.flushed) = (0, Instant::now());
        self.sound = self.written();
        Ok(())
    }

    /// How many bytes have been written.
    #[must_use]
    pub fn written(&self) -> u64 {
        self.written.length.load(Ordering::Relaxed)
    }

    /// The length up to which readers can read, whatever comes behind.
    pub(crate) const fn sound(&self) -> u64 {
        self.sound
    }

    /// How long the file is, with what waits for the end of its chunk.
    #[must_use]
    pub fn length(&self) -> u64 {
        self.written() + self.waiting
    }

    /// Writes what belongs to the end of a file. Returns its length.
    pub fn finish(mut self) -> io::Result<u64> {
        self.flush()?;
        self.mcap.finish().map_err(io_error)?;
        self.mcap.into_inner().flush()?;
        Ok(self.written.length.load(Ordering::Relaxed))
    }
}

/// What is wrong, in the words of the system where it was that.
pub(crate) fn io_error(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other.to_string()),
    }
}
