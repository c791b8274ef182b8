//! The file that a recording is written to.

mod mcap;

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use chrono::Utc;

use crate::port::positive_seconds;
use crate::protocol::Spoken;
use crate::recording::{Entry, HEADER, Parser, Side, Start};
use crate::screen::Screen;
use crate::source::CHUNK;
use crate::status::Failure;

#[derive(Debug, clap::Args)]
pub(super) struct FileOptions {
    /// The file to write; `-` is standard output
    file: PathBuf,
    /// Continues a recording that is there
    #[arg(long, conflicts_with = "force")]
    append: bool,
    /// Overwrites a file that is there
    #[arg(long)]
    force: bool,
    /// Begins another file when this one has so many bytes (`500k`, `10M`, `1G`), which is renamed to FILE.1, FILE.2 ...
    #[arg(long, value_name = "SIZE", value_parser = size)]
    rotate: Option<u64>,
    /// The same after so many seconds
    #[arg(long, value_name = "SECONDS", value_parser = positive_seconds)]
    rotate_after: Option<f64>,
    /// The format; by default MCAP for a FILE named *.mcap, whose older ones become x.1.mcap, x.2.mcap ..., else text
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// MCAP has the messages besides: those of this protocol
    #[command(flatten)]
    spoken: Spoken,
}

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// A line for each run of bytes
    Text,
    /// Bytes, messages and states, for Foxglove, ROS 2 and others; takes deltarobot-convert
    Mcap,
}

impl FileOptions {
    /// Whether the file may be written.
    pub(super) fn check(&self) -> Result<(), Failure> {
        if self.append && self.is_mcap() {
            return Err(Failure::Usage("--append: an MCAP file can't be continued; record another".into()));
        }
        let is_there = fs::metadata(&self.file).is_ok_and(|metadata| metadata.is_file());
        if self.is_output() || !is_there || self.append || self.force {
            return Ok(());
        }
        Err(Failure::of(self.file.display(), "File exists; --append continues it, --force overwrites it"))
    }

    fn is_output(&self) -> bool {
        self.file.as_os_str() == "-"
    }

    fn is_mcap(&self) -> bool {
        let named = self.file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap"));
        self.format.map_or(named, |format| format == Format::Mcap)
    }
}

/// Bytes, with the letters that people put behind.
pub fn size(text: &str) -> Result<u64, String> {
    let (digits, factor) = match text.char_indices().next_back() {
        Some((end, 'k' | 'K')) => (text.get(..end), 1 << 10),
        Some((end, 'm' | 'M')) => (text.get(..end), 1 << 20),
        Some((end, 'g' | 'G')) => (text.get(..end), 1 << 30),
        _ => (Some(text), 1),
    };
    let size = digits.and_then(|digits| digits.parse::<u64>().ok()).and_then(|size| size.checked_mul(factor));
    size.filter(|size| *size >= 1000).ok_or_else(|| "not a size of at least 1000 bytes, such as 10M".into())
}

/// Writes a recording.
pub(super) struct Recorder {
    name: PathBuf,
    /// `None` for standard output.
    file: Option<File>,
    /// What makes MCAP of what is written to that.
    converter: Option<mcap::Converter>,
    /// Its length, up to the last line that was written whole.
    length: u64,
    rotate: Option<u64>,
    rotate_after: Option<Duration>,
    /// When the file was begun.
    began: Instant,
    gap: Duration,
    /// Recorded time when this program began.
    offset: Duration,
    has_failed: bool,
}

impl Recorder {
    pub(super) fn create(options: &FileOptions, gap: Duration) -> Result<Self, Failure> {
        let name = options.file.clone();
        let mut recorder = Self {
            name,
            file: None,
            converter: None,
            length: 0,
            rotate: options.rotate,
            rotate_after: options.rotate_after.map(Duration::from_secs_f64),
            began: Instant::now(),
            gap,
            offset: Duration::ZERO,
            has_failed: false,
        };
        if options.is_mcap() {
            let (converter, pipe) = mcap::Converter::start(options)?;
            (recorder.converter, recorder.file) = (Some(converter), Some(pipe));
            // It does that.
            (recorder.rotate, recorder.rotate_after) = (None, None);
        } else if !options.is_output() {
            let mut open = OpenOptions::new();
            open.create(true).read(options.append).write(true).truncate(!options.append);
            let file = open.open(&recorder.name).map_err(|error| recorder.failure(&error))?;
            recorder.file = Some(file);
        }
        if options.append && recorder.file.is_some() && recorder.find_end()? {
            recorder.begin_part()?;
        } else {
            recorder.line(format!("{HEADER}\n").as_bytes())?;
            recorder.begin_part()?;
        }
        Ok(recorder)
    }

