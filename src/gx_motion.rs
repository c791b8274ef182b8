//! `libdeltarobot/gx_motion.h`: the motion side of the GX protocol, for firmware: takes commands, queues the moves,
//! reports how they end, reports the position.
//!
//! It does no I/O. The firmware's main loop calls:
//!
//! ```c
//! struct gx_motion_event event;
//! struct gx_vector target;
//! int length;
//!
//! taken += gx_motion_receive(&motion, in + taken, got - taken, now_ms());
//! while (gx_motion_poll(&motion, now_ms(), &event) == GX_RC_SUCCESS)
//!     if (event.kind == GX_MOTION_STOP && motors_stop() == 0)
//!         gx_motion_stop(&motion, 0);
//! motors_count(steps);
//! gx_motion_set_position(&motion, steps);
//! if (motors_have_arrived())
//!     gx_motion_done(&motion);
//! if (motors_state() == 0 && gx_motion_next(&motion, &target, NULL) == GX_RC_SUCCESS)
//!     motors_start(target.mask, target.axes, target.velocity);
//! if ((length = gx_motion_output(&motion, out, sizeof out, now_ms())) > 0)
//!     uart_write(&uart, out, length);
//! ```
//!
//! From power-up on, moves are taken as the proposal has it, with any number or none, until a host begins a session,
//! which makes up for what the line loses, delays or splits: see gx_motion_receive. Set only_in_order where only such
//! hosts drive the machine. Commands have no checksum: a flipped bit can make another move of one, which is carried out;
//! the host finds that afterwards.

use core::ffi::{c_int, c_long, c_ulong, c_void};

use super::gx::{GX_RC_ERROR_GENERIC, GX_RC_NO_EVENT, GX_RC_SUCCESS, Vector, fill};
use super::memory::{bytes_of, copy_counters, duration, int, long, time};
use super::state::{Room, state};
use crate::sizes::GX_QUEUE_MAX;
use deltarobot_export::export;
use deltarobot_protocols::gx::motion::{self, EventKind};
use deltarobot_protocols::gx::{AXES, CODE_FREE, Fault, MASK_AXES, Numbered};
use zerocopy::{FromBytes, IntoBytes, transmute_mut, transmute_ref};

/// Event: a move was queued, for `gx_motion_next` to fetch.
pub const GX_MOTION_QUEUED: c_int = 1;
/// Event: a move that was queued before came again. There is nothing to do.
pub const GX_MOTION_REPEATED: c_int = 2;
/// Event: a command was refused: code.
pub const GX_MOTION_REFUSED: c_int = 3;
/// Event: a host has begun a session; its request for position reports holds too.
pub const GX_MOTION_BEGUN: c_int = 4;
/// Event: a host has asked for position reports, without beginning a session: period. There is nothing to do.
pub const GX_MOTION_REPORTING: c_int = 5;
/// Event: a host wants the machine to hold, that is, to pause. `gx_motion_next` hands out no moves.
pub const GX_MOTION_HOLD: c_int = 6;
/// Event: a host wants the machine to go on.
pub const GX_MOTION_RESUME: c_int = 7;
/// Event: the machine is to stop for good, as a host wants it (code is `GX_FAULT_STOPPED`) or is silent
/// (`GX_FAULT_SILENT`). No moves are handed out until `gx_motion_stop` is called, as soon as the machine stands.
pub const GX_MOTION_STOP: c_int = 8;

const _: () = {
    assert!(GX_MOTION_QUEUED == EventKind::Queued as c_int && GX_MOTION_REPEATED == EventKind::Repeated as c_int);
    assert!(GX_MOTION_REFUSED == EventKind::Refused as c_int && GX_MOTION_BEGUN == EventKind::Begun as c_int);
    assert!(GX_MOTION_REPORTING == EventKind::Reporting as c_int && GX_MOTION_HOLD == EventKind::Hold as c_int);
    assert!(GX_MOTION_RESUME == EventKind::Resume as c_int && GX_MOTION_STOP == EventKind::Stop as c_int);
};

