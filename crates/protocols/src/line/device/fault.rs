//! The codes of `onerror`. The page knows that there are some, and names none.

/// Why a line is not answered as its sender wished: the code of an `onerror`. To repeat a command helps against the
/// first three; the others answer one that was received intact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The line's checksum is wrong, or there is none and should be.
    Checksum,
    /// The line is longer than a command may be.
    Overflow,
    /// The line has no `c` in front, a damaged escape, or a t that is none.
    Malformed,
    /// No device of that id is here.
    UnknownId,
    /// The device has no command of that name.
    UnknownCommand,
    /// The device refused to execute the command.
    Refused,
    /// The command was executed, but the answer is too long to be sent.
    TooLong,
}

impl Fault {
    /// The code in words of the protocol.
    #[must_use]
    pub const fn code(self) -> &'static [u8] {
        match self {
            Self::Checksum => b"checksum",
            Self::Overflow => b"overflow",
            Self::Malformed => b"malformed",
            Self::UnknownId => b"unknownid",
            Self::UnknownCommand => b"unknowncommand",
            Self::Refused => b"refused",
            Self::TooLong => b"toolong",
        }
    }
}
