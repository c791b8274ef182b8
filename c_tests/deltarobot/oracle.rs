//! Random streams: what the library delivers, compared with the model of the reference and with the definition of
//! a frame, through the C ABI (see oracle.c).

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};
use std::sync::Mutex;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::{TestCaseResult, TestRunner};

use crate::support::{DEFAULT, LARGEST, Library, MODEL, Mode, Program, Sizes, build, command};

const OPCODES: &[u8] = b"ANHSMChsme";
const OVERHEAD: usize = 5;

fn frame(opcode: u8, payload: &[u8]) -> Vec<u8> {
    let length = u8::try_from(payload.len()).unwrap();
    let mut bytes = vec![b'$', opcode, length];
    bytes.extend(payload);
    let sum = bytes.iter().fold(b':', |sum, &byte| sum.wrapping_add(byte));
    bytes.extend([sum, b':']);
    bytes
}

/// Bytes that frames are made of come up far more often than by chance.
fn any_byte() -> impl Strategy<Value = u8> {
    prop_oneof![
        3 => any::<u8>(),
        2 => Just(b'$'),
        2 => Just(b':'),
        2 => select(OPCODES),
        2 => 0u8..8,
    ]
}

/// A frame's payload: anything, often with a frame inside.
fn any_payload(data_max: usize) -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![
        vec(any_byte(), 0..=data_max),
        vec(any_byte(), 0..=data_max.min(3)),
        (vec(any_byte(), 0..4), select(OPCODES), vec(any_byte(), 0..4), vec(any_byte(), 0..4)).prop_map(
            move |(before, opcode, payload, after)| {
                let mut bytes = [before, frame(opcode, &payload), after].concat();
                bytes.truncate(data_max);
                bytes
            }
        ),
    ]
}

fn any_frame(data_max: usize) -> impl Strategy<Value = Vec<u8>> {
    (select(OPCODES), any_payload(data_max)).prop_map(|(opcode, payload)| frame(opcode, &payload))
}

/// What a line carries: frames, and all that noise makes of them.
fn any_piece(data_max: usize) -> impl Strategy<Value = Vec<u8>> {
    let whole = || any_frame(data_max);
    prop_oneof![
        6 => whole(),
        2 => vec(any_byte(), 0..12),
        // Bits flipped.
        2 => (whole(), any::<Index>(), 0..8u8).prop_map(|(mut bytes, at, bit)| {
            let at = at.index(bytes.len());
            bytes[at] ^= 1 << bit;
            bytes
        }),
        // A byte lost, inserted, or all from one on.
        2 => (whole(), any::<Index>()).prop_map(|(mut bytes, at)| {
            bytes.remove(at.index(bytes.len()));
            bytes
        }),
        1 => (whole(), any::<Index>(), any_byte()).prop_map(|(mut bytes, at, byte)| {
            bytes.insert(at.index(bytes.len()), byte);
            bytes
        }),
        2 => (whole(), any::<Index>()).prop_map(|(mut bytes, at)| {
            bytes.truncate(at.index(bytes.len()));
            bytes
        }),
        // False starts: short ones, and those that wait for more than there is.
        2 => (select(OPCODES), any::<u8>()).prop_map(|(opcode, length)| vec![b'$', opcode, length]),
        1 => (any::<u8>(), vec(any_byte(), 0..3)).prop_map(|(opcode, payload)| frame(opcode, &payload)),
    ]
}

/// A stream that ends with enough zeros for every false start to fail, and the lengths of the chunks it comes in.
fn any_stream(data_max: usize, chunk_max: usize) -> impl Strategy<Value = (Vec<u8>, Vec<usize>)> {
    let chunks = prop_oneof![vec(1..=chunk_max, 1..20), Just(vec![1]), Just(vec![chunk_max])];
    (vec(any_piece(data_max), 0..30), chunks).prop_map(move |(pieces, chunks)| {
        let mut bytes = pieces.concat();
        bytes.resize(bytes.len() + data_max + OVERHEAD, 0);
        (bytes, chunks)
    })
}

/// A frame that was delivered: where it ends in the stream, and its opcode, length and data.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Delivered {
    end: usize,
    content: Vec<u8>,
}

impl Delivered {
    fn start(&self) -> usize {
        // Its starter, checksum and terminator are not in the content.
        self.end.saturating_sub(self.content.len() + 3)
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.start() < other.end && other.start() < self.end
    }
}

/// The frame that begins at a place of the stream.
fn intact_at(stream: &[u8], at: usize, data_max: usize) -> Option<Delivered> {
    let rest = &stream[at..];
    let (&opcode, &length) = (rest.get(1)?, rest.get(2)?);
    if rest[0] != b'$' || !OPCODES.contains(&opcode) || usize::from(length) > data_max {
        return None;
    }
    let payload = rest.get(3..3 + usize::from(length))?;
    let bytes = frame(opcode, payload);
    rest.starts_with(&bytes).then(|| Delivered { end: at + bytes.len(), content: bytes[1..bytes.len() - 2].to_vec() })
}

/// The intact frames of a stream from left to right, none inside another.
fn intact(stream: &[u8], data_max: usize) -> Vec<Delivered> {
    let mut frames = Vec::new();
    let mut at = 0;
    while at < stream.len() {
        match intact_at(stream, at, data_max) {
            Some(frame) => {
                at = frame.end;
                frames.push(frame);
            }
            None => at += 1,
        }
    }
    frames
}

