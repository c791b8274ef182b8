//! `libdeltarobot/gx.h`: commands and notices of the GX binary vector protocol.

use core::ffi::{c_int, c_void};
use core::mem::{align_of, offset_of, size_of};

use super::memory::{bytes_of, int, zero};
use deltarobot_export::export;
use deltarobot_protocols::gx::{
    self, CommandReceiver, Contour, Fault, Format, Item, Lost, NoticeReceiver, NumberField, Vector,
};

pub mod contour;
pub mod write;

/// Done.
pub const GX_RC_SUCCESS: c_int = 0;
/// An argument was NULL or none of its values: nothing was done.
pub const GX_RC_ERROR_GENERIC: c_int = 1;
/// The room is too small.
pub const GX_RC_OVERFLOW: c_int = 3;
/// There is no room until something was fetched.
pub const GX_RC_BUSY: c_int = 5;
/// Nothing has happened, or nothing is there.
pub const GX_RC_NO_EVENT: c_int = 6;
/// A value does not fit where it has to go.
pub const GX_RC_RANGE: c_int = 10;
/// It starts from a position that is not known.
pub const GX_RC_NOT_FOUND: c_int = 11;

/// Written with packed bytes.
pub const GX_BINARY: c_int = 1;
/// Written as text.
pub const GX_ASCII: c_int = 2;

/// Nothing is complete.
pub const GX_NONE: c_int = 0;
/// Command: go to the positions in vector (long form or ASCII). One without axes sets the velocity of those to come.
pub const GX_MOVE: c_int = 1;
/// Command: go on by the deltas in vector, each -64 to 63 steps (short form).
pub const GX_STEP: c_int = 2;
/// Command: report the position each period milliseconds.
pub const GX_REPORTING: c_int = 3;
/// A command or notice that is none; code says what is wrong with it.
pub const GX_MALFORMED: c_int = 4;
/// Notice: the command with this number was carried out.
pub const GX_COMPLETED: c_int = 5;
/// Notice: the command, with this number if it had one, was not; code says why.
pub const GX_REFUSED: c_int = 6;
/// Notice: the position is that in vector.
pub const GX_POSITION: c_int = 7;

/// No command begins like that.
pub const GX_FAULT_UNKNOWN: c_int = 1;
/// The number is none, or above 16383. Text behind it is skipped; a command that begins with `!`, `*` or `~` clears it
/// and is delivered, without a number.
pub const GX_FAULT_NUMBER: c_int = 2;
/// Another began before this was complete, or the line fell silent.
pub const GX_FAULT_INTERRUPTED: c_int = 3;
/// A byte that has no place there.
pub const GX_FAULT_SYNTAX: c_int = 4;
/// It names no axis and no velocity.
pub const GX_FAULT_EMPTY: c_int = 5;
/// It names an axis, or the velocity, twice.
pub const GX_FAULT_REPEATED: c_int = 6;
/// A value does not fit.
pub const GX_FAULT_RANGE: c_int = 7;
/// A step leads out of the positions that there are, or starts where the position is not known.
pub const GX_FAULT_LIMIT: c_int = 8;
/// There is no room for another command.
pub const GX_FAULT_BUSY: c_int = 9;
/// The number is not the next of its session.
pub const GX_FAULT_ORDER: c_int = 16;
/// A session is over, or none has begun and moves are taken in sessions only.
pub const GX_FAULT_CLOSED: c_int = 17;
/// A move without a number where numbers are in order.
pub const GX_FAULT_NUMBERLESS: c_int = 18;
/// The machine does not have that axis.
pub const GX_FAULT_AXIS: c_int = 19;
/// The machine has stopped before this move was finished; those behind it are dropped.
pub const GX_FAULT_STOPPED: c_int = 20;
/// Codes from here to 127 are the firmware's own.
pub const GX_FAULT_OWN: c_int = 64;

/// The largest delta that is written, either way.
pub const GX_DELTA_MAX: c_int = 63;
/// The largest velocity, in steps per second.
pub const GX_VELOCITY_MAX: c_int = 16383;
/// The largest number of a command.
pub const GX_NUMBER_MAX: c_int = 16383;
/// The longest period of position reports, in milliseconds.
pub const GX_PERIOD_MAX: c_int = 16383;
/// Room that any one command or notice fits in, in bytes.
pub const GX_ENCODED_MAX: c_int = 96;

