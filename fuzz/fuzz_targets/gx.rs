//! The GX protocol's codec: any bytes, in any pieces, mean the same; what was read can be written and read again; what
//! is written is read as it was meant; paths come back.
#![no_main]

use std::ffi::{c_int, c_void};
use std::ptr::null;

use deltarobot::contouring_protocol::*;
use deltarobot::gx::write::*;
use deltarobot::gx::*;
use deltarobot_fuzz::input::Input;
use deltarobot_fuzz::object::{Object, Plain};
use libfuzzer_sys::fuzz_target;

const POSITIONS: std::ops::RangeInclusive<i32> = -(1 << 27)..=(1 << 27) - 1;

/// The receiver of either end.
trait Receiver: Plain {
    const KINDS: &[c_int];
    const RECEIVE: unsafe extern "C" fn(*mut Self, *const c_void, c_int, *mut Item) -> c_int;
    const IDLE: unsafe extern "C" fn(*mut Self, *mut Item) -> c_int;

    fn receive(&mut self, bytes: &[u8]) -> (usize, Item) {
        let mut item = Box::new(Item { kind: -1, ..Item::zero() });
        let taken = unsafe { Self::RECEIVE(self, bytes.as_ptr().cast(), bytes.len() as c_int, &raw mut *item) };
        let taken = usize::try_from(taken).unwrap();
        assert!(taken <= bytes.len() && (taken == bytes.len() || item.kind != GX_NONE));
        in_range(&item);
        (taken, *item)
    }

    fn idle(&mut self) -> Item {
        let mut item = Item { kind: -1, ..Item::zero() };
        assert_eq!(unsafe { Self::IDLE(self, &raw mut item) }, 0);
        in_range(&item);
        item
    }
}

impl Receiver for Commands {
    const KINDS: &[c_int] = &[GX_MALFORMED, GX_MOVE, GX_STEP, GX_REPORTING, GX_CONTROL];
    const RECEIVE: unsafe extern "C" fn(*mut Self, *const c_void, c_int, *mut Item) -> c_int = gx_commands_receive;
    const IDLE: unsafe extern "C" fn(*mut Self, *mut Item) -> c_int = gx_commands_idle;
}

impl Receiver for Notices {
    const KINDS: &[c_int] = &[GX_MALFORMED, GX_COMPLETED, GX_REFUSED, GX_POSITION, GX_CONFIRMED, GX_STATUS];
    const RECEIVE: unsafe extern "C" fn(*mut Self, *const c_void, c_int, *mut Item) -> c_int = gx_notices_receive;
    const IDLE: unsafe extern "C" fn(*mut Self, *mut Item) -> c_int = gx_notices_idle;
}

fuzz_target!(|input: &[u8]| {
    let mut input = Input(input);
    match input.byte() % 5 {
        0 => stream::<Commands>(&mut input, true),
        1 => stream::<Notices>(&mut input, true),
        2 if input.byte() & 1 == 1 => stream::<Notices>(&mut input, false),
        2 => stream::<Commands>(&mut input, false),
        3 => contour(&mut input),
        _ => posted(&mut input),
    }
});

type Fields = (c_int, (u16, u8), [u8; 2], u16, (u16, u8, [i32; 6]));

/// An item without its padding.
fn fields(item: &Item) -> Fields {
    let Item { kind, number, format, code, period, vector } = item;
    (*kind, (number.value, number.format), [*format, *code], *period, (vector.velocity, vector.mask, vector.axes))
}

fn in_range(item: &Item) {
    assert!((GX_NONE..=GX_STATUS).contains(&item.kind), "{item:?}");
    if item.kind == GX_NONE {
        return;
    }
    assert!(item.number.value < 1 << 14 && item.number.format <= 2 && (1..=2).contains(&item.format));
    assert!(item.code < 128 && item.period < 1 << 14 && item.vector.velocity < 1 << 14 && item.vector.mask < 128);
    for axis in 0..6 {
        let value = item.vector.axes[axis];
        assert!(if item.vector.mask >> axis & 1 == 1 { POSITIONS.contains(&value) } else { value == 0 }, "{item:?}");
    }
}

