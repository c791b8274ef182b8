//! A serial port or a pseudo-terminal.

use std::fs;
use std::io;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use rustix::fs::{FlockOperation, Mode, OFlags, flock, open};
use rustix::io::{Errno, retry_on_intr};
use rustix::termios::{
    ControlModes, InputModes, OptionalActions, QueueSelector, SpecialCodeIndex, Termios, ioctl_tiocexcl,
    ioctl_tiocnxcl, tcdrain, tcflush, tcgetattr, tcgetsid, tcsetattr,
};
use serial2::SerialPort;

use crate::port::{AtClose, Cause, PortOptions};

/// One that is open, for this program alone.
pub(crate) struct Line(SerialPort);

impl Line {
    /// Opens a device and sets it to 8 data bits, no parity, one stop bit, no flow control. Nothing is changed about
    /// one that is in use. What it received before is thrown away.
    pub(crate) fn open(path: &Path, options: &PortOptions) -> Result<Self, Cause> {
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        let fd = open(path, flags, Mode::empty()).map_err(|error| match error {
            Errno::BUSY => Cause::InUse,
            // A directory or a program is no serial port, whatever may be wrong with it besides.
            Errno::ISDIR | Errno::TXTBSY => Cause::NoSerialPort,
            Errno::ACCESS => not_allowed(path),
            _ => Cause::System(error.into()),
        })?;
        let before = tcgetattr(&fd).map_err(|error| match error {
            Errno::NOTTY | Errno::INVAL | Errno::NODEV | Errno::OPNOTSUPP => Cause::NoSerialPort,
            _ => error.into(),
        })?;
        // Ctrl-C would be a byte like any other.
        if tcgetsid(&fd).is_ok() {
            return Err(Cause::NotUsable("the terminal that this program runs in".into()));
        }
        flock(&fd, FlockOperation::NonBlockingLockExclusive).map_err(|error| match error {
            Errno::WOULDBLOCK => Cause::InUse,
            _ => error.into(),
        })?;
        let line = Self(fd.into());
        set(&line.0, before, options)?;
        Ok(line)
    }

    /// What can be polled and read.
    pub(crate) fn as_fd(&self) -> BorrowedFd<'_> {
        self.0.as_fd()
    }

    /// Writes what there is room for.
    pub(crate) fn write(&self, bytes: &[u8]) -> io::Result<usize> {
        Ok(rustix::io::write(&self.0, bytes)?)
    }

    /// Waits until all was sent.
    pub(crate) fn drain(&self) -> io::Result<()> {
        Ok(retry_on_intr(|| tcdrain(&self.0))?)
    }
}

/// Lets others in.
impl Drop for Line {
    fn drop(&mut self) {
        let _ = ioctl_tiocnxcl(&self.0);
        let _ = flock(&self.0, FlockOperation::Unlock);
    }
}

fn set(port: &SerialPort, mut settings: Termios, options: &PortOptions) -> Result<(), Cause> {
    // A pseudo-terminal would stay closed to others if this program were killed, for as long as its other end is open.
    if has_modem_lines(port) {
        ioctl_tiocexcl(port)?;
    }
    let baud = options.baud;
    settings.make_raw();
    settings.input_modes &= !(InputModes::INPCK | InputModes::IXOFF | InputModes::IXANY);
    settings.control_modes &= !(ControlModes::CSTOPB | ControlModes::CRTSCTS);
    settings.control_modes |= ControlModes::CLOCAL | ControlModes::CREAD;
    match options.at_close {
        Some(AtClose::Drop) => settings.control_modes |= ControlModes::HUPCL,
        Some(AtClose::Keep) => settings.control_modes &= !ControlModes::HUPCL,
        None => (),
    }
    (settings.special_codes[SpecialCodeIndex::VMIN], settings.special_codes[SpecialCodeIndex::VTIME]) = (1, 0);
    settings.set_speed(baud).map_err(|_| Cause::NotTaken(baud))?;
    tcsetattr(port, OptionalActions::Now, &settings).map_err(|error| match error {
        Errno::INVAL => Cause::NotTaken(baud),
        _ => error.into(),
    })?;
    // That is successful when the device took one of the settings. It may say which speed it really has.
    let taken = tcgetattr(port)?;
    let lines = ControlModes::CSIZE | ControlModes::CSTOPB | ControlModes::PARENB | ControlModes::CRTSCTS;
    let is_near = taken.output_speed().abs_diff(baud) <= baud / 40;
    if taken.control_modes & lines != settings.control_modes & lines || !is_near {
        return Err(Cause::NotTaken(baud));
    }
    for (name, result) in [
        ("DTR", options.dtr.map(|level| port.set_dtr(level.is_on()))),
        ("RTS", options.rts.map(|level| port.set_rts(level.is_on()))),
    ] {
        if result.is_some_and(|result| result.is_err()) {
            return Err(Cause::NoLine(name));
        }
    }
    Ok(tcflush(port, QueueSelector::IFlush)?)
}

/// Whether it is more than a pseudo-terminal.
fn has_modem_lines(port: &SerialPort) -> bool {
    port.read_cts().is_ok()
}

/// Says who may use a device.
fn not_allowed(path: &Path) -> Cause {
    let group = group_of(path).map(|group| {
        format!("; members of the group {group} may use it (`sudo usermod -aG {group} $USER`, then log in again)")
    });
    Cause::NotUsable(format!("Permission denied{}", group.unwrap_or_default()))
}

/// The name of the group that may use a device.
fn group_of(path: &Path) -> Option<String> {
    let metadata = fs::metadata(path).ok().filter(|metadata| metadata.mode() & 0o060 == 0o060)?;
    let groups = fs::read_to_string("/etc/group").ok()?;
    groups.lines().find_map(|line| {
        let mut fields = line.split(':');
        let name = fields.next()?;
        (fields.nth(1)?.parse() == Ok(metadata.gid())).then(|| name.to_owned())
    })
}

/// Whether silence within a frame on this port comes from its sender alone: a UART of this machine, not a converter
/// that collects bytes, nor another program.
pub(crate) fn is_direct(path: &Path) -> bool {
    let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    ["ttyS", "ttyAMA", "ttymxc", "ttyO", "ttyTHS", "ttySAC", "ttyPS"].iter().any(|kind| name.starts_with(kind))
}