// The layout that C compilers give these structs; C tests assert the same numbers.
#[expect(clippy::arithmetic_side_effects, reason = "done by the compiler")]
const _: () = {
    assert!(offset_of!(Vector, velocity) == 0 && offset_of!(Vector, mask) == 2);
    assert!(offset_of!(Vector, axes) == if align_of::<i32>() == 1 { 3 } else { 4 });
    assert!(size_of::<NumberField>() == if align_of::<u16>() == 1 { 3 } else { 4 });
    assert!(offset_of!(NumberField, format) == 2);
    assert!(offset_of!(Item, kind) == 0 && offset_of!(Item, number) == size_of::<c_int>());
    assert!(offset_of!(Item, code) == offset_of!(Item, format) + 1);
    assert!(size_of::<CommandReceiver>() == size_of::<NoticeReceiver>());
    if align_of::<i32>() == 4 && size_of::<c_int>() == 4 {
        assert!(size_of::<Vector>() == 28 && size_of::<Contour>() == 56);
        assert!(offset_of!(Item, format) == 8 && offset_of!(Item, period) == 10 && offset_of!(Item, vector) == 12);
        assert!(size_of::<Item>() == 40 && size_of::<CommandReceiver>() == 40);
    }
    assert!(GX_ENCODED_MAX as usize == gx::ENCODED_MAX);
    assert!(GX_VELOCITY_MAX == gx::VELOCITY_MAX as c_int && GX_NUMBER_MAX == gx::NUMBER_MAX as c_int);
    assert!(GX_PERIOD_MAX == gx::PERIOD_MAX as c_int && GX_DELTA_MAX == gx::DELTA_MAX as c_int);
    assert!(GX_BINARY == Format::Binary as c_int && GX_ASCII == Format::Ascii as c_int);
    assert!(GX_FAULT_UNKNOWN == Fault::Unknown as c_int && GX_FAULT_NUMBER == Fault::Number as c_int);
    assert!(GX_FAULT_INTERRUPTED == Fault::Interrupted as c_int && GX_FAULT_SYNTAX == Fault::Syntax as c_int);
    assert!(GX_FAULT_EMPTY == Fault::Empty as c_int && GX_FAULT_REPEATED == Fault::Repeated as c_int);
    assert!(GX_FAULT_RANGE == Fault::Range as c_int && GX_FAULT_LIMIT == Fault::Limit as c_int);
    assert!(GX_FAULT_BUSY == Fault::Busy as c_int);
    assert!(GX_MOVE == gx::MOVE && GX_STEP == gx::STEP && GX_REPORTING == gx::REPORTING);
    assert!(GX_MALFORMED == gx::MALFORMED && GX_COMPLETED == gx::COMPLETED);
    assert!(GX_REFUSED == gx::REFUSED && GX_POSITION == gx::POSITION);
};

/// Makes a receiver of commands of any memory. Zeroed memory is one too.
///
/// Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when commands is NULL.
///
/// ```c
/// struct gx_commands commands;
/// gx_commands_init(&commands);
/// ```
#[export]
pub unsafe extern "C" fn gx_commands_init(commands: *mut CommandReceiver) -> c_int {
    // SAFETY: as the contract of this function asks; zero is a receiver.
    unsafe { init(commands) }.map_or(GX_RC_ERROR_GENERIC, |_| GX_RC_SUCCESS)
}

/// Takes received bytes up to the end of a command, and tells it in item; if none ends there, all of them, and item is
/// `GX_NONE`. A malformed command is told as `GX_MALFORMED`, once, and with its number if that was complete.
///
/// To be called as long as bytes are left. It may take none of them and tell that what came before is malformed.
///
/// Returns the number of bytes taken, or -`GX_RC_ERROR_GENERIC` when a pointer is NULL (buf may be if bytes is 0) or
/// bytes is negative.
///
/// ```c
/// int got = uart_read(&uart, in, sizeof in);
/// for (int taken = 0; taken < got;) {
///     taken += gx_commands_receive(&commands, in + taken, got - taken, &item);
///     handle_item(&item);
/// }
/// ```
#[export]
pub unsafe extern "C" fn gx_commands_receive(
    commands: *mut CommandReceiver,
    buf: *const c_void,
    bytes: c_int,
    item: *mut Item,
) -> c_int {
    // SAFETY: as the contract of this function asks.
    match unsafe { (commands.as_mut(), bytes_of(buf, bytes), item.as_mut()) } {
        (Some(commands), Some(input), Some(item)) => int(commands.receive(input, item)),
        _ => -GX_RC_ERROR_GENERIC,
    }
}

