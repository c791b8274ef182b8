//! What a frame says: an opcode and its payload as one value (specification, section "Opcodes").

use super::{Opcode, POSITION_SIZE, Place, Position, RingFrame, encode};

/// Bytes of the longest payload that is written: a status report as shipped firmware sends it.
pub const PAYLOAD_MAX: usize = 16;
/// Bytes of a status report that say something; the specification's has no others.
const REPORT_SIZE: usize = 13;

/// Where STAT stands in a status report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Layout {
    /// Reading: more than 13 bytes are [`Firmware`](Self::Firmware)'s. 13 bytes are [`Spec`](Self::Spec)'s unless only
    /// the last byte, and not the first, can be STAT. A byte can be STAT when its reserved bits are alike: zero as this
    /// library sends them, or one as shipped firmware does.
    ///
    /// Writing: as [`Firmware`](Self::Firmware), which no reader takes for anything else.
    #[default]
    Auto,
    /// Specification v1.0: STAT, A, B, C; exactly 13 bytes.
    Spec,
    /// Shipped firmware: A, B, C, STAT. Written as 16 bytes, the padding zero; read from 13 bytes on.
    Firmware,
}

/// What the platform is doing: bits 0 and 1 of STAT.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum State {
    /// Nothing.
    Idle = 0,
    /// Homing.
    Homing = 1,
    /// Moving. (The specification misprints "homing".)
    Moving = 2,
    /// In error: nothing but a status request is fulfilled.
    Error = 3,
}

/// A status report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Report {
    /// Where the platform is, if it knows.
    pub position: Position,
    stat: u8,
}

impl Report {
    /// The bits of STAT that mean something: state and end stops. The others are reserved.
    const STAT_BITS: u8 = 0x1F;

    /// A report of that position and STAT, whose reserved bits are cleared.
    #[inline]
    #[must_use]
    pub const fn new(position: Position, stat: u8) -> Self {
        Self { position, stat: stat & Self::STAT_BITS }
    }

    /// STAT, the reserved bits zero. Bits 2 to 4 are the end stops of the arms A to C, 1 when pressed.
    #[inline]
    #[must_use]
    pub const fn stat(&self) -> u8 {
        self.stat
    }

    /// What the platform is doing.
    #[must_use]
    pub const fn state(&self) -> State {
        match self.stat & 3 {
            0 => State::Idle,
            1 => State::Homing,
            2 => State::Moving,
            _ => State::Error,
        }
    }
}

/// A message of the specification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message {
    /// The request with this opcode was understood and will be attempted.
    Ack(Opcode),
    /// The request with this opcode was not understood, is invalid, or can't be fulfilled now.
    Nack(Opcode),
    /// Request: home.
    Homing,
    /// Request: tell the status.
    Status,
    /// Request: move there, in a line.
    Move(Position),
    /// Request: cancel the operation that is going on.
    Cancel,
    /// Homing is over.
    HomingFinished,
    /// The state and position of the platform.
    StatusReport(Report),
    /// The platform is where it was asked to be.
    MoveFinished,
    /// The platform met an error: the operation can't go on.
    GeneralError,
}

impl Message {
    /// What an opcode and its payload mean; `None` when the opcode is unknown or the length wrong for it.
    #[must_use]
    pub fn read(opcode: Opcode, payload: &[u8], layout: Layout) -> Option<Self> {
        let mut head = [0; PAYLOAD_MAX];
        put(&mut head, payload.iter().copied());
        Self::parse(opcode, &head, payload.len(), layout)
    }

    /// What a received frame means; `None` when the length is wrong for the opcode.
    #[inline]
    #[must_use]
    pub fn of_frame(frame: &RingFrame<'_>, layout: Layout) -> Option<Self> {
        let mut head = [0; PAYLOAD_MAX];
        Self::head(frame, &mut head);
        Self::parse(frame.opcode, &head, frame.payload.len(), layout)
    }

    /// Copies the beginning of a frame's payload. Nothing further on means anything.
    #[inline]
    pub(super) fn head(frame: &RingFrame<'_>, head: &mut [u8; PAYLOAD_MAX]) {
        put(head, frame.payload.iter());
    }

