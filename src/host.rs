//! `host.h`: the host's end of the link.

use core::ffi::{c_int, c_long, c_ulong, c_void};
use core::mem::{MaybeUninit, align_of, offset_of, size_of};

use super::memory::{bytes_of, fill, int, long, zero};
use super::payload::position_from;
use super::protocol::{DP_RC_ERROR_GENERIC, DP_RC_SUCCESS, Position};
use deltarobot_export::export;
use deltarobot_protocols::clock::time;
use deltarobot_protocols::config::DP_DATA_MAX_SIZE;
use deltarobot_protocols::deltarobot::host::{Busy, Health, Host, Link, Request, Settings};
use deltarobot_protocols::deltarobot::{POSITION_SIZE, Ring};
use event::{HostEvent, event_to};

pub mod event;

/// A request of this kind is going on, or its end was not fetched by `dp_host_poll` yet.
pub const DP_RC_BUSY: c_int = 5;
/// Nothing has happened.
pub const DP_RC_NO_EVENT: c_int = 6;

/// Room that three requests take, more than which are never to be sent at a time.
pub const DP_HOST_OUTPUT_MAX: c_int = 27;

// The layout that C compilers give these structs; C tests assert the same numbers.
#[expect(clippy::arithmetic_side_effects, reason = "done by the compiler")]
const _: () = {
    const INT: usize = size_of::<c_int>();
    const LONG: usize = size_of::<c_ulong>();
    const ATTEMPTS: usize = 7 * LONG + 4;
    const fn up(size: usize, align: usize) -> usize {
        size.next_multiple_of(align)
    }

    assert!(offset_of!(Settings, ack_ms) == 0 && offset_of!(Settings, guard_ms) == LONG);
    assert!(offset_of!(Settings, settle_ms) == 2 * LONG && offset_of!(Settings, poll_ms) == 3 * LONG);
    assert!(offset_of!(Settings, silence_ms) == 4 * LONG && offset_of!(Settings, operation_ms) == 5 * LONG);
    assert!(offset_of!(Settings, gap_ms) == 6 * LONG && offset_of!(Settings, tolerance) == 7 * LONG);
    assert!(offset_of!(Settings, attempts) == ATTEMPTS && offset_of!(Settings, layout) == ATTEMPTS + INT);
    assert!(offset_of!(Settings, messages) == ATTEMPTS + 2 * INT);
    assert!(offset_of!(Settings, doubles) == ATTEMPTS + 3 * INT);
    assert!(size_of::<Settings>() == up(ATTEMPTS + 4 * INT, align_of::<c_ulong>()));

    assert!(offset_of!(Health, frames) == 0 && offset_of!(Health, malformed) == LONG);
    assert!(offset_of!(Health, strays) == 2 * LONG && offset_of!(Health, garbage_bytes) == 3 * LONG);
    assert!(offset_of!(Health, checksum_failures) == 4 * LONG && offset_of!(Health, overflows) == 5 * LONG);
    assert!(offset_of!(Health, timeouts) == 6 * LONG && offset_of!(Health, repeats) == 7 * LONG);
    assert!(offset_of!(Health, rtt_count) == 8 * LONG && offset_of!(Health, rtt_last) == 9 * LONG);
    assert!(offset_of!(Health, rtt_min) == 10 * LONG && offset_of!(Health, rtt_max) == 11 * LONG);
    assert!(offset_of!(Health, rtt_sum) == 12 * LONG && size_of::<Health>() == 13 * LONG);

    assert!(size_of::<Request>() == up(2 * LONG + 5, align_of::<c_ulong>()));
    assert!(size_of::<Link>() == up(up(size_of::<Ring>(), align_of::<c_ulong>()) + LONG + 3, align_of::<c_ulong>()));
    assert!(
        size_of::<Host>()
            == up(
                size_of::<Settings>()
                    + size_of::<Health>()
                    + size_of::<Link>()
                    + 3 * size_of::<Request>()
                    + 4 * LONG
                    + 4 * INT
                    + 7
                    + 2 * POSITION_SIZE,
                align_of::<c_ulong>()
            )
    );
};

