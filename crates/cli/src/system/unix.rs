//! Unix.

mod pty;
mod serial;
mod tap;

use std::fs::{File, Metadata};
use std::io::{self, Error};
use std::mem::MaybeUninit;
use std::os::fd::AsFd;
pub(crate) use std::os::fd::OwnedFd as Handle;
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::Command;
use std::ptr;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use libc::{SIGALRM, SIGHUP, SIGINT, SIGPROF, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2, SIGVTALRM, SIGXCPU, SIGXFSZ, c_int};
use rustix::event::PollFlags;
use rustix::io::Errno;
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

pub(crate) use pty::pseudo_terminal;
pub(crate) use serial::{Line, is_direct};
pub(crate) use tap::tapped_device;

use crate::wait::wait_for;

/// What ends a program that does not care. Some devices and links have to be removed, whichever it is.
const ENDING: [c_int; 10] = [SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGALRM, SIGVTALRM, SIGPROF, SIGUSR1, SIGUSR2, SIGXCPU];

/// Has signals set the flag instead of ending the program, but for those that whoever started it had ignored: as
/// `nohup` does with SIGHUP, and shells with SIGINT where a script runs something in the background.
pub(crate) fn catch_signals(flag: &Arc<AtomicBool>) -> io::Result<()> {
    for signal in ENDING.into_iter().filter(|signal| !is_ignored(*signal)) {
        signal_hook::flag::register(signal, Arc::clone(flag))?;
    }
    bear_size_limits()
}

/// Has writing beyond the limit on a file's size fail instead of ending the program.
pub(crate) fn bear_size_limits() -> io::Result<()> {
    signal_hook::flag::register(SIGXFSZ, Arc::default()).map(drop)
}

#[expect(unsafe_code, reason = "no library says it")]
fn is_ignored(signal: c_int) -> bool {
    let mut action = MaybeUninit::<libc::sigaction>::uninit();
    // SAFETY: without a new action sigaction(2) only writes the present one to the memory given, which is of its type.
    let result = unsafe { libc::sigaction(signal, ptr::null(), action.as_mut_ptr()) };
    // SAFETY: it was successful, so that the action was written.
    result == 0 && unsafe { action.assume_init() }.sa_sigaction == libc::SIG_IGN
}

/// Runs another program instead of this one. Returns why it could not.
pub(crate) fn become_program(command: &mut Command) -> Error {
    command.exec()
}

/// Whether a file can be run.
pub(crate) fn is_program(metadata: &Metadata) -> bool {
    metadata.permissions().mode() & 0o111 != 0
}

/// Whether a path names a device, as opposed to a file or a stream.
pub(crate) fn is_device(path: &Path) -> bool {
    path.metadata().is_ok_and(|metadata| metadata.file_type().is_char_device())
}

/// Whether nobody will read what is written to standard output.
pub(crate) fn is_abandoned(output: &impl AsFd) -> bool {
    wait_for(output.as_fd(), PollFlags::empty(), Duration::ZERO)
        .is_ok_and(|happened| happened.intersects(PollFlags::ERR | PollFlags::HUP))
}

/// Whether a terminal obeys escape sequences.
pub(crate) const fn has_escapes() -> bool {
    true
}

/// Whether an error of a device that was open means that it has gone.
pub(crate) fn is_gone(error: &Error) -> bool {
    let gone = [Errno::IO, Errno::NXIO, Errno::NODEV, Errno::PIPE, Errno::CONNRESET];
    Errno::from_io_error(error).is_some_and(|error| gone.contains(&error))
}

/// Standard input.
pub fn input() -> io::Result<File> {
    Ok(File::from(io::stdin().as_fd().try_clone_to_owned()?))
}

pub(super) type Pollable = File;

#[expect(clippy::unnecessary_wraps, reason = "on other systems it can fail")]
pub(super) const fn pollable(file: File) -> io::Result<Pollable> {
    Ok(file)
}

/// One end of what wakes up a thread that polls the other.
pub type Wake = UnixStream;

/// Both ends, neither of which blocks.
pub fn wakes() -> io::Result<(Wake, Wake)> {
    let (one, other) = UnixStream::pair()?;
    one.set_nonblocking(true)?;
    other.set_nonblocking(true)?;
    Ok((one, other))
}

/// Whether all users of the machine can read a file.
pub fn everybody_reads(metadata: &Metadata) -> bool {
    metadata.mode() & 0o004 != 0
}

/// As many files may be open as the system allows: programs get fewer unless they ask.
pub fn more_files() {
    let limit = getrlimit(Resource::Nofile);
    // If that fails there are fewer.
    let _ = setrlimit(Resource::Nofile, Rlimit { current: limit.maximum, ..limit });
}
