//! `libdeltarobot/gx.h`: commands and notices of the GX binary vector protocol.

use core::ffi::{c_int, c_uchar, c_ulong, c_void};
use core::mem::offset_of;

use super::memory::{bytes_of, int, room_of};
use super::state::{Room, state};
use deltarobot_export::export;
use deltarobot_protocols::gx::{
    self, AXES, CommandReceiver, Control, Fault, Format, Kind, Lost, NoticeReceiver, Receiver, Status,
};

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
/// Command: go to the positions in vector (long form or ASCII); without axes, set the velocity of those to come.
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
/// Notice: the position is that in vector; with a velocity, which is in force, the machine was stopped there.
pub const GX_POSITION: c_int = 7;
/// Notice, in sessions: the move whose number ends in these seven bits was carried out; code is its `gx_check`.
pub const GX_CONFIRMED: c_int = 8;
/// Command, an extension: what code asks for past the queue, one of `GX_CONTROL_*`.
pub const GX_CONTROL: c_int = 9;
/// Notice, an extension: period more moves fit into the queue, and the machine holds if code is not 0.
pub const GX_STATUS: c_int = 10;

/// The status.
pub const GX_CONTROL_QUERY: c_int = 0;
/// To hold now: to pause, in the middle of a move too.
pub const GX_CONTROL_HOLD: c_int = 1;
/// To go on.
pub const GX_CONTROL_RESUME: c_int = 2;
/// To stop now, and to forget all moves.
pub const GX_CONTROL_STOP: c_int = 3;
/// What is received and none of these.
pub const GX_CONTROL_UNKNOWN: c_int = 127;

/// No command begins like that.
pub const GX_FAULT_UNKNOWN: c_int = 1;
/// No number from 0 to 16383. Text behind it is skipped; `!`, `*` or `~` begins a command without a number.
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
/// The machine has stopped as its host was silent.
pub const GX_FAULT_SILENT: c_int = 21;
/// Codes from here to 127 are the firmware's own.
pub const GX_FAULT_OWN: c_int = 64;

/// The axes: x, y, z, a, b, c.
pub const GX_AXES: c_int = 6;
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

/// Axes and velocity: a target, the deltas of a step, or a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(C)]
pub struct Vector {
    /// Along the vector, in steps per second: 0 to 16383.
    pub velocity: u16,
    /// Which of the values mean something: bit i is `axes[i]`, bit 6 `velocity`.
    pub mask: c_uchar,
    /// x, y, z, a, b, c in steps: positions are -134217728 to 134217727.
    pub axes: [i32; AXES],
}

/// The number of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(C)]
pub struct Number {
    /// 0 to 16383.
    pub value: u16,
    /// How it is written: `GX_BINARY` or `GX_ASCII`; 0: there is none.
    pub format: c_uchar,
}

/// What a receiver has found: a command, a notice, a malformed one, or nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(C)]
pub struct Item {
    /// What it is: `GX_NONE`, `GX_MOVE` ...
    pub kind: c_int,
    /// The number of the command; its format is 0 when it has none.
    pub number: Number,
    /// `GX_BINARY` or `GX_ASCII`: how the command or notice was written.
    pub format: c_uchar,
    /// Of `GX_MALFORMED`: `GX_FAULT_*`. Of `GX_REFUSED`: one of these, or the controller's own, 0 to 127.
    pub code: c_uchar,
    /// Of `GX_REPORTING`: milliseconds between two reports, 0 to 16383; 0: none are wanted.
    pub period: u16,
    /// Positions; of `GX_STEP` deltas, to be added to them. Values that its mask does not flag are 0.
    pub vector: Vector,
}

const GX_RECEIVER_WORDS: usize = 48 / size_of::<c_ulong>();

/// Receives commands: the motion side's. All zero is a new one. Its contents are private.
#[repr(C)]
#[derive(Debug)]
pub struct Commands {
    opaque: [c_ulong; GX_RECEIVER_WORDS],
}
state!(Commands: CommandReceiver);

/// Receives notices: the host's. All zero is a new one. Its contents are private.
#[repr(C)]
#[derive(Debug)]
pub struct Notices {
    opaque: [c_ulong; GX_RECEIVER_WORDS],
}
state!(Notices: NoticeReceiver);

