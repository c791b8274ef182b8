//! Any calls in any order, with any struct contents and any arguments that the contract allows (NULL, or a whole
//! object): each does what the contract says, and nothing else.
#![no_main]

use std::ffi::{c_char, c_int, c_void};
use std::ptr::{null, null_mut};

use deltarobot_fuzz::abi::{
    self, DP_BUFSIZE, DP_DATA_MAX_SIZE, Data, ERROR_GENERIC, Msg, OVERFLOW, SUCCESS, dp_init, dp_process,
    dp_process_each, dp_recv, dp_recv_idle, dp_send,
};
use deltarobot_fuzz::contract::{Ring, frame};
use deltarobot_fuzz::input::Input;
use libfuzzer_sys::fuzz_target;

/// Each struct is an allocation of its own, so that the address sanitizer sees the first byte too far.
struct World {
    rings: [Box<Data>; 2],
    msg: Box<Msg>,
}

fuzz_target!(|input: &[u8]| {
    let mut input = Input(input);
    let mut world = World { rings: [Box::default(), Box::default()], msg: Box::default() };
    while !input.is_empty() {
        let choice = input.byte();
        let World { rings, msg } = &mut world;
        let ring = &mut rings[usize::from(choice >> 7)];
        let variant = choice >> 4 & 7;
        match choice % 12 {
            0..3 => process(ring, &mut input, variant),
            3 | 4 => recv(ring, msg, false, variant),
            5 => recv(ring, msg, true, variant),
            6 | 7 => each(ring, &mut input, variant),
            8 => send(msg, &mut input, variant),
            9 => init(ring, variant),
            10 => scribble_ring(ring, &mut input, variant),
            _ => scribble_msg(msg, &mut input),
        }
    }
});

/// What the ring means before a call.
fn meaning(data: &Data) -> Ring {
    Ring { unread: data.unread(), idx: if data.is_sound() { data.idx as usize } else { 0 } }
}

fn assert_ring(data: &Data, expected: &Ring) {
    assert!(data.is_sound(), "idx {} sz {}", data.idx, data.sz);
    assert_eq!(data.unread(), expected.unread);
    assert_eq!(data.idx as usize, expected.idx);
}

fn process(data: &mut Data, input: &mut Input, variant: u8) {
    let mut bytes = input.line().into_boxed_slice();
    let before = data.clone();
    let buf: *mut c_void = bytes.as_mut_ptr().cast();
    let size = bytes.len() as c_int;
    let (data_ptr, buf, size) = match variant {
        5 => (null_mut(), buf, size),
        6 => (&raw mut *data, null_mut(), input.int()),
        7 => (&raw mut *data, buf, input.int().min(-1)),
        _ => (&raw mut *data, buf, size),
    };
    let rc = unsafe { dp_process(data_ptr, buf, size) };
    if data_ptr.is_null() || size < 0 || (buf.is_null() && size > 0) {
        assert_eq!(rc, ERROR_GENERIC);
        assert_eq!(*data, before);
        return;
    }
    let mut expected = meaning(&before);
    let lost = expected.process(&bytes[..size as usize]);
    assert_eq!(rc, if lost { OVERFLOW } else { SUCCESS });
    assert_ring(data, &expected);
}

fn recv(data: &mut Data, msg: &mut Msg, idle: bool, variant: u8) {
    let before = (data.clone(), msg.clone());
    let data_ptr = if variant & 6 == 6 { null_mut() } else { &raw mut *data };
    let msg_ptr = if variant & 5 == 5 { null_mut() } else { &raw mut *msg };
    let rc = unsafe { if idle { dp_recv_idle(data_ptr, msg_ptr) } else { dp_recv(data_ptr, msg_ptr) } };
    if data_ptr.is_null() || msg_ptr.is_null() {
        assert_eq!(rc, ERROR_GENERIC);
        assert_eq!(*data, before.0);
        if msg_ptr.is_null() {
            assert_eq!(*msg, before.1);
        } else {
            assert_eq!(*msg, Msg { opcode: 0xFF, ..before.1 });
        }
        return;
    }
    let mut expected = meaning(&before.0);
    match expected.recv(idle) {
        Ok((opcode, payload)) => {
            assert_eq!(rc, SUCCESS);
            let mut data = before.1.data;
            for (to, from) in data.iter_mut().zip(&payload) {
                *to = *from as c_char;
            }
            assert_eq!(*msg, Msg { opcode, data_s: payload.len() as c_int, data, checksum_ok: 1 });
        }
        Err(code) => {
            assert_eq!(rc, code);
            assert_eq!(*msg, Msg { opcode: 0xFF, ..before.1 });
        }
    }
    assert_eq!(data.buf, before.0.buf);
    assert_ring(data, &expected);
}

/// What happens in the callback of `dp_process_each`.
struct Listener {
    data: *mut Data,
    heard: Vec<(u8, Vec<u8>)>,
    stop_at: usize,
    re_enter: Option<(u8, Box<[u8]>)>,
}

unsafe extern "C" fn on_msg(msg: *const Msg, usr: *mut c_void) -> c_int {
    let (msg, listener) = unsafe { (&*msg, &mut *usr.cast::<Listener>()) };
    assert_eq!(msg.checksum_ok, 1);
    listener.heard.push((msg.opcode, msg.payload()));
    // Not for ever: a callback that feeds a frame for each it hears is never done.
    if let Some((what, bytes)) = &mut listener.re_enter
        && listener.heard.len() <= 4
    {
        let mut other = Msg::new();
        unsafe {
            match *what % 4 {
                0 => drop(dp_process(listener.data, bytes.as_mut_ptr().cast(), bytes.len() as c_int)),
                1 => drop(dp_recv(listener.data, &raw mut other)),
                2 => drop(dp_recv_idle(listener.data, &raw mut other)),
                _ => drop(dp_init(listener.data)),
            }
        }
    }
    c_int::from(listener.heard.len() == listener.stop_at)
}

