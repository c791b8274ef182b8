//! `libdeltarobot/line_device.h`: the device's end of the Ozeki line protocol's link, for firmware: says which devices
//! are there, takes commands, has them executed, answers them, and sends events.
//!
//! A main loop around it:
//!
//! ```c
//! unsigned char in[64];
//! int got = 0, taken = 0;
//!
//! olp_device_init(&device, &table, &uart);
//! for (;;) {
//!     if (taken == got) {
//!         taken = 0;
//!         got = uart_read(&uart, in, sizeof in);
//!     }
//!     taken += olp_device_receive(&device, in + taken, got - taken, now_ms());
//!     olp_device_poll(&device, now_ms());
//!     if (there_is_news()) {
//!         olp_begin(&event, text, sizeof text, "heaterinfo");
//!         olp_add_float(&event, "temp", temperature, 2);
//!         olp_device_event(&device, &event, "M1F910");
//!     }
//! }
//! ```
//!
//! What it answers to what:
//!
//! - an intact command: ack if acks are in force, then `<command>_resp`
//! - its repeat: the same again; it is not executed again (see repeat_ms)
//! - linksetup: executed here; ack as newly settled, linksetup_resp; an option left out or not understood stays as it is
//! - an unknown id or command: ack, onerror with code unknownid or unknowncommand, and the command's t
//! - one refused by its function: ack, onerror refused, and the command's t
//! - one executed whose answer can't be sent: ack, onerror toolong, and the command's t
//! - a wrong checksum, a missing one when one is in force, too long or unreadable lines: onerror with code checksum,
//!   overflow or malformed; nothing is executed

use core::ffi::{c_char, c_int, c_ulong, c_void};
use core::ptr::{with_exposed_provenance, with_exposed_provenance_mut};

use super::line_protocol::encoder::edit;
use super::line_protocol::{LineEncoder, LineMessage};
use super::line_protocol::{OLP_RC_BUSY, OLP_RC_ERROR_GENERIC, OLP_RC_NO_EVENT, OLP_RC_SUCCESS};
use super::memory::{bytes_of, copy_counters, duration, int, text_of, time};
use crate::sizes::{OLP_REPLY_MAX, OLP_WINDOW_MAX};
use crate::state::{Room, Word, state};
use deltarobot_export::export;
use deltarobot_protocols::line::device::{DeviceLink, ID_MAX, LINE_MAX, Setup};
use deltarobot_protocols::line::{Receiver, Value};
use zerocopy::{FromBytes, IntoBytes, transmute_mut, transmute_ref};

mod serve;

use serve::{check, device_of, is_welcomed, send, serve};

/// Length of the longest id that a device behind a link may have.
pub const OLP_ID_MAX: c_int = 10;
const _: () = assert!(OLP_ID_MAX as usize == ID_MAX);

/// Executes a command: reads its parameters from command, and adds those of the answer (but for id and t, which are
/// added behind them) to answer, which is begun. Returns 0, or anything else to refuse; what was added does not matter
/// then. Both are gone when the function returns. It may use the device, which however receives nothing meanwhile.
///
/// ```c
/// int set_switch(const struct olp_message *command, struct olp_encoder *answer, void *usr)
/// {
///     long state;
///     if (olp_get_int(command, "state", 0, &state) != OLP_RC_SUCCESS)
///         return -1;
///     olp_add_int(answer, "state", switch_to(state));
///     return 0;
/// }
/// ```
pub type RunFunc =
    Option<unsafe extern "C" fn(command: *const LineMessage, answer: *mut LineEncoder, usr: *mut c_void) -> c_int>;
/// Sends a line: so many bytes, the LF among them, gone when the function returns. Its result is ignored: who misses a
/// line asks again. It may use the device, which however receives nothing while a line is being answered.
///
/// ```c
/// int send_line(const void *line, int bytes, void *usr)
/// {
///     return uart_write((struct uart *)usr, line, bytes);
/// }
/// ```
pub type LineSendFunc = Option<unsafe extern "C" fn(line: *const c_void, bytes: c_int, usr: *mut c_void) -> c_int>;

