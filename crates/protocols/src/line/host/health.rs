//! How well the link does.

use core::ffi::c_ulong;

use crate::counter::RoundTrips;

/// Counters of a host session since it began; they wrap.
#[derive(Clone, Debug, Default)]
#[repr(C)]
pub struct Health {
    /// Lines received that can be read.
    pub lines: c_ulong,
    /// Of these, acks, answers and refusals that nothing was waiting for.
    pub strays: c_ulong,
    /// Lines that can't be read.
    pub malformed: c_ulong,
    /// Lines that were too long.
    pub overlong: c_ulong,
    /// Messages that the device has sent, as the gaps in their numbers show, and that were not received.
    pub lost: c_ulong,
    /// Errors that the device has reported.
    pub errors: c_ulong,
    /// Times that the device started anew.
    pub restarts: c_ulong,
    /// Calls of `olp_host_receive` that did not take all bytes, because events were to be fetched first.
    pub overflows: c_ulong,
    /// Acks and answers that did not come in time.
    pub timeouts: c_ulong,
    /// Commands that were repeated, because of that or because the device has asked for it.
    pub repeats: c_ulong,
    /// Number of round trips measured: from a command that was sent once to what came back first. Times in
    /// milliseconds.
    pub rtt_count: c_ulong,
    /// The last round-trip time.
    pub rtt_last: c_ulong,
    /// The shortest round-trip time.
    pub rtt_min: c_ulong,
    /// The longest round-trip time.
    pub rtt_max: c_ulong,
    /// Sum of the round-trip times: divided by `rtt_count`, their average.
    pub rtt_sum: c_ulong,
}

impl Health {
    /// Nothing counted yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            lines: 0,
            strays: 0,
            malformed: 0,
            overlong: 0,
            lost: 0,
            errors: 0,
            restarts: 0,
            overflows: 0,
            timeouts: 0,
            repeats: 0,
            rtt_count: 0,
            rtt_last: 0,
            rtt_min: 0,
            rtt_max: 0,
            rtt_sum: 0,
        }
    }

    pub(super) fn round_trip(&mut self, time: u32) {
        RoundTrips {
            count: &mut self.rtt_count,
            last: &mut self.rtt_last,
            min: &mut self.rtt_min,
            max: &mut self.rtt_max,
            sum: &mut self.rtt_sum,
        }
        .add(time);
    }
}
