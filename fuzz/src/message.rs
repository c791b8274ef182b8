//! Messages and rings of the C ABI, as a contract sees them.

use std::ffi::{c_char, c_int, c_uchar};

use deltarobot::protocol::{ProtocolData, ProtocolMsg};
use deltarobot::sizes::{DP_BUFSIZE, DP_DATA_MAX_SIZE};

/// A ring whose first byte will be at `idx`.
#[must_use]
pub fn empty_ring(idx: usize) -> Box<ProtocolData> {
    Box::new(ProtocolData { m_buf: [0; DP_BUFSIZE], m_idx: idx as c_int, m_sz: 0 })
}

/// Whether a ring's fields are in the range that the header promises.
#[must_use]
pub fn is_sound(ring: &ProtocolData) -> bool {
    (0..DP_BUFSIZE as c_int).contains(&ring.m_idx) && (0..=DP_BUFSIZE as c_int).contains(&ring.m_sz)
}

/// A ring's unread bytes; of one that is not sound, none.
#[must_use]
pub fn unread(ring: &ProtocolData) -> Vec<u8> {
    if !is_sound(ring) {
        return Vec::new();
    }
    (0..ring.m_sz as usize).map(|at| ring.m_buf[(ring.m_idx as usize + at) % DP_BUFSIZE] as u8).collect()
}

#[must_use]
pub fn payload(msg: &ProtocolMsg) -> Vec<u8> {
    msg.data[..usize::try_from(msg.data_s).unwrap()].iter().map(|&byte| byte as u8).collect()
}

type Fields = (c_uchar, c_int, [c_char; DP_DATA_MAX_SIZE], c_int);

/// A message without its padding.
#[must_use]
pub fn fields(msg: &ProtocolMsg) -> Fields {
    (msg.opcode, msg.data_s, msg.data, msg.checksum_ok)
}
