//! `libdeltarobot/protocol_ext.h`: what the original's API lacks.

use core::ffi::{c_char, c_int, c_void};
use core::mem::MaybeUninit;

use super::memory::{bytes_of, int, zero};
use super::protocol::{DP_RC_ERROR_GENERIC, DP_RC_SUCCESS, ProtocolData, ProtocolMsg, next_message, ring_of};
use deltarobot_export::export;

/// Receives a message from `dp_process_each`, gone when this returns, and that one's usr. Any result but 0 stops it.
///
/// ```c
/// int on_msg(const struct protocol_msg *msg, void *usr)
/// {
///     handle(msg);
///     return 0;
/// }
/// ```
pub type MsgFunc = Option<unsafe extern "C" fn(msg: *const ProtocolMsg, usr: *mut c_void) -> c_int>;

/// Adds any number of received bytes, and calls `on_msg` for each message as soon as it is complete.
///
/// Does what `dp_process` and `dp_recv` do, but never overflows: the ring is emptied whenever it is full. Messages that
/// are in the ring already come first. buf's bytes stay as they are until the call returns.
///
/// Returns how many of the bytes were taken: all of them unless `on_msg` stopped it. Nothing is lost then: give the
/// rest to the next call, which goes on with the next message. Returns -`DP_RC_ERROR_GENERIC` when data or `on_msg` is
/// NULL, bytes is negative, or buf is NULL and bytes is not 0.
///
/// ```c
/// int got = uart_read(&uart, in, sizeof in);
/// dp_process_each(&ring, in, got, on_msg, NULL);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_process_each(
    data: *mut ProtocolData,
    buf: *const c_void,
    bytes: c_int,
    on_msg: MsgFunc,
    usr: *mut c_void,
) -> c_int {
    // SAFETY: as the rules at the head ask.
    let (Some(on_msg), Some(input), false) = (on_msg, unsafe { bytes_of(buf, bytes) }, data.is_null()) else {
        return -DP_RC_ERROR_GENERIC;
    };
    let mut rest = input;
    let mut msg = MaybeUninit::<ProtocolMsg>::uninit();
    loop {
        // SAFETY: data is not NULL, so a ring by the contract of dp_process_each; msg is ours.
        while unsafe { next_message(data, msg.as_mut_ptr(), false) } == DP_RC_SUCCESS {
            // SAFETY: as the contract of dp_process_each asks; no reference to the ring is held.
            if unsafe { on_msg(msg.as_ptr(), usr) } != 0 {
                return int(input.len().wrapping_sub(rest.len()));
            }
        }
        if rest.is_empty() {
            return bytes;
        }
        // SAFETY: as above; the reference ends before the next call of on_msg.
        let Some(ring) = (unsafe { ring_of(data) }) else { return -DP_RC_ERROR_GENERIC };
        let (now, later) = rest.split_at_checked(ring.room()).unwrap_or((rest, &[]));
        // Can't overflow: there is room for them.
        let _ = ring.append(now);
        rest = later;
    }
}

/// Like `dp_recv`, for a line that has been quiet for longer than a frame takes (37 bytes at 115200 baud: 3.2 ms): what
/// is incomplete by then, most likely noise that looks like the beginning of a frame, is given up, and what stands
/// behind it delivered.
///
/// Returns `DP_RC_SUCCESS` and the message, `DP_RC_GARBAGE` when bytes were thrown away and the ring is empty now,
/// `DP_RC_NO_FRAME` when it was empty before, or `DP_RC_ERROR_GENERIC` when a pointer is NULL; sets `opcode` as
/// `dp_recv` does.
///
/// ```c
/// if (now_ms() - heard_at >= 10)
///     while (dp_recv_idle(&ring, &msg) == DP_RC_SUCCESS)
///         handle(&msg);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_recv_idle(data: *mut ProtocolData, msg: *mut ProtocolMsg) -> c_int {
    // SAFETY: NULL, or as the rules at the head ask.
    unsafe { next_message(data, msg, true) }
}

/// Makes an empty ring of any memory, as setting it to zero does; the library's safety never needs that. Returns
/// `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when data is NULL.
///
/// ```c
/// struct protocol_data ring;
/// dp_init(&ring);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_init(data: *mut ProtocolData) -> c_int {
    if data.is_null() {
        return DP_RC_ERROR_GENERIC;
    }
    // SAFETY: not NULL, so memory as the rules at the head ask.
    unsafe { zero(data) };
    DP_RC_SUCCESS
}

/// Returns the library's version, e.g. "1.0.0", a string that lives as long as the program: compare it with the
/// header's, `DP_VERSION_STRING`.
///
/// ```c
/// if (strcmp(dp_version(), DP_VERSION_STRING) != 0)
///     printf("compiled for libdeltarobot %s, running with %s\n", DP_VERSION_STRING, dp_version());
/// ```
#[export]
pub extern "C" fn dp_version() -> *const c_char {
    const { concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast() }
}
