//! `libdeltarobot/gx_motion.h`: the motion side of the GX protocol, for firmware: takes commands, queues the moves, tells
//! how they end, reports the position.
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
//!     ;
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
//! From power-up on, moves are taken with any number or none, and numbers are sent back when they are completed, as the
//! proposal has it. Moves by deltas are taken as soon as it is known where the axes are: from gx_motion_set_position, or
//! a move to a position.
//!
//! What the line loses, delays or splits is made up for with a host that begins a session (gx_host.h): see
//! gx_motion_receive. Set only_in_order where only such hosts drive the machine: it protects from what a host sends that
//! has not noticed that the machine was switched off and on. Commands have no checksum: a flipped bit can make another
//! move of one, which nobody can tell from a true one.

use core::ffi::{c_int, c_long, c_ulong, c_void};
use core::mem::{align_of, offset_of, size_of};

use super::gx::{GX_FAULT_AXIS, GX_FAULT_CLOSED, GX_FAULT_NUMBERLESS, GX_FAULT_ORDER, GX_FAULT_OWN, GX_FAULT_STOPPED};
use super::gx::{GX_RC_ERROR_GENERIC, GX_RC_NO_EVENT, GX_RC_SUCCESS, init};
use super::memory::{bytes_of, fill, int, long};
use crate::sizes::GX_QUEUE_MAX;
use deltarobot_export::export;
use deltarobot_protocols::clock::time;
use deltarobot_protocols::gx::motion::{self, Event, Health, Motion, Queue, Queued, Settings};
use deltarobot_protocols::gx::{AXES, CommandReceiver, Number, Vector};

/// Event: a move was queued, for `gx_motion_next` to fetch.
pub const GX_MOTION_QUEUED: c_int = 1;
/// Event: a move that was queued before came again. There is nothing to do.
pub const GX_MOTION_REPEATED: c_int = 2;
/// Event: a command was refused: code.
pub const GX_MOTION_REFUSED: c_int = 3;
/// Event: a host has begun a session; its request for position reports holds too.
pub const GX_MOTION_BEGUN: c_int = 4;
/// Event: a host, without beginning a session, has asked for position reports: period. (Its number, if it has one, is
/// sent back, and not told here.)
pub const GX_MOTION_REPORTING: c_int = 5;

/// Something that happened.
#[derive(Debug)]
#[repr(C)]
pub struct MotionEvent {
    /// What: one of `GX_MOTION_QUEUED` to `GX_MOTION_REPORTING`.
    pub kind: c_int,
    /// The number of the command, 0 to 16383; -1 when it has none, and of `GX_MOTION_REPORTING`.
    pub number: c_int,
    /// Of `GX_MOTION_REFUSED`, why: `GX_FAULT_*`; 0 of others.
    pub code: c_int,
    /// Of `GX_MOTION_REPORTING`, the time between two reports in milliseconds; 0: they were switched off. 0 of others.
    pub period: c_int,
}

// The layout that C compilers give these structs; C tests assert the same numbers.
#[expect(clippy::arithmetic_side_effects, reason = "done by the compiler")]
const _: () = {
    const INT: usize = size_of::<c_int>();
    const LONG: usize = size_of::<c_ulong>();
    const VECTOR: usize = size_of::<Vector>();
    const fn up(size: usize, align: usize) -> usize {
        size.next_multiple_of(align)
    }
    assert!(offset_of!(Settings, gap_ms) == 0 && offset_of!(Settings, axes) == LONG);
    assert!(offset_of!(Settings, only_in_order) == LONG + INT);
    assert!(size_of::<Settings>() == up(LONG + 2 * INT, align_of::<c_ulong>()));
    assert!(offset_of!(Health, moves) == 0 && offset_of!(Health, repeats) == LONG);
    assert!(offset_of!(Health, refused) == 2 * LONG && offset_of!(Health, malformed) == 3 * LONG);
    assert!(offset_of!(Health, reports) == 4 * LONG && size_of::<Health>() == 5 * LONG);
    assert!(size_of::<Queued>() == VECTOR + up(3, align_of::<i32>()));
    assert!(size_of::<Queue>() == GX_QUEUE_MAX * size_of::<Queued>() + VECTOR + up(4, align_of::<i32>()));
    assert!(offset_of!(MotionEvent, kind) == 0 && offset_of!(MotionEvent, number) == INT);
    assert!(offset_of!(MotionEvent, code) == 2 * INT && offset_of!(MotionEvent, period) == 3 * INT);
    assert!(size_of::<MotionEvent>() == 4 * INT);
    if INT == 4 && LONG == 8 {
        let receiver =
            up(up(size_of::<Settings>() + 5 * LONG + size_of::<Queue>() + VECTOR, LONG) + 16 + 26 + 10 + 6, 4);
        assert!(size_of::<Motion>() == up(up(receiver + size_of::<CommandReceiver>(), LONG) + LONG + 2, LONG));
    }
    assert!(GX_FAULT_ORDER == motion::ORDER as c_int && GX_FAULT_CLOSED == motion::CLOSED as c_int);
    assert!(GX_FAULT_NUMBERLESS == motion::NUMBERLESS as c_int && GX_FAULT_AXIS == motion::AXIS as c_int);
    assert!(GX_FAULT_STOPPED == motion::STOPPED as c_int && GX_FAULT_OWN == motion::CODE_FREE as c_int);
};

