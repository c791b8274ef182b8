//! Lines that were received: what they say.

use core::ffi::{c_char, c_float, c_int, c_long, c_uint, c_void};
use core::mem::MaybeUninit;

use super::{
    EMPTY, LineMessage, LineParam, OLP_CHECKSUM_NONE, OLP_CHECKSUM_RIGHT, OLP_CHECKSUM_WRONG, OLP_RC_ERROR_GENERIC,
    OLP_RC_MALFORMED, OLP_RC_NO_COMMAND, OLP_RC_NOT_FOUND, OLP_RC_RANGE, OLP_RC_SUCCESS, OLP_RC_TOO_LONG,
};
use crate::ffi::memory::{bytes_of, int, room_of, text_of};
use crate::line::{self, Checksum, Malformed, Message, NumberError, Param, Params, Value};

/// The checksum of the protocol, Fletcher-16 in ones' complement: both sums begin at 255, and neither is ever 0. Of no
/// bytes it is 0xFFFF; of a NULL pointer or a negative length too.
///
/// Returns the second sum in bits 8 to 15, the first in bits 0 to 7.
///
/// ```c
/// unsigned int sum = olp_fletcher16(line.text, line.length);
/// printf("%04x\n", sum);
/// ```
///
/// # Safety
///
/// Pointers, threads and interrupts: the rules at the head.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn olp_fletcher16(bytes: *const c_void, length: c_int) -> c_uint {
    // SAFETY: as the contract of this function asks.
    line::fletcher16(unsafe { bytes_of(bytes, length) }.unwrap_or_default()).into()
}

/// The checksum of bytes whose beginning was summed up before: sum is what this function or `olp_fletcher16` returned
/// for that, 0xFFFF when it is empty.
///
/// Returns the checksum of all; sum, as far as it has 16 bits, when bytes is NULL or length not positive.
///
/// ```c
/// unsigned int sum = 0xFFFF;
/// for (int got; (got = uart_read(&uart, in, sizeof in)) > 0;)
///     sum = olp_fletcher16_more(sum, in, got);
/// ```
///
/// # Safety
///
/// As for `olp_fletcher16`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn olp_fletcher16_more(sum: c_uint, bytes: *const c_void, length: c_int) -> c_uint {
    let [low, high, ..] = sum.to_le_bytes();
    // SAFETY: as the contract of this function asks.
    let bytes = unsafe { bytes_of(bytes, length) }.unwrap_or_default();
    line::fletcher16_more(u16::from_le_bytes([low, high]), bytes).into()
}

/// Reads a line, with or without its end (LF or CR LF), and describes it in message. Names may be any; a parameter
/// without `=` has an empty value; nothing between two `&` is no parameter.
///
/// Returns `OLP_RC_SUCCESS`; `OLP_RC_NO_COMMAND` when the first parameter is not `c`, `OLP_RC_MALFORMED` when a `%`
/// lacks its two hexadecimal digits or a line feed stands within the line; or `OLP_RC_ERROR_GENERIC` when a pointer is
/// NULL or length negative. Unless it succeeds, message is empty. A wrong checksum is no error: see
/// `message->checksum`.
///
/// ```c
/// struct olp_message message;
/// if (olp_parse(line.text, line.length, &message) == OLP_RC_SUCCESS && message.checksum != OLP_CHECKSUM_WRONG)
///     handle_message(&message);
/// ```
///
/// # Safety
///
/// Pointers, threads and interrupts: the rules at the head.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn olp_parse(line: *const c_char, length: c_int, message: *mut LineMessage) -> c_int {
    // SAFETY: as the contract of this function asks.
    let (text, message) = unsafe { (bytes_of(line.cast(), length), message.as_mut()) };
    let Some(message) = message else { return OLP_RC_ERROR_GENERIC };
    *message = EMPTY;
    let Some(text) = text.filter(|_| !line.is_null()) else { return OLP_RC_ERROR_GENERIC };
    let parsed = match Message::parse(text) {
        Ok(parsed) => parsed,
        Err(Malformed::Command) => return OLP_RC_NO_COMMAND,
        Err(Malformed::Escape | Malformed::LineFeed) => return OLP_RC_MALFORMED,
    };
    message.line = line;
    message.length = int(parsed.line().len());
    message.count = int(parsed.len());
    message.checksum = match parsed.checksum() {
        Checksum::None => OLP_CHECKSUM_NONE,
        Checksum::Right => OLP_CHECKSUM_RIGHT,
        Checksum::Wrong => OLP_CHECKSUM_WRONG,
    };
    message.sum = parsed.sum().into();
    OLP_RC_SUCCESS
}

