//! Bytes to lines.

use core::ffi::{c_int, c_void};
use core::ptr::null;

use super::{LineText, OLP_LINE_COMPLETE, OLP_LINE_NONE, OLP_LINE_OVERLONG, OLP_RC_ERROR_GENERIC, OLP_RC_SUCCESS};
use crate::memory::{bytes_of, int};
use deltarobot_export::export;
use deltarobot_protocols::line::{Received, Receiver};

/// Makes a receiver empty. All zero it is so, too.
///
/// Returns `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` when receiver is NULL.
///
/// ```c
/// struct olp_receiver receiver;
/// olp_receiver_init(&receiver);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_receiver_init(receiver: *mut Receiver) -> c_int {
    // SAFETY: as the contract of this function asks.
    match unsafe { receiver.as_mut() } {
        Some(receiver) => receiver.clear(),
        None => return OLP_RC_ERROR_GENERIC,
    }
    OLP_RC_SUCCESS
}

/// Takes received bytes up to the end of the next line, and tells in line what they were. Lines end with LF or CR LF;
/// empty ones are passed over. Of a line longer than `OLP_LINE_MAX` nothing is kept: `OLP_LINE_OVERLONG` when its end
/// has come.
///
/// Returns how many bytes were taken: when fewer than there are, it is to be called again with the rest; or
/// -`OLP_RC_ERROR_GENERIC` when receiver or line is NULL, bytes negative, or buf NULL and bytes not 0.
///
/// ```c
/// int got = uart_read(&uart, in, sizeof in);
/// for (int taken = 0; taken < got;) {
///     taken += olp_receive(&receiver, in + taken, got - taken, &line);
///     if (line.kind == OLP_LINE_COMPLETE)
///         puts(line.text);
/// }
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_receive(
    receiver: *mut Receiver,
    buf: *const c_void,
    bytes: c_int,
    line: *mut LineText,
) -> c_int {
    // SAFETY: as the contract of this function asks.
    let (Some(receiver), Some(bytes), Some(line)) =
        (unsafe { (receiver.as_mut(), bytes_of(buf, bytes), line.as_mut()) })
    else {
        return OLP_RC_ERROR_GENERIC.wrapping_neg();
    };
    let (taken, found) = receiver.take(bytes);
    *line = match found {
        Received::Nothing => LineText { kind: OLP_LINE_NONE, text: null(), length: 0 },
        Received::Line(length) => {
            LineText { kind: OLP_LINE_COMPLETE, text: receiver.line(length).as_ptr().cast(), length: int(length) }
        }
        Received::Overlong => LineText { kind: OLP_LINE_OVERLONG, text: null(), length: 0 },
    };
    int(taken)
}
