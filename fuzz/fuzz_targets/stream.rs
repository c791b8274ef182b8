//! A stream means the same messages however it is cut, each of them an intact frame of the stream; and every
//! intact frame of the stream is one of them, unless it stands inside another.
#![no_main]

use std::ffi::{c_int, c_void};

use deltarobot::protocol::*;
use deltarobot::protocol_ext::*;
use deltarobot::receiver::*;
use deltarobot::sizes::DP_BUFSIZE;
use deltarobot_fuzz::contract::{Standing, frame, standing};
use deltarobot_fuzz::input::Input;
use deltarobot_fuzz::message::{empty_ring, payload, unread};
use deltarobot_fuzz::object::{Object, Plain};
use libfuzzer_sys::fuzz_target;

/// A message that was received: the bytes that `dp_send` makes of it.
type Wire = Vec<u8>;

fuzz_target!(|input: &[u8]| {
    let mut input = Input(input);
    let cuts = input.slice(8);
    let idx = usize::from(input.byte()) % DP_BUFSIZE;
    let mut stream = input.line();
    while !input.is_empty() {
        stream.extend(input.line());
    }

    let (heard, mut rest) = by_pairs(&stream, idx, |at| usize::from(cuts.get(at % 8).copied().unwrap_or(0)) + 1);
    check_places(&stream, &heard, unread(&rest).len());

    let (by_bytes, same_rest) = by_pairs(&stream, 0, |_| 1);
    assert_eq!(by_bytes, heard);
    assert_eq!(unread(&same_rest), unread(&rest));

    let waiting = unread(&rest);
    let mut receiver = Object::default();
    assert_eq!(by_receiver(&stream, &receiver), heard);
    check_receiver_idle(&receiver, &waiting);
    for stop_every in [0, 1, 3] {
        let mut same_rest = empty_ring(idx);
        let each = |buf, size, usr| unsafe { dp_process_each(&raw mut *same_rest, buf, size, Some(on_msg), usr) };
        assert_eq!(by_each(&stream, cuts, stop_every, each), heard);
        drain(&mut same_rest, &mut Vec::new());
        assert_eq!(unread(&same_rest), waiting);

        let each = |buf, size, usr| unsafe { dp_receiver_each(receiver.ptr(), buf, size, Some(on_msg), usr) };
        assert_eq!(by_each(&stream, cuts, stop_every, each), heard);
        check_receiver_idle(&receiver, &waiting);
    }
    receiver.scribble(&mut Input(&stream), 0..0);
    by_receiver(&stream, &receiver);
    check_idle(&mut rest);
});

/// Feeds the stream to a receiver byte by byte. It is asked when it says so.
fn by_receiver(stream: &[u8], receiver: &Object<Receiver>) -> Vec<Wire> {
    let (mut msg, mut heard) = (Box::new(ProtocolMsg::zero()), Vec::new());
    for byte in stream {
        match unsafe { dp_receiver_byte(receiver.ptr(), *byte) } {
            0 => (),
            // Full, if it held anything before.
            due => {
                while unsafe { dp_receiver_next(receiver.ptr(), &raw mut *msg) } == DP_RC_SUCCESS {
                    heard.push(received(&mut msg));
                }
                if due < 0 {
                    assert!(unsafe { dp_receiver_byte(receiver.ptr(), *byte) } >= 0, "there is room now");
                }
            }
        }
    }
    heard
}

/// On a quiet line the receiver gives up what it waits for, and delivers the frames in it, as the grammar says, applied at
/// each place. There may be garbage in front, too short to be judged.
fn check_receiver_idle(receiver: &Object<Receiver>, waiting: &[u8]) {
    let mut msg = Box::new(ProtocolMsg::zero());
    let mut idle = || match unsafe { dp_receiver_idle(receiver.ptr(), &raw mut *msg) } {
        DP_RC_SUCCESS => Ok(received(&mut msg)),
        code => Err(code),
    };
    let mut rest = waiting;
    let mut skipped = false;
    while !rest.is_empty() {
        let Standing::Intact(opcode, payload) = standing(rest) else {
            (rest, skipped) = (&rest[1..], true);
            continue;
        };
        assert_eq!(idle(), Ok(frame(opcode, &payload)));
        (rest, skipped) = (&rest[payload.len() + 5..], false);
    }
    let none = idle();
    assert!(none == Err(DP_RC_GARBAGE) || !skipped && none == Err(DP_RC_NO_FRAME), "{none:?}");
    assert_eq!(idle(), Err(DP_RC_NO_FRAME), "it is empty");
}

fn received(msg: &mut ProtocolMsg) -> Wire {
    unsafe extern "C" fn keep(buf: *mut c_void, bytes: c_int, usr: *mut c_void) -> c_int {
        let bytes = unsafe { std::slice::from_raw_parts(buf.cast::<u8>(), bytes as usize) };
        unsafe { &mut *usr.cast::<Wire>() }.extend(bytes);
        77
    }
    let mut wire = Wire::new();
    assert_eq!(unsafe { dp_send(msg, Some(keep), (&raw mut wire).cast()) }, 77);
    assert_eq!(wire, frame(msg.opcode, &payload(&msg)));
    wire
}

