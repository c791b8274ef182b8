//! Milliseconds that wrap at 2^32, whatever the caller's `unsigned long` holds.

use core::ffi::c_ulong;

/// A time as the structs keep it.
pub fn stamp(now: u32) -> c_ulong {
    c_ulong::from(now)
}

/// A time that came from C, or out of a struct.
#[allow(clippy::cast_possible_truncation, reason = "that is the point, where unsigned long has 64 bits")]
pub const fn time(stamp: c_ulong) -> u32 {
    stamp as u32
}

/// How much of `span` is left at `now` when it began at `since`; 0 when it is over.
pub const fn left(now: u32, since: c_ulong, span: u32) -> u32 {
    span.saturating_sub(now.wrapping_sub(time(since)))
}

/// How long a setting says something lasts, 0 standing for the default. At most half of what wraps, so that it can be
/// told when it is over.
pub fn span(time: c_ulong, default: u32) -> u32 {
    match u32::try_from(time) {
        Ok(0) => default,
        Ok(time) => time.min(LONGEST),
        Err(_) => LONGEST,
    }
}

const LONGEST: u32 = 0x7FFF_FFFF;

#[cfg(test)]
mod tests {
    use super::{left, stamp};

    #[test]
    fn time_wraps() {
        assert_eq!(left(100, stamp(90), 50), 40);
        assert_eq!(left(140, stamp(90), 50), 0);
        assert_eq!(left(5, stamp(u32::MAX - 4), 50), 40);
        assert_eq!(left(45, stamp(u32::MAX - 4), 50), 0);
    }
}
