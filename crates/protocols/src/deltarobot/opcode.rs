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
    pub const fn is_known(self) -> bool {
        // On AVR constants take RAM, so there the letters are in the code.
        if cfg!(target_arch = "avr") { self.is_known_by_comparing() } else { self.is_known_by_looking() }
    }

    #[inline(always)]
    const fn is_known_by_comparing(self) -> bool {
        // H, M and S are known in both cases.
        let upper = self.0 & !0x20;
        let both = upper == b'H' || upper == b'M' || upper == b'S';
        both || self.0 == b'A' || self.0 == b'C' || self.0 == b'N' || self.0 == b'e'
    }

    /// By the bits of the byte's upper half that go with its lower half.
    #[inline(always)]
    #[expect(clippy::indexing_slicing, reason = "four bits are a place among 16")]
    const fn is_known_by_looking(self) -> bool {
        const KNOWN: [u8; 16] = {
            let mut known = [0; 16];
            let mut all: &[u8] = b"ANHSMChsme";
            while let [first, rest @ ..] = all {
                known[(*first & 15) as usize] |= 1 << (*first >> 4);
                all = rest;
            }
            known
        };
        (KNOWN[(self.0 & 15) as usize] as u32) >> (self.0 >> 4) & 1 != 0
    }
}

#[cfg(test)]
mod tests {
    use super::Opcode;

    #[test]
    fn exactly_the_ten_opcodes_of_the_specification_are_known() {
        for byte in 0..=u8::MAX {
            let known = b"ANHSMChsme".contains(&byte);
            assert_eq!(Opcode(byte).is_known_by_looking(), known, "{byte:#04x}");
            assert_eq!(Opcode(byte).is_known_by_comparing(), known, "{byte:#04x}");
        }
    }
}
