//! `libdeltarobot/protocol.h`: frames of the deltarobot message format, specification v1.0.

use core::ffi::{c_char, c_float, c_int, c_uchar, c_void};
use core::mem::MaybeUninit;
use core::slice;

use super::memory::{bytes_of, int};
use crate::sizes::DP_DATA_MAX_SIZE;
use deltarobot_export::export;
use deltarobot_protocols::config::FAST;
use deltarobot_protocols::deltarobot::{FRAME_MAX, Opcode, Ring, encode};

pub(super) mod receiving;

use receiving::{any_message, next_message};

/// The operation completed.
pub const DP_RC_SUCCESS: c_int = 0;
/// A NULL pointer or a size out of range: nothing was done.
pub const DP_RC_ERROR_GENERIC: c_int = 1;
/// No frame is complete yet.
pub const DP_RC_NO_FRAME: c_int = 2;
/// The ring was too full: its oldest bytes, or bytes that it can't hold at all, were lost.
pub const DP_RC_OVERFLOW: c_int = 3;
/// Bytes that can't be part of a frame were thrown away, and no frame is complete yet.
pub const DP_RC_GARBAGE: c_int = 4;

/// State of the platform: idle.
pub const DP_STATUS_IDLE: c_int = 0;
/// State of the platform: homing.
pub const DP_STATUS_HOMING: c_int = 1;
/// State of the platform: moving.
pub const DP_STATUS_MOVING: c_int = 2;
/// State of the platform: at error.
pub const DP_STATUS_ERROR: c_int = 3;

/// The bits of STAT that hold the state.
pub const DP_BIT_STAT_STATUS_BITS: c_int = 0x03;
/// STAT's state bits: idle.
pub const DP_BIT_STAT_STATUS_IDLE: c_int = 0;
/// STAT's state bits: homing.
pub const DP_BIT_STAT_STATUS_HOMING: c_int = 1;
/// STAT's state bits: moving.
pub const DP_BIT_STAT_STATUS_MOVING: c_int = 2;
/// STAT's state bits: at error.
pub const DP_BIT_STAT_STATUS_ERROR: c_int = 3;
/// An end stop's bit, shifted down: pressed.
pub const DP_BIT_STAT_STOP_PRESSED: c_int = 1;
/// An end stop's bit, shifted down: not pressed.
pub const DP_BIT_STAT_STOP_CLEAR: c_int = 0;

/// One message: what a frame carries.
#[derive(Debug)]
#[repr(C)]
pub struct ProtocolMsg {
    /// What the message is, one of `DP_OPCODE_*`; 0xFF after a call that received none.
    pub opcode: c_uchar,
    /// Number of bytes in data, 0 to `DP_DATA_MAX_SIZE`.
    pub data_s: c_int,
    /// The payload. Receiving leaves the bytes from `data_s` on as they are.
    pub data: [c_char; DP_DATA_MAX_SIZE],
    /// 1 in a received message. Ignored when sending.
    pub checksum_ok: c_int,
}

/// The payload of a status report as the shipped firmware lays it out: 16 bytes with the padding behind STAT.
/// Displacements are in the firmware's own unit: the specification names none.
#[derive(Debug)]
#[repr(C)]
#[expect(non_snake_case, reason = "the original's names")]
pub struct StatusReport {
    /// Displacement of arm A; a NaN when unknown.
    pub DA: c_float,
    /// Displacement of arm B; a NaN when unknown.
    pub DB: c_float,
    /// Displacement of arm C; a NaN when unknown.
    pub DC: c_float,
    /// State and end stops, see `DP_BIT_STAT_*`.
    pub STAT: c_uchar,
}

/// The payload of a move request: 12 bytes, in the unit of status reports.
#[derive(Debug)]
#[repr(C)]
#[expect(non_snake_case, reason = "the original's names")]
pub struct Position {
    /// Displacement of arm A.
    pub DA: c_float,
    /// Displacement of arm B.
    pub DB: c_float,
    /// Displacement of arm C.
    pub DC: c_float,
}