/// A device behind the link, as its welcome describes it. The texts end with a zero byte.
#[derive(Debug)]
#[repr(C)]
pub struct DeviceInfo {
    /// 1 to `OLP_ID_MAX` of `[0-9A-Za-z._-]`; the protocol asks for 6 letters and digits. No two have the same.
    pub id: *const c_char,
    /// What it is, e.g. OzekiSwitchController.
    pub r#type: *const c_char,
    /// Its place; 0: it is left out.
    pub pos: c_int,
    /// Its name; NULL: it has none.
    pub name: *const c_char,
    /// Its version; NULL: it has none.
    pub version: *const c_char,
}

/// A command that a device executes.
#[derive(Debug)]
#[repr(C)]
pub struct Command {
    /// The device's id; NULL: each device has it. The first command that fits is taken.
    pub id: *const c_char,
    /// The command's name, of `[A-Za-z0-9_]`.
    pub name: *const c_char,
    /// What executes it; NULL: it is refused.
    pub run: RunFunc,
}

/// What is behind a link, and how to send to its other end.
#[derive(Debug)]
#[repr(C)]
pub struct DeviceTable {
    /// The devices, at least one. The first stands for all of them in what the link itself sends.
    pub devices: *const DeviceInfo,
    /// Their number.
    pub device_count: c_int,
    /// What they execute. linksetup is not among it: the library does that.
    pub commands: *const Command,
    /// Number of commands.
    pub command_count: c_int,
    /// Sends a line.
    pub send: LineSendFunc,
    /// For how many milliseconds after a command, or its last repeat, a repeat is recognised, at most 2^31 - 1; 0
    /// stands for 5000. It has to be more than the other end waits before it repeats: later, the line is a new command.
    pub repeat_ms: c_ulong,
}

/// Words of a device, with some room to spare.
pub const OLP_DEVICE_WORDS: usize = OLP_WINDOW_MAX * (OLP_REPLY_MAX + 11) / 4 + 37;

/// The device's end of a link. All zero is one that `olp_device_init` has not made yet.
#[derive(Debug)]
#[repr(C)]
pub struct Device {
    opaque: [Word; OLP_DEVICE_WORDS],
}
state!(Device: State);

/// What lies in a [`Device`].
#[derive(FromBytes)]
// In this order: on AVR what lies within 64 bytes takes shorter instructions.
#[repr(C)]
pub(crate) struct State {
    /// Addresses of the table and of usr, which are exposed; that of the table is 0 when the device is not ready.
    table: usize,
    usr: usize,
    /// How many devices were welcomed.
    welcomed: u16,
    /// Not 0: nothing is to be sent but answers.
    greeted: u8,
    /// Not 0 while `olp_device_poll` runs.
    serving: u8,
    /// Not 0: `setup` is to be announced by an event.
    announces: u8,
    setup: Setup,
    link: DeviceLink<OLP_WINDOW_MAX, OLP_REPLY_MAX>,
    receiver: Receiver<{ LINE_MAX + 1 }>,
}

impl State {
    fn table(&self) -> *const DeviceTable {
        with_exposed_provenance(self.table)
    }

    fn usr(&self) -> *mut c_void {
        with_exposed_provenance_mut(self.usr)
    }
}

/// How the link does. The counters wrap at 2^32.
#[derive(Debug, FromBytes, IntoBytes)]
#[repr(C)]
pub struct DeviceHealth {
    /// Commands that were received intact, repeats among them.
    pub commands: c_ulong,
    /// Commands that came again and were only answered again.
    pub repeats: c_ulong,
    /// Lines whose checksum was wrong or missing.
    pub checksums: c_ulong,
    /// Lines that could not be read.
    pub malformed: c_ulong,
    /// Lines that were too long.
    pub overflows: c_ulong,
    /// Commands that were refused: by their function, or because nobody knows their id or name.
    pub refused: c_ulong,
}

