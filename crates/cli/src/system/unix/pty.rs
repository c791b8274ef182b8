//! A pseudo-terminal: a device that this program plays.

use std::ffi::OsStr;
use std::os::fd::{AsFd, BorrowedFd, FromRawFd, OwnedFd};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::time::Duration;
use std::{fs, io, ptr, thread};

use rustix::event::PollFlags;
use rustix::fs::{OFlags, fcntl_setfl};
use rustix::io::{Errno, FdFlags, fcntl_setfd};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use super::tap::Note;
use crate::far_end::{FarEnd, Input};
use crate::status::Failure;
use crate::wait::wait;

/// Makes one, and a symbolic link to it where asked for, which is removed with it. It says which device it is the tap
/// of, if it is one. `None` on systems that have none.
pub(crate) fn pseudo_terminal(link: Option<&Path>, tapped: Option<&Path>) -> Result<Option<Box<dyn FarEnd>>, Failure> {
    Pty::new(link, tapped).map(|pty| Some(Box::new(pty) as _))
}

struct Pty {
    fd: OwnedFd,
    path: PathBuf,
    link: Option<PathBuf>,
    _note: Option<Note>,
}

impl Pty {
    fn new(link: Option<&Path>, tapped: Option<&Path>) -> Result<Self, Failure> {
        let (fd, path) = Self::open().map_err(|error| Failure::of_file("no pseudo-terminal", &error))?;
        if let Some(link) = link {
            make_link(&path, link)?;
        }
        let note = tapped.and_then(|device| Note::leave(&path, device));
        Ok(Self { fd, path, link: link.map(Path::to_owned), _note: note })
    }

    #[expect(unsafe_code, reason = "rustix has no name of a pseudo-terminal in NetBSD")]
    fn open() -> io::Result<(OwnedFd, PathBuf)> {
        let (mut fd, mut device, mut name) = (-1, -1, [0_u8; libc::PATH_MAX as usize]);
        let (settings, size, path) = (ptr::null_mut(), ptr::null_mut(), name.as_mut_ptr().cast());
        // SAFETY: it writes two numbers and a path, for which there is room; without settings and size it sets none.
        if unsafe { libc::openpty(&raw mut fd, &raw mut device, path, settings, size) } != 0 {
            return Err(io::Error::last_os_error());
        }
        // SAFETY: both are open, and nobody else knows them.
        let (fd, device) = unsafe { (OwnedFd::from_raw_fd(fd), OwnedFd::from_raw_fd(device)) };
        fcntl_setfd(&fd, FdFlags::CLOEXEC)?;
        fcntl_setfd(&device, FdFlags::CLOEXEC)?;
        fcntl_setfl(&fd, OFlags::RDWR | OFlags::NONBLOCK)?;
        // Nothing is echoed, even before a program has set the device.
        let mut settings = tcgetattr(&device)?;
        settings.make_raw();
        tcsetattr(&device, OptionalActions::Now, &settings)?;
        let name = name.split(|&byte| byte == 0).next().unwrap_or_default();
        // Now that the device is closed, the other end reports that nobody has it open.
        Ok((fd, OsStr::from_bytes(name).into()))
    }

    fn wait(&self, time: Duration) -> Result<PollFlags, Failure> {
        wait(self.fd.as_fd(), time).map_err(|error| self.failure(error))
    }

    fn failure(&self, error: Errno) -> Failure {
        Failure::of_file(self.path.display(), &error.into())
    }
}

impl FarEnd for Pty {
    /// By the link if there is one.
    fn path(&self) -> &Path {
        self.link.as_deref().unwrap_or(&self.path)
    }

    fn read(&mut self, out: &mut [u8], time: Duration) -> Result<Input, Failure> {
        if self.wait(time)?.contains(PollFlags::IN) {
            return match rustix::io::read(&self.fd, out) {
                Ok(0) | Err(Errno::IO) => Ok(Input::Nobody),
                Ok(count) => Ok(Input::Bytes(count)),
                Err(Errno::AGAIN | Errno::INTR) => Ok(Input::Bytes(0)),
                Err(error) => Err(self.failure(error)),
            };
        }
        if self.is_open()? {
            return Ok(Input::Bytes(0));
        }
        // Waiting for somebody, which poll(2) does not do.
        thread::sleep(time);
        Ok(Input::Nobody)
    }

    fn is_open(&self) -> Result<bool, Failure> {
        Ok(!self.wait(Duration::ZERO)?.contains(PollFlags::HUP))
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        if !self.is_open()? {
            return Ok(());
        }
        match rustix::io::write(&self.fd, bytes) {
            Ok(_) | Err(Errno::AGAIN | Errno::INTR | Errno::IO) => Ok(()),
            Err(error) => Err(self.failure(error)),
        }
    }

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
