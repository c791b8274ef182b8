//! `deltarobot monitor`: what passes on a line, in words.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Duration;

use chrono::{DateTime, Local, SecondsFormat, Utc};
use rustix::event::PollFlags;
use serde_json::json;

use crate::clock::{Clock, SLICE};
use crate::decoder::{Decoder, Lanes, Piece, SENDERS, Statistics, seconds};
use crate::port::{Device, GAP_NETWORK, GAP_USB, Opening, PortOptions, is_url};
use crate::protocol::Spoken;
use crate::recording::{Side, Start};
use crate::screen::{Screen, complain};
use crate::signals::Signals;
use crate::source::{self, CHUNK, Progress, Source};
use crate::status::{Failure, Status};
use crate::system::{Stream, input, is_device};
use crate::wait::wait;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Each line has the time in seconds since the beginning, the direction (> from the host, < from the \
    controller, where a recording or the message says it) and the message. Statistics follow at the end or on Ctrl-C."
)]
pub(crate) struct Arguments {
    /// A device (or `tcp://HOST:PORT`, `rfc2217://HOST:PORT`), a recording, a file of raw bytes, or `-` for standard input
    #[arg(value_name = "PORT|FILE|-")]
    source: PathBuf,
    /// One JSON object a line, the statistics last
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    spoken: Spoken,
    /// Who sends, where neither the source nor the message says
    #[arg(long, value_enum, value_name = "SIDE")]
    from: Option<Side>,
    /// Which times are shown: seconds since the beginning, or date and time
    #[arg(long, value_enum, value_name = "KIND", default_value_t = Times::Relative)]
    time: Times,
    /// Waits for a device that is not there yet, and for one that has disappeared
    #[arg(long)]
    reconnect: bool,
    #[command(flatten)]
    port: PortOptions,
}

/// How times are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Times {
    Relative,
    Local,
    Utc,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let signals = Signals::catch()?;
    let path = arguments.source.as_path();
    if path.as_os_str() == "-" {
        return Monitor::new(arguments, GAP_NETWORK).watch_stream(Path::new("standard input"), input(), &signals);
    }
    let kind = fs::metadata(path).map(|metadata| metadata.file_type());
    let is_missing = arguments.reconnect && kind.is_err();
    if is_missing || is_url(path) || is_device(path) {
        return Monitor::new(arguments, GAP_USB).watch_device(arguments, &signals);
    }
    let kind = kind.map_err(|error| Failure::of_file(path.display(), &error))?;
    if kind.is_dir() {
        return Err(Failure::of(path.display(), "a directory"));
    }
    if kind.is_file() {
        return Monitor::new(arguments, GAP_USB).watch_file(path, &signals);
    }
    Monitor::new(arguments, GAP_NETWORK).watch_stream(path, File::open(path), &signals)
}

struct Monitor {
    screen: Screen,
    json: bool,
    times: Times,
    /// What a time is by the clock on the wall.
    start: Option<Start>,
    statistics: Statistics,
    /// When anything came last, from anybody and from each.
    last: Duration,
    heard: Lanes<Duration>,
    decoder: Box<dyn Decoder>,
    /// What the user says that the gap is, and what it is.
    given_gap: Option<Duration>,
    gap: Duration,
    /// Who sends what comes, if the user knows.
    from: Option<Side>,
}

impl Monitor {
    fn new(arguments: &Arguments, gap: Duration) -> Self {
        let protocol = arguments.spoken.protocol;
        Self {
            screen: Screen::new(),
            json: arguments.json,
            times: arguments.time,
            start: None,
            statistics: Statistics::new(protocol.terms()),
            last: Duration::ZERO,
            heard: Lanes::default(),
            decoder: protocol.decoder(),
            given_gap: arguments.port.gap(),
            gap: arguments.port.gap().unwrap_or(gap),
            from: arguments.from,
        }
    }

