//! What a call of `olp_device_poll` does.
//!
//! What all functions here ask for: a device is ready, its table what [`check`](super::table::check) found good, and no
//! reference to it lives while one of the firmware's functions runs. Such a function may restart the device: then
//! `serving` is 0, and what was going on is over.

use core::ffi::c_int;

use super::table::{command_of, device_of, write_welcome};
use super::{Command, State};
use crate::line_protocol::message::view;
use crate::line_protocol::{LineEncoder, OLP_RC_BUSY, OLP_RC_NO_EVENT, OLP_RC_SUCCESS, OLP_RC_TOO_LONG};
use crate::memory::{int, text_of};
use deltarobot_protocols::bytes::zeros;
use deltarobot_protocols::line::device::{Fault, LINK_LINE_MAX, LinkLine, is_setup};
use deltarobot_protocols::line::{Message, Received};
use zerocopy::IntoBytes;

/// Does the one thing that comes next.
pub(super) unsafe fn serve(device: *mut State, now: u32) -> c_int {
    // SAFETY: as the contract of this function asks.
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
    // SAFETY: as the contract of this function asks, and there is one.
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
    // SAFETY: as the contract of this function asks.
    unsafe { usize::from((*device).welcomed) >= usize::try_from((*(*device).table()).device_count).unwrap_or_default() }
}

/// Answers the line that was received, if there is one.
unsafe fn answer_line(device: *mut State, now: u32) -> c_int {
    // SAFETY: as the contract of this function asks. The line lies where it is until it is released: nothing is
    // received before.
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
    // SAFETY: as the contract of this function asks.
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
    // SAFETY: as the contract of this function asks: ids are strings.
    unsafe { text_of((*(*(*device).table()).devices).id).unwrap_or_default() }
}

/// Has a command executed, and answers it.
unsafe fn execute(device: *mut State, command: &Command, message: &Message, id: *const [u8]) -> c_int {
    let view = view(message);
    // SAFETY: as the contract of this function asks, and as the table's own: its functions take usr.
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
    // SAFETY: see above.
    unsafe {
        let length = (*device).link.write(line, &*id, room);
        send(device, room.as_ptr(), length);
    }
}

pub(super) unsafe fn send(device: *mut State, line: *const u8, length: usize) {
    // SAFETY: as the contract of this function asks.
    let (table, usr) = unsafe { ((*device).table(), (*device).usr()) };
    // SAFETY: as the table asks: its function takes usr.
    if let (1.., Some(send)) = (length, unsafe { (*table).send }) {
        // SAFETY: as above.
        unsafe { send(line.cast(), int(length), usr) };
    }
}