const _: () = {
    assert!(GX_AXES as usize == AXES && GX_ENCODED_MAX as usize == gx::ENCODED_MAX);
    assert!(GX_VELOCITY_MAX == gx::VELOCITY_MAX as c_int && GX_NUMBER_MAX == gx::NUMBER_MAX as c_int);
    assert!(GX_PERIOD_MAX == gx::PERIOD_MAX as c_int && GX_DELTA_MAX == gx::DELTA_MAX as c_int);
    assert!(GX_BINARY == Format::Binary as c_int && GX_ASCII == Format::Ascii as c_int);
    assert!(GX_FAULT_UNKNOWN == Fault::Unknown as c_int && GX_FAULT_NUMBER == Fault::Number as c_int);
    assert!(GX_FAULT_INTERRUPTED == Fault::Interrupted as c_int && GX_FAULT_SYNTAX == Fault::Syntax as c_int);
    assert!(GX_FAULT_EMPTY == Fault::Empty as c_int && GX_FAULT_REPEATED == Fault::Repeated as c_int);
    assert!(GX_FAULT_RANGE == Fault::Range as c_int && GX_FAULT_LIMIT == Fault::Limit as c_int);
    assert!(GX_FAULT_BUSY == Fault::Busy as c_int && GX_FAULT_ORDER == Fault::Order as c_int);
    assert!(GX_FAULT_CLOSED == Fault::Closed as c_int && GX_FAULT_NUMBERLESS == Fault::Numberless as c_int);
    assert!(GX_FAULT_AXIS == Fault::Axis as c_int && GX_FAULT_STOPPED == Fault::Stopped as c_int);
    assert!(GX_FAULT_OWN == gx::CODE_FREE as c_int);
    assert!(GX_MOVE == Kind::Move as c_int && GX_STEP == Kind::Step as c_int);
    assert!(GX_REPORTING == Kind::Reporting as c_int && GX_MALFORMED == Kind::Malformed as c_int);
    assert!(GX_COMPLETED == Kind::Completed as c_int && GX_REFUSED == Kind::Refused as c_int);
    assert!(GX_POSITION == Kind::Position as c_int && GX_CONFIRMED == Kind::Confirmed as c_int);
    assert!(GX_CONTROL == Kind::Control as c_int && GX_STATUS == Kind::Status as c_int);
    assert!(GX_CONTROL_QUERY == Control::Query as c_int && GX_CONTROL_HOLD == Control::Hold as c_int);
    assert!(GX_CONTROL_RESUME == Control::Resume as c_int && GX_CONTROL_STOP == Control::Stop as c_int);
    assert!(GX_FAULT_SILENT == Fault::Silent as c_int);
    assert!(size_of::<Vector>() == size_of::<gx::Vector>() && align_of::<Vector>() == align_of::<gx::Vector>());
    assert!(offset_of!(Vector, velocity) == offset_of!(gx::Vector, velocity));
    assert!(offset_of!(Vector, mask) == offset_of!(gx::Vector, mask));
    assert!(offset_of!(Vector, axes) == offset_of!(gx::Vector, axes));
};

impl Vector {
    /// As the core has it.
    pub(super) const fn core(&self) -> &gx::Vector {
        // SAFETY: the fields are the same and, as is asserted above, lie at the same places.
        unsafe { &*core::ptr::from_ref(self).cast() }
    }

    pub(super) const fn core_mut(&mut self) -> &mut gx::Vector {
        // SAFETY: as in core().
        unsafe { &mut *core::ptr::from_mut(self).cast() }
    }
}

impl Item {
    /// Takes over what a receiver has found. Whatever the receiver's memory held, no value is out of its range.
    fn set<const NOTICES: bool>(&mut self, found: Option<Kind>, receiver: &Receiver<NOTICES>) {
        let Some(kind) = found else {
            self.kind = GX_NONE;
            return;
        };
        let (number, vector) = (receiver.number(), receiver.vector());
        self.kind = kind as c_int;
        self.number = number
            .map_or_else(Number::default, |gx::Number { value, format }| Number { value, format: format as c_uchar });
        self.format = receiver.format() as c_uchar;
        (self.code, self.period) = match kind {
            Kind::Malformed | Kind::Refused => (receiver.code(), 0),
            Kind::Reporting => (0, receiver.period() & gx::PERIOD_MAX),
            Kind::Control => (Control::of(receiver.bits()).map_or(127, |control| control as c_uchar), 0),
            Kind::Status => {
                let status = Status::of(receiver.bits());
                (status.is_held.into(), status.free.into())
            }
            Kind::Confirmed => {
                let (number, check) = receiver.confirmed();
                self.number = Number { value: number.into(), format: self.format };
                (check, 0)
            }
            Kind::Completed => {
                self.format = number.map_or(self.format, |number| number.format as c_uchar);
                (0, 0)
            }
            Kind::Move | Kind::Step | Kind::Position => (0, 0),
        };
        let has_vector = matches!(kind, Kind::Move | Kind::Step | Kind::Position);
        self.vector.mask = if has_vector { vector.mask & (gx::MASK_AXES | gx::MASK_VELOCITY) } else { 0 };
        let has_velocity = self.vector.mask & gx::MASK_VELOCITY != 0;
        self.vector.velocity = if has_velocity { vector.velocity & gx::VELOCITY_MAX } else { 0 };
        let mut flags = self.vector.mask;
        for (place, value) in self.vector.axes.iter_mut().zip(&vector.axes) {
            *place = if flags & 1 == 0 { 0 } else { value.wrapping_shl(4).wrapping_shr(4) };
            flags >>= 1;
        }
    }
}

