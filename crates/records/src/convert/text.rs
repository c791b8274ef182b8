//! The format of `deltarobot record`.

use std::fs::File;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use deltarobot_cli::CHUNK;
use deltarobot_cli::recording::{Entry, HEADER, Parser, Start};
use deltarobot_cli::status::Failure;
use deltarobot_cli::system::Stream;
use deltarobot_cli::wait::wait;

use super::formats::{Content, NAMELESS, Record, Sink, failure};
use crate::writer::FLUSH_TIME;

/// By how much dates may differ from what times say.
const DRIFT: Duration = Duration::from_millis(1);

/// Reads a recording to its end. Returns what could not be read of it.
pub(super) fn read(
    input: File,
    name: &Path,
    robot: Option<&str>,
    sink: &mut dyn Sink,
) -> Result<Option<String>, Failure> {
    let robot = robot.unwrap_or(NAMELESS);
    let (mut parser, mut room) = (Parser::new(), vec![0; CHUNK]);
    let record = |entry: &Entry, parser: &Parser| Record {
        robot: robot.to_owned(),
        time: entry.time,
        date: parser.start().map(|start| start.at(entry.time)),
        gap: parser.gap(),
        content: Content::Bytes(entry.from, entry.bytes.clone()),
    };
    let wrong = |error: String| Failure::of(name.display(), error);
    let input = Stream::new(input).map_err(|error| failure(name, &error))?;
    loop {
        // It may be a pipe from what is recording now.
        if wait(input.as_fd(), FLUSH_TIME).map_err(|error| failure(name, &error.into()))?.is_empty() {
            sink.idle()?;
            continue;
        }
        let count = match input.read(&mut room) {
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            result => result.map_err(|error| failure(name, &error))?,
        };
        let mut bytes = room.get(..count).unwrap_or_default();
        if bytes.is_empty() {
            break;
        }
        while let Some(entry) = parser.next(&mut bytes).map_err(wrong)?.cloned() {
            sink.put(&record(&entry, &parser))?;
        }
    }
    if let Some(entry) = parser.end().map_err(wrong)?.cloned() {
        sink.put(&record(&entry, &parser))?;
    }
    Ok(parser.damage())
}

/// Writes one.
pub(super) struct Text {
    out: BufWriter<Box<dyn Write>>,
    name: PathBuf,
    /// Whose it is, once anything was written.
    robot: Option<String>,
    start: Option<Start>,
}

impl Text {
    pub(super) fn new(out: Box<dyn Write>, name: &Path) -> Self {
        Self { out: BufWriter::new(out), name: name.to_owned(), robot: None, start: None }
    }

    /// Writes when it was, and in which gaps, where the lines so far don't say it.
    fn head(&mut self, record: &Record) -> Result<(), Failure> {
        let is_first = self.robot.is_none();
        let lines = if is_first { format!("{HEADER}\n") } else { String::new() };
        let dated = record.date.filter(|date| {
            let drift = self.start.map(|start| (*date - start.at(record.time)).abs().to_std().unwrap_or_default());
            drift.is_none_or(|drift| drift > DRIFT)
        });
        let start = dated.map(|date| {
            let time = if is_first { Duration::ZERO } else { record.time };
            Start { time, utc: date - record.time.saturating_sub(time) }
        });
        self.start = start.or(self.start);
        let start = start.map(|start| format!("{start}\n")).unwrap_or_default();
        let gap = record.gap.filter(|_| is_first).map(|gap| format!("# gap {}\n", gap.as_secs_f64()));
        let lines = lines + &start + &gap.unwrap_or_default();
        self.out.write_all(lines.as_bytes()).map_err(|error| failure(&self.name, &error))
    }
}

impl Sink for Text {
    fn put(&mut self, record: &Record) -> Result<(), Failure> {
        // Events are no bytes.
        let Content::Bytes(from, bytes) = &record.content else { return Ok(()) };
        if let Some(robot) = self.robot.as_ref().filter(|robot| **robot != record.robot) {
            let text =
                format!("text takes one robot, and there are `{robot}` and `{}`; --robot picks one", record.robot);
            return Err(Failure::Usage(text));
        }
        self.head(record)?;
        self.robot.get_or_insert_with(|| record.robot.clone());
        let entry = Entry { time: record.time, from: *from, bytes: bytes.clone() };
        entry.write(&mut self.out).map_err(|error| failure(&self.name, &error))
    }

    fn idle(&mut self) -> Result<(), Failure> {
        self.out.flush().map_err(|error| failure(&self.name, &error))
    }

    fn finish(&mut self) -> Result<(), Failure> {
        if self.robot.is_none() {
            writeln!(self.out, "{HEADER}").map_err(|error| failure(&self.name, &error))?;
        }
        self.idle()
    }
}
