//! Any calls in any order, with any struct contents and any arguments that the contract allows (NULL, or a whole
//! object): each does what the contract says, and nothing else.
#![no_main]

use std::ffi::{c_char, c_int, c_void};
use std::ptr::{null, null_mut};

use deltarobot::protocol::*;
use deltarobot::protocol_ext::*;
use deltarobot::sizes::{DP_BUFSIZE, DP_DATA_MAX_SIZE};
use deltarobot_fuzz::contract::{Ring, frame};
use deltarobot_fuzz::input::Input;
use deltarobot_fuzz::message::{empty_ring, fields, is_sound, payload, unread};
use deltarobot_fuzz::object::Plain;
use libfuzzer_sys::fuzz_target;

/// Each struct is an allocation of its own, so that the address sanitizer sees the first byte too far.
struct World {
    rings: [Box<ProtocolData>; 2],
    msg: Box<ProtocolMsg>,
}

fuzz_target!(|input: &[u8]| {
    let mut input = Input(input);
    let mut world = World { rings: [empty_ring(0), empty_ring(0)], msg: Box::new(ProtocolMsg::zero()) };
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
fn meaning(data: &ProtocolData) -> Ring {
    Ring { unread: unread(data), idx: if is_sound(data) { data.m_idx as usize } else { 0 } }
}

fn assert_ring(data: &ProtocolData, expected: &Ring) {
    assert!(is_sound(data), "idx {} sz {}", data.m_idx, data.m_sz);
    assert_eq!(unread(data), expected.unread);
    assert_eq!(data.m_idx as usize, expected.idx);
}

fn process(data: &mut ProtocolData, input: &mut Input, variant: u8) {
    let mut bytes = input.line().into_boxed_slice();
    let before = data.copy();
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
        assert_eq!(rc, DP_RC_ERROR_GENERIC);
        assert_eq!(data.bytes(), before.bytes());
        return;
    }
    let mut expected = meaning(&before);
    let lost = expected.process(&bytes[..size as usize]);
    assert_eq!(rc, if lost { DP_RC_OVERFLOW } else { DP_RC_SUCCESS });
    assert_ring(data, &expected);
}

fn recv(data: &mut ProtocolData, msg: &mut ProtocolMsg, idle: bool, variant: u8) {
    let before = (data.copy(), msg.copy());
    let data_ptr = if variant & 6 == 6 { null_mut() } else { &raw mut *data };
    let msg_ptr = if variant & 5 == 5 { null_mut() } else { &raw mut *msg };
    let rc = unsafe { if idle { dp_recv_idle(data_ptr, msg_ptr) } else { dp_recv(data_ptr, msg_ptr) } };
    if data_ptr.is_null() || msg_ptr.is_null() {
        assert_eq!(rc, DP_RC_ERROR_GENERIC);
        assert_eq!(data.bytes(), before.0.bytes());
        if msg_ptr.is_null() {
            assert_eq!(fields(msg), fields(&before.1));
        } else {
            assert_eq!(fields(msg), fields(&ProtocolMsg { opcode: 0xFF, ..before.1 }));
        }
        return;
    }
    let mut expected = meaning(&before.0);
    match expected.recv(idle) {
        Ok((opcode, payload)) => {
            assert_eq!(rc, DP_RC_SUCCESS);
            let mut data = before.1.data;
            for (to, from) in data.iter_mut().zip(&payload) {
                *to = *from as c_char;
            }
            assert_eq!(
                fields(msg),
                fields(&ProtocolMsg { opcode, data_s: payload.len() as c_int, data, checksum_ok: 1 })
            );
        }
        Err(code) => {
            assert_eq!(rc, code);
            assert_eq!(fields(msg), fields(&ProtocolMsg { opcode: 0xFF, ..before.1 }));
        }
    }
    assert_eq!(data.m_buf, before.0.m_buf);
    assert_ring(data, &expected);
}

/// What happens in the callback of `dp_process_each`.
struct Listener {
    data: *mut ProtocolData,
    heard: Vec<(u8, Vec<u8>)>,
    stop_at: usize,
    re_enter: Option<(u8, Box<[u8]>)>,
}

unsafe extern "C" fn on_msg(msg: *const ProtocolMsg, usr: *mut c_void) -> c_int {
    let (msg, listener) = unsafe { (&*msg, &mut *usr.cast::<Listener>()) };
    assert_eq!(msg.checksum_ok, 1);
    listener.heard.push((msg.opcode, payload(&msg)));
    // Not for ever: a callback that feeds a frame for each it hears is never done.
    if let Some((what, bytes)) = &mut listener.re_enter
        && listener.heard.len() <= 4
    {
        let mut other = ProtocolMsg::zero();
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

fn each(data: &mut ProtocolData, input: &mut Input, variant: u8) {
    let bytes = input.line().into_boxed_slice();
    let stop_at = usize::from(input.byte() % 8);
    let re_enter = (variant == 3).then(|| (input.byte(), input.line().into_boxed_slice()));
    let before = data.copy();
    let data: *mut ProtocolData = data;
    let mut listener = Listener { data, heard: Vec::new(), stop_at, re_enter };
    let usr = (&raw mut listener).cast();
    let (buf, size): (*const c_void, _) = (bytes.as_ptr().cast(), bytes.len() as c_int);
    let (data_ptr, buf, size, func): (_, _, _, MsgFunc) = match variant {
        4 => (null_mut(), buf, size, Some(on_msg)),
        5 => (data, null(), input.int(), Some(on_msg)),
        6 => (data, buf, size, None),
        7 => (data, buf, input.int().min(-1), Some(on_msg)),
        _ => (data, buf, size, Some(on_msg)),
    };
    let taken = unsafe { dp_process_each(data_ptr, buf, size, func, usr) };
    let data = unsafe { &*data };
    if data_ptr.is_null() || func.is_none() || size < 0 || (buf.is_null() && size > 0) {
        assert_eq!(taken, -DP_RC_ERROR_GENERIC);
        assert!(listener.heard.is_empty());
        assert_eq!(data.bytes(), before.bytes());
        return;
    }
    let bytes = &bytes[..size as usize];
    assert!(is_sound(data));
    let taken = usize::try_from(taken).unwrap();
    assert!(taken <= bytes.len());
    if listener.re_enter.is_some() {
        return;
    }
    // As if the ring had no end.
    let mut expected = Ring { unread: unread(&before), idx: 0 };
    expected.unread.extend(bytes);
    let mut heard = Vec::new();
    while (stop_at == 0 || heard.len() < stop_at)
        && let Ok(message) = expected.recv(false)
    {
        heard.push(message);
    }
    assert_eq!(listener.heard, heard);
    let mut left = unread(data);
    left.extend(&bytes[taken..]);
    assert_eq!(left, expected.unread);
    assert!(taken == bytes.len() || heard.len() == stop_at);
}

/// What happens in the callback of `dp_send`.
struct Sink {
    frames: Vec<Vec<u8>>,
    answer: c_int,
    re_enter: *mut ProtocolMsg,
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

fn send(msg: &mut ProtocolMsg, input: &mut Input, variant: u8) {
    let before = msg.copy();
    let answer = input.int();
    let msg: *mut ProtocolMsg = msg;
    let re_enter = if variant & 1 == 1 { msg } else { null_mut() };
    let mut sink = Sink { frames: Vec::new(), answer, re_enter };
    let usr = (&raw mut sink).cast();
    let msg_ptr = if variant == 6 { null_mut() } else { msg };
    let func: SendFunc = if variant == 7 { None } else { Some(sendfunc) };
    let rc = unsafe { dp_send(msg_ptr, func, usr) };
    assert_eq!(fields(unsafe { &*msg }), fields(&before));
    let size = usize::try_from(before.data_s).ok().filter(|&size| size <= DP_DATA_MAX_SIZE);
    match size {
        Some(_) if !msg_ptr.is_null() && func.is_some() => {
            assert_eq!(rc, answer);
            let wire = frame(before.opcode, &payload(&before));
            assert_eq!(sink.frames, vec![wire; 1 + usize::from(!re_enter.is_null())]);
        }
        _ => {
            assert_eq!(rc, DP_RC_ERROR_GENERIC);
            assert!(sink.frames.is_empty());
        }
    }
}

fn init(data: &mut ProtocolData, variant: u8) {
    if variant == 7 {
        assert_eq!(unsafe { dp_init(null_mut()) }, DP_RC_ERROR_GENERIC);
        return;
    }
    assert_eq!(unsafe { dp_init(data) }, DP_RC_SUCCESS);
    assert_eq!((data.m_idx, data.m_sz), (0, 0));
}

fn scribble_ring(data: &mut ProtocolData, input: &mut Input, variant: u8) {
    if variant & 1 == 1 {
        let bytes = input.line();
        for (to, from) in data.m_buf.iter_mut().zip(bytes.iter().cycle()) {
            *to = *from as c_char;
        }
    }
    if variant & 2 == 2 {
        data.m_idx = input.int();
    } else {
        data.m_idx = c_int::from(input.byte()) % DP_BUFSIZE as c_int;
    }
    data.m_sz = input.int();
}

fn scribble_msg(msg: &mut ProtocolMsg, input: &mut Input) {
    msg.opcode = input.byte();
    msg.data_s = input.int();
    msg.checksum_ok = input.int();
    for (to, from) in msg.data.iter_mut().zip(input.line()) {
        *to = from as c_char;
    }
}
