//! Lines to be sent, parameter by parameter.

use core::ffi::{c_char, c_float, c_int, c_long, c_uint, c_void};
use core::slice;

use super::{
    LineEncoder, OLP_COMMAND_MAX, OLP_RC_ERROR_GENERIC, OLP_RC_MALFORMED, OLP_RC_NAME, OLP_RC_RANGE, OLP_RC_SUCCESS,
    OLP_RC_TOO_LONG,
};
use crate::memory::{bytes_of, int, room_of, text_of};
use deltarobot_export::export;
use deltarobot_protocols::bytes::zeros;
use deltarobot_protocols::line::{EncodeError, Encoder, Integer};

/// Begins a line that may be as long as the buffer, its line feed counted: one that a device sends. buf stays there
/// until the line is finished; command is NULL or a string.
///
/// `olp_add_*` go on with it and `olp_finish` ends it. After the first of them that fails, the others do nothing and
/// return the same, so that it is enough to ask `olp_finish`. In between, buf holds the line so far.
///
/// Returns `OLP_RC_SUCCESS`; `OLP_RC_NAME` when command is empty or has other bytes than `[A-Za-z0-9_]`,
/// `OLP_RC_TOO_LONG` when it does not fit; or `OLP_RC_ERROR_GENERIC` when a pointer is NULL or cap negative.
///
/// ```c
/// olp_begin(&encoder, text, sizeof text, "heaterinfo");
/// olp_add_float(&encoder, "temp", 21.5f, 2);
/// length = olp_finish(&encoder, 1);
/// ```
#[export]
pub unsafe extern "C" fn olp_begin(
    encoder: *mut LineEncoder,
    buf: *mut c_char,
    cap: c_int,
    command: *const c_char,
) -> c_int {
    // SAFETY: as begin() asks.
    unsafe { begin(encoder, buf, cap, c_int::MAX, command) }
}

/// Like `olp_begin`, for a line that a PC sends: of at most `OLP_COMMAND_MAX` bytes, checksum and line feed counted,
/// and no more than the buffer. If it is too long, leave out parameters that the device does not need.
///
/// ```c
/// char text[OLP_COMMAND_MAX];
/// struct olp_encoder encoder;
/// olp_begin_command(&encoder, text, sizeof text, "setswitch");
/// olp_add_int(&encoder, "state", 1);
/// olp_add_string(&encoder, "id", "9o5qzg");
/// if ((length = olp_finish(&encoder, 1)) > 0)
///     uart_write(&uart, text, length);
/// ```
#[export]
pub unsafe extern "C" fn olp_begin_command(
    encoder: *mut LineEncoder,
    buf: *mut c_char,
    cap: c_int,
    command: *const c_char,
) -> c_int {
    // SAFETY: as begin() asks.
    unsafe { begin(encoder, buf, cap, OLP_COMMAND_MAX, command) }
}

/// Adds a text, a string, encoded: all bytes but `[A-Za-z0-9._-]` as `%` and two hexadecimal digits. encoder was made
/// by `olp_begin` or `olp_begin_command` and its buffer is still there, or is all zero.
///
/// Returns `OLP_RC_SUCCESS`; `OLP_RC_NAME` when name is empty, `s`, or has other bytes than `[A-Za-z0-9_]`,
/// `OLP_RC_TOO_LONG` when the line does not fit; `OLP_RC_ERROR_GENERIC` when a pointer is NULL; or what an earlier call
/// for this line returned.
///
/// ```c
/// olp_add_string(&encoder, "name", "Kitchen lamp");
/// ```
#[export]
pub unsafe extern "C" fn olp_add_string(encoder: *mut LineEncoder, name: *const c_char, text: *const c_char) -> c_int {
    // SAFETY: as add() asks; text is NULL or a string.
    unsafe { add(encoder, name, text_of(text), add_text) }
}

