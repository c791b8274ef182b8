//! A pseudo-terminal: a device that this program plays.

use std::fs;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rustix::event::PollFlags;
use rustix::fs::{Mode, OFlags, fcntl_setfl, open};
use rustix::io::Errno;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use crate::status::Failure;
use crate::tap::Note;
use crate::wait::wait;

/// The far end of a device which other programs open by its path.
pub struct Pty {
    fd: OwnedFd,
    path: PathBuf,
    link: Option<PathBuf>,
    /// Kept for its drop alone.
    note: Option<Note>,
}

/// What came from the other program.
pub enum Input {
    /// So many bytes, 0 when none came in time or a signal did.
    Bytes(usize),
    /// No program has the device open.
    Nobody,
}

impl Pty {
    /// Makes one, and a symbolic link to it where asked for, which is removed with it.
    pub fn new(link: Option<&Path>) -> Result<Self, Failure> {
        let (fd, path) = Self::open().map_err(|error| Failure::of_file("no pseudo-terminal", &error.into()))?;
        if let Some(link) = link {
            make_link(&path, link)?;
        }
        Ok(Self { fd, path, link: link.map(Path::to_owned), note: None })
    }

    /// Says which device it is the tap of.
    pub(crate) fn stands_before(mut self, device: &Path) -> Self {
        self.note = Note::leave(&self.path, device);
        self
    }

    fn open() -> Result<(OwnedFd, PathBuf), Errno> {
        let fd = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&fd)?;
        unlockpt(&fd)?;
        fcntl_setfl(&fd, OFlags::RDWR | OFlags::NONBLOCK)?;
        // Nothing is echoed, even before a program has set the device.
        let mut settings = tcgetattr(&fd)?;
        settings.make_raw();
        tcsetattr(&fd, OptionalActions::Now, &settings)?;
        let path = PathBuf::from(ptsname(&fd, Vec::new())?.to_string_lossy().into_owned());
        // Once opened and closed, it tells that nobody has it open; before, it does not.
        drop(open(&path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?);
        Ok((fd, path))
    }

    /// The device's path, by the link if there is one.
    pub fn path(&self) -> &Path {
        self.link.as_deref().unwrap_or(&self.path)
    }

    /// Reads what has come, waiting for at most so long.
    pub fn read(&self, out: &mut [u8], time: Duration) -> Result<Input, Failure> {
        if self.wait(time)?.contains(PollFlags::IN) {
            return match rustix::io::read(&self.fd, out) {
                Ok(0) | Err(Errno::IO) => Ok(Input::Nobody),
                Ok(count) => Ok(Input::Bytes(count)),
                Err(Errno::AGAIN | Errno::INTR) => Ok(Input::Bytes(0)),
                Err(error) => Err(self.failure(error)),
            };
        }
        Ok(if self.is_open()? { Input::Bytes(0) } else { Input::Nobody })
    }

    /// Whether a program has the device open.
    pub fn is_open(&self) -> Result<bool, Failure> {
        Ok(!self.wait(Duration::ZERO)?.contains(PollFlags::HUP))
    }

    fn wait(&self, time: Duration) -> Result<PollFlags, Failure> {
        wait(&self.fd, time).map_err(|error| self.failure(error))
    }

    /// Writes what there is room for. A line does not wait for who reads too slowly, or not at all.
    pub fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        if !self.is_open()? {
            return Ok(());
        }
        match rustix::io::write(&self.fd, bytes) {
            Ok(_) | Err(Errno::AGAIN | Errno::INTR | Errno::IO) => Ok(()),
            Err(error) => Err(self.failure(error)),
        }
    }

    fn failure(&self, error: Errno) -> Failure {
        Failure::of_file(self.path.display(), &error.into())
    }
}

impl AsFd for Pty {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.fd.as_fd()
    }
}

impl Drop for Pty {
    fn drop(&mut self) {
        if let Some(link) = &self.link
            && fs::read_link(link).is_ok_and(|target| target == self.path)
        {
            let _ = fs::remove_file(link);
        }
    }
}

/// Replaces what a run that was killed may have left, and nothing else: a link to a pseudo-terminal that is gone, or to
/// the number that this one has now.
fn make_link(path: &Path, link: &Path) -> Result<(), Failure> {
    if let Ok(target) = fs::read_link(link)
        && target.starts_with("/dev/pts")
    {
        if target != path && target.exists() {
            let name = target.display();
            return Err(Failure::of(link.display(), format!("in use by another program, whose device is {name}")));
        }
        fs::remove_file(link).map_err(|error| Failure::of_file(link.display(), &error))?;
    }
    symlink(path, link).map_err(|error| Failure::of_file(link.display(), &error))
}
