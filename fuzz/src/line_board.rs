//! A device of the line protocol: its table, and what the table's functions do, which is what the input says.

use std::collections::VecDeque;
use std::ffi::{CStr, c_char, c_int, c_long, c_ulong, c_void};
use std::ptr::null;

use deltarobot::line_device::*;
use deltarobot::line_protocol::encoder::*;
use deltarobot::line_protocol::message::olp_param_at;
use deltarobot::line_protocol::{LineEncoder, LineMessage, LineParam};
use deltarobot::sizes::OLP_REPLY_MAX;

use crate::input::Input;
use crate::link::Line;
use crate::object::Plain;

pub const COMMAND_MAX: usize = 64;
/// Bytes of the longest line that a device receives, and its end.
const RECEIVED_MAX: usize = 80;
pub const IDS: [&CStr; 5] = [c"sf6z34", c"9o5qzg", c"a.b_c-d", c"nobody", c"%&= \xC3"];

/// What the functions of a device's table work with.
pub struct Board {
    pub device: *mut Device,
    pub now: c_ulong,
    pub sent: Line,
    /// What they do besides, one after the other.
    pub deeds: VecDeque<u8>,
    depth: u8,
    /// Whether the device's memory is as the library left it.
    pub sound: bool,
}

impl Board {
    pub fn new(device: *mut Device, now: c_ulong) -> Box<Self> {
        Box::new(Self { device, now, sent: Line::new(), deeds: VecDeque::new(), depth: 0, sound: true })
    }

    pub fn usr(&mut self) -> *mut c_void {
        (&raw mut *self).cast()
    }
}

/// A table, and what it points to.
pub struct Table {
    _infos: Vec<DeviceInfo>,
    _commands: Vec<Command>,
    table: Box<DeviceTable>,
}

impl Table {
    pub fn new(input: &mut Input) -> Self {
        let infos: Vec<_> = [(IDS[0], 0, null()), (IDS[1], 1, c"A name, 100 %".as_ptr()), (IDS[2], -7, c"".as_ptr())]
            .map(|(id, pos, name)| DeviceInfo { id: id.as_ptr(), r#type: c"Kind".as_ptr(), pos, name, version: name })
            .into();
        let command = |id, name: &CStr, run: RunFunc| Command { id, name: name.as_ptr(), run };
        let commands = vec![
            command(IDS[1].as_ptr(), c"setswitch", Some(run)),
            command(null(), c"get", Some(run)),
            command(null(), c"again", Some(run)),
            command(null(), c"refused", None),
        ];
        let table = Box::new(DeviceTable {
            devices: infos.as_ptr(),
            device_count: 1 + c_int::from(input.byte() % 3),
            commands: commands.as_ptr(),
            command_count: 4,
            send: Some(send),
            repeat_ms: c_ulong::from(input.byte()) * 20,
        });
        Self { _infos: infos, _commands: commands, table }
    }

    pub fn ptr(&self) -> *const DeviceTable {
        &raw const *self.table
    }
}

/// An event with a number in it, in room for `how` bytes.
///
/// # Safety
///
/// The device is one.
pub unsafe fn an_event(device: *mut Device, how: u8, id: &[u8]) {
    let mut room = vec![0x55_u8; usize::from(how)].into_boxed_slice();
    let mut event = LineEncoder::zero();
    unsafe {
        olp_begin(&raw mut event, room.as_mut_ptr().cast(), room.len() as c_int, c"info".as_ptr());
        olp_add_int(&raw mut event, c"n".as_ptr(), c_long::from(how) << (how % 24));
        let rc = olp_device_event(device, &raw mut event, id.as_ptr().cast::<c_char>());
        assert!([0, 1, 5, 9].contains(&rc), "{rc}");
    }
}

/// What the functions of a table may do, besides what they are for.
unsafe fn do_more(board: *mut Board) {
    unsafe {
        let device = (*board).device;
        if (*board).depth >= 4 {
            return;
        }
        let Some(deed) = (*board).deeds.pop_front() else { return };
        (*board).depth += 1;
        let line = b"c=get&id=9o5qzg&t=5\n";
        match deed % 8 {
            0 => drop(olp_device_restart(device)),
            1 => drop(olp_device_linksetup(device, 1, c_int::from(deed & 8), 1)),
            2 => {
                let taken = olp_device_receive(device, line.as_ptr().cast(), line.len() as c_int, (*board).now);
                assert!((0..=line.len() as c_int).contains(&taken));
            }
            3 => {
                let rc = olp_device_poll(device, (*board).now);
                assert!([0, 5, 6].contains(&rc) || !(*board).sound, "{rc}");
            }
            4 => an_event(device, deed, IDS[1].to_bytes_with_nul()),
            _ => (),
        }
        (*board).depth -= 1;
    }
}

unsafe extern "C" fn send(line: *const c_void, bytes: c_int, usr: *mut c_void) -> c_int {
    let board: *mut Board = usr.cast();
    unsafe {
        let line = std::slice::from_raw_parts(line.cast::<u8>(), usize::try_from(bytes).unwrap());
        if (*board).sound {
            assert!(line.len() <= OLP_REPLY_MAX.max(255) && line.starts_with(b"c="));
            assert_eq!(line.iter().position(|byte| *byte == b'\n'), Some(line.len() - 1));
        }
        (*board).sent.extend(line);
        do_more(board);
    }
    bytes
}

unsafe extern "C" fn run(command: *const LineMessage, answer: *mut LineEncoder, usr: *mut c_void) -> c_int {
    let board: *mut Board = usr.cast();
    unsafe {
        let line = std::slice::from_raw_parts((*command).line.cast::<u8>(), (*command).length as usize);
        assert!(line.len() < RECEIVED_MAX && (*command).count > 0);
        for index in 0..(*command).count {
            let mut param = LineParam::zero();
            assert_eq!(olp_param_at(command, index, &raw mut param), 0);
            olp_add_raw(answer, c"p".as_ptr(), param.value, param.value_length);
        }
        let deed = (*board).deeds.front().copied().unwrap_or_default();
        if deed >= 0x80 {
            let text = vec![b'&'; usize::from(deed)].into_boxed_slice();
            olp_add_bytes(answer, c"text".as_ptr(), text.as_ptr().cast(), text.len() as c_int);
        }
        do_more(board);
        c_int::from(deed & 0x40)
    }
}
