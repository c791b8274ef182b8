//! The GX protocol's codec: any bytes, in any pieces, mean the same; what was read can be written and read again; what
//! is written is read as it was meant; paths come back.
#![no_main]

use std::ffi::c_int;
use std::ptr::null;

use deltarobot_fuzz::gx_abi::*;
use deltarobot_fuzz::input::Input;
use libfuzzer_sys::fuzz_target;

const POSITIONS: std::ops::RangeInclusive<i32> = -(1 << 27)..=(1 << 27) - 1;

fuzz_target!(|input: &[u8]| {
    let mut input = Input(input);
    match input.byte() % 5 {
        0 => stream(&mut input, false, Receiver::default()),
        1 => stream(&mut input, true, Receiver::default()),
        2 => {
            // A receiver in memory that holds anything.
            let mut receiver = Receiver::default();
            receiver.0.as_flattened_mut().fill_with(|| input.byte());
            let host = input.byte() & 1 == 1;
            stream(&mut input, host, receiver);
        }
        3 => contour(&mut input),
        _ => posted(&mut input),
    }
});

fn receive(host: bool, receiver: &mut Receiver, bytes: &[u8]) -> (usize, Item) {
    let mut item = Box::new(Item { kind: -1, ..Item::default() });
    let receive = if host { gx_notices_receive } else { gx_commands_receive };
    let taken = unsafe { receive(receiver, bytes.as_ptr().cast(), bytes.len() as c_int, &raw mut *item) };
    let taken = usize::try_from(taken).unwrap();
    assert!(taken <= bytes.len() && (taken == bytes.len() || item.kind != NONE));
    in_range(&item);
    (taken, *item)
}

fn idle(host: bool, receiver: &mut Receiver) -> Item {
    let mut item = Item { kind: -1, ..Item::default() };
    let idle = if host { gx_notices_idle } else { gx_commands_idle };
    assert_eq!(unsafe { idle(receiver, &raw mut item) }, 0);
    in_range(&item);
    item
}

fn in_range(item: &Item) {
    assert!((NONE..=POSITION).contains(&item.kind), "{item:?}");
    if item.kind == NONE {
        return;
    }
    assert!(item.number.value < 1 << 14 && item.number.format <= 2 && (1..=2).contains(&item.format));
    assert!(item.code < 128 && item.period < 1 << 14 && item.vector.velocity < 1 << 14 && item.vector.mask < 128);
    for axis in 0..6 {
        let value = item.vector.axes[axis];
        assert!(if item.vector.mask >> axis & 1 == 1 { POSITIONS.contains(&value) } else { value == 0 }, "{item:?}");
    }
}

/// Everything that bytes say, in pieces as the input cuts them, each an allocation of its own.
fn stream(input: &mut Input, host: bool, mut receiver: Receiver) {
    let fresh = receiver.0.as_flattened().iter().all(|byte| *byte == 0);
    let mut by_bytes = receiver.clone();
    let (mut heard, mut heard_by_bytes) = (Vec::new(), Vec::new());
    while !input.is_empty() {
        let length = usize::from(input.byte());
        let piece = Box::<[u8]>::from(input.slice(length));
        let (mut rest, mut calls) = (&piece[..], 0);
        while !rest.is_empty() {
            let (taken, item) = receive(host, &mut receiver, rest);
            if item.kind != NONE {
                heard.push(item);
            }
            rest = &rest[taken..];
            calls += 1;
            assert!(calls <= 2 * piece.len() + 1);
        }
        for byte in &piece {
            while {
                let (taken, item) = receive(host, &mut by_bytes, std::slice::from_ref(byte));
                if item.kind != NONE {
                    heard_by_bytes.push(item);
                }
                taken == 0
            } {}
        }
    }
    let last = (idle(host, &mut receiver), idle(host, &mut by_bytes));
    assert_eq!(idle(host, &mut receiver).kind, NONE);
    if fresh {
        assert_eq!(heard, heard_by_bytes);
        assert_eq!(last.0, last.1);
        heard.iter().for_each(|item| written_again(host, item));
    }
}

