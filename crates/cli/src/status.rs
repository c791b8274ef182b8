//! How the program ends.

use std::fmt::Display;
use std::io;
use std::process::ExitCode;

/// The exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Status {
    Finished = 0,
    NotDone = 1,
    Usage = 2,
    Device = 3,
    TimedOut = 4,
    Cancelled = 5,
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> Self {
        (status as u8).into()
    }
}

/// Why it could not go on.
#[derive(Debug)]
pub(crate) enum Failure {
    /// A device or a file, and what is the matter with it.
    Device(String),
    /// Standard output.
    Output(io::Error),
    /// What the command line asks for can't be.
    Usage(String),
}

impl Failure {
    /// What is the matter with a file or a device.
    pub(crate) fn of(name: impl Display, error: impl Display) -> Self {
        Self::Device(format!("{name}: {error}"))
    }

    /// The same for an error of the system.
    pub(crate) fn of_file(name: impl Display, error: &io::Error) -> Self {
        Self::Device(text(name, error))
    }
}

/// A name and what is the matter with it, worded without Rust's additions.
pub(crate) fn text(name: impl Display, error: &io::Error) -> String {
    let text = error.to_string();
    format!("{name}: {}", text.split(" (os error").next().unwrap_or(&text))
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}
