//! Lines that were received: their checksums, which parameters they have, and what these say.

use core::ffi::{c_char, c_float, c_int, c_long, c_uint, c_void};
use core::mem::MaybeUninit;
use core::ptr::null;

use super::{
    LineMessage, LineParam, OLP_CHECKSUM_NONE, OLP_CHECKSUM_RIGHT, OLP_CHECKSUM_WRONG, OLP_RC_ERROR_GENERIC,
    OLP_RC_MALFORMED, OLP_RC_NO_COMMAND, OLP_RC_NOT_FOUND, OLP_RC_RANGE, OLP_RC_SUCCESS, OLP_RC_TOO_LONG,
};
use crate::memory::{bytes_of, int, room_of, text_of};
use deltarobot_export::export;
use deltarobot_protocols::line::{self, Checksum, Malformed, Message, NumberError, Param, Params, Value};

/// A message that says nothing.
const EMPTY: LineMessage = LineMessage { line: null(), length: 0, count: 0, checksum: OLP_CHECKSUM_NONE, sum: 0 };

/// The checksum of the protocol, Fletcher-16 in ones' complement: the second sum in bits 8 to 15, the first in bits 0
/// to 7. Both begin at 255, and neither is ever 0: of no bytes it is 0xFFFF, of a NULL pointer or a negative length
/// too.
///
/// ```c
/// printf("%04x\n", olp_fletcher16(line.text, line.length));
/// ```
#[export]
pub unsafe extern "C" fn olp_fletcher16(bytes: *const c_void, length: c_int) -> c_uint {
    // SAFETY: bytes is NULL or has that length.
    line::fletcher16(unsafe { bytes_of(bytes, length) }.unwrap_or_default()).into()
}

/// The checksum of bytes whose beginning has the checksum sum, as far as that has 16 bits: 0xFFFF when there is none.
/// It is sum itself when bytes is NULL or length not positive.
///
/// ```c
/// printf("%04x\n", olp_fletcher16_more(olp_fletcher16("c=go&", 5), "x=34", 4));
/// ```
#[export]
pub unsafe extern "C" fn olp_fletcher16_more(sum: c_uint, bytes: *const c_void, length: c_int) -> c_uint {
    let [low, high, ..] = sum.to_le_bytes();
    // SAFETY: bytes is NULL or has that length.
    let bytes = unsafe { bytes_of(bytes, length) }.unwrap_or_default();
    line::fletcher16_more(u16::from_le_bytes([low, high]), bytes).into()
}

/// Reads a line, with or without its end (LF or CR LF), and describes it in message. Names may be any; a parameter
/// without `=` has an empty value; nothing between two `&` is no parameter. A wrong checksum is no error: see
/// `message->checksum`.
///
/// Returns `OLP_RC_SUCCESS`; `OLP_RC_NO_COMMAND` when the first parameter is not `c`, `OLP_RC_MALFORMED` when a `%`
/// lacks its two hexadecimal digits or a line feed stands within the line; or `OLP_RC_ERROR_GENERIC` when a pointer is
/// NULL or length negative. Unless it succeeds, message is empty.
///
/// ```c
/// if (olp_parse(line.text, line.length, &message) == OLP_RC_SUCCESS && message.checksum != OLP_CHECKSUM_WRONG)
///     handle_message(&message);
/// ```
#[export]
pub unsafe extern "C" fn olp_parse(line: *const c_char, length: c_int, message: *mut LineMessage) -> c_int {
    // SAFETY: line is NULL or has that length, message NULL or the caller's.
    let (text, message) = unsafe { (bytes_of(line.cast(), length), message.as_mut()) };
    let Some(message) = message else { return OLP_RC_ERROR_GENERIC };
    *message = EMPTY;
    let Some(text) = text.filter(|_| !line.is_null()) else { return OLP_RC_ERROR_GENERIC };
    match Message::parse(text) {
        Ok(parsed) => *message = view(&parsed),
        Err(Malformed::Command) => return OLP_RC_NO_COMMAND,
        Err(Malformed::Escape | Malformed::LineFeed) => return OLP_RC_MALFORMED,
    }
    OLP_RC_SUCCESS
}

/// Finds a parameter by its place in the line: 0 is the command, `message->count` - 1 the last. message was filled in
/// by `olp_parse` and its line is still there, or is all zero.
///
/// Returns `OLP_RC_SUCCESS`, `OLP_RC_NOT_FOUND` when there is none, or `OLP_RC_ERROR_GENERIC` when a pointer is NULL.
/// Unless it succeeds, param is left as it was.
///
/// ```c
/// for (int i = 0; olp_param_at(&message, i, &param) == OLP_RC_SUCCESS; ++i)
///     printf("%.*s\n", param.name_length, param.name);
/// ```
#[export]
pub unsafe extern "C" fn olp_param_at(message: *const LineMessage, index: c_int, param: *mut LineParam) -> c_int {
    // SAFETY: message is NULL, empty, or of a line that is still there; param is NULL or writable.
    unsafe {
        let Some(mut params) = params_of(message) else { return OLP_RC_ERROR_GENERIC };
        give(usize::try_from(index).ok().and_then(|index| params.nth(index)), param)
    }
}

