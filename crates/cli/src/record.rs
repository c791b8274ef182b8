//! `deltarobot record`: a session on a device, written to a file.

mod file;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::clock::{Clock, SLICE};
use crate::port::{Device, Opening, PortOptions};
use crate::pty::{Input, Pty};
use crate::recording::Side;
use crate::screen::{Screen, complain};
use crate::signals::Signals;
use crate::status::{Failure, Status};
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
    /// Makes a pseudo-terminal for a host program, prints its path, passes on everything and records both directions
    #[arg(long)]
    tap: bool,
    /// A symbolic link to make to that pseudo-terminal
    #[arg(long, value_name = "PATH", requires = "tap")]
    link: Option<PathBuf>,
    /// Waits for a device that is not there yet, and for one that has disappeared
    #[arg(long)]
    reconnect: bool,
    #[command(flatten)]
    options: PortOptions,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let signals = Signals::catch()?;
    arguments.file.check()?;
    let opening = Opening::new(&arguments.port, &arguments.options, arguments.reconnect);
    let Some(device) = opening.open(|| signals.is_raised())? else { return Ok(Status::Finished) };
    // The file last: what is there stays if anything else is missing.
    let pty =
        if arguments.tap { Some(Pty::new(arguments.link.as_deref())?.stands_before(&arguments.port)) } else { None };
    let file = Recorder::create(&arguments.file, device.gap())?;
    if let Some(pty) = pty.as_ref().filter(|_| !file.is_output()) {
        Screen::new().line(&pty.path().display().to_string())?;
    }
    let mut session = Session { device, pty, file, clock: Clock::new(), room: vec![0; 4096] };
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
    pty: Option<Pty>,
    file: Recorder,
    clock: Clock,
    room: Vec<u8>,
}

impl Session {
    fn run(&mut self, signals: &Signals) -> Result<(), Failure> {
        let mut ends_at = None;
        loop {
            if signals.came() {
                let is_used = self.pty.as_ref().map_or(Ok(false), Pty::is_open)?;
                if !is_used || ends_at.is_some() {
                    return Ok(());
                }
                ends_at = Some(Instant::now() + LINGER);
            }
            if let Some(ends_at) = ends_at
                && (Instant::now() >= ends_at || !self.pty.as_ref().map_or(Ok(false), Pty::is_open)?)
            {
                return Ok(());
            }
            if !self.pass_on()? && self.file.is_abandoned() {
                return Ok(());
            }
        }
    }

    /// Passes on what comes, and records it. Returns whether anything came.
    fn pass_on(&mut self) -> Result<bool, Failure> {
        let Self { device, pty, file, clock, room } = self;
        let received = clock.receive(SLICE, |time| {
            if !time.is_zero() {
                wait_for_either(device, pty.as_ref(), time)?;
            }
            if device.receive(Duration::ZERO)?.is_some() {
                return Ok(Some((Side::Controller, 0)));
            }
            let Some(pty) = pty else { return Ok(None) };
            match pty.read(room, Duration::ZERO)? {
                Input::Bytes(0) | Input::Nobody => Ok(None),
                Input::Bytes(count) => Ok(Some((Side::Host, count))),
            }
        })?;
        match received {
            None => return Ok(false),
            // Passed on first: the file may be slow.
            Some((Side::Controller, _)) => {
                if let Some(pty) = pty {
                    pty.write(device.bytes())?;
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

fn wait_for_either(device: &mut Device, pty: Option<&Pty>, time: Duration) -> Result<(), Failure> {
    let mut polled = vec![PollFd::new(&*device, PollFlags::IN)];
    // One that nobody has open would end the waiting at once.
    let mut time = time;
    if let Some(pty) = pty {
        if pty.is_open()? { polled.push(PollFd::new(pty, PollFlags::IN)) } else { time = time.min(TURN) }
    }
    let time = Timespec::try_from(time).unwrap_or_default();
    // What is wrong shows when it is read.
    let _ = poll(&mut polled, Some(&time));
    Ok(())
}
