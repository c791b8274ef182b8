//! How a message comes out of the ring.
//!
//! On hosts by the short ways of the core, where they lead; each in a function of its own, that ends in a jump to the
//! next: every register that one needs would have to be saved by all calls of `dp_recv`, most of which only find that
//! the frame is not complete yet.

use core::ffi::{c_int, c_uchar};
use core::mem::MaybeUninit;

use super::{DP_RC_ERROR_GENERIC, DP_RC_GARBAGE, DP_RC_NO_FRAME, DP_RC_SUCCESS, ProtocolMsg};
use crate::memory::int;
use crate::sizes::DP_DATA_MAX_SIZE;
use deltarobot_protocols::bytes;
use deltarobot_protocols::config::FAST;
use deltarobot_protocols::deltarobot::{Glance, NoFrame, Opcode, Proof, Ring};

/// What `opcode` becomes when no frame was received: never the opcode of one.
const NO_OPCODE: c_uchar = 0xFF;

/// The next message of a ring that there is.
///
/// # Safety
///
/// Of all functions here: msg points to a writable message outside the ring.
#[inline(always)]
pub(crate) unsafe fn next_message(ring: &mut Ring, msg: *mut ProtocolMsg) -> c_int {
    // SAFETY: the same contract; a ring and a message are what any_message asks for.
    unsafe {
        if !FAST {
            return any_message(ring, msg, false);
        }
        match ring.glance() {
            Some(Glance::Waiting) => no_frame(msg, NoFrame::Waiting),
            Some(Glance::Whole { start, opcode, size }) => whole(ring, msg, opcode, start, size),
            Some(Glance::NoStart) => no_start(ring, msg),
            Some(Glance::NoHead) => no_head(ring, msg),
            None => unclear(ring, msg),
        }
    }
}

/// Any state of the ring, or none.
///
/// # Safety
///
/// As for `dp_recv`.
#[cfg_attr(target_pointer_width = "64", inline(never))]
#[cfg_attr(not(target_pointer_width = "64"), inline(always))]
pub(crate) unsafe fn any_message(data: *mut Ring, msg: *mut ProtocolMsg, idle: bool) -> c_int {
    if msg.is_null() {
        return DP_RC_ERROR_GENERIC;
    }
    // SAFETY: data is NULL, or a ring by the contract of this function; msg is not NULL, so a message outside the ring.
    // Chars and bytes that may be uninitialised have the same layout.
    unsafe {
        let Some(ring) = data.as_mut() else { return no_message(msg, DP_RC_ERROR_GENERIC) };
        match ring.search(idle) {
            Ok(frame) => {
                (*msg).data_s = int(frame.payload.len());
                (*msg).opcode = frame.opcode.0;
                frame.payload.copy_to(&mut *(&raw mut (*msg).data).cast::<[MaybeUninit<u8>; DP_DATA_MAX_SIZE]>());
                (*msg).checksum_ok = 1;
                DP_RC_SUCCESS
            }
            Err(none) => no_frame(msg, none),
        }
    }
}

/// A whole candidate. Sizes that the compiler knows make shorter code: beside the 5 bytes of every frame, requests have
/// none, an acknowledgement one, moves and reports 12 to 16.
#[inline(never)]
unsafe fn whole(ring: &mut Ring, msg: *mut ProtocolMsg, opcode: u8, start: usize, size: usize) -> c_int {
    // SAFETY: the same contract.
    unsafe {
        match size {
            13..=21 => whole_of::<true>(ring, msg, opcode, start, size),
            22.. => whole_long(ring, msg, opcode, start, size),
            5 => whole_of::<true>(ring, msg, opcode, start, 5),
            6 => whole_of::<true>(ring, msg, opcode, start, 6),
            _ => whole_short(ring, msg, opcode, start, size),
        }
    }
}

/// 17 bytes of payload or more: here the compiler learns it.
#[inline(never)]
unsafe fn whole_long(ring: &mut Ring, msg: *mut ProtocolMsg, opcode: u8, start: usize, size: usize) -> c_int {
    // SAFETY: the same contract.
    unsafe { whole_of::<true>(ring, msg, opcode, start, size.max(22)) }
}

#[inline(never)]
unsafe fn whole_short(ring: &mut Ring, msg: *mut ProtocolMsg, opcode: u8, start: usize, size: usize) -> c_int {
    // SAFETY: the same contract.
    unsafe { whole_of::<true>(ring, msg, opcode, start, size) }
}

/// A whole candidate, the first that the call meets or the second. What lies beyond a second one is left to the search,
/// whose time is bounded however many there are.
#[inline(always)]
unsafe fn whole_of<const FIRST: bool>(
    ring: &mut Ring,
    msg: *mut ProtocolMsg,
    opcode: u8,
    start: usize,
    size: usize,
) -> c_int {
    // SAFETY: the same contract; a ring and a message are what any_message asks for.
    unsafe {
        match ring.prove(start, Opcode(opcode), size) {
            Proof::Frame(payload) => deliver(msg, opcode, payload),
            Proof::Garbage if FIRST => return behind_garbage(ring, msg),
            Proof::Garbage => return behind_second(ring, msg),
            Proof::Unclear if FIRST => return across(ring, msg, opcode, start, size),
            Proof::Unclear => return any_message(ring, msg, false),
        }
        ring.drop_frame(start, size);
        DP_RC_SUCCESS
    }
}