/// Finds a parameter by its name, a string. Names repeat: occurrence selects one of that name, 0 the first. The command
/// is the first `c`. Returns what `olp_param_at` does.
///
/// ```c
/// if (olp_find(&message, "id", 0, &param) == OLP_RC_SUCCESS)
///     printf("from %.*s\n", param.value_length, param.value);
/// ```
#[export]
pub unsafe extern "C" fn olp_find(
    message: *const LineMessage,
    name: *const c_char,
    occurrence: c_int,
    param: *mut LineParam,
) -> c_int {
    // SAFETY: message is NULL, empty, or of a line that is still there, name NULL or a string, param NULL or writable.
    unsafe {
        let (Some(params), Some(name)) = (params_of(message), text_of(name)) else { return OLP_RC_ERROR_GENERIC };
        give(usize::try_from(occurrence).ok().and_then(|occurrence| params.find_named(name, occurrence)), param)
    }
}

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
    // SAFETY: param is NULL, empty, or of a line that is still there; value is NULL or writable.
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
    // SAFETY: param is NULL, empty, or of a line that is still there; value is NULL or writable.
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
    // SAFETY: param is NULL, empty, or of a line that is still there; cap is buf's size.
    unsafe { decode(value_of(param), room_of(buf.cast(), cap)) }
}

/// Returns 1 if a parameter's decoded value is that text, a string; else, and when a pointer is NULL, 0.
///
/// ```c
/// int has_started = olp_value_is(&param, "welcome");
/// ```
#[export]
pub unsafe extern "C" fn olp_value_is(param: *const LineParam, text: *const c_char) -> c_int {
    // SAFETY: param is NULL, empty, or of a line that is still there; text is NULL or a string.
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
    // SAFETY: message is NULL, empty, or of a line that is still there, name NULL or a string, value NULL or writable.
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
    // SAFETY: message is NULL, empty, or of a line that is still there, name NULL or a string, value NULL or writable.
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
    // SAFETY: message is NULL, empty, or of a line that is still there, name NULL or a string; cap is buf's size.
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
    // SAFETY: message is NULL, empty, or of a line that is still there; name and text are NULL or strings.
    unsafe { is(find_value(message, name, occurrence), text_of(text)) }
}

/// A message as C sees it.
pub(crate) fn view(message: &Message<'_>) -> LineMessage {
    LineMessage {
        line: message.line.as_ptr().cast(),
        length: int(message.line.len()),
        count: int(message.count),
        checksum: match message.checksum {
            Checksum::None => OLP_CHECKSUM_NONE,
            Checksum::Right => OLP_CHECKSUM_RIGHT,
            Checksum::Wrong => OLP_CHECKSUM_WRONG,
        },
        sum: message.sum.into(),
    }
}

/// Unsafe as [`olp_param_at`] is.
unsafe fn params_of<'a>(message: *const LineMessage) -> Option<Params<'a>> {
    // SAFETY: message is NULL, empty, or of a line that is still there.
    unsafe {
        let message = message.as_ref()?;
        bytes_of(message.line.cast(), message.length).map(Params::of)
    }
}

/// The value of a parameter, or why there is none. Unsafe as [`olp_find`] is.
unsafe fn find_value<'a>(
    message: *const LineMessage,
    name: *const c_char,
    occurrence: c_int,
) -> Result<Value<'a>, c_int> {
    // SAFETY: message is NULL, empty, or of a line that is still there, name NULL or a string.
    let (Some(params), Some(name)) = (unsafe { (params_of(message), text_of(name)) }) else {
        return Err(OLP_RC_ERROR_GENERIC);
    };
    let occurrence = usize::try_from(occurrence).map_err(|_| OLP_RC_NOT_FOUND)?;
    params.value(name, occurrence).ok_or(OLP_RC_NOT_FOUND)
}

/// Hands a parameter to C; out is NULL or points to a writable one.
unsafe fn give(param: Option<Param<'_>>, out: *mut LineParam) -> c_int {
    // SAFETY: out is NULL or writable.
    let Some(out) = (unsafe { out.as_mut() }) else { return OLP_RC_ERROR_GENERIC };
    let Some(Param { name, value }) = param else { return OLP_RC_NOT_FOUND };
    *out = LineParam {
        name: name.as_ptr().cast(),
        name_length: int(name.len()),
        value: value.raw().as_ptr().cast(),
        value_length: int(value.raw().len()),
    };
    OLP_RC_SUCCESS
}

/// Unsafe as [`olp_value_int`] is.
unsafe fn value_of<'a>(param: *const LineParam) -> Result<Value<'a>, c_int> {
    // SAFETY: param is NULL, empty, or of a line that is still there.
    let bytes = unsafe { param.as_ref().and_then(|param| bytes_of(param.value.cast(), param.value_length)) };
    bytes.map(Value::new).ok_or(OLP_RC_ERROR_GENERIC)
}

/// Hands a number to C; out is NULL or points to a writable one.
unsafe fn store<T>(number: Result<Result<T, NumberError>, c_int>, out: *mut T) -> c_int {
    // SAFETY: out is NULL or writable.
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
