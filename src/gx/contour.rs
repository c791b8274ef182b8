//! Of `gx.h`: paths.

use core::ffi::{c_int, c_uchar, c_ulong, c_void};

use super::write::write;
use super::{GX_RC_ERROR_GENERIC, GX_RC_SUCCESS, Number, Vector};
use crate::state::{Room, state};
use deltarobot_export::export;
use deltarobot_protocols::gx::{self, AXES};

const CONTOUR_WORDS: usize = 64 / size_of::<c_ulong>();

/// Writes a path as the shortest stream of commands. All zero is a path of no axis. Its contents are private.
#[repr(C)]
#[derive(Debug)]
pub struct Contour {
    opaque: [c_ulong; CONTOUR_WORDS],
}
state!(Contour: gx::Contour);

/// Begins a path of the axes that the mask flags (other bits are ignored), where is not known. Any memory will do.
///
/// Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when contour is NULL or the mask flags no axis.
///
/// ```c
/// struct gx_contour contour;
/// gx_contour_init(&contour, 1 | 2 | 4);
/// gx_contour_start(&contour, &position);
/// ```
#[export]
pub unsafe extern "C" fn gx_contour_init(contour: *mut Contour, mask: c_uchar) -> c_int {
    // SAFETY: contour is NULL or writable.
    match unsafe { Room::init(contour) }.map(|contour| contour.set_axes(mask)) {
        Some(true) => GX_RC_SUCCESS,
        _ => GX_RC_ERROR_GENERIC,
    }
}

/// Sets where the machine is, and how fast it was ordered to move, as far as the mask of start says so; NULL: neither
/// is known, as after an error notice.
///
/// Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when contour is NULL.
///
/// ```c
/// if (item.kind == GX_REFUSED)
///     gx_contour_start(&contour, NULL);
/// ```
#[export]
pub unsafe extern "C" fn gx_contour_start(contour: *mut Contour, start: *const Vector) -> c_int {
    // SAFETY: two objects that do not overlap, or NULL.
    match unsafe { (Room::get(contour), start.as_ref()) } {
        (Some(contour), Some(start)) => contour.starts_at(start.core()),
        (Some(contour), None) => contour.forget(),
        _ => return GX_RC_ERROR_GENERIC,
    }
    GX_RC_SUCCESS
}

/// Writes the shortest command that leads to the next position of a path; `gx_follow` along these commands gives the
/// positions back, repeated ones too. position holds six values, of which those of the path's axes count; velocity is 0
/// to 16383, or negative: as before.
///
/// position is NULL or points to six values.
///
/// Returns what `gx_write_move` does; when that is negative, the path still ends where it did.
///
/// ```c
/// for (int i = 0; i < path_length; ++i)
///     if ((length = gx_contour_segment(&contour, NULL, path[i], -1, out, sizeof out)) > 0)
///         uart_write(&uart, out, length);
/// ```
#[export]
pub unsafe extern "C" fn gx_contour_segment(
    contour: *mut Contour,
    number: *const Number,
    position: *const i32,
    velocity: c_int,
    buf: *mut c_void,
    cap: c_int,
) -> c_int {
    // More than there are stays more.
    let velocity = if velocity < 0 { None } else { Some(u16::try_from(velocity).unwrap_or(u16::MAX)) };
    // SAFETY: pointers are NULL or valid, position's to six values, and cap is buf's size.
    unsafe {
        match (Room::get(contour), position.cast::<[i32; AXES]>().as_ref()) {
            (Some(contour), Some(position)) => {
                write(number, buf, cap, |number, room| contour.segment(number, position, velocity, room))
            }
            _ => -GX_RC_ERROR_GENERIC,
        }
    }
}
