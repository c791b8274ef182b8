//! The C ABI, declared as `include/libdeltarobot/*.h` do.

use std::ffi::{c_char, c_int, c_uchar, c_void};

pub use deltarobot::config::{DP_BUFSIZE, DP_DATA_MAX_SIZE};

pub const SUCCESS: c_int = 0;
pub const ERROR_GENERIC: c_int = 1;
pub const NO_FRAME: c_int = 2;
pub const OVERFLOW: c_int = 3;
pub const GARBAGE: c_int = 4;

#[derive(Clone, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Data {
    pub buf: [u8; DP_BUFSIZE],
    pub idx: c_int,
    pub sz: c_int,
}

#[derive(Clone, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Msg {
    pub opcode: c_uchar,
    pub data_s: c_int,
    pub data: [c_char; DP_DATA_MAX_SIZE],
    pub checksum_ok: c_int,
}

pub type SendFunc = unsafe extern "C" fn(*mut c_void, c_int, *mut c_void) -> c_int;
pub type MsgFunc = unsafe extern "C" fn(*const Msg, *mut c_void) -> c_int;

unsafe extern "C" {
    pub fn dp_process(data: *mut Data, buf: *mut c_void, bytes: c_int) -> c_int;
    pub fn dp_recv(data: *mut Data, msg: *mut Msg) -> c_int;
    pub fn dp_recv_idle(data: *mut Data, msg: *mut Msg) -> c_int;
    pub fn dp_send(msg: *mut Msg, sendfunc: Option<SendFunc>, usr: *mut c_void) -> c_int;
    pub fn dp_process_each(
        data: *mut Data,
        buf: *const c_void,
        bytes: c_int,
        on_msg: Option<MsgFunc>,
        usr: *mut c_void,
    ) -> c_int;
    pub fn dp_init(data: *mut Data) -> c_int;
}

impl Data {
    pub const fn new() -> Self {
        Self { buf: [0; DP_BUFSIZE], idx: 0, sz: 0 }
    }

    /// Whether the fields are in the range that the header promises.
    pub fn is_sound(&self) -> bool {
        (0..DP_BUFSIZE as c_int).contains(&self.idx) && (0..=DP_BUFSIZE as c_int).contains(&self.sz)
    }

    /// The unread bytes; of a ring that is not sound, none.
    pub fn unread(&self) -> Vec<u8> {
        if !self.is_sound() {
            return Vec::new();
        }
        (0..self.sz as usize).map(|at| self.buf[(self.idx as usize + at) % DP_BUFSIZE]).collect()
    }
}

impl Default for Data {
    fn default() -> Self {
        Self::new()
    }
}

impl Msg {
    pub const fn new() -> Self {
        Self { opcode: 0, data_s: 0, data: [0; DP_DATA_MAX_SIZE], checksum_ok: 0 }
    }

    pub fn payload(&self) -> Vec<u8> {
        self.data[..usize::try_from(self.data_s).unwrap()].iter().map(|&byte| byte as u8).collect()
    }
}

impl Default for Msg {
    fn default() -> Self {
        Self::new()
    }
}
