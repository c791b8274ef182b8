//! What a motion side can be told to do differently.

use core::ffi::{c_int, c_ulong};

use crate::clock::span;
use crate::gx::MASK_AXES;

/// Settings of a motion side. 0 stands for the default everywhere.
#[derive(Clone, Debug, Default)]
#[repr(C)]
pub struct Settings {
    /// An incomplete command is given up, with an error notice, when the line was quiet for this many milliseconds; by
    /// default 1000, as somebody may be typing.
    pub gap_ms: c_ulong,
    /// Mask of the axes that the machine has, bit 0 being x: commands for others are refused, and position reports
    /// leave them out. By default all six.
    pub axes: c_int,
    /// Not 0: moves are taken in a session only, numbered in order; before one has begun, those with a number are
    /// refused, and those without always. For a motion side that only hosts with sessions drive: one that was switched
    /// off and on, or reset, while its host did not notice, takes nothing then that the host takes for the rest of the
    /// session. By default moves are taken with any number, or none, until a host begins a session.
    pub only_in_order: c_int,
}

impl Settings {
    /// All of them at their defaults.
    #[must_use]
    pub const fn new() -> Self {
        Self { gap_ms: 0, axes: 0, only_in_order: 0 }
    }

    pub(super) fn gap(&self) -> u32 {
        span(self.gap_ms, 1000)
    }

    /// The axes that there are, as a mask.
    pub(super) fn axes(&self) -> u8 {
        match u8::try_from(self.axes & c_int::from(MASK_AXES)) {
            Ok(0) | Err(_) => MASK_AXES,
            Ok(axes) => axes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Settings;

    #[test]
    fn zero_is_the_default() {
        let mut settings = Settings::new();
        assert_eq!((settings.gap(), settings.axes()), (1000, 0x3F));
        (settings.gap_ms, settings.axes) = (20, 0x43);
        assert_eq!((settings.gap(), settings.axes()), (20, 3));
        settings.axes = -1;
        assert_eq!(settings.axes(), 0x3F);
        settings.axes = 0x40;
        assert_eq!(settings.axes(), 0x3F);
    }
}
