//! What `serial.h` opens, the only part of the library that calls the operating system. `system` is that system: its
//! functions made safe, with errors as `Cause`s.

#[cfg_attr(windows, path = "port/windows.rs")]
#[cfg_attr(unix, path = "port/unix.rs")]
pub(crate) mod system;

use core::ffi::{CStr, c_int, c_long, c_ulong};

use crate::serial::SerialSettings;

/// Bytes of an error's text, the terminating zero included.
const TEXT_MAX: usize = 320;
/// Bytes of a device's name in it; of a longer name the end is shown.
const NAME_MAX: usize = 240;

/// A serial port. All zero is a closed one.
#[derive(Debug, zerocopy::FromBytes)]
#[repr(C)]
pub(crate) struct Port {
    /// The file descriptor, or the `HANDLE`, of which Windows uses 32 bits.
    handle: c_int,
    is_open: c_int,
    has_failed: c_int,
    /// Where in `text` the error begins, behind the device's name.
    name_length: c_int,
    text: [u8; TEXT_MAX],
}

/// It failed; [`Port::error`] says why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Failed;

/// What went wrong.
pub(crate) enum Cause {
    System(system::Error),
    InUse,
    NoSerialPort,
    NotTaken(c_ulong),
    NoLines,
    Disconnected,
    TimedOut,
}

impl Port {
    /// Opens and sets up a serial port or pseudo-terminal, unless that fails. What it received before is discarded.
    pub(crate) fn open(&mut self, device: &CStr, settings: &SerialSettings) -> Result<(), Failed> {
        self.has_failed = 0;
        let name = device.to_bytes();
        let mut text = Text { buffer: &mut self.text, length: 0 };
        let hidden = name.len().saturating_sub(NAME_MAX);
        if hidden > 0 {
            text.put(b"...");
        }
        text.put(name.get(hidden..).unwrap_or_default());
        // Below TEXT_MAX.
        self.name_length = c_int::try_from(text.length).unwrap_or_default();
        self.handle = self.noted(system::open(device, settings))?;
        self.is_open = 1;
        Ok(())
    }

    /// Closes it, if it is open. What was written is still sent.
    pub(crate) fn close(&mut self) {
        if let Some(handle) = self.handle() {
            system::close(handle);
        }
        (self.handle, self.is_open) = (0, 0);
    }

    /// What it is to the system, if it is open.
    pub(crate) fn handle(&self) -> Option<c_int> {
        (self.is_open != 0).then_some(self.handle)
    }

    /// Does something with the device, which is open, and notes why it failed.
    pub(crate) fn run<T>(&mut self, operation: impl FnOnce(c_int) -> Result<T, Cause>) -> Result<T, Failed> {
        let result = operation(self.handle);
        self.noted(result)
    }

    /// Writes all bytes; it is a failure when that takes longer than `timeout_ms` milliseconds.
    pub(crate) fn send(&mut self, bytes: &[u8], timeout_ms: c_long) -> Result<(), Failed> {
        self.run(|handle| match system::write(handle, bytes, timeout_ms)? {
            written if written == bytes.len() => Ok(()),
            _ => Err(Cause::TimedOut),
        })
    }

    /// The device's name and what went wrong last, such as `/dev/ttyUSB0: in use by another program`; empty when
    /// nothing did since it was opened.
    pub(crate) fn error(&self) -> &CStr {
        if self.has_failed == 0 { c"" } else { CStr::from_bytes_until_nul(&self.text).unwrap_or_default() }
    }

    fn noted<T>(&mut self, result: Result<T, Cause>) -> Result<T, Failed> {
        let cause = match result {
            Ok(done) => return Ok(done),
            Err(cause) => cause,
        };
        self.has_failed = 1;
        let length = usize::try_from(self.name_length).unwrap_or_default();
        let mut text = Text { buffer: &mut self.text, length };
        if length > 0 {
            text.put(b": ");
        }
        match cause {
            Cause::System(error) => text.put(system::text(error, &mut [0; 128])),
            Cause::InUse => text.put(b"in use by another program"),
            Cause::NoSerialPort => text.put(b"not a serial port"),
            Cause::NotTaken(baud) => {
                text.put(b"can't be set to ");
                text.put_number(baud);
                text.put(b" baud 8N1");
            }
            Cause::NoLines => text.put(b"has no such line"),
            Cause::Disconnected => text.put(b"disconnected"),
            Cause::TimedOut => text.put(b"no bytes were taken in time"),
        }
        Err(Failed)
    }
}

/// Whether a speed is near enough to another: a link bears a difference of 2 %, and hardware divides its clock.
const fn is_near(speed: c_ulong, asked: c_ulong) -> bool {
    speed.abs_diff(asked) <= asked / 50
}

/// Writes one part behind the other, and a zero byte behind all. What does not fit is left out.
struct Text<'a> {
    buffer: &'a mut [u8],
    length: usize,
}

impl Text<'_> {
    fn put(&mut self, part: &[u8]) {
        // The last place is the zero byte's.
        for byte in part {
            let Some([place, next, ..]) = self.buffer.get_mut(self.length..) else { return };
            (*place, *next) = (*byte, 0);
            self.length = self.length.wrapping_add(1);
        }
    }

    fn put_number(&mut self, number: c_ulong) {
        if let rest @ 1.. = number / 10 {
            self.put_number(rest);
        }
        if let Ok(digit) = u8::try_from(number % 10) {
            self.put(&[b'0'.wrapping_add(digit)]);
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::{Failed, Port, SerialSettings, TEXT_MAX, Text};
    use core::ffi::CStr;
    use zerocopy::FromZeros;

    #[test]
    fn parts_stand_behind_each_other_and_what_does_not_fit_is_left_out() {
        let mut buffer = [0x7F; 12];
        let mut text = Text { buffer: &mut buffer, length: 0 };
        text.put(b"at ");
        text.put_number(0);
        text.put(b", ");
        text.put_number(1_234_567);
        assert_eq!(text.length, 11);
        assert_eq!(CStr::from_bytes_until_nul(&buffer), Ok(c"at 0, 12345"));
        for length in [4, 99] {
            Text { buffer: &mut buffer, length }.put(b"!");
            assert_eq!(CStr::from_bytes_until_nul(&buffer), Ok(c"at 0!"));
        }
    }

    #[test]
    fn errors_name_the_device() {
        let mut port = Port::new_zeroed();
        assert_eq!(port.error(), c"");
        for (device, error) in [
            (c"/nonexistent/tty", c"/nonexistent/tty: No such file or directory"),
            (c"/dev/null", c"/dev/null: not a serial port"),
            (c"/", c"/: not a serial port"),
        ] {
            assert_eq!(port.open(device, &SerialSettings { baud: 9600, ..SerialSettings::default() }), Err(Failed));
            assert_eq!((port.error(), port.handle()), (error, None));
        }
    }

    #[test]
    fn of_a_long_name_the_end_is_shown() {
        let mut port = Port::new_zeroed();
        let mut name = [b'x'; 2 * TEXT_MAX];
        if let Some(end) = name.last_chunk_mut() {
            *end = *b"/tty\0";
        }
        let name = CStr::from_bytes_with_nul(&name).unwrap_or_default();
        assert_eq!(port.open(name, &SerialSettings { baud: 9600, ..SerialSettings::default() }), Err(Failed));
        let text = port.error().to_str().unwrap_or_default();
        assert!(text.starts_with("...xx") && text.ends_with("x/tty: File name too long"), "{text}");
    }
}
