//! `serial.h`: the serial port.

use core::ffi::{CStr, c_char, c_int, c_long, c_ulong, c_void};
use deltarobot_export::export;

use super::memory::{bytes_of, int, room_of, zero};
use super::protocol::{DP_RC_ERROR_GENERIC, DP_RC_SUCCESS};
use crate::port::{Failed, Port};

/// The system has reported an error: `dp_serial_error` says which.
pub const DP_RC_DEVICE: c_int = 7;
/// How long `dp_serial_send` waits for room, in milliseconds.
pub const DP_SERIAL_SEND_MS: c_long = 1000;

/// Opens and sets up a serial port or pseudo-terminal: 8 data bits, no parity, one stop bit, no flow control, bytes as
/// they are.
///
/// baud is the speed, 0 for `DP_SERIAL_BAUD`; only standard speeds are known. It does not wait for a carrier. As long
/// as it is open, nobody else can open the device by this function or, unless as root or if it is a pseudo-terminal,
/// otherwise. What was received before is thrown away.
///
/// device is NULL or a string. A port that is open must be closed first: else its file descriptor is lost.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when that was not possible, or `DP_RC_ERROR_GENERIC` when serial or device
/// is NULL. When it did not succeed, the port is closed: it need not be, but can be, closed.
///
/// ```c
/// struct dp_serial port;
/// if (dp_serial_open(&port, "/dev/ttyUSB0", DP_SERIAL_BAUD) != DP_RC_SUCCESS)
///     fprintf(stderr, "%s\n", dp_serial_error(&port));
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_open(serial: *mut Port, device: *const c_char, baud: c_ulong) -> c_int {
    if serial.is_null() {
        return DP_RC_ERROR_GENERIC;
    }
    // SAFETY: as the contract of this function asks; zero is a port that is closed.
    unsafe {
        zero(serial);
        if device.is_null() {
            return DP_RC_ERROR_GENERIC;
        }
        code((*serial).open(CStr::from_ptr(device), baud))
    }
}

/// Reads what has come, at most cap bytes. When nothing has, waits for it up to `timeout_ms` milliseconds (for ever if
/// negative), or until a signal was handled.
///
/// serial was opened or is all zero.
///
/// Returns how many bytes were read, 0 when none came; -`DP_RC_DEVICE` when the device has disappeared (what it
/// received before that is read first); -`DP_RC_ERROR_GENERIC` when serial is NULL or not open, cap is negative, or buf
/// is NULL and cap is not 0.
///
/// ```c
/// int got = dp_serial_read(&port, in, sizeof in, 100);
/// if (got > 0)
///     dp_process(&ring, in, got);
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_read(serial: *mut Port, buf: *mut c_void, cap: c_int, timeout_ms: c_long) -> c_int {
    // SAFETY: as the contract of this function asks.
    let (port, out) = unsafe { (serial.as_mut(), room_of(buf, cap)) };
    match (port, out) {
        (Some(port), Some(out)) if port.is_open() => count(port.read(out, timeout_ms).map(<[u8]>::len)),
        _ => DP_RC_ERROR_GENERIC.wrapping_neg(),
    }
}

/// Writes all bytes, waiting for room up to `timeout_ms` milliseconds altogether (for ever if negative). Signals don't
/// end it.
///
/// Returns how many bytes were written, fewer than all when the time was over first; -`DP_RC_DEVICE` when the device
/// has disappeared; -`DP_RC_ERROR_GENERIC` when serial is NULL or not open, bytes is negative, or buf is NULL and bytes
/// is not 0.
///
/// ```c
/// int written = dp_serial_write(&port, out, length, 1000);
/// if (written >= 0 && written < length)
///     puts("nobody reads at the other end");
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_write(
    serial: *mut Port,
    buf: *const c_void,
    bytes: c_int,
    timeout_ms: c_long,
) -> c_int {
    // SAFETY: as the contract of this function asks.
    let (port, input) = unsafe { (serial.as_mut(), bytes_of(buf, bytes)) };
    match (port, input) {
        (Some(port), Some(input)) if port.is_open() => count(port.write(input, timeout_ms)),
        _ => DP_RC_ERROR_GENERIC.wrapping_neg(),
    }
}

