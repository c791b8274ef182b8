//! The storage of the drop-in pair: a ring of bytes whose fields C can see.

use core::ffi::c_int;

use deltarobot_protocols::bytes::{Wrapped, copy_into_ring, wrap};
use deltarobot_protocols::deltarobot::{FRAME_HEAD, FRAME_OVERHEAD, Opcode, Verdict, judge_head, judge_tail};

use crate::memory::int;

/// A ring buffer for bytes from the wire. Its fields are never trusted: when one is out of range, it counts as empty.
#[derive(Clone, Debug)]
#[repr(C)]
pub(crate) struct Ring<const SIZE: usize> {
    pub(crate) bytes: [u8; SIZE],
    /// Where the first unread byte is, below `SIZE`.
    pub(crate) start: c_int,
    /// Number of unread bytes, at most `SIZE`.
    pub(crate) used: c_int,
}

/// Bytes were lost for want of room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Overflow;

impl<const SIZE: usize> Ring<SIZE> {
    /// Makes a ring whose fields are out of range an empty one.
    #[inline(always)]
    pub(crate) fn heal(&mut self) -> (usize, usize) {
        let (start, used) = self.fields();
        if start >= SIZE || used > SIZE {
            (self.start, self.used) = (0, 0);
            return (0, 0);
        }
        (start, used)
    }

    /// Number of bytes that fit without loss, in a ring whose fields are in range.
    pub(crate) fn room(&self) -> usize {
        SIZE.wrapping_sub(self.fields().1)
    }

