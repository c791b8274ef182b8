//! `libdeltarobot/receiver.h`: a receiver of frames that is smaller and faster than the drop-in ring: it owns the
//! buffer of one frame.
//!
//! Each byte from the line is stored, in an interrupt if need be; what it means is found out later, where messages are
//! fetched:
//!
//! ```c
//! struct protocol_msg msg;
//!
//! if (dp_receiver_byte(&receiver, byte))
//!     while (dp_receiver_next(&receiver, &msg) == DP_RC_SUCCESS)
//!         handle(&msg);
//! ```
//!
//! Every intact frame is found, as `dp_recv` finds it: behind a byte that begins none, the search goes on with the next
//! one; what may become a frame is waited for.

use core::ffi::{c_int, c_uchar, c_ulong, c_void};
use core::mem::MaybeUninit;

use super::memory::{bytes_of, int};
use super::protocol::{
    DP_RC_ERROR_GENERIC, DP_RC_GARBAGE, DP_RC_NO_FRAME, DP_RC_OVERFLOW, DP_RC_SUCCESS, NO_OPCODE, ProtocolMsg, deliver,
};
use super::protocol_ext::MsgFunc;
use super::state::{Room, state};
use crate::sizes::DP_DATA_MAX_SIZE;
use deltarobot_export::export;
use deltarobot_protocols::bytes;
use deltarobot_protocols::deltarobot::{Frame, NoFrame, Receiver as State, receiver_room};

/// Words of a receiver's room. C's macro is in receiver/macros.h.
pub const DP_RECEIVER_WORDS: usize = (DP_DATA_MAX_SIZE + 16).div_ceil(size_of::<c_ulong>());

/// A receiver. All zero is one that has received nothing.
#[derive(Debug)]
#[repr(C)]
pub struct Receiver {
    opaque: [c_ulong; DP_RECEIVER_WORDS],
}

state!(Receiver: State<{ receiver_room(DP_DATA_MAX_SIZE) }>);

/// Makes an empty receiver of any memory, as setting it to zero does; the library's safety never needs that. Returns
/// `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when receiver is NULL.
///
/// ```c
/// struct dp_receiver receiver;
/// dp_receiver_init(&receiver);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_receiver_init(receiver: *mut Receiver) -> c_int {
    // SAFETY: NULL, or memory as the rules at the head ask.
    match unsafe { Receiver::init(receiver) } {
        Some(_) => DP_RC_SUCCESS,
        None => DP_RC_ERROR_GENERIC,
    }
}

/// Takes a received byte. It only stores the byte and compares a count, so that it fits an interrupt;
/// `dp_receiver_next` must not run at the same time.
///
/// Returns 0, or 1 when `dp_receiver_next` is to be called, at once or a few bytes later: what comes meanwhile is kept
/// as long as there is room. When there is none, -`DP_RC_OVERFLOW` is returned and the byte is not taken: call
/// `dp_receiver_next`, then give it again. Returns -`DP_RC_ERROR_GENERIC` when receiver is NULL.
///
/// ```c
/// if (dp_receiver_byte(&receiver, byte))
///     fetch = 1;
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_receiver_byte(receiver: *mut Receiver, byte: c_uchar) -> c_int {
    // SAFETY: NULL, or as the rules at the head ask.
    let Some(receiver) = (unsafe { Receiver::get(receiver) }) else { return -DP_RC_ERROR_GENERIC };
    match receiver.byte(byte) {
        Ok(is_due) => c_int::from(is_due),
        Err(_) => -DP_RC_OVERFLOW,
    }
}

/// Fetches the next message: to be called until it does not return `DP_RC_SUCCESS`.
///
/// Returns `DP_RC_SUCCESS` and the message, `DP_RC_NO_FRAME` when more bytes are needed, `DP_RC_GARBAGE` when more are
/// needed and some that can't be part of a frame were thrown away, or `DP_RC_ERROR_GENERIC` when a pointer is NULL.
/// Without a message, `opcode` is set to 0xFF and the rest of msg is left as it was.
///
/// ```c
/// struct protocol_msg msg;
/// while (dp_receiver_next(&receiver, &msg) == DP_RC_SUCCESS)
///     handle(&msg);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_receiver_next(receiver: *mut Receiver, msg: *mut ProtocolMsg) -> c_int {
    if msg.is_null() {
        return DP_RC_ERROR_GENERIC;
    }
    // SAFETY: NULL, or as the rules at the head ask; msg is not NULL.
    unsafe {
        let code = match Receiver::get(receiver) {
            // A function of its own, so that no registers are saved where there is nothing to do.
            Some(receiver) if receiver.is_due() => return next(receiver, msg),
            Some(_) => DP_RC_NO_FRAME,
            None => DP_RC_ERROR_GENERIC,
        };
        (*msg).opcode = NO_OPCODE;
        code
    }
}

