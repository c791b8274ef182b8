//! `deltarobot record`: a session on a device, written to a file.

mod file;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::clock::{Clock, SLICE};
use crate::far_end::{FarEnd, Input, Place};
use crate::port::{Device, Opening, PortOptions};
use crate::recording::Side;
use crate::screen::{Screen, complain};
use crate::signals::Signals;
use crate::status::{Failure, Status};
use crate::wait::{wait, wait_for_any};
pub use file::size;
use file::{FileOptions, Recorder};

/// How long bytes of the device may wait while it is looked whether a program has opened the tap.
const TURN: Duration = Duration::from_millis(5);
/// How long a tap that is to end still passes on, for a program that uses it: that may have been asked to end too, and
/// have a motion to cancel.
const LINGER: Duration = Duration::from_secs(2);

#[derive(Debug, clap::Args)]
#[command(
    after_help = "The file is text, with a line for each run of bytes: seconds since the beginning, > for what the \
    host sent or < for what came from the controller, and the bytes as hexadecimal digits. Ends with Ctrl-C; a tap \
    that a program uses, two seconds later or when that ends."
)]
pub(crate) struct Arguments {
    /// The device, with the controller at its other end
    port: PathBuf,
    #[command(flatten)]
    file: FileOptions,
    /// Makes another device for a host program, prints its path, passes on everything and records both directions
    #[arg(long)]
    tap: bool,
    #[command(flatten)]
    place: Place,
    /// Waits for a device that is not there yet, and for one that has disappeared
    #[arg(long)]
    reconnect: bool,
    #[command(flatten)]
    options: PortOptions,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let signals = Signals::catch()?;
    arguments.file.check()?;
    if arguments.place.is_given() && !arguments.tap {
        return Err(Failure::Usage("--link and --listen are for --tap only; try --help".into()));
    }
    let opening = Opening::new(&arguments.port, &arguments.options, arguments.reconnect);
    let Some(device) = opening.open(|| signals.is_raised())? else { return Ok(Status::Finished) };
    // The file last: what is there stays if anything else is missing.
    let tap = arguments.tap.then(|| arguments.place.make(Some(&arguments.port))).transpose()?;
    let file = Recorder::create(&arguments.file, device.gap())?;
    if let Some(tap) = tap.as_ref().filter(|_| !file.is_output()) {
        Screen::new().line(&tap.path().display().to_string())?;
    }
    let mut session = Session { device, tap, file, clock: Clock::new(), room: vec![0; 4096] };
    let result = loop {
        match session.run(&signals) {
            Err(failure @ Failure::Device(_)) if arguments.reconnect && !session.file.has_failed() => {
                complain(&failure.to_string());
                match opening.open(|| signals.is_raised()) {
                    Ok(Some(device)) => session.device = device,
                    Ok(None) => break Ok(()),
                    Err(failure) => break Err(failure),
                }
            }
            result => break result,
        }
    };
    result.and(session.file.finish()).map(|()| Status::Finished)
}

/// The line between a host program and a device.
struct Session {
    device: Device,
    tap: Option<Box<dyn FarEnd>>,
    file: Recorder,
    clock: Clock,
    room: Vec<u8>,
}

impl Session {
    fn run(&mut self, signals: &Signals) -> Result<(), Failure> {
        let mut ends_at = None;
        loop {
            if signals.came() {
                if !self.is_tap_used()? || ends_at.is_some() {
                    return Ok(());
                }
                ends_at = Some(Instant::now() + LINGER);
            }
            if let Some(ends_at) = ends_at
                && (Instant::now() >= ends_at || !self.is_tap_used()?)
            {
                return Ok(());
            }
            if !self.pass_on()? && self.file.is_abandoned() {
                return Ok(());
            }
        }
    }

    fn is_tap_used(&self) -> Result<bool, Failure> {
        self.tap.as_ref().map_or(Ok(false), |tap| tap.is_open())
    }

    /// Passes on what comes, and records it. Returns whether anything came.
    fn pass_on(&mut self) -> Result<bool, Failure> {
        let Self { device, tap, file, clock, room } = self;
        let received = clock.receive(SLICE, |time| {
            if !time.is_zero() {
                wait_for_either(device, tap.as_deref(), time)?;
            }
            if device.receive(Duration::ZERO)?.is_some() {
                return Ok(Some((Side::Controller, 0)));
            }
            let Some(tap) = tap else { return Ok(None) };
            match tap.read(room, Duration::ZERO)? {
                Input::Bytes(0) | Input::Nobody => Ok(None),
                Input::Bytes(count) => Ok(Some((Side::Host, count))),
            }
        })?;
        match received {
            None => return Ok(false),
            // Passed on first: the file may be slow.
            Some((Side::Controller, _)) => {
                if let Some(tap) = tap {
                    tap.write(device.bytes())?;
                }
                file.note(clock.now(), Side::Controller, device.bytes())?;
            }
            Some((Side::Host, count)) => {
                let bytes = room.get(..count).unwrap_or_default();
                let written = device.write(bytes);
                file.note(clock.now(), Side::Host, bytes)?;
                written?;
            }
        }
        Ok(true)
    }
}

fn wait_for_either(device: &Device, tap: Option<&dyn FarEnd>, time: Duration) -> Result<(), Failure> {
    // What is wrong shows when it is read.
    let _ = match tap {
        // One that nobody has open would end the waiting at once.
        Some(tap) if tap.is_open()? => wait_for_any([device.as_fd(), tap.as_fd()], time).map(drop),
        Some(_) => wait(device.as_fd(), time.min(TURN)).map(drop),
        None => wait(device.as_fd(), time).map(drop),
    };
    Ok(())
}
