//! What the receiver finds, beside the grammar applied to the whole stream.

use proptest::prelude::*;
use zerocopy::FromBytes;

use super::{Full, Observer, Receiver, receiver_room};
use crate::deltarobot::{Fault, Verdict, judge};

type Messages = Vec<(u8, Vec<u8>)>;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Losses {
    skipped: usize,
    bad_checksums: usize,
}

impl Observer for Losses {
    fn skipped(&mut self, bytes: usize) {
        assert!(bytes > 0);
        self.skipped += bytes;
    }
    fn bad_checksum(&mut self) {
        self.bad_checksums += 1;
    }
}

/// The grammar, applied to a whole stream: the messages, the losses, and how many bytes wait for more.
fn naive(mut stream: &[u8], longest: usize, idle: bool) -> (Messages, Losses, usize) {
    let (mut messages, mut losses) = (Vec::new(), Losses::default());
    loop {
        match judge(stream, longest) {
            Verdict::Frame { opcode, length } => {
                messages.push((opcode.0, stream[3..length + 3].to_vec()));
                stream = &stream[length + 5..];
                continue;
            }
            Verdict::Needs(_) if !idle || stream.is_empty() => return (messages, losses, stream.len()),
            Verdict::Needs(_) => {}
            Verdict::Fault(fault) => losses.bad_checksums += usize::from(fault == Fault::Checksum),
        }
        losses.skipped += 1;
        stream = &stream[1..];
    }
}

/// A receiver, and what was found.
#[derive(Default)]
struct Run<const ROOM: usize> {
    receiver: Receiver<ROOM>,
    losses: Losses,
    messages: Messages,
}

impl<const ROOM: usize> Run<ROOM> {
    /// Fetches all that is there.
    fn fetch(&mut self) {
        while let Ok(frame) = self.receiver.next_observed(&mut self.losses) {
            self.messages.push((frame.opcode.0, frame.payload.to_vec()));
        }
    }

    /// The line has fallen silent: now all is found.
    fn finds(mut self, expected: &(Messages, Losses, usize), way: &str) {
        while let Ok(frame) = self.receiver.next_idle(&mut self.losses) {
            self.messages.push((frame.opcode.0, frame.payload.to_vec()));
        }
        assert!(self.receiver.is_empty());
        assert_eq!((&self.messages, &self.losses), (&expected.0, &expected.1), "{way}");
    }
}

/// A way to give the receiver the first of these bytes; returns how many it took.
type Way<const ROOM: usize> = fn(&mut Run<ROOM>, &[u8]) -> usize;

fn check<const ROOM: usize>(stream: &[u8], chunks: &[usize]) {
    let expected = naive(stream, Receiver::<ROOM>::LONGEST, true);
    let until_now = |upto: usize| naive(&stream[..upto], Receiver::<ROOM>::LONGEST, false).0.len();

    let byte: Way<ROOM> = |run, bytes| {
        if run.receiver.byte(bytes[0]).unwrap() {
            run.fetch();
        }
        1
    };
    let next_of: Way<ROOM> = |run, mut bytes| {
        let length = bytes.len();
        while let Ok(frame) = run.receiver.next_of_observed(&mut bytes, &mut run.losses) {
            run.messages.push((frame.opcode.0, frame.payload.to_vec()));
        }
        assert!(bytes.is_empty());
        length
    };
    let take: Way<ROOM> = |run, bytes| {
        let taken = run.receiver.take(bytes);
        run.fetch();
        taken
    };
    for (name, way) in [("byte", byte), ("next_of", next_of), ("take", take)] {
        let (mut run, mut rest, mut sizes) = (Run::default(), stream, chunks.iter().cycle());
        while !rest.is_empty() {
            let size = rest.len().min(*sizes.next().unwrap());
            rest = &rest[way(&mut run, &rest[..size])..];
            assert_eq!(run.messages.len(), until_now(stream.len() - rest.len()), "{name}");
        }
        run.finds(&expected, name);
    }

    let mut run = Run::<ROOM>::default();
    for byte in stream {
        if run.receiver.byte(*byte) == Err(Full) {
            run.fetch();
            run.receiver.byte(*byte).unwrap();
        }
    }
    run.finds(&expected, "late, when there is no room any more");
}

