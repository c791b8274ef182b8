//! `deltarobot monitor`: what passes on a line, in words.

use std::fs::{self, File};
use std::io::{self, Read};
use std::os::unix::fs::FileTypeExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use serde_json::{Value, json};

use crate::decoder::{Decoder, Piece, QUIET_MS, Statistics, checksum_failures};
use crate::port::{Device, Speed};
use crate::recording::{self, Side};
use crate::screen::Screen;
use crate::signals::Signals;
use crate::status::{Failure, Status};
use crate::wire::hex;
use crate::words;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Each line has the time in seconds since the beginning, the direction (> from the host, < from the \
    controller, where a recording or the opcode tells it) and the frame. Statistics follow at the end or on Ctrl-C."
)]
pub(crate) struct Arguments {
    /// A device, a recording, a file of raw bytes, or `-` for standard input
    #[arg(value_name = "PORT|FILE|-")]
    source: PathBuf,
    /// One JSON object a line, the statistics last
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    speed: Speed,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let signals = Signals::catch()?;
    let mut monitor = Monitor::new(arguments.json);
    let result = monitor.watch(arguments, &signals);
    // A device that has gone was still worth being counted.
    if !matches!(result, Err(Failure::Output(_) | Failure::Usage(_))) && monitor.has_begun {
        monitor.tell_statistics()?;
    }
    result.map(|()| Status::Finished)
}

struct Monitor {
    screen: Screen,
    json: bool,
    has_begun: bool,
    statistics: Statistics,
    /// When anything came last.
    last: Duration,
    host: Decoder,
    controller: Decoder,
    unknown: Decoder,
}

impl Monitor {
    fn new(json: bool) -> Self {
        Self {
            screen: Screen::new(),
            json,
            has_begun: false,
            statistics: Statistics::default(),
            last: Duration::ZERO,
            host: Decoder::new(),
            controller: Decoder::new(),
            unknown: Decoder::new(),
        }
    }