/// Writes a whole frame of bytes bytes somewhere; usr is what `dp_send` was given. `dp_send` returns its result.
/// The frame may be changed, and is gone when the function returns.
///
/// ```c
/// int uart_send(void *buf, int bytes, void *usr)
/// {
///     return uart_write((struct uart *)usr, buf, bytes) == bytes ? 0 : -1;
/// }
/// ```
pub type SendFunc = Option<unsafe extern "C" fn(buf: *mut c_void, bytes: c_int, usr: *mut c_void) -> c_int>;

type Send = unsafe extern "C" fn(buf: *mut c_void, bytes: c_int, usr: *mut c_void) -> c_int;

/// Adds received bytes at the ring's end.
///
/// When they do not fit, the oldest bytes make room; of more than `DP_BUFSIZE` bytes the first `DP_BUFSIZE` are
/// taken. A ring whose fields are out of range counts as empty.
///
/// Not for an interrupt that may come during another call on the ring: there, bytes go into a queue of the program's
/// own.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_OVERFLOW` when bytes were lost, or `DP_RC_ERROR_GENERIC` when data is NULL, bytes is
/// negative, or buf is NULL and bytes is not 0.
///
/// ```c
/// int got = uart_read(&uart, in, sizeof in);
/// if (dp_process(&ring, in, got) == DP_RC_OVERFLOW)
///     ++losses;
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_process(data: *mut Ring, buf: *mut c_void, bytes: c_int) -> c_int {
    // SAFETY: the same contract.
    unsafe { process(data, buf, bytes) }
}

#[inline(always)]
unsafe fn process(data: *mut Ring, buf: *mut c_void, bytes: c_int) -> c_int {
    // SAFETY: where neither is NULL, they are a ring and a byte by the contract of dp_process; else the same contract.
    unsafe {
        if FAST && neither_null(data, buf) && bytes == 1 {
            return match (*data).push(*buf.cast()) {
                Ok(()) => DP_RC_SUCCESS,
                Err((end, used)) => process_in_front(data, buf, end, used),
            };
        }
        process_any(data, buf, bytes)
    }
}

/// A byte that goes to the ring's beginning, where those at its end go on, or into a full one.
///
/// # Safety
///
/// As for [`dp_process`], with neither pointer NULL, and a single byte.
#[inline(never)]
unsafe fn process_in_front(data: *mut Ring, buf: *mut c_void, end: usize, used: usize) -> c_int {
    // SAFETY: the same contract.
    unsafe { if (*data).push_in_front(end, used, *buf.cast()) { DP_RC_SUCCESS } else { process_any(data, buf, 1) } }
}

/// Any number of bytes. A function of its own where there is a faster way for a single one.
#[cfg_attr(target_pointer_width = "64", inline(never))]
#[cfg_attr(not(target_pointer_width = "64"), inline(always))]
unsafe fn process_any(data: *mut Ring, buf: *mut c_void, bytes: c_int) -> c_int {
    // SAFETY: both are as the contract of dp_process asks.
    let (Some(ring), Some(input)) = (unsafe { data.as_mut() }, unsafe { bytes_of(buf, bytes) }) else {
        return DP_RC_ERROR_GENERIC;
    };
    match ring.append(input) {
        Ok(()) => DP_RC_SUCCESS,
        Err(_) => DP_RC_OVERFLOW,
    }
}

