//! Recordings: text, a line for each run of bytes.
//!
//! ```text
//! # deltarobot recording 1
//! 0.012345 > 24 53 00 B1 3A
//! 0.013702 < 24 73 10 ...
//! ```
//!
//! Seconds since the recording began; `>` for what the host sent and `<` for what came from the controller; the bytes
//! in hexadecimal digits. Lines that begin with `#` and empty ones say nothing, but the first line has to be that.

use std::io::{self, Write};
use std::time::Duration;

use crate::hex::{from_hex, hex};

/// The first line.
pub(crate) const HEADER: &str = "# deltarobot recording 1";

/// Who sent something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Side {
    Host,
    Controller,
}

impl Side {
    pub(crate) const fn arrow(self) -> char {
        match self {
            Self::Host => '>',
            Self::Controller => '<',
        }
    }

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Host => "host",
            Self::Controller => "controller",
        }
    }
}

/// Bytes that passed at a time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Entry {
    pub(crate) time: Duration,
    pub(crate) from: Side,
    pub(crate) bytes: Vec<u8>,
}

impl Entry {
    pub(crate) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{:.6} {} {}", self.time.as_secs_f64(), self.from.arrow(), hex(&self.bytes))
    }
}

/// Whether a file is a recording.
pub(crate) fn is_recording(text: &[u8]) -> bool {
    text.starts_with(HEADER.as_bytes())
}

/// Reads a recording; the error names the line.
pub(crate) fn read(text: &[u8]) -> Result<Vec<Entry>, String> {
    if !is_recording(text) {
        return Err(format!("not a recording: it does not begin with `{HEADER}`"));
    }
    let text = String::from_utf8_lossy(text);
    let said = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    said.map(|(number, line)| entry(line).map_err(|error| format!("line {}: {error}", number + 1))).collect()
}

fn entry(line: &str) -> Result<Entry, String> {
    let mut parts = line.splitn(3, ' ');
    let (Some(time), Some(arrow), Some(bytes)) = (parts.next(), parts.next(), parts.next()) else {
        return Err("not of the form `SECONDS > BYTES`".into());
    };
    let time = time.parse().ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    let from = match arrow {
        ">" => Side::Host,
        "<" => Side::Controller,
        _ => return Err(format!("`{arrow}` is neither > nor <")),
    };
    Ok(Entry { time: time.ok_or("that is no time")?, from, bytes: from_hex(bytes)? })
}

#[cfg(test)]
mod tests {
    use super::{Duration, Entry, HEADER, Side, read};

    #[test]
    fn what_was_written_is_read() {
        let entries = [
            Entry { time: Duration::from_micros(12_345), from: Side::Host, bytes: b"$S\0\xB1:".to_vec() },
            Entry { time: Duration::from_micros(3_600_000_001), from: Side::Controller, bytes: vec![0xFF] },
        ];
        let mut text = format!("{HEADER}\n# a comment\n\n").into_bytes();
        for entry in &entries {
            entry.write(&mut text).unwrap();
        }
        assert_eq!(read(&text).unwrap(), entries);
    }

    #[test]
    fn what_is_wrong_is_named() {
        assert!(read(b"$S").unwrap_err().starts_with("not a recording"));
        for (line, error) in [
            ("0.1 >", "line 2: not of the form `SECONDS > BYTES`"),
            ("0.1 ? 24", "line 2: `?` is neither > nor <"),
            ("-1 > 24", "line 2: that is no time"),
            ("nan > 24", "line 2: that is no time"),
            ("1 > 2x", "line 2: `2x` is not hexadecimal"),
        ] {
            assert_eq!(read(format!("{HEADER}\n{line}\n").as_bytes()).unwrap_err(), error);
        }
    }
}
