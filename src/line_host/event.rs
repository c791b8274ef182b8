//! Events as C sees them.

use core::ffi::c_int;

use super::types::Link;
use crate::line_protocol::message::view;
use crate::line_protocol::{
    LineMessage, OLP_RC_MALFORMED, OLP_RC_NOT_FOUND, OLP_RC_OVERFLOW, OLP_RC_SUCCESS, OLP_RC_TOO_LONG,
};
use crate::memory::int;
use deltarobot_protocols::line::host::{Dropped, Event, Listed, Outcome};

/// Event: a device has signed in (`message`). `device` is its place in the table, -1 when it is not there; `error` is
/// `OLP_RC_SUCCESS`, or `OLP_RC_TOO_LONG` when the id is longer than `OLP_HOST_ID_MAX` (-1) or another text was cut
/// off, `OLP_RC_OVERFLOW` when the table is full, `OLP_RC_NOT_FOUND` when it has no id.
pub const OLP_HOST_WELCOME: c_int = 1;
/// Event: what is in force on the link was reported, or has changed: `link`.
pub const OLP_HOST_LINKSETUP: c_int = 2;
/// Event: the device has acknowledged the command `handle`. Once for each.
pub const OLP_HOST_ACKED: c_int = 3;
/// Event: the command `handle` has ended as `outcome` says. Exactly once for each.
pub const OLP_HOST_ENDED: c_int = 4;
/// Event: another line came from the device: `message`.
pub const OLP_HOST_LINE: c_int = 5;
/// Event: the numbers of the device's messages say that `lost` are missing before this line; or one is damaged.
pub const OLP_HOST_LOST: c_int = 6;
/// Event: the device reports an error: `message`, about the command `handle`, or 0 when that is not known.
pub const OLP_HOST_ERROR: c_int = 7;
/// Event: a line was lost: `error` is `OLP_RC_TOO_LONG` or `OLP_RC_MALFORMED`.
pub const OLP_HOST_DROPPED: c_int = 8;

/// Outcome: executed and answered: `message`; an `onerror` `toolong` when the answer is too long for the device.
pub const OLP_HOST_ANSWERED: c_int = 1;
/// Outcome: the device did not execute it, and says so: `message`, an `onerror`.
pub const OLP_HOST_REFUSED: c_int = 2;
/// Outcome: what was to come back did not. Whether it was executed is not known; acknowledged, it was received.
pub const OLP_HOST_TIMED_OUT: c_int = 3;
/// Outcome: the device has restarted. Whether the command was executed before that is not known.
pub const OLP_HOST_RESTARTED: c_int = 4;
/// Outcome: it was never sent, as checksums came into force after it was queued, with which it is too long.
pub const OLP_HOST_NOT_SENT: c_int = 5;

/// Something that happened.
#[derive(Debug)]
#[repr(C)]
pub struct LineHostEvent {
    /// What: one of `OLP_HOST_WELCOME` to `OLP_HOST_DROPPED`.
    pub kind: c_int,
    /// Of `OLP_HOST_ACKED`, `OLP_HOST_ENDED` and `OLP_HOST_ERROR`, the command's; 0 of others.
    pub handle: c_int,
    /// Of `OLP_HOST_ENDED`, one of `OLP_HOST_ANSWERED` to `OLP_HOST_NOT_SENT`; 0 of others.
    pub outcome: c_int,
    /// Of `OLP_HOST_WELCOME`, the place in the table; -1 of others.
    pub device: c_int,
    /// Of `OLP_HOST_WELCOME` and `OLP_HOST_DROPPED`, one of `OLP_RC_*`; 0 of others.
    pub error: c_int,
    /// Of `OLP_HOST_LOST`, the number of messages, 1 to 127; 0 of others.
    pub lost: c_int,
    /// What is in force on the link.
    pub link: Link,
    /// The line, where it lies in the session until its next call that is not of `const`; empty if there is none.
    pub message: LineMessage,
}

/// Writes what happened to an event that is all zero but for its device, which is -1.
pub(super) fn write_event(event: &mut LineHostEvent, happened: &Event<'_>) {
    let (kind, message) = match happened {
        Event::Welcome(listed, message) => {
            (event.device, event.error) = place_of(*listed);
            (OLP_HOST_WELCOME, Some(message))
        }
        Event::Linksetup(_) => (OLP_HOST_LINKSETUP, None),
        Event::Acked(handle) => {
            event.handle = (*handle).cast_signed().into();
            (OLP_HOST_ACKED, None)
        }
        Event::Ended(handle, outcome, message) => {
            event.handle = (*handle).cast_signed().into();
            event.outcome = outcome_of(*outcome);
            (OLP_HOST_ENDED, message.as_ref())
        }
        Event::Line(message) => (OLP_HOST_LINE, Some(message)),
        Event::Lost(count) => {
            event.lost = (*count).into();
            (OLP_HOST_LOST, None)
        }
        Event::Error(handle, message) => {
            event.handle = (*handle).cast_signed().into();
            (OLP_HOST_ERROR, Some(message))
        }
        Event::Dropped(why) => {
            event.error = match why {
                Dropped::TooLong => OLP_RC_TOO_LONG,
                Dropped::Malformed => OLP_RC_MALFORMED,
            };
            (OLP_HOST_DROPPED, None)
        }
    };
    event.kind = kind;
    if let Some(message) = message {
        event.message = view(message);
    }
}

/// The place of a device that has signed in, and what is wrong with that.
fn place_of(listed: Listed) -> (c_int, c_int) {
    match listed {
        Listed::Whole(index) => (int(index), OLP_RC_SUCCESS),
        Listed::Cut(index) => (int(index), OLP_RC_TOO_LONG),
        Listed::Full => (-1, OLP_RC_OVERFLOW),
        Listed::IdTooLong => (-1, OLP_RC_TOO_LONG),
        Listed::NoId => (-1, OLP_RC_NOT_FOUND),
    }
}

const fn outcome_of(outcome: Outcome) -> c_int {
    match outcome {
        Outcome::Answered => OLP_HOST_ANSWERED,
        Outcome::Refused => OLP_HOST_REFUSED,
        Outcome::TimedOut => OLP_HOST_TIMED_OUT,
        Outcome::Restarted => OLP_HOST_RESTARTED,
        Outcome::TooLong => OLP_HOST_NOT_SENT,
    }
}