/// Begins a motion side. Memory that is all zero is one too, with the default settings.
///
/// settings are copied; NULL stands for the defaults.
///
/// Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when motion is NULL.
///
/// ```c
/// struct gx_motion_settings settings = {0};
/// settings.axes = 1 | 2 | 4;
/// gx_motion_init(&motion, &settings);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_init(motion: *mut Motion, settings: *const Settings) -> c_int {
    // SAFETY: as the contract of this function asks; zero is a motion side.
    let (Some(motion), settings) = (unsafe { (init(motion), settings.as_ref()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    if let Some(settings) = settings {
        motion.set(settings);
    }
    GX_RC_SUCCESS
}

/// Takes received bytes; `now_ms` is when they came.
///
/// Moves are queued as they come, whatever number they have or none, unless a host begins a session: by two numbered
/// requests for position reports without another command between them, the second number 5461 behind the first (modulo
/// 16384). The second is answered by both numbers. From there on each move has to carry the next number: what was taken
/// before is not carried out twice, and what comes out of order (`GX_FAULT_ORDER`) or without a number
/// (`GX_FAULT_NUMBERLESS`) is refused. Another numbered request for position reports begins a new session. Behind
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
    // SAFETY: as the contract of this function asks.
    match unsafe { (motion.as_mut(), bytes_of(buf, bytes)) } {
        (Some(motion), Some(input)) => int(motion.receive(input, time(now_ms))),
        _ => -GX_RC_ERROR_GENERIC,
    }
}

/// Fetches the next event. To be called after receiving, and at the latest when `gx_motion_next_deadline` says, until
/// there is none.
///
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
    // SAFETY: as the contract of this function asks.
    let Some(motion) = (unsafe { motion.as_mut() }).filter(|_| !event.is_null()) else {
        return GX_RC_ERROR_GENERIC;
    };
    let happened = motion.poll(time(now_ms));
    // SAFETY: event is not NULL.
    unsafe { write_event(event, happened) };
    if happened.is_some() { GX_RC_SUCCESS } else { GX_RC_NO_EVENT }
}

/// Fetches the next move to carry out. Firmware that plans ahead may fetch more before the first is done. What only
/// sets the velocity is no move: it takes effect, and ends, in its turn.
///
/// move receives the target: its mask flags the axes to be moved (and the velocity, if one was ever set; it holds for
/// all moves to come); the other axes hold where they are to stay, as far as that is known. number, unless it is NULL,
/// receives the move's number, or -1 when it has none or its session is over.
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
    // SAFETY: as the contract of this function asks.
    let (Some(motion), Some(room), number) = (unsafe { (motion.as_mut(), r#move.as_mut(), number.as_mut()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    let Some((target, its_number)) = motion.next() else {
        return GX_RC_NO_EVENT;
    };
    room.copy(target);
    if let Some(number) = number {
        *number = number_of(its_number);
    }
    GX_RC_SUCCESS
}

/// Says that the oldest of the moves fetched has been carried out. Its number, if it has one, is told to the host.
///
/// Returns `GX_RC_SUCCESS`, `GX_RC_NO_EVENT` when none is being carried out, or `GX_RC_ERROR_GENERIC` when motion is
/// NULL.
///
/// ```c
/// if (motors_have_arrived())
///     gx_motion_done(&motion);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_done(motion: *mut Motion) -> c_int {
    // SAFETY: as the contract of this function asks.
    match unsafe { motion.as_mut() }.map(Motion::done) {
        Some(true) => GX_RC_SUCCESS,
        Some(false) => GX_RC_NO_EVENT,
        None => GX_RC_ERROR_GENERIC,
    }
}

