//! The settings of a host session, and its counters.

use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

use crate::gx::{Format, NUMBER_MAX};
use crate::session::{span, times};

/// Settings of a host session, times in milliseconds. 0 stands for the default everywhere.
#[derive(Clone, Debug, Default, FromBytes, Immutable, KnownLayout)]
pub struct Settings {
    /// How long an answer may take to come; by default 250. What asks for one is not sent again sooner.
    pub answer_ms: u32,
    /// When no move ends for this long, the newest one is sent again, as something may be lost; by default 1000.
    pub probe_ms: u32,
    /// A session is given up when a move takes longer than this from its turn on; by default 120000.
    pub move_ms: u32,
    /// A notice is complete when the line was quiet for this long, or another one has begun; by default 50.
    pub gap_ms: u32,
    /// How often something is sent without an answer, or a session begun in vain; by default 8. Below 0: no limit.
    pub attempts: i16,
    /// Most moves that are sent and unfinished at a time: 1 to `WINDOW`, the default. Refused ones are sent again.
    pub window: u8,
    /// Not 0: commands are sent in ASCII, without short forms; position reports come in ASCII too.
    pub ascii: u8,
    /// The number that the first session begins with, 0 to 16383.
    pub first_number: u16,
    /// Every so manieth move is sent in positions, 1 to 255, so that nothing drifts; by default every 16th.
    pub absolute_every: u8,
    /// Not 0: the motion side only sends numbers back, as the proposal has it. Then without a session one move at a
    /// time is sent, in positions; again after [`probe_ms`](Self::probe_ms), which should be longer than a move lasts.
    pub echo: u8,
}

impl Settings {
    pub(super) const fn answer(&self) -> u32 {
        span(self.answer_ms, 250)
    }

    pub(super) const fn probe(&self) -> u32 {
        span(self.probe_ms, 1000)
    }

    pub(super) const fn move_timeout(&self) -> u32 {
        span(self.move_ms, 120_000)
    }

    pub(super) const fn gap(&self) -> u32 {
        span(self.gap_ms, 50)
    }

    /// Whether something may be tried again that was tried so often.
    pub(super) fn allows(&self, attempts: u8) -> bool {
        let most = times(self.attempts, 8, 0);
        most == 0 || attempts < most
    }

    /// What numbers a session's confirmations tell apart is the most, whatever was asked for.
    pub(super) fn window(&self, size: usize) -> usize {
        let most = if self.echo == 0 { size.min(127) } else { 1 };
        match usize::from(self.window) {
            0 => most,
            window => window.min(most),
        }
    }

    pub(super) const fn absolute_every(&self) -> u8 {
        if self.absolute_every == 0 { 16 } else { self.absolute_every }
    }

    pub(super) const fn format(&self) -> Format {
        if self.ascii == 0 { Format::Binary } else { Format::Ascii }
    }

    pub(super) const fn first_number(&self) -> u16 {
        if self.first_number <= NUMBER_MAX { self.first_number } else { 0 }
    }
}

/// Counters of a host session since it began; they wrap.
#[derive(Clone, Debug, Default, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Health {
    /// Moves sent, each counted once.
    pub moves: u32,
    /// Moves sent again.
    pub repeats: u32,
    /// Notices that moves were carried out.
    pub completions: u32,
    /// Error notices.
    pub errors: u32,
    /// Notices of numbers that nothing unfinished has: late, or sent again.
    pub strays: u32,
    /// Position reports.
    pub reports: u32,
    /// Malformed notices.
    pub malformed: u32,
    /// Answers that did not come in time.
    pub timeouts: u32,
    /// Sessions begun.
    pub sessions: u32,
    /// Ends and reports that did not fit what was requested.
    pub deviations: u32,
}

#[cfg(test)]
mod tests {
    use super::{Format, Settings};

    #[test]
    fn zero_is_the_default_and_what_is_out_of_range_the_nearest_that_is_not() {
        let mut it = Settings::default();
        assert_eq!((it.answer(), it.probe(), it.move_timeout(), it.gap()), (250, 1000, 120_000, 50));
        assert_eq!((it.window(16), it.format(), it.first_number()), (16, Format::Binary, 0));
        assert!(it.allows(7) && !it.allows(8));
        it = Settings { answer_ms: u32::MAX, attempts: 1000, window: 1, ascii: 2, first_number: 16384, ..it };
        assert_eq!((it.answer(), it.window(16)), (0x7FFF_FFFF, 1));
        assert!(it.allows(254) && !it.allows(255));
        assert_eq!((it.format(), it.first_number()), (Format::Ascii, 0));
        it = Settings { attempts: -1, window: 17, ..it };
        assert!(it.allows(255) && it.window(16) == 16);
    }
}
