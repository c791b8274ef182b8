//! What a motion side has seen.

use core::ffi::c_ulong;

/// Counters of a motion side since it began; they wrap.
#[derive(Clone, Debug, Default)]
#[repr(C)]
pub struct Health {
    /// Moves queued.
    pub moves: c_ulong,
    /// Moves that were queued before and came again: not carried out twice.
    pub repeats: c_ulong,
    /// Moves refused, told or not.
    pub refused: c_ulong,
    /// Malformed commands.
    pub malformed: c_ulong,
    /// Position reports sent.
    pub reports: c_ulong,
}

impl Health {
    /// Nothing counted yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { moves: 0, repeats: 0, refused: 0, malformed: 0, reports: 0 }
    }
}
