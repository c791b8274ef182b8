//! The layout that C compilers give the structs of `line_host.h`; C tests assert the same numbers.

use core::ffi::{c_int, c_uchar, c_uint, c_ulong, c_ushort};
use core::mem::{align_of, offset_of, size_of};

use super::event::LineHostEvent;
use super::{OLP_HOST_ID_MAX, OLP_HOST_NAME_MAX, OLP_HOST_TYPE_MAX, OLP_HOST_VERSION_MAX};
use crate::line_protocol::LineMessage;
use crate::sizes::{OLP_DEVICES_MAX, OLP_WINDOW_MAX};
use deltarobot_protocols::line::Receiver;
use deltarobot_protocols::line::host::{Counter, Device, Devices, Health, Host, ID_MAX, Link, NAME_MAX, Recent};
use deltarobot_protocols::line::host::{Session, Settings, Slot, TYPE_MAX, VERSION_MAX};

#[expect(clippy::arithmetic_side_effects, reason = "done by the compiler")]
const _: () = {
    const INT: usize = size_of::<c_int>();
    const LONG: usize = size_of::<c_ulong>();
    const ALIGN: usize = align_of::<c_ulong>();
    const SHORT: usize = align_of::<c_ushort>();
    const fn up(size: usize, align: usize) -> usize {
        size.next_multiple_of(align)
    }
    const COUNTER: usize = 64 * size_of::<Recent>() + INT + 4;
    const SLOT: usize = up(2 * LONG + 5 * INT + size_of::<c_ushort>() + 8 + 54, ALIGN);
    const DEVICE: usize = ID_MAX + TYPE_MAX + NAME_MAX + VERSION_MAX + 4 + 2 * INT;
    const SESSION: usize = size_of::<Settings>() + size_of::<Health>() + LONG;

    assert!(offset_of!(Settings, timeout_ms) == 0 && offset_of!(Settings, answer_ms) == LONG);
    assert!(offset_of!(Settings, repeat_ms) == 2 * LONG && offset_of!(Settings, repeats) == 3 * LONG);
    assert!(offset_of!(Settings, recognises) == 3 * LONG + INT);
    assert!(size_of::<Settings>() == up(3 * LONG + 2 * INT, ALIGN));
    assert!(offset_of!(Link, ack) == 0 && offset_of!(Link, checksum) == INT);
    assert!(offset_of!(Link, windowsize) == 2 * INT && size_of::<Link>() == 2 * INT + size_of::<c_uint>());
    assert!(offset_of!(Health, lines) == 0 && offset_of!(Health, strays) == LONG);
    assert!(offset_of!(Health, malformed) == 2 * LONG && offset_of!(Health, overlong) == 3 * LONG);
    assert!(offset_of!(Health, lost) == 4 * LONG && offset_of!(Health, errors) == 5 * LONG);
    assert!(offset_of!(Health, restarts) == 6 * LONG && offset_of!(Health, overflows) == 7 * LONG);
    assert!(offset_of!(Health, timeouts) == 8 * LONG && offset_of!(Health, repeats) == 9 * LONG);
    assert!(offset_of!(Health, rtt_count) == 10 * LONG && offset_of!(Health, rtt_last) == 11 * LONG);
    assert!(offset_of!(Health, rtt_min) == 12 * LONG && offset_of!(Health, rtt_max) == 13 * LONG);
    assert!(offset_of!(Health, rtt_sum) == 14 * LONG && size_of::<Health>() == 15 * LONG);
    assert!(offset_of!(Device, id) == 0 && offset_of!(Device, r#type) == ID_MAX + 1);
    assert!(offset_of!(Device, name) == ID_MAX + TYPE_MAX + 2);
    assert!(offset_of!(Device, version) == ID_MAX + TYPE_MAX + NAME_MAX + 3);
    assert!(offset_of!(Device, pos) == DEVICE - 2 * INT && offset_of!(Device, cut) == DEVICE - INT);
    assert!(size_of::<Device>() == DEVICE);
    assert!(size_of::<Devices>() == up(OLP_DEVICES_MAX * (DEVICE + size_of::<c_uchar>()), INT) + INT);
    assert!(size_of::<Recent>() == size_of::<c_ushort>() + 2 && size_of::<Counter>() == COUNTER);
    assert!(size_of::<Slot>() == SLOT);
    assert!(
        size_of::<Session>()
            == up(
                up(up(SESSION + size_of::<Link>() + 9 * INT + 5 + COUNTER, SHORT), ALIGN)
                    + OLP_WINDOW_MAX * SLOT
                    + size_of::<Devices>(),
                ALIGN
            )
    );
    assert!(size_of::<Host>() == up(up(size_of::<Receiver>(), ALIGN) + size_of::<Session>(), ALIGN));

    assert!(offset_of!(LineHostEvent, kind) == 0 && offset_of!(LineHostEvent, handle) == INT);
    assert!(offset_of!(LineHostEvent, outcome) == 2 * INT && offset_of!(LineHostEvent, device) == 3 * INT);
    assert!(offset_of!(LineHostEvent, error) == 4 * INT && offset_of!(LineHostEvent, lost) == 5 * INT);
    assert!(offset_of!(LineHostEvent, link) == 6 * INT);
    assert!(
        offset_of!(LineHostEvent, message) == up(6 * INT + size_of::<Link>(), align_of::<LineMessage>())
            && size_of::<LineHostEvent>() == offset_of!(LineHostEvent, message) + size_of::<LineMessage>()
    );
    assert!(OLP_HOST_ID_MAX as usize == ID_MAX && OLP_HOST_TYPE_MAX as usize == TYPE_MAX);
    assert!(OLP_HOST_NAME_MAX as usize == NAME_MAX && OLP_HOST_VERSION_MAX as usize == VERSION_MAX);
};
