//! `libdeltarobot/protocol.h`: frames of the deltarobot message format, specification v1.0.

use core::ffi::{c_char, c_float, c_int, c_uchar, c_void};
use core::hint;
use core::mem::{MaybeUninit, offset_of};
use core::slice;

use super::memory::{bytes_of, int};
use super::ring::{Overflow, Ring};
use crate::sizes::{DP_BUFSIZE, DP_DATA_MAX_SIZE};
use deltarobot_export::export;
use deltarobot_protocols::deltarobot::{FRAME_OVERHEAD, Opcode, Verdict, encode};

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

/// A ring buffer for bytes from the wire; all zero is an empty one.
///
/// The fields can be read at any time. They are never trusted: a ring whose `m_idx` or `m_sz` is out of range counts as
/// empty, so an uninitialised one does no harm.
#[derive(Debug)]
#[repr(C)]
pub struct ProtocolData {
    /// Storage of the ring.
    pub m_buf: [c_char; DP_BUFSIZE],
    /// Where the first unread byte is, 0 to `DP_BUFSIZE` - 1.
    pub m_idx: c_int,
    /// Number of unread bytes, 0 to `DP_BUFSIZE`.
    pub m_sz: c_int,
}

// It is a Ring.
const _: () = {
    type Same = Ring<DP_BUFSIZE>;
    assert!(size_of::<ProtocolData>() == size_of::<Same>() && align_of::<ProtocolData>() == align_of::<Same>());
    assert!(offset_of!(ProtocolData, m_buf) == offset_of!(Same, bytes));
    assert!(offset_of!(ProtocolData, m_idx) == offset_of!(Same, start));
    assert!(offset_of!(ProtocolData, m_sz) == offset_of!(Same, used));
};

/// The ring behind a pointer from C, or `None` for NULL.
///
/// # Safety
///
/// data is NULL or a whole ring, which nobody else touches while the reference lives.
#[inline(always)]
pub(crate) unsafe fn ring_of<'a>(data: *mut ProtocolData) -> Option<&'a mut Ring<DP_BUFSIZE>> {
    // SAFETY: the two have one layout, and any bytes are a ring.
    unsafe { data.cast::<Ring<DP_BUFSIZE>>().as_mut() }
}

/// What `opcode` becomes when no frame was received: never the opcode of one.
pub(crate) const NO_OPCODE: c_uchar = 0xFF;

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

/// The payload of a status report as shipped firmware sends it: 16 bytes with the padding. Displacements are in the
/// firmware's own unit, as the specification names none.
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

/// Adds received bytes at the ring's end.
///
/// When they do not fit, the oldest bytes make room; of more than `DP_BUFSIZE` bytes the first `DP_BUFSIZE` are taken.
/// Not for an interrupt that may come during another call on the ring: there, put bytes into a queue of your own.
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
pub unsafe extern "C" fn dp_process(data: *mut ProtocolData, buf: *mut c_void, bytes: c_int) -> c_int {
    // SAFETY: NULL, or as the rules at the head ask.
    let (Some(ring), Some(input)) = (unsafe { ring_of(data) }, unsafe { bytes_of(buf, bytes) }) else {
        return DP_RC_ERROR_GENERIC;
    };
    match ring.append(input) {
        Ok(()) => DP_RC_SUCCESS,
        Err(Overflow) => DP_RC_OVERFLOW,
    }
}

/// Takes the next message out of the ring.
///
/// An incomplete frame at the ring's start is waited for, whatever stands behind it; bytes that can't be part of a frame
/// are thrown away.
///
/// Returns `DP_RC_SUCCESS` and the message, `DP_RC_NO_FRAME` when more bytes are needed, `DP_RC_GARBAGE` when more are
/// needed and some were thrown away, or `DP_RC_ERROR_GENERIC` when a pointer is NULL. Without a message, only `opcode`
/// is set, to 0xFF.
///
/// ```c
/// struct protocol_msg msg;
/// while (dp_recv(&ring, &msg) == DP_RC_SUCCESS)
///     handle(&msg);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_recv(data: *mut ProtocolData, msg: *mut ProtocolMsg) -> c_int {
    // SAFETY: NULL, or as the rules at the head ask.
    unsafe { next_message(data, msg, false) }
}

