//! What the firmware's table says.

use core::ffi::c_int;
use core::slice;

use super::{Command, DeviceInfo, DeviceTable};
use crate::line_protocol::{OLP_RC_ERROR_GENERIC, OLP_RC_SUCCESS, OLP_RC_TOO_LONG};
use crate::memory::{number, text_of};
use deltarobot_protocols::line::Value;
use deltarobot_protocols::line::device::{Welcome, is_id};

/// Whether a table is one to work with; room is for trying.
///
/// # Safety
///
/// As for [`olp_device_init`](super::olp_device_init).
pub(super) unsafe fn check(table: *const DeviceTable, room: &mut [u8]) -> c_int {
    // SAFETY: as the contract of this function asks.
    unsafe {
        let Some(table) = table.as_ref() else { return OLP_RC_ERROR_GENERIC };
        let commands = table.command_count >= 0 && (table.command_count == 0 || !table.commands.is_null());
        if table.device_count < 1 || table.devices.is_null() || table.send.is_none() || !commands {
            return OLP_RC_ERROR_GENERIC;
        }
        for (place, info) in devices(table).iter().enumerate() {
            let Some(welcome) = &welcome(info) else { return OLP_RC_ERROR_GENERIC };
            // A command for an id that two have would go to the first of them alone.
            if index_of(table, Value::new(welcome.id)) != Some(place) {
                return OLP_RC_ERROR_GENERIC;
            }
            if welcome.write(room).is_err() {
                return OLP_RC_TOO_LONG;
            }
        }
        let named = commands_of(table).iter().all(|command| !command.name.is_null());
        if named { OLP_RC_SUCCESS } else { OLP_RC_ERROR_GENERIC }
    }
}

// From here on, tables are what `check` found good.

/// # Safety
///
/// See above.
pub(super) unsafe fn devices(table: &DeviceTable) -> &[DeviceInfo] {
    // SAFETY: as the contract of this function asks.
    unsafe { slice::from_raw_parts(table.devices, usize::try_from(table.device_count).unwrap_or_default()) }
}

/// # Safety
///
/// See above.
unsafe fn commands_of(table: &DeviceTable) -> &[Command] {
    let count = usize::try_from(table.command_count).unwrap_or_default();
    // SAFETY: as the contract of this function asks.
    if count == 0 { &[] } else { unsafe { slice::from_raw_parts(table.commands, count) } }
}

/// The welcome of a device, if it has what that needs.
///
/// # Safety
///
/// As for [`olp_device_init`](super::olp_device_init).
pub(super) unsafe fn welcome(info: &DeviceInfo) -> Option<Welcome<'_>> {
    // SAFETY: as the contract of this function asks.
    unsafe {
        Some(Welcome {
            id: text_of(info.id).filter(|id| is_id(id))?,
            r#type: text_of(info.r#type)?,
            pos: number(info.pos),
            name: text_of(info.name),
            version: text_of(info.version),
        })
    }
}

/// The place of the device that is meant, if there is one.
///
/// # Safety
///
/// See above.
unsafe fn index_of(table: &DeviceTable, asked: Value) -> Option<usize> {
    // SAFETY: ids are NULL or strings.
    unsafe { devices(table).iter().position(|info| text_of(info.id).is_some_and(|id| asked.is(id))) }
}

/// The id of the device that is meant, if there is one.
///
/// # Safety
///
/// See above.
pub(super) unsafe fn device_of<'a>(table: &'a DeviceTable, asked: Value) -> Option<&'a [u8]> {
    // SAFETY: as for index_of().
    unsafe { text_of(devices(table).get(index_of(table, asked)?)?.id) }
}

/// The command that is meant, if there is one.
///
/// # Safety
///
/// See above.
pub(super) unsafe fn command_of<'a>(table: &'a DeviceTable, id: Value, name: Value) -> Option<&'a Command> {
    // SAFETY: as the contract of this function asks.
    unsafe {
        commands_of(table).iter().find(|command| {
            text_of(command.id).is_none_or(|own| id.is(own)) && text_of(command.name).is_some_and(|own| name.is(own))
        })
    }
}

/// The id of the first device.
///
/// # Safety
///
/// See above.
pub(super) unsafe fn first_id<'a>(table: *const DeviceTable) -> &'a [u8] {
    // SAFETY: as the contract of this function asks.
    unsafe { text_of((*(*table).devices).id).unwrap_or_default() }
}