fn drain(data: &mut ProtocolData, heard: &mut Vec<Wire>) {
    let mut msg = ProtocolMsg::zero();
    while unsafe { dp_recv(data, &raw mut msg) } == DP_RC_SUCCESS {
        heard.push(received(&mut msg));
    }
    // What was skipped once is gone, and what is waited for is left alone.
    assert_eq!(unsafe { dp_recv(data, &raw mut msg) }, DP_RC_NO_FRAME);
}

/// Feeds the stream by `dp_process` and drains the ring after each; `cut` says how long each part may be.
fn by_pairs(stream: &[u8], idx: usize, cut: impl Fn(usize) -> usize) -> (Vec<Wire>, Box<ProtocolData>) {
    let mut data = empty_ring(idx);
    let mut heard = Vec::new();
    let mut rest = stream;
    let mut at = 0;
    while !rest.is_empty() {
        let room = DP_BUFSIZE - data.m_sz as usize;
        assert!(room > 0, "a drained ring has room");
        let (now, later) = rest.split_at(cut(at).min(room).min(rest.len()));
        let buf = now.as_ptr().cast_mut().cast();
        assert_eq!(unsafe { dp_process(&raw mut *data, buf, now.len() as c_int) }, DP_RC_SUCCESS);
        drain(&mut data, &mut heard);
        rest = later;
        at += 1;
    }
    (heard, data)
}

/// What the callback of `dp_process_each` and `dp_receiver_each` has heard.
struct Listener {
    heard: Vec<Wire>,
    stop_every: usize,
}

unsafe extern "C" fn on_msg(msg: *const ProtocolMsg, usr: *mut c_void) -> c_int {
    let listener = unsafe { &mut *usr.cast::<Listener>() };
    listener.heard.push(received(&mut unsafe { &*msg }.copy()));
    c_int::from(listener.stop_every > 0 && listener.heard.len().is_multiple_of(listener.stop_every))
}

/// Feeds the stream in parts of any length, and stops at each `stop_every`th message.
fn by_each(
    stream: &[u8],
    cuts: &[u8],
    stop_every: usize,
    mut each: impl FnMut(*const c_void, c_int, *mut c_void) -> c_int,
) -> Vec<Wire> {
    let mut listener = Listener { heard: Vec::new(), stop_every };
    let mut rest = stream;
    for part in 0.. {
        // All the cuts may be 0.
        let cut = cuts.get(part % 8).map_or(usize::MAX, |&cut| usize::from(cut) * 3 + usize::from(part > 100));
        let (now, later) = rest.split_at(cut.min(rest.len()));
        rest = later;
        let mut from = 0;
        loop {
            let heard_before = listener.heard.len();
            let usr = (&raw mut listener).cast();
            let (buf, size) = (now[from..].as_ptr().cast(), (now.len() - from) as c_int);
            from += usize::try_from(each(buf, size, usr)).unwrap();
            let stopped = stop_every > 0
                && listener.heard.len() > heard_before
                && listener.heard.len().is_multiple_of(stop_every);
            assert!(stopped || from == now.len());
            if !stopped {
                break;
            }
        }
        if rest.is_empty() {
            break;
        }
    }
    listener.heard
}

/// Finds the place in the stream of each message: the first where its bytes are, behind the one before. No other
/// intact frame may stand between them.
fn check_places(stream: &[u8], heard: &[Wire], rest: usize) {
    let end = stream.len() - rest;
    let mut at = 0;
    let mut heard = heard.iter();
    let mut next = heard.next();
    while at < end {
        match standing(&stream[at..]) {
            Standing::Intact(opcode, payload) => {
                let wire = next.unwrap_or_else(|| panic!("the frame at {at} was not delivered"));
                assert_eq!(*wire, frame(opcode, &payload), "at {at}");
                at += wire.len();
                next = heard.next();
            }
            _ => at += 1,
        }
    }
    assert_eq!((at, next), (end, None));
    // What is left is waited for because it may become a frame.
    assert!(rest == 0 || standing(&stream[end..]) == Standing::Incomplete);
}

/// On a quiet line the rest is given up, and the frames in it delivered.
fn check_idle(data: &mut ProtocolData) {
    let rest = unread(&data);
    let mut msg = Box::new(ProtocolMsg::zero());
    let mut heard = Vec::new();
    let rc = loop {
        match unsafe { dp_recv_idle(data, &raw mut *msg) } {
            DP_RC_SUCCESS => heard.push(received(&mut msg)),
            rc => break rc,
        }
    };
    assert_eq!(data.m_sz, 0);
    let mut at = 0;
    let mut dropped = false;
    let mut expected = Vec::new();
    while at < rest.len() {
        dropped = true;
        at += 1;
        if let Some(Standing::Intact(opcode, payload)) = rest.get(at..).map(standing) {
            dropped = false;
            at += payload.len() + 5;
            expected.push(frame(opcode, &payload));
            // The loop skips a byte first: look at this place too.
            while let Standing::Intact(opcode, payload) = standing(&rest[at..]) {
                at += payload.len() + 5;
                expected.push(frame(opcode, &payload));
            }
        }
    }
    assert_eq!(heard, expected);
    assert_eq!(rc, if dropped { DP_RC_GARBAGE } else { DP_RC_NO_FRAME });
}
