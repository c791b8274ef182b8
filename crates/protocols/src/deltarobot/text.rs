//! Messages as text for logs, worded as the original's host program does.

use super::{Layout, Message, Opcode, Position, Report, State};
use crate::decimal::write_float;

/// Bytes that the text of any message needs at most, the terminating zero among them.
pub const TEXT_MAX: usize = 96;

impl Opcode {
    /// The name in logs; `UNKNOWN_OPCODE` for what the specification does not know.
    pub fn name(self) -> &'static str {
        let name = self.terminated_name();
        name.get(..name.len().wrapping_sub(1)).unwrap_or_default()
    }

    /// The name and a zero byte behind it, for those who hand it to C.
    pub const fn terminated_name(self) -> &'static str {
        match self {
            Self::ACK => "ACK\0",
            Self::NACK => "NACK\0",
            Self::HOMING => "HOMING!\0",
            Self::STATUS => "STATUS?\0",
            Self::MOVE => "MOVE!\0",
            Self::CANCEL => "CANCEL!\0",
            Self::HOMING_REPL => "HOMING_REPLY\0",
            Self::STATUS_REPL => "STATUS_REPLY\0",
            Self::MOVE_REPL => "MOVE_REPLY\0",
            Self::GENERAL_ERR => "GENERAL_ERROR\0",
            _ => "UNKNOWN_OPCODE\0",
        }
    }
}

impl State {
    /// The name in logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "IDLE",
            Self::Homing => "HOMING",
            Self::Moving => "MOVING",
            Self::Error => "ERROR",
        }
    }
}

/// Writes one line about a message, byte by byte.
///
/// A status report is read by [`Layout::Auto`]. A payload of the wrong length is not shown, only the opcode's name.
pub fn describe(opcode: Opcode, payload: &[u8], put: &mut dyn FnMut(u8)) {
    write_text(opcode.name(), put);
    match Message::read(opcode, payload, Layout::Auto) {
        Some(Message::Ack(answered)) => {
            write_text(": (", put);
            write_text(answered.name(), put);
            put(b')');
        }
        Some(Message::Move(position)) => {
            put(b':');
            write_position(position, put);
        }
        Some(Message::StatusReport(report)) => write_report(&report, put),
        _ => (),
    }
}

fn write_report(report: &Report, put: &mut dyn FnMut(u8)) {
    write_text(": ", put);
    write_text(report.state().name(), put);
    write_position(report.position, put);
    for (bit, arm) in [(1 << 2, b'A'), (1 << 3, b'B'), (1 << 4, b'C')] {
        if report.stat() & bit != 0 {
            write_text(" STP_", put);
            put(arm);
        }
    }
}

fn write_position(position: Position, put: &mut dyn FnMut(u8)) {
    for (bits, arm) in position.0.into_iter().zip(*b"ABC") {
        write_text("  D", put);
        put(arm);
        put(b'=');
        write_float(bits, put);
    }
}

fn write_text(text: &str, put: &mut dyn FnMut(u8)) {
    for byte in text.bytes() {
        put(byte);
    }
}

#[cfg(test)]
mod tests {
    use super::{Opcode, TEXT_MAX, describe};

    fn text(opcode: u8, payload: &[u8]) -> String {
        let mut text = String::new();
        describe(Opcode(opcode), payload, &mut |byte| text.push(char::from(byte)));
        text
    }

    #[test]
    fn texts_of_the_original() {
        const POSITION: [u8; 12] = *b"\0\0\x80\x3F\0\0\0\x40\0\0\x60\xC0";
        let report = [&POSITION[..], b"\xEE\xDE\xAD\xBE"].concat();
        for (opcode, payload, expected) in [
            (b'A', &b"M"[..], "ACK: (MOVE!)"),
            (b'A', b"\0", "ACK: (UNKNOWN_OPCODE)"),
            (b'N', b"M", "NACK"),
            (b'H', b"", "HOMING!"),
            (b'S', b"", "STATUS?"),
            (b'C', b"", "CANCEL!"),
            (b'h', b"", "HOMING_REPLY"),
            (b'm', b"", "MOVE_REPLY"),
            (b'e', b"", "GENERAL_ERROR"),
            (0xFF, b"", "UNKNOWN_OPCODE"),
            (b'M', &POSITION, "MOVE!:  DA=1  DB=2  DC=-3.5"),
            (b's', &report, "STATUS_REPLY: MOVING  DA=1  DB=2  DC=-3.5 STP_A STP_B"),
            (b's', &[0; 16], "STATUS_REPLY: IDLE  DA=0  DB=0  DC=0"),
            // Of a wrong length.
            (b'A', b"", "ACK"),
            (b'M', &[0; 11], "MOVE!"),
            (b's', &[0; 12], "STATUS_REPLY"),
        ] {
            assert_eq!(text(opcode, payload), expected);
        }
        assert!(text(b's', &[0x13; 13]).starts_with("STATUS_REPLY: ERROR"));
    }

    #[test]
    fn the_longest_text_fits() {
        let smallest = [0xB5, 0xF8, 0x80, 0x80];
        let longest = "STATUS_REPLY: HOMING  DA=-1.18442e-38  DB=-1.18442e-38  DC=-1.18442e-38 STP_A STP_B STP_C";
        assert_eq!(text(b's', &[smallest, smallest, smallest, [0x1D, 0, 0, 0]].concat()), longest);
        assert!(longest.len() < TEXT_MAX);
    }
}