/// What was read can be written, and is then read as the same.
fn written_again(host: bool, item: &Item) {
    let kinds: &[c_int] =
        if host { &[MALFORMED, COMPLETED, REFUSED, POSITION] } else { &[MALFORMED, MOVE, STEP, REPORTING] };
    assert!(kinds.contains(&item.kind), "{item:?}");
    let mut room = [0; ENCODED_MAX];
    let (buf, cap, format) = (room.as_mut_ptr().cast(), room.len() as c_int, c_int::from(item.format));
    let (number, vector) = (&raw const item.number, &raw const item.vector);
    let length = unsafe {
        match item.kind {
            MOVE => gx_write_move(format, number, vector, buf, cap),
            STEP if item.vector.axes.contains(&-64) => return assert!(gx_write_step(number, vector, buf, cap) == -10),
            STEP => gx_write_step(number, vector, buf, cap),
            REPORTING => gx_write_reporting(format, number, item.period.into(), buf, cap),
            COMPLETED => gx_write_completed(number, buf, cap),
            REFUSED => gx_write_refused(format, number, item.code.into(), buf, cap),
            POSITION => gx_write_position(format, vector, buf, cap),
            _ => return,
        }
    };
    let written = &room[..usize::try_from(length).unwrap()];
    for cap in 0..written.len() {
        let mut short = vec![0; cap].into_boxed_slice();
        if item.kind == MOVE {
            let short = short.as_mut_ptr().cast();
            assert_eq!(unsafe { gx_write_move(format, number, vector, short, cap as c_int) }, -3);
        }
    }
    let mut receiver = Receiver::default();
    let (taken, mut read) = receive(host, &mut receiver, written);
    assert_eq!(taken, written.len());
    if read.kind == NONE {
        read = idle(host, &mut receiver);
    }
    assert_eq!(read, *item);
}

fn int32(input: &mut Input) -> i32 {
    i32::from_le_bytes([(); 4].map(|()| input.byte()))
}

/// A path, of any values: each segment is refused, or leads there.
fn contour(input: &mut Input) {
    let mut contour = Box::<Contour>::default();
    let mask = input.byte();
    assert_eq!(unsafe { gx_contour_init(&raw mut *contour, mask) }, c_int::from(mask & 0x3F == 0));
    let (mut receiver, mut at, mut path) = (Receiver::default(), Vector::default(), [0_i32; 6]);
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
        let mut room = [0; ENCODED_MAX];
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
        let (taken, item) = receive(false, &mut receiver, bytes);
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
    let mut command = Box::new(Vector {
        velocity: u16::from_le_bytes([input.byte(), input.byte()]),
        mask: input.byte(),
        axes: [0; 6],
    });
    let shift = input.byte() & 31;
    command.axes = [(); 6].map(|()| int32(input) >> shift);
    let before = *command;
    let mut buffer = Box::<Buffer>::default();
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
        assert_eq!(*command, before);
        assert_eq!(rc == 0, buffer.length != 0);
        let range = if is_short { -63..=63 } else { POSITIONS };
        let fits = before.mask & 0x80 == 0
            && (before.mask & 0x40 == 0 || before.velocity < 1 << 14)
            && (0..6).all(|axis| before.mask >> axis & 1 == 0 || range.contains(&before.axes[axis]));
        assert_eq!(rc, if !fits { 10 } else { c_int::from(before.mask == 0) });
        if rc == 0 {
            let mut read = Box::<Vector>::default();
            let rc: c_int = unsafe { unpack(&raw mut *buffer, &raw mut *read) };
            assert_eq!((rc, read.mask), (0, before.mask));
            for axis in 0..6 {
                assert_eq!(read.axes[axis], if before.mask >> axis & 1 == 1 { before.axes[axis] } else { 0 });
            }
        }
        // Any buffer: the command changes only when that is told.
        let mut any = Box::<Buffer>::default();
        any.length = input.byte() % 32;
        any.bytes = [(); 28].map(|()| input.byte());
        any.bytes[0] = if is_short { b'*' } else { b'!' };
        let rc: c_int = unsafe { unpack(&raw mut *any, &raw mut *command) };
        assert!(matches!(rc, 0 | 8 | 10));
        if rc != 0 {
            assert_eq!(*command, before);
        }
        *command = before;
    }
}
