//! The serial port, on Unix: a terminal device as the deltarobot link needs it.
//!
//! 8 data bits, no parity, one stop bit, no flow control, bytes as they are, at 115200 baud or another standard speed.
//! It opens without waiting for a carrier and keeps other programs away. Nothing here waits longer than it was told to,
//! and a device that has disappeared is an error at the next use.
//!
//! Not in firmware builds, nor anywhere else without the feature `serial`: this is all of the library that calls the
//! operating system.

mod speed;
mod system;
mod text;

use core::ffi::{CStr, c_char, c_int, c_long, c_short, c_ulong};
use core::mem::{MaybeUninit, offset_of, size_of};

use text::Text;

/// The speed of the deltarobot link in baud (specification, section "Serial").
pub const BAUD: c_ulong = 115_200;

/// Bytes of a text about an error, the terminating zero among them.
pub const TEXT_MAX: usize = 320;
/// How much of a device's name is told; of a longer one, the end.
const NAME_MAX: usize = 240;

/// A serial port. All zero is one that is closed.
///
/// Its fields are private, but `fd`, while it is open, can be given to poll(2) or select(2). It is set to `O_NONBLOCK`.
#[derive(Debug)]
#[repr(C)]
pub struct Port {
    /// The file descriptor.
    fd: c_int,
    is_open: c_int,
    has_failed: c_int,
    /// The device's name, and behind it what went wrong last.
    name_length: c_int,
    text: [c_char; TEXT_MAX],
}

// The layout of C's struct; C tests assert the same numbers.
const _: () = {
    const INT: usize = size_of::<c_int>();
    assert!(offset_of!(Port, fd) == 0 && offset_of!(Port, is_open) == INT && offset_of!(Port, has_failed) == 2 * INT);
    assert!(offset_of!(Port, name_length) == 3 * INT && offset_of!(Port, text) == 4 * INT);
    assert!(size_of::<Port>() == 4 * INT + TEXT_MAX && align_of::<Port>() == align_of::<c_int>());
};

/// It failed; [`Port::error`] says why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Failed;

/// What went wrong.
enum Cause {
    System(system::Errno),
    InUse,
    NoSerialPort,
    NoSuchSpeed(c_ulong),
    NotTaken(c_ulong),
    Disconnected,
    NotOpen,
    TimedOut,
}

impl Port {
    /// A port that is closed.
    #[must_use]
    pub const fn new() -> Self {
        Self { fd: -1, is_open: 0, has_failed: 0, name_length: 0, text: [0; TEXT_MAX] }
    }

    /// Opens and sets up a device, which has to be a terminal: a serial port or a pseudo-terminal. What it received
    /// before is thrown away. The speed is in baud, 0 stands for [`BAUD`].
    ///
    /// # Errors
    ///
    /// [`Failed`] when that was not possible; the port is closed then.
    pub fn open(&mut self, device: &CStr, baud: c_ulong) -> Result<(), Failed> {
        self.close();
        self.has_failed = 0;
        self.set_name(device.to_bytes());
        self.try_to_open(device, if baud == 0 { BAUD } else { baud }).map_err(|cause| self.fail(&cause))
    }

    fn try_to_open(&mut self, device: &CStr, baud: c_ulong) -> Result<(), Cause> {
        let speed = speed::of(baud).ok_or(Cause::NoSuchSpeed(baud))?;
        let fd = system::open(device).map_err(|error| match error {
            libc::EBUSY => Cause::InUse,
            // A directory or a program is no serial port, whatever may be wrong with it besides.
            libc::EISDIR | libc::ETXTBSY => Cause::NoSerialPort,
            _ => Cause::System(error),
        })?;
        if let Err(cause) = set_up(fd, baud, speed) {
            system::close(fd);
            return Err(cause);
        }
        (self.fd, self.is_open) = (fd, 1);
        Ok(())
    }

    /// Closes it, if it is open. What was written is still sent.
    pub fn close(&mut self) {
        if self.is_open != 0 {
            system::release(self.fd);
            system::close(self.fd);
        }
        (self.fd, self.is_open) = (-1, 0);
    }

