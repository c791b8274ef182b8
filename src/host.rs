//! `libdeltarobot/host.h`: the host's end of the link: sends requests, retransmits them, reports how they ended.
//!
//! A session does no I/O. A loop around it, from the first request on:
//!
//! ```c
//! struct dp_host_event event;
//! char in[64], out[DP_HOST_OUTPUT_MAX];
//! int got = 0, taken = 0, length;
//!
//! dp_host_init(&host, NULL);
//! dp_host_home(&host);
//! for (;;) {
//!     while (dp_host_poll(&host, now_ms(), &event) == DP_RC_SUCCESS)
//!         handle_event(&event);
//!     if ((length = dp_host_output(&host, out, sizeof out, now_ms())) > 0)
//!         uart_write(&uart, out, length);
//!     if (is_over())
//!         break;
//!     if (taken == got) {
//!         wait_readable(&uart, dp_host_next_deadline(&host, now_ms()));
//!         taken = 0;
//!         got = uart_read(&uart, in, sizeof in);
//!     }
//!     taken += dp_host_receive(&host, in + taken, got - taken, now_ms());
//! }
//! ```

use core::ffi::{c_int, c_long, c_ulong, c_void};
use core::mem::MaybeUninit;

use super::memory::{bytes_of, copy_counters, duration, fill, int, long, short, time};
use super::payload::position_from;
use super::protocol::{DP_RC_ERROR_GENERIC, DP_RC_SUCCESS, Position};
use super::state::{Room, state};
use crate::sizes::DP_DATA_MAX_SIZE;
use deltarobot_export::export;
use deltarobot_protocols::deltarobot::host::{Busy, Host as Session, Settings};
use deltarobot_protocols::deltarobot::{POSITION_SIZE, receiver_room};
use event::{HostEvent, event_to};
use zerocopy::{FromBytes, IntoBytes, transmute_mut, transmute_ref};

pub mod event;

/// A request of this kind is going on, or its end was not fetched by `dp_host_poll` yet.
pub const DP_RC_BUSY: c_int = 5;
/// Nothing has happened.
pub const DP_RC_NO_EVENT: c_int = 6;

/// Room for what is to be sent at a time: three requests.
pub const DP_HOST_OUTPUT_MAX: c_int = 27;

/// Settings of a session, times in milliseconds up to 2147483647 (24 days). 0 stands for the default everywhere.
#[derive(Debug)]
#[repr(C)]
pub struct HostSettings {
    /// How long an answer is waited for before the request is retransmitted; by default 250.
    pub ack_ms: c_ulong,
    /// The longest time from sending a request to its answer's arrival: what has not come by then is lost, and what
    /// comes sooner is not taken for the answer to a later request. By default 500.
    pub guard_ms: c_ulong,
    /// How long after its ack an operation may take to show in the state: a report of IDLE that comes sooner, with no
    /// other state before it, does not end the operation. Not below guard; by default 500.
    pub settle_ms: c_ulong,
    /// During an operation the status is requested when no report came for this long; by default 200.
    pub poll_ms: c_ulong,
    /// An operation is given up when nothing at all was received for this long; by default 3000.
    pub silence_ms: c_ulong,
    /// An operation is given up after this long in any case; by default 120000.
    pub operation_ms: c_ulong,
    /// An incomplete frame is given up when the line was quiet for this long; by default 50.
    pub gap_ms: c_ulong,
    /// How far each arm may be from the target of a move that IDLE ends, in the displacement's unit; by default 0.25,
    /// twice what shipped firmware allows itself.
    pub tolerance: f32,
    /// How often a request is sent altogether before it has timed out, 1 to 255; by default 4.
    pub attempts: c_int,
    /// Layout of status reports, one of `DP_LAYOUT_*`; by default `DP_LAYOUT_AUTO`.
    pub layout: c_int,
    /// Not 0: each received message is an event.
    pub messages: c_int,
    /// Not 0: the line may deliver a frame twice, as some radio links do. Operations then keep `guard_ms` apart.
    pub duplicates: c_int,
}

