//! Recordings: text, a line for each run of bytes.
//!
//! ```text
//! # deltarobot recording 1
//! # started 2026-11-28T20:41:15.123456Z
//! 0.012345 > 24 53 00 B1 3A
//! 0.013702 < 24 73 10 ...
//! ```
//!
//! Seconds since the recording began; `>` for what the host sent and `<` for what came from the controller; the bytes
//! in hexadecimal digits. Lines that begin with `#` and empty ones are comments, but the first line has to be that.
//! Some comments have a meaning: when the recording was started, and in which gaps nothing ends (see [`Parser`]).

use std::fmt;
use std::io::{self, Write};
use std::time::Duration;

use chrono::{DateTime, SecondsFormat, Utc};

use crate::hex::{append_hex, hex};

/// The first line.
pub const HEADER: &str = "# deltarobot recording 1";
/// What some editors put before it.
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";
/// A line that is longer is none of a recording: `record` writes a tenth of it at most.
const LINE_MAX: usize = 1 << 20;

/// Who sent something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Side {
    /// The program.
    Host,
    /// The robot.
    Controller,
}

impl Side {
    /// As in recordings.
    pub const fn arrow(self) -> char {
        match self {
            Self::Host => '>',
            Self::Controller => '<',
        }
    }

    /// In a word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Host => "host",
            Self::Controller => "controller",
        }
    }
}

/// Bytes that passed at a time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Since the recording began.
    pub time: Duration,
    /// Who sent them.
    pub from: Side,
    /// What was sent.
    pub bytes: Vec<u8>,
}

impl Entry {
    /// Writes its line.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{:.6} {} {}", self.time.as_secs_f64(), self.from.arrow(), hex(&self.bytes))
    }
}

/// What a time in a recording was by the clock on the wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start {
    /// Since the recording began.
    pub time: Duration,
    /// Its date and time.
    pub utc: DateTime<Utc>,
}

impl Start {
    /// Such a moment's date and time.
    pub fn at(&self, time: Duration) -> DateTime<Utc> {
        self.utc + time.saturating_sub(self.time) - self.time.saturating_sub(time)
    }

    fn parse(comment: &str) -> Option<Self> {
        let mut words = comment.split_ascii_whitespace().skip_while(|word| *word == "#");
        let kind = words.next().filter(|word| matches!(*word, "started" | "continued"))?;
        let utc = DateTime::parse_from_rfc3339(words.next()?).ok()?.into();
        let time = if kind == "continued" { seconds(words.nth(1)?)? } else { Duration::ZERO };
        Some(Self { time, utc })
    }
}

impl fmt::Display for Start {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let utc = self.utc.to_rfc3339_opts(SecondsFormat::Micros, true);
        if self.time.is_zero() {
            write!(f, "# started {utc}")
        } else {
            write!(f, "# continued {utc} at {:.6}", self.time.as_secs_f64())
        }
    }
}

/// Whether a file that begins with these bytes is a recording; `None` when more of them are needed.
pub fn is_recording(bytes: &[u8]) -> Option<bool> {
    let begins = |bytes: &[u8], with: &[u8]| {
        let length = bytes.len().min(with.len());
        (bytes.get(..length) == with.get(..length)).then_some(length == with.len())
    };
    match begins(bytes, BYTE_ORDER_MARK) {
        Some(true) => begins(bytes.get(BYTE_ORDER_MARK.len()..).unwrap_or_default(), HEADER.as_bytes()),
        Some(false) if !bytes.is_empty() => return None,
        _ => begins(bytes, HEADER.as_bytes()),
    }
    .map_or(Some(false), |is_whole| is_whole.then_some(true))
}

/// Reads a recording as its bytes come, of which it keeps no more than a line.
///
/// A computer that crashes, or a disk that is full, leaves a line that is cut off, and sometimes zero bytes behind it:
/// that is passed over, also where the recording was continued afterwards. Every other line that can't be read is an
/// error.
#[derive(Debug)]
pub struct Parser {
    /// What has come of a line.
    partial: Vec<u8>,
    number: usize,
    entry: Entry,
    start: Option<Start>,
    gap: Option<Duration>,
    /// What is the matter with the last line, unless a comment follows.
    doubtful: Option<String>,
    /// The first line that was passed over, and how many there were.
    damaged: Option<(usize, usize)>,
}