/// Says that the machine has stopped, and will not carry out what was fetched or queued: all of that is dropped, and
/// the host is told, by the number of the oldest move that has one. A host that had begun a session has to begin a new
/// one. Where the machine is has to be told by `gx_motion_set_position` before moves by deltas are taken.
///
/// code goes into the error notice: 0 stands for `GX_FAULT_STOPPED`; 64 to 127 are the firmware's own.
///
/// motion was begun by `gx_motion_init` or is all zero.
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
        Ok(0) => motion::STOPPED,
        Ok(code @ motion::CODE_FREE..=127) => code,
        _ => return GX_RC_ERROR_GENERIC,
    };
    // SAFETY: as the contract of this function asks.
    let Some(motion) = (unsafe { motion.as_mut() }) else {
        return GX_RC_ERROR_GENERIC;
    };
    motion.stop(code);
    GX_RC_SUCCESS
}

/// Says where the machine is: for position reports, and, as long as no move has told where an axis is, as that which
/// deltas are added to. position holds `GX_AXES` values in steps, x first.
///
/// position is NULL or points to six values.
///
/// Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when a pointer is NULL or a value is not a position (28 bits):
/// nothing changes then.
///
/// ```c
/// int32_t steps[GX_AXES];
/// motors_count(steps);
/// gx_motion_set_position(&motion, steps);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_set_position(motion: *mut Motion, position: *const i32) -> c_int {
    // SAFETY: as the contract of this function asks.
    let (Some(motion), Some(position)) = (unsafe { (motion.as_mut(), position.cast::<[i32; AXES]>().as_ref()) }) else {
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
/// int length = gx_motion_output(&motion, out, sizeof out, now_ms());
/// if (length > 0)
///     uart_write(&uart, out, length);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_output(motion: *mut Motion, buf: *mut c_void, cap: c_int, now_ms: c_ulong) -> c_int {
    // SAFETY: as the contract of this function asks.
    let Some(motion) = (unsafe { motion.as_mut() }) else {
        return -GX_RC_ERROR_GENERIC;
    };
    // SAFETY: as the contract of this function asks.
    let written = unsafe { fill(buf, cap, |frame, room| motion.output(frame, room, time(now_ms))) };
    written.unwrap_or(-GX_RC_ERROR_GENERIC)
}

/// How long `gx_motion_poll` and `gx_motion_output` have nothing to do if nothing is received or done. Ask when there
/// are no events left and the output was fetched.
///
/// Returns milliseconds, or -1 when they need not be called at all or motion is NULL.
///
/// ```c
/// wait_readable(&uart, gx_motion_next_deadline(&motion, now_ms()));
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_next_deadline(motion: *const Motion, now_ms: c_ulong) -> c_long {
    // SAFETY: as the contract of this function asks.
    let left = unsafe { motion.as_ref() }.and_then(|motion| motion.next_deadline(time(now_ms)));
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
    // SAFETY: as the contract of this function asks.
    unsafe { motion.as_ref() }.map_or(0, |motion| motion.unfinished().into())
}

/// What was seen: NULL when motion is, else counters that live and change with it.
///
/// ```c
/// const struct gx_motion_health *health = gx_motion_get_health(&motion);
/// printf("%lu moves, %lu refused\n", health->moves, health->refused);
/// ```
#[export(gx)]
pub unsafe extern "C" fn gx_motion_get_health(motion: *const Motion) -> *const Health {
    // SAFETY: as the contract of this function asks.
    match unsafe { motion.as_ref() } {
        Some(motion) => motion.health(),
        None => core::ptr::null(),
    }
}

/// # Safety
///
/// event points to writable memory of its type.
unsafe fn write_event(event: *mut MotionEvent, happened: Option<Event>) {
    let (kind, number, code, period) = match happened {
        None => (0, None, 0, 0),
        Some(Event::Queued(number)) => (GX_MOTION_QUEUED, number, 0, 0),
        Some(Event::Repeated(number)) => (GX_MOTION_REPEATED, number, 0, 0),
        Some(Event::Refused(number, code)) => (GX_MOTION_REFUSED, number, code, 0),
        Some(Event::Begun(number)) => (GX_MOTION_BEGUN, number, 0, 0),
        Some(Event::Reporting(period)) => (GX_MOTION_REPORTING, None, 0, period),
    };
    // SAFETY: as the contract of this function asks.
    unsafe {
        (*event).kind = kind;
        (*event).number = number_of(number);
        (*event).code = code.into();
        (*event).period = int(period.into());
    }
}

fn number_of(number: Option<Number>) -> c_int {
    number.map_or(-1, |number| int(number.value.into()))
}
