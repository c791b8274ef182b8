//! Where a tap says which device it stands before, so that a program that uses it can reach that when the tap goes
//! away.

use std::env;
use std::fs::{self, File, OpenOptions};
use std::io::{Read, Write};
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use rustix::fs::{FlockOperation, OFlags, flock};
use rustix::process::geteuid;

/// A note that is there as long as its tap.
pub(super) struct Note {
    path: PathBuf,
    /// Locked as long as the tap lives, so that what a killed one has left is not believed.
    _file: File,
}

impl Note {
    /// Leaves one for a pseudo-terminal. `None` when there is no place for it.
    pub(super) fn leave(pty: &Path, device: &Path) -> Option<Self> {
        let path = place(pty)?;
        let device = fs::canonicalize(device).unwrap_or_else(|_| device.to_owned());
        let _ = fs::remove_file(&path);
        let mut file = OpenOptions::new().write(true).create_new(true).mode(0o600).open(&path).ok()?;
        flock(&file, FlockOperation::NonBlockingLockExclusive).ok()?;
        file.write_all(device.to_str()?.as_bytes()).ok()?;
        Some(Self { path, _file: file })
    }
}

impl Drop for Note {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// The device behind a pseudo-terminal that is the tap of the same user.
pub(crate) fn tapped_device(path: &Path) -> Option<PathBuf> {
    let flags = OFlags::NOFOLLOW | OFlags::NONBLOCK;
    let flags = i32::try_from(flags.bits()).ok()?;
    let path = place(&fs::canonicalize(path).ok()?)?;
    let mut file = OpenOptions::new().read(true).custom_flags(flags).open(path).ok()?;
    let is_ours = file.metadata().is_ok_and(|it| it.is_file() && it.uid() == geteuid().as_raw());
    if !is_ours || flock(&file, FlockOperation::NonBlockingLockShared).is_ok() {
        return None;
    }
    let mut device = String::new();
    file.read_to_string(&mut device).ok()?;
    Some(device.into())
}

fn place(pty: &Path) -> Option<PathBuf> {
    let number = pty.strip_prefix("/dev/pts").ok()?.to_str()?;
    let directory = env::var_os("XDG_RUNTIME_DIR").map_or_else(env::temp_dir, PathBuf::from);
    Some(directory.join(format!("deltarobot-tap-{number}-{}", geteuid().as_raw())))
}