fn each(data: &mut Data, input: &mut Input, variant: u8) {
    let bytes = input.line().into_boxed_slice();
    let stop_at = usize::from(input.byte() % 8);
    let re_enter = (variant == 3).then(|| (input.byte(), input.line().into_boxed_slice()));
    let before = data.clone();
    let data: *mut Data = data;
    let mut listener = Listener { data, heard: Vec::new(), stop_at, re_enter };
    let usr = (&raw mut listener).cast();
    let (buf, size): (*const c_void, _) = (bytes.as_ptr().cast(), bytes.len() as c_int);
    let (data_ptr, buf, size, func) = match variant {
        4 => (null_mut(), buf, size, Some(on_msg as abi::MsgFunc)),
        5 => (data, null(), input.int(), Some(on_msg as abi::MsgFunc)),
        6 => (data, buf, size, None),
        7 => (data, buf, input.int().min(-1), Some(on_msg as abi::MsgFunc)),
        _ => (data, buf, size, Some(on_msg as abi::MsgFunc)),
    };
    let taken = unsafe { dp_process_each(data_ptr, buf, size, func, usr) };
    let data = unsafe { &*data };
    if data_ptr.is_null() || func.is_none() || size < 0 || (buf.is_null() && size > 0) {
        assert_eq!(taken, -ERROR_GENERIC);
        assert!(listener.heard.is_empty());
        assert_eq!(*data, before);
        return;
    }
    let bytes = &bytes[..size as usize];
    assert!(data.is_sound());
    let taken = usize::try_from(taken).unwrap();
    assert!(taken <= bytes.len());
    if listener.re_enter.is_some() {
        return;
    }
    // As if the ring had no end.
    let mut expected = Ring { unread: before.unread(), idx: 0 };
    expected.unread.extend(bytes);
    let mut heard = Vec::new();
    while (stop_at == 0 || heard.len() < stop_at)
        && let Ok(message) = expected.recv(false)
    {
        heard.push(message);
    }
    assert_eq!(listener.heard, heard);
    let mut left = data.unread();
    left.extend(&bytes[taken..]);
    assert_eq!(left, expected.unread);
    assert!(taken == bytes.len() || heard.len() == stop_at);
}

/// What happens in the callback of `dp_send`.
struct Sink {
    frames: Vec<Vec<u8>>,
    answer: c_int,
    re_enter: *mut Msg,
}

unsafe extern "C" fn sendfunc(buf: *mut c_void, bytes: c_int, usr: *mut c_void) -> c_int {
    let sink = unsafe { &mut *usr.cast::<Sink>() };
    let frame = unsafe { std::slice::from_raw_parts_mut(buf.cast::<u8>(), usize::try_from(bytes).unwrap()) };
    sink.frames.push(frame.to_vec());
    if !sink.re_enter.is_null() {
        let again = std::mem::replace(&mut sink.re_enter, null_mut());
        let before = frame.to_vec();
        unsafe { dp_send(again, Some(sendfunc), usr) };
        assert_eq!(frame, before);
    }
    frame.fill(0xA5);
    sink.answer
}

fn send(msg: &mut Msg, input: &mut Input, variant: u8) {
    let before = msg.clone();
    let answer = input.int();
    let msg: *mut Msg = msg;
    let re_enter = if variant & 1 == 1 { msg } else { null_mut() };
    let mut sink = Sink { frames: Vec::new(), answer, re_enter };
    let usr = (&raw mut sink).cast();
    let msg_ptr = if variant == 6 { null_mut() } else { msg };
    let func = if variant == 7 { None } else { Some(sendfunc as abi::SendFunc) };
    let rc = unsafe { dp_send(msg_ptr, func, usr) };
    assert_eq!(unsafe { &*msg }, &before);
    let size = usize::try_from(before.data_s).ok().filter(|&size| size <= DP_DATA_MAX_SIZE);
    match size {
        Some(_) if !msg_ptr.is_null() && func.is_some() => {
            assert_eq!(rc, answer);
            let wire = frame(before.opcode, &before.payload());
            assert_eq!(sink.frames, vec![wire; 1 + usize::from(!re_enter.is_null())]);
        }
        _ => {
            assert_eq!(rc, ERROR_GENERIC);
            assert!(sink.frames.is_empty());
        }
    }
}

fn init(data: &mut Data, variant: u8) {
    if variant == 7 {
        assert_eq!(unsafe { dp_init(null_mut()) }, ERROR_GENERIC);
        return;
    }
    assert_eq!(unsafe { dp_init(data) }, SUCCESS);
    assert_eq!((data.idx, data.sz), (0, 0));
}

fn scribble_ring(data: &mut Data, input: &mut Input, variant: u8) {
    if variant & 1 == 1 {
        let bytes = input.line();
        for (to, from) in data.buf.iter_mut().zip(bytes.iter().cycle()) {
            *to = *from;
        }
    }
    if variant & 2 == 2 {
        data.idx = input.int();
    } else {
        data.idx = c_int::from(input.byte()) % DP_BUFSIZE as c_int;
    }
    data.sz = input.int();
}

fn scribble_msg(msg: &mut Msg, input: &mut Input) {
    msg.opcode = input.byte();
    msg.data_s = input.int();
    msg.checksum_ok = input.int();
    for (to, from) in msg.data.iter_mut().zip(input.line()) {
        *to = from as c_char;
    }
}
