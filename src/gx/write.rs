//! Of `gx.h`: what writes commands and notices, and paths of them.

use core::ffi::{c_int, c_uchar, c_ulong, c_void};

use super::{
    GX_ASCII, GX_BINARY, GX_RC_ERROR_GENERIC, GX_RC_OVERFLOW, GX_RC_RANGE, GX_RC_SUCCESS, Number, Vector, control_of,
    room,
};
use crate::memory::int;
use crate::state::{Room, state};
use deltarobot_export::export;
use deltarobot_protocols::gx::{self, AXES, EncodeError, Format, Status, Written};

/// Writes a vector of positions: `GX_BINARY`, the long form, or `GX_ASCII`. number goes in front of it unless it is
/// NULL or its format is 0.
///
/// Returns its length in bytes, at most `GX_ENCODED_MAX`; or -`GX_RC_RANGE` when a value or the mask does not fit,
/// -`GX_RC_OVERFLOW` when the room is too small, -`GX_RC_ERROR_GENERIC` when target is NULL or has an empty mask, a
/// format is none, buf is NULL or cap negative. The room's contents are then not to be used.
///
/// ```c
/// const struct gx_vector target = {500, 1 | GX_MASK_VELOCITY, {1000, 0, 0, 0, 0, 0}};
/// if ((length = gx_write_move(GX_BINARY, NULL, &target, out, sizeof out)) > 0)
///     uart_write(&uart, out, length);
/// ```
#[export]
pub unsafe extern "C" fn gx_write_move(
    format: c_int,
    number: *const Number,
    target: *const Vector,
    buf: *mut c_void,
    cap: c_int,
) -> c_int {
    // SAFETY: pointers are NULL or valid, and cap is buf's size.
    unsafe {
        write(number, buf, cap, |number, room| gx::write_move(format_of(format)?, number, vector_of(target)?, room))
    }
}

/// Writes the short form, always binary: deltas of -63 to 63 steps an axis. Returns what `gx_write_move` does.
///
/// ```c
/// const struct gx_vector deltas = {0, 1 | 2, {10, -10, 0, 0, 0, 0}};
/// if ((length = gx_write_step(NULL, &deltas, out, sizeof out)) > 0)
///     uart_write(&uart, out, length);
/// ```
#[export]
pub unsafe extern "C" fn gx_write_step(
    number: *const Number,
    deltas: *const Vector,
    buf: *mut c_void,
    cap: c_int,
) -> c_int {
    // SAFETY: pointers are NULL or valid, and cap is buf's size.
    unsafe { write(number, buf, cap, |number, room| gx::write_step(number, vector_of(deltas)?, room)) }
}

/// Writes the shortest command, always binary, that leads from a position to a target: the short form if it can, and no
/// axis that stays where it is. The mask of from flags the axes that are known; NULL: none. Returns what
/// `gx_write_move` does.
///
/// ```c
/// if ((length = gx_write_shortest(NULL, &target, &position, out, sizeof out)) > 0)
///     uart_write(&uart, out, length);
/// ```
#[export]
pub unsafe extern "C" fn gx_write_shortest(
    number: *const Number,
    target: *const Vector,
    from: *const Vector,
    buf: *mut c_void,
    cap: c_int,
) -> c_int {
    // SAFETY: pointers are NULL or valid, and cap is buf's size.
    unsafe {
        let unknown = gx::Vector::new();
        let (target, from) = (vector_of(target), vector_of(from).unwrap_or(&unknown));
        write(number, buf, cap, |number, room| gx::write_shortest(number, target?, from, room))
    }
}