/// Writes all bytes, waiting for room up to `DP_SERIAL_SEND_MS`. A `send_func_t`, for which usr is the port.
///
/// usr is the port.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when the device has disappeared or did not take all of them in time, or
/// `DP_RC_ERROR_GENERIC` when usr is NULL or not open, bytes is negative, or buf is NULL and bytes is not 0.
///
/// ```c
/// if (dp_send(&msg, dp_serial_send, &port) != DP_RC_SUCCESS)
///     fprintf(stderr, "%s\n", dp_serial_error(&port));
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_send(buf: *mut c_void, bytes: c_int, usr: *mut c_void) -> c_int {
    // SAFETY: as the contract of this function asks.
    let (port, input) = unsafe { (usr.cast::<Port>().as_mut(), bytes_of(buf, bytes)) };
    match (port, input) {
        (Some(port), Some(input)) if port.is_open() => code(port.send(input, DP_SERIAL_SEND_MS)),
        _ => DP_RC_ERROR_GENERIC,
    }
}

/// Waits until all that was written was sent, however long that takes. Signals don't end it.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when the device has disappeared, or `DP_RC_ERROR_GENERIC` when serial is
/// NULL or not open.
///
/// ```c
/// dp_serial_send(out, length, &port);
/// if (dp_serial_drain(&port) == DP_RC_SUCCESS)
///     sent_at = now_ms();
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_drain(serial: *mut Port) -> c_int {
    // SAFETY: as the contract of this function asks.
    match unsafe { serial.as_mut() } {
        Some(port) if port.is_open() => code(port.drain()),
        _ => DP_RC_ERROR_GENERIC,
    }
}

/// Throws away what was received and not read.
///
/// Returns what `dp_serial_drain` does.
///
/// ```c
/// if (dp_serial_discard(&port) == DP_RC_SUCCESS)
///     memset(&ring, 0, sizeof ring);
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_discard(serial: *mut Port) -> c_int {
    // SAFETY: as the contract of this function asks.
    match unsafe { serial.as_mut() } {
        Some(port) if port.is_open() => code(port.discard()),
        _ => DP_RC_ERROR_GENERIC,
    }
}

/// Closes it. What was written is still sent.
///
/// Returns `DP_RC_SUCCESS`, also when it was not open, or `DP_RC_ERROR_GENERIC` when serial is NULL.
///
/// ```c
/// dp_serial_drain(&port);
/// dp_serial_close(&port);
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_close(serial: *mut Port) -> c_int {
    // SAFETY: as the contract of this function asks.
    match unsafe { serial.as_mut() } {
        Some(port) => {
            port.close();
            DP_RC_SUCCESS
        }
        None => DP_RC_ERROR_GENERIC,
    }
}

/// The device's name and what went wrong with it last, such as `/dev/ttyUSB0: in use by another program`.
///
/// Returns a string that lives and changes with the port, empty when nothing went wrong since it was opened or serial
/// is NULL.
///
/// ```c
/// if (dp_serial_read(&port, in, sizeof in, 100) < 0)
///     fprintf(stderr, "%s\n", dp_serial_error(&port));
/// ```
#[export]
pub unsafe extern "C" fn dp_serial_error(serial: *const Port) -> *const c_char {
    // SAFETY: as the contract of this function asks.
    unsafe { serial.as_ref() }.map_or(c"".as_ptr(), |port| port.error().as_ptr())
}

fn code(result: Result<(), Failed>) -> c_int {
    match result {
        Ok(()) => DP_RC_SUCCESS,
        Err(Failed) => DP_RC_DEVICE,
    }
}

fn count(result: Result<usize, Failed>) -> c_int {
    result.map_or(DP_RC_DEVICE.wrapping_neg(), int)
}
