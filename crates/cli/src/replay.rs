//! `deltarobot replay`: what was recorded, sent again.

use std::fs;
use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

use crate::port::{Device, Speed};
use crate::recording::{self, Side};
use crate::screen::Screen;
use crate::signals::Signals;
use crate::status::{Failure, Status};

/// How often it is looked whether the user wants to end.
const TURN: Duration = Duration::from_millis(50);

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The recording, made by `deltarobot record`
    file: PathBuf,
    /// The device to send to; `-` is standard output
    port: PathBuf,
    /// Whose part to play
    #[arg(long, value_enum, default_value_t = Side::Host)]
    side: Side,
    /// Without the pauses between
    #[arg(long)]
    fast: bool,
    #[command(flatten)]
    speed: Speed,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let name = arguments.file.display();
    let text = fs::read(&arguments.file).map_err(|error| Failure::of_file(&name, &error))?;
    let entries = recording::read(&text).map_err(|error| Failure::of(&name, error))?;
    let entries: Vec<_> = entries.iter().filter(|entry| entry.from == arguments.side).collect();
    if entries.is_empty() {
        let side = arguments.side.name();
        return Err(Failure::Usage(format!("{name}: nothing in it was sent by the {side}; try --side")));
    }
    let signals = Signals::catch()?;
    let mut device = match arguments.port.as_os_str() {
        output if output == "-" => None,
        _ => Some(Device::open(&arguments.port, arguments.speed)?),
    };
    let mut screen = Screen::new();
    let began = Instant::now();
    for entry in entries {
        loop {
            if signals.came() {
                return Ok(Status::Cancelled);
            }
            let left = entry.time.saturating_sub(began.elapsed()).min(TURN);
            if arguments.fast || left.is_zero() {
                break;
            }
            match &mut device {
                // Answers are of no interest, but they shall not pile up either.
                Some(device) => {
                    device.read(u32::try_from(left.as_millis()).unwrap_or(0).max(1))?;
                }
                None => thread::sleep(left),
            }
        }
        match &mut device {
            Some(device) => device.write(&entry.bytes)?,
            None => screen.raw(&entry.bytes)?,
        }
    }
    if let Some(device) = &mut device {
        device.drain()?;
    }
    Ok(Status::Finished)
}
