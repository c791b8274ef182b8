//! Messages as text.

use core::ffi::{c_char, c_int, c_uchar};

use super::payload_of;
use crate::memory::int;
use crate::protocol::{DP_RC_ERROR_GENERIC, ProtocolMsg};
use deltarobot_export::export;
use deltarobot_protocols::deltarobot::{Opcode, TEXT_MAX, describe};

/// Size of a buffer that the text of any message fits in.
pub const DP_MSG_TEXT_MAX: c_int = 96;

const _: () = assert!(DP_MSG_TEXT_MAX as usize == TEXT_MAX);

/// The name of an opcode for logs: `ACK`, `NACK`, `HOMING!`, `STATUS?`, `MOVE!`, `CANCEL!`, `HOMING_REPLY`,
/// `STATUS_REPLY`, `MOVE_REPLY`, `GENERAL_ERROR`, or `UNKNOWN_OPCODE`. Can be called at any time.
///
/// Returns a string that lives as long as the program.
///
/// ```c
/// printf("%s, %d bytes\n", dp_opcode_name(msg.opcode), msg.data_s);
/// ```
#[export]
pub extern "C" fn dp_opcode_name(opcode: c_uchar) -> *const c_char {
    Opcode(opcode).terminated_name().as_ptr().cast()
}

/// Writes a message as a line of text without a line's end, such as `STATUS_REPLY: IDLE  DA=0  DB=0  DC=-3.5 STP_A`.
///
/// snprintf's rules: of a text that does not fit, as much as does is written, always a zero byte behind it; with cap 0
/// nothing is written and buf may be NULL. No text reaches `DP_MSG_TEXT_MAX`. Numbers are written as `%g` writes them.
/// Status reports are read as `DP_LAYOUT_AUTO`; a payload of the wrong length is not shown.
///
/// Returns the length of the whole text without the zero byte, or -`DP_RC_ERROR_GENERIC` when msg is NULL, cap is
/// negative, or buf is NULL and cap is not 0.
///
/// ```c
/// char text[DP_MSG_TEXT_MAX];
/// if (dp_msg_format(&msg, text, sizeof text) > 0)
///     puts(text);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_msg_format(msg: *const ProtocolMsg, buf: *mut c_char, cap: c_int) -> c_int {
    let room = match usize::try_from(cap) {
        Ok(cap) if !msg.is_null() && (cap == 0 || !buf.is_null()) => cap,
        _ => return DP_RC_ERROR_GENERIC.wrapping_neg(),
    };
    let mut length = 0_usize;
    let mut put = |byte: u8| {
        if length.wrapping_add(1) < room {
            // SAFETY: below the capacity, so in the caller's buffer.
            unsafe { buf.add(length).cast::<u8>().write(byte) };
        }
        length = length.wrapping_add(1);
    };
    // SAFETY: msg is not NULL, so a whole message, which nobody writes meanwhile.
    let (opcode, payload) = unsafe { (Opcode((*msg).opcode), payload_of(msg)) };
    describe(opcode, payload.unwrap_or_default(), &mut put);
    if let Some(last) = room.checked_sub(1) {
        // SAFETY: below the capacity, so in the caller's buffer.
        unsafe { buf.add(length.min(last)).write(0) };
    }
    int(length)
}
