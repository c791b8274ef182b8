//! `libdeltarobot/serial.h`: the serial port, on Unix and Windows. Not in libraries for bare metal.
//!
//! ```c
//! struct dp_serial port;
//! if (dp_serial_open(&port, "/dev/ttyUSB0", DP_SERIAL_BAUD) == DP_RC_SUCCESS) {
//!     int got;
//!     dp_send(&msg, dp_serial_send, &port);
//!     while ((got = dp_serial_read(&port, in, sizeof in, 100)) > 0)
//!         dp_process(&ring, in, got);
//! }
//! if (*dp_serial_error(&port) != '\0')
//!     fprintf(stderr, "%s\n", dp_serial_error(&port));
//! dp_serial_close(&port);
//! ```

use core::ffi::{c_char, c_int, c_long, c_ulong, c_void};
use deltarobot_export::export;

use super::memory::{bytes_of, int, room_of, string_of};
use super::protocol::{DP_RC_ERROR_GENERIC, DP_RC_SUCCESS};
use crate::port::{Cause, Failed, Port, system};
use crate::state::{Room, state};

/// The system has reported an error: `dp_serial_error` says which.
pub const DP_RC_DEVICE: c_int = 7;
/// The speed of the deltarobot link in baud (specification, section "Serial").
pub const DP_SERIAL_BAUD: c_ulong = 115_200;
/// How long `dp_serial_send` waits for room, in milliseconds.
pub const DP_SERIAL_SEND_MS: c_long = 1000;
/// A line is asserted.
pub const DP_SERIAL_ON: c_int = 1;
/// A line is not asserted.
pub const DP_SERIAL_OFF: c_int = -1;

/// Words of a struct dp_serial.
pub const DP_SERIAL_WORDS: usize = 384 / size_of::<c_ulong>();

/// A serial port. All zero is a closed one.
#[derive(Debug)]
#[repr(C)]
pub struct Serial {
    opaque: [c_ulong; DP_SERIAL_WORDS],
}
state!(Serial: Port);

/// How a port is opened and closed. All zero is what `dp_serial_open` does.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct SerialSettings {
    /// Speed in baud, 0 for `DP_SERIAL_BAUD`.
    pub baud: c_ulong,
    /// DTR after opening: `DP_SERIAL_ON`, `DP_SERIAL_OFF`, or 0 for what opening makes of it, on. Ignored where there is
    /// no such line. Many boards reset when DTR or RTS rises. On Unix, opening raises both before they can be set to
    /// off: a board that shall not be reset has to be closed with `keep_lines` the time before.
    pub dtr: c_int,
    /// RTS after opening, likewise. Both change at once.
    pub rts: c_int,
    /// Not 0: closing leaves DTR and RTS as they are, for later programs too (`stty -hupcl`). Windows drops them.
    pub keep_lines: c_int,
}

/// Opens a serial port or pseudo-terminal: 8 data bits, no parity, one stop bit, no flow control, bytes as they are.
///
/// device is its name, such as `/dev/ttyUSB0` or, in Windows, `COM5`. baud is the speed, any that the hardware gets
/// near to (2 %), 0 for `DP_SERIAL_BAUD`. It waits for no carrier. As long as it is open, nobody else can open the
/// device by this function or, unless as root or if it is a pseudo-terminal, otherwise. What was received before is
/// discarded. An open port must be closed first: else its file descriptor is lost.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when that was not possible, or `DP_RC_ERROR_GENERIC` when serial or device
/// is NULL. Unless it succeeded, the port is closed.
///
/// ```c
/// if (dp_serial_open(&port, "/dev/ttyUSB0", DP_SERIAL_BAUD) != DP_RC_SUCCESS)
///     fprintf(stderr, "%s\n", dp_serial_error(&port));
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_open(serial: *mut Serial, device: *const c_char, baud: c_ulong) -> c_int {
    let settings = SerialSettings { baud, ..SerialSettings::default() };
    // SAFETY: the caller promises the same of these pointers.
    unsafe { dp_serial_open_with(serial, device, &raw const settings) }
}

