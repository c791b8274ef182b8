//! What `gx_host_poll` fetches.

use core::ffi::c_int;

use super::{
    GX_HOST_BEGUN, GX_HOST_DEVIATED, GX_HOST_DRIFT, GX_HOST_DROPPED, GX_HOST_ENDED, GX_HOST_ERROR, GX_HOST_FAILED,
    GX_HOST_FINISHED, GX_HOST_LOST, GX_HOST_REFUSED, GX_HOST_REPORT, GX_HOST_STATUS, GX_HOST_STOPPED,
    GX_HOST_TIMED_OUT, GX_HOST_UNANSWERED, HostEvent,
};
use crate::memory::int;
use deltarobot_protocols::gx::host::{Event, Outcome};

/// # Safety
///
/// to points to writable memory of its type.
pub(super) unsafe fn write_event(to: *mut HostEvent, happened: Option<&Event<'_>>) {
    let (mut outcome, mut code, mut number) = (0, 0, None);
    let kind = match happened {
        None => 0,
        Some(Event::Ended(how, why)) => {
            (outcome, code) = (*how as c_int, *why);
            GX_HOST_ENDED
        }
        Some(event @ (Event::Report(position) | Event::Drift(position) | Event::Stopped(position))) => {
            // SAFETY: the same contract.
            unsafe { (*to).position.set(position) };
            match event {
                Event::Report(_) => GX_HOST_REPORT,
                Event::Drift(_) => GX_HOST_DRIFT,
                _ => GX_HOST_STOPPED,
            }
        }
        Some(Event::Error(why, of)) => {
            (code, number) = (*why, *of);
            GX_HOST_ERROR
        }
        Some(Event::Begun) => GX_HOST_BEGUN,
        Some(Event::Status(status)) => {
            (code, number) = (status.is_held.into(), Some(status.free.into()));
            GX_HOST_STATUS
        }
        Some(Event::Unanswered(control)) => {
            code = *control as u8;
            GX_HOST_UNANSWERED
        }
    };
    // SAFETY: the same contract.
    unsafe {
        (*to).kind = kind;
        (*to).outcome = outcome;
        (*to).code = code.into();
        (*to).number = number.map_or(-1, |number| int(number.into()));
    }
}

const _: () = {
    assert!(GX_HOST_FINISHED == Outcome::Finished as c_int && GX_HOST_REFUSED == Outcome::Refused as c_int);
    assert!(GX_HOST_FAILED == Outcome::Failed as c_int && GX_HOST_DROPPED == Outcome::Dropped as c_int);
    assert!(GX_HOST_TIMED_OUT == Outcome::TimedOut as c_int && GX_HOST_LOST == Outcome::Lost as c_int);
    assert!(GX_HOST_DEVIATED == Outcome::Deviated as c_int);
};