/// Everything that bytes say, in pieces as the input cuts them, each an allocation of its own. The receiver is fresh, or in
/// memory that holds anything.
fn stream<R: Receiver>(input: &mut Input, fresh: bool) {
    let mut receiver = Object::<R>::default();
    if !fresh {
        receiver.scribble(input, 0..0);
    }
    let receiver = unsafe { &mut *receiver.ptr() };
    let mut by_bytes = receiver.copy();
    let (mut heard, mut heard_by_bytes) = (Vec::new(), Vec::new());
    while !input.is_empty() {
        let length = usize::from(input.byte());
        let piece = Box::<[u8]>::from(input.slice(length));
        let (mut rest, mut calls) = (&piece[..], 0);
        while !rest.is_empty() {
            let (taken, item) = receiver.receive(rest);
            if item.kind != GX_NONE {
                heard.push(item);
            }
            rest = &rest[taken..];
            calls += 1;
            assert!(calls <= 2 * piece.len() + 1);
        }
        for byte in &piece {
            while {
                let (taken, item) = by_bytes.receive(std::slice::from_ref(byte));
                if item.kind != GX_NONE {
                    heard_by_bytes.push(item);
                }
                taken == 0
            } {}
        }
    }
    let last = (receiver.idle(), by_bytes.idle());
    assert_eq!(receiver.idle().kind, GX_NONE);
    if fresh {
        assert!(heard.iter().map(fields).eq(heard_by_bytes.iter().map(fields)), "{heard:?} {heard_by_bytes:?}");
        assert_eq!(fields(&last.0), fields(&last.1));
        heard.iter().for_each(written_again::<R>);
    }
}

/// What was read can be written, and is then read as the same.
fn written_again<R: Receiver>(item: &Item) {
    assert!(R::KINDS.contains(&item.kind), "{item:?}");
    let mut room = [0; GX_ENCODED_MAX as usize];
    let (buf, cap, format) = (room.as_mut_ptr().cast(), room.len() as c_int, c_int::from(item.format));
    let (number, vector) = (&raw const item.number, &raw const item.vector);
    let length = unsafe {
        match item.kind {
            GX_MOVE => gx_write_move(format, number, vector, buf, cap),
            GX_STEP if item.vector.axes.contains(&-64) => {
                return assert!(gx_write_step(number, vector, buf, cap) == -10);
            }
            GX_STEP => gx_write_step(number, vector, buf, cap),
            GX_REPORTING => gx_write_reporting(format, number, item.period.into(), buf, cap),
            GX_COMPLETED => gx_write_completed(number, buf, cap),
            GX_REFUSED => gx_write_refused(format, number, item.code.into(), buf, cap),
            GX_POSITION => gx_write_position(format, vector, buf, cap),
            GX_CONFIRMED => gx_write_confirmed(number, item.code.into(), buf, cap),
            GX_STATUS => gx_write_status(format, item.period.into(), item.code.into(), buf, cap),
            GX_CONTROL if c_int::from(item.code) != GX_CONTROL_UNKNOWN => {
                gx_write_control(format, number, item.code.into(), buf, cap)
            }
            _ => return,
        }
    };
    let written = &room[..usize::try_from(length).unwrap()];
    for cap in 0..written.len() {
        let mut short = vec![0; cap].into_boxed_slice();
        if item.kind == GX_MOVE {
            let short = short.as_mut_ptr().cast();
            assert_eq!(unsafe { gx_write_move(format, number, vector, short, cap as c_int) }, -3);
        }
    }
    let mut receiver = R::zero();
    let (taken, mut read) = receiver.receive(written);
    assert_eq!(taken, written.len());
    if read.kind == GX_NONE {
        read = receiver.idle();
    }
    assert_eq!(fields(&read), fields(item));
}

fn int32(input: &mut Input) -> i32 {
    i32::from_le_bytes([(); 4].map(|()| input.byte()))
}