    /// Whether there is no byte.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.used == 0
    }

    /// Adds bytes at the end. Where they don't fit, the oldest make room for them; of more bytes than the whole ring
    /// holds the first are taken.
    #[inline(always)]
    pub(crate) fn append(&mut self, mut input: &[u8]) -> Result<(), Overflow> {
        let (start, used) = self.heal();
        let end = wrap::<SIZE>(start.wrapping_add(used));
        let mut wanted = used.wrapping_add(input.len());
        let mut result = Ok(());
        if wanted > SIZE {
            // A full ring starts where it ends.
            input = input.get(..SIZE).unwrap_or(input);
            self.start = int(wrap::<SIZE>(end.wrapping_add(input.len())));
            wanted = SIZE;
            result = Err(Overflow);
        }
        self.used = int(wanted);
        copy_into_ring(input, &mut self.bytes, end);
        result
    }

    /// Whether the ring, whose fields are in range, starts with the head of a frame and holds as many bytes as that
    /// takes.
    #[inline(always)]
    pub(crate) fn judge_head(&self, longest: usize) -> Verdict {
        let (begin, length) = self.fields();
        judge_head(&Wrapped { ring: &self.bytes, begin, length }, longest)
    }

    /// Takes out the frame whose head was found: its payload, or `None` when it is none.
    #[inline(always)]
    pub(crate) fn take_frame(&mut self, opcode: Opcode, length: usize) -> Option<Wrapped<'_, SIZE>> {
        let (begin, used) = self.fields();
        let Verdict::Frame { .. } = judge_tail(&Wrapped { ring: &self.bytes, begin, length: used }, opcode, length)
        else {
            return None;
        };
        self.skip(length.wrapping_add(FRAME_OVERHEAD));
        Some(Wrapped { ring: &self.bytes, begin: wrap::<SIZE>(begin.wrapping_add(FRAME_HEAD)), length })
    }

    /// Drops bytes from the start, of which there are so many.
    #[inline(always)]
    pub(crate) fn skip(&mut self, bytes: usize) {
        let (start, used) = self.fields();
        (self.start, self.used) = (int(wrap::<SIZE>(start.wrapping_add(bytes))), int(used.wrapping_sub(bytes)));
    }

    /// Where the unread bytes begin and how many they are.
    #[inline(always)]
    const fn fields(&self) -> (usize, usize) {
        (self.start.cast_unsigned() as usize, self.used.cast_unsigned() as usize)
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::{Overflow, Ring};
    use deltarobot_protocols::deltarobot::{Verdict, judge};

    /// A ring as a list of bytes, and the grammar applied to it.
    #[derive(Debug, PartialEq)]
    struct Model {
        unread: Vec<u8>,
        start: usize,
    }

    impl Model {
        fn of<const SIZE: usize>(ring: &Ring<SIZE>) -> Self {
            let (start, used) = (ring.start as u32 as usize, ring.used as u32 as usize);
            let (start, used) = if start < SIZE && used <= SIZE { (start, used) } else { (0, 0) };
            Self { unread: ring.bytes.iter().cycle().skip(start).take(used).copied().collect(), start }
        }
        fn append(&mut self, input: &[u8], size: usize) -> Result<(), Overflow> {
            let fits = self.unread.len() + input.len() <= size;
            self.unread.extend_from_slice(&input[..input.len().min(size)]);
            let lost = self.unread.len().saturating_sub(size);
            self.skip(lost, size);
            if fits { Ok(()) } else { Err(Overflow) }
        }

        fn skip(&mut self, bytes: usize, size: usize) {
            self.unread.drain(..bytes);
            self.start = (self.start + bytes) % size;
        }

        fn next(&mut self, longest: usize, idle: bool, size: usize) -> Option<(u8, Vec<u8>)> {
            loop {
                match judge(self.unread.as_slice(), longest) {
                    Verdict::Frame { opcode, length } => {
                        let payload = self.unread[3..length + 3].to_vec();
                        self.skip(length + 5, size);
                        return Some((opcode.0, payload));
                    }
                    Verdict::Needs(_) if !idle || self.unread.is_empty() => return None,
                    _ => self.skip(1, size),
                }
            }
        }
    }

    /// As dp_recv does it.
    fn next<const SIZE: usize>(ring: &mut Ring<SIZE>, longest: usize, idle: bool) -> Option<(u8, Vec<u8>)> {
        ring.heal();
        loop {
            match ring.judge_head(longest) {
                Verdict::Frame { opcode, length } => {
                    if let Some(payload) = ring.take_frame(opcode, length) {
                        let mut copy = std::vec![0; length];
                        payload.copy_to(&mut copy, |byte| byte);
                        return Some((opcode.0, copy));
                    }
                }
                Verdict::Needs(_) if !idle || ring.is_empty() => return None,
                _ => {}
            }
            ring.skip(1);
        }
    }

    #[derive(Clone, Debug)]
    enum Step {
        Append(Vec<u8>),
        Next(bool),
        Spoil(i32, i32),
    }

    fn check<const SIZE: usize>(longest: usize, steps: &[Step]) {
        let mut ring = Ring { bytes: [0x24; SIZE], start: 0, used: 0 };
        let mut model = Model { unread: Vec::new(), start: 0 };
        for step in steps {
            match *step {
                Step::Append(ref input) => assert_eq!(ring.append(input), model.append(input, SIZE)),
                Step::Next(idle) => assert_eq!(next(&mut ring, longest, idle), model.next(longest, idle, SIZE)),
                Step::Spoil(start, used) => {
                    (ring.start, ring.used) = (start, used);
                    model = Model::of(&ring);
                    continue;
                }
            }
            assert_eq!((ring.start as usize, ring.used as usize), (model.start, model.unread.len()));
            assert_eq!(Model::of(&ring), model);
        }
    }

    fn step() -> impl Strategy<Value = Step> {
        let frame = (prop::sample::select(b"ANHSMChsmeX".to_vec()), prop::collection::vec(any::<u8>(), 0..40), 0..9_u8);
        let frame = frame.prop_map(|(opcode, payload, damage)| {
            let mut frame = [b"$".as_slice(), &[opcode, payload.len() as u8], &payload].concat();
            let sum = frame.iter().fold(b':', |sum: u8, byte| sum.wrapping_add(*byte));
            frame.push(sum.wrapping_add(u8::from(damage == 0)));
            frame.push(if damage == 1 { b'$' } else { b':' });
            frame
        });
        let noise = prop::collection::vec(prop::sample::select(b"$MA:\0\x01\x02\x03".to_vec()), 0..20);
        let field = || prop_oneof![4 => -1..12_i32, 4 => -1..140_i32, 1 => any::<i32>()];
        prop_oneof![
            3 => frame.prop_map(Step::Append),
            3 => noise.prop_map(Step::Append),
            1 => prop::collection::vec(any::<u8>(), 0..300).prop_map(Step::Append),
            4 => Just(Step::Next(false)),
            1 => Just(Step::Next(true)),
            1 => (field(), field()).prop_map(|(start, used)| Step::Spoil(start, used)),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 1_000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn it_does_what_the_grammar_says(steps in prop::collection::vec(step(), 0..30)) {
            check::<6>(1, &steps);
            check::<7>(2, &steps);
            check::<8>(1, &steps);
            check::<64>(32, &steps);
            check::<128>(32, &steps);
            check::<131>(32, &steps);
            check::<512>(255, &steps);
        }
    }
}