/// Makes a receiver of commands of any memory. Zeroed memory is one too. Returns `GX_RC_SUCCESS`, or
/// `GX_RC_ERROR_GENERIC` when commands is NULL.
///
/// ```c
/// struct gx_commands commands;
/// gx_commands_init(&commands);
/// ```
#[export]
pub unsafe extern "C" fn gx_commands_init(commands: *mut Commands) -> c_int {
    // SAFETY: commands is NULL or writable, as all pointers are.
    unsafe { Room::init(commands) }.map_or(GX_RC_ERROR_GENERIC, |_| GX_RC_SUCCESS)
}

/// Takes received bytes up to the end of a command, which item receives; if none ends there, all of them, and item is
/// `GX_NONE`. A malformed command is one `GX_MALFORMED`, with its number if that was complete. To be called as long as
/// bytes are left: it may take none of them and report that what came before is malformed.
///
/// Returns the number of bytes taken, or -`GX_RC_ERROR_GENERIC` when a pointer is NULL (buf may be if bytes is 0) or
/// bytes is negative.
///
/// ```c
/// int got = uart_read(&uart, in, sizeof in);
/// for (int taken = 0; taken < got; handle_item(&item))
///     taken += gx_commands_receive(&commands, in + taken, got - taken, &item);
/// ```
#[export]
pub unsafe extern "C" fn gx_commands_receive(
    commands: *mut Commands,
    buf: *const c_void,
    bytes: c_int,
    item: *mut Item,
) -> c_int {
    // SAFETY: three objects that do not overlap, and bytes is buf's size.
    match unsafe { (Room::get(commands), bytes_of(buf, bytes), item.as_mut()) } {
        (Some(commands), Some(input), Some(item)) => {
            let (taken, found) = commands.receive(input);
            item.set(found, commands);
            int(taken)
        }
        _ => -GX_RC_ERROR_GENERIC,
    }
}

