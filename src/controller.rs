//! `controller.h`: the dispatcher of a controller's firmware.

use core::ffi::{c_int, c_void};
use core::mem::{align_of, offset_of, size_of};

use super::memory::{bytes_of, zero};
use super::payload::layout_of;
use super::protocol::{DP_RC_ERROR_GENERIC, DP_RC_NO_FRAME, DP_RC_OVERFLOW, DP_RC_SUCCESS};
use super::protocol::{Position, SendFunc, StatusReport};
use deltarobot_export::export;
use deltarobot_protocols::config::DP_DATA_MAX_SIZE;
use deltarobot_protocols::deltarobot::controller::Dispatcher;
use deltarobot_protocols::deltarobot::{Layout, PAYLOAD_MAX, Ring};

mod serving;

/// Homing and moving are refused while another operation is going on. Without this flag the new one takes the old one's
/// place, as in shipped firmware.
pub const DP_CONTROLLER_REFUSE_BUSY: c_int = 1;
/// The end of homing and of a move is told by `h` and `m` (specification), besides the status report.
pub const DP_CONTROLLER_TELL_END: c_int = 2;
/// An error during an operation is told by `e` (specification), besides the status report.
pub const DP_CONTROLLER_TELL_ERROR: c_int = 4;

/// Begins to home. Returns 0, or anything else to refuse. From its return until the end, the state that is read is
/// `DP_STATUS_HOMING`.
///
/// ```c
/// int start_homing(void *usr)
/// {
///     return motors_home();
/// }
/// ```
pub type HomeFunc = Option<unsafe extern "C" fn(usr: *mut c_void) -> c_int>;
/// Begins to move to target, which is free of NaNs. Returns 0, or anything else to refuse. From its return until the
/// end, the state that is read is `DP_STATUS_MOVING`. target is gone when the function returns.
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

/// The firmware's own functions. Each is given usr. What `home`, `move` or `cancel` would do is refused where they are
/// NULL; `read` and `send` are needed.
#[derive(Debug)]
#[repr(C)]
pub struct Calls {
    /// Begins to home.
    pub home: HomeFunc,
    /// Begins to move.
    pub r#move: MoveFunc,
    /// Begins to stop.
    pub cancel: CancelFunc,
    /// Tells the status.
    pub read: ReadFunc,
    /// Sends bytes, whole frames. Its result is ignored: the protocol leaves lost frames to the host.
    pub send: SendFunc,
}

/// A controller. Its fields are private.
#[derive(Debug)]
#[repr(C)]
pub struct Controller {
    dispatcher: Dispatcher,
    calls: *const Calls,
    usr: *mut c_void,
    layout: c_int,
    flags: c_int,
}