/// Writes a request for position reports each period milliseconds, 0 to 16383; 0: none. Returns what `gx_write_move`
/// does.
///
/// ```c
/// if ((length = gx_write_reporting(GX_BINARY, NULL, 100, out, sizeof out)) > 0)
///     uart_write(&uart, out, length);
/// ```
#[export]
pub unsafe extern "C" fn gx_write_reporting(
    format: c_int,
    number: *const Number,
    period: c_int,
    buf: *mut c_void,
    cap: c_int,
) -> c_int {
    // What is none stays out of range.
    let period = u16::try_from(period).unwrap_or(u16::MAX);
    // SAFETY: pointers are NULL or valid, and cap is buf's size.
    unsafe { write(number, buf, cap, |number, room| gx::write_reporting(format_of(format)?, number, period, room)) }
}

/// Writes the notice that the command with this number was carried out, in the number's format. Returns what
/// `gx_write_move` does, -`GX_RC_ERROR_GENERIC` also without a number.
///
/// ```c
/// if ((length = gx_write_completed(&item.number, out, sizeof out)) > 0)
///     uart_write(&uart, out, length);
/// ```
#[export]
pub unsafe extern "C" fn gx_write_completed(number: *const Number, buf: *mut c_void, cap: c_int) -> c_int {
    // SAFETY: pointers are NULL or valid, and cap is buf's size.
    unsafe { write(number, buf, cap, |number, room| gx::write_completed(number.ok_or(EncodeError::Empty)?, room)) }
}

/// Writes the notice that a command was not carried out: with its number, if it had one, in the format of the command.
/// code is 0 to 127: `GX_FAULT_*` or the firmware's own. Without a number it begins with a line end: behind a packed
/// number of the notice before, it would be about that command. Returns what `gx_write_move` does.
///
/// ```c
/// if ((length = gx_write_refused(item.format, &item.number, GX_FAULT_BUSY, out, sizeof out)) > 0)
///     uart_write(&uart, out, length);
/// ```
#[export]
pub unsafe extern "C" fn gx_write_refused(
    format: c_int,
    number: *const Number,
    code: c_int,
    buf: *mut c_void,
    cap: c_int,
) -> c_int {
    // What is none stays out of range.
    let code = u8::try_from(code).unwrap_or(u8::MAX);
    // SAFETY: pointers are NULL or valid, and cap is buf's size.
    unsafe { write(number, buf, cap, |number, room| gx::write_refused(format_of(format)?, number, code, room)) }
}

/// Writes a position report; a velocity, the one in force, says that the machine was stopped. Returns what
/// `gx_write_move` does.
///
/// ```c
/// if ((length = gx_write_position(GX_BINARY, &position, out, sizeof out)) > 0)
///     uart_write(&uart, out, length);
/// ```
#[export]
pub unsafe extern "C" fn gx_write_position(
    format: c_int,
    position: *const Vector,
    buf: *mut c_void,
    cap: c_int,
) -> c_int {
    // SAFETY: pointers are NULL or valid, and cap is buf's size.
    unsafe {
        write(core::ptr::null(), buf, cap, |_, room| gx::write_position(format_of(format)?, vector_of(position)?, room))
    }
}

/// Writes what a host asks for past the queue, one of `GX_CONTROL_*`. Returns what `gx_write_move` does.
///
/// ```c
/// if ((length = gx_write_control(GX_BINARY, NULL, GX_CONTROL_HOLD, out, sizeof out)) > 0)
///     uart_write(&uart, out, length);
/// ```
#[export]
pub unsafe extern "C" fn gx_write_control(
    format: c_int,
    number: *const Number,
    control: c_int,
    buf: *mut c_void,
    cap: c_int,
) -> c_int {
    let control = control_of(control).ok_or(EncodeError::Range);
    // SAFETY: pointers are NULL or valid, and cap is buf's size.
    unsafe { write(number, buf, cap, |number, room| gx::write_control(format_of(format)?, number, control?, room)) }
}