/// Like `dp_serial_open`, with more settings. NULL stands for settings that are all zero.
///
/// ```c
/// struct dp_serial_settings settings = {0};
/// settings.baud = 250000;
/// settings.keep_lines = 1;
/// dp_serial_open_with(&port, "/dev/ttyACM0", &settings);
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_open_with(
    serial: *mut Serial,
    device: *const c_char,
    settings: *const SerialSettings,
) -> c_int {
    // SAFETY: serial is NULL or writable, what it held is overwritten; settings are NULL or whole.
    let (port, settings) = unsafe { (Serial::init(serial), settings.as_ref()) };
    // SAFETY: device is NULL or a string.
    let (Some(port), Some(device)) = (port, unsafe { string_of(device) }) else { return DP_RC_ERROR_GENERIC };
    let mut settings = settings.copied().unwrap_or_default();
    if settings.baud == 0 {
        settings.baud = DP_SERIAL_BAUD;
    }
    code(port.open(device, &settings))
}

/// Reads what has come, at most cap bytes. When nothing has, waits for it up to `timeout_ms` milliseconds (for ever if
/// negative), or until a signal was handled. serial was opened or is all zero, here and below.
///
/// Returns how many bytes were read, 0 when none came; -`DP_RC_DEVICE` when the device has disappeared (what it
/// received before that is read first); -`DP_RC_ERROR_GENERIC` when serial is NULL or closed, cap is negative, or buf
/// is NULL and cap is not 0.
///
/// ```c
/// int got = dp_serial_read(&port, in, sizeof in, 100);
/// if (got > 0)
///     dp_process(&ring, in, got);
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_read(
    serial: *mut Serial,
    buf: *mut c_void,
    cap: c_int,
    timeout_ms: c_long,
) -> c_int {
    // SAFETY: serial is NULL or whole, and buf NULL or writable for cap bytes.
    match unsafe { (opened(serial), room_of(buf, cap)) } {
        (Some(port), Some(out)) => count(port.run(|handle| system::read(handle, out, timeout_ms))),
        _ => -DP_RC_ERROR_GENERIC,
    }
}

/// Writes all bytes, waiting for room up to `timeout_ms` milliseconds in all, for ever if negative, signals or not.
///
/// Returns how many bytes were written, fewer than all when the time was over first; -`DP_RC_DEVICE` when the device
/// has disappeared; -`DP_RC_ERROR_GENERIC` when serial is NULL or closed, bytes is negative, or buf is NULL and bytes
/// is not 0.
///
/// ```c
/// int written = dp_serial_write(&port, out, length, 1000);
/// if (written >= 0 && written < length)
///     puts("nobody reads at the other end");
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_write(
    serial: *mut Serial,
    buf: *const c_void,
    bytes: c_int,
    timeout_ms: c_long,
) -> c_int {
    // SAFETY: serial is NULL or whole, and buf NULL or readable for that many bytes.
    match unsafe { (opened(serial), bytes_of(buf, bytes)) } {
        (Some(port), Some(input)) => count(port.run(|handle| system::write(handle, input, timeout_ms))),
        _ => -DP_RC_ERROR_GENERIC,
    }
}

/// Writes all bytes, waiting for room up to `DP_SERIAL_SEND_MS`. A `send_func_t`, for which usr is the port.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when the device has disappeared or did not take all of them in time, or
/// `DP_RC_ERROR_GENERIC` when usr is NULL or closed, bytes is negative, or buf is NULL and bytes is not 0.
///
/// ```c
/// if (dp_send(&msg, dp_serial_send, &port) != DP_RC_SUCCESS)
///     fprintf(stderr, "%s\n", dp_serial_error(&port));
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_send(buf: *mut c_void, bytes: c_int, usr: *mut c_void) -> c_int {
    // SAFETY: usr is NULL or a whole port, and buf NULL or readable for that many bytes.
    match unsafe { (opened(usr.cast()), bytes_of(buf, bytes)) } {
        (Some(port), Some(input)) => code(port.send(input, DP_SERIAL_SEND_MS)),
        _ => DP_RC_ERROR_GENERIC,
    }
}

