//! CSV: a row for each run of bytes, with the messages that were complete with it, and one for each event.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use chrono::{DateTime, SecondsFormat, Utc};
use csv::{ReaderBuilder, StringRecord, WriterBuilder};
use deltarobot_cli::Protocol;
use deltarobot_cli::hex::{from_hex, hex};
use deltarobot_cli::recording::Side;
use deltarobot_cli::status::Failure;
use serde_json::Value;

use super::formats::{Content, NAMELESS, Record, Sink, failure};
use super::messages::Messages;

/// The columns, of which reading needs `time`, `from` and `bytes`.
const COLUMNS: [&str; 12] =
    ["time", "date", "robot", "from", "bytes", "messages", "state", "a", "b", "c", "stops", "event"];

/// Reads a table to its end, of all robots or of one.
pub(super) fn read(
    input: &File,
    name: &Path,
    robot: Option<&str>,
    sink: &mut dyn Sink,
) -> Result<Option<String>, Failure> {
    let mut reader = ReaderBuilder::new().flexible(true).from_reader(input);
    let wrong = |error: csv::Error| Failure::of(name.display(), error);
    let head = reader.headers().map_err(wrong)?.clone();
    let columns = COLUMNS.map(|column| head.iter().position(|it| it.trim().eq_ignore_ascii_case(column)));
    let [Some(_), _, named, Some(_), Some(_), ..] = columns else {
        return Err(Failure::of(name.display(), "there have to be columns `time`, `from` and `bytes`"));
    };
    for row in reader.records() {
        let row = row.map_err(wrong)?;
        let record = record(&row, columns, robot).map_err(|error| {
            let line = row.position().map_or(0, csv::Position::line);
            Failure::of(name.display(), format!("line {line}: {error}"))
        })?;
        // Where robots have names, one of them can be picked.
        let is_wanted = named.is_none() || robot.is_none_or(|robot| robot == record.robot);
        if is_wanted {
            sink.put(&record)?;
        }
    }
    Ok(None)
}

fn record(row: &StringRecord, columns: [Option<usize>; 12], robot: Option<&str>) -> Result<Record, String> {
    let [time, date, name, from, bytes, .., event] =
        columns.map(|column| column.and_then(|column| row.get(column)).map(str::trim).filter(|text| !text.is_empty()));
    let seconds = time.and_then(|time| time.parse().ok()).and_then(|time| Duration::try_from_secs_f64(time).ok());
    let date = date.map(|date| {
        DateTime::parse_from_rfc3339(date)
            .map(|date| date.with_timezone(&Utc))
            .map_err(|_| format!("`{date}` is no date"))
    });
    let content = match (from, event) {
        (Some("host"), _) => Content::Bytes(Side::Host, from_hex(bytes.unwrap_or_default())?),
        (Some("controller"), _) => Content::Bytes(Side::Controller, from_hex(bytes.unwrap_or_default())?),
        (None, Some(event)) => Content::Event(serde_json::from_str(event).map_err(|error| error.to_string())?),
        (from, _) => return Err(format!("`{}` is neither host nor controller", from.unwrap_or_default())),
    };
    Ok(Record {
        robot: name.or(robot).unwrap_or(NAMELESS).to_owned(),
        time: seconds.ok_or_else(|| format!("`{}` is no time", time.unwrap_or_default()))?,
        date: date.transpose()?,
        gap: None,
        content,
    })
}

/// Writes one.
pub(super) struct Csv {
    out: csv::Writer<Box<dyn Write>>,
    name: PathBuf,
    messages: Messages,
    has_head: bool,
}

impl Csv {
    pub(super) fn new(out: Box<dyn Write>, name: &Path, protocol: Protocol) -> Self {
        let out = WriterBuilder::new().from_writer(out);
        Self { out, name: name.to_owned(), messages: Messages::new(protocol), has_head: false }
    }

    fn row<T: AsRef<[u8]>>(&mut self, row: impl IntoIterator<Item = T>) -> Result<(), Failure> {
        self.out.write_record(row).map_err(|error| failure(&self.name, &error.into()))
    }

    fn head(&mut self) -> Result<(), Failure> {
        if std::mem::replace(&mut self.has_head, true) { Ok(()) } else { self.row(COLUMNS) }
    }
}

impl Sink for Csv {
    fn put(&mut self, record: &Record) -> Result<(), Failure> {
        let (mut texts, mut state) = (Vec::new(), None);
        self.messages.take(record, |_, piece| {
            texts.push(piece.text.clone());
            state = piece.state().or(state.take());
        });
        let (from, bytes, event) = match &record.content {
            Content::Bytes(from, bytes) => (from.name(), hex(bytes), String::new()),
            Content::Event(event) => ("", String::new(), event.to_string()),
        };
        let state = state.unwrap_or_default();
        let cell = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let [name, stops] = ["state", "stops"].map(|member| state.get(member));
        let arm = |number: usize| state.pointer(&format!("/position/{number}")).map(cell).unwrap_or_default();
        let stops = stops.and_then(Value::as_array).map(|stops| stops.iter().map(cell).collect()).unwrap_or_default();
        self.head()?;
        self.row([
            format!("{:.6}", record.time.as_secs_f64()),
            record.date.map(|date| date.to_rfc3339_opts(SecondsFormat::Micros, true)).unwrap_or_default(),
            record.robot.clone(),
            from.to_owned(),
            bytes,
            texts.join("; "),
            name.map(cell).unwrap_or_default(),
            arm(0),
            arm(1),
            arm(2),
            stops,
            event,
        ])
    }

    fn idle(&mut self) -> Result<(), Failure> {
        self.out.flush().map_err(|error| failure(&self.name, &error))
    }

    fn finish(&mut self) -> Result<(), Failure> {
        self.head()?;
        self.idle()
    }
}