/// Writes the notice that a session's move was carried out, with its `gx_check`. Returns what `gx_write_move` does.
///
/// ```c
/// if ((length = gx_write_confirmed(&item.number, gx_check(&target, item.number.value), out, sizeof out)) > 0)
///     uart_write(&uart, out, length);
/// ```
#[export]
pub unsafe extern "C" fn gx_write_confirmed(
    number: *const Number,
    check: c_int,
    buf: *mut c_void,
    cap: c_int,
) -> c_int {
    let check = u8::try_from(check).unwrap_or(u8::MAX);
    // SAFETY: pointers are NULL or valid, and cap is buf's size.
    unsafe {
        write(number, buf, cap, |number, room| gx::write_confirmed(number.ok_or(EncodeError::Empty)?, check, room))
    }
}

/// Writes the status of a motion side: free more moves fit into its queue, at most 255, and it holds if held is not 0.
/// Returns what `gx_write_move` does.
///
/// ```c
/// if ((length = gx_write_status(GX_BINARY, 16, 0, out, sizeof out)) > 0)
///     uart_write(&uart, out, length);
/// ```
#[export]
pub unsafe extern "C" fn gx_write_status(
    format: c_int,
    free: c_int,
    held: c_int,
    buf: *mut c_void,
    cap: c_int,
) -> c_int {
    let status = u8::try_from(free).map(|free| Status { free, is_held: held != 0 }).map_err(|_| EncodeError::Range);
    // SAFETY: cap is buf's size.
    unsafe { write(core::ptr::null(), buf, cap, |_, room| gx::write_status(format_of(format)?, status?, room)) }
}

const GX_CONTOUR_WORDS: usize = 64 / size_of::<c_ulong>();

/// Writes a path as the shortest stream of commands. All zero is a path of no axis. Its contents are private.
#[repr(C)]
#[derive(Debug)]
pub struct Contour {
    opaque: [c_ulong; GX_CONTOUR_WORDS],
}
state!(Contour: gx::Contour);

/// Begins a path of the axes that the mask flags (other bits are ignored), where is not known. Any memory will do.
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

/// Sets where the machine is, and its velocity, as far as the mask of start says so; NULL: neither is known, as after
/// an error notice. Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when contour is NULL.
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

/// Writes the shortest command to the next position of a path; `gx_follow` along these commands gives the positions
/// back, repeated ones too. position holds six values, of which those of the path's axes count; velocity is 0 to 16383,
/// or negative: as before. Returns what `gx_write_move` does; when that is negative, the path still ends where it did.
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

fn format_of(format: c_int) -> Result<Format, EncodeError> {
    match format {
        GX_BINARY => Ok(Format::Binary),
        GX_ASCII => Ok(Format::Ascii),
        _ => Err(EncodeError::Empty),
    }
}

/// A vector, if there is one.
///
/// # Safety
///
/// vector is NULL or points to a vector that nobody writes while the reference lives.
unsafe fn vector_of<'a>(vector: *const Vector) -> Result<&'a gx::Vector, EncodeError> {
    // SAFETY: the same contract.
    unsafe { vector.as_ref() }.map(Vector::core).ok_or(EncodeError::Empty)
}

/// Calls a function of the core's that writes something with a number, and makes its answer an int.
///
/// # Safety
///
/// number is NULL or points to a number, buf is NULL or points to cap writable bytes.
unsafe fn write(
    number: *const Number,
    buf: *mut c_void,
    cap: c_int,
    write: impl FnOnce(Option<gx::Number>, &mut [u8]) -> Written,
) -> c_int {
    // SAFETY: the same contract.
    let (number, room) = unsafe { (number.as_ref(), room(buf, cap)) };
    let number = match number {
        Some(number) if number.format != 0 => {
            let Ok(format) = format_of(number.format.into()) else { return -GX_RC_ERROR_GENERIC };
            Some(gx::Number { value: number.value, format })
        }
        _ => None,
    };
    match room.map(|room| write(number, room)) {
        Some(Ok(length)) => int(length),
        Some(Err(EncodeError::Range)) => -GX_RC_RANGE,
        Some(Err(EncodeError::Room)) => -GX_RC_OVERFLOW,
        Some(Err(EncodeError::Empty)) | None => -GX_RC_ERROR_GENERIC,
    }
}