    fn begins_now(&mut self) {
        self.start = Some(Start { time: Duration::ZERO, utc: Utc::now() });
    }

    fn watch_device(mut self, arguments: &Arguments, signals: &Signals) -> Result<Status, Failure> {
        let opening = Opening::new(&arguments.source, &arguments.port, arguments.reconnect);
        let mut clock = Clock::new();
        self.begins_now();
        let result = loop {
            let opened = opening.open(|| signals.came() || self.screen.is_abandoned());
            let mut device = match opened {
                Ok(Some(device)) => device,
                Ok(None) => break Ok(()),
                // Nothing was watched.
                Err(failure) if self.last.is_zero() => return Err(failure),
                Err(failure) => break Err(failure),
            };
            self.gap = device.gap();
            match self.watch_open(&mut device, &mut clock, signals) {
                Err(failure @ Failure::Device(_)) if arguments.reconnect => complain(&failure.to_string()),
                result => break result,
            }
        };
        // A device that has gone was still worth being watched.
        self.end()?;
        result.map(|()| Status::Finished)
    }

    fn watch_open(&mut self, device: &mut Device, clock: &mut Clock, signals: &Signals) -> Result<(), Failure> {
        while !signals.came() {
            if clock.receive(SLICE, |time| device.receive(time))?.is_some() {
                self.take(None, device.bytes(), clock.now())?;
                self.screen.flush()?;
            } else {
                self.idle(clock.now())?;
                self.screen.flush()?;
                if self.screen.is_abandoned() {
                    break;
                }
            }
        }
        Ok(())
    }

    fn watch_stream(mut self, name: &Path, stream: io::Result<File>, signals: &Signals) -> Result<Status, Failure> {
        let failure = |error| Failure::of_file(name.display(), &error);
        let stream = stream.and_then(Stream::new).map_err(failure)?;
        let (mut clock, mut room, mut source) = (Clock::new(), vec![0; CHUNK], Source::new(name));
        self.begins_now();
        while !signals.came() {
            let received = clock.receive(SLICE, |time| {
                let happened = wait(stream.as_fd(), time).map_err(|error| failure(error.into()))?;
                if happened.is_empty() {
                    return Ok(None);
                }
                // What is already there, as more may be; the end is 0 bytes.
                match stream.read(&mut room) {
                    Ok(count) => Ok(Some(count)),
                    Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(None),
                    Err(_) if !happened.intersects(PollFlags::IN) => Ok(Some(0)),
                    Err(error) => Err(failure(error)),
                }
            })?;
            match received {
                Some(0) => break,
                Some(count) => {
                    let bytes = room.get(..count).unwrap_or_default();
                    self.take_from(&mut source, bytes, clock.now(), signals)?;
                }
                None => {
                    self.idle_stream(clock.now(), &source)?;
                    if self.screen.is_abandoned() {
                        break;
                    }
                }
            }
            self.screen.flush()?;
        }
        self.finish(source)
    }

    /// In a recording it is the times of its entries that count.
    fn idle_stream(&mut self, now: Duration, source: &Source) -> Result<(), Failure> {
        if source.is_recording() { Ok(()) } else { self.idle(now) }
    }

    fn watch_file(mut self, path: &Path, signals: &Signals) -> Result<Status, Failure> {
        let (mut file, mut source) = (Progress::open(path)?, Source::new(path));
        // Before anything is shown, all of it has to be readable.
        while !signals.came() {
            let bytes = file.read()?;
            if bytes.is_empty() {
                source.end(|_| Ok(true))?;
                break;
            }
            source.feed(bytes, |_| Ok(true))?;
            if !source.is_recording() {
                break;
            }
        }
        let (mut file, mut source) = (Progress::again(path)?, Source::new(path));
        loop {
            let bytes = file.read()?;
            if bytes.is_empty() || signals.came() {
                break;
            }
            for bytes in bytes.chunks(CHUNK / 16) {
                if signals.is_raised() {
                    break;
                }
                self.take_from(&mut source, bytes, Duration::ZERO, signals)?;
                self.screen.flush()?;
            }
        }
        self.finish(source)
    }

