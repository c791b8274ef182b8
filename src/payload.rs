//! `libdeltarobot/payload.h`: building, reading and printing the messages of the specification.

use core::ffi::{c_char, c_int, c_uchar};
use core::mem::align_of;

use super::memory::{bytes_of, int};
use super::protocol::{DP_RC_ERROR_GENERIC, DP_RC_SUCCESS, Position, ProtocolMsg, StatusReport};
use crate::sizes::DP_DATA_MAX_SIZE;
use deltarobot_export::export;
use deltarobot_protocols::deltarobot as core_;
use deltarobot_protocols::deltarobot::{Layout, Message, Opcode, PAYLOAD_MAX, Report, TEXT_MAX, describe};

/// Reading a status report: one of more than 13 bytes has the floats first. 13 bytes may be either layout (firmware
/// like the shipped one sends so many on AVR); the reading counts in which more is plausible: STAT, when its reserved
/// bits (5 to 7) are alike; each float that is zero or of a magnitude from 1.1e-19 to 3.6e19; and twice as much each
/// that is unknown, 0x7F800001 or 0x7FC00000 with either sign. Of equal ones it is floats first. A session of `host.h`
/// takes the layout of the last report that was clear (of 14 bytes or more, or better by two), unless this one is too.
/// Writing one: as `DP_LAYOUT_FIRMWARE`.
pub const DP_LAYOUT_AUTO: c_int = 0;
/// Status reports as in specification v1.0: STAT, DA, DB, DC; exactly 13 bytes.
pub const DP_LAYOUT_SPEC: c_int = 1;
/// Status reports as shipped firmware sends them: DA, DB, DC, STAT, 3 bytes, written as 0; read from 13 bytes on.
pub const DP_LAYOUT_FIRMWARE: c_int = 2;

/// Size of a buffer that the text of any message fits in.
pub const DP_MSG_TEXT_MAX: c_int = 96;

const _: () = assert!(DP_MSG_TEXT_MAX as usize == TEXT_MAX);

/// Builds a message without payload: `DP_OPCODE_HOMING`, `STATUS`, `CANCEL`, `HOMING_REPL`, `MOVE_REPL`, `GENERAL_ERR`.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` and leaves msg alone when it is NULL or opcode none of these.
///
/// ```c
/// if (dp_build(&msg, DP_OPCODE_STATUS) == DP_RC_SUCCESS)
///     dp_send(&msg, uart_send, &uart);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_build(msg: *mut ProtocolMsg, opcode: c_uchar) -> c_int {
    // SAFETY: NULL or the caller's whole object.
    unsafe { build(msg, Message::read(Opcode(opcode), &[], Layout::Auto).as_ref(), Layout::Auto) }
}

/// Builds an acknowledgement of the request with the opcode answered, which is not checked. Returns `DP_RC_SUCCESS`, or
/// `DP_RC_ERROR_GENERIC` when msg is NULL.
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

/// Builds a refusal, as `dp_build_ack` builds an acknowledgement.
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

/// Builds a request to move to a position. Its floats are copied bit by bit, NaNs too. Returns `DP_RC_SUCCESS`, or
/// `DP_RC_ERROR_GENERIC` and leaves msg alone when a pointer is NULL or `DP_DATA_MAX_SIZE` below 12.
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

/// Whether a message is one of the specification's, with a known opcode and a payload of its length. Returns
/// `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when it is not or msg is NULL.
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

/// Reads from an ack or a nack which opcode it answers. Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC`, answered left
/// as it was, when msg is neither or not 1 byte long, or a pointer is NULL.
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

/// Reads from a request to move where to; the floats, copied bit by bit, may be NaNs. Returns `DP_RC_SUCCESS`, or
/// `DP_RC_ERROR_GENERIC`, target left as it was, when msg is no such request or not 12 bytes long, or a pointer is NULL.
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

/// Returns the name of an opcode for logs, a string that lives as long as the program: `ACK`, `NACK`, `HOMING!`,
/// `STATUS?`, `MOVE!`, `CANCEL!`, `HOMING_REPLY`, `STATUS_REPLY`, `MOVE_REPLY`, `GENERAL_ERROR` or `UNKNOWN_OPCODE`.
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
        _ => return -DP_RC_ERROR_GENERIC,
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

// A position of C's is read and written as three u32, the bits of its floats.
const _: () = assert!(align_of::<u32>() == align_of::<Position>() && size_of::<[u32; 3]>() == size_of::<Position>());

/// The payload of a message; `None` when its size is out of range.
///
/// # Safety
///
/// msg points to a message, which nobody writes while the slice lives.
unsafe fn payload_of<'a>(msg: *const ProtocolMsg) -> Option<&'a [u8]> {
    // SAFETY: a message can be read.
    let length = unsafe { (*msg).data_s };
    if length > const { int(DP_DATA_MAX_SIZE) } {
        return None;
    }
    // SAFETY: data has at least so many bytes, and the contract is that of the slice.
    unsafe { bytes_of((&raw const (*msg).data).cast(), length) }
}

/// The layout that a `DP_LAYOUT_*` means.
pub(super) const fn layout_of(layout: c_int) -> Option<Layout> {
    match layout {
        DP_LAYOUT_AUTO => Some(Layout::Auto),
        DP_LAYOUT_SPEC => Some(Layout::Spec),
        DP_LAYOUT_FIRMWARE => Some(Layout::Firmware),
        _ => None,
    }
}

/// Takes a position over from C, as bits: a signalling NaN would not survive being loaded as a float.
///
/// # Safety
///
/// position is NULL or points to one.
pub(super) unsafe fn position_from(position: *const Position) -> Option<core_::Position> {
    // SAFETY: three floats have the layout of three u32 (asserted above), and any bits are a u32.
    unsafe { position.cast::<[u32; 3]>().as_ref() }.map(|bits| core_::Position(*bits))
}

/// Hands a position to C, as bits.
///
/// # Safety
///
/// out points to a writable position.
pub(super) unsafe fn position_to(out: *mut Position, position: core_::Position) {
    // SAFETY: three floats have the layout of three u32, and any bits are a float.
    unsafe { out.cast::<[u32; 3]>().write(position.0) };
}

/// Takes a status report over from C.
///
/// # Safety
///
/// report is NULL or points to one.
pub(super) unsafe fn report_from(report: *const StatusReport) -> Option<Report> {
    // SAFETY: a report begins with what a position consists of; it is read only when it is not NULL.
    unsafe { position_from(report.cast()).map(|position| Report::new(position, (*report).STAT)) }
}

/// Hands a status report to C.
///
/// # Safety
///
/// out points to a writable status report.
pub(super) unsafe fn report_to(out: *mut StatusReport, report: &Report) {
    // SAFETY: a report begins with what a position consists of.
    unsafe {
        position_to(out.cast(), report.position);
        (*out).STAT = report.stat();
    }
}
