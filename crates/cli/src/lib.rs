//! The program `deltarobot`: simulated machines, requests to a real robot, and tools for the line between. What knows a
//! protocol is below `decoder` and `sim`, in a file for each. What is public is for `deltarobot-serve`.

#![deny(unsafe_code)]
#![allow(
    clippy::arithmetic_side_effects,
    reason = "numbers here are times and sizes of what fits in memory, and a program may stop where a library must not"
)]
#![allow(
    clippy::missing_errors_doc,
    clippy::must_use_candidate,
    clippy::new_without_default,
    reason = "the errors are all of one kind, in words, and this is no library for others than the programs here"
)]
#![cfg_attr(
    test,
    allow(
        clippy::float_cmp,
        clippy::indexing_slicing,
        clippy::panic,
        clippy::unwrap_used,
        reason = "a test that can't go on fails, and numbers that are written down are compared as they are"
    )
)]

pub mod clock;
mod decode;
pub mod decoder;
mod external;
pub mod far_end;
mod generate;
pub mod hex;
mod monitor;
mod operation;
pub mod path;
pub mod port;
mod ports;
mod protocol;
mod record;
pub mod recording;
mod replay;
mod run;
pub mod screen;
mod send;
mod signals;
pub mod sim;
mod source;
pub mod status;
pub mod system;
pub mod wait;
pub mod words;

pub use operation::driver::session_settings;
pub use protocol::{Protocol, Spoken};
pub use record::size;
pub use signals::{Signals, bear_size_limits};
pub use source::CHUNK;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use status::{Failure, Status};

/// What `--help` says at the end.
const STATUSES: &str = "\
Exit status:
  0  finished
  1  refused or failed by the controller; for `decode`: there were bytes that are no message
  2  wrong usage
  3  a device or file that is missing, in use, unreadable or was disconnected
  4  the controller did not answer in time
  5  cancelled (Ctrl-C during a request; pressed again, it ends the program at once)";

/// Controls a delta robot over a serial line, simulates it and the machines of two other protocols, and shows what
/// passes on the line.
#[derive(Debug, Parser)]
#[command(name = "deltarobot", version, max_term_width = 100, after_help = STATUSES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Simulates a controller or devices, on a pseudo-terminal or a port of TCP
    Sim(sim::Arguments),
    /// Has the robot home, and waits until it has
    Home(operation::Home),
    /// Moves the robot, and waits until it is there
    Move(operation::Move),
    /// Asks for the robot's state and position
    Status(operation::StatusQuery),
    /// Cancels what the robot is doing
    Cancel(operation::Plain),
    /// Checks a path from a CSV, SVG or G-code file, and has the robot trace it
    Path(path::command::Arguments),
    /// Makes requests from a file, one after the other
    Run(run::Arguments),
    /// Sends commands of the protocols `line` and `gx`, and waits for their ends
    Send(send::Arguments),
    /// Shows the messages that come from a device, a file or standard input
    Monitor(monitor::Arguments),
    /// Shows the messages in bytes given on the command line
    Decode(decode::Arguments),
    /// Lists the serial ports of this machine
    Ports(ports::Arguments),
    /// Records what comes from a device, or passes between a host program and a device
    Record(record::Arguments),
    /// Sends what was recorded, at the times when it was
    Replay(replay::Arguments),
    /// Prints what a shell needs to complete command lines
    Completions(generate::Completions),
    /// Writes the manual pages to a directory
    Man(generate::Man),
    #[command(external_subcommand)]
    External(Vec<OsString>),
}

/// Does what the command line says.
#[must_use]
pub fn main() -> ExitCode {
    let result = Cli::try_parse().map_or_else(|error| explain(&error), |cli| dispatch(&cli.command));
    result.unwrap_or_else(|failure| failure.end()).into()
}

fn dispatch(command: &Command) -> Result<Status, Failure> {
    match command {
        Command::Sim(arguments) => sim::run(arguments),
        Command::Home(arguments) => operation::home(arguments),
        Command::Move(arguments) => operation::move_to(arguments),
        Command::Status(arguments) => operation::status(arguments),
        Command::Cancel(arguments) => operation::cancel(arguments),
        Command::Path(arguments) => path::command::run(arguments),
        Command::Run(arguments) => run::run(arguments),
        Command::Send(arguments) => send::run(arguments),
        Command::Monitor(arguments) => monitor::run(arguments),
        Command::Decode(arguments) => decode::run(arguments),
        Command::Ports(arguments) => ports::run(arguments),
        Command::Record(arguments) => record::run(arguments),
        Command::Replay(arguments) => replay::run(arguments),
        Command::Completions(arguments) => generate::completions(arguments),
        Command::Man(arguments) => generate::man(arguments),
        Command::External(words) => Err(external::run(words)),
    }
}

/// Prints help where it was asked for; else says what is wrong with the command line, on one line.
pub fn explain(error: &clap::Error) -> Result<Status, Failure> {
    if !error.use_stderr() {
        error.print()?;
        return Ok(Status::Finished);
    }
    if error.kind() == clap::error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        return Err(Failure::Usage("a subcommand is needed; try --help".into()));
    }
    let text = error.render().to_string();
    let said = text.split("\n\n").next().unwrap_or_default().trim_start_matches("error: ");
    let said: Vec<_> = said.lines().map(str::trim).collect();
    Err(Failure::Usage(format!("{}; try --help", said.join(" "))))
}