impl Parser {
    /// At the beginning of a recording.
    pub const fn new() -> Self {
        Self {
            partial: Vec::new(),
            number: 0,
            entry: Entry { time: Duration::ZERO, from: Side::Host, bytes: Vec::new() },
            start: None,
            gap: None,
            doubtful: None,
            damaged: None,
        }
    }

    /// When it was started, as far as it was read.
    pub const fn start(&self) -> Option<Start> {
        self.start
    }

    /// The gap of the port that it was recorded from.
    pub const fn gap(&self) -> Option<Duration> {
        self.gap
    }

    /// The time of the last entry.
    pub const fn last(&self) -> Duration {
        self.entry.time
    }

    /// Finds the first entry in `bytes`, or behind the partial line that came before them, and takes what was read off
    /// them. The error names the line.
    pub fn next(&mut self, bytes: &mut &[u8]) -> Result<Option<&Entry>, String> {
        while let Some(end) = bytes.iter().position(|byte| *byte == b'\n') {
            let (line, rest) = bytes.split_at(end + 1);
            *bytes = rest;
            let is_entry = if self.partial.is_empty() {
                self.line(line)
            } else {
                self.partial.extend_from_slice(line);
                let line = std::mem::take(&mut self.partial);
                self.line(&line)
            }?;
            if is_entry {
                return Ok(Some(&self.entry));
            }
        }
        self.partial.extend_from_slice(bytes);
        *bytes = &[];
        if self.partial.len() > LINE_MAX {
            return Err(format!("line {} is too long", self.number + 1));
        }
        Ok(None)
    }

    /// Nothing follows: an entry that has no end of a line may be the last.
    pub fn end(&mut self) -> Result<Option<&Entry>, String> {
        let line = std::mem::take(&mut self.partial);
        let is_entry = !line.is_empty() && self.line(&line)?;
        match self.doubtful.take() {
            Some(_) if !line.is_empty() => self.pass_over(),
            Some(error) => return Err(error),
            None => (),
        }
        Ok(is_entry.then_some(&self.entry))
    }

    /// What was passed over, in words.
    pub fn damage(&self) -> Option<String> {
        self.damaged.map(|(line, count)| match count {
            1 => format!("line {line} is damaged and was left out"),
            _ => format!("{count} lines, the first of them line {line}, are damaged and were left out"),
        })
    }

    fn pass_over(&mut self) {
        let (first, count) = self.damaged.unwrap_or((self.number, 0));
        self.damaged = Some((first, count + 1));
    }

    /// Reads a line; returns whether it is an entry.
    fn line(&mut self, line: &[u8]) -> Result<bool, String> {
        self.number += 1;
        let has_zeros = line.contains(&0);
        let is_bare = |byte: &u8| *byte == 0 || byte.is_ascii_whitespace();
        let begin = line.iter().position(|byte| !is_bare(byte)).unwrap_or(line.len());
        let end = line.iter().rposition(|byte| !is_bare(byte)).map_or(begin, |last| last + 1);
        let text = line.get(begin..end).unwrap_or_default();
        if self.number == 1 {
            let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
            return if text.starts_with(HEADER.as_bytes()) {
                Ok(false)
            } else {
                Err(format!("not a recording: it does not begin with `{HEADER}`"))
            };
        }
        if let [b'#', ..] = text {
            self.comment(&String::from_utf8_lossy(text));
            return Ok(false);
        }
        if let Some(error) = self.doubtful.take() {
            return Err(error);
        }
        match self.read_entry(text) {
            Ok(is_entry) => {
                if has_zeros {
                    self.pass_over();
                }
                return Ok(is_entry);
            }
            Err(_) if has_zeros => self.pass_over(),
            Err(error) => self.doubtful = Some(format!("line {}: {error}", self.number)),
        }
        Ok(false)
    }

    fn comment(&mut self, text: &str) {
        if self.doubtful.take().is_some() {
            self.number -= 1;
            self.pass_over();
            self.number += 1;
        }
        if let Some(start) = Start::parse(text) {
            self.start = Some(start);
        } else if let Some(gap) = text.strip_prefix("# gap ").and_then(seconds) {
            self.gap = Some(gap);
        }
    }

