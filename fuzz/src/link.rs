//! What the fuzz targets of both ends of a link share: the line between them, bytes given and asked for, time.

use std::collections::VecDeque;
use std::ffi::{c_int, c_long, c_ulong, c_void};

use crate::input::Input;
use crate::object::Event;

/// Both ends of a link, and the line between them.
pub trait World {
    fn new(input: &mut Input) -> Self;

    /// Does what the input says.
    fn step(&mut self, input: &mut Input);

    /// Asks what can be asked at any time.
    fn look(&self);

    /// With nobody at the other end, all that was requested ends by its deadlines.
    fn everything_ends(&mut self);
}

/// A fuzz target's run.
pub fn run<W: World>(input: &[u8]) {
    let mut input = Input(input);
    let mut world = W::new(&mut input);
    while !input.is_empty() {
        world.step(&mut input);
        world.look();
    }
    world.everything_ends();
}

/// Bytes on their way.
pub type Line = VecDeque<u8>;

/// Takes bytes from a line, which may do something to them; whether they are as they were sent.
pub fn carry(line: &mut Line, input: &mut Input, variant: u8) -> (Vec<u8>, bool) {
    let count = match usize::from(input.byte()) {
        0 => line.len(),
        count => count.min(line.len()),
    };
    let mut bytes: Vec<_> = line.drain(..count).collect();
    if variant < 4 || bytes.is_empty() {
        return (bytes, true);
    }
    let at = usize::from(input.byte()) % bytes.len();
    match variant {
        4 => drop(bytes.remove(at)),
        5 => bytes[at] ^= 1 << (input.byte() % 8),
        6 => bytes.truncate(at),
        _ => bytes.extend_from_within(at..),
    }
    (bytes, false)
}

/// Gives bytes to a session, in allocations that end with them; what is fetched makes room for the next. Whether it
/// took them all.
pub fn give<W>(
    world: &mut W,
    bytes: &[u8],
    receive: impl Fn(&W, *const c_void, c_int) -> c_int,
    fetch: impl Fn(&mut W),
) -> bool {
    let mut rest = Box::<[u8]>::from(bytes);
    for _ in 0..=2 * bytes.len() {
        let taken = receive(world, rest.as_ptr().cast(), rest.len() as c_int);
        rest = rest[usize::try_from(taken).unwrap()..].into();
        if rest.is_empty() {
            return true;
        }
        fetch(world);
    }
    false
}

/// What a session writes into room for so many bytes. `leaves_rest`: and leaves the rest of
/// it alone.
pub fn written(cap: usize, leaves_rest: bool, output: impl Fn(*mut c_void, c_int) -> c_int) -> Vec<u8> {
    let mut room = vec![0x55_u8; cap].into_boxed_slice();
    let length = usize::try_from(output(room.as_mut_ptr().cast(), cap as c_int)).unwrap();
    assert!(!leaves_rest || room[length..].iter().all(|byte| *byte == 0x55));
    room[..length].to_vec()
}

/// Fetches events until there is none, at most so many, and at most as many as there can be; whether there is an end of
/// them.
pub fn fetch<W, E: Event>(
    world: &mut W,
    times: usize,
    most: usize,
    poll: impl Fn(&W, *mut E) -> c_int,
    happened: impl Fn(&mut W, &E),
) -> bool {
    for _ in 0..times.min(most) {
        let mut event = Box::new(E::zero());
        *event.kind() = -1;
        let rc = poll(world, &raw mut *event);
        let is_none = *event.kind() == 0;
        assert_eq!(rc, if is_none { 6 } else { 0 });
        happened(world, &event);
        if is_none {
            return true;
        }
    }
    times < most
}

/// A deadline that a session returns.
pub fn in_range(deadline: c_long) -> c_long {
    assert!((-1..1 << 32).contains(&deadline), "{deadline}");
    deadline
}

/// A time later: any at all, before now, soon, at the deadline or just before it.
pub fn later(now: c_ulong, deadline: c_long, input: &mut Input, variant: u8) -> c_ulong {
    now.wrapping_add(match variant {
        0 => c_ulong::from_le_bytes(input.bytes::<8>()),
        1 => (c_ulong::from(input.byte()) << 24).wrapping_neg(),
        2..4 => c_ulong::from(input.byte()) * 10,
        4 => deadline.max(1) as c_ulong - 1,
        _ => deadline.max(0) as c_ulong,
    })
}
