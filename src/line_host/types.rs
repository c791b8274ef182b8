//! The structs of `line_host.h` that are copied in and out, and what its events say.

use core::ffi::{c_char, c_int, c_uint, c_ulong};

use super::{OLP_HOST_ID_MAX, OLP_HOST_NAME_MAX, OLP_HOST_TYPE_MAX, OLP_HOST_VERSION_MAX};
use crate::line_protocol::message::view;
use crate::line_protocol::{
    LineMessage, OLP_RC_MALFORMED, OLP_RC_NOT_FOUND, OLP_RC_OVERFLOW, OLP_RC_SUCCESS, OLP_RC_TOO_LONG,
};
use crate::memory::int;
use deltarobot_protocols::line::host::{self, Dropped, Event, Listed, Outcome};
use zerocopy::{FromBytes, IntoBytes};

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
/// Event: the gap in the numbers of the device's messages says that `lost` are missing before this line. An estimate: a
/// damaged number makes a gap too.
pub const OLP_HOST_LOST: c_int = 6;
/// Event: the device reports an error: `message`, about the command `handle`, or 0 when that is not known.
pub const OLP_HOST_ERROR: c_int = 7;
/// Event: a line was lost: `error` is `OLP_RC_TOO_LONG` or `OLP_RC_MALFORMED`.
pub const OLP_HOST_DROPPED: c_int = 8;

/// Outcome: the device has executed the command, and answered: `message`, or an `onerror` with the code `toolong` when
/// its answer is too long for it.
pub const OLP_HOST_ANSWERED: c_int = 1;
/// Outcome: the device did not execute it, and says so: `message`, an `onerror`.
pub const OLP_HOST_REFUSED: c_int = 2;
/// Outcome: what was to come back did not. Whether the command was executed is not known; if it was acknowledged, the
/// device has it.
pub const OLP_HOST_TIMED_OUT: c_int = 3;
/// Outcome: the device has restarted. Whether the command was executed before that is not known.
pub const OLP_HOST_RESTARTED: c_int = 4;
/// Outcome: it was never sent, as checksums came into force after it was queued, with which it is too long.
pub const OLP_HOST_NOT_SENT: c_int = 5;

/// Something that happened.
#[derive(Debug)]
#[repr(C)]
pub struct HostEvent {
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
    pub link: HostLink,
    /// The line, where it lies in the session until its next call that is not of `const`; empty if there is none.
    pub message: LineMessage,
}