/// To be called when the line has been quiet for longer than a command takes: a command that is incomplete is given up
/// and item is `GX_MALFORMED`. Else item is `GX_NONE`. Returns `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when a pointer
/// is NULL.
///
/// ```c
/// if (now_ms() - heard_at >= 20 && gx_commands_idle(&commands, &item) == GX_RC_SUCCESS)
///     handle_item(&item);
/// ```
#[export]
pub unsafe extern "C" fn gx_commands_idle(commands: *mut Commands, item: *mut Item) -> c_int {
    // SAFETY: two objects that do not overlap.
    let (Some(commands), Some(item)) = (unsafe { (Room::get(commands), item.as_mut()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    item.set(commands.idle(), commands);
    GX_RC_SUCCESS
}

/// Makes a receiver of notices of any memory, as `gx_commands_init` makes one of commands.
///
/// ```c
/// struct gx_notices notices;
/// gx_notices_init(&notices);
/// ```
#[export]
pub unsafe extern "C" fn gx_notices_init(notices: *mut Notices) -> c_int {
    // SAFETY: notices is NULL or writable, as all pointers are.
    unsafe { Room::init(notices) }.map_or(GX_RC_ERROR_GENERIC, |_| GX_RC_SUCCESS)
}

/// Takes received bytes up to the end of a notice, which item receives: see `gx_commands_receive`. A packed number is a
/// whole notice, but may begin an error notice too: it is reported when the next byte has come, or by
/// `gx_notices_idle`. Returns what `gx_commands_receive` does.
///
/// ```c
/// int got = uart_read(&uart, in, sizeof in);
/// for (int taken = 0; taken < got; handle_item(&item))
///     taken += gx_notices_receive(&notices, in + taken, got - taken, &item);
/// ```
#[export]
pub unsafe extern "C" fn gx_notices_receive(
    notices: *mut Notices,
    buf: *const c_void,
    bytes: c_int,
    item: *mut Item,
) -> c_int {
    // SAFETY: three objects that do not overlap, and bytes is buf's size.
    match unsafe { (Room::get(notices), bytes_of(buf, bytes), item.as_mut()) } {
        (Some(notices), Some(input), Some(item)) => {
            let (taken, found) = notices.receive(input);
            item.set(found, notices);
            int(taken)
        }
        _ => -GX_RC_ERROR_GENERIC,
    }
}

/// To be called when the line has been quiet for longer than a notice takes: reports the completion that could have
/// become an error notice, and anything else that is incomplete as `GX_MALFORMED`. Else item is `GX_NONE`. Returns
/// `GX_RC_SUCCESS`, or `GX_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// if (now_ms() - heard_at >= 20 && gx_notices_idle(&notices, &item) == GX_RC_SUCCESS)
///     handle_item(&item);
/// ```
#[export]
pub unsafe extern "C" fn gx_notices_idle(notices: *mut Notices, item: *mut Item) -> c_int {
    // SAFETY: two objects that do not overlap.
    let (Some(notices), Some(item)) = (unsafe { (Room::get(notices), item.as_mut()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    item.set(notices.idle(), notices);
    GX_RC_SUCCESS
}

/// Takes a position, whose mask flags the axes that are known, along where an item leads, if it does: to the values of
/// `GX_MOVE` and `GX_POSITION`, on by those of `GX_STEP`. Velocities are taken over too.
///
/// Returns `GX_RC_SUCCESS`; or, position left as it was, `GX_RC_RANGE` when a step leads out of the positions there are,
/// `GX_RC_NOT_FOUND` when an axis it names is not known, `GX_RC_ERROR_GENERIC` when a pointer is NULL.
///
/// ```c
/// if (gx_follow(&position, &item) == GX_RC_SUCCESS && (position.mask & 1) != 0)
///     printf("x is at %ld\n", (long)position.axes[0]);
/// ```
#[export]
pub unsafe extern "C" fn gx_follow(position: *mut Vector, item: *const Item) -> c_int {
    // SAFETY: two objects that do not overlap.
    let (Some(position), Some(item)) = (unsafe { (position.as_mut(), item.as_ref()) }) else {
        return GX_RC_ERROR_GENERIC;
    };
    if !matches!(item.kind, GX_MOVE | GX_STEP | GX_POSITION) {
        return GX_RC_SUCCESS;
    }
    match position.core_mut().follow(item.vector.core(), item.kind == GX_STEP) {
        Ok(()) => GX_RC_SUCCESS,
        Err(Lost::Range) => GX_RC_RANGE,
        Err(Lost::Unknown) => GX_RC_NOT_FOUND,
    }
}

/// The check in the confirmation of the move with this number, for its host to compare. target is where all axes are to
/// be after it, and the velocity then in force; its mask flags those that the session has named up to this move.
/// Returns 0 to 126, or -`GX_RC_ERROR_GENERIC` when target is NULL or number is none.
///
/// ```c
/// if (item.kind == GX_CONFIRMED && item.code != gx_check(&target, 5462))
///     puts("the machine is elsewhere");
/// ```
#[export]
pub unsafe extern "C" fn gx_check(target: *const Vector, number: c_int) -> c_int {
    // SAFETY: target is NULL or valid.
    match (unsafe { target.as_ref() }, u16::try_from(number)) {
        (Some(target), Ok(number)) if number <= gx::NUMBER_MAX => target.core().check(target.mask, number).into(),
        _ => -GX_RC_ERROR_GENERIC,
    }
}

/// What a host asks for, if it is one of those.
pub(super) const fn control_of(control: c_int) -> Option<Control> {
    Some(match control {
        GX_CONTROL_QUERY => Control::Query,
        GX_CONTROL_HOLD => Control::Hold,
        GX_CONTROL_RESUME => Control::Resume,
        GX_CONTROL_STOP => Control::Stop,
        _ => return None,
    })
}

/// Fills a buffer of C's with as many commands or notices as fit: `next` writes one and returns its length, 0 when
/// there is none that fits. Returns how many bytes were written.
///
/// # Safety
///
/// buf is NULL or points to cap writable bytes, which nobody else touches meanwhile.
pub(super) unsafe fn fill(buf: *mut c_void, cap: c_int, mut next: impl FnMut(&mut [u8]) -> usize) -> c_int {
    // SAFETY: the same contract.
    let Some(mut room) = (unsafe { room(buf, cap) }) else { return -GX_RC_ERROR_GENERIC };
    let mut written = 0_usize;
    loop {
        let length = next(room);
        if length == 0 {
            return int(written);
        }
        written = written.wrapping_add(length);
        room = room.get_mut(length..).unwrap_or_default();
    }
}

/// The room that a pointer and a size from C stand for, for the core to write to.
///
/// # Safety
///
/// As for [`fill`].
unsafe fn room<'a>(buf: *mut c_void, cap: c_int) -> Option<&'a mut [u8]> {
    // SAFETY: the same contract; the core only writes to it, and returns how many bytes from its beginning.
    unsafe { room_of(buf, cap).map(|room| &mut *(core::ptr::from_mut(room) as *mut [u8])) }
}
