//! `gx.h`, `gx_host.h`, `gx_motion.h` and `ContouringProtocol.h` as a C program sees them.

use std::ffi::{c_int, c_long, c_ulong, c_void};

pub use deltarobot::config::{GX_QUEUE_MAX, GX_WINDOW_MAX};
/// What is private is used for its size alone.
pub use deltarobot::gx::{host::Host, motion::Motion};

#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Vector {
    pub velocity: u16,
    pub mask: u8,
    pub axes: [i32; 6],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Number {
    pub value: u16,
    pub format: u8,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Item {
    pub kind: c_int,
    pub number: Number,
    pub format: u8,
    pub code: u8,
    pub period: u16,
    pub vector: Vector,
}

/// `struct gx_commands` or `struct gx_notices`.
#[repr(C, align(4))]
#[derive(Clone, Debug, Default)]
pub struct Receiver(pub [[u8; 20]; 2]);

/// `struct gx_contour`.
#[repr(C, align(4))]
#[derive(Clone, Debug, Default)]
pub struct Contour(pub [[u8; 28]; 2]);

#[repr(C)]
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Buffer {
    pub length: u8,
    pub bytes: [u8; 28],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct HostSettings {
    pub answer_ms: c_ulong,
    pub probe_ms: c_ulong,
    pub move_ms: c_ulong,
    pub gap_ms: c_ulong,
    pub attempts: c_int,
    pub window: c_int,
    pub ascii: c_int,
    pub first_number: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct HostEvent {
    pub kind: c_int,
    pub outcome: c_int,
    pub code: c_int,
    pub number: c_int,
    pub position: Vector,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct MotionSettings {
    pub gap_ms: c_ulong,
    pub axes: c_int,
    pub only_in_order: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct MotionEvent {
    pub kind: c_int,
    pub number: c_int,
    pub code: c_int,
    pub period: c_int,
}

pub const NONE: c_int = 0;
pub const MOVE: c_int = 1;
pub const STEP: c_int = 2;
pub const REPORTING: c_int = 3;
pub const MALFORMED: c_int = 4;
pub const COMPLETED: c_int = 5;
pub const REFUSED: c_int = 6;
pub const POSITION: c_int = 7;

/// Room for anything.
pub const ENCODED_MAX: usize = 96;

#[allow(clashing_extern_declarations, reason = "receivers of both ends are the same bytes")]
unsafe extern "C" {
    pub fn gx_commands_receive(receiver: *mut Receiver, buf: *const c_void, bytes: c_int, item: *mut Item) -> c_int;
    pub fn gx_commands_idle(receiver: *mut Receiver, item: *mut Item) -> c_int;
    pub fn gx_notices_receive(receiver: *mut Receiver, buf: *const c_void, bytes: c_int, item: *mut Item) -> c_int;
    pub fn gx_notices_idle(receiver: *mut Receiver, item: *mut Item) -> c_int;
    pub fn gx_follow(position: *mut Vector, item: *const Item) -> c_int;
    pub fn gx_write_move(
        format: c_int,
        number: *const Number,
        target: *const Vector,
        buf: *mut c_void,
        cap: c_int,
    ) -> c_int;
    pub fn gx_write_step(number: *const Number, deltas: *const Vector, buf: *mut c_void, cap: c_int) -> c_int;
    pub fn gx_write_reporting(
        format: c_int,
        number: *const Number,
        period: c_int,
        buf: *mut c_void,
        cap: c_int,
    ) -> c_int;
    pub fn gx_write_completed(number: *const Number, buf: *mut c_void, cap: c_int) -> c_int;
    pub fn gx_write_refused(format: c_int, number: *const Number, code: c_int, buf: *mut c_void, cap: c_int) -> c_int;
    pub fn gx_write_position(format: c_int, position: *const Vector, buf: *mut c_void, cap: c_int) -> c_int;
    pub fn gx_contour_init(contour: *mut Contour, mask: u8) -> c_int;
    pub fn gx_contour_start(contour: *mut Contour, start: *const Vector) -> c_int;
    pub fn gx_contour_segment(
        contour: *mut Contour,
        number: *const Number,
        position: *const i32,
        velocity: c_int,
        buf: *mut c_void,
        cap: c_int,
    ) -> c_int;
    pub fn PackCPVectorCommand(buffer: *mut Buffer, command: *mut Vector) -> c_int;
    pub fn UnpackCPVectorCommand(buffer: *mut Buffer, command: *mut Vector) -> c_int;
    pub fn PackCPShortVectorCommand(buffer: *mut Buffer, command: *mut Vector) -> c_int;
    pub fn UnpackCPShortVectorCommand(buffer: *mut Buffer, command: *mut Vector) -> c_int;

    pub fn gx_host_init(host: *mut Host, settings: *const HostSettings) -> c_int;
    pub fn gx_host_move(host: *mut Host, target: *const i32, axes: c_int, velocity: c_int) -> c_int;
    pub fn gx_host_report(host: *mut Host, period_ms: c_int) -> c_int;
    pub fn gx_host_receive(host: *mut Host, buf: *const c_void, bytes: c_int, now_ms: c_ulong) -> c_int;
    pub fn gx_host_poll(host: *mut Host, now_ms: c_ulong, event: *mut HostEvent) -> c_int;
    pub fn gx_host_output(host: *mut Host, buf: *mut c_void, cap: c_int, now_ms: c_ulong) -> c_int;
    pub fn gx_host_next_deadline(host: *const Host, now_ms: c_ulong) -> c_long;
    pub fn gx_host_unfinished(host: *const Host) -> c_int;
    pub fn gx_host_get_health(host: *const Host) -> *const c_ulong;

    pub fn gx_motion_init(motion: *mut Motion, settings: *const MotionSettings) -> c_int;
    pub fn gx_motion_receive(motion: *mut Motion, buf: *const c_void, bytes: c_int, now_ms: c_ulong) -> c_int;
    pub fn gx_motion_poll(motion: *mut Motion, now_ms: c_ulong, event: *mut MotionEvent) -> c_int;
    pub fn gx_motion_next(motion: *mut Motion, target: *mut Vector, number: *mut c_int) -> c_int;
    pub fn gx_motion_done(motion: *mut Motion) -> c_int;
    pub fn gx_motion_stop(motion: *mut Motion, code: c_int) -> c_int;
    pub fn gx_motion_set_position(motion: *mut Motion, position: *const i32) -> c_int;
    pub fn gx_motion_output(motion: *mut Motion, buf: *mut c_void, cap: c_int, now_ms: c_ulong) -> c_int;
    pub fn gx_motion_next_deadline(motion: *const Motion, now_ms: c_ulong) -> c_long;
    pub fn gx_motion_unfinished(motion: *const Motion) -> c_int;
    pub fn gx_motion_get_health(motion: *const Motion) -> *const c_ulong;
}
