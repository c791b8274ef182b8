//! What the firmware's table says.

use core::ffi::{c_char, c_int};
use core::ptr;

use super::{Command, DeviceInfo, DeviceTable};
use crate::line_protocol::{OLP_RC_ERROR_GENERIC, OLP_RC_SUCCESS, OLP_RC_TOO_LONG};
use crate::memory::{number, text_of};
use deltarobot_protocols::line::device::is_id;
use deltarobot_protocols::line::{Encoder, Value};

/// Whether a table is one to work with; room is for trying. Unsafe as [`olp_device_init`](super::olp_device_init) is.
pub(super) unsafe fn check(table: *const DeviceTable, room: &mut [u8]) -> c_int {
    // SAFETY: as the contract of this function asks.
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

// From here on, tables are what `check` found good, which makes these functions unsafe.

/// Writes the welcome of a device and returns its length, 0 when it does not fit.
pub(super) unsafe fn write_welcome(info: *const DeviceInfo, room: &mut [u8]) -> usize {
    // SAFETY: as the contract of this function asks.
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
    // SAFETY: as the contract of this function asks.
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
    // SAFETY: as the contract of this function asks.
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
