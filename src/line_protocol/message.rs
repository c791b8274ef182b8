//! Lines that were received: which parameters they have, and their checksums.

use core::ffi::{c_char, c_int, c_uint, c_void};

use super::{
    EMPTY, LineMessage, LineParam, OLP_CHECKSUM_NONE, OLP_CHECKSUM_RIGHT, OLP_CHECKSUM_WRONG, OLP_RC_ERROR_GENERIC,
    OLP_RC_MALFORMED, OLP_RC_NO_COMMAND, OLP_RC_NOT_FOUND, OLP_RC_SUCCESS,
};
use crate::memory::{bytes_of, int, text_of};
use deltarobot_export::export;
use deltarobot_protocols::line::{self, Checksum, Malformed, Message, Param, Params, Value};

/// The checksum of the protocol, Fletcher-16 in ones' complement: the second sum in bits 8 to 15, the first in bits 0
/// to 7. Both begin at 255, and neither is ever 0: of no bytes it is 0xFFFF, of a NULL pointer or a negative length
/// too.
///
/// ```c
/// printf("%04x\n", olp_fletcher16(line.text, line.length));
/// ```
#[export]
pub unsafe extern "C" fn olp_fletcher16(bytes: *const c_void, length: c_int) -> c_uint {
    // SAFETY: as the contract of this function asks.
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
    // SAFETY: as the contract of this function asks.
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
    // SAFETY: as the contract of this function asks.
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
    // SAFETY: as the contract of this function asks.
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
    // SAFETY: as the contract of this function asks.
    unsafe {
        let (Some(params), Some(name)) = (params_of(message), text_of(name)) else { return OLP_RC_ERROR_GENERIC };
        give(usize::try_from(occurrence).ok().and_then(|occurrence| params.find_named(name, occurrence)), param)
    }
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
    // SAFETY: as the contract of this function asks.
    unsafe {
        let message = message.as_ref()?;
        bytes_of(message.line.cast(), message.length).map(Params::of)
    }
}

/// The value of a parameter, or why there is none. Unsafe as [`olp_find`] is.
pub(super) unsafe fn find_value<'a>(
    message: *const LineMessage,
    name: *const c_char,
    occurrence: c_int,
) -> Result<Value<'a>, c_int> {
    // SAFETY: as the contract of this function asks.
    let (Some(params), Some(name)) = (unsafe { (params_of(message), text_of(name)) }) else {
        return Err(OLP_RC_ERROR_GENERIC);
    };
    let occurrence = usize::try_from(occurrence).map_err(|_| OLP_RC_NOT_FOUND)?;
    params.value(name, occurrence).ok_or(OLP_RC_NOT_FOUND)
}

/// Hands a parameter to C; out is NULL or points to a writable one.
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
