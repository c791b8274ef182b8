//! `deltarobot replay`: what was recorded, sent again.

use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

use crate::port::{Device, Opening, PortOptions};
use crate::recording::{Entry, Side};
use crate::screen::Screen;
use crate::signals::Signals;
use crate::source::{Piece, Progress, Source};
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
    options: PortOptions,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let signals = Signals::catch()?;
    // Before anything is sent, all of it has to be readable.
    let mut is_empty = true;
    let source = read(arguments, Progress::open(&arguments.file)?, &signals, |_| {
        is_empty = false;
        Ok(true)
    })?;
    if signals.is_raised() {
        return Ok(Status::Cancelled);
    }
    source.complain_about_damage();
    if is_empty {
        let (name, side) = (arguments.file.display(), arguments.side.name());
        return Err(Failure::Usage(format!("{name}: nothing in it was sent by the {side}; try --side")));
    }
    let device = match arguments.port.as_os_str() {
        output if output == "-" => None,
        _ => match Opening::new(&arguments.port, &arguments.options, false).open(|| signals.is_raised())? {
            Some(device) => Some(device),
            None => return Ok(Status::Cancelled),
        },
    };
    let mut player = Player { device, screen: Screen::new(), began: Instant::now(), fast: arguments.fast };
    read(arguments, Progress::again(&arguments.file)?, &signals, |entry| player.play(entry, &signals))?;
    if signals.is_raised() {
        return Ok(Status::Cancelled);
    }
    if let Some(device) = &mut player.device {
        device.drain()?;
    }
    Ok(Status::Finished)
}

/// Reads a recording through, unless a signal comes: what that side sent.
fn read(
    arguments: &Arguments,
    mut file: Progress,
    signals: &Signals,
    mut take: impl FnMut(&Entry) -> Result<bool, Failure>,
) -> Result<Source, Failure> {
    let no_recording = || Failure::of(arguments.file.display(), "not a recording");
    let mut take = |piece: Piece| match piece {
        Piece::Raw(_) => Err(no_recording()),
        Piece::Entry(entry, _) if entry.from == arguments.side => {
            take(entry).map(|goes_on| goes_on && !signals.is_raised())
        }
        Piece::Entry(..) => Ok(!signals.is_raised()),
    };
    let mut source = Source::new(&arguments.file);
    while !signals.is_raised() {
        let bytes = file.read()?;
        if bytes.is_empty() {
            source.end(&mut take)?;
            break;
        }
        source.feed(bytes, &mut take)?;
    }
    Ok(source)
}

struct Player {
    device: Option<Device>,
    screen: Screen,
    began: Instant,
    fast: bool,
}

impl Player {
    /// Sends bytes at their time. Returns false when a signal came before.
    fn play(&mut self, entry: &Entry, signals: &Signals) -> Result<bool, Failure> {
        loop {
            if signals.is_raised() {
                return Ok(false);
            }
            let left = entry.time.saturating_sub(self.began.elapsed()).min(TURN);
            if self.fast || left.is_zero() {
                break;
            }
            match &mut self.device {
                // Answers are of no interest, but they shall not pile up either.
                Some(device) => drop(device.receive(left)?),
                None => thread::sleep(left),
            }
        }
        match &mut self.device {
            Some(device) => device.write(&entry.bytes)?,
            None => self.screen.raw(&entry.bytes)?,
        }
        Ok(true)
    }
}
