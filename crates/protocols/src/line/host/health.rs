//! How well the link does.

use zerocopy::FromBytes;

use crate::session::RoundTrips;

/// Counters of a host session since it began; they wrap.
#[derive(Clone, Debug, Default, FromBytes)]
pub struct Health {
    /// Lines received that can be read.
    pub lines: u32,
    /// Of these, acks, answers and refusals that nothing was waiting for.
    pub strays: u32,
    /// Lines that can't be read.
    pub malformed: u32,
    /// Lines that were too long.
    pub overlong: u32,
    /// Messages that the device has sent, as the gaps in their numbers show, and that were not received.
    pub lost: u32,
    /// Errors that the device has reported.
    pub errors: u32,
    /// Times that the device restarted.
    pub restarts: u32,
    /// Calls of `Host::receive` that did not take all bytes, because events were to be fetched first.
    pub overflows: u32,
    /// Acks and answers that did not come in time.
    pub timeouts: u32,
    /// Commands that were retransmitted, because of that or because the device has asked for it.
    pub repeats: u32,
    /// Round trips: from a command that was sent once to what came back first.
    pub round_trips: RoundTrips,
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
            round_trips: RoundTrips::new(),
        }
    }
}
