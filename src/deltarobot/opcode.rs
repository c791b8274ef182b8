//! The opcodes of the specification, section "Opcodes".

/// The second byte of a frame: says what the frame is.
///
/// Any byte can be sent in that place; only those for which [`is_known`](Self::is_known) holds are received.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct Opcode(pub u8);

impl Opcode {
    /// Acknowledge, either direction; the payload is the opcode it answers.
    pub const ACK: Self = Self(b'A');
    /// No-acknowledge, either direction; the payload is the opcode it answers.
    pub const NACK: Self = Self(b'N');
    /// Homing request, host to controller.
    pub const HOMING: Self = Self(b'H');
    /// Status request, host to controller.
    pub const STATUS: Self = Self(b'S');
    /// Move request, host to controller.
    pub const MOVE: Self = Self(b'M');
    /// Cancel request, host to controller.
    pub const CANCEL: Self = Self(b'C');
    /// Homing finished, controller to host.
    pub const HOMING_REPL: Self = Self(b'h');
    /// Status report, controller to host.
    pub const STATUS_REPL: Self = Self(b's');
    /// Move finished, controller to host.
    pub const MOVE_REPL: Self = Self(b'm');
    /// General error, controller to host.
    pub const GENERAL_ERR: Self = Self(b'e');

    /// Whether this is an opcode of the specification. A frame with another one is garbage.
    #[inline]
    #[must_use]
    pub const fn is_known(self) -> bool {
        // Bit n stands for the n-th letter.
        const UPPER: u32 = 1 << (b'A' & 31)
            | 1 << (b'N' & 31)
            | 1 << (b'H' & 31)
            | 1 << (b'S' & 31)
            | 1 << (b'M' & 31)
            | 1 << (b'C' & 31);
        const LOWER: u32 = 1 << (b'h' & 31) | 1 << (b's' & 31) | 1 << (b'm' & 31) | 1 << (b'e' & 31);
        let letters = match self.0 >> 5 {
            2 => UPPER,
            3 => LOWER,
            _ => 0,
        };
        letters >> (self.0 & 31) & 1 != 0
    }
}

#[cfg(test)]
mod tests {
    use super::Opcode;

    #[test]
    fn exactly_the_ten_opcodes_of_the_specification_are_known() {
        for byte in 0..=u8::MAX {
            assert_eq!(Opcode(byte).is_known(), b"ANHMSChsme".contains(&byte), "{byte:#04x}");
        }
    }
}
