//! `deltarobot record`: a session on a device, written to a file.

use std::fs::File;
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use crate::port::{Device, Speed};
use crate::pty::{Input, Pty};
use crate::recording::{Entry, HEADER, Side};
use crate::screen::Screen;
use crate::signals::Signals;
use crate::status::{Failure, Status};

/// How long either end waits for the other to be looked at, in milliseconds.
const TURN_MS: u32 = 5;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "The file is text, with a line for each run of bytes: seconds since the beginning, > for what the \
    host sent or < for what came from the controller, and the bytes as hexadecimal digits. Ends with Ctrl-C."
)]
pub(crate) struct Arguments {
    /// The device, with the controller at its other end
    port: PathBuf,
    /// The file to write; `-` is standard output
    file: PathBuf,
    /// Makes a pseudo-terminal for a host program, prints its path, passes on everything and records both directions
    #[arg(long)]
    tap: bool,
    /// A symbolic link to make to that pseudo-terminal
    #[arg(long, value_name = "PATH", requires = "tap")]
    link: Option<PathBuf>,
    #[command(flatten)]
    speed: Speed,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let signals = Signals::catch()?;
    let mut device = Device::open(&arguments.port, arguments.speed)?;
    // The file last: what is there stays if anything else is missing.
    let pty = if arguments.tap { Some(Pty::new(arguments.link.as_deref())?) } else { None };
    let mut file = Recorder::create(arguments)?;
    let Some(pty) = pty else {
        while !signals.came() {
            let bytes = device.read(1000)?;
            file.note(Side::Controller, bytes)?;
        }
        return Ok(Status::Finished);
    };
    if !file.is_output() {
        Screen::new().line(&pty.path().display().to_string())?;
    }
    let mut room = [0; 4096];
    while !signals.came() {
        let bytes = device.read(TURN_MS)?;
        file.note(Side::Controller, bytes)?;
        if !bytes.is_empty() {
            pty.write(bytes)?;
        }
        if let Input::Bytes(count) = pty.read(&mut room, 0)? {
            let bytes = room.get(..count).unwrap_or_default();
            file.note(Side::Host, bytes)?;
            device.write(bytes)?;
        }
    }
    Ok(Status::Finished)
}

/// The file that is written.
struct Recorder {
    name: PathBuf,
    /// `None` for standard output.
    file: Option<File>,
    began: Instant,
}

impl Recorder {
    fn create(arguments: &Arguments) -> Result<Self, Failure> {
        let name = arguments.file.clone();
        let file = if name.as_os_str() == "-" {
            None
        } else {
            Some(File::create(&name).map_err(|error| Failure::of_file(name.display(), &error))?)
        };
        let mut recorder = Self { name, file, began: Instant::now() };
        recorder.line(format!("{HEADER}\n").as_bytes())?;
        Ok(recorder)
    }

    const fn is_output(&self) -> bool {
        self.file.is_none()
    }

    fn note(&mut self, from: Side, bytes: &[u8]) -> Result<(), Failure> {
        if bytes.is_empty() {
            return Ok(());
        }
        let mut line = Vec::new();
        Entry { time: self.began.elapsed(), from, bytes: bytes.to_vec() }.write(&mut line)?;
        self.line(&line)
    }

    /// At once: what is recorded is there even if the program is killed.
    fn line(&mut self, line: &[u8]) -> Result<(), Failure> {
        match &mut self.file {
            Some(file) => file.write_all(line).map_err(|error| Failure::of_file(self.name.display(), &error)),
            None => Ok(Screen::new().raw(line)?),
        }
    }
}
