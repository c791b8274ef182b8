//! `libdeltarobot/line_host.h`: the PC's end of the Ozeki line protocol's link: sends commands, retransmits them,
//! reports how they ended and what the devices say.
//!
//! A session does no I/O. A loop around it:
//!
//! ```c
//! struct olp_host_event event;
//! char in[64], out[OLP_COMMAND_MAX];
//! int got = 0, taken = 0, length;
//!
//! olp_host_init(&host, NULL);
//! for (;;) {
//!     while (olp_host_poll(&host, now_ms(), &event) == OLP_RC_SUCCESS)
//!         handle_event(&event);
//!     while ((length = olp_host_output(&host, out, sizeof out, now_ms())) > 0)
//!         uart_write(&uart, out, length);
//!     if (is_over())
//!         break;
//!     if (taken == got) {
//!         wait_readable(&uart, olp_host_next_deadline(&host, now_ms()));
//!         taken = 0;
//!         got = uart_read(&uart, in, sizeof in);
//!     }
//!     taken += olp_host_receive(&host, in + taken, got - taken, now_ms());
//! }
//! ```
//!
//! handle_event() calls olp_host_setup at the first OLP_HOST_WELCOME, and olp_host_send when that setup has ended as
//! OLP_HOST_ANSWERED.
//!
//! What holds for the outcome of a command, if the device recognises repeats and the settings say so:
//!
//! - acks and checksums on: ANSWERED means executed once, REFUSED not at all, all else once or not at all
//! - acks on, checksums off: the same, if no line to the device is damaged, as it executes what arrives
//! - acks off: the same, if no line is damaged and none takes longer than a timeout there and back
//! - checksums on: in any case once or not at all
//!
//! A board that does not recognise repeats, which is what is assumed, executes a command twice when its ack is lost; so
//! may a device that restarts in between. A damaged line has the right checksum once in some 65000. Answers have none:
//! one that is damaged in several places may be believed. Without acks, commands are retransmitted only when the device
//! asks for it, or the settings say that it recognises repeats, and no two of one name and id are out at a time. They
//! are executed in the order of sending while the window is 1; in a larger one, retransmitted ones fall behind.

use core::ffi::{c_char, c_int, c_long, c_ulong, c_void};

use super::line_protocol::{
    OLP_RC_BUSY, OLP_RC_ERROR_GENERIC, OLP_RC_MALFORMED, OLP_RC_NO_EVENT, OLP_RC_NOT_FOUND, OLP_RC_SUCCESS,
    OLP_RC_TOO_LONG,
};
use super::memory::{bytes_of, copy_counters, duration, fill, int, long, short, text_of, time, zero};
use crate::sizes::{OLP_DEVICES_MAX, OLP_LINE_MAX, OLP_WINDOW_MAX};
use crate::state::{Room, state};
use deltarobot_export::export;
use deltarobot_protocols::line::host::{self, QueueError};
use zerocopy::{transmute_mut, transmute_ref};

pub mod types;

pub use types::{HostDevice, HostEvent, HostHealth, HostLink, HostSettings};
use types::{copy_text, link_of, write_event};

/// Longest id that a device in the table may have.
pub const OLP_HOST_ID_MAX: c_int = 15;
/// Longest type of a device that is kept whole.
pub const OLP_HOST_TYPE_MAX: c_int = 47;
/// Longest name of a device that is kept whole.
pub const OLP_HOST_NAME_MAX: c_int = 31;
/// Longest version of a device that is kept whole.
pub const OLP_HOST_VERSION_MAX: c_int = 15;

/// `unsigned long`s of a session, with some room to spare.
pub const OLP_HOST_WORDS: usize = OLP_LINE_MAX / 4 + 27 * OLP_WINDOW_MAX + 31 * OLP_DEVICES_MAX + 180;

