//! `host.h` and `controller.h` as a C program sees them.

use std::ffi::{c_int, c_long, c_uchar, c_ulong, c_void};

use crate::abi::{Msg, SendFunc};
/// What is private is used for its size alone.
pub use deltarobot::{deltarobot::host::Host, ffi::controller::Controller};

pub const OUTPUT_MAX: usize = 27;

#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct StatusReport {
    pub arms: [f32; 3],
    pub stat: c_uchar,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct HostSettings {
    pub ack_ms: c_ulong,
    pub guard_ms: c_ulong,
    pub settle_ms: c_ulong,
    pub poll_ms: c_ulong,
    pub silence_ms: c_ulong,
    pub operation_ms: c_ulong,
    pub gap_ms: c_ulong,
    pub tolerance: f32,
    pub attempts: c_int,
    pub layout: c_int,
    pub messages: c_int,
    pub doubles: c_int,
}

#[repr(C)]
#[derive(Clone, Debug, Default)]
pub struct HostEvent {
    pub kind: c_int,
    pub opcode: c_uchar,
    pub outcome: c_int,
    pub state: c_int,
    pub report: StatusReport,
    pub msg: Msg,
}

pub type StartFunc = unsafe extern "C" fn(*mut c_void) -> c_int;
pub type MoveFunc = unsafe extern "C" fn(*const [f32; 3], *mut c_void) -> c_int;
pub type ReadFunc = unsafe extern "C" fn(*mut StatusReport, *mut c_void);

#[repr(C)]
#[derive(Debug)]
pub struct Calls {
    pub home: Option<StartFunc>,
    pub r#move: Option<MoveFunc>,
    pub cancel: Option<StartFunc>,
    pub read: Option<ReadFunc>,
    pub send: Option<SendFunc>,
}

unsafe extern "C" {
    pub fn dp_host_init(host: *mut Host, settings: *const HostSettings) -> c_int;
    pub fn dp_host_home(host: *mut Host) -> c_int;
    pub fn dp_host_move(host: *mut Host, target: *const [f32; 3]) -> c_int;
    pub fn dp_host_cancel(host: *mut Host) -> c_int;
    pub fn dp_host_status(host: *mut Host) -> c_int;
    pub fn dp_host_receive(host: *mut Host, buf: *const c_void, bytes: c_int, now_ms: c_ulong) -> c_int;
    pub fn dp_host_poll(host: *mut Host, now_ms: c_ulong, event: *mut HostEvent) -> c_int;
    pub fn dp_host_output(host: *mut Host, buf: *mut c_void, cap: c_int, now_ms: c_ulong) -> c_int;
    pub fn dp_host_next_deadline(host: *const Host, now_ms: c_ulong) -> c_long;
    pub fn dp_host_busy(host: *const Host) -> c_int;
    pub fn dp_host_get_health(host: *const Host) -> *const c_ulong;

    pub fn dp_controller_init(
        controller: *mut Controller,
        calls: *const Calls,
        usr: *mut c_void,
        layout: c_int,
        flags: c_int,
    ) -> c_int;
    pub fn dp_controller_receive(controller: *mut Controller, buf: *const c_void, bytes: c_int) -> c_int;
    pub fn dp_controller_poll(controller: *mut Controller) -> c_int;
    pub fn dp_controller_poll_idle(controller: *mut Controller) -> c_int;
    pub fn dp_controller_report(controller: *mut Controller) -> c_int;
}
