//! What a host session can be told to do differently.

use core::ffi::{c_int, c_ulong};

use crate::clock::span;

/// Settings of a host session, times in milliseconds. 0 stands for the default everywhere; times of more than
/// 2147483647 ms (24 days) for that.
#[derive(Clone, Debug, Default)]
#[repr(C)]
pub struct Settings {
    /// How long an answer is waited for before the request is repeated; by default 250.
    pub ack_ms: c_ulong,
    /// The longest time from sending a request to its answer's arrival, however late: what has not come by then is
    /// lost. Nothing that came sooner is taken for the answer to a later request. By default 500.
    pub guard_ms: c_ulong,
    /// How long after its ack an operation may take to show in the state: a report of IDLE that comes sooner, with no
    /// other state before it, does not end the operation. Not below guard; by default 500.
    pub settle_ms: c_ulong,
    /// During an operation the status is requested when no report came for this long; by default 200.
    pub poll_ms: c_ulong,
    /// An operation is given up when nothing at all was received for this long; by default 3000.
    pub silence_ms: c_ulong,
    /// An operation is given up after this long in any case; by default 120000.
    pub operation_ms: c_ulong,
    /// An incomplete frame is given up when the line was quiet for this long; by default 50.
    pub gap_ms: c_ulong,
    /// How far each arm may be from the target of a move that is reported as finished by IDLE, in the units of the
    /// displacement; by default 0.25, twice what shipped firmware allows itself.
    pub tolerance: f32,
    /// How often a request is sent altogether before it has timed out, 1 to 255; by default 4.
    pub attempts: c_int,
    /// Layout of status reports, one of `DP_LAYOUT_*`; by default `DP_LAYOUT_AUTO`.
    pub layout: c_int,
    /// Not 0: each received message is an event.
    pub messages: c_int,
    /// Not 0: the line may deliver a frame twice, as some radio links do (a serial line does not). Each operation then
    /// waits until the guard time of the last one is over, even when that ended well before.
    pub doubles: c_int,
}

impl Settings {
    /// All of them at their defaults.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            ack_ms: 0,
            guard_ms: 0,
            settle_ms: 0,
            poll_ms: 0,
            silence_ms: 0,
            operation_ms: 0,
            gap_ms: 0,
            tolerance: 0.0,
            attempts: 0,
            layout: 0,
            messages: 0,
            doubles: 0,
        }
    }

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

    pub(super) fn silence(&self) -> u32 {
        span(self.silence_ms, 3000)
    }

    pub(super) fn operation(&self) -> u32 {
        span(self.operation_ms, 120_000)
    }

    pub(super) fn gap(&self) -> u32 {
        span(self.gap_ms, 50)
    }

    /// The bits of the float, which is finite.
    pub(super) const fn tolerance(&self) -> u32 {
        match self.tolerance.abs().to_bits() {
            0 => 0x3E80_0000,
            bits @ ..0x7F80_0000 => bits,
            _ => 0x7F7F_FFFF,
        }
    }

    pub(super) fn attempts(&self) -> u8 {
        match u8::try_from(self.attempts) {
            Ok(0) => 4,
            Ok(attempts) => attempts,
            Err(_) if self.attempts < 0 => 1,
            Err(_) => u8::MAX,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Settings;
    use core::ffi::c_ulong;

    #[test]
    fn zero_is_the_default_and_what_is_out_of_range_the_nearest_that_is_not() {
        let mut settings = Settings::new();
        assert_eq!((settings.ack(), settings.guard(), settings.settle()), (250, 500, 500));
        assert_eq!((settings.attempts(), settings.tolerance()), (4, 0.25_f32.to_bits()));
        (settings.ack_ms, settings.guard_ms, settings.attempts) = (c_ulong::MAX, 900, 1000);
        assert_eq!((settings.ack(), settings.guard(), settings.settle()), (0x7FFF_FFFF, 900, 900));
        assert_eq!(settings.attempts(), 255);
        settings.attempts = -1;
        assert_eq!(settings.attempts(), 1);
        for (set, used) in [(-0.0, 0.25), (-2.5, 2.5), (f32::MAX, f32::MAX), (f32::INFINITY, f32::MAX)] {
            settings.tolerance = set;
            assert_eq!(settings.tolerance(), f32::to_bits(used));
        }
    }
}
