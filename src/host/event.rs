//! What `dp_host_poll` fetches.

use core::ffi::{c_int, c_uchar};

use crate::memory::int;
use crate::payload::report_to;
use crate::protocol::{DP_STATUS_ERROR, DP_STATUS_HOMING, DP_STATUS_IDLE, DP_STATUS_MOVING, ProtocolMsg, StatusReport};
use deltarobot_protocols::deltarobot::host::{Event, Outcome};
use deltarobot_protocols::deltarobot::{Opcode, Report, State};

/// Event: a message was received; `msg` holds it. Only where the settings ask for these events.
pub const DP_HOST_MESSAGE: c_int = 1;
/// Event: a status report was received; `report` holds it, `state` its state.
pub const DP_HOST_STATUS: c_int = 2;
/// Event: the platform is in another state than before: `state`; `report` is the status report that says so.
pub const DP_HOST_STATE: c_int = 3;
/// Event: a general error was received.
pub const DP_HOST_ERROR: c_int = 4;
/// Event: the controller has accepted the operation `opcode`.
pub const DP_HOST_ACCEPTED: c_int = 5;
/// Event: the request `opcode` has ended as `outcome` says. Comes exactly once for each request.
pub const DP_HOST_ENDED: c_int = 6;

/// Outcome: the request was carried out.
pub const DP_HOST_FINISHED: c_int = 1;
/// Outcome: the controller did not accept the request.
pub const DP_HOST_REFUSED: c_int = 2;
/// Outcome: the controller accepted the operation, and could not carry it out.
pub const DP_HOST_FAILED: c_int = 3;
/// Outcome: the operation was cancelled: before it was ever sent, or the platform stands now.
pub const DP_HOST_CANCELLED: c_int = 4;
/// Outcome: too many answers stayed away, or the operation lasted too long. What the platform does is not known.
pub const DP_HOST_TIMED_OUT: c_int = 5;

/// Something that happened.
#[derive(Debug)]
#[repr(C)]
pub struct HostEvent {
    /// What: one of `DP_HOST_MESSAGE` to `DP_HOST_ENDED`.
    pub kind: c_int,
    /// Of `DP_HOST_ACCEPTED` and `DP_HOST_ENDED`, the request: `DP_OPCODE_HOMING`, `MOVE`, `CANCEL` or `STATUS`.
    pub opcode: c_uchar,
    /// Of `DP_HOST_ENDED`, one of `DP_HOST_FINISHED` to `DP_HOST_TIMED_OUT`; 0 of others.
    pub outcome: c_int,
    /// Of `DP_HOST_STATUS` and `DP_HOST_STATE`, one of `DP_STATUS_*`; -1 of others.
    pub state: c_int,
    /// Of `DP_HOST_STATUS` and `DP_HOST_STATE`, the report. Other events leave it alone.
    pub report: StatusReport,
    /// Of `DP_HOST_MESSAGE`, the message. Other events may have changed it.
    pub msg: ProtocolMsg,
}

// The codes of C are those of the core.
const _: () = {
    assert!(DP_HOST_FINISHED == Outcome::Finished as c_int && DP_HOST_REFUSED == Outcome::Refused as c_int);
    assert!(DP_HOST_FAILED == Outcome::Failed as c_int && DP_HOST_CANCELLED == Outcome::Cancelled as c_int);
    assert!(DP_HOST_TIMED_OUT == Outcome::TimedOut as c_int);
    assert!(DP_STATUS_IDLE == State::Idle as c_int && DP_STATUS_HOMING == State::Homing as c_int);
    assert!(DP_STATUS_MOVING == State::Moving as c_int && DP_STATUS_ERROR == State::Error as c_int);
};

/// Hands an event to C, or that there is none. The payload of a message is there already; the report is the last one.
///
/// # Safety
///
/// out points to a writable event, whose contents may be uninitialised.
pub(super) unsafe fn event_to(out: *mut HostEvent, event: Option<Event>, report: Option<&Report>) {
    let (mut opcode, mut outcome) = (Opcode(0), 0);
    let kind = match event {
        None => 0,
        Some(Event::Message(received, length)) => {
            // SAFETY: writable by the contract.
            unsafe {
                (*out).msg.opcode = received.0;
                (*out).msg.data_s = int(length);
                (*out).msg.checksum_ok = 1;
            }
            DP_HOST_MESSAGE
        }
        Some(Event::Status) => DP_HOST_STATUS,
        Some(Event::State) => DP_HOST_STATE,
        Some(Event::GeneralError) => DP_HOST_ERROR,
        Some(Event::Accepted(accepted)) => {
            opcode = accepted;
            DP_HOST_ACCEPTED
        }
        Some(Event::Ended(ended, how)) => {
            (opcode, outcome) = (ended, how as c_int);
            DP_HOST_ENDED
        }
    };
    let report = report.filter(|_| matches!(kind, DP_HOST_STATUS | DP_HOST_STATE));
    // SAFETY: writable by the contract.
    unsafe {
        (*out).kind = kind;
        (*out).opcode = opcode.0;
        (*out).outcome = outcome;
        (*out).state = report.map_or(-1, |report| report.state() as c_int);
        if let Some(report) = report {
            report_to(&raw mut (*out).report, report);
        }
    }
}
