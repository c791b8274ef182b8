//! COM ports.

use std::fs::OpenOptions;
use std::io::{self, ErrorKind};
use std::net::TcpStream;
use std::os::windows::fs::OpenOptionsExt;
use std::os::windows::io::OwnedHandle;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use rustix::fd::{AsFd, BorrowedFd};
use serial2::SerialPort;
use serial2::os::windows::CommTimeouts;

use super::socket::{pair, pass_on};
use crate::port::{AtClose, Cause, Level, PortOptions};

/// `FILE_FLAG_OVERLAPPED`: reading keeps nobody from writing.
const OVERLAPPED: u32 = 0x4000_0000;
const ERROR_ACCESS_DENIED: i32 = 5;
const ERROR_SHARING_VIOLATION: i32 = 32;

/// In milliseconds. Reading ends with a pause of a millisecond, or after so many, which is as long as closing the port
/// may take. (The combination of timeouts that ends it with the first byte is not known in wine.)
const TIMEOUTS: CommTimeouts = CommTimeouts {
    read_interval_timeout: 1,
    read_total_timeout_multiplier: 0,
    read_total_timeout_constant: 20,
    write_total_timeout_multiplier: 0,
    write_total_timeout_constant: 100,
};

/// One that is open, for this program alone.
pub(crate) struct Line {
    port: Arc<SerialPort>,
    received: TcpStream,
    is_closed: Arc<AtomicBool>,
    reader: Option<JoinHandle<()>>,
}

impl Line {
    /// Opens a port and sets it to 8 data bits, no parity, one stop bit, no flow control. What it received before is
    /// thrown away.
    pub(crate) fn open(path: &Path, options: &PortOptions) -> Result<Self, Cause> {
        if options.at_close == Some(AtClose::Keep) {
            return Err(Cause::NotUsable("Windows lowers DTR and RTS when a port is closed".into()));
        }
        let mut open = OpenOptions::new();
        let open = open.read(true).write(true).share_mode(0).custom_flags(OVERLAPPED);
        let file = open.open(device(path)).map_err(|error| match error.raw_os_error() {
            Some(ERROR_ACCESS_DENIED | ERROR_SHARING_VIOLATION) => Cause::InUse,
            _ => Cause::System(error),
        })?;
        let mut port = SerialPort::from(OwnedHandle::from(file));
        set(&mut port, options)?;
        let port = Arc::new(port);
        let (received, far) = pair().map_err(Cause::System)?;
        let is_closed = Arc::new(AtomicBool::new(false));
        let (read_port, is_over) = (Arc::clone(&port), Arc::clone(&is_closed));
        let read = move |room: &mut [u8]| match read_port.read(room) {
            _ if is_over.load(Ordering::Relaxed) => Ok(Some(0)),
            Err(error) if error.kind() == ErrorKind::TimedOut => Ok(None),
            result => result.map(Some),
        };
        let reader = Some(pass_on("port", far, read).map_err(Cause::System)?);
        Ok(Self { port, received, is_closed, reader })
    }

    /// What can be polled and read.
    pub(crate) fn as_fd(&self) -> BorrowedFd<'_> {
        self.received.as_fd()
    }

    /// Writes what there is room for.
    pub(crate) fn write(&self, bytes: &[u8]) -> io::Result<usize> {
        match self.port.write(bytes) {
            Err(error) if error.kind() == ErrorKind::TimedOut => Ok(0),
            result => result,
        }
    }

    /// Waits until all was sent.
    pub(crate) fn drain(&self) -> io::Result<()> {
        self.port.flush()
    }
}

/// The port is closed when its reader has ended, too.
impl Drop for Line {
    fn drop(&mut self) {
        self.is_closed.store(true, Ordering::Relaxed);
        // It may wait for room.
        let _ = self.received.shutdown(std::net::Shutdown::Both);
        let _ = self.reader.take().map(JoinHandle::join);
    }
}

fn set(port: &mut SerialPort, options: &PortOptions) -> Result<(), Cause> {
    let baud = options.baud;
    port.set_windows_timeouts(&TIMEOUTS).map_err(|_| Cause::NoSerialPort)?;
    let mut settings = port.get_configuration().map_err(|_| Cause::NoSerialPort)?;
    settings.set_raw();
    settings.set_baud_rate(baud).map_err(|_| Cause::NotTaken(baud))?;
    // What drivers say of a speed that they don't have differs.
    port.set_configuration(&settings).map_err(|_| Cause::NotTaken(baud))?;
    let taken = port.get_configuration().and_then(|taken| taken.get_baud_rate())?;
    if taken.abs_diff(baud) > baud / 40 {
        return Err(Cause::NotTaken(baud));
    }
    // Setting the port has lowered both lines, which opening raises on other systems.
    let is_on = |level: Option<Level>| level.is_none_or(Level::is_on);
    for (name, level, result) in
        [("DTR", options.dtr, port.set_dtr(is_on(options.dtr))), ("RTS", options.rts, port.set_rts(is_on(options.rts)))]
    {
        if level.is_some() && result.is_err() {
            return Err(Cause::NoLine(name));
        }
    }
    Ok(port.discard_input_buffer()?)
}

/// Ports beyond COM9 are found only among the devices.
fn device(path: &Path) -> PathBuf {
    if path.components().count() > 1 { path.to_owned() } else { Path::new(r"\\.\").join(path) }
}

/// Whether a path names a port, as opposed to a file or a stream.
pub(crate) fn is_device(path: &Path) -> bool {
    let Some(name) = path.to_str() else { return false };
    let name = name.strip_prefix(r"\\.\").unwrap_or(name);
    let is_com = name.get(..3).is_some_and(|start| start.eq_ignore_ascii_case("COM"));
    is_com && name.get(3..).is_some_and(|number| number.parse::<u16>().is_ok())
}

/// Whether silence within a frame comes from its sender alone, which is not known of any port.
pub(crate) const fn is_direct(_: &Path) -> bool {
    false
}