// The layout that C compilers give these structs; C tests assert the same numbers.
#[expect(clippy::arithmetic_side_effects, reason = "done by the compiler")]
const _: () = {
    const POINTER: usize = size_of::<*const ()>();
    const INT: usize = size_of::<c_int>();
    const CALLS: usize = size_of::<Dispatcher>().next_multiple_of(align_of::<*const ()>());
    assert!(size_of::<Calls>() == 5 * POINTER && align_of::<Calls>() == align_of::<*const ()>());
    assert!(offset_of!(Calls, home) == 0 && offset_of!(Calls, r#move) == POINTER);
    assert!(offset_of!(Calls, cancel) == 2 * POINTER && offset_of!(Calls, read) == 3 * POINTER);
    assert!(offset_of!(Calls, send) == 4 * POINTER);

    assert!(size_of::<Dispatcher>() == size_of::<Ring>() + (INT + 13).next_multiple_of(align_of::<c_int>()));
    assert!(offset_of!(Controller, dispatcher) == 0 && offset_of!(Controller, calls) == CALLS);
    assert!(offset_of!(Controller, usr) == CALLS + POINTER && offset_of!(Controller, layout) == CALLS + 2 * POINTER);
    assert!(offset_of!(Controller, flags) == CALLS + 2 * POINTER + INT);
};

/// Makes a controller of any memory.
///
/// layout says how status reports are laid out, `DP_LAYOUT_*` (`payload.h`); flags is a sum of `DP_CONTROLLER_*`. With
/// 0 for both, it answers like shipped firmware.
///
/// calls' functions can be called with usr; calls stays there as long as the controller is used.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when controller or calls is NULL, calls has no `read` or `send`,
/// the layout is none of these, or `DP_DATA_MAX_SIZE` is below the 16 bytes of a status report (13 for
/// `DP_LAYOUT_SPEC`).
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
    if controller.is_null() || !report_fits(layout) {
        return DP_RC_ERROR_GENERIC;
    }
    // SAFETY: as the contract of this function asks; zero is a controller that is not ready.
    unsafe {
        zero(controller);
        (*controller).dispatcher.refuse_busy(flags & DP_CONTROLLER_REFUSE_BUSY != 0);
        (*controller).calls = calls;
        (*controller).usr = usr;
        (*controller).layout = layout;
        (*controller).flags = flags;
        if is_ready(controller) { DP_RC_SUCCESS } else { DP_RC_ERROR_GENERIC }
    }
}

/// Takes received bytes.
///
/// When they don't fit, the oldest are lost: call `dp_controller_poll` often enough, or give it fewer at a time.
///
/// Not for an interrupt that may come during another call on the controller: there, bytes go into a queue of the
/// firmware's own.
///
/// Returns `DP_RC_SUCCESS`, `DP_RC_OVERFLOW` when bytes were lost, or `DP_RC_ERROR_GENERIC` when controller is NULL,
/// bytes is negative, or buf is NULL and bytes is not 0.
///
/// ```c
/// int got = uart_read(&uart, in, sizeof in);
/// if (dp_controller_receive(&controller, in, got) == DP_RC_OVERFLOW)
///     ++losses;
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_controller_receive(controller: *mut Controller, buf: *const c_void, bytes: c_int) -> c_int {
    if controller.is_null() {
        return DP_RC_ERROR_GENERIC;
    }
    // SAFETY: not NULL, so as the contract of this function asks.
    let (dispatcher, input) = unsafe { (&mut (*controller).dispatcher, bytes_of(buf, bytes)) };
    match input.map(|input| dispatcher.ring().append(input)) {
        Some(Ok(())) => DP_RC_SUCCESS,
        Some(Err(_)) => DP_RC_OVERFLOW,
        None => DP_RC_ERROR_GENERIC,
    }
}

/// Does one thing: reports the end of the operation, or answers one request. To be called in the firmware's main loop.
///
/// controller was made by `dp_controller_init` or is all zero.
///
/// Returns `DP_RC_SUCCESS` when something was done, `DP_RC_NO_FRAME` when there was nothing to do, or
/// `DP_RC_ERROR_GENERIC` when controller is NULL or was not made by `dp_controller_init`.
///
/// ```c
/// while (dp_controller_poll(&controller) == DP_RC_SUCCESS)
///     ;
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_controller_poll(controller: *mut Controller) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe { poll(controller, false) }
}

/// Like `dp_controller_poll` when the line has been quiet for longer than a frame takes: incomplete frames, which would
/// be waited for until enough bytes have come, are given up (see `dp_recv_idle`).
///
/// Returns what `dp_controller_poll` does.
///
/// ```c
/// if (now_ms() - heard_at >= 10)
///     dp_controller_poll_idle(&controller);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_controller_poll_idle(controller: *mut Controller) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe { poll(controller, true) }
}

/// Sends a status report unasked. Shipped firmware does so at each encoder step of a move.
///
/// Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` when controller is NULL or was not made by `dp_controller_init`.
///
/// ```c
/// if (motors_state() == DP_STATUS_MOVING && motors_made_a_step())
///     dp_controller_report(&controller);
/// ```
#[export(dp)]
pub unsafe extern "C" fn dp_controller_report(controller: *mut Controller) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe {
        if !is_ready(controller) {
            return DP_RC_ERROR_GENERIC;
        }
        serving::report(controller);
    }
    DP_RC_SUCCESS
}

/// Whether a controller was made, so that its functions can be called.
///
/// # Safety
///
/// As for [`dp_controller_poll`].
unsafe fn is_ready(controller: *const Controller) -> bool {
    // SAFETY: as the contract of this function asks.
    unsafe {
        !controller.is_null()
            && match (*controller).calls.as_ref() {
                Some(calls) => calls.read.is_some() && calls.send.is_some(),
                None => false,
            }
    }
}

/// # Safety
///
/// As for [`dp_controller_poll`].
unsafe fn poll(controller: *mut Controller, idle: bool) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe {
        if !is_ready(controller) {
            return DP_RC_ERROR_GENERIC;
        }
        if serving::act(controller, idle) { DP_RC_SUCCESS } else { DP_RC_NO_FRAME }
    }
}

/// Whether status reports of a layout, if it is one, fit a frame.
const fn report_fits(layout: c_int) -> bool {
    match layout_of(layout) {
        Some(Layout::Spec) => DP_DATA_MAX_SIZE >= 13,
        Some(_) => DP_DATA_MAX_SIZE >= PAYLOAD_MAX,
        None => false,
    }
}
