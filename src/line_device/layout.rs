//! The layout that C compilers give the structs of `line_device.h`; C tests assert the same numbers.

use core::ffi::{c_int, c_ulong};
use core::mem::{align_of, offset_of, size_of};

use super::{Command, Device, DeviceInfo, DeviceTable, OLP_ID_MAX};
use crate::sizes::{OLP_REPLY_MAX, OLP_WINDOW_MAX};
use deltarobot_protocols::line::COMMAND_MAX;
use deltarobot_protocols::line::device::{Answer, Answers, DeviceHealth, DeviceLink, ID_MAX, Input};

#[expect(clippy::arithmetic_side_effects, reason = "done by the compiler")]
const _: () = {
    const INT: usize = size_of::<c_int>();
    const LONG: usize = size_of::<c_ulong>();
    const POINTER: usize = size_of::<*const ()>();
    const COMMANDS: usize = pointer_up(POINTER + INT);
    const SEND: usize = pointer_up(COMMANDS + POINTER + INT);
    const REPEAT_MS: usize = up(SEND + POINTER, align_of::<c_ulong>());
    const ANSWER: usize = up(LONG + INT + 2 + OLP_REPLY_MAX, align_of::<c_ulong>());
    const LINK: usize = up(size_of::<Answers>() + 7 * LONG + INT + 4, align_of::<c_ulong>());
    const fn up(size: usize, align: usize) -> usize {
        size.next_multiple_of(align)
    }
    const fn pointer_up(size: usize) -> usize {
        up(size, align_of::<*const ()>())
    }

    assert!(offset_of!(DeviceInfo, id) == 0 && offset_of!(DeviceInfo, r#type) == POINTER);
    assert!(offset_of!(DeviceInfo, pos) == 2 * POINTER);
    assert!(offset_of!(DeviceInfo, name) == pointer_up(2 * POINTER + INT));
    assert!(offset_of!(DeviceInfo, version) == pointer_up(2 * POINTER + INT) + POINTER);
    assert!(size_of::<DeviceInfo>() == pointer_up(2 * POINTER + INT) + 2 * POINTER);

    assert!(offset_of!(Command, id) == 0 && offset_of!(Command, name) == POINTER);
    assert!(offset_of!(Command, run) == 2 * POINTER && size_of::<Command>() == 3 * POINTER);

    assert!(offset_of!(DeviceTable, devices) == 0 && offset_of!(DeviceTable, device_count) == POINTER);
    assert!(offset_of!(DeviceTable, commands) == COMMANDS);
    assert!(offset_of!(DeviceTable, command_count) == COMMANDS + POINTER);
    assert!(offset_of!(DeviceTable, send) == SEND && offset_of!(DeviceTable, repeat_ms) == REPEAT_MS);
    assert!(size_of::<DeviceTable>() == pointer_up(REPEAT_MS + LONG));

    assert!(offset_of!(DeviceHealth, commands) == 0 && offset_of!(DeviceHealth, repeats) == LONG);
    assert!(offset_of!(DeviceHealth, checksums) == 2 * LONG && offset_of!(DeviceHealth, malformed) == 3 * LONG);
    assert!(offset_of!(DeviceHealth, overflows) == 4 * LONG && offset_of!(DeviceHealth, refused) == 5 * LONG);
    assert!(size_of::<DeviceHealth>() == 6 * LONG);

    assert!(size_of::<Answer>() == ANSWER);
    assert!(size_of::<Answers>() == up(OLP_WINDOW_MAX * ANSWER + 2, align_of::<c_ulong>()));
    assert!(size_of::<DeviceLink>() == LINK);
    assert!(size_of::<Input>() == up(2 * INT + 1 + COMMAND_MAX, align_of::<c_int>()));
    assert!(
        size_of::<Device>() == up(pointer_up(LINK) + 2 * POINTER + INT + size_of::<Input>() + 5, align_of::<Device>())
    );
    assert!(OLP_ID_MAX as usize == ID_MAX);
};