/// Something that happened.
#[derive(Debug)]
#[repr(C)]
pub struct MotionEvent {
    /// What: one of `GX_MOTION_QUEUED` to `GX_MOTION_STOP`.
    pub kind: c_int,
    /// The number of the command, 0 to 16383; -1 when it has none, and from `GX_MOTION_REPORTING` on.
    pub number: c_int,
    /// Of `GX_MOTION_REFUSED` and `GX_MOTION_STOP`, why: `GX_FAULT_*`; 0 of others.
    pub code: c_int,
    /// Of `GX_MOTION_REPORTING`, the time between two reports in milliseconds, 0 if they are off; 0 of others.
    pub period: c_int,
}

/// Settings of a motion side. 0 stands for the default everywhere.
#[derive(Debug)]
#[repr(C)]
pub struct MotionSettings {
    /// Milliseconds of silence after which an incomplete command is given up, with an error notice; by default 1000.
    pub gap_ms: c_ulong,
    /// The machine is to stop (`GX_MOTION_STOP`) when nothing has come for this many milliseconds while there are moves
    /// to carry out; `gx_host.h` then sends something every `probe_ms`, by default 1000. 0: it is not to stop.
    pub host_ms: c_ulong,
    /// The axes there are, bit 0 being x: commands for others are refused, and none reported. By default all six.
    pub axes: c_int,
    /// Not 0: moves are taken in sessions only, for a machine that only hosts with sessions drive: when it was switched
    /// off and on, or reset, it takes nothing from a host that did not notice, for the rest of the session. By default
    /// moves are taken with any number, or none, until a host begins a session.
    pub only_in_order: c_int,
}

/// Counters of a motion side since it began; they wrap.
#[derive(Debug, FromBytes, IntoBytes)]
#[repr(C)]
pub struct MotionHealth {
    /// Moves queued.
    pub moves: c_ulong,
    /// Moves that were queued before and came again: not carried out twice.
    pub repeats: c_ulong,
    /// Moves refused, with an error notice or without.
    pub refused: c_ulong,
    /// Malformed commands.
    pub malformed: c_ulong,
    /// Position reports sent.
    pub reports: c_ulong,
}

/// Structs have no padding on AVR, where a queued move takes 30 bytes, and RAM is too scarce for room to spare.
const MOTION_BYTES: usize = if align_of::<i32>() == 1 { 175 + 30 * GX_QUEUE_MAX } else { 192 + 32 * GX_QUEUE_MAX };
const GX_MOTION_WORDS: usize = MOTION_BYTES / size_of::<c_ulong>();

/// A motion side. All zero is a new one with default settings. Its contents are private.
#[derive(Debug)]
#[repr(C)]
pub struct Motion {
    opaque: [c_ulong; GX_MOTION_WORDS],
}
state!(Motion: motion::Motion<GX_QUEUE_MAX>);

