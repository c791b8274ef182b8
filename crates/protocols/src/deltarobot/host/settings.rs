//! What a host session can be asked to do differently, and its statistics.

use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

use crate::deltarobot::Observer;
use crate::session::{RoundTrips, count, span};

/// Settings of a host session, times in milliseconds. 0 stands for the default everywhere; times are at most
/// 2147483647 ms (24 days).
#[derive(Clone, Debug, Default, FromBytes, Immutable, KnownLayout)]
pub struct Settings {
    /// How long an answer is waited for before the request is retransmitted; by default 250.
    pub ack_ms: u32,
    /// The longest time from sending a request to its answer's arrival, if it comes at all; by default 500.
    pub guard_ms: u32,
    /// For how long after its ack IDLE does not end an operation that was not seen running; not below `guard_ms`, by
    /// default 500.
    pub settle_ms: u32,
    /// During an operation the status is requested when no report came for this long; by default 200.
    pub poll_ms: u32,
    /// An operation is given up when nothing at all was received for this long; by default 3000.
    pub silence_ms: u32,
    /// An operation is given up after this long in any case; by default 120000.
    pub operation_ms: u32,
    /// An incomplete frame is given up when the line was quiet for this long; by default 50.
    pub gap_ms: u32,
    /// How far each arm may be from the target of a finished move; by default 0.25, twice what shipped firmware allows.
    pub tolerance: f32,
    /// How often a request is sent altogether before it has timed out, 1 to 255; by default 4.
    pub attempts: i16,
    /// Layout of status reports: a [`Layout`](crate::deltarobot::Layout) as a number.
    pub layout: u8,
    /// Not 0: each received message is an event.
    pub messages: u8,
    /// Not 0: the line may deliver a frame twice, as some radio links do. Operations then keep `guard_ms` apart.
    pub duplicates: u8,
}

impl Settings {
    pub(super) fn ack(&self) -> u32 {
        span(self.ack_ms, 250)
    }

    pub(super) fn guard(&self) -> u32 {
        span(self.guard_ms, 500)
    }

    pub(super) fn settle(&self) -> u32 {
        span(self.settle_ms, 500).max(self.guard())
    }

    pub(super) fn poll(&self) -> u32 {
        span(self.poll_ms, 200)
    }

    /// The bits of the float, which is finite.
    pub(super) const fn tolerance(&self) -> u32 {
        match self.tolerance.abs().to_bits() {
            0 => 0x3E80_0000,
            bits @ ..0x7F80_0000 => bits,
            _ => 0x7F7F_FFFF,
        }
    }
}

/// Statistics of a host session since it began. Counters wrap at 2^32.
#[derive(Clone, Debug, Default, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Health {
    /// Intact frames received.
    pub frames: u32,
    /// Of these, frames whose payload has the wrong length for the opcode. They are ignored.
    pub malformed: u32,
    /// Of these, acks and nacks that nothing was waiting for: late, or of another opcode than was asked.
    pub strays: u32,
    /// Bytes received that belong to no intact frame.
    pub garbage_bytes: u32,
    /// Frames that were whole but for their checksum. Their bytes are among the garbage.
    pub checksum_failures: u32,
    /// Answers that did not come in time.
    pub timeouts: u32,
    /// Requests that were retransmitted because of that.
    pub retransmissions: u32,
    /// From a request that was sent once to its answer.
    pub round_trips: RoundTrips,
}

impl Observer for Health {
    fn skipped(&mut self, bytes: usize) {
        self.garbage_bytes = self.garbage_bytes.wrapping_add(u32::try_from(bytes).unwrap_or_default());
    }

    fn bad_checksum(&mut self) {
        count(&mut self.checksum_failures);
    }
}

#[cfg(test)]
mod tests {
    use super::Settings;

    #[test]
    fn zero_is_the_default_and_what_is_out_of_range_the_nearest_that_is_not() {
        let mut settings = Settings::default();
        assert_eq!((settings.settle(), settings.tolerance()), (500, 0.25_f32.to_bits()));
        settings.guard_ms = 900;
        assert_eq!(settings.settle(), 900);
        for (set, used) in [(-0.0, 0.25), (-2.5, 2.5), (f32::MAX, f32::MAX), (f32::INFINITY, f32::MAX)] {
            settings.tolerance = set;
            assert_eq!(settings.tolerance(), f32::to_bits(used));
        }
    }
}