/// A host session. All zero is a new one with default settings.
#[derive(Debug)]
#[repr(C)]
pub struct Host {
    opaque: [c_ulong; OLP_HOST_WORDS],
}
// One command more than the caller's.
state!(Host: host::Host<{ OLP_LINE_MAX + 1 }, { OLP_WINDOW_MAX + 1 }, OLP_DEVICES_MAX>);

/// Begins a session; settings are copied, NULL stands for the defaults. All zero is a session with these, too. Returns
/// `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` when host is NULL.
///
/// ```c
/// struct olp_host_settings settings = {0};
/// settings.recognises = 1;
/// olp_host_init(&host, &settings);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_host_init(host: *mut Host, settings: *const HostSettings) -> c_int {
    // SAFETY: Room's contract; the objects of one call don't overlap.
    let (Some(host), settings) = (unsafe { (Host::init(host), settings.as_ref()) }) else {
        return OLP_RC_ERROR_GENERIC;
    };
    if let Some(settings) = settings {
        let HostSettings { timeout_ms, answer_ms, repeat_ms, repeats, recognises, baud, receive_room } = *settings;
        host.set(host::Settings {
            timeout_ms: duration(timeout_ms),
            answer_ms: duration(answer_ms),
            repeat_ms: duration(repeat_ms),
            repeats: short(repeats),
            recognises: (recognises != 0).into(),
            baud: duration(baud),
            receive_room: short(receive_room),
        });
    }
    OLP_RC_SUCCESS
}

/// Queues a `linksetup`, which says what shall be in force on the link (section "Link Setup command"). Any device takes
/// it; the page names the one of type `OzekiIDManager`. Returns what `olp_host_send` does.
///
/// ack and checksum are 0 (off), 1 (on), or below 0 to leave the parameter out, as windowsize, of 0 to 65535. What is
/// left out stays as it is. All three together make a line that is too long: call this twice, for ack and checksum
/// first. What is in force comes as the event `OLP_HOST_LINKSETUP`, and may be less than was asked for. A window that
/// the answer does not report is 1; of one that it does, no more is used than was asked for last and `OLP_WINDOW_MAX`.
///
/// It travels alone: it is sent when all commands before it have ended, and those behind it when it has. It should be a
/// session's first command: a device that remembers an earlier session's, to recognise repeats, forgets them.
///
/// ```c
/// struct olp_host_device device;
/// if (olp_host_get_device(&host, 0, &device) == OLP_RC_SUCCESS)
///     olp_host_setup(&host, device.id, 1, 1, -1);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_host_setup(
    host: *mut Host,
    id: *const c_char,
    ack: c_int,
    checksum: c_int,
    windowsize: c_long,
) -> c_int {
    let window = u16::try_from(windowsize).ok();
    // SAFETY: host is NULL or a session, id NULL or a string.
    let (Some(host), Some(id), true) =
        (unsafe { Host::get(host) }, unsafe { text_of(id) }, window.is_some() || windowsize < 0)
    else {
        return -OLP_RC_ERROR_GENERIC;
    };
    let given = |value: c_int| (value >= 0).then_some(value > 0);
    handle(host.setup(id, given(ack), given(checksum), window))
}

/// Queues a command for the device id, a string that is encoded as needed. `OLP_WINDOW_MAX` are kept, sent or not.
///
/// command is the beginning of its line, e.g. "c=setswitch&state=1", as `olp_begin_command` and `olp_add_*` build it:
/// length bytes (before `olp_finish`, those are `encoder.length`) of printable ASCII, without parameters named `s`, `t`
/// or `id`: the session adds these. They have to fit into the `OLP_COMMAND_MAX` bytes of a line, line feed included,
/// with a `t` of two digits (a longer line is never given a number of three). With an id of 6 characters, command may
/// have 48 bytes, 41 where checksums are in force.
///
/// Returns the command's handle, 1 to 32767, which `OLP_HOST_ACKED` and `OLP_HOST_ENDED` will carry; or -`OLP_RC_BUSY`
/// when as many are kept (fetch events), -`OLP_RC_TOO_LONG`, -`OLP_RC_MALFORMED` when it is no such line or id is
/// empty, or -`OLP_RC_ERROR_GENERIC` when a pointer is NULL or length is negative. Nothing is queued then.
///
/// ```c
/// int handle = olp_host_send(&host, "c=setswitch&state=1", 19, "9o5qzg");
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_host_send(
    host: *mut Host,
    command: *const c_char,
    length: c_int,
    id: *const c_char,
) -> c_int {
    // SAFETY: host is NULL or a session, command NULL or of that length, id NULL or a string.
    match unsafe { (Host::get(host), bytes_of(command.cast(), length), text_of(id)) } {
        (Some(host), Some(command), Some(id)) => handle(host.send(command, id)),
        _ => -OLP_RC_ERROR_GENERIC,
    }
}