/// To be called when the line has been quiet for longer than a command takes: a command that is incomplete is given up
/// and told in item as `GX_MALFORMED`. Else item is `GX_NONE`.
///
/// Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// if (now_ms() - heard_at >= 20 && gx_commands_idle(&commands, &item) == GX_RC_SUCCESS)
///     handle_item(&item);
/// ```
#[export]
pub unsafe extern "C" fn gx_commands_idle(commands: *mut CommandReceiver, item: *mut Item) -> c_int {
    // SAFETY: as the contract of this function asks.
    match unsafe { (commands.as_mut(), item.as_mut()) } {
        (Some(commands), Some(item)) => commands.idle(item),
        _ => return GX_RC_ERROR_GENERIC,
    }
    GX_RC_SUCCESS
}

/// Makes a receiver of notices of any memory. Zeroed memory is one too.
///
/// Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when notices is NULL.
///
/// ```c
/// struct gx_notices notices;
/// gx_notices_init(&notices);
/// ```
#[export]
pub unsafe extern "C" fn gx_notices_init(notices: *mut NoticeReceiver) -> c_int {
    // SAFETY: as the contract of this function asks; zero is a receiver.
    unsafe { init(notices) }.map_or(GX_RC_ERROR_GENERIC, |_| GX_RC_SUCCESS)
}

/// Takes received bytes up to the end of a notice, and tells it in item: see `gx_commands_receive`.
///
/// A packed number is a whole notice, but may be the beginning of an error notice too: it is told when the next byte
/// has come, or by `gx_notices_idle`.
///
/// Returns the number of bytes taken, or -`GX_RC_ERROR_GENERIC` when a pointer is NULL (buf may be if bytes is 0) or
/// bytes is negative.
///
/// ```c
/// int got = uart_read(&uart, in, sizeof in);
/// for (int taken = 0; taken < got;) {
///     taken += gx_notices_receive(&notices, in + taken, got - taken, &item);
///     handle_item(&item);
/// }
/// ```
#[export]
pub unsafe extern "C" fn gx_notices_receive(
    notices: *mut NoticeReceiver,
    buf: *const c_void,
    bytes: c_int,
    item: *mut Item,
) -> c_int {
    // SAFETY: as the contract of this function asks.
    match unsafe { (notices.as_mut(), bytes_of(buf, bytes), item.as_mut()) } {
        (Some(notices), Some(input), Some(item)) => int(notices.receive(input, item)),
        _ => -GX_RC_ERROR_GENERIC,
    }
}

/// To be called when the line has been quiet for longer than a notice takes: tells the completion that could have
/// become an error notice; anything else that is incomplete is given up and told as `GX_MALFORMED`. Else item is
/// `GX_NONE`.
///
/// Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// if (now_ms() - heard_at >= 20 && gx_notices_idle(&notices, &item) == GX_RC_SUCCESS)
///     handle_item(&item);
/// ```
#[export]
pub unsafe extern "C" fn gx_notices_idle(notices: *mut NoticeReceiver, item: *mut Item) -> c_int {
    // SAFETY: as the contract of this function asks.
    match unsafe { (notices.as_mut(), item.as_mut()) } {
        (Some(notices), Some(item)) => notices.idle(item),
        _ => return GX_RC_ERROR_GENERIC,
    }
    GX_RC_SUCCESS
}

/// Takes a position along where an item leads, if it does: `GX_MOVE` and `GX_POSITION` tell where that is, `GX_STEP`
/// how far. The position's mask tells which axes are known. Velocities are taken over too.
///
/// Returns `GX_RC_SUCCESS`; or, position left as it was, `GX_RC_RANGE` when a step leads out of the positions that
/// there are, `GX_RC_NOT_FOUND` when it starts from an axis that is not known, `GX_RC_ERROR_GENERIC` when a pointer is
/// NULL.
///
/// ```c
/// if (gx_follow(&position, &item) == GX_RC_SUCCESS && (position.mask & 1) != 0)
///     printf("x is at %ld\n", (long)position.axes[0]);
/// ```
#[export]
pub unsafe extern "C" fn gx_follow(position: *mut Vector, item: *const Item) -> c_int {
    // SAFETY: as the contract of this function asks.
    let (Some(position), Some(item)) = (unsafe { (position.as_mut(), item.as_ref()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    match item.message().map(|message| position.follow(&message)) {
        None | Some(Ok(())) => GX_RC_SUCCESS,
        Some(Err(Lost::Range)) => GX_RC_RANGE,
        Some(Err(Lost::Unknown)) => GX_RC_NOT_FOUND,
    }
}

/// Makes any memory an object of a type of which all zero is one; `None` where there is no memory.
///
/// # Safety
///
/// out is NULL or points to writable memory of that type, which nobody else touches while the reference lives.
pub(super) unsafe fn init<'a, T>(out: *mut T) -> Option<&'a mut T> {
    if out.is_null() {
        return None;
    }
    // SAFETY: as the contract of this function asks.
    unsafe {
        zero(out);
        out.as_mut()
    }
}
