//! The line that a device receives.

use core::ffi::c_uchar;

use super::Fault;
use crate::line::encoder::COMMAND_MAX;
use crate::line::receiver::{Assembly, Received};

/// The line that is being received: one at a time, as long as a command may be. Its fields are private.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Input {
    assembly: Assembly,
    /// What was received: 0 nothing yet, the length of a line, or 255: one that was too long.
    received: c_uchar,
    line: [c_uchar; COMMAND_MAX],
}

/// See [`Input`].
const OVERLONG: u8 = 0xFF;

impl Input {
    /// Nothing received.
    #[must_use]
    pub fn new() -> Self {
        Self { assembly: Assembly::default(), received: 0, line: [0; COMMAND_MAX] }
    }

    /// Takes bytes up to the end of a line, and tells how many. None while a line is there.
    pub fn take(&mut self, bytes: &[u8]) -> usize {
        if self.received != 0 {
            return 0;
        }
        let (taken, received) = self.assembly.take(&mut self.line, bytes);
        self.received = match received {
            Received::Nothing => 0,
            Received::Line(length) => u8::try_from(length).unwrap_or(OVERLONG),
            Received::Overlong => OVERLONG,
        };
        taken
    }

    /// The line that was received, if there is one.
    ///
    /// # Errors
    ///
    /// [`Fault::Overflow`] in place of one that was too long.
    #[must_use]
    pub fn line(&self) -> Option<Result<&[u8], Fault>> {
        match self.received {
            0 => None,
            OVERLONG => Some(Err(Fault::Overflow)),
            length => Some(Ok(self.line.get(..usize::from(length)).unwrap_or_default())),
        }
    }

    /// The line is done with: the next may come.
    pub const fn release(&mut self) {
        self.received = 0;
    }
}

impl Default for Input {
    fn default() -> Self {
        Self::new()
    }
}