/// A whole candidate, across the ring's end.
#[inline(never)]
unsafe fn across(ring: &mut Ring, msg: *mut ProtocolMsg, opcode: u8, start: usize, size: usize) -> c_int {
    // SAFETY: the same contract; a ring and a message are what any_message asks for.
    unsafe {
        // One by one, which never becomes a call of memset.
        let mut room = core::array::from_fn(|_| 0);
        match ring.prove_across(start, Opcode(opcode), size, &mut room) {
            Proof::Frame(payload) => deliver(msg, opcode, payload),
            Proof::Garbage => return behind_garbage(ring, msg),
            Proof::Unclear => return any_message(ring, msg, false),
        }
        ring.drop_frame(start, size);
        DP_RC_SUCCESS
    }
}

/// A head that may lie across the ring's end.
#[inline(never)]
unsafe fn unclear(ring: &mut Ring, msg: *mut ProtocolMsg) -> c_int {
    // SAFETY: the same contract; a ring and a message are what any_message asks for.
    unsafe {
        match ring.look() {
            Some((start, Ok((opcode, size)))) => across(ring, msg, opcode.0, start, size),
            Some((_, Err(NoFrame::Waiting))) => no_frame(msg, NoFrame::Waiting),
            Some((_, Err(NoFrame::Garbage))) => behind_garbage(ring, msg),
            None => any_message(ring, msg, false),
        }
    }
}

/// A byte that begins no frame, or none.
#[inline(never)]
unsafe fn no_start(ring: &mut Ring, msg: *mut ProtocolMsg) -> c_int {
    // SAFETY: the same contract.
    unsafe { if ring.is_empty() { no_frame(msg, NoFrame::Waiting) } else { pass_garbage(ring, msg) } }
}

/// A start, behind which the head is wrong or has yet to come.
#[inline(never)]
unsafe fn no_head(ring: &mut Ring, msg: *mut ProtocolMsg) -> c_int {
    // SAFETY: the same contract.
    unsafe { if ring.awaits_head() { no_frame(msg, NoFrame::Waiting) } else { behind_garbage(ring, msg) } }
}

/// A byte that is known to begin no frame.
#[inline(never)]
unsafe fn behind_garbage(ring: &mut Ring, msg: *mut ProtocolMsg) -> c_int {
    // SAFETY: the same contract.
    unsafe { pass_garbage(ring, msg) }
}

#[inline(always)]
unsafe fn pass_garbage(ring: &mut Ring, msg: *mut ProtocolMsg) -> c_int {
    // SAFETY: the same contract; a ring and a message are what any_message asks for.
    unsafe {
        match ring.pass() {
            Some(Ok((passed, opcode, size))) => second(ring, msg, opcode.0, passed, size),
            Some(Err(none)) => no_frame(msg, none),
            None => any_message(ring, msg, false),
        }
    }
}

/// A whole candidate behind garbage.
#[inline(never)]
unsafe fn second(ring: &mut Ring, msg: *mut ProtocolMsg, opcode: u8, passed: usize, size: usize) -> c_int {
    let start = ring.skip(passed);
    // SAFETY: the same contract.
    unsafe { whole_of::<false>(ring, msg, opcode, start, size) }
}

/// A second candidate's first byte, known to begin no frame too.
#[inline(never)]
unsafe fn behind_second(ring: &mut Ring, msg: *mut ProtocolMsg) -> c_int {
    match ring.pass() {
        // SAFETY: the same contract.
        Some(Err(none)) => return unsafe { no_frame(msg, none) },
        Some(Ok((passed, ..))) => _ = ring.skip(passed),
        None => {}
    }
    // SAFETY: the same contract; a ring and a message are what any_message asks for.
    unsafe { any_message(ring, msg, false) }
}

/// There is no frame.
#[inline(always)]
unsafe fn no_frame(msg: *mut ProtocolMsg, none: NoFrame) -> c_int {
    let code = match none {
        NoFrame::Waiting => DP_RC_NO_FRAME,
        NoFrame::Garbage => DP_RC_GARBAGE,
    };
    // SAFETY: the same contract.
    unsafe { no_message(msg, code) }
}

#[inline(always)]
unsafe fn no_message(msg: *mut ProtocolMsg, code: c_int) -> c_int {
    // SAFETY: as the contract of these functions asks. The message may be uninitialised: so no reference to it is made.
    unsafe { (*msg).opcode = NO_OPCODE };
    code
}

/// Hands a payload in one piece to the caller. It goes first: what was read of it for the checksum need not be read
/// again then.
#[inline(always)]
unsafe fn deliver(msg: *mut ProtocolMsg, opcode: c_uchar, payload: &[u8]) {
    // SAFETY: as the contract of these functions asks; chars and bytes as above.
    unsafe {
        let data = &mut *(&raw mut (*msg).data).cast::<[MaybeUninit<u8>; DP_DATA_MAX_SIZE]>();
        bytes::copy(payload, data, MaybeUninit::new);
        (*msg).opcode = opcode;
        (*msg).data_s = int(payload.len());
        (*msg).checksum_ok = 1;
    }
}