/// Finds a parameter by its place in the line: 0 is the command, `message->count` - 1 the last.
///
/// Returns `OLP_RC_SUCCESS`, `OLP_RC_NOT_FOUND` when there is none, or `OLP_RC_ERROR_GENERIC` when a pointer is NULL.
/// Unless it succeeds, param is left as it was.
///
/// ```c
/// struct olp_param param;
/// for (int i = 0; olp_param_at(&message, i, &param) == OLP_RC_SUCCESS; ++i)
///     printf("%.*s\n", param.name_length, param.name);
/// ```
///
/// # Safety
///
/// Pointers, threads and interrupts: the rules at the head. message was filled in by `olp_parse` and its line is still
/// there, or is all zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn olp_param_at(message: *const LineMessage, index: c_int, param: *mut LineParam) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe {
        let Some(mut params) = params_of(message) else { return OLP_RC_ERROR_GENERIC };
        give(usize::try_from(index).ok().and_then(|index| params.nth(index)), param)
    }
}

/// Finds a parameter by its name. Names repeat: occurrence tells which of that name, 0 the first. The command is the
/// first `c`.
///
/// Returns what `olp_param_at` does.
///
/// ```c
/// struct olp_param id;
/// if (olp_find(&message, "id", 0, &id) == OLP_RC_SUCCESS)
///     printf("from %.*s\n", id.value_length, id.value);
/// ```
///
/// # Safety
///
/// As for `olp_param_at`; name is NULL or a string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn olp_find(
    message: *const LineMessage,
    name: *const c_char,
    occurrence: c_int,
    param: *mut LineParam,
) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe {
        match find(message, name, occurrence) {
            Ok(found) => give(Some(found), param),
            Err(OLP_RC_NOT_FOUND) => give(None, param),
            Err(code) => code,
        }
    }
}

/// Reads a parameter's value as an integer: an optional sign and decimal digits, perhaps spaces around them.
///
/// Returns `OLP_RC_SUCCESS`, `OLP_RC_MALFORMED` when the value is none, `OLP_RC_RANGE` when a long does not hold it, or
/// `OLP_RC_ERROR_GENERIC` when a pointer is NULL. Unless it succeeds, value is left as it was.
///
/// ```c
/// long state;
/// if (olp_value_int(&param, &state) == OLP_RC_SUCCESS)
///     printf("state %ld\n", state);
/// ```
///
/// # Safety
///
/// Pointers, threads and interrupts: the rules at the head. param was filled in by `olp_param_at` or `olp_find` and its
/// line is still there, or is all zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn olp_value_int(param: *const LineParam, value: *mut c_long) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe { store(value_of(param).map(Value::int), value) }
}

/// Reads a parameter's value as a decimal number, such as `-1000.00` or `1e3`, perhaps with spaces around it: the float
/// that is nearest. Infinities and NaNs are no such numbers.
///
/// Returns what `olp_value_int` does; `OLP_RC_RANGE` when the number is beyond the largest float.
///
/// ```c
/// float temperature;
/// if (olp_value_float(&param, &temperature) == OLP_RC_SUCCESS)
///     printf("%.2f degrees\n", (double)temperature);
/// ```
///
/// # Safety
///
/// As for `olp_value_int`.
#[unsafe(no_mangle)]
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
/// char name[32];
/// if (olp_value_string(&param, name, sizeof name) >= 0)
///     puts(name);
/// ```
///
/// # Safety
///
/// As for `olp_value_int`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn olp_value_string(param: *const LineParam, buf: *mut c_char, cap: c_int) -> c_int {
    // SAFETY: as the contract of this function asks.
    let (value, room) = unsafe { (value_of(param), room_of(buf.cast(), cap)) };
    match (value, room) {
        (Some(value), Some(room)) => decode(value, room),
        _ => OLP_RC_ERROR_GENERIC.wrapping_neg(),
    }
}

/// Whether a parameter's decoded value is that text.
///
/// Returns 1 or 0; 0 when a pointer is NULL.
///
/// ```c
/// if (olp_param_at(&message, 0, &param) == OLP_RC_SUCCESS && olp_value_is(&param, "welcome"))
///     puts("a device has started");
/// ```
///
/// # Safety
///
/// As for `olp_value_int`; text is NULL or a string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn olp_value_is(param: *const LineParam, text: *const c_char) -> c_int {
    // SAFETY: as the contract of this function asks.
    match unsafe { (value_of(param), text_of(text)) } {
        (Some(value), Some(text)) => value.is(text).into(),
        _ => 0,
    }
}

/// `olp_find` and `olp_value_int` in one.
///
/// Returns what they do.
///
/// ```c
/// long state;
/// if (olp_get_int(&message, "state", 0, &state) == OLP_RC_SUCCESS)
///     printf("state %ld\n", state);
/// ```
///
/// # Safety
///
/// As theirs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn olp_get_int(
    message: *const LineMessage,
    name: *const c_char,
    occurrence: c_int,
    value: *mut c_long,
) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe {
        match find(message, name, occurrence) {
            Ok(param) => store(Some(param.value.int()), value),
            Err(code) => code,
        }
    }
}

