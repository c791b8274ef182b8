//! Waiting for what comes.

use std::os::fd::AsFd;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

/// Waits until there is something to read, or nobody at the other end, for at most so long. What happened: nothing,
/// too, when a signal came.
pub fn wait(fd: &impl AsFd, time: Duration) -> Result<PollFlags, Errno> {
    wait_for(fd, PollFlags::IN, time)
}

/// The same for other events; an error at the other end is always one.
pub fn wait_for(fd: &impl AsFd, events: PollFlags, time: Duration) -> Result<PollFlags, Errno> {
    let time = Timespec::try_from(time).map_err(|_| Errno::INVAL)?;
    let mut polled = [PollFd::new(fd, events)];
    match poll(&mut polled, Some(&time)) {
        Ok(_) => Ok(polled.first().map_or(PollFlags::empty(), PollFd::revents)),
        Err(Errno::INTR) => Ok(PollFlags::empty()),
        Err(error) => Err(error),
    }
}