/// Takes the next message out of the ring.
///
/// An incomplete frame at the ring's start is waited for, whatever stands behind it; bytes that can't be part
/// of a frame are thrown away.
///
/// Returns `DP_RC_SUCCESS` and the message, `DP_RC_NO_FRAME` when more bytes are needed, `DP_RC_GARBAGE` when more are
/// needed and some were thrown away, or `DP_RC_ERROR_GENERIC` when a pointer is NULL. Without a message, `opcode`
/// is set to 0xFF and the rest of msg is left as it was.
///
/// ```c
/// struct protocol_msg msg;
/// while (dp_recv(&ring, &msg) == DP_RC_SUCCESS)
///     handle(&msg);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_recv(data: *mut Ring, msg: *mut ProtocolMsg) -> c_int {
    // SAFETY: the same contract.
    unsafe { recv(data, msg) }
}

#[inline(always)]
unsafe fn recv(data: *mut Ring, msg: *mut ProtocolMsg) -> c_int {
    if FAST && neither_null(data, msg) {
        // SAFETY: not NULL, so both are as the contract of dp_recv asks.
        return unsafe { next_message(&mut *data, msg) };
    }
    // SAFETY: the same contract.
    unsafe { any_message(data, msg, false) }
}

/// Sends a message: calls sendfunc once, with the whole frame and usr.
///
/// The opcode is not checked.
///
/// Returns what sendfunc returned, or `DP_RC_ERROR_GENERIC` without calling it when msg or sendfunc is NULL or `data_s`
/// is outside 0 to `DP_DATA_MAX_SIZE`.
///
/// ```c
/// struct protocol_msg msg;
/// msg.opcode = DP_OPCODE_HOMING;
/// msg.data_s = 0;
/// dp_send(&msg, uart_send, &uart);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_send(msg: *mut ProtocolMsg, sendfunc: SendFunc, usr: *mut c_void) -> c_int {
    // SAFETY: the same contract.
    unsafe { send(msg, sendfunc, usr) }
}

#[inline(always)]
unsafe fn send(msg: *mut ProtocolMsg, sendfunc: SendFunc, usr: *mut c_void) -> c_int {
    let (Some(sendfunc), false) = (sendfunc, msg.is_null()) else {
        return DP_RC_ERROR_GENERIC;
    };
    // SAFETY: not NULL, so a message by the contract of dp_send.
    let length = unsafe { (*msg).data_s };
    if !(0..=const { int(DP_DATA_MAX_SIZE) }).contains(&length) {
        return DP_RC_ERROR_GENERIC;
    }
    // SAFETY: the same contract, and the length was looked at.
    unsafe {
        if FAST && length > 16 {
            return send_long(msg, length, sendfunc, usr);
        }
        send_of(msg, length, sendfunc, usr)
    }
}

/// A payload of more than 16 bytes: its loops would cost registers in the way of the others.
#[inline(never)]
unsafe fn send_long(msg: *mut ProtocolMsg, length: c_int, sendfunc: Send, usr: *mut c_void) -> c_int {
    // SAFETY: the same contract.
    unsafe { send_of(msg, length, sendfunc, usr) }
}

#[inline(always)]
unsafe fn send_of(msg: *mut ProtocolMsg, length: c_int, sendfunc: Send, usr: *mut c_void) -> c_int {
    let mut frame = [MaybeUninit::uninit(); FRAME_MAX];
    // SAFETY: a message with such a payload; the slice is not used any more when sendfunc is called.
    let encoded = unsafe {
        let payload = slice::from_raw_parts((&raw const (*msg).data).cast(), length.cast_unsigned() as usize);
        encode(Opcode((*msg).opcode), payload, &mut frame)
    };
    match encoded {
        // SAFETY: as the contract of dp_send asks; encode() wrote that many bytes of the frame.
        Some(length) => unsafe { sendfunc(frame.as_mut_ptr().cast(), int(length), usr) },
        None => DP_RC_ERROR_GENERIC,
    }
}

/// Whether neither is NULL.
#[inline(always)]
fn neither_null<T, U>(one: *const T, other: *const U) -> bool {
    // One comparison will do for nearly all pointers: those that have a bit in common.
    one.addr() & other.addr() != 0 || !one.is_null() && !other.is_null()
}
