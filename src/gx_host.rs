//! `libdeltarobot/gx_host.h`: the host's end of the GX protocol: numbers moves, sends them in their shortest form,
//! again where something was lost, and reports how they ended.
//!
//! A session does no I/O. A loop around it:
//!
//! ```c
//! struct gx_host_event event;
//! char in[64], out[GX_ENCODED_MAX];
//! int got = 0, taken = 0, length;
//!
//! gx_host_init(&host, NULL);
//! for (;;) {
//!     while (gx_host_poll(&host, now_ms(), &event) == GX_RC_SUCCESS)
//!         handle_event(&event);
//!     while (path_goes_on() && gx_host_move(&host, next_position(), 1 | 2, 500) == GX_RC_SUCCESS)
//!         go_on();
//!     while ((length = gx_host_output(&host, out, sizeof out, now_ms())) > 0)
//!         uart_write(&uart, out, length);
//!     if (is_over())
//!         break;
//!     if (taken == got) {
//!         wait_readable(&uart, gx_host_next_deadline(&host, now_ms()));
//!         taken = 0;
//!         got = uart_read(&uart, in, sizeof in);
//!     }
//!     taken += gx_host_receive(&host, in + taken, got - taken, now_ms());
//! }
//! ```
//!
//! It needs a motion side that keeps numbers in order, as gx_motion.h does in a session; one that only sends them back
//! is driven if `echo` is set, else moves end as timed out, and are not sent.
//!
//! Whatever the line loses, delays or splits, when the machine stops, and when the host is begun again, a move is
//! reported as finished only if it was carried out, once and in order, and as refused or dropped only if it was not.
//! The same holds when the motion side is switched off and on, or reset, if it has only_in_order set (gx_motion.h):
//! moves are reported as lost then. Else it carries out again what is sent again, and moves by deltas from where it
//! believes to be.
//!
//! Commands have no checksum: a flipped bit can make another move of one, and so can lost bytes (in binary a mask or
//! several in a row, in ASCII any digit). It is carried out, and reported as GX_HOST_DEVIATED; the next corrects it.

use core::ffi::{c_int, c_long, c_ulong, c_void};

use super::gx::{GX_RC_BUSY, GX_RC_ERROR_GENERIC, GX_RC_NO_EVENT, GX_RC_SUCCESS, control_of, fill};
use super::memory::{bytes_of, copy_counters, duration, int, long, short, time};
use super::state::{Room, state};
use crate::sizes::GX_WINDOW_MAX;
use deltarobot_export::export;
use deltarobot_protocols::gx::host::{self, QueueError};
use deltarobot_protocols::gx::{self, AXES, MASK_AXES, PERIOD_MAX};
use event::{HostEvent, write_event};
use zerocopy::{FromBytes, IntoBytes, transmute_mut, transmute_ref};

pub mod event;

/// Settings of a host session, times in milliseconds. 0 stands for the default everywhere.
#[derive(Debug)]
#[repr(C)]
pub struct HostSettings {
    /// How long an answer may take to come; by default 250. What asks for one is not sent again sooner.
    pub answer_ms: c_ulong,
    /// When no move ends for this long, the newest one is sent again, as something may be lost; by default 1000.
    pub probe_ms: c_ulong,
    /// A session is given up when a move takes longer than this from its turn on; by default 120000.
    pub move_ms: c_ulong,
    /// A notice is complete when the line was quiet for this long, or another one has begun; by default 50.
    pub gap_ms: c_ulong,
    /// How often something is sent without an answer, or a session begun in vain; by default 8. Below 0: no limit.
    pub attempts: c_int,
    /// Most moves that are sent and unfinished at a time: 1 to `GX_WINDOW_MAX`, the default. More than the motion side
    /// queues are refused by it, and sent again.
    pub window: c_int,
    /// Not 0: commands are sent in ASCII, without short forms; position reports come in ASCII too.
    pub ascii: c_int,
    /// The number that the first session begins with, 0 to 16383.
    pub first_number: c_int,
    /// Every so manieth move is sent in positions, 1 to 255, so that nothing drifts; by default every 16th.
    pub absolute_every: c_int,
    /// Not 0: the motion side only sends numbers back, as the proposal has it. Then without a session one move at a
    /// time is sent, in positions; again after `probe_ms`, which should be longer than a move lasts.
    pub echo: c_int,
}

/// Counters of a host session since it began; they wrap.
#[derive(Debug, FromBytes, IntoBytes)]
#[repr(C)]
pub struct HostHealth {
    /// Moves sent, each counted once.
    pub moves: c_ulong,
    /// Moves sent again.
    pub repeats: c_ulong,
    /// Notices that moves were carried out.
    pub completions: c_ulong,
    /// Error notices.
    pub errors: c_ulong,
    /// Notices of numbers that nothing unfinished has: late, or sent again.
    pub strays: c_ulong,
    /// Position reports.
    pub reports: c_ulong,
    /// Malformed notices.
    pub malformed: c_ulong,
    /// Answers that did not come in time.
    pub timeouts: c_ulong,
    /// Sessions begun.
    pub sessions: c_ulong,
    /// Ends and reports that did not fit what was requested.
    pub deviations: c_ulong,
}

