//! The settings of a motion side, and its counters.

use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

use crate::gx::MASK_AXES;

/// Settings of a motion side. 0 stands for the default everywhere.
#[derive(Clone, Debug, Default, FromBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Settings {
    /// The axes there are, bit 0 being x: commands for others are refused, and none reported. By default all six.
    pub axes: u8,
    /// Not 0: moves are taken in sessions only, for a machine that only hosts with sessions drive: when it was switched
    /// off and on, or reset, it takes nothing from a host that did not notice, for the rest of the session. By default
    /// moves are taken with any number, or none, until a host begins a session.
    pub only_in_order: u8,
    /// Milliseconds of silence after which an incomplete command is given up, with an error notice; by default 1000, as
    /// somebody may be typing.
    pub gap_ms: u32,
    /// The machine is to stop when nothing, not even a status query, has come for this many milliseconds while there are
    /// moves to carry out. 0: it is not.
    pub host_ms: u32,
}

impl Settings {
    /// The axes that there are, as a mask.
    pub(super) const fn axes(&self) -> u8 {
        match self.axes & MASK_AXES {
            0 => MASK_AXES,
            axes => axes,
        }
    }
}

/// Counters of a motion side since it began; they wrap.
#[derive(Clone, Debug, Default, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Health {
    /// Moves queued.
    pub moves: u32,
    /// Moves that were queued before and came again: not carried out twice.
    pub repeats: u32,
    /// Moves refused, with an error notice or without.
    pub refused: u32,
    /// Malformed commands.
    pub malformed: u32,
    /// Position reports sent.
    pub reports: u32,
}

#[cfg(test)]
mod tests {
    use super::Settings;

    #[test]
    fn zero_is_the_default() {
        for (axes, there_are) in [(0, 0x3F), (0x43, 3), (0x40, 0x3F)] {
            assert_eq!(Settings { axes, ..Settings::default() }.axes(), there_are);
        }
    }
}