/// Like `olp_add_string`, for length bytes, zero bytes among them; `OLP_RC_ERROR_GENERIC` also when length is negative.
///
/// ```c
/// olp_add_bytes(&encoder, "serial", in, 4);
/// ```
#[export]
pub unsafe extern "C" fn olp_add_bytes(
    encoder: *mut LineEncoder,
    name: *const c_char,
    text: *const c_void,
    length: c_int,
) -> c_int {
    // SAFETY: as add() asks; text is NULL or points to so many bytes.
    unsafe { add(encoder, name, bytes_of(text, length), add_text) }
}

/// Adds a value that is encoded already, such as one of a received line: unchanged. Returns what `olp_add_bytes` does;
/// `OLP_RC_MALFORMED` when the value has an `&`, a CR or an LF in it, or a `%` without its two digits.
///
/// ```c
/// olp_add_raw(&encoder, "t", param.value, param.value_length);
/// ```
#[export]
pub unsafe extern "C" fn olp_add_raw(
    encoder: *mut LineEncoder,
    name: *const c_char,
    value: *const c_char,
    length: c_int,
) -> c_int {
    // SAFETY: as add() asks; value is NULL or points to so many bytes.
    unsafe { add(encoder, name, bytes_of(value.cast(), length), |line, name, value| _ = line.raw(name, value)) }
}

/// Adds an integer, in decimal. Returns what `olp_add_string` does.
///
/// ```c
/// olp_add_int(&encoder, "state", 1);
/// ```
#[export]
pub unsafe extern "C" fn olp_add_int(encoder: *mut LineEncoder, name: *const c_char, value: c_long) -> c_int {
    // SAFETY: as add() asks.
    unsafe { add(encoder, name, Some(value.write(&mut zeros())), add_text) }
}

/// Adds a float as `printf("%.*f", decimals, value)` writes it, a tie rounded to the even digit. Returns what
/// `olp_add_string` does; `OLP_RC_RANGE` when value is not finite, or decimals not 0 to `OLP_DECIMALS_MAX`.
///
/// ```c
/// olp_add_float(&encoder, "temp", 21.5f, 2);
/// ```
#[export]
pub unsafe extern "C" fn olp_add_float(
    encoder: *mut LineEncoder,
    name: *const c_char,
    value: c_float,
    decimals: c_int,
) -> c_int {
    let decimals = u8::try_from(decimals).unwrap_or(u8::MAX);
    // SAFETY: as add() asks.
    unsafe {
        add(encoder, name, Some(&[]), add_text);
        edit(encoder, &mut |line| _ = line.fixed(value, decimals))
    }
}

/// Adds the lower 16 bits of value as four hexadecimal digits in lower case. Returns what `olp_add_string` does.
///
/// ```c
/// olp_add_hex(&encoder, "checksum", message.sum);
/// ```
#[export]
pub unsafe extern "C" fn olp_add_hex(encoder: *mut LineEncoder, name: *const c_char, value: c_uint) -> c_int {
    let [low, high, ..] = value.to_le_bytes();
    let value = u16::from_le_bytes([low, high]);
    // SAFETY: as add() asks.
    unsafe {
        add(encoder, name, Some(&[]), add_text);
        edit(encoder, &mut |line| line.put_hex(value))
    }
}

/// Ends a line: with its checksum, `&s=` and four hexadecimal digits, unless checksum is 0, and with a line feed. A
/// zero byte stands behind it where the buffer has room for one.
///
/// Returns the length of the line, its line feed counted; minus what the first call for this line returned that failed,
/// or -`OLP_RC_TOO_LONG` when checksum and line feed do not fit: the first byte of the buffer, if it has one, is zero
/// then; or -`OLP_RC_ERROR_GENERIC` when encoder is NULL or its line was ended already.
///
/// ```c
/// length = olp_finish(&encoder, 1);
/// ```
#[export]
pub unsafe extern "C" fn olp_finish(encoder: *mut LineEncoder, checksum: c_int) -> c_int {
    // SAFETY: encoder is as edit() asks.
    unsafe {
        // What it says is kept.
        let code = edit(encoder, &mut |line| _ = line.finish(checksum != 0));
        let Some(encoder) = encoder.as_mut() else { return -OLP_RC_ERROR_GENERIC };
        encoder.error = OLP_RC_ERROR_GENERIC;
        // Below 0, whatever an encoder that was never begun holds: nobody shall take it for a length.
        if code == OLP_RC_SUCCESS { encoder.length } else { code.saturating_abs().wrapping_neg() }
    }
}