/// Statistics of a session since it began. Counters wrap at 2^32.
#[derive(Debug, FromBytes, IntoBytes)]
#[repr(C)]
pub struct HostHealth {
    /// Intact frames received.
    pub frames: c_ulong,
    /// Of these, frames whose payload has the wrong length for the opcode. They are ignored.
    pub malformed: c_ulong,
    /// Of these, acks and nacks that nothing was waiting for: late, or of another opcode than was asked.
    pub strays: c_ulong,
    /// Bytes received that belong to no intact frame.
    pub garbage_bytes: c_ulong,
    /// Frames that were whole but for their checksum. Their bytes are among the garbage.
    pub checksum_failures: c_ulong,
    /// Answers that did not come in time.
    pub timeouts: c_ulong,
    /// Requests that were retransmitted because of that.
    pub retransmissions: c_ulong,
    /// Number of round trips measured: from a request that was sent once to its answer. Times in milliseconds.
    pub rtt_count: c_ulong,
    /// The last round-trip time.
    pub rtt_last: c_ulong,
    /// The shortest round-trip time.
    pub rtt_min: c_ulong,
    /// The longest round-trip time.
    pub rtt_max: c_ulong,
    /// Sum of the round-trip times: divided by `rtt_count`, their average.
    pub rtt_sum: c_ulong,
}

/// Words of a session's room.
pub const DP_HOST_WORDS: usize = DP_DATA_MAX_SIZE / 4 + 56;

/// A session. All zero is one with the default settings.
#[derive(Debug)]
#[repr(C)]
pub struct Host {
    opaque: [c_ulong; DP_HOST_WORDS],
}

state!(Host: Session<{ receiver_room(DP_DATA_MAX_SIZE) }>);

/// Begins a session, in any memory. settings are copied; NULL stands for the defaults.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when host is NULL.
///
/// ```c
/// struct dp_host_settings settings = {0};
/// settings.messages = 1;
/// dp_host_init(&host, &settings);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_init(host: *mut Host, settings: *const HostSettings) -> c_int {
    // SAFETY: both are NULL or the caller's whole objects, and don't overlap.
    let (session, settings) = unsafe { (Host::init(host), settings.as_ref()) };
    let Some(session) = session else { return DP_RC_ERROR_GENERIC };
    if let Some(settings) = settings {
        let HostSettings {
            ack_ms,
            guard_ms,
            settle_ms,
            poll_ms,
            silence_ms,
            operation_ms,
            gap_ms,
            tolerance,
            attempts,
            layout,
            messages,
            duplicates,
        } = *settings;
        *session.settings() = Settings {
            ack_ms: duration(ack_ms),
            guard_ms: duration(guard_ms),
            settle_ms: duration(settle_ms),
            poll_ms: duration(poll_ms),
            silence_ms: duration(silence_ms),
            operation_ms: duration(operation_ms),
            gap_ms: duration(gap_ms),
            tolerance,
            attempts: short(attempts),
            layout: u8::try_from(layout).unwrap_or_default(),
            messages: u8::from(messages != 0),
            duplicates: u8::from(duplicates != 0),
        };
    }
    DP_RC_SUCCESS
}

/// Requests homing. The end comes as an event.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_BUSY` while an operation is going on, or `DP_RC_ERROR_GENERIC` when host is NULL.
///
/// ```c
/// if (dp_host_home(&host) == DP_RC_BUSY)
///     puts("first, DP_HOST_ENDED has to come");
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_home(host: *mut Host) -> c_int {
    // SAFETY: NULL or the caller's whole object.
    request(unsafe { Host::get(host) }, Session::home)
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
    // SAFETY: NULL or the caller's whole object.
    let target = unsafe { position_from(target) };
    match target.filter(|target| POSITION_SIZE <= DP_DATA_MAX_SIZE && target.is_finite()) {
        // SAFETY: NULL or the caller's whole object.
        Some(target) => request(unsafe { Host::get(host) }, |session| session.move_to(target)),
        None => DP_RC_ERROR_GENERIC,
    }
}

/// Requests that the operation going on be cancelled. Both requests end: this one when the controller has answered it,
/// the operation when the platform stands. Without an operation it is requested all the same.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_BUSY` while one is being requested, or `DP_RC_ERROR_GENERIC` when host is NULL.
///
/// ```c
/// if (stop_is_pressed())
///     dp_host_cancel(&host);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_cancel(host: *mut Host) -> c_int {
    // SAFETY: NULL or the caller's whole object.
    request(unsafe { Host::get(host) }, Session::cancel)
}

/// Requests a status report. It ends with the next report that is received.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_BUSY` while one is being requested, or `DP_RC_ERROR_GENERIC` when host is NULL.
///
/// ```c
/// if (now_ms() - asked_at >= 1000 && dp_host_status(&host) == DP_RC_SUCCESS)
///     asked_at = now_ms();
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_status(host: *mut Host) -> c_int {
    // SAFETY: NULL or the caller's whole object.
    request(unsafe { Host::get(host) }, Session::status)
}