/// Begins a session. Memory that is all zero is one too, with the default settings.
///
/// settings are copied; NULL stands for the defaults.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when host is NULL.
///
/// ```c
/// struct dp_host_settings settings = {0};
/// settings.messages = 1;
/// dp_host_init(&host, &settings);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_init(host: *mut Host, settings: *const Settings) -> c_int {
    if host.is_null() {
        return DP_RC_ERROR_GENERIC;
    }
    // SAFETY: as the contract of this function asks; zero is a session.
    unsafe {
        zero(host);
        if let Some(settings) = settings.as_ref() {
            (*host).set(settings);
        }
    }
    DP_RC_SUCCESS
}

/// Requests homing. The end comes as an event.
///
/// host was begun by `dp_host_init` or is all zero.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_BUSY` while an operation is going on, or `DP_RC_ERROR_GENERIC` when host is NULL.
///
/// ```c
/// if (dp_host_home(&host) == DP_RC_BUSY)
///     puts("first, DP_HOST_ENDED has to come");
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_home(host: *mut Host) -> c_int {
    // SAFETY: as the contract of this function asks.
    result(unsafe { host.as_mut() }.map(Host::home))
}

/// Requests a move to a position. The end comes as an event.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_BUSY` while an operation is going on, or `DP_RC_ERROR_GENERIC` when a pointer is
/// NULL, a coordinate is a NaN or infinite, or `DP_DATA_MAX_SIZE` is below 12.
///
/// ```c
/// const struct protocol_msg_position target = {1, 2, -3.5f};
/// if (dp_host_move(&host, &target) == DP_RC_ERROR_GENERIC)
///     puts("no robot can go there");
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_move(host: *mut Host, target: *const Position) -> c_int {
    // SAFETY: as the contract of this function asks.
    let target =
        unsafe { position_from(target) }.filter(|target| POSITION_SIZE <= DP_DATA_MAX_SIZE && target.is_finite());
    // SAFETY: as the contract of this function asks.
    match (unsafe { host.as_mut() }, target) {
        (Some(host), Some(target)) => result(Some(host.move_to(target))),
        _ => DP_RC_ERROR_GENERIC,
    }
}

/// Requests that the operation going on be cancelled. Both requests end: this one when the controller has answered it,
/// the operation when the platform stands. Without an operation it is requested all the same.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_BUSY` while this is being requested already, or `DP_RC_ERROR_GENERIC` when host is
/// NULL.
///
/// ```c
/// if (stop_is_pressed())
///     dp_host_cancel(&host);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_cancel(host: *mut Host) -> c_int {
    // SAFETY: as the contract of this function asks.
    result(unsafe { host.as_mut() }.map(Host::cancel))
}

/// Requests a status report. It ends with the next report that is received.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_BUSY` while one is being requested already, or `DP_RC_ERROR_GENERIC` when host is
/// NULL.
///
/// ```c
/// if (now_ms() - asked_at >= 1000 && dp_host_status(&host) == DP_RC_SUCCESS)
///     asked_at = now_ms();
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_status(host: *mut Host) -> c_int {
    // SAFETY: as the contract of this function asks.
    result(unsafe { host.as_mut() }.map(Host::status))
}

/// Takes received bytes; `now_ms` is when they came.
///
/// Returns how many bytes were taken: all, or as many as there is room for until events have been fetched by
/// `dp_host_poll`; give it the rest then. Returns -`DP_RC_ERROR_GENERIC` when host is NULL, bytes is negative, or buf
/// is NULL and bytes is not 0.
///
/// ```c
/// int got = uart_read(&uart, in, sizeof in);
/// for (int taken = 0; taken < got; handle_events(&host))
///     taken += dp_host_receive(&host, in + taken, got - taken, now_ms());
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_receive(host: *mut Host, buf: *const c_void, bytes: c_int, now_ms: c_ulong) -> c_int {
    // SAFETY: as the contract of this function asks.
    match unsafe { (host.as_mut(), bytes_of(buf, bytes)) } {
        (Some(host), Some(input)) => int(host.receive(input, time(now_ms))),
        _ => DP_RC_ERROR_GENERIC.wrapping_neg(),
    }
}

