//! A stream means the same messages however it is cut, each of them an intact frame of the stream; and every
//! intact frame of the stream is one of them, unless it stands inside another.
#![no_main]

use std::ffi::{c_int, c_void};

use deltarobot::protocol::*;
use deltarobot::protocol_ext::*;
use deltarobot::sizes::{DP_BUFSIZE, DP_DATA_MAX_SIZE};
use deltarobot_fuzz::contract::{Standing, frame, standing};
use deltarobot_fuzz::input::Input;
use deltarobot_fuzz::message::{empty_ring, payload, unread};
use deltarobot_fuzz::object::Plain;
use deltarobot_protocols::deltarobot::{Frame, NoFrame, Receiver, receiver_room};
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

    for stop_every in [0, 1, 3] {
        let (by_each, same_rest) = by_each(&stream, idx, cuts, stop_every);
        assert_eq!(by_each, heard);
        assert_eq!(unread(&same_rest), unread(&rest));
    }
    let waiting = unread(&rest);
    for (by_receiver, in_parts) in
        [(by_bytes_received(&stream), "by bytes"), (by_parts_received(&stream, cuts), "in parts")]
    {
        let (received, mut receiver) = by_receiver;
        assert_eq!(received, heard, "{in_parts}");
        check_receiver_idle(&mut receiver, &waiting);
    }
    check_idle(&mut rest);
});

type FrameReceiver = Receiver<{ receiver_room(DP_DATA_MAX_SIZE) }>;

fn wire(found: Frame<'_>) -> Wire {
    frame(found.opcode.0, found.payload)
}

/// The receiver of the core, a byte at a time. It is asked only when it says so.
fn by_bytes_received(stream: &[u8]) -> (Vec<Wire>, FrameReceiver) {
    let (mut receiver, mut heard) = (FrameReceiver::new(), Vec::new());
    for byte in stream {
        if receiver.byte(*byte).expect("there is room, as frames are fetched") {
            while let Ok(found) = receiver.next() {
                heard.push(wire(found));
            }
        }
    }
    (heard, receiver)
}

/// In parts of any length: those that are taken into its buffer first, and those whose frames it finds where they are.
fn by_parts_received(stream: &[u8], cuts: &[u8]) -> (Vec<Wire>, FrameReceiver) {
    let (mut receiver, mut heard) = (FrameReceiver::new(), Vec::new());
    let mut rest = stream;
    for part in 0.. {
        let cut = cuts.get(part % 8).map_or(usize::MAX, |&cut| usize::from(cut) * 3 + 1);
        let (mut now, later) = rest.split_at(cut.min(rest.len()));
        rest = later;
        if cut % 2 == 0 {
            while !now.is_empty() {
                let taken = receiver.take(now);
                assert!(taken > 0, "there is room, as frames are fetched");
                now = &now[taken..];
                while let Ok(found) = receiver.next() {
                    heard.push(wire(found));
                }
            }
        } else {
            while let Ok(found) = receiver.next_of(&mut now) {
                heard.push(wire(found));
            }
            assert!(now.is_empty());
        }
        if rest.is_empty() {
            break;
        }
    }
    (heard, receiver)
}

/// On a quiet line the receiver gives up what it waits for, and delivers the frames in it, as the grammar says, applied at
/// each place. There may be garbage in front, too short to be judged.
fn check_receiver_idle(receiver: &mut FrameReceiver, waiting: &[u8]) {
    assert!(waiting.is_empty() || !receiver.is_empty());
    let mut rest = waiting;
    let mut skipped = false;
    while !rest.is_empty() {
        let Standing::Intact(opcode, payload) = standing(rest) else {
            (rest, skipped) = (&rest[1..], true);
            continue;
        };
        let found = receiver.next_idle(&mut ()).map(wire);
        assert_eq!(found, Ok(frame(opcode, &payload)));
        (rest, skipped) = (&rest[payload.len() + 5..], false);
    }
    let none = receiver.next_idle(&mut ()).map(wire);
    assert!(none == Err(NoFrame::Garbage) || !skipped && none == Err(NoFrame::Waiting), "{none:?}");
    assert!(receiver.is_empty());
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

/// Feeds the stream by `dp_process_each` in parts of any length, and stops at each `stop_every`th message.
fn by_each(stream: &[u8], idx: usize, cuts: &[u8], stop_every: usize) -> (Vec<Wire>, Box<ProtocolData>) {
    struct Listener {
        heard: Vec<Wire>,
        stop_every: usize,
    }
    unsafe extern "C" fn on_msg(msg: *const ProtocolMsg, usr: *mut c_void) -> c_int {
        let listener = unsafe { &mut *usr.cast::<Listener>() };
        listener.heard.push(received(&mut unsafe { &*msg }.copy()));
        c_int::from(listener.stop_every > 0 && listener.heard.len().is_multiple_of(listener.stop_every))
    }
    let mut data = empty_ring(idx);
    let mut listener = Listener { heard: Vec::new(), stop_every };
    let mut rest = stream;
    for part in 0.. {
        let cut = cuts.get(part % 8).map_or(usize::MAX, |&cut| usize::from(cut) * 3);
        let (now, later) = rest.split_at(cut.min(rest.len()));
        rest = later;
        let mut from = 0;
        loop {
            let heard_before = listener.heard.len();
            let usr = (&raw mut listener).cast();
            let (buf, size) = (now[from..].as_ptr().cast(), (now.len() - from) as c_int);
            let taken = unsafe { dp_process_each(&raw mut *data, buf, size, Some(on_msg), usr) };
            from += usize::try_from(taken).unwrap();
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
        if part > stream.len() {
            // All cuts are 0.
            return by_each(stream, idx, &[], stop_every);
        }
    }
    drain(&mut data, &mut Vec::new());
    (listener.heard, data)
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
