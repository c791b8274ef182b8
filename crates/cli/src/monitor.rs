//! `deltarobot monitor`: what passes on a line, in words.

use std::fs::{self, File};
use std::io::{self, Read};
use std::os::fd::AsFd;
use std::os::unix::fs::FileTypeExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde_json::json;

use crate::decoder::{Decoder, Lanes, Piece, QUIET_MS, SENDERS, Statistics, seconds};
use crate::port::{Device, Speed};
use crate::protocol::Spoken;
use crate::recording::{self, Side};
use crate::screen::Screen;
use crate::signals::Signals;
use crate::status::{Failure, Status};
use crate::wait::wait;

/// Bytes that are taken at a time: between two of these it is looked whether the user wants to end.
const CHUNK: usize = 4096;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Each line has the time in seconds since the beginning, the direction (> from the host, < from the \
    controller, where a recording or the message tells it) and the message. Statistics follow at the end or on Ctrl-C."
)]
pub(crate) struct Arguments {
    /// A device, a recording, a file of raw bytes, or `-` for standard input
    #[arg(value_name = "PORT|FILE|-")]
    source: PathBuf,
    /// One JSON object a line, the statistics last
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    spoken: Spoken,
    /// Who sends, where neither the source nor the message tells
    #[arg(long, value_enum, value_name = "SIDE")]
    from: Option<Side>,
    #[command(flatten)]
    speed: Speed,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let signals = Signals::catch()?;
    Monitor::new(arguments).watch(arguments, &signals)?;
    Ok(Status::Finished)
}

struct Monitor {
    screen: Screen,
    json: bool,
    statistics: Statistics,
    /// When anything came last, from anybody and from each.
    last: Duration,
    heard: Lanes<Duration>,
    decoder: Box<dyn Decoder>,
    /// Who sends what comes, if the user knows.
    from: Option<Side>,
}

impl Monitor {
    fn new(arguments: &Arguments) -> Self {
        let protocol = arguments.spoken.protocol;
        Self {
            screen: Screen::new(),
            json: arguments.json,
            statistics: Statistics::new(protocol.terms()),
            last: Duration::ZERO,
            heard: Lanes::default(),
            decoder: protocol.decoder(),
            from: arguments.from,
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
        if recording::is_recording(&bytes) {
            return self.watch_recording(path, &bytes, signals);
        }
        for bytes in bytes.chunks(CHUNK) {
            if signals.came() {
                break;
            }
            self.take(None, bytes, Duration::ZERO)?;
        }
        self.end()
    }

    fn watch_device(&mut self, arguments: &Arguments, signals: &Signals) -> Result<(), Failure> {
        let mut device = Device::open(&arguments.source, arguments.speed)?;
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
        // A device that has gone was still worth being watched.
        self.end()?;
        result
    }

    fn watch_stream(&mut self, name: &Path, stream: &mut (impl Read + AsFd), signals: &Signals) -> Result<(), Failure> {
        let began = Instant::now();
        let mut room = [0; CHUNK];
        let (mut is_first, mut recording) = (true, Vec::new());
        while !signals.came() {
            if wait(stream, QUIET_MS).map_err(|error| Failure::of_file(name.display(), &error.into()))?.is_empty() {
                self.idle(began.elapsed())?;
                continue;
            }
            let count = stream.read(&mut room).map_err(|error| Failure::of_file(name.display(), &error))?;
            let bytes = room.get(..count).unwrap_or_default();
            let is_recording = !recording.is_empty() || is_first && recording::is_recording(bytes);
            is_first = false;
            match count {
                0 if is_recording => return self.watch_recording(name, &recording, signals),
                0 => break,
                // The rest of it is waited for.
                _ if is_recording => recording.extend_from_slice(bytes),
                _ => self.take(None, bytes, began.elapsed())?,
            }
        }
        self.end()
    }

    fn watch_recording(&mut self, name: &Path, text: &[u8], signals: &Signals) -> Result<(), Failure> {
        let entries = recording::read(text).map_err(|error| Failure::of(name.display(), error))?;
        for entry in &entries {
            if signals.came() {
                break;
            }
            self.take(Some(entry.from), &entry.bytes, entry.time)?;
        }
        self.end()
    }

    fn take(&mut self, from: Option<Side>, bytes: &[u8], time: Duration) -> Result<(), Failure> {
        self.idle(time)?;
        let from = from.or(self.from);
        *self.heard.of(from) = time;
        self.last = time;
        self.statistics.count_bytes(bytes);
        let pieces = self.decoder.feed(from, bytes);
        self.tell(&pieces, time)
    }

    /// It is now. What ends by silence has the time of its last byte.
    fn idle(&mut self, now: Duration) -> Result<(), Failure> {
        for from in SENDERS {
            let heard = *self.heard.of(from);
            let pieces = self.decoder.idle(from, now.saturating_sub(heard));
            self.tell(&pieces, heard)?;
        }
        Ok(())
    }

    /// Nothing follows.
    fn end(&mut self) -> Result<(), Failure> {
        for from in SENDERS {
            let pieces = self.decoder.end(from);
            let heard = *self.heard.of(from);
            self.tell(&pieces, heard)?;
        }
        let it = &self.statistics;
        Ok(if self.json { self.screen.json(&it.json(self.last)) } else { self.screen.line(&it.text(self.last)) }?)
    }

    fn tell(&mut self, pieces: &[Piece], time: Duration) -> Result<(), Failure> {
        for piece in pieces {
            self.statistics.count(piece);
            let from = piece.from;
            if self.json {
                let when = json!({ "time": seconds(time), "from": from.map(Side::name) });
                self.screen.json(&piece.add_to(when))?;
            } else {
                let arrow = from.map_or(' ', Side::arrow);
                self.screen.line(&format!("{:10.3} {arrow} {}", time.as_secs_f64(), piece.text))?;
            }
        }
        Ok(())
    }
}
