//! `libdeltarobot/controller.h`: the controller's end of the link, for firmware: has requests carried out and answered.

use core::ffi::{c_int, c_void};

use super::memory::{bytes_of, int};
use super::payload::layout_of;
use super::protocol::{DP_RC_ERROR_GENERIC, DP_RC_NO_FRAME, DP_RC_SUCCESS, Position, SendFunc, StatusReport};
use super::state::{Room, Word, state};
use crate::sizes::DP_DATA_MAX_SIZE;
use deltarobot_export::export;
use deltarobot_protocols::deltarobot::{Layout, PAYLOAD_MAX};
use serving::{Served, State};

mod serving;

/// Refuses homing and moving during an operation. Without it they take that one's place, as in shipped firmware.
pub const DP_CONTROLLER_REFUSE_BUSY: c_int = 1;
/// The end of homing and of a move is reported by `h` and `m` (specification), besides the status report.
pub const DP_CONTROLLER_REPORT_END: c_int = 2;
/// An error during an operation is reported by `e` (specification), besides the status report.
pub const DP_CONTROLLER_REPORT_ERROR: c_int = 4;

/// Begins to home. Returns 0, or anything else to refuse. From then until the end, the state is `DP_STATUS_HOMING`.
///
/// ```c
/// int start_homing(void *usr)
/// {
///     return motors_home();
/// }
/// ```
pub type HomeFunc = Option<unsafe extern "C" fn(usr: *mut c_void) -> c_int>;
/// Begins to move to target, which is free of NaNs, and gone when the function returns. Returns 0, or anything else to
/// refuse. From then until the end, the state is `DP_STATUS_MOVING`.
///
/// ```c
/// int start_move(const struct protocol_msg_position *target, void *usr)
/// {
///     return motors_move(target->DA, target->DB, target->DC);
/// }
/// ```
pub type MoveFunc = Option<unsafe extern "C" fn(target: *const Position, usr: *mut c_void) -> c_int>;
/// Begins to stop. Returns 0, or anything else to refuse.
///
/// ```c
/// int stop(void *usr)
/// {
///     return motors_stop();
/// }
/// ```
pub type CancelFunc = Option<unsafe extern "C" fn(usr: *mut c_void) -> c_int>;
/// Fills in report: the position, NaNs when it is not known, and state and end stops in STAT.
///
/// ```c
/// void read_status(struct protocol_msg_status_report *report, void *usr)
/// {
///     motors_where(&report->DA, &report->DB, &report->DC);
///     report->STAT = (unsigned char)(motors_state() | (stop_a_is_pressed() ? DP_BIT_STAT_STOP_A_BIT : 0));
/// }
/// ```
pub type ReadFunc = Option<unsafe extern "C" fn(report: *mut StatusReport, usr: *mut c_void)>;

/// The firmware's own functions. `read` and `send` are needed; what one that is NULL would do is refused.
#[derive(Debug)]
#[repr(C)]
pub struct Calls {
    /// Begins to home.
    pub home: HomeFunc,
    /// Begins to move.
    pub r#move: MoveFunc,
    /// Begins to stop.
    pub cancel: CancelFunc,
    /// Reads the status.
    pub read: ReadFunc,
    /// Sends bytes, whole frames. Its result is ignored: the protocol leaves lost frames to the host.
    pub send: SendFunc,
}

/// Words of a controller's room.
pub const DP_CONTROLLER_WORDS: usize = DP_DATA_MAX_SIZE / 4 + 13;

/// A controller. As it keeps pointers, it has to be made by `dp_controller_init`, or all zero, which does nothing.
#[derive(Debug)]
#[repr(C)]
pub struct Controller {
    opaque: [Word; DP_CONTROLLER_WORDS],
}

state!(Controller: State);

