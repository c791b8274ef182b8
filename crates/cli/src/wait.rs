//! Waiting for what comes.

use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fd::BorrowedFd;
use rustix::io::Errno;

/// Waits until there is something to read, or nobody at the other end, for at most so long. What happened: nothing,
/// too, when a signal came.
pub fn wait(fd: BorrowedFd, time: Duration) -> Result<PollFlags, Errno> {
    wait_for(fd, PollFlags::IN, time)
}

/// The same for other events; an error at the other end is always one.
pub fn wait_for(fd: BorrowedFd, events: PollFlags, time: Duration) -> Result<PollFlags, Errno> {
    let mut polled = [PollFd::from_borrowed_fd(fd, events)];
    poll_all(&mut polled, time)?;
    let [polled] = polled;
    Ok(polled.revents())
}

/// Waits for one of several. Returns what happened at each.
pub fn wait_for_any<const COUNT: usize>(fds: [BorrowedFd; COUNT], time: Duration) -> Result<[PollFlags; COUNT], Errno> {
    let mut polled = fds.map(|fd| PollFd::from_borrowed_fd(fd, PollFlags::IN));
    poll_all(&mut polled, time)?;
    Ok(polled.map(|it| it.revents()))
}

fn poll_all(polled: &mut [PollFd], time: Duration) -> Result<(), Errno> {
    let time = Timespec::try_from(time).map_err(|_| Errno::INVAL)?;
    match poll(polled, Some(&time)) {
        Ok(_) | Err(Errno::INTR) => Ok(()),
        Err(error) => Err(error),
    }
}
