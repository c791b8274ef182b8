//! What differs between operating systems: the same names on each.
//!
//! Whatever is waited for is a file descriptor, or on Windows a socket, which is all that can be polled there: threads
//! pass on what comes from other handles. Nothing outside of this directory knows the system.

use std::fs::File;
use std::io;

use rustix::fd::{AsFd, BorrowedFd};

#[cfg(unix)]
mod unix;
#[cfg(windows)]
mod windows;

#[cfg(unix)]
use unix as host;
#[cfg(windows)]
use windows as host;

pub(crate) use host::{
    Handle, Line, bear_size_limits, become_program, catch_signals, has_escapes, is_abandoned, is_device, is_direct,
    is_gone, is_program, pseudo_terminal, tapped_device,
};
pub use host::{Wake, everybody_reads, input, more_files, wakes};

/// Standard input, a pipe or a file, which is read when something has come.
pub struct Stream(host::Pollable);

impl Stream {
    /// Reads from a file that is open.
    pub fn new(file: File) -> io::Result<Self> {
        host::pollable(file).map(Self)
    }

    /// What becomes readable when something comes.
    pub fn as_fd(&self) -> BorrowedFd<'_> {
        self.0.as_fd()
    }

    /// Reads what is there; at the end none.
    pub fn read(&self, room: &mut [u8]) -> io::Result<usize> {
        Ok(rustix::io::read(&self.0, room)?)
    }
}