/// Begins a line of at most limit bytes. encoder is NULL or writable, cap is buf's size, and command NULL or a string.
unsafe fn begin(
    encoder: *mut LineEncoder,
    buf: *mut c_char,
    cap: c_int,
    limit: c_int,
    command: *const c_char,
) -> c_int {
    // SAFETY: encoder is NULL or writable, cap is buf's size, and command NULL or a string.
    unsafe {
        let Some(encoder) = encoder.as_mut() else { return OLP_RC_ERROR_GENERIC };
        *encoder = LineEncoder { buf, cap: cap.min(limit), length: 0, error: OLP_RC_ERROR_GENERIC };
        // From here on these are bytes that can be read, and those behind the line are zero.
        for place in room_of(buf.cast(), cap.min(limit.saturating_add(1))).unwrap_or_default() {
            place.write(0);
        }
        if let Some(command) = text_of(command) {
            encoder.error = OLP_RC_SUCCESS;
            edit(encoder, &mut |line| line.start(command));
        }
        encoder.error
    }
}

/// How a value is added.
type Put = fn(&mut Encoder<'_>, &[u8], &[u8]);

fn add_text(line: &mut Encoder<'_>, name: &[u8], text: &[u8]) {
    line.text(name, text);
}

/// Adds a parameter, or fails if there is no name or no value. name is NULL or a string, encoder as [`edit`] asks.
unsafe fn add(encoder: *mut LineEncoder, name: *const c_char, value: Option<&[u8]>, put: Put) -> c_int {
    // SAFETY: as asked of the caller: name is NULL or a string, and encoder as edit() asks.
    unsafe {
        let name = text_of(name);
        edit(encoder, &mut |line| match (name, value) {
            (Some(name), Some(value)) => put(line, name, value),
            _ => line.fail(EncodeError::Aborted),
        })
    }
}

/// Goes on with a line, unless it has failed, or was never begun. encoder is NULL, all zero, or was begun, and its
/// buffer is still there; nobody else touches either meanwhile.
pub(crate) unsafe fn edit(encoder: *mut LineEncoder, edit: &mut dyn FnMut(&mut Encoder<'_>)) -> c_int {
    // SAFETY: NULL or an encoder, which nobody else touches meanwhile.
    let Some(encoder) = (unsafe { encoder.as_mut() }) else { return OLP_RC_ERROR_GENERIC };
    if encoder.error != OLP_RC_SUCCESS {
        return encoder.error;
    }
    encoder.error = OLP_RC_ERROR_GENERIC;
    if let (Ok(length), Ok(cap), false) =
        (usize::try_from(encoder.length), usize::try_from(encoder.cap), encoder.buf.is_null())
    {
        // SAFETY: begin() checked the buffer, and wrote all of these bytes; it is still there.
        let room = unsafe { slice::from_raw_parts_mut(encoder.buf.cast(), cap) };
        let mut line = Encoder::resume(room, length);
        edit(&mut line);
        encoder.length = int(line.length());
        encoder.error = line.error().map_or(OLP_RC_SUCCESS, |error| (error as u8).into());
    }
    encoder.error
}

// The codes of C are those of the core.
const _: () = {
    assert!(EncodeError::Aborted as c_int == OLP_RC_ERROR_GENERIC);
    assert!(EncodeError::Malformed as c_int == OLP_RC_MALFORMED);
    assert!(EncodeError::TooLong as c_int == OLP_RC_TOO_LONG);
    assert!(EncodeError::Range as c_int == OLP_RC_RANGE);
    assert!(EncodeError::Name as c_int == OLP_RC_NAME);
};
