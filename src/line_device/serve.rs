//! What a call of `olp_device_poll` does, and what the firmware's table says.
//!
//! What all functions but [`check`] ask for: a device is ready, its table what that found good, and no reference to it
//! lives while one of the firmware's functions runs. Such a function may restart the device: then `serving` is 0, and
//! what was going on is over.

use core::ffi::{c_char, c_int};
use core::ptr;

use super::{Command, DeviceInfo, DeviceTable, State};
use crate::line_protocol::message::view;
use crate::line_protocol::{
    LineEncoder, OLP_RC_BUSY, OLP_RC_ERROR_GENERIC, OLP_RC_NO_EVENT, OLP_RC_SUCCESS, OLP_RC_TOO_LONG,
};
use crate::memory::{int, number, text_of};
use deltarobot_protocols::bytes::zeros;
use deltarobot_protocols::line::device::{Fault, LINK_LINE_MAX, LinkLine, is_id, is_setup};
use deltarobot_protocols::line::{Encoder, Message, Received, Value};
use zerocopy::IntoBytes;

/// Does the one thing that comes next.
pub(super) unsafe fn serve(device: *mut State, now: u32) -> c_int {
    // SAFETY: the device is ready, and no reference to it lives where one of the firmware's functions is called.
    unsafe {
        if (*device).serving != 0 {
            return OLP_RC_BUSY;
        }
        (*device).link.tick(now);
        (*device).serving = 1;
        let mut rc = OLP_RC_SUCCESS;
        if !is_welcomed(device) {
            welcome(device);
        } else if (*device).announces != 0 {
            (*device).announces = 0;
            (*device).link.set_up((*device).setup);
            send_link_line(device, LinkLine::Setup, first_id(device));
        } else {
            (*device).greeted = 1;
            rc = answer_line(device, now);
        }
        (*device).serving = 0;
        rc
    }
}

/// Welcomes the next device.
unsafe fn welcome(device: *mut State) {
    // SAFETY: the table of a device that is ready is good, and it has a device that was not welcomed.
    unsafe {
        let info = (*(*device).table()).devices.add((*device).welcomed.into());
        (*device).welcomed = (*device).welcomed.wrapping_add(1);
        let room = (*device).link.room();
        let length = write_welcome(info, room);
        let line = room.as_ptr();
        send(device, line, length);
    }
}

/// Whether all devices were welcomed.
pub(super) unsafe fn is_welcomed(device: *const State) -> bool {
    // SAFETY: the table of a device that is ready is good.
    unsafe { usize::from((*device).welcomed) >= usize::try_from((*(*device).table()).device_count).unwrap_or_default() }
}

/// Answers the line that was received, if there is one.
unsafe fn answer_line(device: *mut State, now: u32) -> c_int {
    // SAFETY: the device is ready. The line lies where it is until it is released: nothing is received before.
    unsafe {
        let receiver = &raw const (*device).receiver;
        let message = match (*receiver).received() {
            Received::Nothing => return OLP_RC_NO_EVENT,
            Received::TooLong => Err(Fault::Overflow),
            Received::Line(line) => Message::parse(line).map_err(|_| Fault::Malformed),
        };
        let accepted = message.and_then(|message| (*device).link.accept(&message, now).map(|()| message));
        let rc = match accepted {
            Ok(message) => answer(device, &message),
            Err(fault) => {
                send_link_line(device, LinkLine::Event(fault), first_id(device));
                OLP_RC_SUCCESS
            }
        };
        if (*device).serving != 0 {
            (*device).receiver.release();
        }
        rc
    }
}

/// Answers an intact command.
unsafe fn answer(device: *mut State, message: &Message) -> c_int {
    // SAFETY: the table of a device that is ready is good: its ids and names are strings.
    unsafe {
        let table = (*device).table();
        let asked = message.text(b"id");
        let known = device_of(table, asked);
        let id: *const [u8] = if known.is_null() { asked.raw() } else { text_of((*known).id).unwrap_or_default() };
        let sets_up = !known.is_null() && is_setup(message);
        if sets_up {
            (*device).link.change_setup(message);
        }
        send_link_line(device, LinkLine::Ack, id);
        if (*device).serving == 0 {
            return OLP_RC_SUCCESS;
        }
        let line = if known.is_null() {
            LinkLine::Answer(Fault::UnknownId)
        } else if sets_up {
            LinkLine::SetupAnswer
        } else if let Some(again) = (*device).link.repeated() {
            let (line, length) = (again.as_ptr(), again.len());
            send(device, line, length);
            return OLP_RC_SUCCESS;
        } else if let Some(command) = command_of(table, asked, message.command()) {
            return execute(device, command, message, id);
        } else {
            LinkLine::Answer(Fault::UnknownCommand)
        };
        send_link_line(device, line, id);
    }
    OLP_RC_SUCCESS
}

/// The first device's id: that of what nobody asked for.
unsafe fn first_id(device: *const State) -> *const [u8] {
    // SAFETY: the table of a device that is ready is good: it has a first device, whose id is a string.
    unsafe { text_of((*(*(*device).table()).devices).id).unwrap_or_default() }
}

