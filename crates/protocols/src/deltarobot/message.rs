//! Messages: an opcode and its payload as one value (specification, section "Opcodes").

use super::{Layout, Opcode, POSITION_SIZE, Position, Report, SeenLayout, report};

/// Bytes of the longest payload that is written: a status report as shipped firmware sends it.
pub const PAYLOAD_MAX: usize = 16;

/// A message of the specification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message {
    /// The request with this opcode was understood and will be attempted.
    Ack(Opcode),
    /// The request with this opcode was not understood, is invalid, or can't be fulfilled now.
    Nack(Opcode),
    /// Request: home.
    Homing,
    /// Request: report the status.
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
    pub fn read(opcode: Opcode, payload: &[u8], layout: Layout) -> Option<Self> {
        Self::read_after(opcode, payload, layout, &mut SeenLayout::default())
    }

    /// The same in a session: see [`Report::read_after`].
    pub fn read_after(opcode: Opcode, payload: &[u8], layout: Layout, seen: &mut SeenLayout) -> Option<Self> {
        Some(match (opcode, payload) {
            (Opcode::ACK, [answered]) => Self::Ack(Opcode(*answered)),
            (Opcode::NACK, [answered]) => Self::Nack(Opcode(*answered)),
            (Opcode::MOVE, _) if payload.len() == POSITION_SIZE => Self::Move(Position::read(payload)?),
            (Opcode::STATUS_REPL, _) => Self::StatusReport(Report::read_after(payload, layout, seen)?),
            (Opcode::HOMING, []) => Self::Homing,
            (Opcode::STATUS, []) => Self::Status,
            (Opcode::CANCEL, []) => Self::Cancel,
            (Opcode::HOMING_REPL, []) => Self::HomingFinished,
            (Opcode::MOVE_REPL, []) => Self::MoveFinished,
            (Opcode::GENERAL_ERR, []) => Self::GeneralError,
            _ => return None,
        })
    }

    /// The opcode of the frame that says this.
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

    /// Writes the payload to the beginning of `out` and returns its length.
    pub fn write(&self, layout: Layout, out: &mut [u8; PAYLOAD_MAX]) -> usize {
        let (position, begin, length) = match self {
            Self::Ack(answered) | Self::Nack(answered) => {
                out[0] = answered.0;
                return 1;
            }
            Self::Move(position) => (position, 0, POSITION_SIZE),
            Self::StatusReport(report) => {
                // Where STAT stands in either layout: the position comes over one of them.
                let [spec, .., firmware, padding0, padding1, padding2] = out;
                (*spec, *firmware) = (report.stat(), report.stat());
                (*padding0, *padding1, *padding2) = (0, 0, 0);
                if layout == Layout::Spec {
                    (&report.position, 1, report::REPORT_SIZE)
                } else {
                    (&report.position, 0, PAYLOAD_MAX)
                }
            }
            _ => return 0,
        };
        for (place, byte) in out.iter_mut().skip(begin).zip(position.to_wire()) {
            *place = byte;
        }
        length
    }
}

#[cfg(test)]
mod tests {
    use super::{Layout, Message, Opcode, PAYLOAD_MAX, Position, Report};

    const REPORT: Report = Report::new(Position([0x3F80_0000, 0x7F80_0001, 0xC060_0000]), 0b0001_0110);

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
                let mut bytes = [0xAA; PAYLOAD_MAX + 1];
                let length = message.write(layout, bytes.first_chunk_mut().unwrap());
                for size in 0..=bytes.len() {
                    // Any other length is wrong, but a firmware's report may have 13 bytes and more.
                    let lenient = message.opcode() == Opcode::STATUS_REPL && layout != Layout::Spec && size >= 13;
                    let expected = (size == length || lenient).then_some(message);
                    assert_eq!(Message::read(message.opcode(), &bytes[..size], layout), expected, "{size}");
                }
            }
        }
        assert_eq!(Message::read(Opcode(b'x'), &[], Layout::Auto), None);
    }

    #[test]
    fn reports_are_written_in_either_layout() {
        let mut out = [0xAA; PAYLOAD_MAX];
        assert_eq!(Message::StatusReport(REPORT).write(Layout::Firmware, &mut out), 16);
        assert_eq!(out, [0, 0, 0x80, 0x3F, 1, 0, 0x80, 0x7F, 0, 0, 0x60, 0xC0, 0x16, 0, 0, 0]);
        assert_eq!(Message::StatusReport(REPORT).write(Layout::Spec, &mut out), 13);
        assert_eq!(out[..13], [0x16, 0, 0, 0x80, 0x3F, 1, 0, 0x80, 0x7F, 0, 0, 0x60, 0xC0]);
    }
}
