//! Messages as text for logs, worded as the original's host program does.

use super::{Layout, Message, Opcode, Position, Report, State};
use crate::decimal::write_float;

/// Bytes that the text of any message needs at most, the terminating zero among them.
pub const TEXT_MAX: usize = 96;

impl Opcode {
    /// The name in logs; `UNKNOWN_OPCODE` for what the specification does not know.
    #[must_use]
    pub fn name(self) -> &'static str {
        let name = self.terminated_name();
        name.get(..name.len().wrapping_sub(1)).unwrap_or_default()
    }

    /// The name and a zero byte behind it, for those who hand it to C.
    #[must_use]
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
    #[must_use]
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
    use std::string::String;

    fn text(opcode: u8, payload: &[u8]) -> String {
        let mut text = String::new();
        describe(Opcode(opcode), payload, &mut |byte| text.push(char::from(byte)));
        text
    }

    #[test]
    fn texts_of_the_original() {
        assert_eq!(text(b'A', b"M"), "ACK: (MOVE!)");
        assert_eq!(text(b'A', b"\0"), "ACK: (UNKNOWN_OPCODE)");
        assert_eq!(text(b'N', b"M"), "NACK");
        for (opcode, name) in [(b'H', "HOMING!"), (b'S', "STATUS?"), (b'C', "CANCEL!"), (b'h', "HOMING_REPLY")] {
            assert_eq!(text(opcode, b""), name);
        }
        for (opcode, name) in [(b'm', "MOVE_REPLY"), (b'e', "GENERAL_ERROR"), (0xFF, "UNKNOWN_OPCODE")] {
            assert_eq!(text(opcode, b""), name);
        }
        let position = b"\0\0\x80\x3F\0\0\0\x40\0\0\x60\xC0";
        assert_eq!(text(b'M', position), "MOVE!:  DA=1  DB=2  DC=-3.5");
        let report: std::vec::Vec<u8> = position.iter().copied().chain(*b"\xEE\xDE\xAD\xBE").collect();
        assert_eq!(text(b's', &report), "STATUS_REPLY: MOVING  DA=1  DB=2  DC=-3.5 STP_A STP_B");
        assert_eq!(text(b's', &[0; 16]), "STATUS_REPLY: IDLE  DA=0  DB=0  DC=0");
        assert_eq!(text(b's', &[0x13; 13])[..19], *"STATUS_REPLY: ERROR");
    }

    #[test]
    fn wrong_lengths_show_the_name_alone() {
        assert_eq!(text(b'A', b""), "ACK");
        assert_eq!(text(b'M', &[0; 11]), "MOVE!");
        assert_eq!(text(b's', &[0; 12]), "STATUS_REPLY");
    }

    #[test]
    fn the_longest_text_fits() {
        let smallest = [0xB5, 0xF8, 0x80, 0x80];
        let payload: std::vec::Vec<u8> = smallest.repeat(3).into_iter().chain(*b"\x1D\0\0\0").collect();
        let longest = text(b's', &payload);
        assert_eq!(
            longest,
            "STATUS_REPLY: HOMING  DA=-1.18442e-38  DB=-1.18442e-38  DC=-1.18442e-38 STP_A STP_B STP_C"
        );
        assert!(longest.len() < TEXT_MAX);
    }
}