/// Waits until all that was written was sent, however long that takes, signals or not.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when the device has disappeared, or `DP_RC_ERROR_GENERIC` when serial is
/// NULL or closed.
///
/// ```c
/// dp_serial_send(out, length, &port);
/// if (dp_serial_drain(&port) == DP_RC_SUCCESS)
///     sent_at = now_ms();
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_drain(serial: *mut Serial) -> c_int {
    // SAFETY: serial is NULL or whole.
    run(unsafe { opened(serial) }, system::drain)
}

/// Discards what was received and not read. Returns what `dp_serial_drain` does.
///
/// ```c
/// if (dp_serial_discard(&port) == DP_RC_SUCCESS)
///     memset(&ring, 0, sizeof ring);
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_discard(serial: *mut Serial) -> c_int {
    // SAFETY: serial is NULL or whole.
    run(unsafe { opened(serial) }, system::discard)
}

/// Sets DTR: on is `DP_SERIAL_ON` or 1, or `DP_SERIAL_OFF` or 0. An Arduino resets when it goes on.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when there is no such line, as in a pseudo-terminal, or the device has
/// disappeared, or `DP_RC_ERROR_GENERIC` when serial is NULL or closed.
///
/// ```c
/// dp_serial_set_dtr(&port, 0);
/// dp_serial_read(&port, in, sizeof in, 100);
/// dp_serial_set_dtr(&port, 1);
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_set_dtr(serial: *mut Serial, on: c_int) -> c_int {
    // SAFETY: serial is NULL or whole.
    run(unsafe { opened(serial) }, |handle| system::set_line(handle, system::DTR, on > 0))
}

/// Sets RTS, as `dp_serial_set_dtr` sets DTR.
///
/// ```c
/// dp_serial_set_rts(&port, DP_SERIAL_OFF);
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_set_rts(serial: *mut Serial, on: c_int) -> c_int {
    // SAFETY: serial is NULL or whole.
    run(unsafe { opened(serial) }, |handle| system::set_line(handle, system::RTS, on > 0))
}

/// Returns the file descriptor, which is set to `O_NONBLOCK`, for poll(2) or select(2), in Windows the `HANDLE` as an
/// int; or -1 when serial is NULL or closed.
///
/// ```c
/// int fd = dp_serial_handle(&port);
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_handle(serial: *const Serial) -> c_int {
    // SAFETY: serial is NULL or whole.
    unsafe { Serial::peek(serial) }.and_then(Port::handle).unwrap_or(-1)
}

/// Closes it, if it is open. What was written is still sent. Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` for NULL.
///
/// ```c
/// dp_serial_drain(&port);
/// dp_serial_close(&port);
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_close(serial: *mut Serial) -> c_int {
    // SAFETY: serial is NULL or whole.
    let Some(port) = (unsafe { Serial::get(serial) }) else { return DP_RC_ERROR_GENERIC };
    port.close();
    DP_RC_SUCCESS
}

/// Returns the device's name and what went wrong with it last, such as `/dev/ttyUSB0: in use by another program`: a
/// string that lives and changes with the port, empty when nothing did since it was opened or serial is NULL.
///
/// ```c
/// if (dp_serial_read(&port, in, sizeof in, 100) < 0)
///     fprintf(stderr, "%s\n", dp_serial_error(&port));
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_error(serial: *const Serial) -> *const c_char {
    // SAFETY: serial is NULL or whole.
    unsafe { Serial::peek(serial) }.map_or(c"".as_ptr(), |port| port.error().as_ptr())
}

/// The port, if it is open.
///
/// # Safety
///
/// As for `dp_serial_read`.
unsafe fn opened<'a>(serial: *mut Serial) -> Option<&'a mut Port> {
    // SAFETY: serial is NULL or whole, and this call's alone.
    unsafe { Serial::get(serial) }.filter(|port| port.handle().is_some())
}

fn run(port: Option<&mut Port>, operation: impl FnOnce(c_int) -> Result<(), Cause>) -> c_int {
    port.map_or(DP_RC_ERROR_GENERIC, |port| code(port.run(operation)))
}

fn code(result: Result<(), Failed>) -> c_int {
    if result.is_ok() { DP_RC_SUCCESS } else { DP_RC_DEVICE }
}

fn count(result: Result<usize, Failed>) -> c_int {
    result.map_or(-DP_RC_DEVICE, int)
}