    fn watch(&mut self, arguments: &Arguments, signals: &Signals) -> Result<(), Failure> {
        let path = arguments.source.as_path();
        if path.as_os_str() == "-" {
            return self.watch_stream(Path::new("standard input"), &mut io::stdin().lock(), signals);
        }
        let failure = |error: &io::Error| Failure::of_file(path.display(), error);
        let kind = fs::metadata(path).map_err(|error| failure(&error))?.file_type();
        if kind.is_char_device() {
            return self.watch_device(arguments, signals);
        }
        if kind.is_dir() {
            return Err(Failure::of(path.display(), "a directory"));
        }
        let mut file = File::open(path).map_err(|error| failure(&error))?;
        if !kind.is_file() {
            return self.watch_stream(path, &mut file, signals);
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(|error| failure(&error))?;
        self.has_begun = true;
        if recording::is_recording(&bytes) {
            return self.watch_recording(path, &bytes, signals);
        }
        self.take(None, &bytes, Duration::ZERO)?;
        self.idle(Duration::ZERO)
    }

    fn watch_device(&mut self, arguments: &Arguments, signals: &Signals) -> Result<(), Failure> {
        let mut device = Device::open(&arguments.source, arguments.speed)?;
        self.has_begun = true;
        let began = Instant::now();
        let result = loop {
            if signals.came() {
                break Ok(());
            }
            match device.read(QUIET_MS) {
                Ok([]) => self.idle(began.elapsed())?,
                Ok(bytes) => self.take(None, bytes, began.elapsed())?,
                Err(failure) => break Err(failure),
            }
        };
        self.idle(began.elapsed())?;
        result
    }

    fn watch_stream(
        &mut self,
        name: &Path,
        stream: &mut (impl Read + std::os::fd::AsFd),
        signals: &Signals,
    ) -> Result<(), Failure> {
        self.has_begun = true;
        let began = Instant::now();
        let mut room = [0; 4096];
        let mut start = Vec::new();
        while !signals.came() {
            if !is_readable(stream)? {
                self.idle(began.elapsed())?;
                continue;
            }
            let count = stream.read(&mut room).map_err(|error| Failure::of_file(name.display(), &error))?;
            let bytes = room.get(..count).unwrap_or_default();
            if !start.is_empty() || recording::is_recording(bytes) {
                // The beginning of a recording: the rest is waited for.
                start.extend_from_slice(bytes);
                if count == 0 {
                    return self.watch_recording(name, &start, signals);
                }
                continue;
            }
            if count == 0 {
                break;
            }
            self.take(None, bytes, began.elapsed())?;
        }
        self.idle(began.elapsed())
    }

    fn watch_recording(&mut self, name: &Path, text: &[u8], signals: &Signals) -> Result<(), Failure> {
        let entries = recording::read(text).map_err(|error| Failure::of(name.display(), error))?;
        for entry in &entries {
            if signals.came() {
                break;
            }
            self.take(Some(entry.from), &entry.bytes, entry.time)?;
        }
        self.idle(self.last)
    }

    fn take(&mut self, from: Option<Side>, bytes: &[u8], time: Duration) -> Result<(), Failure> {
        if time.saturating_sub(self.last) >= Duration::from_millis(QUIET_MS.into()) {
            self.idle(self.last)?;
        }
        self.last = time;
        let pieces = self.decoder(from).feed(bytes);
        self.tell(from, &pieces, time)
    }

    fn idle(&mut self, time: Duration) -> Result<(), Failure> {
        for from in [None, Some(Side::Host), Some(Side::Controller)] {
            let pieces = self.decoder(from).idle();
            self.tell(from, &pieces, time)?;
        }
        Ok(())
    }

    fn decoder(&mut self, from: Option<Side>) -> &mut Decoder {
        match from {
            None => &mut self.unknown,
            Some(Side::Host) => &mut self.host,
            Some(Side::Controller) => &mut self.controller,
        }
    }

    fn tell(&mut self, from: Option<Side>, pieces: &[Piece], time: Duration) -> Result<(), Failure> {
        for piece in pieces {
            self.statistics.count(piece);
            let from = from.or_else(|| sender(piece));
            let line = if self.json {
                let context = json!({ "time": seconds(time), "from": from.map(Side::name) });
                piece_json(piece, context).to_string()
            } else {
                format!("{:10.3} {} {}", time.as_secs_f64(), from.map_or(' ', Side::arrow), piece_text(piece))
            };
            self.screen.line(&line)?;
        }
        Ok(())
    }

    fn tell_statistics(&mut self) -> Result<(), Failure> {
        let it = &self.statistics;
        let line = if self.json {
            json!({ "statistics": {
                "seconds": seconds(self.last), "bytes": it.bytes, "frames": it.frames(), "frames_by_opcode": it.frames,
                "garbage_bytes": it.garbage_bytes, "checksum_failures": it.checksum_failures,
            } })
            .to_string()
        } else {
            let kinds: Vec<_> = it.frames.iter().map(|(name, count)| format!("{count} {name}")).collect();
            let kinds = if kinds.is_empty() { String::new() } else { format!(" ({})", kinds.join(", ")) };
            format!(
                "{} bytes in {:.3} s: {} frames{kinds}, {} bytes of garbage, {} wrong checksums",
                it.bytes,
                self.last.as_secs_f64(),
                it.frames(),
                it.garbage_bytes,
                it.checksum_failures
            )
        };
        Ok(self.screen.line(&line)?)
    }
}

/// Who must have sent it: most opcodes go one way only.
fn sender(piece: &Piece) -> Option<Side> {
    match piece {
        Piece::Frame { opcode, .. } => match opcode.0 {
            b'H' | b'S' | b'M' | b'C' => Some(Side::Host),
            b'h' | b's' | b'm' | b'e' => Some(Side::Controller),
            _ => None,
        },
        Piece::Garbage { .. } => None,
    }
}

/// A frame in words, or garbage as hexadecimal digits.
pub(crate) fn piece_text(piece: &Piece) -> String {
    match piece {
        Piece::Frame { opcode, payload, .. } => words::text(*opcode, payload),
        Piece::Garbage { bytes } => {
            let failures = checksum_failures(bytes);
            let failures: Vec<_> =
                failures.iter().map(|(is, should)| format!(" (checksum {is:02X} instead of {should:02X})")).collect();
            format!("garbage: {}{}", hex(bytes), failures.concat())
        }
    }
}

/// The same, added to an object.
pub(crate) fn piece_json(piece: &Piece, mut object: Value) -> Value {
    let said = match piece {
        Piece::Frame { opcode, payload, bytes } => {
            let mut said = words::json(*opcode, payload);
            if let Some(said) = said.as_object_mut() {
                said.insert("bytes".into(), hex(bytes).into());
            }
            said
        }
        Piece::Garbage { bytes } => {
            json!({ "garbage": hex(bytes), "checksum_failures": checksum_failures(bytes).len() })
        }
    };
    if let (Some(object), Value::Object(said)) = (object.as_object_mut(), said) {
        object.extend(said);
    }
    object
}

/// In microseconds' precision.
fn seconds(time: Duration) -> Value {
    format!("{:.6}", time.as_secs_f64()).parse::<f64>().map_or(Value::Null, Value::from)
}

/// Waits for input as long as a line may be quiet. Not when a signal came.
fn is_readable(stream: &impl std::os::fd::AsFd) -> Result<bool, Failure> {
    let time = Timespec { tv_sec: 0, tv_nsec: i64::from(QUIET_MS) * 1_000_000 };
    let mut polled = [PollFd::new(stream, PollFlags::IN)];
    match poll(&mut polled, Some(&time)) {
        Ok(count) => Ok(count > 0),
        Err(Errno::INTR) => Ok(false),
        Err(error) => Err(Failure::of_file("input", &error.into())),
    }
}