/// Writes what happened to an event that is all zero but for its device, which is -1.
pub(super) fn write_event(event: &mut HostEvent, happened: &Event<'_>) {
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
            event.outcome = (*outcome as u8).into();
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

// The codes of C are those of the core.
const _: () = {
    assert!(OLP_HOST_ANSWERED == Outcome::Answered as c_int && OLP_HOST_REFUSED == Outcome::Refused as c_int);
    assert!(OLP_HOST_TIMED_OUT == Outcome::TimedOut as c_int && OLP_HOST_RESTARTED == Outcome::Restarted as c_int);
    assert!(OLP_HOST_NOT_SENT == Outcome::TooLong as c_int);
};

/// Settings of a host session: 0 stands for the default everywhere. Times are in milliseconds, at most 2^31 - 1.
#[derive(Debug)]
#[repr(C)]
pub struct HostSettings {
    /// Least time to wait for an ack; 0: 500. Timeouts follow measured round trips, and double when nothing comes.
    pub timeout_ms: c_ulong,
    /// The same for an answer; 0: as long as for an ack.
    pub answer_ms: c_ulong,
    /// How long after a command was sent first it may still be retransmitted; 0: 4000. A device has to remember it for
    /// longer than that and a line's way (`olp_device`: 5000 by default). Timeouts double up to half of it.
    pub repeat_ms: c_ulong,
    /// How often a command may be retransmitted; 0: 3; below 0: never.
    pub repeats: c_int,
    /// Not 0: the device recognises repeated commands (`olp_device` does, no other board is known to): they are
    /// retransmitted without acks, after their ack, and as soon as the device reports damage.
    pub recognises: c_int,
    /// The line's speed in baud, for when a line has left and how long a reply takes; 0: it is not known.
    pub baud: c_ulong,
    /// Bytes that the device's receive buffer takes: no more are sent before it has read them. 0: 63, as an Arduino's;
    /// below 0: any number.
    pub receive_room: c_int,
}

/// What is in force on a link, as the host knows it. At first, 0 and a window of 1 (section "Link Setup command").
#[derive(Debug)]
#[repr(C)]
pub struct HostLink {
    /// 1: the device acknowledges commands; else 0.
    pub ack: c_int,
    /// 1: commands have a Fletcher-16 checksum; else 0.
    pub checksum: c_int,
    /// Number of commands that may be unanswered, 1 to 65535. No more than `OLP_WINDOW_MAX` ever are.
    pub windowsize: c_uint,
}

/// Counters of a host session since it began; they wrap at 2^32.
#[derive(Debug, FromBytes, IntoBytes)]
#[repr(C)]
pub struct HostHealth {
    /// Lines received that can be read.
    pub lines: c_ulong,
    /// Of these, acks, answers and refusals that nothing was waiting for.
    pub strays: c_ulong,
    /// Lines that can't be read.
    pub malformed: c_ulong,
    /// Lines that were too long.
    pub overlong: c_ulong,
    /// Messages that the device has sent, as the gaps in their numbers show, and that were not received.
    pub lost: c_ulong,
    /// Errors that the device has reported.
    pub errors: c_ulong,
    /// Times that the device restarted.
    pub restarts: c_ulong,
    /// Calls of `olp_host_receive` that did not take all bytes, because events were to be fetched first.
    pub overflows: c_ulong,
    /// Acks and answers that did not come in time.
    pub timeouts: c_ulong,
    /// Commands that were retransmitted, because of that or because the device has asked for it.
    pub repeats: c_ulong,
    /// Number of round trips measured, in milliseconds: from a command sent once to what came back first.
    pub rtt_count: c_ulong,
    /// The last round-trip time.
    pub rtt_last: c_ulong,
    /// The shortest round-trip time.
    pub rtt_min: c_ulong,
    /// The longest round-trip time.
    pub rtt_max: c_ulong,
    /// Sum of the round-trip times: divided by `rtt_count`, their average.
    pub rtt_sum: c_ulong,
}

// The compiler has copy_text() see to it that the core's texts are as long.
const ID_SIZE: usize = OLP_HOST_ID_MAX as usize + 1;
const TYPE_SIZE: usize = OLP_HOST_TYPE_MAX as usize + 1;
const NAME_SIZE: usize = OLP_HOST_NAME_MAX as usize + 1;
const VERSION_SIZE: usize = OLP_HOST_VERSION_MAX as usize + 1;

/// A device. Its texts are decoded and end with a 0; those it did not give are empty.
#[derive(Debug)]
#[repr(C)]
pub struct HostDevice {
    /// What it is called in messages.
    pub id: [c_char; ID_SIZE],
    /// What it is, e.g. `OzekiSwitchController`.
    pub r#type: [c_char; TYPE_SIZE],
    /// What its user calls it.
    pub name: [c_char; NAME_SIZE],
    /// Its version.
    pub version: [c_char; VERSION_SIZE],
    /// Its place among the devices behind the microcontroller; 0 when it did not give one.
    pub pos: c_int,
    /// Not 0: its type, name or version is longer than there is room, and was cut off.
    pub cut: c_int,
}

pub(super) fn link_of(link: host::Link) -> HostLink {
    HostLink { ack: link.acks().into(), checksum: link.checks().into(), windowsize: link.windowsize().into() }
}

/// Copies a text, which ends in C whatever the session's memory was overwritten with.
#[expect(clippy::cast_possible_wrap, reason = "the bytes of a char")]
#[allow(clippy::unnecessary_cast, reason = "where a char has no sign")]
pub(super) fn copy_text<const SIZE: usize>(text: &[u8; SIZE], out: &mut [c_char; SIZE]) {
    for (place, byte) in out.iter_mut().zip(text) {
        *place = *byte as c_char;
    }
    if let Some(last) = out.last_mut() {
        *last = 0;
    }
}