/// Frames, beginnings of frames, and noise.
fn stream() -> impl Strategy<Value = Vec<u8>> {
    let opcode = prop_oneof![9 => prop::sample::select(b"ANHSMChsme".to_vec()), 1 => any::<u8>()];
    let payload = prop_oneof![4 => 0..6_usize, 1 => 0..40_usize].prop_flat_map(|length| {
        prop::collection::vec(prop_oneof![3 => any::<u8>(), 1 => prop::sample::select(b"$:A\0\x01".to_vec())], length)
    });
    let frame = (opcode, payload, 0..20_u8).prop_map(|(opcode, payload, damage)| {
        let mut frame = [b"$".as_slice(), &[opcode, u8::try_from(payload.len()).unwrap()], &payload].concat();
        let sum = frame.iter().fold(b':', |sum, byte| sum.wrapping_add(*byte));
        frame.push(sum.wrapping_add(u8::from(damage == 0)));
        frame.push(if damage == 1 { b'$' } else { b':' });
        frame
    });
    let piece = prop_oneof![
        6 => frame,
        1 => prop::collection::vec(prop_oneof![Just(b'$'), Just(b'M'), any::<u8>()], 0..4),
        2 => prop::collection::vec(prop::sample::select(b"$MA:\0\x01\x02".to_vec()), 0..12),
        1 => (0..40_u8).prop_map(|length| [b'$', b'M', length, b':'].to_vec()),
    ];
    prop::collection::vec(piece, 0..12).prop_map(|pieces| pieces.concat())
}

#[test]
fn long_candidates_that_begin_far_behind_are_waited_for() {
    let candidate = |length: u8| [b"$M".as_slice(), &[length], &[b'x'; 97]].concat();
    let mut frame = [b"$M\xF0".as_slice(), &[b'y'; 240]].concat();
    frame.push(frame.iter().fold(b':', |sum, byte| sum.wrapping_add(*byte)));
    frame.push(b':');
    for length in [230, 240, 245] {
        let stream = [candidate(length).repeat(7), frame.clone(), candidate(length), frame.clone()].concat();
        check::<{ receiver_room(240) }>(&stream, &[1]);
        check::<{ receiver_room(245) }>(&stream, &[64, 200]);
        check::<{ receiver_room(246) }>(&stream, &[64, 200]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn it_finds_what_the_grammar_says(stream in stream(), chunks in prop::collection::vec(1..70_usize, 1..5)) {
        check::<{ receiver_room(1) }>(&stream, &chunks);
        check::<{ receiver_room(2) }>(&stream, &chunks);
        check::<{ receiver_room(12) }>(&stream, &chunks);
        check::<{ receiver_room(32) }>(&stream, &chunks);
        // The largest whose counts are bytes.
        check::<{ receiver_room(245) }>(&stream, &chunks);
        check::<{ receiver_room(255) }>(&stream, &chunks);
    }

    #[test]
    fn any_contents_are_safe(mut contents in prop::collection::vec(any::<u8>(), 18), small: bool, stream in stream()) {
        type Small = Receiver<{ receiver_room(2) }>;
        if small {
            // Fields that may be in range.
            contents[..6].iter_mut().enumerate().for_each(|(place, byte)| *byte = if place % 2 == 0 { *byte % 20 } else { 0 });
        }
        for way in 0..3 {
            let mut receiver = Small::read_from_bytes(&contents).unwrap();
            let mut input = stream.as_slice();
            match way {
                0 => while receiver.next_of(&mut input).is_ok() {},
                1 => {
                    assert!(receiver.take(input) <= input.len());
                    while receiver.next().is_ok() {}
                }
                _ => for byte in input {
                    if receiver.byte(*byte) != Ok(false) {
                        while receiver.next().is_ok() {}
                    }
                },
            }
            while receiver.next_idle(&mut ()).is_ok() {}
            prop_assert!(receiver.is_empty());
            for byte in b"$S\0\xB1" {
                prop_assert_eq!(receiver.byte(*byte), Ok(false));
            }
            prop_assert_eq!(receiver.byte(b':'), Ok(true));
            prop_assert_eq!(receiver.next().map(|frame| frame.opcode.0), Ok(b'S'));
        }
    }
}