    /// Whether it is open.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.is_open != 0
    }

    /// Reads what has come. When nothing has, waits for it up to so many milliseconds (for ever if negative), or until
    /// a signal was handled; then no bytes are returned.
    ///
    /// # Errors
    ///
    /// [`Failed`] when the device is gone or it is not open. What was received before that is still read.
    pub fn read<'a>(&mut self, out: &'a mut [MaybeUninit<u8>], timeout_ms: c_long) -> Result<&'a [u8], Failed> {
        self.try_to_read(out, timeout_ms).map_err(|cause| self.fail(&cause))
    }

    fn try_to_read<'a>(&self, out: &'a mut [MaybeUninit<u8>], timeout_ms: c_long) -> Result<&'a [u8], Cause> {
        let fd = self.descriptor()?;
        if out.is_empty() || !wait(fd, libc::POLLIN, Deadline::after(timeout_ms).left())? {
            return Ok(&[]);
        }
        match system::read(fd, out) {
            // There was something to read, so nothing is the end.
            Ok([]) => Err(Cause::Disconnected),
            Ok(bytes) => Ok(bytes),
            Err(libc::EAGAIN | libc::EINTR) => Ok(&[]),
            Err(error) => Err(cause_of(error)),
        }
    }

    /// Writes all bytes, waiting for room up to so many milliseconds in all (for ever if negative), and tells how many
    /// were written: fewer when the time was over first. Signals don't end it.
    ///
    /// # Errors
    ///
    /// [`Failed`] when the device is gone or it is not open.
    pub fn write(&mut self, bytes: &[u8], timeout_ms: c_long) -> Result<usize, Failed> {
        self.try_to_write(bytes, timeout_ms).map_err(|cause| self.fail(&cause))
    }

    fn try_to_write(&self, bytes: &[u8], timeout_ms: c_long) -> Result<usize, Cause> {
        let fd = self.descriptor()?;
        let deadline = Deadline::after(timeout_ms);
        let mut rest = bytes;
        while !rest.is_empty() {
            match system::write(fd, rest) {
                Ok(written @ 1..) => rest = rest.get(written..).unwrap_or_default(),
                Err(libc::EINTR) => (),
                // No device should take nothing without saying so, but none shall keep us here beyond the deadline.
                Ok(0) | Err(libc::EAGAIN) => {
                    let left = deadline.left();
                    if left == 0 || (!wait(fd, libc::POLLOUT, left)? && deadline.left() == 0) {
                        break;
                    }
                }
                Err(error) => return Err(cause_of(error)),
            }
        }
        Ok(bytes.len().wrapping_sub(rest.len()))
    }

    /// Like [`write`](Self::write), but it is a failure when not all bytes were written in time.
    ///
    /// # Errors
    ///
    /// [`Failed`] for this reason too.
    pub fn send(&mut self, bytes: &[u8], timeout_ms: c_long) -> Result<(), Failed> {
        let written = self.write(bytes, timeout_ms)?;
        if written == bytes.len() { Ok(()) } else { Err(self.fail(&Cause::TimedOut)) }
    }

    /// Waits until all that was written was sent.
    ///
    /// # Errors
    ///
    /// [`Failed`] when the device is gone or it is not open.
    pub fn drain(&mut self) -> Result<(), Failed> {
        let drained = self.descriptor().and_then(|fd| system::drain(fd).map_err(cause_of));
        drained.map_err(|cause| self.fail(&cause))
    }

    /// Throws away what was received and not read.
    ///
    /// # Errors
    ///
    /// [`Failed`] when the device is gone or it is not open.
    pub fn discard(&mut self) -> Result<(), Failed> {
        let discarded = self.descriptor().and_then(|fd| system::discard(fd).map_err(cause_of));
        discarded.map_err(|cause| self.fail(&cause))
    }

    /// The device's name and what went wrong with it last, such as `/dev/ttyUSB0: in use by another program`; empty
    /// when nothing did since it was opened.
    #[must_use]
    pub fn error(&self) -> &CStr {
        if self.has_failed == 0 { c"" } else { text::string(&self.text) }
    }

    fn descriptor(&self) -> Result<system::Descriptor, Cause> {
        if self.is_open() { Ok(self.fd) } else { Err(Cause::NotOpen) }
    }

    fn set_name(&mut self, name: &[u8]) {
        let mut text = Text::new(&mut self.text, 0);
        let hidden = name.len().saturating_sub(NAME_MAX);
        if hidden > 0 {
            text.put(b"...");
        }
        text.put(name.get(hidden..).unwrap_or_default());
        // Below TEXT_MAX.
        self.name_length = c_int::try_from(text.length()).unwrap_or_default();
    }

    /// Notes what went wrong.
    fn fail(&mut self, cause: &Cause) -> Failed {
        self.has_failed = 1;
        let mut text = Text::new(&mut self.text, usize::try_from(self.name_length).unwrap_or_default());
        if text.length() > 0 {
            text.put(b": ");
        }
        match cause {
            Cause::System(error) => text.put(system::text(*error, &mut [0; 64])),
            Cause::InUse => text.put(b"in use by another program"),
            Cause::NoSerialPort => text.put(b"not a serial port"),
            Cause::NoSuchSpeed(baud) => {
                text.put_number(*baud);
                text.put(b" baud is no standard speed");
            }
            Cause::NotTaken(baud) => {
                text.put(b"can't be set to ");
                text.put_number(*baud);
                text.put(b" baud 8N1");
            }
            Cause::Disconnected => text.put(b"disconnected"),
            Cause::NotOpen => text.put(b"not open"),
            Cause::TimedOut => text.put(b"no bytes were taken in time"),
        }
        Failed
    }
}

