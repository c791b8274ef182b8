//! The Ozeki line protocol, declared as `include/libdeltarobot/line_*.h` do.

use std::ffi::{c_char, c_float, c_int, c_long, c_uint, c_ulong, c_void};
use std::ptr::{null, null_mut};

pub use deltarobot::config::{OLP_DEVICES_MAX, OLP_LINE_MAX, OLP_REPLY_MAX, OLP_WINDOW_MAX};
/// What is private is used for its size alone.
pub use deltarobot::ffi::line_device::Device;
pub use deltarobot::line::host::Host;

pub const MALFORMED: c_int = 8;
pub const TOO_LONG: c_int = 9;
pub const RANGE: c_int = 10;
pub const NOT_FOUND: c_int = 11;
pub const NO_COMMAND: c_int = 12;

#[repr(C)]
pub struct Message {
    pub line: *const c_char,
    pub length: c_int,
    pub count: c_int,
    pub checksum: c_int,
    pub sum: c_uint,
}

#[repr(C)]
pub struct Param {
    pub name: *const c_char,
    pub name_length: c_int,
    pub value: *const c_char,
    pub value_length: c_int,
}

#[repr(C)]
pub struct Line {
    pub kind: c_int,
    pub text: *const c_char,
    pub length: c_int,
}

#[repr(C)]
pub struct Encoder {
    pub buf: *mut c_char,
    pub cap: c_int,
    pub length: c_int,
    pub error: c_int,
}

#[repr(C)]
pub struct Receiver {
    pub used: c_int,
    pub overlong: c_int,
    pub line: [u8; OLP_LINE_MAX + 1],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct HostSettings {
    pub timeout_ms: c_ulong,
    pub answer_ms: c_ulong,
    pub repeat_ms: c_ulong,
    pub repeats: c_int,
    pub recognises: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Link {
    pub ack: c_int,
    pub checksum: c_int,
    pub windowsize: c_uint,
}

#[repr(C)]
#[derive(Default)]
pub struct HostEvent {
    pub kind: c_int,
    pub handle: c_int,
    pub outcome: c_int,
    pub device: c_int,
    pub error: c_int,
    pub lost: c_int,
    pub link: Link,
    pub message: Message,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct HostDevice {
    pub id: [u8; 16],
    pub kind: [u8; 48],
    pub name: [u8; 32],
    pub version: [u8; 16],
    pub pos: c_int,
    pub cut: c_int,
}

#[repr(C)]
pub struct DeviceInfo {
    pub id: *const c_char,
    pub kind: *const c_char,
    pub pos: c_int,
    pub name: *const c_char,
    pub version: *const c_char,
}

pub type RunFunc = unsafe extern "C" fn(*const Message, *mut Encoder, *mut c_void) -> c_int;
pub type SendFunc = unsafe extern "C" fn(*const c_void, c_int, *mut c_void) -> c_int;

#[repr(C)]
pub struct Command {
    pub id: *const c_char,
    pub name: *const c_char,
    pub run: Option<RunFunc>,
}

#[repr(C)]
pub struct DeviceTable {
    pub devices: *const DeviceInfo,
    pub device_count: c_int,
    pub commands: *const Command,
    pub command_count: c_int,
    pub send: Option<SendFunc>,
    pub repeat_ms: c_ulong,
}

impl Default for Message {
    fn default() -> Self {
        Self { line: null(), length: -1, count: -1, checksum: -1, sum: 77 }
    }
}

impl Default for Param {
    fn default() -> Self {
        Self { name: null(), name_length: -1, value: null(), value_length: -1 }
    }
}

impl Default for Encoder {
    fn default() -> Self {
        Self { buf: null_mut(), cap: -1, length: -1, error: -1 }
    }
}

impl Default for Receiver {
    fn default() -> Self {
        Self { used: 0, overlong: 0, line: [0; OLP_LINE_MAX + 1] }
    }
}

unsafe extern "C" {
    pub fn olp_parse(line: *const c_char, length: c_int, message: *mut Message) -> c_int;
    pub fn olp_param_at(message: *const Message, index: c_int, param: *mut Param) -> c_int;
    pub fn olp_find(message: *const Message, name: *const c_char, occurrence: c_int, param: *mut Param) -> c_int;
    pub fn olp_value_int(param: *const Param, value: *mut c_long) -> c_int;
    pub fn olp_value_float(param: *const Param, value: *mut c_float) -> c_int;
    pub fn olp_value_string(param: *const Param, buf: *mut c_char, cap: c_int) -> c_int;
    pub fn olp_value_is(param: *const Param, text: *const c_char) -> c_int;
    pub fn olp_begin(encoder: *mut Encoder, buf: *mut c_char, cap: c_int, command: *const c_char) -> c_int;
    pub fn olp_begin_command(encoder: *mut Encoder, buf: *mut c_char, cap: c_int, command: *const c_char) -> c_int;
    pub fn olp_add_bytes(encoder: *mut Encoder, name: *const c_char, text: *const c_void, length: c_int) -> c_int;
    pub fn olp_add_raw(encoder: *mut Encoder, name: *const c_char, value: *const c_char, length: c_int) -> c_int;
    pub fn olp_add_int(encoder: *mut Encoder, name: *const c_char, value: c_long) -> c_int;
    pub fn olp_add_float(encoder: *mut Encoder, name: *const c_char, value: c_float, decimals: c_int) -> c_int;
    pub fn olp_add_hex(encoder: *mut Encoder, name: *const c_char, value: c_uint) -> c_int;
    pub fn olp_finish(encoder: *mut Encoder, checksum: c_int) -> c_int;
    pub fn olp_receive(receiver: *mut Receiver, buf: *const c_void, bytes: c_int, line: *mut Line) -> c_int;

    pub fn olp_host_init(host: *mut Host, settings: *const HostSettings) -> c_int;
    pub fn olp_host_setup(host: *mut Host, id: *const c_char, ack: c_int, checksum: c_int, windowsize: c_long)
    -> c_int;
    pub fn olp_host_send(host: *mut Host, command: *const c_char, length: c_int, id: *const c_char) -> c_int;
    pub fn olp_host_receive(host: *mut Host, buf: *const c_void, bytes: c_int, now_ms: c_ulong) -> c_int;
    pub fn olp_host_poll(host: *mut Host, now_ms: c_ulong, event: *mut HostEvent) -> c_int;
    pub fn olp_host_output(host: *mut Host, buf: *mut c_void, cap: c_int, now_ms: c_ulong) -> c_int;
    pub fn olp_host_next_deadline(host: *const Host, now_ms: c_ulong) -> c_long;
    pub fn olp_host_get_link(host: *const Host, link: *mut Link) -> c_int;
    pub fn olp_host_get_device(host: *const Host, index: c_int, device: *mut HostDevice) -> c_int;
    pub fn olp_host_get_health(host: *const Host) -> *const c_ulong;

    pub fn olp_device_init(device: *mut Device, table: *const DeviceTable, usr: *mut c_void) -> c_int;
    pub fn olp_device_restart(device: *mut Device) -> c_int;
    pub fn olp_device_linksetup(device: *mut Device, ack: c_int, checksum: c_int, window: c_int) -> c_int;
    pub fn olp_device_receive(device: *mut Device, buf: *const c_void, bytes: c_int, now_ms: c_ulong) -> c_int;
    pub fn olp_device_poll(device: *mut Device, now_ms: c_ulong) -> c_int;
    pub fn olp_device_event(device: *mut Device, event: *mut Encoder, id: *const c_char) -> c_int;
    pub fn olp_device_get_health(device: *const Device) -> *const c_ulong;
}