/// Takes received bytes, up to the end of a line; `now_ms` is when they came. Behind that end, none are taken until
/// `olp_host_poll` has said that there are no more events of the line: fetch these, and give it the rest.
///
/// Returns how many bytes were taken, or -`OLP_RC_ERROR_GENERIC` when host is NULL, bytes is negative, or buf is NULL
/// and bytes is not 0.
///
/// ```c
/// for (int taken = 0; taken < length; handle_events(&host))
///     taken += olp_host_receive(&host, in + taken, length - taken, now_ms());
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_host_receive(host: *mut Host, buf: *const c_void, bytes: c_int, now_ms: c_ulong) -> c_int {
    // SAFETY: host is NULL or a session; bytes is buf's size.
    match unsafe { (Host::get(host), bytes_of(buf, bytes)) } {
        (Some(host), Some(input)) => int(host.receive(input, time(now_ms))),
        _ => -OLP_RC_ERROR_GENERIC,
    }
}

/// Fetches the next event. To be called after receiving, and at the latest when `olp_host_next_deadline` says, until
/// there is none; `olp_host_output` comes after that. The events of a line come in this order: lost, dropped, error,
/// linksetup, acked, ended, welcome, line.
///
/// Returns `OLP_RC_SUCCESS` and the event, `OLP_RC_NO_EVENT` when there is none (`kind` is 0 then), or
/// `OLP_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// struct olp_host_event event;
/// while (olp_host_poll(&host, now_ms(), &event) == OLP_RC_SUCCESS)
///     handle_event(&event);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_host_poll(host: *mut Host, now_ms: c_ulong, event: *mut HostEvent) -> c_int {
    // SAFETY: Room's contract; the objects of one call don't overlap.
    let (Some(host), Some(event)) = (unsafe { (Host::get(host), event.as_mut()) }) else {
        return OLP_RC_ERROR_GENERIC;
    };
    // SAFETY: an event may be all zero.
    unsafe { zero(event) };
    event.device = -1;
    let mut code = OLP_RC_NO_EVENT;
    if let Some(happened) = host.poll(time(now_ms)) {
        write_event(event, &happened);
        code = OLP_RC_SUCCESS;
    }
    event.link = link_of(host.link());
    code
}

/// Fetches the bytes to send: whole lines; `now_ms` is when they leave. To be called after `olp_host_poll`, with room
/// for at least `OLP_COMMAND_MAX` bytes; with more, it writes as many lines as there are and fit.
///
/// Returns how many bytes were written, 0 when there is nothing to send or no room for the next line, or
/// -`OLP_RC_ERROR_GENERIC` when host is NULL, cap is negative, or buf is NULL and cap is not 0.
///
/// ```c
/// if ((length = olp_host_output(&host, out, sizeof out, now_ms())) > 0)
///     uart_write(&uart, out, length);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_host_output(host: *mut Host, buf: *mut c_void, cap: c_int, now_ms: c_ulong) -> c_int {
    // SAFETY: host is NULL or a session; cap is buf's size.
    let written =
        unsafe { Host::get(host).and_then(|host| fill(buf, cap, |line, room| host.output(line, room, time(now_ms)))) };
    written.unwrap_or(-OLP_RC_ERROR_GENERIC)
}

