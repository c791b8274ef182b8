//! Reading messages.

use core::ffi::{c_int, c_uchar};

use super::{layout_of, payload_of, position_to, report_to};
use crate::protocol::{DP_RC_ERROR_GENERIC, DP_RC_SUCCESS, Position, ProtocolMsg, StatusReport};
use deltarobot_export::export;
use deltarobot_protocols::deltarobot::{Layout, Message, Opcode};

/// Whether a message is one of the specification's: a known opcode, and a payload of the length that it asks for.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when it is not or msg is NULL.
///
/// ```c
/// while (dp_recv(&ring, &msg) == DP_RC_SUCCESS)
///     if (dp_msg_check(&msg) == DP_RC_SUCCESS)
///         handle(&msg);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_msg_check(msg: *const ProtocolMsg) -> c_int {
    // SAFETY: NULL or the caller's whole object.
    if unsafe { read(msg, Layout::Auto) }.is_some() { DP_RC_SUCCESS } else { DP_RC_ERROR_GENERIC }
}

/// Reads from an ack or a nack which opcode it answers.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC`, answered left as it was, when msg is no such, or a pointer NULL.
///
/// ```c
/// unsigned char answered;
/// if (msg.opcode == DP_OPCODE_NACK && dp_read_answer(&msg, &answered) == DP_RC_SUCCESS)
///     printf("refused: %s\n", dp_opcode_name(answered));
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_read_answer(msg: *const ProtocolMsg, answered: *mut c_uchar) -> c_int {
    // SAFETY: each is NULL or the caller's whole object.
    match unsafe { (read(msg, Layout::Auto), answered.as_mut()) } {
        (Some(Message::Ack(opcode) | Message::Nack(opcode)), Some(answered)) => *answered = opcode.0,
        _ => return DP_RC_ERROR_GENERIC,
    }
    DP_RC_SUCCESS
}

/// Reads from a request to move where to. The floats are copied bit by bit and may be NaNs.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC`, target left as it was, when msg is no such, or a pointer NULL.
///
/// ```c
/// struct protocol_msg_position target;
/// if (dp_read_move(&msg, &target) == DP_RC_SUCCESS)
///     motors_move(target.DA, target.DB, target.DC);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_read_move(msg: *const ProtocolMsg, target: *mut Position) -> c_int {
    // SAFETY: NULL or the caller's whole object.
    match unsafe { read(msg, Layout::Auto) } {
        // SAFETY: not NULL, so the caller's whole object.
        Some(Message::Move(position)) if !target.is_null() => unsafe { position_to(target, position) },
        _ => return DP_RC_ERROR_GENERIC,
    }
    DP_RC_SUCCESS
}

/// Reads a status report of a layout, `DP_LAYOUT_*`. The floats are copied bit by bit: an unknown position is a NaN, a
/// signalling one from shipped firmware. Reserved bits of STAT are cleared.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC`, report left as it was, when msg is no status report or of a
/// length that the layout does not have, the layout is none of these, or a pointer is NULL.
///
/// ```c
/// struct protocol_msg_status_report report;
/// if (dp_read_status_report(&msg, DP_LAYOUT_AUTO, &report) == DP_RC_SUCCESS)
///     is_idle = (report.STAT & DP_BIT_STAT_STATUS_BITS) == DP_STATUS_IDLE;
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_read_status_report(
    msg: *const ProtocolMsg,
    layout: c_int,
    report: *mut StatusReport,
) -> c_int {
    let Some(layout) = layout_of(layout) else { return DP_RC_ERROR_GENERIC };
    // SAFETY: NULL or the caller's whole object.
    match unsafe { read(msg, layout) } {
        // SAFETY: not NULL, so the caller's whole object.
        Some(Message::StatusReport(read)) if !report.is_null() => unsafe { report_to(report, &read) },
        _ => return DP_RC_ERROR_GENERIC,
    }
    DP_RC_SUCCESS
}

/// What a message says, if it is one of the specification's.
///
/// # Safety
///
/// msg is NULL or points to a whole object of the caller's.
unsafe fn read(msg: *const ProtocolMsg, layout: Layout) -> Option<Message> {
    if msg.is_null() {
        return None;
    }
    // SAFETY: not NULL, so a whole message, which nobody writes meanwhile.
    unsafe { Message::read(Opcode((*msg).opcode), payload_of(msg)?, layout) }
}