/// # Safety
///
/// msg points to a writable message outside the receiver.
#[inline(never)]
unsafe fn next(receiver: &mut State<{ receiver_room(DP_DATA_MAX_SIZE) }>, msg: *mut ProtocolMsg) -> c_int {
    // SAFETY: the same contract.
    unsafe { hand_over(receiver.next_due(), msg) }
}

/// Fetches the next message when the line has been quiet for longer than a frame takes, as `dp_recv_idle` does: what is
/// incomplete is given up, and what stands behind it delivered.
///
/// Returns what `dp_recv_idle` does.
///
/// ```c
/// if (now_ms() - heard_at >= 10)
///     while (dp_receiver_idle(&receiver, &msg) == DP_RC_SUCCESS)
///         handle(&msg);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_receiver_idle(receiver: *mut Receiver, msg: *mut ProtocolMsg) -> c_int {
    if msg.is_null() {
        return DP_RC_ERROR_GENERIC;
    }
    // SAFETY: NULL, or as the rules at the head ask; msg is not NULL.
    unsafe {
        let Some(receiver) = Receiver::get(receiver) else {
            (*msg).opcode = NO_OPCODE;
            return DP_RC_ERROR_GENERIC;
        };
        hand_over(receiver.next_idle(&mut ()), msg)
    }
}

/// Takes any number of received bytes, and calls `on_msg` for each message as soon as it is complete. Frames that lie
/// in buf are not copied into the receiver. buf's bytes stay as they are until the call returns.
///
/// Returns what `dp_process_each` does, receiver in place of data.
///
/// ```c
/// int got = uart_read(&uart, in, sizeof in);
/// dp_receiver_each(&receiver, in, got, on_msg, NULL);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_receiver_each(
    receiver: *mut Receiver,
    buf: *const c_void,
    bytes: c_int,
    on_msg: MsgFunc,
    usr: *mut c_void,
) -> c_int {
    // SAFETY: as the rules at the head ask.
    let (Some(on_msg), Some(input)) = (on_msg, unsafe { bytes_of(buf, bytes) }) else {
        return -DP_RC_ERROR_GENERIC;
    };
    let mut rest = input;
    let mut msg = MaybeUninit::<ProtocolMsg>::uninit();
    loop {
        // SAFETY: NULL, or as the rules at the head ask; the reference ends before on_msg is called.
        let Some(receiver) = (unsafe { Receiver::get(receiver) }) else {
            return -DP_RC_ERROR_GENERIC;
        };
        // SAFETY: msg is ours.
        if unsafe { hand_over(receiver.next_of(&mut rest), msg.as_mut_ptr()) } != DP_RC_SUCCESS {
            return bytes;
        }
        // SAFETY: on_msg can be called with usr.
        if unsafe { on_msg(msg.as_ptr(), usr) } != 0 {
            return int(input.len().wrapping_sub(rest.len()));
        }
    }
}

/// Writes the message of a frame, and returns its code.
///
/// # Safety
///
/// msg points to a writable message outside the receiver.
#[inline(always)]
unsafe fn hand_over(frame: Result<Frame<'_>, NoFrame>, msg: *mut ProtocolMsg) -> c_int {
    // SAFETY: the same contract; the receiver accepts no longer payload. msg may be uninitialised: so no reference to it
    // is made.
    unsafe {
        match frame {
            Ok(Frame { opcode, payload }) => {
                deliver(msg, opcode, payload.len(), |data| bytes::copy(payload, data, MaybeUninit::new));
                DP_RC_SUCCESS
            }
            Err(none) => {
                (*msg).opcode = NO_OPCODE;
                if none == NoFrame::Garbage { DP_RC_GARBAGE } else { DP_RC_NO_FRAME }
            }
        }
    }
}
