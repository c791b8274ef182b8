//! `deltarobot convert`: recordings in other formats, a file for each.

mod csv;
mod formats;
mod mcap;
mod messages;
mod text;

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use deltarobot_cli::port::positive_seconds;
use deltarobot_cli::screen::complain;
use deltarobot_cli::status::{Failure, Status};
use deltarobot_cli::system::input;
use deltarobot_cli::{Signals, Spoken, bear_size_limits, size};
use same_file::Handle;

use crate::rotation::Limits;
use formats::{Format, Sink};

/// Converts recordings between the text that `deltarobot record` writes, MCAP, and CSV.
#[derive(Debug, Parser)]
#[command(
    name = "deltarobot convert",
    version,
    max_term_width = 100,
    after_help = "Formats are taken from the extensions .txt, .mcap and .csv, unless --from or --to says another. Bytes, \
    times and robots are the same in all of them; text has one robot only."
)]
struct Arguments {
    /// The recording; `-` is standard input
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The file to write; `-` is standard output
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// The format of IN
    #[arg(long, value_enum, value_name = "FORMAT")]
    from: Option<Format>,
    /// The format of OUT
    #[arg(long, value_enum, value_name = "FORMAT")]
    to: Option<Format>,
    /// The robot, where IN has several and OUT takes one; the name of one that has none
    #[arg(long, value_name = "NAME")]
    robot: Option<String>,
    #[command(flatten)]
    spoken: Spoken,
    /// Overwrites a file that is there
    #[arg(long)]
    force: bool,
    /// Begins another MCAP file when this one has so many bytes (`500k`, `10M`, `1G`); x.mcap is renamed to x.1.mcap ...
    #[arg(long, value_name = "SIZE", value_parser = size)]
    rotate: Option<u64>,
    /// The same after so many seconds
    #[arg(long, value_name = "SECONDS", value_parser = positive_seconds)]
    rotate_after: Option<f64>,
    /// Whoever writes IN ends this, and no signal does
    #[arg(long, hide = true)]
    to_end: bool,
}

impl Arguments {
    fn format_of(option: &str, given: Option<Format>, path: &Path) -> Result<Format, Failure> {
        given.or_else(|| Format::of(path)).ok_or_else(|| {
            Failure::Usage(format!("{}: neither .txt nor .mcap nor .csv; {option} says what it is", path.display()))
        })
    }
}

/// Does what the command line says.
#[must_use]
pub fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return deltarobot_cli::explain(&error).unwrap_or_else(|failure| failure.end()).into(),
    };
    convert(&arguments).unwrap_or_else(|failure| failure.end()).into()
}

fn convert(arguments: &Arguments) -> Result<Status, Failure> {
    if arguments.to_end { Signals::catch().map(drop) } else { bear_size_limits() }?;
    let from = Arguments::format_of("--from", arguments.from, &arguments.input)?;
    let to = Arguments::format_of("--to", arguments.to, &arguments.output)?;
    if to != Format::Mcap && (arguments.rotate.is_some() || arguments.rotate_after.is_some()) {
        return Err(Failure::Usage("--rotate and --rotate-after are for MCAP only".into()));
    }
    let name = if is_stream(&arguments.input) { Path::new("standard input") } else { &arguments.input };
    let input = open(&arguments.input).map_err(|error| Failure::of_file(name.display(), &error))?;
    check(arguments, &input)?;
    let mut sink = sink(arguments, to)?;
    let damage = match from {
        Format::Text => text::read(input, name, arguments.robot.as_deref(), sink.as_mut()),
        Format::Csv => csv::read(&input, name, arguments.robot.as_deref(), sink.as_mut()),
        Format::Mcap => mcap::read(&input, name, arguments.robot.as_deref(), sink.as_mut()),
    };
    // What was read before an error is worth having.
    let finished = sink.finish();
    let damage = damage?;
    finished?;
    if let Some(damage) = damage {
        complain(&format!("{}: {damage}", name.display()));
    }
    Ok(Status::Finished)
}

fn is_stream(path: &Path) -> bool {
    path.as_os_str() == "-"
}

fn open(path: &Path) -> io::Result<File> {
    if is_stream(path) { input() } else { File::open(path) }
}

/// Whether the output may be written.
fn check(arguments: &Arguments, input: &File) -> Result<(), Failure> {
    let output = &arguments.output;
    let Ok(there) = fs::metadata(output) else { return Ok(()) };
    if is_stream(output) || !there.is_file() {
        return Ok(());
    }
    let is_input = || Ok::<_, io::Error>(Handle::from_file(input.try_clone()?)? == Handle::from_path(output)?);
    if is_input().unwrap_or(false) {
        return Err(Failure::of(output.display(), "is what is read; write another file"));
    }
    if arguments.force { Ok(()) } else { Err(Failure::of(output.display(), "File exists; --force overwrites it")) }
}

fn sink(arguments: &Arguments, to: Format) -> Result<Box<dyn Sink>, Failure> {
    let (path, protocol) = (arguments.output.as_path(), arguments.spoken.protocol);
    if to == Format::Mcap && !is_stream(path) {
        let limits = Limits { size: arguments.rotate, time: arguments.rotate_after.map(Duration::from_secs_f64) };
        return Ok(Box::new(mcap::Mcap::files(path, limits, protocol)?));
    }
    let output: Box<dyn io::Write> = if is_stream(path) {
        Box::new(io::stdout())
    } else {
        let file = OpenOptions::new().write(true).create(true).truncate(true).open(path);
        Box::new(file.map_err(|error| Failure::of_file(path.display(), &error))?)
    };
    let name = if is_stream(path) { Path::new("standard output") } else { path };
    Ok(match to {
        Format::Text => Box::new(text::Text::new(output, name)),
        Format::Csv => Box::new(csv::Csv::new(output, name, protocol)),
        Format::Mcap => Box::new(mcap::Mcap::stream(output, name, protocol)?),
    })
}