/// Has a command executed, and answers it.
unsafe fn execute(device: *mut State, command: &Command, message: &Message, id: *const [u8]) -> c_int {
    let view = view(message);
    // SAFETY: the functions in a good table can be called with usr; references into the device are not used after it.
    unsafe {
        let length = (*device).link.begin(text_of(command.name).unwrap_or_default());
        let room = (*device).link.room();
        let (buf, cap) = (room.as_mut_ptr().cast(), int(room.len()));
        let mut answer = LineEncoder { buf, cap, length: int(length), error: OLP_RC_SUCCESS };
        let refused = command.run.is_none_or(|run| run(&raw const view, &raw mut answer, (*device).usr()) != 0);
        if (*device).serving == 0 {
            return OLP_RC_SUCCESS;
        }
        let cannot_send = (answer.error != OLP_RC_SUCCESS).then_some(Fault::TooLong);
        let fault = if refused { Some(Fault::Refused) } else { cannot_send };
        // A length below 0 is too long.
        let written = usize::try_from(answer.length).unwrap_or(usize::MAX);
        let (length, fault) = (*device).link.finish(written, fault, &*id);
        let line = (*device).link.room().as_ptr();
        send(device, line, length);
        match (fault, answer.error) {
            (Some(Fault::TooLong), OLP_RC_SUCCESS) => OLP_RC_TOO_LONG,
            (Some(Fault::TooLong), error) => error,
            _ => OLP_RC_SUCCESS,
        }
    }
}

/// Writes and sends a line of the link itself.
#[inline(never)]
unsafe fn send_link_line(device: *mut State, line: LinkLine, id: *const [u8]) {
    let mut room = zeros::<{ LINK_LINE_MAX / 2 }>();
    let room = room.as_mut_bytes();
    // SAFETY: the device is ready, and id is of its table or of the line that it answers.
    unsafe {
        let length = (*device).link.write(line, &*id, room);
        send(device, room.as_ptr(), length);
    }
}

pub(super) unsafe fn send(device: *mut State, line: *const u8, length: usize) {
    // SAFETY: the table of a device that is ready is good.
    let (table, usr) = unsafe { ((*device).table(), (*device).usr()) };
    // SAFETY: it is that of a device that is ready, so good.
    if let (1.., Some(send)) = (length, unsafe { (*table).send }) {
        // SAFETY: the functions in such a table can be called with usr.
        unsafe { send(line.cast(), int(length), usr) };
    }
}

/// Whether a table is one to work with; room is for trying. Unsafe as [`olp_device_init`](super::olp_device_init) is.
pub(super) unsafe fn check(table: *const DeviceTable, room: &mut [u8]) -> c_int {
    // SAFETY: table is NULL or what olp_device_init's caller says: so many devices and commands, with strings.
    unsafe {
        let Some(table) = table.as_ref() else { return OLP_RC_ERROR_GENERIC };
        let mut info = table.devices;
        if table.device_count < 1 || info.is_null() || table.send.is_none() || table.command_count < 0 {
            return OLP_RC_ERROR_GENERIC;
        }
        for _ in 0..table.device_count {
            // A command for an id that two have would go to the first of them alone.
            let is_good =
                text_of((*info).id).is_some_and(|id| is_id(id) && ptr::eq(device_of(table, Value::new(id)), info));
            if !is_good || (*info).r#type.is_null() {
                return OLP_RC_ERROR_GENERIC;
            }
            if write_welcome(info, room) == 0 {
                return OLP_RC_TOO_LONG;
            }
            info = info.add(1);
        }
        let mut command = table.commands;
        for _ in 0..table.command_count {
            if command.is_null() || (*command).name.is_null() {
                return OLP_RC_ERROR_GENERIC;
            }
            command = command.add(1);
        }
        OLP_RC_SUCCESS
    }
}

/// Writes the welcome of a device and returns its length, 0 when it does not fit.
pub(super) unsafe fn write_welcome(info: *const DeviceInfo, room: &mut [u8]) -> usize {
    // SAFETY: info is one of a table's: its texts are NULL or strings.
    unsafe {
        let mut line = Encoder::begin(room, b"welcome");
        add(&mut line, b"id", (*info).id);
        add(&mut line, b"type", (*info).r#type);
        if (*info).pos != 0 {
            line.number(b"&pos=", number((*info).pos));
        }
        add(&mut line, b"name", (*info).name);
        add(&mut line, b"version", (*info).version);
        line.finish(false).unwrap_or(0)
    }
}

/// Adds a text that is there: NULL or a string.
unsafe fn add(line: &mut Encoder, name: &[u8], text: *const c_char) {
    // SAFETY: text is NULL or a string.
    if let Some(text) = unsafe { text_of(text) } {
        line.text(name, text);
    }
}

/// The device that is meant, or NULL.
pub(super) unsafe fn device_of(table: *const DeviceTable, asked: Value) -> *const DeviceInfo {
    // SAFETY: ids are NULL or strings.
    unsafe {
        let mut info = (*table).devices;
        for _ in 0..(*table).device_count {
            if text_of((*info).id).is_some_and(|id| asked.is(id)) {
                return info;
            }
            info = info.add(1);
        }
        ptr::null()
    }
}

/// The command that is meant, if there is one.
pub(super) unsafe fn command_of<'a>(table: *const DeviceTable, id: Value, name: Value) -> Option<&'a Command> {
    // SAFETY: a good table has so many commands, whose texts are NULL or strings.
    unsafe {
        let mut command = (*table).commands;
        for _ in 0..(*table).command_count {
            if text_of((*command).name).is_some_and(|own| name.is(own))
                && text_of((*command).id).is_none_or(|own| id.is(own))
            {
                return command.as_ref();
            }
            command = command.add(1);
        }
        None
    }
}
