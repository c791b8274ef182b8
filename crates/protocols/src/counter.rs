//! Counters that wrap, as the sessions' health is told in.

use core::ffi::c_ulong;

pub fn count(counter: &mut c_ulong) {
    *counter = counter.wrapping_add(1);
}

/// Where a session keeps its round-trip times, in milliseconds.
pub struct RoundTrips<'a> {
    pub count: &'a mut c_ulong,
    pub last: &'a mut c_ulong,
    pub min: &'a mut c_ulong,
    pub max: &'a mut c_ulong,
    pub sum: &'a mut c_ulong,
}

impl RoundTrips<'_> {
    pub fn add(self, time: u32) {
        let time = c_ulong::from(time);
        *self.last = time;
        *self.min = if *self.count == 0 { time } else { time.min(*self.min) };
        *self.max = time.max(*self.max);
        *self.sum = self.sum.wrapping_add(time);
        count(self.count);
    }
}

#[cfg(test)]
mod tests {
    use super::RoundTrips;

    #[test]
    fn round_trips() {
        let (mut count, mut last, mut min, mut max, mut sum) = (0, 0, 0, 0, 0);
        for time in [7, 3, 11] {
            RoundTrips { count: &mut count, last: &mut last, min: &mut min, max: &mut max, sum: &mut sum }.add(time);
        }
        assert_eq!((count, last, min, max, sum), (3, 11, 3, 11, 21));
    }
}
