//! Windows.

mod serial;
mod socket;

use std::fs::{File, Metadata};
use std::io::{self, Error, Read};
use std::net::TcpStream;
use std::os::windows::io::AsHandle;
pub(crate) use std::os::windows::io::OwnedHandle as Handle;
use std::path::{Path, PathBuf};
use std::process::{Command, exit};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread;
use std::time::Duration;

use windows_sys::Win32::System::Console::{CTRL_BREAK_EVENT, CTRL_C_EVENT, SetConsoleCtrlHandler};
use windows_sys::core::BOOL;

pub(crate) use serial::{Line, is_device, is_direct};
use socket::pair;

use crate::far_end::FarEnd;
use crate::status::Failure;

const TRUE: BOOL = 1;

/// What the handler sets.
static ASKED_TO_END: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// Has Ctrl-C, Ctrl-Break, the closing of the window and the end of the session set the flag instead of ending the
/// program. All but the first two end it as soon as the handler returns, so that this gives it time for a motion to
/// cancel: five seconds, after which the system ends it anyway.
pub(crate) fn catch_signals(flag: &Arc<AtomicBool>) -> io::Result<()> {
    extern "system" fn handle(event: u32) -> BOOL {
        if let Some(flag) = ASKED_TO_END.get() {
            flag.store(true, Ordering::Relaxed);
        }
        if !matches!(event, CTRL_C_EVENT | CTRL_BREAK_EVENT) {
            thread::sleep(Duration::from_secs(5));
        }
        TRUE
    }
    ASKED_TO_END.get_or_init(|| Arc::clone(flag));
    #[expect(unsafe_code, reason = "no library leaves time to a program whose window is closed")]
    // SAFETY: the handler is there as long as the program. It runs in a thread of its own, where all can be called.
    let is_set = unsafe { SetConsoleCtrlHandler(Some(handle), TRUE) };
    if is_set == 0 { Err(Error::last_os_error()) } else { Ok(()) }
}

/// There are no such limits.
pub(crate) const fn bear_size_limits() -> io::Result<()> {
    Ok(())
}

/// Runs another program, and ends as it does. Returns why it could not.
pub(crate) fn become_program(command: &mut Command) -> Error {
    // Ctrl-C is for that program, which this one waits for.
    if let Err(error) = catch_signals(&Arc::default()) {
        return error;
    }
    match command.status() {
        Ok(status) => exit(status.code().unwrap_or(1)),
        Err(error) => error,
    }
}

/// Names say it.
pub(crate) const fn is_program(_: &Metadata) -> bool {
    true
}

/// Whoever reads no more is noticed when something is written.
pub(crate) const fn is_abandoned<T>(_: &T) -> bool {
    false
}

/// Whether the terminal obeys escape sequences, which has to be asked for.
pub(crate) fn has_escapes() -> bool {
    anstyle_query::windows::enable_ansi_colors() == Some(true)
}

/// Whether an error of a device that was open means that it has gone: drivers differ in what they say.
pub(crate) const fn is_gone(_: &Error) -> bool {
    true
}

/// Standard input.
pub fn input() -> io::Result<File> {
    Ok(File::from(io::stdin().as_handle().try_clone_to_owned()?))
}

pub(super) type Pollable = TcpStream;

pub(super) fn pollable(mut file: File) -> io::Result<Pollable> {
    let (near, far) = pair()?;
    socket::pass_on("stream", far, move |room| file.read(room).map(Some))?;
    Ok(near)
}

/// One end of what wakes up a thread that polls the other.
pub type Wake = TcpStream;

/// Both ends, neither of which blocks.
pub fn wakes() -> io::Result<(Wake, Wake)> {
    let (one, other) = pair()?;
    one.set_nonblocking(true)?;
    other.set_nonblocking(true)?;
    Ok((one, other))
}

/// Not known: there are lists of who may.
pub const fn everybody_reads(_: &Metadata) -> bool {
    false
}

/// There is no such limit.
pub const fn more_files() {}

/// There are no pseudo-terminals.
pub(crate) const fn pseudo_terminal(_: Option<&Path>, _: Option<&Path>) -> Result<Option<Box<dyn FarEnd>>, Failure> {
    Ok(None)
}

/// Only a pseudo-terminal is known to be one.
pub(crate) const fn tapped_device(_: &Path) -> Option<PathBuf> {
    None
}
