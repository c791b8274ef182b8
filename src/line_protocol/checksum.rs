//! Checksums.

use core::ffi::{c_int, c_uint, c_void};

use crate::memory::bytes_of;
use deltarobot_export::export;
use deltarobot_protocols::line;

/// The checksum of the protocol, Fletcher-16 in ones' complement: the second sum in bits 8 to 15, the first in bits 0
/// to 7. Both begin at 255, and neither is ever 0: of no bytes it is 0xFFFF, of a NULL pointer or a negative length
/// too.
///
/// ```c
/// printf("%04x\n", olp_fletcher16(line.text, line.length));
/// ```
#[export]
pub unsafe extern "C" fn olp_fletcher16(bytes: *const c_void, length: c_int) -> c_uint {
    // SAFETY: as the contract of this function asks.
    line::fletcher16(unsafe { bytes_of(bytes, length) }.unwrap_or_default()).into()
}

/// The checksum of bytes whose beginning has the checksum sum, as far as that has 16 bits: 0xFFFF when there is none.
/// It is sum itself when bytes is NULL or length not positive.
///
/// ```c
/// printf("%04x\n", olp_fletcher16_more(olp_fletcher16("c=go&", 5), "x=34", 4));
/// ```
#[export]
pub unsafe extern "C" fn olp_fletcher16_more(sum: c_uint, bytes: *const c_void, length: c_int) -> c_uint {
    let [low, high, ..] = sum.to_le_bytes();
    // SAFETY: as the contract of this function asks.
    let bytes = unsafe { bytes_of(bytes, length) }.unwrap_or_default();
    line::fletcher16_more(u16::from_le_bytes([low, high]), bytes).into()
}
