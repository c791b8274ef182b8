//! Bytes to lines.

use core::ffi::{c_int, c_ulong, c_void};
use core::ptr::null;

use super::{LineText, OLP_LINE_COMPLETE, OLP_LINE_NONE, OLP_LINE_OVERLONG, OLP_RC_ERROR_GENERIC, OLP_RC_SUCCESS};
use crate::memory::{bytes_of, int};
use crate::sizes::OLP_LINE_MAX;
use crate::state::{Room, state};
use deltarobot_export::export;
use deltarobot_protocols::line::{self, Received};

/// `unsigned long`s of a receiver, with some room to spare.
pub const OLP_RECEIVER_WORDS: usize = OLP_LINE_MAX / 4 + 3;

/// A receiver of lines up to `OLP_LINE_MAX` bytes. All zero is an empty one.
#[derive(Debug)]
#[repr(C)]
pub struct Receiver {
    opaque: [c_ulong; OLP_RECEIVER_WORDS],
}
state!(Receiver: line::Receiver<{ OLP_LINE_MAX + 1 }>);

/// Makes a receiver empty, as it is when all zero. Returns `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` for NULL.
///
/// ```c
/// olp_receiver_init(&receiver);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_receiver_init(receiver: *mut Receiver) -> c_int {
    // SAFETY: this is Room's contract.
    match unsafe { Receiver::get(receiver) } {
        Some(receiver) => receiver.clear(),
        None => return OLP_RC_ERROR_GENERIC,
    }
    OLP_RC_SUCCESS
}

/// Takes received bytes up to the end of the next line, and reports in line what they were. Lines end with LF or CR LF;
/// empty ones are passed over. One longer than `OLP_LINE_MAX` is lost: `OLP_LINE_OVERLONG` when its end has come.
///
/// Returns how many bytes were taken: when fewer than there are, it is to be called again with the rest; or
/// -`OLP_RC_ERROR_GENERIC` when receiver or line is NULL, bytes negative, or buf NULL and bytes not 0.
///
/// ```c
/// int taken = olp_receive(&receiver, in, length, &line);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_receive(
    receiver: *mut Receiver,
    buf: *const c_void,
    bytes: c_int,
    line: *mut LineText,
) -> c_int {
    // SAFETY: the objects of one call don't overlap, so that each may be borrowed.
    let (Some(receiver), Some(bytes), Some(line)) =
        (unsafe { (Receiver::get(receiver), bytes_of(buf, bytes), line.as_mut()) })
    else {
        return -OLP_RC_ERROR_GENERIC;
    };
    receiver.release();
    let taken = receiver.take(bytes);
    *line = match receiver.received() {
        Received::Nothing => LineText { kind: OLP_LINE_NONE, text: null(), length: 0 },
        Received::Line(text) => {
            LineText { kind: OLP_LINE_COMPLETE, text: text.as_ptr().cast(), length: int(text.len()) }
        }
        Received::TooLong => LineText { kind: OLP_LINE_OVERLONG, text: null(), length: 0 },
    };
    int(taken)
}