    fn read_entry(&mut self, text: &[u8]) -> Result<bool, String> {
        if text.is_empty() {
            return Ok(false);
        }
        let mut parts = text.splitn(3, |byte| *byte == b' ');
        let (Some(time), Some(arrow), Some(bytes)) = (parts.next(), parts.next(), parts.next()) else {
            return Err("not of the form `SECONDS > BYTES`".into());
        };
        let from = match arrow {
            b">" => Side::Host,
            b"<" => Side::Controller,
            _ => return Err(format!("`{}` is neither > nor <", String::from_utf8_lossy(arrow))),
        };
        let time = std::str::from_utf8(time).ok().and_then(seconds).ok_or("that is no time")?;
        self.entry.bytes.clear();
        append_hex(&String::from_utf8_lossy(bytes), &mut self.entry.bytes)?;
        (self.entry.time, self.entry.from) = (time, from);
        Ok(true)
    }
}

fn seconds(text: &str) -> Option<Duration> {
    text.parse().ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
}

#[cfg(test)]
mod tests {
    use super::{Duration, Entry, HEADER, Parser, Side, is_recording};

    /// All entries, and what was said about damage; or the error.
    fn read(text: &[u8], piece: usize) -> Result<(Vec<Entry>, Option<String>), String> {
        let (mut parser, mut entries) = (Parser::new(), Vec::new());
        for mut bytes in text.chunks(piece) {
            while let Some(entry) = parser.next(&mut bytes)? {
                entries.push(entry.clone());
            }
        }
        entries.extend(parser.end()?.cloned());
        Ok((entries, parser.damage()))
    }

    fn entries() -> Vec<Entry> {
        vec![
            Entry { time: Duration::from_micros(12_345), from: Side::Host, bytes: b"$S\0\xB1:".to_vec() },
            Entry { time: Duration::from_micros(3_600_000_001), from: Side::Controller, bytes: vec![0xFF] },
        ]
    }

    #[test]
    fn what_was_written_is_read() {
        let mut text = format!("{HEADER}\n# a comment\n\n").into_bytes();
        for entry in entries() {
            entry.write(&mut text).unwrap();
        }
        let windows = String::from_utf8(text.clone()).unwrap().replace('\n', "\r\n");
        for text in [text.as_slice(), windows.as_bytes(), &[b"\xEF\xBB\xBF", text.as_slice()].concat()] {
            for piece in [1, 7, 1000] {
                assert_eq!(read(text, piece).unwrap(), (entries(), None));
            }
            assert_eq!(is_recording(text), Some(true));
            assert_eq!(is_recording(&text[..20]), None);
        }
        assert_eq!((is_recording(b"$S"), is_recording(b""), is_recording(b"# x")), (Some(false), None, Some(false)));
    }

    #[test]
    fn what_a_crash_leaves_is_passed_over() {
        let whole = format!("{HEADER}\n0.012345 > 24 53 00 B1 3A\n3600.000001 < FF\n");
        for (end, line) in [("1.0 > 24 5", 4), ("1.", 4), ("\0\0\0\0", 4), ("1.0 > 2\0\0", 4), ("\0\0\n", 4)] {
            let (read, damage) = read((whole.clone() + end).as_bytes(), 1000).unwrap();
            assert_eq!((read, damage.unwrap()), (entries(), format!("line {line} is damaged and was left out")));
        }
        let continued = format!("{HEADER}\n0.012345 > 24 53 00 B1 3A\n1.0 > 2\n# continued\n3600.000001 < FF\n");
        assert_eq!(
            read(continued.as_bytes(), 3).unwrap(),
            (entries(), Some("line 3 is damaged and was left out".into()))
        );
    }

    #[test]
    fn what_is_wrong_is_named() {
        assert!(read(b"$S\n", 9).unwrap_err().starts_with("not a recording"));
        for (line, error) in [
            ("0.1 >", "line 2: not of the form `SECONDS > BYTES`"),
            ("0.1 ? 24", "line 2: `?` is neither > nor <"),
            ("-1 > 24", "line 2: that is no time"),
            ("nan > 24", "line 2: that is no time"),
            ("1 > 2x", "line 2: `2x` is not hexadecimal"),
        ] {
            assert_eq!(read(format!("{HEADER}\n{line}\n").as_bytes(), 1000).unwrap_err(), error);
        }
    }
}