/// A path, of any values: each segment is refused, or leads there.
fn contour(input: &mut Input) {
    let mut contour = Box::new(Contour::zero());
    let mask = input.byte();
    assert_eq!(unsafe { gx_contour_init(&raw mut *contour, mask) }, c_int::from(mask & 0x3F == 0));
    let (mut receiver, mut at, mut path) = (Commands::zero(), Vector::zero(), [0_i32; 6]);
    while !input.is_empty() {
        let how = input.byte();
        if how == 0xFF {
            assert_eq!(unsafe { gx_contour_start(&raw mut *contour, null()) }, 0);
            at.mask = 0;
        }
        for value in &mut path {
            *value = if how & 0x80 == 0 {
                value.wrapping_add(i32::from(input.byte() as i8))
            } else {
                int32(input) >> (how >> 3 & 7)
            };
        }
        let velocity = if how & 1 == 1 { c_int::from(input.byte()) * 70 } else { -1 };
        let mut room = [0; GX_ENCODED_MAX as usize];
        let length = unsafe {
            let (buf, cap) = (room.as_mut_ptr().cast(), room.len() as c_int);
            gx_contour_segment(&raw mut *contour, null(), path.as_ptr(), velocity, buf, cap)
        };
        let used = |axis: &usize| mask >> axis & 1 == 1;
        let fits = (0..6).filter(used).all(|axis| POSITIONS.contains(&path[axis])) && velocity < 1 << 14;
        if mask & 0x3F == 0 || !fits {
            assert_eq!(length, if mask & 0x3F == 0 { -1 } else { -10 });
            continue;
        }
        let bytes = &room[..usize::try_from(length).unwrap()];
        let (taken, item) = receiver.receive(bytes);
        assert_eq!(taken, bytes.len());
        assert_eq!(unsafe { gx_follow(&raw mut at, &raw const item) }, 0);
        for axis in (0..6).filter(used) {
            assert_eq!(at.axes[axis], path[axis]);
        }
        assert!(velocity < 0 || c_int::from(at.velocity) == velocity);
    }
}

/// The posted functions, with anything in their structs.
fn posted(input: &mut Input) {
    let mut command = Box::new(CPVectorCommand::zero());
    command.targetVelocity = u16::from_le_bytes([input.byte(), input.byte()]);
    command.axisMask = input.byte();
    let shift = input.byte() & 31;
    command.axisPosition = [(); 6].map(|()| int32(input) >> shift);
    let before = command.copy();
    let mut buffer = Box::new(CPPackedVectorCommandBuffer::zero());
    for is_short in [false, true] {
        let (pack, unpack) = if is_short {
            (
                PackCPShortVectorCommand as unsafe extern "C" fn(_, _) -> _,
                UnpackCPShortVectorCommand as unsafe extern "C" fn(_, _) -> _,
            )
        } else {
            (PackCPVectorCommand as _, UnpackCPVectorCommand as _)
        };
        let rc: c_int = unsafe { pack(&raw mut *buffer, &raw mut *command) };
        assert_eq!(command.bytes(), before.bytes());
        assert_eq!(rc == 0, buffer.length != 0);
        let range = if is_short { -63..=63 } else { POSITIONS };
        let fits = before.axisMask & 0x80 == 0
            && (before.axisMask & 0x40 == 0 || before.targetVelocity < 1 << 14)
            && (0..6).all(|axis| before.axisMask >> axis & 1 == 0 || range.contains(&before.axisPosition[axis]));
        assert_eq!(rc, if !fits { 10 } else { c_int::from(before.axisMask == 0) });
        if rc == 0 {
            let mut read = Box::new(CPVectorCommand::zero());
            let rc: c_int = unsafe { unpack(&raw mut *buffer, &raw mut *read) };
            assert_eq!((rc, read.axisMask), (0, before.axisMask));
            for axis in 0..6 {
                assert_eq!(
                    read.axisPosition[axis],
                    if before.axisMask >> axis & 1 == 1 { before.axisPosition[axis] } else { 0 }
                );
            }
        }
        // Any buffer: the command changes only when that is told.
        let mut any = Box::new(CPPackedVectorCommandBuffer::zero());
        any.length = input.byte() % 32;
        any.bytes = [(); 28].map(|()| input.byte());
        any.bytes[0] = if is_short { b'*' } else { b'!' };
        let rc: c_int = unsafe { unpack(&raw mut *any, &raw mut *command) };
        assert!(matches!(rc, 0 | 8 | 10));
        if rc != 0 {
            assert_eq!(command.bytes(), before.bytes());
        }
        *command = before.copy();
    }
}