/// Makes the device's end of a link of any memory. The first calls of `olp_device_poll` will send the welcomes.
///
/// table's counts, texts and functions are what it says, and its functions can be called with usr; it stays there,
/// unchanged, as long as the device is used.
///
/// Returns `OLP_RC_SUCCESS`; `OLP_RC_TOO_LONG` when a welcome is longer than `OLP_REPLY_MAX`; `OLP_RC_ERROR_GENERIC`
/// when device or table is NULL, or the table has no device, no `send`, an id that can't be or that two devices have,
/// or NULL where a text or an array has to be.
///
/// ```c
/// static const struct olp_device_info devices[] = {{"9o5qzg", "OzekiSwitchController", 0, 0, 0}};
/// static const struct olp_command commands[] = {{0, "setswitch", set_switch}};
/// static const struct olp_device_table table = {devices, 1, commands, 1, send_line, 0};
/// olp_device_init(&device, &table, &uart);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_device_init(device: *mut Device, table: *const DeviceTable, usr: *mut c_void) -> c_int {
    // SAFETY: Room's contract; table is NULL or what the caller says it is.
    unsafe {
        let Some(state) = Device::init(device) else { return OLP_RC_ERROR_GENERIC };
        let rc = check(table, state.link.room());
        if rc == OLP_RC_SUCCESS {
            state.table = table.expose_provenance();
            state.usr = usr.expose_provenance();
            state.link.expect_repeats_for(duration((*table).repeat_ms));
        }
        rc
    }
}

/// Starts again, as after `olp_device_init`: to be called when another connection is made. Returns `OLP_RC_SUCCESS`, or
/// `OLP_RC_ERROR_GENERIC` when device is NULL or was not made by `olp_device_init`.
///
/// ```c
/// olp_device_restart(&device);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_device_restart(device: *mut Device) -> c_int {
    // SAFETY: the table and usr of a device that is ready are those that olp_device_init was given.
    unsafe {
        match ready(device) {
            Some(state) => olp_device_init(device, (*state).table(), (*state).usr()),
            None => OLP_RC_ERROR_GENERIC,
        }
    }
}

/// Has the device set up the link by a linksetup event, in force when the next calls of `olp_device_poll` have sent it
/// (behind the welcomes). ack and checksum: 0 off, else on. window: how many commands may be unanswered, 1 to
/// `OLP_WINDOW_MAX`. Returns `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` when window is out of range, or device NULL or
/// not made by `olp_device_init`.
///
/// ```c
/// olp_device_linksetup(&device, 1, 1, OLP_WINDOW_MAX);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_device_linksetup(
    device: *mut Device,
    ack: c_int,
    checksum: c_int,
    window: c_int,
) -> c_int {
    let window = u8::try_from(window).ok().filter(|window| (1..=OLP_WINDOW_MAX).contains(&usize::from(*window)));
    match (window, ready(device)) {
        (Some(window), Some(state)) => {
            // SAFETY: not NULL, and nobody else touches the device meanwhile.
            let state = unsafe { &mut *state };
            state.setup = Setup::new(ack != 0, checksum != 0, window);
            state.announces = 1;
            state.greeted = 0;
            OLP_RC_SUCCESS
        }
        _ => OLP_RC_ERROR_GENERIC,
    }
}

/// Takes received bytes, up to the end of a line. Until `olp_device_poll` has answered that line, no more are taken.
/// `now_ms` makes no difference, as `olp_device_poll` has the time. Not for interrupts that may come during another
/// call on the same device.
///
/// Returns how many bytes were taken, the rest being for after the next `olp_device_poll`; -`OLP_RC_ERROR_GENERIC` when
/// device is NULL or was not made by `olp_device_init`, bytes is negative, or buf is NULL and bytes is not 0.
///
/// ```c
/// for (int taken = 0; taken < length; olp_device_poll(&device, now_ms()))
///     taken += olp_device_receive(&device, in + taken, length - taken, now_ms());
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_device_receive(
    device: *mut Device,
    buf: *const c_void,
    bytes: c_int,
    now_ms: c_ulong,
) -> c_int {
    let _ = now_ms;
    // SAFETY: buf is NULL or has so many bytes; the device is not NULL, and nobody else touches it meanwhile.
    unsafe {
        match (bytes_of(buf, bytes), ready(device)) {
            (Some(input), Some(state)) => int((*state).receiver.take(input)),
            _ => -OLP_RC_ERROR_GENERIC,
        }
    }
}

