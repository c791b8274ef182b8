//! What `gx_host_poll` fetches.

use core::ffi::c_int;

use crate::gx::Vector;
use crate::memory::int;
use deltarobot_protocols::gx::host::{Event, Outcome};

/// Event: the oldest move has ended as outcome says: once for each move, in the order of the requests.
pub const GX_HOST_ENDED: c_int = 1;
/// Event: a position report: position.
pub const GX_HOST_REPORT: c_int = 2;
/// Event: an error notice: code, number. What is to be done about it, the session does.
pub const GX_HOST_ERROR: c_int = 3;
/// Event: a session has begun.
pub const GX_HOST_BEGUN: c_int = 4;
/// Event: a position report that does not fit what was requested: position. The next move corrects that.
pub const GX_HOST_DRIFT: c_int = 5;
/// Event: the status: number more moves fit into the motion side's queue, and it holds if code is not 0.
pub const GX_HOST_STATUS: c_int = 6;
/// Event: the machine was stopped at position, with the velocity in force, and has forgotten all moves.
pub const GX_HOST_STOPPED: c_int = 7;
/// Event: what `gx_host_control` asked for got no answer, or is not known there: code, `GX_CONTROL_*`.
pub const GX_HOST_UNANSWERED: c_int = 8;

/// Outcome: the move was carried out.
pub const GX_HOST_FINISHED: c_int = 1;
/// Outcome: the motion side did not accept the move. It was not carried out.
pub const GX_HOST_REFUSED: c_int = 2;
/// Outcome: the motion side accepted the move, and has stopped before it was carried out to its end.
pub const GX_HOST_FAILED: c_int = 3;
/// Outcome: it was not begun: one before it was refused or has failed, or the session ended before it was sent.
pub const GX_HOST_DROPPED: c_int = 4;
/// Outcome: no answer for too long, or the move lasted too long. Whether it was carried out is not known.
pub const GX_HOST_TIMED_OUT: c_int = 5;
/// Outcome: the motion side was restarted or has left the session. Whether the move was carried out is not known.
pub const GX_HOST_LOST: c_int = 6;
/// Outcome: a damaged command was carried out, says the check. The next names all axes, which corrects that.
pub const GX_HOST_DEVIATED: c_int = 7;

const _: () = {
    assert!(GX_HOST_FINISHED == Outcome::Finished as c_int && GX_HOST_REFUSED == Outcome::Refused as c_int);
    assert!(GX_HOST_FAILED == Outcome::Failed as c_int && GX_HOST_DROPPED == Outcome::Dropped as c_int);
    assert!(GX_HOST_TIMED_OUT == Outcome::TimedOut as c_int && GX_HOST_LOST == Outcome::Lost as c_int);
    assert!(GX_HOST_DEVIATED == Outcome::Deviated as c_int);
};

/// Something that happened.
#[derive(Debug)]
#[repr(C)]
pub struct HostEvent {
    /// What: one of `GX_HOST_ENDED` to `GX_HOST_UNANSWERED`.
    pub kind: c_int,
    /// Of `GX_HOST_ENDED`, one of `GX_HOST_FINISHED` to `GX_HOST_DEVIATED`; 0 of others.
    pub outcome: c_int,
    /// Of an error notice, and of `GX_HOST_ENDED` if one is the reason: `GX_FAULT_*`; see `GX_HOST_*`; else 0.
    pub code: c_int,
    /// Of `GX_HOST_ERROR`, the number that the notice names; of `GX_HOST_STATUS`, see there; else -1.
    pub number: c_int,
    /// Of `GX_HOST_REPORT`, `GX_HOST_DRIFT` and `GX_HOST_STOPPED`; other events leave it alone.
    pub position: Vector,
}

/// Makes an event C's.
pub(super) fn write_event(to: &mut HostEvent, happened: Option<&Event<'_>>) {
    let (mut outcome, mut code, mut number) = (0, 0, None);
    let kind = match happened {
        None => 0,
        Some(Event::Ended(how, why)) => {
            (outcome, code) = (*how as c_int, *why);
            GX_HOST_ENDED
        }
        Some(event @ (Event::Report(position) | Event::Drift(position) | Event::Stopped(position))) => {
            to.position.core_mut().copy(position);
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
    to.kind = kind;
    to.outcome = outcome;
    to.code = code.into();
    to.number = number.map_or(-1, |number| int(number.into()));
}
