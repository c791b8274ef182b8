//! The layouts of the structs whose fields C sees, as a list apart from their declarations: a field that changes its
//! place does so on purpose. The C tests assert the same list of the headers.

use core::ffi::{c_char, c_float, c_int, c_uchar, c_uint, c_ulong};

use super::sizes::{DP_BUFSIZE, DP_DATA_MAX_SIZE};
use super::{
    contouring_protocol, controller, gx, gx_host, gx_motion, host, kinematics, line_device, line_host, line_protocol,
    protocol,
};

/// A pointer to a function.
type Function = Option<unsafe extern "C" fn()>;

macro_rules! layouts {
    ($($(#[$attribute:meta])* $in_c:ident = $name:ty { $($field:ident: $type:ty),* $(,)? })*) => {$(
        $(#[$attribute])*
        const _: () = {
            #[repr(C)]
            #[allow(non_snake_case, dead_code, reason = "the original's names; for its layout alone")]
            struct Listed { $($field: $type),* }
            assert!(size_of::<Listed>() == size_of::<$name>() && align_of::<Listed>() == align_of::<$name>());
            $(assert!(core::mem::offset_of!(Listed, $field) == core::mem::offset_of!($name, $field));)*
        };
    )*};
}

layouts! {
    protocol_data = protocol::ProtocolData { m_buf: [c_char; DP_BUFSIZE], m_idx: c_int, m_sz: c_int }
    protocol_msg = protocol::ProtocolMsg {
        opcode: c_uchar, data_s: c_int, data: [c_char; DP_DATA_MAX_SIZE], checksum_ok: c_int,
    }
    protocol_msg_status_report = protocol::StatusReport { DA: c_float, DB: c_float, DC: c_float, STAT: c_uchar }
    protocol_msg_position = protocol::Position { DA: c_float, DB: c_float, DC: c_float }
    dp_host_settings = host::HostSettings {
        ack_ms: c_ulong, guard_ms: c_ulong, settle_ms: c_ulong, poll_ms: c_ulong, silence_ms: c_ulong,
        operation_ms: c_ulong, gap_ms: c_ulong, tolerance: c_float, attempts: c_int, layout: c_int, messages: c_int,
        duplicates: c_int,
    }
    dp_host_health = host::HostHealth {
        frames: c_ulong, malformed: c_ulong, strays: c_ulong, garbage_bytes: c_ulong, checksum_failures: c_ulong,
        timeouts: c_ulong, retransmissions: c_ulong, rtt_count: c_ulong, rtt_last: c_ulong, rtt_min: c_ulong,
        rtt_max: c_ulong, rtt_sum: c_ulong,
    }
    dp_host_event = host::event::HostEvent {
        kind: c_int, opcode: c_uchar, outcome: c_int, state: c_int, report: protocol::StatusReport,
        msg: protocol::ProtocolMsg,
    }
    dp_controller_calls = controller::Calls {
        home: Function, r#move: Function, cancel: Function, read: Function, send: Function,
    }

    #[cfg(all(any(unix, windows), feature = "serial"))]
    dp_serial_settings = super::serial::SerialSettings { baud: c_ulong, dtr: c_int, rts: c_int, keep_lines: c_int }
    dp_robot_configuration = kinematics::RobotConfiguration {
        A1: [c_float; 3], A2: [c_float; 3], A3: [c_float; 3], d_B1B3: c_float, d_e: c_float,
    }

    olp_message = line_protocol::LineMessage {
        line: *const c_char, length: c_int, count: c_int, checksum: c_int, sum: c_uint,
    }
    olp_param = line_protocol::LineParam {
        name: *const c_char, name_length: c_int, value: *const c_char, value_length: c_int,
    }
    olp_line = line_protocol::LineText { kind: c_int, text: *const c_char, length: c_int }

    olp_encoder = line_protocol::LineEncoder { buf: *const c_char, cap: c_int, length: c_int, error: c_int }
    olp_host_settings = line_host::HostSettings {
        timeout_ms: c_ulong, answer_ms: c_ulong, repeat_ms: c_ulong, repeats: c_int, recognises: c_int, baud: c_ulong,
        receive_room: c_int,
    }
    olp_host_link = line_host::HostLink { ack: c_int, checksum: c_int, windowsize: c_uint }
    olp_host_health = line_host::HostHealth {
        lines: c_ulong, strays: c_ulong, malformed: c_ulong, overlong: c_ulong, lost: c_ulong, errors: c_ulong,
        restarts: c_ulong, overflows: c_ulong, timeouts: c_ulong, repeats: c_ulong, rtt_count: c_ulong,
        rtt_last: c_ulong, rtt_min: c_ulong, rtt_max: c_ulong, rtt_sum: c_ulong,
    }
    olp_host_device = line_host::HostDevice {
        id: [c_char; 16], r#type: [c_char; 48], name: [c_char; 32], version: [c_char; 16], pos: c_int, cut: c_int,
    }
    olp_host_event = line_host::HostEvent {
        kind: c_int, handle: c_int, outcome: c_int, device: c_int, error: c_int, lost: c_int, link: line_host::HostLink,
        message: line_protocol::LineMessage,
    }
    olp_device_info = line_device::DeviceInfo {
        id: *const c_char, r#type: *const c_char, pos: c_int, name: *const c_char, version: *const c_char,
    }
    olp_command = line_device::Command { id: *const c_char, name: *const c_char, run: Function }
    olp_device_table = line_device::DeviceTable {
        devices: *const line_device::DeviceInfo, device_count: c_int, commands: *const line_device::Command,
        command_count: c_int, send: Function, repeat_ms: c_ulong,
    }
    olp_device_health = line_device::DeviceHealth {
        commands: c_ulong, repeats: c_ulong, checksums: c_ulong, malformed: c_ulong, overflows: c_ulong,
        refused: c_ulong,
    }

    gx_vector = gx::Vector { velocity: u16, mask: c_uchar, axes: [i32; 6] }
    gx_number = gx::Number { value: u16, format: c_uchar }
    gx_item = gx::Item {
        kind: c_int, number: gx::Number, format: c_uchar, code: c_uchar, period: u16, vector: gx::Vector,
    }
    gx_host_settings = gx_host::HostSettings {
        answer_ms: c_ulong, probe_ms: c_ulong, move_ms: c_ulong, gap_ms: c_ulong, attempts: c_int, window: c_int,
        ascii: c_int, first_number: c_int, absolute_every: c_int, echo: c_int,
    }
    gx_host_health = gx_host::HostHealth {
        moves: c_ulong, repeats: c_ulong, completions: c_ulong, errors: c_ulong, strays: c_ulong, reports: c_ulong,
        malformed: c_ulong, timeouts: c_ulong, sessions: c_ulong, deviations: c_ulong,
    }
    gx_host_event = gx_host::event::HostEvent {
        kind: c_int, outcome: c_int, code: c_int, number: c_int, position: gx::Vector,
    }
    gx_motion_settings = gx_motion::MotionSettings {
        gap_ms: c_ulong, host_ms: c_ulong, axes: c_int, only_in_order: c_int,
    }
    gx_motion_health = gx_motion::MotionHealth {
        moves: c_ulong, repeats: c_ulong, refused: c_ulong, malformed: c_ulong, reports: c_ulong,
    }
    gx_motion_event = gx_motion::MotionEvent { kind: c_int, number: c_int, code: c_int, period: c_int }

    CPVectorCommand = contouring_protocol::CPVectorCommand { targetVelocity: u16, axisMask: u8, axisPosition: [i32; 6] }
    CPPackedVectorCommandBuffer = contouring_protocol::CPPackedVectorCommandBuffer { length: u8, bytes: [u8; 28] }
}
