//! The serial port: 8 data bits, no parity, one stop bit, no flow control, bytes as they are, at any speed.
//!
//! Opening waits for no carrier and keeps other programs away. No call waits longer than its timeout. A device that
//! has disappeared is an error at the next use.
//!
//! The only part of the library that calls the operating system. `system` is that system: its functions made safe,
//! with errors as `Cause`s.

#[cfg_attr(windows, path = "port/windows.rs")]
#[cfg_attr(unix, path = "port/unix.rs")]
mod system;
mod text;

use core::ffi::{CStr, c_int, c_long, c_ulong};
use core::mem::MaybeUninit;

use text::Text;

/// Bytes of an error's text, the terminating zero included.
const TEXT_MAX: usize = 320;
/// Bytes of a device's name in it; of a longer name the end is shown.
const NAME_MAX: usize = 240;

/// A serial port. All zero is a closed one.
#[derive(Debug, zerocopy::FromBytes)]
#[repr(C)]
pub struct Port {
    /// The file descriptor, or the `HANDLE`, of which Windows uses 32 bits.
    handle: c_int,
    is_open: c_int,
    has_failed: c_int,
    /// Where in `text` the error begins, behind the device's name.
    name_length: c_int,
    text: [u8; TEXT_MAX],
}

/// How a port is opened and closed.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Speed in baud.
    pub baud: c_ulong,
    /// The level of DTR after opening; `None`: what opening makes of it, which is on.
    pub dtr: Option<bool>,
    /// The level of RTS likewise.
    pub rts: Option<bool>,
    /// Closing leaves DTR and RTS as they are.
    pub keep_lines: bool,
}

impl Settings {
    /// Those of a link at a speed: no control of the lines.
    #[must_use]
    pub const fn at(baud: c_ulong) -> Self {
        Self { baud, dtr: None, rts: None, keep_lines: false }
    }
}

/// An output of the port besides the data.
#[derive(Clone, Copy, Debug)]
pub enum Line {
    /// Data terminal ready.
    Dtr,
    /// Request to send.
    Rts,
}

/// It failed; [`Port::error`] says why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Failed;

/// What went wrong.
enum Cause {
    System(system::Error),
    InUse,
    NoSerialPort,
    NotTaken(c_ulong),
    NoLines,
    Disconnected,
    NotOpen,
    TimedOut,
}

impl Port {
    /// A closed port.
    #[must_use]
    pub const fn new() -> Self {
        Self { handle: 0, is_open: 0, has_failed: 0, name_length: 0, text: [0; TEXT_MAX] }
    }

    /// Opens and sets up a serial port or pseudo-terminal. What it received before is discarded.
    ///
    /// # Errors
    ///
    /// [`Failed`] when that was not possible; the port is closed then.
    pub fn open(&mut self, device: &CStr, settings: &Settings) -> Result<(), Failed> {
        self.close();
        self.has_failed = 0;
        self.set_name(device.to_bytes());
        match system::open(device, settings) {
            Ok(handle) => {
                (self.handle, self.is_open) = (handle, 1);
                Ok(())
            }
            Err(cause) => Err(self.fail(&cause)),
        }
    }

    /// Closes it, if it is open. What was written is still sent.
    pub fn close(&mut self) {
        if self.is_open() {
            system::close(self.handle);
        }
        (self.handle, self.is_open) = (0, 0);
    }

