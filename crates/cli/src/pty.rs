//! A pseudo-terminal: a device that this program plays.

use std::fs;
use std::io;
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};

use rustix::event::PollFlags;
use rustix::fs::{Mode, OFlags, fcntl_setfl, open};
use rustix::io::Errno;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use crate::status::Failure;
use crate::wait::wait;

/// The far end of a device which other programs open by its path.
pub(crate) struct Pty {
    fd: OwnedFd,
    path: PathBuf,
    link: Option<PathBuf>,
}

/// What came from the other program.
pub(crate) enum Input {
    /// So many bytes, 0 when none came in time or a signal did.
    Bytes(usize),
    /// No program has the device open.
    Nobody,
}

impl Pty {
    /// Makes one, and a symbolic link to it where asked for, which is removed with it.
    pub(crate) fn new(link: Option<&Path>) -> Result<Self, Failure> {
        let (fd, path) = Self::open().map_err(|error| Failure::of_file("no pseudo-terminal", &error.into()))?;
        if let Some(link) = link {
            make_link(&path, link).map_err(|error| Failure::of_file(link.display(), &error))?;
        }
        Ok(Self { fd, path, link: link.map(Path::to_owned) })
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
    pub(crate) fn path(&self) -> &Path {
        self.link.as_deref().unwrap_or(&self.path)
    }

    /// Reads what has come, waiting for at most so many milliseconds.
    pub(crate) fn read(&self, out: &mut [u8], timeout_ms: u32) -> Result<Input, Failure> {
        if self.wait(timeout_ms)?.contains(PollFlags::IN) {
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
    fn is_open(&self) -> Result<bool, Failure> {
        Ok(!self.wait(0)?.contains(PollFlags::HUP))
    }

    fn wait(&self, timeout_ms: u32) -> Result<PollFlags, Failure> {
        wait(&self.fd, timeout_ms).map_err(|error| self.failure(error))
    }

    /// Writes what there is room for. A line does not wait for who reads too slowly, or not at all.
    pub(crate) fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
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

impl Drop for Pty {
    fn drop(&mut self) {
        if let Some(link) = &self.link
            && fs::read_link(link).is_ok_and(|target| target == self.path)
        {
            let _ = fs::remove_file(link);
        }
    }
}

/// Replaces what an earlier run may have left, and nothing else.
fn make_link(path: &Path, link: &Path) -> io::Result<()> {
    if fs::read_link(link).is_ok_and(|target| target.starts_with("/dev/pts")) {
        fs::remove_file(link)?;
    }
    std::os::unix::fs::symlink(path, link)
}
