//! The structs of `line_host.h` that are copied in and out.

use core::ffi::{c_char, c_int, c_uint, c_ulong};

use super::{OLP_HOST_ID_MAX, OLP_HOST_NAME_MAX, OLP_HOST_TYPE_MAX, OLP_HOST_VERSION_MAX};
use deltarobot_protocols::line::host;
use zerocopy::{FromBytes, IntoBytes};

/// Settings of a host session: 0 stands for the default everywhere. Times are in milliseconds, at most 2^31 - 1.
#[derive(Debug)]
#[repr(C)]
pub struct Settings {
    /// Least time to wait for an ack; 0: 500. Timeouts follow measured round trips, and double when nothing comes.
    pub timeout_ms: c_ulong,
    /// The same for an answer; 0: as long as for an ack.
    pub answer_ms: c_ulong,
    /// How long after a command was sent first it may still be retransmitted; 0: 4000. A device has to remember it for
    /// longer than that and a line's way (`olp_device`: 5000 by default). Timeouts double up to half of it.
    pub repeat_ms: c_ulong,
    /// How often a command may be retransmitted; 0: 3; below 0: never.
    pub repeats: c_int,
    /// Not 0: the device recognises repeated commands (`olp_device` does, no other board is known to), so that they are
    /// retransmitted without acks, after their ack, and as soon as the device reports damage.
    pub recognises: c_int,
    /// The line's speed in baud, for when a line has left and how long a reply takes; 0: it is not known.
    pub baud: c_ulong,
    /// Bytes that the device's receive buffer takes, of which no more are sent; 0: 63, an Arduino's; below 0: any.
    pub receive_room: c_int,
}

/// What is in force on a link, as the host knows it. At first, 0 and a window of 1 (section "Link Setup command").
#[derive(Debug)]
#[repr(C)]
pub struct Link {
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
pub struct Health {
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
pub struct Device {
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

pub(super) fn link_of(link: host::Link) -> Link {
    Link { ack: link.acks().into(), checksum: link.checks().into(), windowsize: link.windowsize().into() }
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
