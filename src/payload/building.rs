//! Building messages.

use core::ffi::{c_int, c_uchar};

use super::{layout_of, position_from, report_from};
use crate::memory::int;
use crate::protocol::{DP_RC_ERROR_GENERIC, DP_RC_SUCCESS, Position, ProtocolMsg, StatusReport};
use crate::sizes::DP_DATA_MAX_SIZE;
use deltarobot_export::export;
use deltarobot_protocols::deltarobot::{Layout, Message, Opcode, PAYLOAD_MAX};

/// Builds a message without payload: `DP_OPCODE_HOMING`, `STATUS`, `CANCEL`, `HOMING_REPL`, `MOVE_REPL` or
/// `GENERAL_ERR`.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when msg is NULL or messages of that opcode have a payload: msg is
/// left as it was.
///
/// ```c
/// struct protocol_msg msg;
/// if (dp_build(&msg, DP_OPCODE_STATUS) == DP_RC_SUCCESS)
///     dp_send(&msg, uart_send, &uart);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_build(msg: *mut ProtocolMsg, opcode: c_uchar) -> c_int {
    // SAFETY: NULL or the caller's whole object.
    unsafe { build(msg, Message::read(Opcode(opcode), &[], Layout::Auto).as_ref(), Layout::Auto) }
}

/// Builds an acknowledgement of the request with the opcode answered, which is not checked.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when msg is NULL.
///
/// ```c
/// struct protocol_msg answer;
/// dp_build_ack(&answer, msg.opcode);
/// dp_send(&answer, uart_send, &uart);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_build_ack(msg: *mut ProtocolMsg, answered: c_uchar) -> c_int {
    // SAFETY: NULL or the caller's whole object.
    unsafe { build(msg, Some(&Message::Ack(Opcode(answered))), Layout::Auto) }
}

/// Builds a refusal likewise, and returns the same.
///
/// ```c
/// struct protocol_msg answer;
/// dp_build_nack(&answer, DP_OPCODE_MOVE);
/// dp_send(&answer, uart_send, &uart);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_build_nack(msg: *mut ProtocolMsg, answered: c_uchar) -> c_int {
    // SAFETY: NULL or the caller's whole object.
    unsafe { build(msg, Some(&Message::Nack(Opcode(answered))), Layout::Auto) }
}

/// Builds a request to move to a position. Its floats are copied bit by bit, NaNs too.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when a pointer is NULL or `DP_DATA_MAX_SIZE` is below 12: msg is
/// left as it was.
///
/// ```c
/// const struct protocol_msg_position target = {1, 2, -3.5f};
/// if (dp_build_move(&msg, &target) == DP_RC_SUCCESS)
///     dp_send(&msg, uart_send, &uart);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_build_move(msg: *mut ProtocolMsg, target: *const Position) -> c_int {
    // SAFETY: NULL or the caller's whole object.
    let Some(target) = (unsafe { position_from(target) }) else { return DP_RC_ERROR_GENERIC };
    // SAFETY: NULL or the caller's whole object.
    unsafe { build(msg, Some(&Message::Move(target)), Layout::Auto) }
}

/// Builds a status report in a layout, `DP_LAYOUT_*`. Floats are copied bit by bit, reserved bits of STAT cleared.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when a pointer is NULL, the layout is none of these, or
/// `DP_DATA_MAX_SIZE` is below the 16 or 13 bytes that it takes: msg is left as it was.
///
/// ```c
/// const struct protocol_msg_status_report report = {1, 2, -3.5f, DP_STATUS_IDLE | DP_BIT_STAT_STOP_A_BIT};
/// if (dp_build_status_report(&msg, &report, DP_LAYOUT_FIRMWARE) == DP_RC_SUCCESS)
///     dp_send(&msg, uart_send, &uart);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_build_status_report(
    msg: *mut ProtocolMsg,
    report: *const StatusReport,
    layout: c_int,
) -> c_int {
    // SAFETY: NULL or the caller's whole object.
    let (Some(report), Some(layout)) = (unsafe { report_from(report) }, layout_of(layout)) else {
        return DP_RC_ERROR_GENERIC;
    };
    // SAFETY: NULL or the caller's whole object.
    unsafe { build(msg, Some(&Message::StatusReport(report)), layout) }
}

/// Fills in a message; leaves it alone when there is none to write or it does not fit.
///
/// # Safety
///
/// msg is NULL or points to a whole object of the caller's.
unsafe fn build(msg: *mut ProtocolMsg, message: Option<&Message>, layout: Layout) -> c_int {
    let (Some(message), false) = (message, msg.is_null()) else { return DP_RC_ERROR_GENERIC };
    let mut payload = [0; PAYLOAD_MAX];
    let length = message.write(layout, &mut payload);
    if length > DP_DATA_MAX_SIZE {
        return DP_RC_ERROR_GENERIC;
    }
    // SAFETY: not NULL, so a whole message, of which the payload has room for the length.
    unsafe {
        (*msg).opcode = message.opcode().0;
        (*msg).data_s = int(length);
        let data = (&raw mut (*msg).data).cast::<u8>();
        for (place, byte) in payload.iter().take(length).enumerate() {
            data.add(place).write(*byte);
        }
        (*msg).checksum_ok = 1;
    }
    DP_RC_SUCCESS
}