/// Fetches the next event. To be called after receiving, and at the latest when `dp_host_next_deadline` says, until
/// there is none; what is to be sent after that tells `dp_host_output`.
///
/// Returns `DP_RC_SUCCESS` and the event, `DP_RC_NO_EVENT` when there is none (`kind` is 0 then), or
/// `DP_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// struct dp_host_event event;
/// while (dp_host_poll(&host, now_ms(), &event) == DP_RC_SUCCESS)
///     if (event.kind == DP_HOST_ENDED)
///         printf("%s: outcome %d\n", dp_opcode_name(event.opcode), event.outcome);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_poll(host: *mut Host, now_ms: c_ulong, event: *mut HostEvent) -> c_int {
    // SAFETY: as the contract of this function asks.
    let Some(host) = (unsafe { host.as_mut() }).filter(|_| !event.is_null()) else {
        return DP_RC_ERROR_GENERIC;
    };
    // SAFETY: event is not NULL; chars and uninitialised bytes have the same layout.
    let data = unsafe { &mut *(&raw mut (*event).msg.data).cast::<[MaybeUninit<u8>; DP_DATA_MAX_SIZE]>() };
    let happened = host.poll(time(now_ms), data);
    // SAFETY: event is not NULL.
    unsafe { event_to(event, happened.as_ref()) };
    if happened.is_some() { DP_RC_SUCCESS } else { DP_RC_NO_EVENT }
}

/// Fetches the bytes to send: whole frames, at most `DP_HOST_OUTPUT_MAX` bytes at a time; `now_ms` is when they leave.
/// To be called after `dp_host_poll`.
///
/// Returns how many bytes were written, 0 when there is nothing to send or no room for the next frame, or
/// -`DP_RC_ERROR_GENERIC` when host is NULL, cap is negative, or buf is NULL and cap is not 0.
///
/// ```c
/// char out[DP_HOST_OUTPUT_MAX];
/// int length = dp_host_output(&host, out, sizeof out, now_ms());
/// if (length > 0)
///     uart_write(&uart, out, length);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_output(host: *mut Host, buf: *mut c_void, cap: c_int, now_ms: c_ulong) -> c_int {
    // SAFETY: as the contract of this function asks.
    let Some(host) = (unsafe { host.as_mut() }) else {
        return DP_RC_ERROR_GENERIC.wrapping_neg();
    };
    // SAFETY: as the contract of this function asks.
    let written = unsafe { fill(buf, cap, |frame, room| host.output(frame, room, time(now_ms))) };
    written.unwrap_or(DP_RC_ERROR_GENERIC.wrapping_neg())
}

/// How long `dp_host_poll` has nothing to do if nothing is received or requested. Ask when there are no events left and
/// the output was fetched: what it returns is then what poll(2) takes as time-out.
///
/// Returns milliseconds, 0 or more, or -1 when it need not be called at all or host is NULL.
///
/// ```c
/// wait_readable(&uart, dp_host_next_deadline(&host, now_ms()));
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_next_deadline(host: *const Host, now_ms: c_ulong) -> c_long {
    // SAFETY: as the contract of this function asks.
    let left = unsafe { host.as_ref() }.and_then(|host| host.next_deadline(time(now_ms)));
    left.map_or(-1, long)
}

/// Whether an operation is going on.
///
/// Returns 1, or 0, also when host is NULL.
///
/// ```c
/// if (!dp_host_busy(&host))
///     dp_host_home(&host);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_busy(host: *const Host) -> c_int {
    // SAFETY: as the contract of this function asks.
    c_int::from(unsafe { host.as_ref() }.is_some_and(Host::is_busy))
}

/// How the link does.
///
/// Returns counters that live and change with the session, or NULL when host is.
///
/// ```c
/// const struct dp_host_health *health = dp_host_get_health(&host);
/// if (health->rtt_count > 0)
///     printf("round trip: %lu ms on average\n", health->rtt_sum / health->rtt_count);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_get_health(host: *const Host) -> *const Health {
    // SAFETY: as the contract of this function asks.
    match unsafe { host.as_ref() } {
        Some(host) => host.health(),
        None => core::ptr::null(),
    }
}

fn result(outcome: Option<Result<(), Busy>>) -> c_int {
    match outcome {
        Some(Ok(())) => DP_RC_SUCCESS,
        Some(Err(Busy)) => DP_RC_BUSY,
        None => DP_RC_ERROR_GENERIC,
    }
}
