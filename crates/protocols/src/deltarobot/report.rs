//! Status reports, and in which of two layouts they are written (specification, section "Status Report").

use zerocopy::{FromBytes, Immutable, KnownLayout};

use super::{POSITION_SIZE, Position};

/// Bytes of a status report that say something; the specification's has no others.
pub(super) const REPORT_SIZE: usize = POSITION_SIZE.wrapping_add(1);

/// Where STAT stands in a status report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum Layout {
    /// Reading: more than 13 bytes are [`Firmware`](Self::Firmware)'s. 13 bytes are [`Spec`](Self::Spec)'s unless only
    /// the last byte, and not the first, can be STAT. A byte can be STAT when its reserved bits are alike: zero as this
    /// library sends them, or one as shipped firmware does.
    ///
    /// Writing: as [`Firmware`](Self::Firmware), which no reader takes for anything else.
    #[default]
    Auto = 0,
    /// Specification v1.0: STAT, A, B, C; exactly 13 bytes.
    Spec = 1,
    /// Shipped firmware: A, B, C, STAT. Written as 16 bytes, the padding zero; read from 13 bytes on.
    Firmware = 2,
}

impl Layout {
    /// The layout that is stored as this number; [`Auto`](Self::Auto) where it is none's.
    #[must_use]
    pub const fn of(stored: u8) -> Self {
        match stored {
            1 => Self::Spec,
            2 => Self::Firmware,
            _ => Self::Auto,
        }
    }
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, FromBytes, Immutable, KnownLayout)]
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
        self.stat & Self::STAT_BITS
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

    /// Reads a payload; `None` when its length is wrong for the layout.
    #[must_use]
    pub fn read(payload: &[u8], layout: Layout) -> Option<Self> {
        let &[first, .., last] = payload.get(..REPORT_SIZE)? else { return None };
        let stat_first = match layout {
            Layout::Firmware => false,
            Layout::Auto => payload.len() == REPORT_SIZE && (can_be_stat(first) || !can_be_stat(last)),
            Layout::Spec if payload.len() == REPORT_SIZE => true,
            Layout::Spec => return None,
        };
        let position = Position::read(payload.get(usize::from(stat_first)..)?)?;
        Some(Self::new(position, if stat_first { first } else { last }))
    }
}

/// See [`Layout::Auto`].
const fn can_be_stat(byte: u8) -> bool {
    matches!(byte & !Report::STAT_BITS, 0 | 0xE0)
}

#[cfg(test)]
mod tests {
    use super::{Layout, Position, Report, State};

    const REPORT: Report = Report::new(Position([0x3F80_0000, 0x7F80_0001, 0xC060_0000]), 0b0001_0110);
    const FIRMWARE: [u8; 16] = [0, 0, 0x80, 0x3F, 1, 0, 0x80, 0x7F, 0, 0, 0x60, 0xC0, 0xF6, 0xDE, 0xAD, 0xBE];
    const SPEC: [u8; 13] = [0x16, 0, 0, 0x80, 0x3F, 1, 0, 0x80, 0x7F, 0, 0, 0x60, 0xC0];

    #[test]
    fn reserved_bits_are_masked() {
        assert_eq!(Report::new(Position::UNKNOWN, 0xFF).stat(), 0x1F);
        assert_eq!(Report::read(&FIRMWARE, Layout::Auto), Some(REPORT));
        assert_eq!(REPORT.stat(), 0x16);
    }

    #[test]
    fn states_are_the_two_lowest_bits() {
        for (bits, state) in [(0, State::Idle), (1, State::Homing), (2, State::Moving), (3, State::Error)] {
            assert_eq!(Report::new(Position::UNKNOWN, 0xFC | bits).state(), state);
        }
    }

    #[test]
    fn a_report_of_13_bytes_is_the_specifications_unless_that_is_impossible() {
        assert_eq!(Report::read(&SPEC, Layout::Auto), Some(REPORT));
        // Floats first; the first byte says which it can be.
        let floats_first = |first: u8, last: u8| {
            let mut bytes = [0; 13];
            (bytes[0], bytes[12]) = (first, last);
            Report::read(&bytes, Layout::Auto).map(|report| report.stat())
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
            assert_eq!(Report::read(&bytes[..length], Layout::Auto) == Some(REPORT), is_report, "{length}");
            assert_eq!(Report::read(&bytes[..length], Layout::Firmware) == Some(REPORT), length >= 13, "{length}");
            assert_eq!(Report::read(&bytes[..length], Layout::Spec).is_some(), length == 13, "{length}");
        }
    }
}