/// Makes a controller of any memory.
///
/// layout is that of status reports, `DP_LAYOUT_*` (`payload.h`); flags is a sum of `DP_CONTROLLER_*`. With 0 for both,
/// it answers like shipped firmware. calls' functions are given usr; calls stays there as long as the controller.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when controller or calls is NULL, calls has no `read` or `send`,
/// the layout is none of these, or `DP_DATA_MAX_SIZE` is below 16, a status report (13 for `DP_LAYOUT_SPEC`).
///
/// ```c
/// static const struct dp_controller_calls calls = {start_homing, start_move, stop, read_status, uart_send};
/// static struct dp_controller controller;
/// dp_controller_init(&controller, &calls, &uart, DP_LAYOUT_AUTO, 0);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_controller_init(
    controller: *mut Controller,
    calls: *const Calls,
    usr: *mut c_void,
    layout: c_int,
    flags: c_int,
) -> c_int {
    let longest = match layout_of(layout) {
        Some(Layout::Spec) => 13,
        Some(Layout::Auto | Layout::Firmware) => PAYLOAD_MAX,
        None => return DP_RC_ERROR_GENERIC,
    };
    // SAFETY: NULL or the caller's whole object.
    let Some(state) = unsafe { Controller::init(controller) }.filter(|_| longest <= DP_DATA_MAX_SIZE) else {
        return DP_RC_ERROR_GENERIC;
    };
    (state.calls, state.usr) = (calls.expose_provenance(), usr.expose_provenance());
    state.layout = u8::try_from(layout).unwrap_or_default();
    state.controller.refuse_busy(flags & DP_CONTROLLER_REFUSE_BUSY != 0);
    state.reports_end = u8::from(flags & DP_CONTROLLER_REPORT_END != 0);
    state.reports_error = u8::from(flags & DP_CONTROLLER_REPORT_ERROR != 0);
    // SAFETY: not NULL, so the caller's whole object; it was made just now.
    if unsafe { Served::new(controller) }.is_some() { DP_RC_SUCCESS } else { DP_RC_ERROR_GENERIC }
}

/// Takes received bytes. Not for an interrupt that may come during another call on the controller: there, bytes go into
/// a queue of the firmware's own.
///
/// Returns how many were taken: all, or as many as fit. The rest fits when `dp_controller_poll` has nothing to do.
/// Returns -`DP_RC_ERROR_GENERIC` when controller is NULL, bytes is negative, or buf is NULL and bytes is not 0.
///
/// ```c
/// int got = uart_read(&uart, in, sizeof in), taken = 0;
/// while (taken < got) {
///     taken += dp_controller_receive(&controller, in + taken, got - taken);
///     while (dp_controller_poll(&controller) == DP_RC_SUCCESS)
///         ;
/// }
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_controller_receive(controller: *mut Controller, buf: *const c_void, bytes: c_int) -> c_int {
    // SAFETY: NULL or the caller's, the controller whole and so many bytes readable; they don't overlap.
    match unsafe { (Controller::get(controller), bytes_of(buf, bytes)) } {
        (Some(state), Some(input)) => int(state.controller.receive(input)),
        _ => -DP_RC_ERROR_GENERIC,
    }
}

/// Does one thing, in the firmware's main loop: reports the end of the operation, or answers one request.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_NO_FRAME` when there was nothing to do, or `DP_RC_ERROR_GENERIC` when controller is
/// NULL or was not made by `dp_controller_init`.
///
/// ```c
/// while (dp_controller_poll(&controller) == DP_RC_SUCCESS)
///     ;
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_controller_poll(controller: *mut Controller) -> c_int {
    // SAFETY: NULL or the caller's whole object, made by dp_controller_init or all zero.
    poll(unsafe { Served::new(controller) }, false)
}

/// Like `dp_controller_poll`, for a line that has been quiet for longer than a frame takes: what is incomplete is given
/// up, as by `dp_recv_idle`.
///
/// ```c
/// if (now_ms() - heard_at >= 10)
///     dp_controller_poll_idle(&controller);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_controller_poll_idle(controller: *mut Controller) -> c_int {
    // SAFETY: NULL or the caller's whole object, made by dp_controller_init or all zero.
    poll(unsafe { Served::new(controller) }, true)
}

/// Sends a status report unasked, as shipped firmware does at each encoder step of a move. Returns `DP_RC_SUCCESS`, or
/// `DP_RC_ERROR_GENERIC` when controller is NULL or was not made by `dp_controller_init`.
///
/// ```c
/// if (motors_state() == DP_STATUS_MOVING && motors_made_a_step())
///     dp_controller_report(&controller);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_controller_report(controller: *mut Controller) -> c_int {
    // SAFETY: NULL or the caller's whole object, made by dp_controller_init or all zero.
    let Some(served) = (unsafe { Served::new(controller) }) else { return DP_RC_ERROR_GENERIC };
    served.report();
    DP_RC_SUCCESS
}

fn poll(served: Option<Served>, idle: bool) -> c_int {
    match served.map(|served| served.act(idle)) {
        Some(true) => DP_RC_SUCCESS,
        Some(false) => DP_RC_NO_FRAME,
        None => DP_RC_ERROR_GENERIC,
    }
}
