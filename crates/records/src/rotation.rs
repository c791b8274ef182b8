//! Files that are ended, and followed by others, at a size or after a time.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use chrono::Utc;

use crate::channels::{Channel, Robot};
use crate::writer::Writer;

/// When a file is ended and another begun.
#[derive(Clone, Copy, Debug, Default)]
pub struct Limits {
    /// At this size in bytes.
    pub size: Option<u64>,
    /// After this time.
    pub time: Option<Duration>,
}

/// How files are named.
#[derive(Clone, Debug)]
pub enum Naming {
    /// This one is written; those that are ended are renamed: `x.mcap` to `x.1.mcap`.
    Numbered(PathBuf),
    /// In this directory, by the date at which they are begun.
    Dated(PathBuf),
}

/// Writes one file after the other.
pub struct Recorder {
    naming: Naming,
    limits: Limits,
    open: Option<Open>,
    /// Bytes of the files that were ended.
    ended: u64,
    has_failed: bool,
}

struct Open {
    writer: Writer<File>,
    file: File,
    path: PathBuf,
    began: Instant,
}

impl Recorder {
    /// Nothing is created before there is something to write.
    #[must_use]
    pub const fn new(naming: Naming, limits: Limits) -> Self {
        Self { naming, limits, open: None, ended: 0, has_failed: false }
    }

    /// Begins a file even if nothing follows.
    pub fn begin(&mut self) -> io::Result<()> {
        self.with_open(|_| Ok(()))
    }

    /// Writes a message, as [`Writer::put`] does. After an error the file ends with its last chunk; where files are named
    /// by date, the next message begins another.
    pub fn put(&mut self, robot: &Robot, channel: Channel, time: u64, json: &[u8]) -> io::Result<()> {
        let is_full = self.open.as_ref().is_some_and(|open| {
            self.limits.size.is_some_and(|size| open.writer.length() >= size)
                || self.limits.time.is_some_and(|time| open.began.elapsed() >= time)
        });
        if is_full {
            self.finish()?;
            self.put_aside()?;
        }
        self.with_open(|writer| writer.put(robot, channel, time, json))
    }

    /// Ends a chunk that has waited for long enough.
    pub fn flush_if_due(&mut self) -> io::Result<()> {
        if self.open.is_some() { self.with_open(Writer::flush_if_due) } else { Ok(()) }
    }

    /// Ends the chunk: what was put is in the file.
    pub fn flush(&mut self) -> io::Result<()> {
        if self.open.is_some() { self.with_open(Writer::flush) } else { Ok(()) }
    }

    /// Ends the file.
    pub fn finish(&mut self) -> io::Result<()> {
        // What waits, first: behind that, only the index can fail.
        self.flush()?;
        let Some(Open { writer, file, .. }) = self.open.take() else { return Ok(()) };
        let sound = writer.sound();
        let result = writer.finish();
        if result.is_err() {
            let _ = file.set_len(sound);
        }
        self.ended += *result.as_ref().unwrap_or(&sound);
        result.map(drop)
    }

    /// The file that is being written.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        self.open.as_ref().map(|open| open.path.as_path())
    }

    /// Bytes in all files.
    #[must_use]
    pub fn written(&self) -> u64 {
        self.ended + self.open.as_ref().map_or(0, |open| open.writer.written())
    }

    fn with_open(&mut self, write: impl FnOnce(&mut Writer<File>) -> io::Result<()>) -> io::Result<()> {
        let mut open = match self.open.take() {
            Some(open) => open,
            // Another file would take the name of one that is there.
            None if self.has_failed && matches!(self.naming, Naming::Numbered(_)) => {
                return Err(io::Error::other("an earlier write failed"));
            }
            None => Open::create(&self.naming)?,
        };
        let result = write(&mut open.writer);
        if result.is_err() {
            // A chunk that is there in part would hide from readers that the ones before it are whole.
            let _ = open.file.set_len(open.writer.sound());
            self.ended += open.writer.sound();
            self.has_failed = true;
        } else {
            self.open = Some(open);
        }
        result
    }

    /// Renames a file that was ended, where files are numbered.
    fn put_aside(&self) -> io::Result<()> {
        let Naming::Numbered(path) = &self.naming else { return Ok(()) };
        let free = (1..=u32::MAX).map(|number| numbered(path, number)).find(|name| fs::symlink_metadata(name).is_err());
        free.map_or(Ok(()), |free| fs::rename(path, free))
    }
}

impl Open {
    fn create(naming: &Naming) -> io::Result<Self> {
        let (file, path) = match naming {
            Naming::Numbered(path) => (File::create(path)?, path.clone()),
            Naming::Dated(directory) => {
                fs::create_dir_all(directory)?;
                create_dated(directory)?
            }
        };
        let writer = file.try_clone().and_then(Writer::new);
        let writer = writer.inspect_err(|_| drop(fs::remove_file(&path)))?;
        Ok(Self { writer, file, path, began: Instant::now() })
    }
}

/// `x.mcap` with a number: `x.1.mcap`.
fn numbered(path: &Path, number: u32) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!(".{number}"));
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

/// Creates a file that is named by the date, which may have been there before where clocks are set back.
fn create_dated(directory: &Path) -> io::Result<(File, PathBuf)> {
    let date = Utc::now().format("%Y%m%dT%H%M%S%.3fZ");
    let mut number = 0_u32;
    loop {
        let again = if number == 0 { String::new() } else { format!("-{number}") };
        let path = directory.join(format!("deltarobot-{date}{again}.mcap"));
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
            result => return result.map(|file| (file, path)),
        }
    }
}
