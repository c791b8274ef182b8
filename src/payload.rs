//! `libdeltarobot/payload.h`: building, reading and printing the messages of the specification.

use core::ffi::c_int;
use core::mem::align_of;

use super::memory::{bytes_of, int};
use super::protocol::{Position, ProtocolMsg, StatusReport};
use crate::sizes::DP_DATA_MAX_SIZE;
use deltarobot_protocols::deltarobot as core_;
use deltarobot_protocols::deltarobot::{Layout, Report};

pub mod building;
pub mod reading;
pub mod text;

/// Reading a status report: one of more than 13 bytes has the floats first. 13 bytes may be either layout (firmware
/// like the shipped one sends so many on AVR); the reading counts in which more is plausible: STAT, when its reserved
/// bits (5 to 7) are alike; each float that is zero or of a magnitude from 1.1e-19 to 3.6e19; and twice as much each
/// that is unknown, 0x7F800001 or 0x7FC00000 with either sign. Of equal ones it is floats first. A session of `host.h`
/// takes the layout of the last report that was clear (of 14 bytes or more, or better by two), unless this one is too.
/// Writing one: as `DP_LAYOUT_FIRMWARE`.
pub const DP_LAYOUT_AUTO: c_int = 0;
/// Status reports as in specification v1.0: STAT, DA, DB, DC; exactly 13 bytes.
pub const DP_LAYOUT_SPEC: c_int = 1;
/// Status reports as shipped firmware sends them: DA, DB, DC, STAT, 3 bytes, written as 0; read from 13 bytes on.
pub const DP_LAYOUT_FIRMWARE: c_int = 2;

// A position of C's is read and written as three u32, the bits of its floats.
const _: () = assert!(align_of::<u32>() == align_of::<Position>() && size_of::<[u32; 3]>() == size_of::<Position>());

/// The payload of a message; `None` when its size is out of range.
///
/// # Safety
///
/// msg points to a message, which nobody writes while the slice lives.
unsafe fn payload_of<'a>(msg: *const ProtocolMsg) -> Option<&'a [u8]> {
    // SAFETY: a message can be read.
    let length = unsafe { (*msg).data_s };
    if length > const { int(DP_DATA_MAX_SIZE) } {
        return None;
    }
    // SAFETY: data has at least so many bytes, and the contract is that of the slice.
    unsafe { bytes_of((&raw const (*msg).data).cast(), length) }
}

/// The layout that a `DP_LAYOUT_*` means.
pub(super) const fn layout_of(layout: c_int) -> Option<Layout> {
    match layout {
        DP_LAYOUT_AUTO => Some(Layout::Auto),
        DP_LAYOUT_SPEC => Some(Layout::Spec),
        DP_LAYOUT_FIRMWARE => Some(Layout::Firmware),
        _ => None,
    }
}

/// Takes a position over from C, as bits: a signalling NaN would not survive being loaded as a float.
///
/// # Safety
///
/// position is NULL or points to one.
pub(super) unsafe fn position_from(position: *const Position) -> Option<core_::Position> {
    // SAFETY: three floats have the layout of three u32 (asserted above), and any bits are a u32.
    unsafe { position.cast::<[u32; 3]>().as_ref() }.map(|bits| core_::Position(*bits))
}

/// Hands a position to C, as bits.
///
/// # Safety
///
/// out points to a writable position.
pub(super) unsafe fn position_to(out: *mut Position, position: core_::Position) {
    // SAFETY: three floats have the layout of three u32, and any bits are a float.
    unsafe { out.cast::<[u32; 3]>().write(position.0) };
}

/// Takes a status report over from C.
///
/// # Safety
///
/// report is NULL or points to one.
pub(super) unsafe fn report_from(report: *const StatusReport) -> Option<Report> {
    // SAFETY: a report begins with what a position consists of; it is read only when it is not NULL.
    unsafe { position_from(report.cast()).map(|position| Report::new(position, (*report).STAT)) }
}

/// Hands a status report to C.
///
/// # Safety
///
/// out points to a writable status report.
pub(super) unsafe fn report_to(out: *mut StatusReport, report: &Report) {
    // SAFETY: a report begins with what a position consists of.
    unsafe {
        position_to(out.cast(), report.position);
        (*out).STAT = report.stat();
    }
}