/// Returns for how many milliseconds `olp_host_poll` and `olp_host_output` have nothing to do if nothing is received or
/// queued, as poll(2) takes it; -1 when they need not be called at all or host is NULL. Ask when there are no events
/// left and the output was fetched.
///
/// ```c
/// wait_readable(&uart, olp_host_next_deadline(&host, now_ms()));
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_host_next_deadline(host: *const Host, now_ms: c_ulong) -> c_long {
    // SAFETY: host is NULL or a session.
    let left = unsafe { Host::peek(host) }.and_then(|host| host.next_deadline(time(now_ms)));
    left.map_or(-1, long)
}

/// Copies what is in force on the link, as far as is known: at first, and after the device has restarted, neither acks
/// nor checksums, and a window of 1. Returns `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// struct olp_host_link link;
/// if (olp_host_get_link(&host, &link) == OLP_RC_SUCCESS && link.checksum)
///     puts("lines have checksums");
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_host_get_link(host: *const Host, link: *mut HostLink) -> c_int {
    // SAFETY: Room's contract; the objects of one call don't overlap.
    let (Some(host), Some(link)) = (unsafe { (Host::peek(host), link.as_mut()) }) else {
        return OLP_RC_ERROR_GENERIC;
    };
    *link = link_of(host.link());
    OLP_RC_SUCCESS
}

/// Copies what is known of a device that has signed in; index is its place in the table, from 0 up, which it keeps.
/// Returns `OLP_RC_SUCCESS`, `OLP_RC_NOT_FOUND`, device being left alone, or `OLP_RC_ERROR_GENERIC` when a pointer is
/// NULL.
///
/// ```c
/// struct olp_host_device device;
/// for (int i = 0; olp_host_get_device(&host, i, &device) == OLP_RC_SUCCESS; ++i)
///     printf("%s: %s\n", device.id, device.type);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_host_get_device(host: *const Host, index: c_int, device: *mut HostDevice) -> c_int {
    // SAFETY: Room's contract; the objects of one call don't overlap.
    let (Some(host), Some(device)) = (unsafe { (Host::peek(host), device.as_mut()) }) else {
        return OLP_RC_ERROR_GENERIC;
    };
    let Some(found) = usize::try_from(index).ok().and_then(|index| host.devices().get(index)) else {
        return OLP_RC_NOT_FOUND;
    };
    copy_text(&found.id, &mut device.id);
    copy_text(&found.r#type, &mut device.r#type);
    copy_text(&found.name, &mut device.name);
    copy_text(&found.version, &mut device.version);
    device.pos = c_int::try_from(found.pos).unwrap_or_default();
    device.cut = found.cut.into();
    OLP_RC_SUCCESS
}

/// Copies how the link does. Returns `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// struct olp_host_health health;
/// if (olp_host_get_health(&host, &health) == OLP_RC_SUCCESS && health.rtt_count > 0)
///     printf("round trip: %lu ms on average\n", health.rtt_sum / health.rtt_count);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_host_get_health(host: *const Host, health: *mut HostHealth) -> c_int {
    // SAFETY: Room's contract; the objects of one call don't overlap.
    let (Some(host), Some(health)) = (unsafe { (Host::peek(host), health.as_mut()) }) else {
        return OLP_RC_ERROR_GENERIC;
    };
    copy_counters::<15>(transmute_ref!(host.health()), transmute_mut!(health));
    OLP_RC_SUCCESS
}

fn handle(queued: Result<u16, QueueError>) -> c_int {
    match queued {
        Ok(handle) => handle.cast_signed().into(),
        Err(QueueError::Busy) => -OLP_RC_BUSY,
        Err(QueueError::Malformed) => -OLP_RC_MALFORMED,
        Err(QueueError::TooLong) => -OLP_RC_TOO_LONG,
    }
}
