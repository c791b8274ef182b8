//! How well the link does.

use core::ffi::c_ulong;

use crate::counter::RoundTrips;

/// Counters of a host session since it began; they wrap.
#[derive(Clone, Debug, Default)]
#[repr(C)]
pub struct Health {
    /// Intact frames received.
    pub frames: c_ulong,
    /// Of these, frames whose payload has the wrong length for the opcode. They are ignored.
    pub malformed: c_ulong,
    /// Of these, acks and nacks that nothing was waiting for: late, or of another opcode than was asked.
    pub strays: c_ulong,
    /// Bytes received that belong to no intact frame.
    pub garbage_bytes: c_ulong,
    /// Frames that were whole but for their checksum. Their bytes are among the garbage.
    pub checksum_failures: c_ulong,
    /// Calls of `dp_host_receive` that could not take all bytes: 0 where every event is fetched between two of them.
    pub overflows: c_ulong,
    /// Answers that did not come in time.
    pub timeouts: c_ulong,
    /// Requests that were repeated because of that.
    pub repeats: c_ulong,
    /// Number of round trips measured: from a request that was sent once to its answer. Times in milliseconds.
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
            frames: 0,
            malformed: 0,
            strays: 0,
            garbage_bytes: 0,
            checksum_failures: 0,
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
