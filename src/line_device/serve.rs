//! What a call of `olp_device_poll` does.
//!
//! A device is ready here, its table what [`check`](super::table::check) found good, and no reference to it lives while
//! one of the firmware's functions runs. Such a function may restart the device: then `serving` is 0, and what was
//! going on is over.

use core::ffi::c_int;
use core::mem::MaybeUninit;

use super::table::{command_of, device_of, devices, first_id, welcome};
use super::{Command, State};
use crate::line_protocol::message::view;
use crate::line_protocol::{LineEncoder, OLP_RC_NO_EVENT, OLP_RC_SUCCESS, OLP_RC_TOO_LONG};
use crate::memory::{int, text_of, zero};
use deltarobot_protocols::line::device::{Fault, LINK_LINE_MAX, LinkLine, Request, is_id, is_setup};
use deltarobot_protocols::line::{Message, Received};

/// Does the one thing that comes next.
///
/// # Safety
///
/// See above.
pub(super) unsafe fn serve(device: *mut State, now: u32) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe {
        let table = (*device).table();
        let welcomed = usize::from((*device).welcomed);
        if let Some(info) = devices(&*table).get(welcomed) {
            (*device).welcomed = (*device).welcomed.wrapping_add(1);
            let room = (*device).link.room();
            let length = welcome(info).as_ref().and_then(|welcome| welcome.write(room).ok()).unwrap_or_default();
            let line = room.as_ptr();
            send(device, line, length);
            return OLP_RC_SUCCESS;
        }
        if (*device).announces != 0 {
            (*device).announces = 0;
            send_link_line(device, LinkLine::Setup((*device).setup), first_id(table));
            return OLP_RC_SUCCESS;
        }
        (*device).greeted = 1;
        answer_line(device, now)
    }
}

/// Answers the line that was received, if there is one.
///
/// # Safety
///
/// See above.
// On AVR with its caller it would have a frame of more than 64 bytes: see DeviceLink::write().
#[cfg_attr(target_pointer_width = "16", inline(never))]
unsafe fn answer_line(device: *mut State, now: u32) -> c_int {
    // SAFETY: as the contract of this function asks. The line lies where it is until it is released: nothing is
    // received before.
    unsafe {
        let receiver = &raw const (*device).receiver;
        let message = match (*receiver).received() {
            Received::Nothing => return OLP_RC_NO_EVENT,
            Received::Line(line) => Message::parse(line).map_err(|_| Fault::Malformed),
            Received::TooLong => Err(Fault::Overflow),
        };
        let accepted = message.and_then(|message| Ok((message, (*device).link.accept(&message, now)?)));
        let rc = match &accepted {
            Ok((message, request)) => answer(device, message, request),
            Err(fault) => {
                send_link_line(device, LinkLine::Fault(*fault, None), first_id((*device).table()));
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
///
/// # Safety
///
/// See above.
unsafe fn answer(device: *mut State, message: &Message, request: &Request) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe {
        let table = (*device).table();
        let asked = message.get(b"id").unwrap_or_default();
        let known = device_of(&*table, asked);
        let id = known.unwrap_or_else(|| Some(asked.raw()).filter(|id| is_id(id)).unwrap_or_default());
        let sets_up = known.is_some() && is_setup(message);
        if sets_up {
            (*device).link.change_setup(message);
        }
        send_link_line(device, LinkLine::Ack(request), id);
        if (*device).serving == 0 {
            return OLP_RC_SUCCESS;
        }
        if known.is_none() {
            send_link_line(device, LinkLine::Fault(Fault::UnknownId, Some(request)), id);
        } else if sets_up {
            send_link_line(device, LinkLine::SetupAnswer(message), id);
        } else if let Some(again) = (*device).link.repeated(request) {
            let (line, length) = (again.as_ptr(), again.len());
            send(device, line, length);
        } else if let Some(command) = command_of(&*table, asked, message.command()) {
            return execute(device, command, message, request, id);
        } else {
            send_link_line(device, LinkLine::Fault(Fault::UnknownCommand, Some(request)), id);
        }
    }
    OLP_RC_SUCCESS
}

/// Has a command executed, and answers it.
///
/// # Safety
///
/// See above.
unsafe fn execute(device: *mut State, command: &Command, message: &Message, request: &Request, id: &[u8]) -> c_int {
    let view = view(message);
    // SAFETY: as the contract of this function asks, and as the table's own: its functions take usr.
    unsafe {
        let (room, length) = (*device).link.begin(text_of(command.name).unwrap_or_default());
        let (buf, cap) = (room.as_mut_ptr().cast(), int(room.len()));
        let mut answer = LineEncoder { buf, cap, length: int(length), error: OLP_RC_SUCCESS };
        let refused = command.run.is_none_or(|run| run(&raw const view, &raw mut answer, (*device).usr()) != 0);
        if (*device).serving == 0 {
            return OLP_RC_SUCCESS;
        }
        let written = match usize::try_from(answer.length) {
            _ if refused => Err(Fault::Refused),
            Ok(length) if answer.error == OLP_RC_SUCCESS => Ok(length),
            _ => Err(Fault::TooLong),
        };
        let (line, fault) = (*device).link.finish(request, id, written);
        let (line, length) = (line.as_ptr(), line.len());
        send(device, line, length);
        match (fault, answer.error) {
            (Some(Fault::TooLong), OLP_RC_SUCCESS) => OLP_RC_TOO_LONG,
            (Some(Fault::TooLong), error) => error,
            _ => OLP_RC_SUCCESS,
        }
    }
}

/// Writes and sends a line of the link itself.
///
/// # Safety
///
/// See above.
#[inline(never)]
unsafe fn send_link_line(device: *mut State, line: LinkLine<'_>, id: &[u8]) {
    let mut room = MaybeUninit::<[u8; LINK_LINE_MAX]>::uninit();
    // SAFETY: see above; zero is a value of such arrays.
    unsafe {
        zero(room.as_mut_ptr());
        let length = (*device).link.write(line, id, room.assume_init_mut());
        send(device, room.as_ptr().cast(), length);
    }
}

/// # Safety
///
/// See above.
pub(super) unsafe fn send(device: *mut State, line: *const u8, length: usize) {
    // SAFETY: as the contract of this function asks.
    let (table, usr) = unsafe { ((*device).table(), (*device).usr()) };
    // SAFETY: as the table asks: its function takes usr.
    if let (1.., Some(send)) = (length, unsafe { (*table).send }) {
        // SAFETY: as above.
        unsafe { send(line.cast(), int(length), usr) };
    }
}