/// Does one thing in the firmware's main loop: sends a welcome or the linksetup event, or answers a received line.
///
/// Returns `OLP_RC_SUCCESS` when something was done; `OLP_RC_NO_EVENT` when there was nothing to do; `OLP_RC_BUSY` when
/// called by a function that it called itself; `OLP_RC_ERROR_GENERIC` when device is NULL or was not made by
/// `olp_device_init`; and when a command was executed but the answer can't be sent, `OLP_RC_TOO_LONG` or what else
/// `olp_finish` may say.
///
/// ```c
/// while (olp_device_poll(&device, now_ms()) == OLP_RC_SUCCESS)
///     ;
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_device_poll(device: *mut Device, now_ms: c_ulong) -> c_int {
    let Some(state) = ready(device) else { return OLP_RC_ERROR_GENERIC };
    // SAFETY: a device that is ready has a good table; serve() holds no reference to it while callbacks run.
    unsafe {
        if (*state).greeted != 0 && !(*state).receiver.has_ended() && !(*state).link.is_behind(time(now_ms)) {
            return if (*state).serving == 0 { OLP_RC_NO_EVENT } else { OLP_RC_BUSY };
        }
        serve(state, time(now_ms))
    }
}

/// Sends an event of the device of that id, a string: event was begun, by `olp_begin`, and has its parameters; id and t
/// are added here. Its buffer is the caller's, has room for the whole line, and is still there.
///
/// Returns `OLP_RC_SUCCESS`; `OLP_RC_BUSY` as long as there are welcomes to send, which come first;
/// `OLP_RC_ERROR_GENERIC` when a pointer is NULL, device was not made by `olp_device_init`, or it has no such id; or,
/// when the event can't be sent, what is wrong with it: `OLP_RC_TOO_LONG` or what else `olp_finish` may say.
///
/// ```c
/// olp_begin(&event, text, sizeof text, "heaterinfo");
/// olp_add_float(&event, "temp", 21.5f, 2);
/// olp_device_event(&device, &event, "M1F910");
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_device_event(device: *mut Device, event: *mut LineEncoder, id: *const c_char) -> c_int {
    let Some(state) = ready(device) else { return OLP_RC_ERROR_GENERIC };
    // SAFETY: a device that is ready has a good table; id is NULL or a string, and event's buffer is still there.
    unsafe {
        let (Some(id), Some(event)) = (text_of(id), event.as_mut()) else { return OLP_RC_ERROR_GENERIC };
        let info = device_of((*state).table(), Value::new(id));
        if info.is_null() {
            return OLP_RC_ERROR_GENERIC;
        }
        if !is_welcomed(state) {
            return OLP_RC_BUSY;
        }
        let id = text_of((*info).id).unwrap_or_default();
        let mut written = 0;
        let rc = edit(event, &mut |line| written = (*state).link.finish_event(line, id));
        if written != 0 {
            event.error = OLP_RC_ERROR_GENERIC;
            send(state, event.buf.cast(), written);
        }
        rc
    }
}

/// Copies how the link does. Returns `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// struct olp_device_health health;
/// if (olp_device_get_health(&device, &health) == OLP_RC_SUCCESS)
///     printf("%lu commands, %lu of them repeated\n", health.commands, health.repeats);
/// ```
#[export(olp)]
pub unsafe extern "C" fn olp_device_get_health(device: *const Device, health: *mut DeviceHealth) -> c_int {
    // SAFETY: Room's contract; the objects of one call don't overlap.
    let (Some(state), Some(health)) = (unsafe { (Device::peek(device), health.as_mut()) }) else {
        return OLP_RC_ERROR_GENERIC;
    };
    copy_counters::<6>(transmute_ref!(state.link.health()), transmute_mut!(health));
    OLP_RC_SUCCESS
}

/// The state of a device that `olp_device_init` has made, or `None`.
fn ready(device: *mut Device) -> Option<*mut State> {
    let state = device.cast::<State>();
    // SAFETY: not NULL, so it points to a device, whose room is large enough and aligned for the state.
    (!state.is_null() && unsafe { (*state).table } != 0).then_some(state)
}