/// A move takes 32 bytes at most; the rest is some 220.
const GX_HOST_WORDS: usize = (272 + 32 * GX_WINDOW_MAX) / size_of::<c_ulong>();

/// A host session. All zero is a new session with default settings. Its contents are private.
#[derive(Debug)]
#[repr(C)]
pub struct Host {
    opaque: [c_ulong; GX_HOST_WORDS],
}
state!(Host: host::Host<GX_WINDOW_MAX>);

/// Begins a session. settings are copied; NULL stands for the defaults, which memory that is all zero has too. Returns
/// `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when host is NULL.
///
/// ```c
/// struct gx_host_settings settings = {0};
/// settings.window = 4;
/// gx_host_init(&host, &settings);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_host_init(host: *mut Host, settings: *const HostSettings) -> c_int {
    // SAFETY: pointers are NULL or valid, and the objects do not overlap.
    let (Some(host), settings) = (unsafe { (Room::init(host), settings.as_ref()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    if let Some(settings) = settings {
        let HostSettings {
            answer_ms,
            probe_ms,
            move_ms,
            gap_ms,
            attempts,
            window,
            ascii,
            first_number,
            absolute_every,
            echo,
        } = *settings;
        host.set(host::Settings {
            answer_ms: duration(answer_ms),
            probe_ms: duration(probe_ms),
            move_ms: duration(move_ms),
            gap_ms: duration(gap_ms),
            attempts: short(attempts),
            window: u8::try_from(window).unwrap_or_default(),
            ascii: u8::from(ascii != 0),
            first_number: u16::try_from(first_number).unwrap_or_default(),
            absolute_every: u8::try_from(absolute_every).unwrap_or_default(),
            echo: u8::from(echo != 0),
        });
    }
    GX_RC_SUCCESS
}

/// Requests a move behind those requested before; its end comes as an event. target holds `GX_AXES` positions in steps,
/// x first, of which those count that axes, a mask, flags; the other axes stay. velocity is in steps per second, 0 to
/// 16383, and holds from this move on; -1: that of the move before. Without any axis, only the velocity is set.
///
/// Returns `GX_RC_SUCCESS`, `GX_RC_BUSY` when the ends of `GX_WINDOW_MAX` moves were not fetched yet, or
/// `GX_RC_ERROR_GENERIC` when a pointer is NULL, a value or mask is out of range, or there is neither axis nor velocity.
///
/// ```c
/// const int32_t target[GX_AXES] = {1000, 2000, 0, 0, 0, 0};
/// if (gx_host_move(&host, target, 1 | 2, 500) == GX_RC_BUSY)
///     puts("first, events have to be fetched");
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_host_move(host: *mut Host, target: *const i32, axes: c_int, velocity: c_int) -> c_int {
    // SAFETY: pointers are NULL or valid, target's to six values, and they do not overlap.
    let (Some(host), Some(target)) = (unsafe { (Room::get(host), target.cast::<[i32; AXES]>().as_ref()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    match vector_of(target, axes, velocity).map(|target| host.move_to(&target)) {
        Some(Ok(())) => GX_RC_SUCCESS,
        Some(Err(QueueError::Busy)) => GX_RC_BUSY,
        Some(Err(QueueError::Range)) | None => GX_RC_ERROR_GENERIC,
    }
}

/// Requests position reports each `period_ms` milliseconds, 1 to 16383, or none any more: 0. They come as events, and
/// are asked for again when they stay away. Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when host is NULL or the
/// period is out of range.
///
/// ```c
/// if (gx_host_report(&host, 100) != GX_RC_SUCCESS)
///     puts("no such period");
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_host_report(host: *mut Host, period_ms: c_int) -> c_int {
    // SAFETY: host is NULL or valid.
    match (unsafe { Room::get(host) }, u16::try_from(period_ms)) {
        (Some(host), Ok(period)) if period <= PERIOD_MAX => {
            host.report(period);
            GX_RC_SUCCESS
        }
        _ => GX_RC_ERROR_GENERIC,
    }
}

/// Asks for something past the queue, `GX_CONTROL_QUERY` to `GX_CONTROL_STOP`, in place of what was asked for before,
/// until the answer comes: `GX_HOST_STATUS`, or of a stop `GX_HOST_STOPPED`; else `GX_HOST_UNANSWERED`. On a stop, moves
/// end as failed or dropped, or as lost where it is not known which of them ended.
///
/// Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when host is NULL or control is none of these.
///
/// ```c
/// if (stop_is_pressed())
///     gx_host_control(&host, GX_CONTROL_STOP);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_host_control(host: *mut Host, control: c_int) -> c_int {
    // SAFETY: host is NULL or valid.
    match (unsafe { Room::get(host) }, control_of(control)) {
        (Some(host), Some(control)) => host.control(control),
        _ => return GX_RC_ERROR_GENERIC,
    }
    GX_RC_SUCCESS
}

/// Takes received bytes; `now_ms` is when they came. Returns how many bytes were taken: all, or fewer when events have
/// to be fetched first by `gx_host_poll`; give it the rest then. Returns -`GX_RC_ERROR_GENERIC` when host is NULL,
/// bytes is negative, or buf is NULL and bytes is not 0.
///
/// ```c
/// int got = uart_read(&uart, in, sizeof in);
/// for (int taken = 0; taken < got; handle_events(&host))
///     taken += gx_host_receive(&host, in + taken, got - taken, now_ms());
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_host_receive(host: *mut Host, buf: *const c_void, bytes: c_int, now_ms: c_ulong) -> c_int {
    // SAFETY: host is NULL or valid, bytes is buf's size, and they do not overlap.
    match unsafe { (Room::get(host), bytes_of(buf, bytes)) } {
        (Some(host), Some(input)) => int(host.receive(input, time(now_ms))),
        _ => -GX_RC_ERROR_GENERIC,
    }
}

/// Fetches the next event. To be called after receiving, and when `gx_host_next_deadline` says, until there is none;
/// then `gx_host_output`. Returns `GX_RC_SUCCESS` and the event, `GX_RC_NO_EVENT` when there is none (kind is 0 then),
/// or `GX_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// struct gx_host_event event;
/// while (gx_host_poll(&host, now_ms(), &event) == GX_RC_SUCCESS)
///     if (event.kind == GX_HOST_ENDED)
///         printf("the oldest move: outcome %d\n", event.outcome);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_host_poll(host: *mut Host, now_ms: c_ulong, event: *mut HostEvent) -> c_int {
    // SAFETY: pointers are NULL or valid, and the objects do not overlap.
    let (Some(host), Some(event)) = (unsafe { (Room::get(host), event.as_mut()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    let happened = host.poll(time(now_ms));
    write_event(event, happened.as_ref());
    if happened.is_some() { GX_RC_SUCCESS } else { GX_RC_NO_EVENT }
}

/// Fetches the bytes to send: whole commands, as many as fit; `now_ms` is when they leave. To be called after
/// `gx_host_poll`. Room for `GX_ENCODED_MAX` bytes is always enough for one.
///
/// Returns how many bytes were written, 0 when there is nothing to send or no room for the next command, or
/// -`GX_RC_ERROR_GENERIC` when host is NULL, cap is negative, or buf is NULL and cap is not 0.
///
/// ```c
/// if ((length = gx_host_output(&host, out, sizeof out, now_ms())) > 0)
///     uart_write(&uart, out, length);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_host_output(host: *mut Host, buf: *mut c_void, cap: c_int, now_ms: c_ulong) -> c_int {
    // SAFETY: host is NULL or valid, cap is buf's size, and they do not overlap.
    unsafe {
        match Room::get(host) {
            Some(host) => fill(buf, cap, |room| host.output(room, time(now_ms))),
            None => -GX_RC_ERROR_GENERIC,
        }
    }
}

/// How long `gx_host_poll` has nothing to do if nothing is received or requested, as poll(2) takes it. To be called
/// when all events and output were fetched. Returns milliseconds, or -1 when it need not be called at all or host is
/// NULL.
///
/// ```c
/// wait_readable(&uart, gx_host_next_deadline(&host, now_ms()));
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_host_next_deadline(host: *const Host, now_ms: c_ulong) -> c_long {
    // SAFETY: host is NULL or valid.
    let left = unsafe { Room::peek(host) }.and_then(|host| host.next_deadline(time(now_ms)));
    left.map_or(-1, long)
}

/// How many moves were requested whose ends were not fetched yet; 0 also when host is NULL.
///
/// ```c
/// if (gx_host_unfinished(&host) == 0)
///     puts("all moves have ended");
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_host_unfinished(host: *const Host) -> c_int {
    // SAFETY: host is NULL or valid.
    unsafe { Room::peek(host) }.map_or(0, |host| host.unfinished().into())
}

/// Copies out how the link does. Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// struct gx_host_health health;
/// if (gx_host_get_health(&host, &health) == GX_RC_SUCCESS)
///     printf("%lu moves, %lu repeats\n", health.moves, health.repeats);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_host_get_health(host: *const Host, health: *mut HostHealth) -> c_int {
    // SAFETY: pointers are NULL or valid, and the objects do not overlap.
    let (Some(host), Some(health)) = (unsafe { (Room::peek(host), health.as_mut()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    copy_counters::<10>(transmute_ref!(host.health()), transmute_mut!(health));
    GX_RC_SUCCESS
}

/// What `gx_host_move` was given, if it can be a vector.
fn vector_of(target: &[i32; AXES], axes: c_int, velocity: c_int) -> Option<gx::Vector> {
    let mut vector = gx::Vector::new();
    for (place, value) in vector.axes.iter_mut().zip(target) {
        *place = *value;
    }
    vector.mask = u8::try_from(axes).ok().filter(|axes| *axes <= MASK_AXES)?;
    if velocity != -1 {
        vector.set_velocity(u16::try_from(velocity).ok()?);
    }
    Some(vector)
}