impl Default for Port {
    fn default() -> Self {
        Self::new()
    }
}

/// Claims a device before anything is changed about it: another program may be using it.
fn set_up(fd: system::Descriptor, baud: c_ulong, speed: libc::speed_t) -> Result<(), Cause> {
    let before = system::settings(fd).map_err(|error| match error {
        libc::ENOTTY | libc::EINVAL | libc::ENODEV | libc::EOPNOTSUPP => Cause::NoSerialPort,
        _ => cause_of(error),
    })?;
    system::claim(fd).map_err(|error| if error == libc::EWOULDBLOCK { Cause::InUse } else { cause_of(error) })?;
    let mut settings = before;
    system::make_raw(&mut settings, speed);
    let taken =
        system::apply(fd, &settings).and_then(|()| system::settings(fd)).map(|now| system::are_alike(&settings, &now));
    match taken {
        Ok(true) => system::discard(fd).map_err(cause_of),
        Ok(false) | Err(libc::EINVAL) => Err(Cause::NotTaken(baud)),
        Err(error) => Err(cause_of(error)),
    }
    .inspect_err(|_| system::release(fd))
}

/// What an error of a device that was open means.
const fn cause_of(error: system::Errno) -> Cause {
    match error {
        libc::EIO | libc::ENXIO | libc::ENODEV | libc::EPIPE => Cause::Disconnected,
        _ => Cause::System(error),
    }
}

/// Waits for one of poll(2)'s events. Returns whether it came; not when the time is over or a signal was handled.
fn wait(fd: system::Descriptor, events: c_short, timeout_ms: c_int) -> Result<bool, Cause> {
    match system::wait(fd, events, timeout_ms) {
        Ok(0) | Err(libc::EINTR) => Ok(false),
        // Even if the device is gone: there may be something left to read.
        Ok(happened) if happened & events != 0 => Ok(true),
        Ok(_) => Err(Cause::Disconnected),
        Err(error) => Err(Cause::System(error)),
    }
}

/// When waiting has to end.
struct Deadline(Option<i64>);

impl Deadline {
    #[allow(clippy::useless_conversion, reason = "c_long has 32 bits elsewhere")]
    fn after(timeout_ms: c_long) -> Self {
        Self((timeout_ms >= 0).then(|| system::now().saturating_add(i64::from(timeout_ms))))
    }

    /// Milliseconds that are left, as poll(2) takes them.
    fn left(&self) -> c_int {
        self.0.map_or(-1, |end| c_int::try_from(end.saturating_sub(system::now()).max(0)).unwrap_or(c_int::MAX))
    }
}

#[cfg(test)]
mod tests {
    use super::{Failed, Port, TEXT_MAX};
    use core::ffi::CStr;

    #[test]
    fn errors_tell_the_device() {
        let mut port = Port::new();
        assert_eq!(port.error(), c"");
        assert_eq!(port.send(b"$S", 0), Err(Failed));
        assert_eq!(port.error(), c"not open");
        for (device, baud, error) in [
            (c"/nonexistent/tty", 0, c"/nonexistent/tty: No such file or directory"),
            (c"/dev/null", 9600, c"/dev/null: not a serial port"),
            (c"/", 0, c"/: not a serial port"),
            (c"/dev/tty", 12_345, c"/dev/tty: 12345 baud is no standard speed"),
        ] {
            assert_eq!(port.open(device, baud), Err(Failed));
            assert_eq!(port.error(), error);
            assert!(!port.is_open());
        }
    }

    #[test]
    fn of_a_long_name_the_end_is_told() {
        let mut port = Port::new();
        let mut name = [b'x'; 2 * TEXT_MAX];
        if let Some(end) = name.last_chunk_mut() {
            *end = *b"/tty\0";
        }
        let name = CStr::from_bytes_with_nul(&name).unwrap_or_default();
        assert_eq!(port.open(name, 1), Err(Failed));
        let text = port.error().to_str().unwrap_or_default();
        assert!(text.starts_with("...xx") && text.ends_with("x/tty: 1 baud is no standard speed"), "{text}");
    }
}