/// Begins a motion side. settings are copied; NULL stands for the defaults, which memory that is all zero has too.
/// Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when motion is NULL.
///
/// ```c
/// struct gx_motion_settings settings = {0};
/// settings.axes = 1 | 2 | 4;
/// gx_motion_init(&motion, &settings);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_init(motion: *mut Motion, settings: *const MotionSettings) -> c_int {
    // SAFETY: pointers are NULL or valid, and the objects do not overlap.
    let (Some(motion), settings) = (unsafe { (Room::init(motion), settings.as_ref()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    if let Some(&MotionSettings { gap_ms, host_ms, axes, only_in_order }) = settings {
        motion.set(motion::Settings {
            gap_ms: duration(gap_ms),
            host_ms: duration(host_ms),
            axes: u8::try_from(axes & c_int::from(MASK_AXES)).unwrap_or_default(),
            only_in_order: u8::from(only_in_order != 0),
        });
    }
    GX_RC_SUCCESS
}

/// Takes received bytes; `now_ms` is when they came.
///
/// Moves are queued whatever number they have or none, until a host begins a session: by two numbered requests for
/// position reports in a row, the second number 5461 behind the first (modulo 16384), which is answered by both
/// numbers. From there on each move has to carry the next number: what was taken before is not carried out twice, and
/// what comes out of order (`GX_FAULT_ORDER`) or without a number (`GX_FAULT_NUMBERLESS`) is refused; ends are reported
/// with a check of where the move led (`GX_CONFIRMED`). One more numbered request begins a new session. Behind
/// `gx_motion_stop`, moves are refused until one begins (`GX_FAULT_CLOSED`); ESC ESC lets them be taken as they come
/// again.
///
/// Returns how many bytes were taken: all, or fewer when events or output have to be fetched first; give it the rest
/// then. Returns -`GX_RC_ERROR_GENERIC` when motion is NULL, bytes is negative, or buf is NULL and bytes is not 0.
///
/// ```c
/// int got = uart_read(&uart, in, sizeof in);
/// for (int taken = 0; taken < got; serve(&motion))
///     taken += gx_motion_receive(&motion, in + taken, got - taken, now_ms());
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_receive(
    motion: *mut Motion,
    buf: *const c_void,
    bytes: c_int,
    now_ms: c_ulong,
) -> c_int {
    // SAFETY: motion is NULL or valid, bytes is buf's size, and they do not overlap.
    match unsafe { (Room::get(motion), bytes_of(buf, bytes)) } {
        (Some(motion), Some(input)) => int(motion.receive(input, time(now_ms))),
        _ => -GX_RC_ERROR_GENERIC,
    }
}

/// Fetches the next event. To be called after receiving, and when `gx_motion_next_deadline` says, until there is none.
/// Returns `GX_RC_SUCCESS` and the event, `GX_RC_NO_EVENT` when there is none (kind is 0 then), or
/// `GX_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// struct gx_motion_event event;
/// while (gx_motion_poll(&motion, now_ms(), &event) == GX_RC_SUCCESS)
///     printf("event %d\n", event.kind);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_poll(motion: *mut Motion, now_ms: c_ulong, event: *mut MotionEvent) -> c_int {
    // SAFETY: pointers are NULL or valid, and the objects do not overlap.
    let (Some(motion), Some(event)) = (unsafe { (Room::get(motion), event.as_mut()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    let Some(happened) = motion.poll(time(now_ms)) else {
        event.kind = 0;
        return GX_RC_NO_EVENT;
    };
    event.kind = happened.kind as c_int;
    event.number = number_of(happened.number);
    event.code = happened.code.into();
    event.period = int(happened.period.into());
    GX_RC_SUCCESS
}

/// Fetches the next move to carry out; what only sets the velocity is none, and ends in its turn. Firmware that plans
/// ahead may fetch more before the first is done. move receives the target: its mask flags the axes to be moved, and the
/// velocity if one was ever set; the other axes hold where they are to stay, as far as that is known. number, unless it
/// is NULL, receives the move's number, or -1 when it has none or its session is over.
///
/// Returns `GX_RC_SUCCESS`, `GX_RC_NO_EVENT` when there is none, or `GX_RC_ERROR_GENERIC` when motion or move is NULL.
///
/// ```c
/// struct gx_vector target;
/// if (motors_state() == 0 && gx_motion_next(&motion, &target, NULL) == GX_RC_SUCCESS)
///     motors_start(target.mask, target.axes, target.velocity);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_next(motion: *mut Motion, r#move: *mut Vector, number: *mut c_int) -> c_int {
    // SAFETY: pointers are NULL or valid, and the objects do not overlap.
    let (Some(motion), Some(room), number) = (unsafe { (Room::get(motion), r#move.as_mut(), number.as_mut()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    let Some((target, its_number)) = motion.next() else {
        return GX_RC_NO_EVENT;
    };
    room.core_mut().copy(target);
    if let Some(number) = number {
        *number = number_of(its_number);
    }
    GX_RC_SUCCESS
}

/// Says that the oldest of the moves fetched has been carried out. Its number, if it has one, is reported to the host.
/// Returns `GX_RC_SUCCESS`, `GX_RC_NO_EVENT` when none was fetched, or `GX_RC_ERROR_GENERIC` when motion is NULL.
///
/// ```c
/// if (motors_have_arrived())
///     gx_motion_done(&motion);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_done(motion: *mut Motion) -> c_int {
    // SAFETY: motion is NULL or valid.
    match unsafe { Room::get(motion) }.map(motion::Motion::done) {
        Some(true) => GX_RC_SUCCESS,
        Some(false) => GX_RC_NO_EVENT,
        None => GX_RC_ERROR_GENERIC,
    }
}

/// Says that the machine has stopped: what was fetched or queued is dropped, which the host hears by an error notice of
/// the oldest move that has a number. code is that notice's: 0 stands for `GX_FAULT_STOPPED`; 64 to 127 are the
/// firmware's own. A host with a session has to begin a new one. `gx_motion_set_position` has to be called before moves
/// by deltas are taken; if the host wanted the stop, before this call: the position is reported then, and the velocity
/// in force.
///
/// Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when motion is NULL or code is another.
///
/// ```c
/// if (stop_is_pressed() && motors_stop() == 0)
///     gx_motion_stop(&motion, 0);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_stop(motion: *mut Motion, code: c_int) -> c_int {
    let code = match u8::try_from(code) {
        Ok(0) => Fault::Stopped as u8,
        Ok(code @ CODE_FREE..=127) => code,
        _ => return GX_RC_ERROR_GENERIC,
    };
    // SAFETY: motion is NULL or valid.
    let Some(motion) = (unsafe { Room::get(motion) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    motion.stop(code);
    GX_RC_SUCCESS
}

/// Says where the machine is: position reports give this, and moves by deltas begin here on axes that no move has
/// positioned yet. position holds `GX_AXES` values in steps, x first. Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC`
/// when a pointer is NULL or a value is not a position (28 bits): nothing changes then.
///
/// ```c
/// int32_t steps[GX_AXES];
/// motors_count(steps);
/// gx_motion_set_position(&motion, steps);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_set_position(motion: *mut Motion, position: *const i32) -> c_int {
    // SAFETY: pointers are NULL or valid, position's to six values, and they do not overlap.
    let (Some(motion), Some(position)) = (unsafe { (Room::get(motion), position.cast::<[i32; AXES]>().as_ref()) })
    else {
        return GX_RC_ERROR_GENERIC;
    };
    if motion.set_position(position) { GX_RC_SUCCESS } else { GX_RC_ERROR_GENERIC }
}

/// Fetches the bytes to send: whole notices and reports, as many as fit; `now_ms` is when they leave. To be called
/// after `gx_motion_poll`. Room for `GX_ENCODED_MAX` bytes is always enough for one.
///
/// Returns how many bytes were written, 0 when there is nothing to send or no room for the next notice, or
/// -`GX_RC_ERROR_GENERIC` when motion is NULL, cap is negative, or buf is NULL and cap is not 0.
///
/// ```c
/// if ((length = gx_motion_output(&motion, out, sizeof out, now_ms())) > 0)
///     uart_write(&uart, out, length);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_output(motion: *mut Motion, buf: *mut c_void, cap: c_int, now_ms: c_ulong) -> c_int {
    // SAFETY: motion is NULL or valid, cap is buf's size, and they do not overlap.
    unsafe {
        match Room::get(motion) {
            Some(motion) => fill(buf, cap, |room| motion.output(room, time(now_ms))),
            None => -GX_RC_ERROR_GENERIC,
        }
    }
}

/// How long `gx_motion_poll` and `gx_motion_output` have nothing to do if nothing is received or done. To be called
/// when all events and output were fetched. Returns milliseconds, or -1 when they need not be called at all or motion
/// is NULL.
///
/// ```c
/// wait_readable(&uart, gx_motion_next_deadline(&motion, now_ms()));
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_next_deadline(motion: *const Motion, now_ms: c_ulong) -> c_long {
    // SAFETY: motion is NULL or valid.
    let left = unsafe { Room::peek(motion) }.and_then(|motion| motion.next_deadline(time(now_ms)));
    left.map_or(-1, long)
}

/// How many moves are queued or being carried out; 0 also when motion is NULL.
///
/// ```c
/// if (gx_motion_unfinished(&motion) == 0)
///     motors_stop();
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_unfinished(motion: *const Motion) -> c_int {
    // SAFETY: motion is NULL or valid.
    unsafe { Room::peek(motion) }.map_or(0, |motion| motion.unfinished().into())
}

/// Copies out what was seen. Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// struct gx_motion_health health;
/// if (gx_motion_get_health(&motion, &health) == GX_RC_SUCCESS)
///     printf("%lu moves, %lu refused\n", health.moves, health.refused);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_get_health(motion: *const Motion, health: *mut MotionHealth) -> c_int {
    // SAFETY: pointers are NULL or valid, and the objects do not overlap.
    let (Some(motion), Some(health)) = (unsafe { (Room::peek(motion), health.as_mut()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    copy_counters::<5>(transmute_ref!(motion.health()), transmute_mut!(health));
    GX_RC_SUCCESS
}

fn number_of(number: Numbered) -> c_int {
    if number.is_some() { int(number.value().into()) } else { -1 }
}