/// `olp_find` and `olp_value_float` in one.
///
/// Returns what they do.
///
/// ```c
/// float temperature;
/// if (olp_get_float(&message, "temp", 0, &temperature) == OLP_RC_SUCCESS)
///     printf("%.2f degrees\n", (double)temperature);
/// ```
///
/// # Safety
///
/// As theirs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn olp_get_float(
    message: *const LineMessage,
    name: *const c_char,
    occurrence: c_int,
    value: *mut c_float,
) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe {
        match find(message, name, occurrence) {
            Ok(param) => store(Some(param.value.float()), value),
            Err(code) => code,
        }
    }
}

/// `olp_find` and `olp_value_string` in one.
///
/// Returns what `olp_value_string` does, and -`OLP_RC_NOT_FOUND`, buf being then left as it was.
///
/// ```c
/// char name[32];
/// if (olp_get_string(&message, "name", 0, name, sizeof name) >= 0)
///     puts(name);
/// ```
///
/// # Safety
///
/// As theirs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn olp_get_string(
    message: *const LineMessage,
    name: *const c_char,
    occurrence: c_int,
    buf: *mut c_char,
    cap: c_int,
) -> c_int {
    // SAFETY: as the contract of this function asks.
    match unsafe { (find(message, name, occurrence), room_of(buf.cast(), cap)) } {
        (Ok(param), Some(room)) => decode(param.value, room),
        (Err(code), Some(_)) => code.wrapping_neg(),
        (_, None) => OLP_RC_ERROR_GENERIC.wrapping_neg(),
    }
}

/// `olp_find` and `olp_value_is` in one: `olp_is(&message, "c", 0, "welcome")`.
///
/// Returns 1 or 0; 0 when there is no such parameter or a pointer is NULL.
///
/// ```c
/// if (olp_is(&message, "c", 0, "heaterinfo") && olp_is(&message, "id", 0, "M1F910"))
///     handle_message(&message);
/// ```
///
/// # Safety
///
/// As theirs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn olp_is(
    message: *const LineMessage,
    name: *const c_char,
    occurrence: c_int,
    text: *const c_char,
) -> c_int {
    // SAFETY: as the contract of this function asks.
    match unsafe { (find(message, name, occurrence), text_of(text)) } {
        (Ok(param), Some(text)) => param.value.is(text).into(),
        _ => 0,
    }
}

/// # Safety
///
/// As for [`olp_param_at`].
unsafe fn params_of<'a>(message: *const LineMessage) -> Option<Params<'a>> {
    // SAFETY: as the contract of this function asks.
    unsafe {
        let message = message.as_ref()?;
        bytes_of(message.line.cast(), message.length).map(Params::of)
    }
}

/// # Safety
///
/// As for [`olp_find`].
unsafe fn find<'a>(message: *const LineMessage, name: *const c_char, occurrence: c_int) -> Result<Param<'a>, c_int> {
    // SAFETY: as the contract of this function asks.
    let (Some(params), Some(name)) = (unsafe { (params_of(message), text_of(name)) }) else {
        return Err(OLP_RC_ERROR_GENERIC);
    };
    let occurrence = usize::try_from(occurrence).map_err(|_| OLP_RC_NOT_FOUND)?;
    params.find_named(name, occurrence).ok_or(OLP_RC_NOT_FOUND)
}

/// Hands a parameter to C.
///
/// # Safety
///
/// out is NULL or points to a writable parameter.
unsafe fn give(param: Option<Param<'_>>, out: *mut LineParam) -> c_int {
    // SAFETY: as the contract of this function asks.
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

/// # Safety
///
/// As for [`olp_value_int`].
unsafe fn value_of<'a>(param: *const LineParam) -> Option<Value<'a>> {
    // SAFETY: as the contract of this function asks.
    unsafe {
        let param = param.as_ref()?;
        bytes_of(param.value.cast(), param.value_length).map(Value::new)
    }
}

/// Hands a number to C.
///
/// # Safety
///
/// out is NULL or points to a writable number.
unsafe fn store<T>(number: Option<Result<T, NumberError>>, out: *mut T) -> c_int {
    // SAFETY: as the contract of this function asks.
    match (number, unsafe { out.as_mut() }) {
        (Some(Ok(number)), Some(out)) => *out = number,
        (Some(Err(NumberError::Malformed)), Some(_)) => return OLP_RC_MALFORMED,
        (Some(Err(NumberError::Range)), Some(_)) => return OLP_RC_RANGE,
        _ => return OLP_RC_ERROR_GENERIC,
    }
    OLP_RC_SUCCESS
}

/// Writes a decoded value and a zero byte.
fn decode(value: Value<'_>, room: &mut [MaybeUninit<u8>]) -> c_int {
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
    if fits { int(length) } else { OLP_RC_TOO_LONG.wrapping_neg() }
}
