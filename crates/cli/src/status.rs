//! How the program ends.

use std::fmt::{self, Display, Formatter};
use std::io;
use std::process::ExitCode;

use crate::screen::complain;

/// The exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// All is well.
    Finished = 0,
    /// The controller refused or failed.
    NotDone = 1,
    /// The command line or a file of settings is wrong.
    Usage = 2,
    /// A device or a file can't be used.
    Device = 3,
    /// There was no answer.
    TimedOut = 4,
    /// The user ended it.
    Cancelled = 5,
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> Self {
        (status as u8).into()
    }
}

/// Why it could not go on.
#[derive(Debug)]
pub enum Failure {
    /// A device or a file, and what is the matter with it.
    Device(String),
    /// Standard output.
    Output(io::Error),
    /// What the command line asks for can't be.
    Usage(String),
}

impl Failure {
    /// What is the matter with a file or a device.
    pub fn of(name: impl Display, error: impl Display) -> Self {
        Self::Device(format!("{name}: {error}"))
    }

    /// Says what it is, and how the program ends for it.
    pub fn end(&self) -> Status {
        if let Self::Output(error) = self
            && error.kind() == io::ErrorKind::BrokenPipe
        {
            // Who reads what we print has seen enough.
            return Status::Finished;
        }
        complain(&self.to_string());
        if matches!(self, Self::Usage(_)) { Status::Usage } else { Status::Device }
    }

    /// The same for an error of the system.
    pub fn of_file(name: impl Display, error: &io::Error) -> Self {
        Self::of(name, system_text(error))
    }
}

/// An error of the system, worded without Rust's additions.
pub fn system_text(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_owned()
}

impl Display for Failure {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Device(text) | Self::Usage(text) => f.write_str(text),
            Self::Output(error) => write!(f, "standard output: {}", system_text(error)),
        }
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}