/// Takes the next message out of a ring; when `idle`, what is incomplete too is thrown away.
///
/// # Safety
///
/// data is NULL or a ring, msg NULL or a message outside of it.
#[inline(always)]
pub(crate) unsafe fn next_message(data: *mut ProtocolData, msg: *mut ProtocolMsg, idle: bool) -> c_int {
    if msg.is_null() {
        return DP_RC_ERROR_GENERIC;
    }
    // SAFETY: NULL or a ring.
    let code = match unsafe { ring_of(data) } {
        None => DP_RC_ERROR_GENERIC,
        Some(ring) => {
            ring.heal();
            let mut code = DP_RC_NO_FRAME;
            loop {
                match ring.judge_head(DP_DATA_MAX_SIZE) {
                    Verdict::Frame { opcode, length } => {
                        // SAFETY: msg is not NULL, so a message; judge_head() accepts no longer payload.
                        if unsafe { take_message(ring, msg, opcode, length) } {
                            return DP_RC_SUCCESS;
                        }
                    }
                    Verdict::Needs(_) if !idle || ring.is_empty() => break code,
                    Verdict::Needs(_) | Verdict::Fault(_) => {}
                }
                ring.skip(1);
                code = DP_RC_GARBAGE;
            }
        }
    };
    // SAFETY: msg is not NULL, so a message. It may be uninitialised: so no reference to it is made.
    unsafe { (*msg).opcode = NO_OPCODE };
    code
}

/// Takes out the message whose head was found, if it is one.
///
/// # Safety
///
/// msg points to a writable message outside the ring, and length is at most `DP_DATA_MAX_SIZE`.
// On hosts and AVR a call is cheaper than to save the registers it needs in each dp_recv that waits.
#[cfg_attr(any(target_pointer_width = "64", target_arch = "avr"), inline(never))]
#[cfg_attr(not(any(target_pointer_width = "64", target_arch = "avr")), inline(always))]
unsafe fn take_message(ring: &mut Ring<DP_BUFSIZE>, msg: *mut ProtocolMsg, opcode: Opcode, length: usize) -> bool {
    let Some(payload) = ring.take_frame(opcode, length) else { return false };
    // SAFETY: the same contract.
    unsafe { deliver(msg, opcode, length, |data| payload.copy_to(data, MaybeUninit::new)) };
    true
}

/// Writes a message whose payload, of that length, `copy` writes.
///
/// # Safety
///
/// msg points to a writable message, and length is at most `DP_DATA_MAX_SIZE`.
#[inline(always)]
pub(crate) unsafe fn deliver(
    msg: *mut ProtocolMsg,
    opcode: Opcode,
    length: usize,
    copy: impl FnOnce(&mut [MaybeUninit<u8>; DP_DATA_MAX_SIZE]),
) {
    // SAFETY: a message, whose chars have the layout of bytes that may be uninitialised; and such a length.
    unsafe {
        hint::assert_unchecked(length <= DP_DATA_MAX_SIZE);
        (*msg).data_s = int(length);
        (*msg).opcode = opcode.0;
        copy(&mut *(&raw mut (*msg).data).cast());
        (*msg).checksum_ok = 1;
    }
}

/// Sends a message, whose opcode is not checked: calls sendfunc once, with the whole frame and usr.
///
/// Returns what sendfunc returned, or `DP_RC_ERROR_GENERIC` without calling it when msg or sendfunc is NULL or `data_s`
/// is outside 0 to `DP_DATA_MAX_SIZE`.
///
/// ```c
/// msg.opcode = DP_OPCODE_HOMING;
/// msg.data_s = 0;
/// dp_send(&msg, uart_send, &uart);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_send(msg: *mut ProtocolMsg, sendfunc: SendFunc, usr: *mut c_void) -> c_int {
    let (Some(sendfunc), false) = (sendfunc, msg.is_null()) else {
        return DP_RC_ERROR_GENERIC;
    };
    // SAFETY: not NULL, so a message as the rules at the head ask.
    let length = unsafe { (*msg).data_s };
    if !(0..=const { int(DP_DATA_MAX_SIZE) }).contains(&length) {
        return DP_RC_ERROR_GENERIC;
    }
    let mut frame = [MaybeUninit::uninit(); const { DP_DATA_MAX_SIZE.wrapping_add(FRAME_OVERHEAD) }];
    // SAFETY: a message with such a payload; the slice is not used any more when sendfunc is called.
    let encoded = unsafe {
        let payload = slice::from_raw_parts((&raw const (*msg).data).cast(), length.cast_unsigned() as usize);
        encode(Opcode((*msg).opcode), payload, &mut frame)
    };
    match encoded {
        // SAFETY: sendfunc can be called with usr; encode() wrote that many bytes of the frame.
        Some(length) => unsafe { sendfunc(frame.as_mut_ptr().cast(), int(length), usr) },
        None => DP_RC_ERROR_GENERIC,
    }
}