    /// What an opcode means with a payload of that beginning and length.
    pub(super) fn parse(opcode: Opcode, head: &[u8; PAYLOAD_MAX], length: usize, layout: Layout) -> Option<Self> {
        let plain = match opcode {
            Opcode::ACK if length == 1 => return Some(Self::Ack(Opcode(head[0]))),
            Opcode::NACK if length == 1 => return Some(Self::Nack(Opcode(head[0]))),
            Opcode::MOVE if length == POSITION_SIZE => return Some(Self::Move(position(head, false))),
            Opcode::STATUS_REPL => return report(head, length, layout).map(Self::StatusReport),
            Opcode::HOMING => Self::Homing,
            Opcode::STATUS => Self::Status,
            Opcode::CANCEL => Self::Cancel,
            Opcode::HOMING_REPL => Self::HomingFinished,
            Opcode::MOVE_REPL => Self::MoveFinished,
            Opcode::GENERAL_ERR => Self::GeneralError,
            _ => return None,
        };
        (length == 0).then_some(plain)
    }

    /// The opcode of the frame that says this.
    #[must_use]
    pub const fn opcode(&self) -> Opcode {
        match self {
            Self::Ack(_) => Opcode::ACK,
            Self::Nack(_) => Opcode::NACK,
            Self::Homing => Opcode::HOMING,
            Self::Status => Opcode::STATUS,
            Self::Move(_) => Opcode::MOVE,
            Self::Cancel => Opcode::CANCEL,
            Self::HomingFinished => Opcode::HOMING_REPL,
            Self::StatusReport(_) => Opcode::STATUS_REPL,
            Self::MoveFinished => Opcode::MOVE_REPL,
            Self::GeneralError => Opcode::GENERAL_ERR,
        }
    }

    /// Writes the payload to the beginning of `out` and tells its length.
    #[must_use]
    pub fn write(&self, layout: Layout, out: &mut [u8; PAYLOAD_MAX]) -> usize {
        match self {
            Self::Ack(answered) | Self::Nack(answered) => {
                out[0] = answered.0;
                1
            }
            Self::Move(position) => {
                put(out, position.to_wire());
                POSITION_SIZE
            }
            Self::StatusReport(report) if layout == Layout::Spec => {
                put(out, [report.stat].into_iter().chain(report.position.to_wire()));
                REPORT_SIZE
            }
            Self::StatusReport(report) => {
                put(out, report.position.to_wire().into_iter().chain([report.stat, 0, 0, 0]));
                PAYLOAD_MAX
            }
            _ => 0,
        }
    }

    /// Writes the frame that says this to the beginning of `out` and tells its length; `None` when it does not fit, or
    /// this build's frames are too short for it.
    #[must_use]
    pub fn encode<P: Place>(&self, layout: Layout, out: &mut [P]) -> Option<usize> {
        let mut payload = [0; PAYLOAD_MAX];
        let length = self.write(layout, &mut payload);
        encode(self.opcode(), payload.get(..length).unwrap_or_default(), out)
    }
}

#[inline]
fn put(out: &mut [u8; PAYLOAD_MAX], bytes: impl IntoIterator<Item = u8>) {
    for (place, byte) in out.iter_mut().zip(bytes) {
        *place = byte;
    }
}

/// The position at the beginning, or one byte behind it.
#[inline]
fn position(head: &[u8; PAYLOAD_MAX], behind_stat: bool) -> Position {
    let &[s, a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3, ..] = head;
    Position::from_wire(&if behind_stat {
        [a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3]
    } else {
        [s, a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2]
    })
}

fn report(head: &[u8; PAYLOAD_MAX], length: usize, layout: Layout) -> Option<Report> {
    let &[first, _, _, _, _, _, _, _, _, _, _, _, last, ..] = head;
    let stat_first = match layout {
        _ if length < REPORT_SIZE => return None,
        Layout::Firmware => false,
        Layout::Auto => length == REPORT_SIZE && (can_be_stat(first) || !can_be_stat(last)),
        Layout::Spec if length == REPORT_SIZE => true,
        Layout::Spec => return None,
    };
    Some(Report::new(position(head, stat_first), if stat_first { first } else { last }))
}

/// See [`Layout::Auto`].
const fn can_be_stat(byte: u8) -> bool {
    matches!(byte & !Report::STAT_BITS, 0 | 0xE0)
}

#[cfg(test)]
mod tests {
    use super::{Layout, Message, Opcode, PAYLOAD_MAX, Position, Report, State};

