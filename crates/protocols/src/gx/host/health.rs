//! How well the link does.

use core::ffi::c_ulong;

/// Counters of a host session since it began; they wrap.
#[derive(Clone, Debug, Default)]
#[repr(C)]
pub struct Health {
    /// Moves sent, each counted once.
    pub moves: c_ulong,
    /// Moves sent again.
    pub repeats: c_ulong,
    /// Notices that moves were carried out.
    pub completions: c_ulong,
    /// Error notices.
    pub errors: c_ulong,
    /// Notices of numbers that nothing unfinished has: late, or told again.
    pub strays: c_ulong,
    /// Position reports.
    pub reports: c_ulong,
    /// Malformed notices.
    pub malformed: c_ulong,
    /// Answers that did not come in time.
    pub timeouts: c_ulong,
    /// Sessions begun.
    pub sessions: c_ulong,
}

impl Health {
    /// Nothing counted yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            moves: 0,
            repeats: 0,
            completions: 0,
            errors: 0,
            strays: 0,
            reports: 0,
            malformed: 0,
            timeouts: 0,
            sessions: 0,
        }
    }
}
