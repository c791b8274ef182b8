//! What the sessions of the three protocols share: time that wraps, counters and round trips.
//!
//! Times are milliseconds of the caller's clock, of which the lowest 32 bits count: they may wrap.

use zerocopy::{FromBytes, Immutable, KnownLayout};

/// How much of `span` is left at `now` when it began at `since`; 0 when it is over.
#[must_use]
pub const fn left(now: u32, since: u32, span: u32) -> u32 {
    span.saturating_sub(now.wrapping_sub(since))
}

/// How long a setting says something lasts, 0 standing for the default. At most half of what wraps, so that its end is
/// noticed.
#[must_use]
pub const fn span(setting: u32, default: u32) -> u32 {
    match setting {
        0 => default,
        1..=LONGEST => setting,
        _ => LONGEST,
    }
}

const LONGEST: u32 = 0x7FFF_FFFF;

/// Counts up; wraps at 2^32.
pub const fn count(counter: &mut u32) {
    *counter = counter.wrapping_add(1);
}

/// Statistics of round-trip times, in milliseconds.
#[derive(Clone, Copy, Debug, Default, FromBytes, Immutable, KnownLayout)]
pub struct RoundTrips {
    /// How many were measured.
    pub count: u32,
    /// The last one.
    pub last: u32,
    /// The shortest, when there was one.
    pub min: u32,
    /// The longest.
    pub max: u32,
    /// All of them together; wraps at 2^32.
    pub sum: u32,
}

impl RoundTrips {
    /// None yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { count: 0, last: 0, min: 0, max: 0, sum: 0 }
    }

    /// Adds a measured one.
    pub const fn add(&mut self, time: u32) {
        self.last = time;
        if self.count == 0 || time < self.min {
            self.min = time;
        }
        if time > self.max {
            self.max = time;
        }
        self.sum = self.sum.wrapping_add(time);
        count(&mut self.count);
    }
}

#[cfg(test)]
mod tests {
    use super::{RoundTrips, left, span};

    #[test]
    fn time_wraps() {
        assert_eq!(left(100, 90, 50), 40);
        assert_eq!(left(140, 90, 50), 0);
        assert_eq!(left(5, u32::MAX - 4, 50), 40);
        assert_eq!(left(45, u32::MAX - 4, 50), 0);
    }

    #[test]
    fn settings_have_defaults_and_a_limit() {
        assert_eq!((span(0, 500), span(3, 500), span(u32::MAX, 500)), (500, 3, 0x7FFF_FFFF));
    }

    #[test]
    fn round_trips() {
        let mut times = RoundTrips::new();
        for time in [7, 3, 11] {
            times.add(time);
        }
        assert_eq!((times.count, times.last, times.min, times.max, times.sum), (3, 11, 3, 11, 21));
    }
}