    /// Whether it is open.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.is_open != 0
    }

    /// The file descriptor, or what Windows calls a `HANDLE`; `None` when it is closed.
    #[must_use]
    pub const fn handle(&self) -> Option<c_int> {
        if self.is_open() { Some(self.handle) } else { None }
    }

    /// Reads what has come. When nothing has, waits for it up to `timeout_ms` milliseconds (for ever if negative), or
    /// until a signal was handled; then no bytes are returned.
    ///
    /// # Errors
    ///
    /// [`Failed`] when the device is gone or the port is closed. What was received before that is read first.
    pub fn read<'a>(&mut self, out: &'a mut [MaybeUninit<u8>], timeout_ms: c_long) -> Result<&'a [u8], Failed> {
        if out.is_empty() {
            return self.run(|_| Ok(&[][..]));
        }
        self.run(|handle| system::read(handle, out, timeout_ms))
    }

    /// Writes all bytes, waiting for room up to `timeout_ms` milliseconds in all (for ever if negative). Returns how
    /// many were written: fewer when the time was over first. Signals don't end it.
    ///
    /// # Errors
    ///
    /// [`Failed`] when the device is gone or the port is closed.
    pub fn write(&mut self, bytes: &[u8], timeout_ms: c_long) -> Result<usize, Failed> {
        self.run(|handle| system::write(handle, bytes, timeout_ms))
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
    /// [`Failed`] when the device is gone or the port is closed.
    pub fn drain(&mut self) -> Result<(), Failed> {
        self.run(system::drain)
    }

    /// Discards what was received and not read.
    ///
    /// # Errors
    ///
    /// [`Failed`] when the device is gone or the port is closed.
    pub fn discard(&mut self) -> Result<(), Failed> {
        self.run(system::discard)
    }

    /// Sets a line's level.
    ///
    /// # Errors
    ///
    /// [`Failed`] when the device has no such line or is gone, or the port is closed.
    pub fn set_line(&mut self, line: Line, on: bool) -> Result<(), Failed> {
        self.run(|handle| system::set_line(handle, line, on))
    }

    /// The device's name and what went wrong last, such as `/dev/ttyUSB0: in use by another program`; empty when
    /// nothing did since it was opened.
    #[must_use]
    pub fn error(&self) -> &CStr {
        if self.has_failed == 0 { c"" } else { CStr::from_bytes_until_nul(&self.text).unwrap_or_default() }
    }

    /// Does something with the open device, and notes why it failed.
    fn run<T>(&mut self, operation: impl FnOnce(c_int) -> Result<T, Cause>) -> Result<T, Failed> {
        let result = self.handle().ok_or(Cause::NotOpen).and_then(operation);
        result.map_err(|cause| self.fail(&cause))
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

    fn fail(&mut self, cause: &Cause) -> Failed {
        self.has_failed = 1;
        let mut text = Text::new(&mut self.text, usize::try_from(self.name_length).unwrap_or_default());
        if text.length() > 0 {
            text.put(b": ");
        }
        match cause {
            Cause::System(error) => text.put(system::text(*error, &mut [0; 128])),
            Cause::InUse => text.put(b"in use by another program"),
            Cause::NoSerialPort => text.put(b"not a serial port"),
            Cause::NotTaken(baud) => {
                text.put(b"can't be set to ");
                text.put_number(*baud);
                text.put(b" baud 8N1");
            }
            Cause::NoLines => text.put(b"has no such line"),
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

/// Whether a speed is near enough to another: a link bears a difference of 2 %, and hardware divides its clock.
const fn is_near(speed: c_ulong, asked: c_ulong) -> bool {
    speed.abs_diff(asked) <= asked / 50
}

#[cfg(all(test, unix))]
mod tests {
    use super::{Failed, Port, Settings, TEXT_MAX};
    use core::ffi::CStr;

    #[test]
    fn errors_name_the_device() {
        let mut port = Port::new();
        assert_eq!(port.error(), c"");
        assert_eq!(port.send(b"$S", 0), Err(Failed));
        assert_eq!(port.error(), c"not open");
        for (device, error) in [
            (c"/nonexistent/tty", c"/nonexistent/tty: No such file or directory"),
            (c"/dev/null", c"/dev/null: not a serial port"),
            (c"/", c"/: not a serial port"),
        ] {
            assert_eq!(port.open(device, &Settings::at(9600)), Err(Failed));
            assert_eq!(port.error(), error);
            assert!(!port.is_open());
        }
    }

    #[test]
    fn of_a_long_name_the_end_is_shown() {
        let mut port = Port::new();
        let mut name = [b'x'; 2 * TEXT_MAX];
        if let Some(end) = name.last_chunk_mut() {
            *end = *b"/tty\0";
        }
        let name = CStr::from_bytes_with_nul(&name).unwrap_or_default();
        assert_eq!(port.open(name, &Settings::at(9600)), Err(Failed));
        let text = port.error().to_str().unwrap_or_default();
        assert!(text.starts_with("...xx") && text.ends_with("x/tty: File name too long"), "{text}");
    }
}