/// Takes received bytes; `now_ms` is when they came.
///
/// Returns how many were taken: all, or as many as fit. The rest fits when `dp_host_poll` has no more events. Returns
/// -`DP_RC_ERROR_GENERIC` when host is NULL, bytes is negative, or buf is NULL and bytes is not 0.
///
/// ```c
/// for (int taken = 0; taken < length; handle_events(&host))
///     taken += dp_host_receive(&host, in + taken, length - taken, now_ms());
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_receive(host: *mut Host, buf: *const c_void, bytes: c_int, now_ms: c_ulong) -> c_int {
    // SAFETY: NULL or the caller's, the session whole and so many bytes readable; they don't overlap.
    match unsafe { (Host::get(host), bytes_of(buf, bytes)) } {
        (Some(session), Some(input)) => int(session.receive(input, time(now_ms))),
        _ => -DP_RC_ERROR_GENERIC,
    }
}

/// Fetches the next event. To be called after receiving, and at the latest when `dp_host_next_deadline` says, until
/// there is none; then `dp_host_output` has what is to be sent.
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
    // SAFETY: NULL or the caller's whole object.
    let (Some(session), false) = (unsafe { Host::get(host) }, event.is_null()) else { return DP_RC_ERROR_GENERIC };
    // SAFETY: the event is the caller's whole object, apart from the session; chars may be uninitialised as bytes.
    let data = unsafe { &mut *(&raw mut (*event).msg.data).cast::<[MaybeUninit<u8>; DP_DATA_MAX_SIZE]>() };
    let happened = session.poll(time(now_ms), data);
    // SAFETY: not NULL, so the caller's whole object; `data` is not used any more.
    unsafe { event_to(event, happened, session.last_report()) };
    if happened.is_some() { DP_RC_SUCCESS } else { DP_RC_NO_EVENT }
}

/// Fetches what is to be sent after `dp_host_poll`: whole frames, `DP_HOST_OUTPUT_MAX` bytes at most, sent at `now_ms`.
///
/// Returns how many bytes were written, 0 when there is nothing to send or no room for the next frame, or
/// -`DP_RC_ERROR_GENERIC` when host is NULL, cap is negative, or buf is NULL and cap is not 0.
///
/// ```c
/// int length = dp_host_output(&host, out, sizeof out, now_ms());
/// if (length > 0)
///     uart_write(&uart, out, length);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_output(host: *mut Host, buf: *mut c_void, cap: c_int, now_ms: c_ulong) -> c_int {
    // SAFETY: each is NULL or the caller's, the session whole and so many bytes writable; they don't overlap.
    let written = unsafe {
        Host::get(host).and_then(|session| fill(buf, cap, |frame, room| session.output(frame, room, time(now_ms))))
    };
    written.unwrap_or(-DP_RC_ERROR_GENERIC)
}

/// Returns how many milliseconds `dp_host_poll` need not be called if nothing is received or requested, as poll(2) takes
/// them: -1 when not at all, or host is NULL. Ask when events and output were fetched.
///
/// ```c
/// wait_readable(&uart, dp_host_next_deadline(&host, now_ms()));
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_next_deadline(host: *const Host, now_ms: c_ulong) -> c_long {
    // SAFETY: NULL or the caller's whole object.
    unsafe { Host::peek(host) }.and_then(|session| session.next_deadline(time(now_ms))).map_or(-1, long)
}

/// Whether an operation is going on: 1, or 0, also when host is NULL.
///
/// ```c
/// if (!dp_host_busy(&host))
///     dp_host_home(&host);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_busy(host: *const Host) -> c_int {
    // SAFETY: NULL or the caller's whole object.
    c_int::from(unsafe { Host::peek(host) }.is_some_and(Session::is_busy))
}

/// Copies the statistics. Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// struct dp_host_health health;
/// if (dp_host_get_health(&host, &health) == DP_RC_SUCCESS && health.rtt_count > 0)
///     printf("round trip: %lu ms on average\n", health.rtt_sum / health.rtt_count);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_host_get_health(host: *const Host, health: *mut HostHealth) -> c_int {
    // SAFETY: both are NULL or the caller's whole objects, and don't overlap.
    let (Some(session), Some(health)) = (unsafe { (Host::peek(host), health.as_mut()) }) else {
        return DP_RC_ERROR_GENERIC;
    };
    copy_counters::<12>(transmute_ref!(session.health()), transmute_mut!(health));
    DP_RC_SUCCESS
}

type State = <Host as Room>::State;

fn request(session: Option<&mut State>, begin: impl FnOnce(&mut State) -> Result<(), Busy>) -> c_int {
    match session.map(begin) {
        Some(Ok(())) => DP_RC_SUCCESS,
        Some(Err(Busy)) => DP_RC_BUSY,
        None => DP_RC_ERROR_GENERIC,
    }
}
