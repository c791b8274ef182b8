//! The firmware's own functions, called where the dispatcher asks for them.
//!
//! Everywhere here, the controller is not NULL, and no reference to it lives while one of these functions runs: they may
//! call the library on it. It is ready at first; one of them may try to make it anew, without functions.

use core::mem::MaybeUninit;

use super::{Controller, DP_CONTROLLER_TELL_END, DP_CONTROLLER_TELL_ERROR};
use crate::memory::int;
use crate::payload::{layout_of, position_to, report_from};
use crate::protocol::StatusReport;
use deltarobot_protocols::deltarobot::controller::{Judgement, Order};
use deltarobot_protocols::deltarobot::{FRAME_MAX, Message, Position, Report};

/// Does one thing: reports the end of the operation, or answers one request. Tells whether there was something to do.
///
/// # Safety
///
/// See above, and as for [`dp_controller_poll`](super::dp_controller_poll).
pub(super) unsafe fn act(controller: *mut Controller, idle: bool) -> bool {
    // SAFETY: as the contract of this function asks.
    unsafe {
        if (*controller).dispatcher.is_active() {
            let now = status(controller);
            if let Some(end) = (*controller).dispatcher.ended(&now) {
                tell_end(controller, end);
                return true;
            }
        }
        match (*controller).dispatcher.order(idle) {
            Some(order) => serve(controller, &order),
            None => return false,
        }
    }
    true
}

/// Answers a request.
///
/// # Safety
///
/// As for [`act`].
unsafe fn serve(controller: *mut Controller, order: &Order) {
    // SAFETY: as the contract of this function asks.
    unsafe {
        let now = status(controller);
        let judgement = (*controller).dispatcher.judge(order, &now);
        let accepted = carry_out(controller, &judgement);
        if accepted {
            (*controller).dispatcher.began(&judgement);
        }
        if judgement != Judgement::Report {
            let answer = if accepted { Message::Ack(order.opcode) } else { Message::Nack(order.opcode) };
            send(controller, &answer);
        }
        if judgement != Judgement::RefuseOnly {
            let now = report(controller);
            (*controller).dispatcher.reports(&now);
        }
    }
}

/// Has the firmware do what was judged; tells whether it does.
///
/// # Safety
///
/// As for [`act`].
unsafe fn carry_out(controller: *mut Controller, judgement: &Judgement) -> bool {
    // SAFETY: as the contract of this function asks, and as calls' own: its functions take usr.
    unsafe {
        let (Some(calls), usr) = ((*controller).calls.as_ref(), (*controller).usr) else { return false };
        match judgement {
            Judgement::Home => calls.home.is_some_and(|home| home(usr) == 0),
            Judgement::Cancel => calls.cancel.is_some_and(|cancel| cancel(usr) == 0),
            Judgement::Move(target) => calls.r#move.is_some_and(|start| {
                let mut position = MaybeUninit::uninit();
                position_to(position.as_mut_ptr(), *target);
                start(position.as_ptr(), usr) == 0
            }),
            Judgement::Repeated => true,
            Judgement::Report | Judgement::Refuse | Judgement::RefuseOnly => false,
        }
    }
}

/// # Safety
///
/// As for [`act`].
unsafe fn tell_end(controller: *mut Controller, end: Option<Message>) {
    // SAFETY: as the contract of this function asks.
    unsafe {
        let flag = match end {
            Some(Message::GeneralError) => DP_CONTROLLER_TELL_ERROR,
            _ => DP_CONTROLLER_TELL_END,
        };
        if let Some(end) = end.filter(|_| (*controller).flags & flag != 0) {
            send(controller, &end);
        }
        report(controller);
    }
}

/// Asks the firmware for the status.
///
/// # Safety
///
/// As for [`act`].
unsafe fn status(controller: *mut Controller) -> Report {
    let mut report = StatusReport { DA: 0.0, DB: 0.0, DC: 0.0, STAT: 0 };
    // SAFETY: as the contract of this function asks; the report is ours.
    unsafe {
        if let Some(read) = (*controller).calls.as_ref().and_then(|calls| calls.read) {
            read(&raw mut report, (*controller).usr);
        }
        report_from(&raw const report).unwrap_or(Report::new(Position::UNKNOWN, 0))
    }
}

/// Sends the status, and returns it.
///
/// # Safety
///
/// As for [`act`].
#[inline(never)] // That is smaller.
pub(super) unsafe fn report(controller: *mut Controller) -> Report {
    // SAFETY: as the contract of this function asks.
    unsafe {
        let report = status(controller);
        send(controller, &Message::StatusReport(report));
        report
    }
}

/// # Safety
///
/// As for [`act`].
unsafe fn send(controller: *mut Controller, message: &Message) {
    let mut frame = [MaybeUninit::<u8>::uninit(); FRAME_MAX];
    // SAFETY: as the contract of this function asks.
    let (calls, usr, layout) = unsafe { ((*controller).calls.as_ref(), (*controller).usr, (*controller).layout) };
    let encoded = message.encode(layout_of(layout).unwrap_or_default(), &mut frame);
    if let (Some(length), Some(send)) = (encoded, calls.and_then(|calls| calls.send)) {
        // SAFETY: as calls asks: its functions take usr; encode() wrote that many bytes of the frame.
        unsafe { send(frame.as_mut_ptr().cast(), int(length), usr) };
    }
}
