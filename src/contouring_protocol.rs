//! `ContouringProtocol.h`: vector moves of the GX binary vector protocol, packed and unpacked. It takes the place of
//! the header that came with the proposal; libdeltarobot/gx.h has what that lacks.
#![expect(non_upper_case_globals, non_snake_case, reason = "in the style of the posted names")]

use core::ffi::c_int;

use deltarobot_export::export;
use deltarobot_protocols::gx::{CommandReceiver, EncodeError, Format, Kind, MASK_AXES, Vector, write_move, write_step};

/// A value of 7 bits: one byte with the high bit set.
pub type CPPacked7 = [u8; 1];
/// A value of 14 bits: two of them, the less significant first.
pub type CPPacked14 = [u8; 2];
/// A value of 28 bits: four of them, the least significant first.
pub type CPPacked28 = [u8; 4];

/// Done. The numbers of these codes are those of `GX_RC_*` in libdeltarobot/gx.h.
pub const CPResult_ok: c_int = 0;
/// A pointer is NULL, or the mask is empty.
pub const CPResult_error: c_int = 1;
/// The buffer does not hold what it should: start byte, mask, high bits and length are looked at.
pub const CPResult_malformed: c_int = 8;
/// A value does not fit, or the mask has bits that mean nothing.
pub const CPResult_range: c_int = 10;

/// A vector move.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct CPVectorCommand {
    /// The feed rate along the vector, in steps per second: 0 to 16383.
    pub targetVelocity: u16,
    /// Which of the values are valid: `CPMask_*`.
    pub axisMask: u8,
    /// x, y, z, a, b, c in steps, -134217728 to 134217727; deltas with PackCPShortVectorCommand, and there only.
    pub axisPosition: [i32; 6],
}

/// A packed vector move.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct CPPackedVectorCommandBuffer {
    /// How many of the bytes there are: 3 to 28, or 0 when packing failed.
    pub length: u8,
    /// The bytes, as they are sent.
    pub bytes: [u8; 28],
}

/// Packs a vector of positions: the long form. Values that axisMask does not flag are not looked at. The posted code
/// packed only the lowest bits of values that do not fit, and added to a length that nobody had set.
///
/// Returns 0; or, the buffer's length being 0 then, `CPResult_range` when a flagged value or the mask does not fit,
/// `CPResult_error` when the mask is empty or a pointer is NULL.
///
/// ```c
/// CPVectorCommand command = {500, CPMask_x | CPMask_velocity, {1000, 0, 0, 0, 0, 0}};
/// CPPackedVectorCommandBuffer buffer;
/// if (PackCPVectorCommand(&buffer, &command) == CPResult_ok)
///     uart_write(&uart, buffer.bytes, buffer.length);
/// ```
#[export]
pub unsafe extern "C" fn PackCPVectorCommand(
    buffer: *mut CPPackedVectorCommandBuffer,
    command: *mut CPVectorCommand,
) -> c_int {
    // SAFETY: pointers are NULL or valid, and the objects do not overlap.
    unsafe { pack(buffer, command, |vector, room| write_move(Format::Binary, None, vector, room)) }
}

/// Unpacks a vector of positions: the long form. Values that are not in it stay as they were, the velocity too. The
/// posted code got positions from 2097152 and below 0 wrong, and took any bytes for a command.
///
/// Returns 0; or, the command left as it was, `CPResult_malformed` when the buffer does not hold a long form and
/// nothing else, `CPResult_error` when a pointer is NULL.
///
/// ```c
/// CPVectorCommand command;
/// if (UnpackCPVectorCommand(&buffer, &command) == CPResult_ok && (command.axisMask & CPMask_x) != 0)
///     printf("x to %ld\n", (long)command.axisPosition[CPAxis_x]);
/// ```
#[export]
pub unsafe extern "C" fn UnpackCPVectorCommand(
    buffer: *mut CPPackedVectorCommandBuffer,
    command: *mut CPVectorCommand,
) -> c_int {
    // SAFETY: pointers are NULL or valid, and the objects do not overlap.
    unsafe { unpack(buffer, command, false) }
}