/// What the two sides made of a stream.
#[derive(Debug, Default)]
struct Outcome {
    model: Vec<Delivered>,
    library: Vec<Delivered>,
    each: Vec<Vec<u8>>,
    left: usize,
    bad: Vec<String>,
}

fn unhex(text: &str) -> Vec<u8> {
    (0..text.len()).step_by(2).map(|at| u8::from_str_radix(&text[at..at + 2], 16).unwrap()).collect()
}

impl Outcome {
    fn parse(line: &str) -> Self {
        let mut outcome = Self::default();
        for token in line.split_whitespace() {
            let (label, value) = token.split_once(':').unwrap_or_else(|| panic!("unexpected answer: {line}"));
            let delivered = || Delivered { end: label[1..].parse().unwrap_or(0), content: unhex(value) };
            match label {
                "bad" => outcome.bad.push(value.to_owned()),
                "r" => outcome.left = value.parse().unwrap(),
                "e" => outcome.each.push(unhex(value)),
                _ if label.starts_with('m') => outcome.model.push(delivered()),
                _ if label.starts_with('l') => outcome.library.push(delivered()),
                _ => panic!("unexpected answer: {line}"),
            }
        }
        outcome
    }
}

/// The program on the far side, which is asked one stream after the other.
struct Oracle {
    child: Child,
    questions: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl Oracle {
    fn start(sizes: Sizes, mode: Mode) -> Self {
        let program = Program::of("oracle", &["deltarobot/oracle.c", MODEL]);
        let library = Library::in_mode(sizes, mode);
        let executable = build(&program, &library, mode).expect("always built");
        let mut child =
            command(&executable, &library, mode).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let questions = child.stdin.take();
        let answers = BufReader::new(child.stdout.take().unwrap());
        Self { child, questions, answers }
    }

    fn ask(&mut self, stream: &[u8], chunks: &[usize]) -> Outcome {
        let mut line = String::new();
        let mut rest = stream;
        for &length in chunks.iter().cycle() {
            if rest.is_empty() {
                break;
            }
            let (chunk, later) = rest.split_at(length.min(rest.len()));
            line.extend(chunk.iter().map(|byte| format!("{byte:02x}")));
            line.push(' ');
            rest = later;
        }
        line.push('\n');
        self.questions.as_mut().unwrap().write_all(line.as_bytes()).expect("oracle takes a stream");
        let mut answer = String::new();
        self.answers.read_line(&mut answer).expect("oracle answers");
        assert!(answer.ends_with('\n'), "oracle ended: {:?}", self.child.try_wait());
        Outcome::parse(&answer)
    }
}

impl Drop for Oracle {
    fn drop(&mut self) {
        self.questions = None;
        let _ = self.child.wait();
    }
}

fn compare(stream: &[u8], outcome: &Outcome, sizes: Sizes) -> TestCaseResult {
    prop_assert_eq!(&outcome.bad, &Vec::<String>::new());
    // Every intact frame, nothing else, and the same for any chunks.
    let expected = intact(stream, sizes.data_max);
    prop_assert_eq!(&outcome.library, &expected);
    let contents: Vec<_> = expected.iter().map(|frame| frame.content.clone()).collect();
    prop_assert_eq!(&outcome.each, &contents);
    // The zeros at the end have settled all.
    prop_assert_eq!(outcome.left, 0);
    // None of the model's is missing, unless a frame that is just as intact and began earlier stands across it.
    for frame in &outcome.model {
        prop_assert_eq!(intact_at(stream, frame.start(), sizes.data_max), Some(frame.clone()));
        let found = outcome.library.contains(frame);
        let across = outcome.library.iter().any(|other| other.overlaps(frame) && other.start() < frame.start());
        prop_assert!(found || across, "missing: {:?}", frame);
    }
    Ok(())
}

/// With an incomplete frame in the ring there is room for chunks of this length at least.
fn chunk_max(sizes: Sizes) -> usize {
    sizes.bufsize - (sizes.data_max + OVERHEAD - 1)
}

/// `rounds` times as many streams as proptest is set to try (`PROPTEST_CASES`).
fn check_streams(sizes: Sizes, mode: Mode, rounds: u32) {
    let oracle = Mutex::new(Oracle::start(sizes, mode));
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    let cases = config.cases.saturating_mul(rounds);
    TestRunner::new(ProptestConfig { cases, ..config })
        .run(&any_stream(sizes.data_max, chunk_max(sizes)), |(stream, chunks)| {
            let outcome = oracle.lock().unwrap().ask(&stream, &chunks);
            compare(&stream, &outcome, sizes)
        })
        .unwrap_or_else(|failure| panic!("{failure}"));
}

#[test]
fn random_streams() {
    check_streams(DEFAULT, Mode::Sanitized, 10);
}

#[test]
fn random_streams_with_the_longest_payloads() {
    check_streams(LARGEST, Mode::Sanitized, 2);
}

#[test]
fn random_streams_through_the_smallest_ring() {
    check_streams(Sizes::new(37, 32), Mode::Sanitized, 5);
}

#[test]
fn random_streams_with_small_leaves() {
    check_streams(DEFAULT, Mode::SmallLeaves, 5);
}