    /// Reads what is there, and continues its time. Returns whether there is anything.
    fn find_end(&mut self) -> Result<bool, Failure> {
        let Some(mut file) = self.file.take() else { return Ok(false) };
        let mut parser = Parser::new();
        let (mut room, mut last) = (vec![0; CHUNK], b'\n');
        loop {
            let count = file.read(&mut room).map_err(|error| self.failure(&error))?;
            let mut bytes = room.get(..count).unwrap_or_default();
            self.length += u64::try_from(count).unwrap_or_default();
            let Some(end) = bytes.last() else { break };
            last = *end;
            let failure = |error| Failure::of(self.name.display(), error);
            while parser.next(&mut bytes).map_err(failure)?.is_some() {}
        }
        if self.length > 0 {
            parser.end().map_err(|error| Failure::of(self.name.display(), error))?;
        }
        file.seek(SeekFrom::End(0)).map_err(|error| self.failure(&error))?;
        self.file = Some(file);
        if last != b'\n' {
            self.line(b"\n")?;
        }
        // Where the clock on the wall was set back, time stands still.
        let since = |start: Start| (Utc::now() - start.utc).to_std().unwrap_or_default() + start.time;
        self.offset = parser.start().map_or(parser.last(), since).max(parser.last());
        Ok(self.length > 0)
    }

    /// What a part of a recording begins with.
    fn begin_part(&mut self) -> Result<(), Failure> {
        let start = Start { time: self.offset, utc: Utc::now() };
        self.line(format!("{start}\n# gap {}\n", self.gap.as_secs_f64()).as_bytes())
    }

    pub(super) fn is_output(&self) -> bool {
        self.name.as_os_str() == "-"
    }

    /// Whether nobody reads what is written.
    pub(super) fn is_abandoned(&self) -> bool {
        self.is_output() && Screen::new().is_abandoned()
    }

    /// Whether nothing more can be written.
    pub(super) const fn has_failed(&self) -> bool {
        self.has_failed
    }

    /// Notes what passed at a time since this program began.
    pub(super) fn note(&mut self, time: Duration, from: Side, bytes: &[u8]) -> Result<(), Failure> {
        let time = self.offset + time;
        let is_full = self.rotate.is_some_and(|size| self.length >= size)
            || self.rotate_after.is_some_and(|time| self.began.elapsed() >= time);
        if is_full && self.file.is_some() {
            self.begin_file(time)?;
        }
        let mut line = Vec::new();
        Entry { time, from, bytes: bytes.to_vec() }.write(&mut line)?;
        self.line(&line)
    }

    /// Renames the file to the first name that is free, and begins another with its name.
    fn begin_file(&mut self, time: Duration) -> Result<(), Failure> {
        let numbered = |number: u32| {
            let mut name = self.name.clone().into_os_string();
            name.push(format!(".{number}"));
            PathBuf::from(name)
        };
        let free = (1..=u32::MAX).map(numbered).find(|name| fs::symlink_metadata(name).is_err());
        let renamed = free.map_or(Ok(()), |free| fs::rename(&self.name, free));
        let created = renamed.and_then(|()| File::create_new(&self.name));
        self.file = Some(created.map_err(|error| self.failed(&error))?);
        (self.length, self.began) = (0, Instant::now());
        let start = Start { time, utc: Utc::now() };
        self.line(format!("{HEADER}\n{start}\n# gap {}\n", self.gap.as_secs_f64()).as_bytes())
    }

    /// At once: what is recorded is there even if the program is killed.
    fn line(&mut self, line: &[u8]) -> Result<(), Failure> {
        match &mut self.file {
            Some(file) => {
                if let Err(error) = file.write_all(line) {
                    // A whole line or none.
                    let _ = file.set_len(self.length);
                    return Err(self.failed(&error));
                }
            }
            None => Screen::new().raw(line).inspect_err(|_| self.has_failed = true)?,
        }
        self.length += u64::try_from(line.len()).unwrap_or_default();
        Ok(())
    }

    /// Nothing follows.
    pub(super) fn finish(&mut self) -> Result<(), Failure> {
        let Some(converter) = self.converter.take() else { return Ok(()) };
        self.file = None;
        converter.end(&self.name)
    }

    fn failed(&mut self, error: &io::Error) -> Failure {
        self.has_failed = true;
        if error.kind() == io::ErrorKind::BrokenPipe
            && let Err(failure) = self.finish()
        {
            return failure;
        }
        self.failure(error)
    }

    fn failure(&self, error: &io::Error) -> Failure {
        Failure::of_file(Path::new(&self.name).display(), error)
    }
}