    const REPORT: Report = Report::new(Position([0x3F80_0000, 0x7F80_0001, 0xC060_0000]), 0b0001_0110);
    const FIRMWARE: [u8; 16] = [0, 0, 0x80, 0x3F, 1, 0, 0x80, 0x7F, 0, 0, 0x60, 0xC0, 0xF6, 0xDE, 0xAD, 0xBE];
    const SPEC: [u8; 13] = [0x16, 0, 0, 0x80, 0x3F, 1, 0, 0x80, 0x7F, 0, 0, 0x60, 0xC0];

    fn read_report(payload: &[u8], layout: Layout) -> Option<Report> {
        match Message::read(Opcode::STATUS_REPL, payload, layout)? {
            Message::StatusReport(report) => Some(report),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn every_message_is_read_as_it_was_written() {
        let position = Position([1, 0x7F80_0001, 0xFFFF_FFFF]);
        for message in [
            Message::Ack(Opcode::MOVE),
            Message::Nack(Opcode(0)),
            Message::Homing,
            Message::Status,
            Message::Move(position),
            Message::Cancel,
            Message::HomingFinished,
            Message::StatusReport(REPORT),
            Message::MoveFinished,
            Message::GeneralError,
        ] {
            for layout in [Layout::Auto, Layout::Spec, Layout::Firmware] {
                let mut payload = [0xAA; PAYLOAD_MAX];
                let length = message.write(layout, &mut payload);
                assert_eq!(Message::read(message.opcode(), &payload[..length], layout), Some(message));
                // A byte more or less is another length, which is wrong but for what a firmware's report may have.
                for wrong in [length.wrapping_sub(1), length + 1] {
                    let bytes: std::vec::Vec<u8> = payload.iter().copied().chain([0; 4]).collect();
                    let Some(bytes) = bytes.get(..wrong) else { continue };
                    let lenient = message.opcode() == Opcode::STATUS_REPL && layout != Layout::Spec;
                    assert_eq!(
                        Message::read(message.opcode(), bytes, layout).is_some(),
                        lenient,
                        "{message:?} {wrong}"
                    );
                }
            }
        }
        assert_eq!(Message::read(Opcode(b'x'), &[], Layout::Auto), None);
    }

    #[test]
    fn reserved_bits_are_masked_and_written_as_zero() {
        assert_eq!(Report::new(Position::UNKNOWN, 0xFF).stat(), 0x1F);
        assert_eq!(read_report(&FIRMWARE, Layout::Auto), Some(REPORT));
        let mut out = [0xAA; PAYLOAD_MAX];
        assert_eq!(Message::StatusReport(REPORT).write(Layout::Firmware, &mut out), 16);
        assert_eq!(out[12..], [0x16, 0, 0, 0]);
        assert_eq!(Message::StatusReport(REPORT).write(Layout::Spec, &mut out), 13);
        assert_eq!(out[..13], SPEC);
    }

    #[test]
    fn states_are_the_two_lowest_bits() {
        for (bits, state) in [(0, State::Idle), (1, State::Homing), (2, State::Moving), (3, State::Error)] {
            assert_eq!(Report::new(Position::UNKNOWN, 0xFC | bits).state(), state);
        }
    }

    #[test]
    fn a_report_of_13_bytes_is_the_specifications_unless_that_is_impossible() {
        assert_eq!(read_report(&SPEC, Layout::Auto), Some(REPORT));
        // Floats first; the first byte says which it can be.
        let floats_first = |first: u8, last: u8| {
            let mut bytes = [0; 13];
            (bytes[0], bytes[12]) = (first, last);
            read_report(&bytes, Layout::Auto).map(|report| report.stat())
        };
        assert_eq!(floats_first(0x02, 0xE1), Some(0x02));
        assert_eq!(floats_first(0xE2, 0xE1), Some(0x02));
        assert_eq!(floats_first(0xCD, 0xE1), Some(0x01));
        assert_eq!(floats_first(0x33, 0x06), Some(0x06));
        assert_eq!(floats_first(0x33, 0x42), Some(0x13));
    }

    #[test]
    fn more_than_13_bytes_are_floats_first_and_fewer_are_none() {
        for length in 0..=32 {
            let mut bytes = [0xE1; 32];
            bytes[..16].copy_from_slice(&FIRMWARE);
            let is_report = length > 13;
            assert_eq!(read_report(&bytes[..length], Layout::Auto) == Some(REPORT), is_report, "{length}");
            assert_eq!(read_report(&bytes[..length], Layout::Firmware) == Some(REPORT), length >= 13, "{length}");
            assert_eq!(read_report(&bytes[..length], Layout::Spec).is_some(), length == 13, "{length}");
        }
    }
}