    fn take_from(
        &mut self,
        source: &mut Source,
        bytes: &[u8],
        now: Duration,
        signals: &Signals,
    ) -> Result<(), Failure> {
        source.feed(bytes, |piece| self.take_piece(&piece, now).map(|()| !signals.is_raised()))
    }

    fn take_piece(&mut self, piece: &source::Piece, now: Duration) -> Result<(), Failure> {
        match piece {
            source::Piece::Raw(_) if self.start.is_none() && self.times != Times::Relative => {
                Err(Failure::Usage("--time: a file of bytes does not say when they passed".into()))
            }
            source::Piece::Raw(bytes) => self.take(None, bytes, now),
            source::Piece::Entry(entry, parser) => {
                self.start = parser.start();
                if self.start.is_none() && self.times != Times::Relative {
                    return Err(Failure::Usage("--time: the recording does not say when it was recorded".into()));
                }
                if let Some(gap) = parser.gap() {
                    self.gap = self.given_gap.unwrap_or(gap);
                }
                self.take(Some(entry.from), &entry.bytes, entry.time)
            }
        }
    }

    fn finish(mut self, mut source: Source) -> Result<Status, Failure> {
        let last = self.last;
        let result = source.end(|piece| self.take_piece(&piece, last).map(|()| true));
        source.complain_about_damage();
        self.end()?;
        result.map(|()| Status::Finished)
    }
}

impl Monitor {
    fn take(&mut self, from: Option<Side>, bytes: &[u8], time: Duration) -> Result<(), Failure> {
        self.idle(time)?;
        let from = from.or(self.from);
        *self.heard.of(from) = time;
        self.last = time;
        self.statistics.count_bytes(bytes);
        let pieces = self.decoder.feed(from, bytes);
        self.show(&pieces, time)
    }

    /// It is now. What ends by silence has the time of its last byte.
    fn idle(&mut self, now: Duration) -> Result<(), Failure> {
        for from in SENDERS {
            let heard = *self.heard.of(from);
            let pieces = self.decoder.idle(from, now.saturating_sub(heard), self.gap);
            self.show(&pieces, heard)?;
        }
        Ok(())
    }

    /// Nothing follows.
    fn end(&mut self) -> Result<(), Failure> {
        for from in SENDERS {
            let pieces = self.decoder.end(from);
            let heard = *self.heard.of(from);
            self.show(&pieces, heard)?;
        }
        let it = &self.statistics;
        if self.json { self.screen.put_json(&it.json(self.last)) } else { self.screen.put(&it.text(self.last)) }?;
        Ok(self.screen.flush()?)
    }

    fn show(&mut self, pieces: &[Piece], time: Duration) -> Result<(), Failure> {
        for piece in pieces {
            self.statistics.count(piece);
            let from = piece.from;
            let date = self.start.map(|start| start.at(time)).filter(|_| self.times != Times::Relative);
            if self.json {
                let mut when = json!({ "time": seconds(time), "from": from.map(Side::name) });
                if let (Some(date), Some(when)) = (date, when.as_object_mut()) {
                    when.insert("date".into(), self.date_text(date).into());
                }
                self.screen.put_json(&piece.add_to(when))?;
            } else {
                let arrow = from.map_or(' ', Side::arrow);
                let time = date.map_or_else(|| format!("{:10.3}", time.as_secs_f64()), |date| self.date_text(date));
                self.screen.put(&format!("{time} {arrow} {}", piece.text))?;
            }
        }
        Ok(())
    }

    fn date_text(&self, date: DateTime<Utc>) -> String {
        match self.times {
            Times::Local => date.with_timezone(&Local).to_rfc3339_opts(SecondsFormat::Millis, false),
            _ => date.to_rfc3339_opts(SecondsFormat::Millis, true),
        }
    }
}
