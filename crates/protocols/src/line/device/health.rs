//! How well the link does.

use core::ffi::c_ulong;

/// How the link does. The counters wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct DeviceHealth {
    /// Commands that were received intact, repeats among them.
    pub commands: c_ulong,
    /// Commands that came again and were only answered again.
    pub repeats: c_ulong,
    /// Lines whose checksum was wrong or missing.
    pub checksums: c_ulong,
    /// Lines that could not be read.
    pub malformed: c_ulong,
    /// Lines that were too long.
    pub overflows: c_ulong,
    /// Commands that were refused: by their function, or because nobody knows their id or name.
    pub refused: c_ulong,
}
