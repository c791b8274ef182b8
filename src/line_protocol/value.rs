//! What parameters say.

use core::ffi::{c_char, c_float, c_int, c_long};
use core::mem::MaybeUninit;

use super::message::find_value;
use super::{
    LineMessage, LineParam, OLP_RC_ERROR_GENERIC, OLP_RC_MALFORMED, OLP_RC_RANGE, OLP_RC_SUCCESS, OLP_RC_TOO_LONG,
};
use crate::memory::{bytes_of, int, room_of, text_of};
use deltarobot_export::export;
use deltarobot_protocols::line::{NumberError, Value};

/// Reads a parameter's value as an integer: an optional sign and decimal digits, perhaps spaces around them. param was
/// filled in by `olp_param_at` or `olp_find` and its line is still there, or is all zero.
///
/// Returns `OLP_RC_SUCCESS`, `OLP_RC_MALFORMED` when the value is none, `OLP_RC_RANGE` when a long does not hold it, or
/// `OLP_RC_ERROR_GENERIC` when a pointer is NULL. Unless it succeeds, value is left as it was.
///
/// ```c
/// long state;
/// if (olp_value_int(&param, &state) == OLP_RC_SUCCESS)
///     switch_to(state);
/// ```
#[export]
pub unsafe extern "C" fn olp_value_int(param: *const LineParam, value: *mut c_long) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe { store(value_of(param).map(Value::int), value) }
}

/// Reads a parameter's value as a decimal number, such as `-1000.00` or `1e3`, perhaps with spaces around it: the
/// nearest float, no infinity or NaN. Returns what `olp_value_int` does; `OLP_RC_RANGE` beyond the largest float.
///
/// ```c
/// if (olp_value_float(&param, &temperature) == OLP_RC_SUCCESS)
///     show(temperature);
/// ```
#[export]
pub unsafe extern "C" fn olp_value_float(param: *const LineParam, value: *mut c_float) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe { store(value_of(param).map(Value::float), value) }
}

/// Decodes a parameter's value to buf, and writes a zero byte behind it. There may be others in it.
///
/// Returns the number of bytes, the last zero byte not counted; -`OLP_RC_TOO_LONG` when they do not fit, buf being then
/// an empty string if cap is not 0; or -`OLP_RC_ERROR_GENERIC` when a pointer is NULL or cap negative (buf may be NULL
/// when cap is 0).
///
/// ```c
/// if (olp_value_string(&param, text, sizeof text) >= 0)
///     puts(text);
/// ```
#[export]
pub unsafe extern "C" fn olp_value_string(param: *const LineParam, buf: *mut c_char, cap: c_int) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe { decode(value_of(param), room_of(buf.cast(), cap)) }
}

/// Returns 1 if a parameter's decoded value is that text, a string; else, and when a pointer is NULL, 0.
///
/// ```c
/// int has_started = olp_value_is(&param, "welcome");
/// ```
#[export]
pub unsafe extern "C" fn olp_value_is(param: *const LineParam, text: *const c_char) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe { is(value_of(param), text_of(text)) }
}

/// `olp_find` and `olp_value_int` in one: returns what they do.
///
/// ```c
/// long state;
/// if (olp_get_int(&message, "state", 0, &state) == OLP_RC_SUCCESS)
///     switch_to(state);
/// ```
#[export]
pub unsafe extern "C" fn olp_get_int(
    message: *const LineMessage,
    name: *const c_char,
    occurrence: c_int,
    value: *mut c_long,
) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe { store(find_value(message, name, occurrence).map(Value::int), value) }
}

/// `olp_find` and `olp_value_float` in one: returns what they do.
///
/// ```c
/// if (olp_get_float(&message, "temp", 0, &temperature) == OLP_RC_SUCCESS)
///     show(temperature);
/// ```
#[export]
pub unsafe extern "C" fn olp_get_float(
    message: *const LineMessage,
    name: *const c_char,
    occurrence: c_int,
    value: *mut c_float,
) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe { store(find_value(message, name, occurrence).map(Value::float), value) }
}

/// `olp_find` and `olp_value_string` in one: returns what they do; if -`OLP_RC_NOT_FOUND`, buf is left as it was.
///
/// ```c
/// if (olp_get_string(&message, "name", 0, text, sizeof text) >= 0)
///     puts(text);
/// ```
#[export]
pub unsafe extern "C" fn olp_get_string(
    message: *const LineMessage,
    name: *const c_char,
    occurrence: c_int,
    buf: *mut c_char,
    cap: c_int,
) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe { decode(find_value(message, name, occurrence), room_of(buf.cast(), cap)) }
}

/// `olp_find` and `olp_value_is` in one. Returns 1 or 0; 0 when there is no such parameter or a pointer is NULL.
///
/// ```c
/// if (olp_is(&message, "c", 0, "heaterinfo") && olp_is(&message, "id", 0, "M1F910"))
///     handle_message(&message);
/// ```
#[export]
pub unsafe extern "C" fn olp_is(
    message: *const LineMessage,
    name: *const c_char,
    occurrence: c_int,
    text: *const c_char,
) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe { is(find_value(message, name, occurrence), text_of(text)) }
}

/// Unsafe as [`olp_value_int`] is.
unsafe fn value_of<'a>(param: *const LineParam) -> Result<Value<'a>, c_int> {
    // SAFETY: as the contract of this function asks.
    let bytes = unsafe { param.as_ref().and_then(|param| bytes_of(param.value.cast(), param.value_length)) };
    bytes.map(Value::new).ok_or(OLP_RC_ERROR_GENERIC)
}

/// Hands a number to C; out is NULL or points to a writable one.
unsafe fn store<T>(number: Result<Result<T, NumberError>, c_int>, out: *mut T) -> c_int {
    // SAFETY: as the contract of this function asks.
    match (number, unsafe { out.as_mut() }) {
        (Ok(Ok(number)), Some(out)) => *out = number,
        (Ok(Err(NumberError::Malformed)), Some(_)) => return OLP_RC_MALFORMED,
        (Ok(Err(NumberError::Range)), Some(_)) => return OLP_RC_RANGE,
        (Ok(_), None) => return OLP_RC_ERROR_GENERIC,
        (Err(code), _) => return code,
    }
    OLP_RC_SUCCESS
}

/// Writes a decoded value and a zero byte.
fn decode(value: Result<Value<'_>, c_int>, room: Option<&mut [MaybeUninit<u8>]>) -> c_int {
    let Some(room) = room else { return -OLP_RC_ERROR_GENERIC };
    let value = match value {
        Ok(value) => value,
        Err(code) => return code.wrapping_neg(),
    };
    let length = value.len();
    let fits = length < room.len();
    if fits {
        for (place, byte) in room.iter_mut().zip(value.bytes()) {
            place.write(byte);
        }
    }
    if let Some(behind) = room.get_mut(if fits { length } else { 0 }) {
        behind.write(0);
    }
    if fits { int(length) } else { -OLP_RC_TOO_LONG }
}

fn is(value: Result<Value<'_>, c_int>, text: Option<&[u8]>) -> c_int {
    value.is_ok_and(|value| text.is_some_and(|text| value.is(text))).into()
}
