//! Waiting for what comes.

use std::os::fd::AsFd;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

/// Waits until there is something to read, or nobody at the other end, for at most so many milliseconds. What happened:
/// nothing, too, when a signal came.
pub(crate) fn wait(fd: &impl AsFd, timeout_ms: u32) -> Result<PollFlags, Errno> {
    let time = Timespec { tv_sec: i64::from(timeout_ms / 1000), tv_nsec: i64::from(timeout_ms % 1000) * 1_000_000 };
    let mut polled = [PollFd::new(fd, PollFlags::IN)];
    match poll(&mut polled, Some(&time)) {
        Ok(_) => Ok(polled.first().map_or(PollFlags::empty(), PollFd::revents)),
        Err(Errno::INTR) => Ok(PollFlags::empty()),
        Err(error) => Err(error),
    }
}