/// Packs a vector of deltas: the short form. axisPosition holds how far each axis shall go on, -63 to 63 steps, not
/// where to. Returns what PackCPVectorCommand does.
///
/// ```c
/// CPVectorCommand deltas = {0, CPMask_x | CPMask_y, {10, -10, 0, 0, 0, 0}};
/// if (PackCPShortVectorCommand(&buffer, &deltas) == CPResult_ok)
///     uart_write(&uart, buffer.bytes, buffer.length);
/// ```
#[export]
pub unsafe extern "C" fn PackCPShortVectorCommand(
    buffer: *mut CPPackedVectorCommandBuffer,
    command: *mut CPVectorCommand,
) -> c_int {
    // SAFETY: pointers are NULL or valid, and the objects do not overlap.
    unsafe { pack(buffer, command, |vector, room| write_step(None, vector, room)) }
}

/// Unpacks a vector of deltas, the short form, and adds them to the positions: axisPosition holds where the axes are
/// before the call, and where they shall go after it. Values that are not in it stay as they were, the velocity too. The
/// posted code took any bytes for a command, and let the sum overflow.
///
/// Returns 0; or, the command left as it was, `CPResult_range` when a sum is no position (28 bits), and else, of the
/// short form, what UnpackCPVectorCommand does.
///
/// ```c
/// if (UnpackCPShortVectorCommand(&buffer, &command) == CPResult_ok)
///     printf("x to %ld\n", (long)command.axisPosition[CPAxis_x]);
/// ```
#[export]
pub unsafe extern "C" fn UnpackCPShortVectorCommand(
    buffer: *mut CPPackedVectorCommandBuffer,
    command: *mut CPVectorCommand,
) -> c_int {
    // SAFETY: pointers are NULL or valid, and the objects do not overlap.
    unsafe { unpack(buffer, command, true) }
}

impl CPVectorCommand {
    const fn to_core(self) -> Vector {
        Vector { velocity: self.targetVelocity, mask: self.axisMask, axes: self.axisPosition }
    }
}

/// Packs a command by a function of the core's.
///
/// # Safety
///
/// Each pointer is NULL or points to a whole object, buffer to a writable one, and they do not overlap.
unsafe fn pack(
    buffer: *mut CPPackedVectorCommandBuffer,
    command: *const CPVectorCommand,
    write: impl FnOnce(&Vector, &mut [u8]) -> Result<usize, EncodeError>,
) -> c_int {
    // SAFETY: the same contract.
    let (Some(buffer), command) = (unsafe { (buffer.as_mut(), command.as_ref()) }) else { return CPResult_error };
    buffer.length = 0;
    let Some(command) = command else { return CPResult_error };
    match write(&command.to_core(), &mut buffer.bytes).map(u8::try_from) {
        Ok(Ok(length)) => buffer.length = length,
        Err(EncodeError::Empty) => return CPResult_error,
        Ok(Err(_)) | Err(_) => return CPResult_range,
    }
    CPResult_ok
}

/// Unpacks a command of one form.
///
/// # Safety
///
/// Each pointer is NULL or points to a whole object, command to a writable one, and they do not overlap.
unsafe fn unpack(buffer: *const CPPackedVectorCommandBuffer, command: *mut CPVectorCommand, is_step: bool) -> c_int {
    // SAFETY: the same contract.
    let (Some(buffer), Some(command)) = (unsafe { (buffer.as_ref(), command.as_mut()) }) else {
        return CPResult_error;
    };
    let Some(bytes) = buffer.bytes.get(..buffer.length.into()) else { return CPResult_malformed };
    let (start, kind) = if is_step { (b'*', Kind::Step) } else { (b'!', Kind::Move) };
    let mut receiver = CommandReceiver::new();
    if bytes.first() != Some(&start) || receiver.receive(bytes) != (bytes.len(), Some(kind)) {
        return CPResult_malformed;
    }
    let packed = receiver.vector();
    // The positions are set: that they are known is what the mask is to say.
    let mut reached = Vector { mask: MASK_AXES, ..command.to_core() };
    if reached.follow(packed, is_step).is_err() {
        return CPResult_range;
    }
    command.targetVelocity = reached.velocity;
    command.axisMask = packed.mask;
    for (place, value) in command.axisPosition.iter_mut().zip(&reached.axes) {
        *place = *value;
    }
    CPResult_ok
}
