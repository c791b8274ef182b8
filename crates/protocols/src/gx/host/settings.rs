//! What a host session can be told to do differently.

use core::ffi::{c_int, c_ulong};

use crate::clock::span;
use crate::config::GX_WINDOW_MAX;
use crate::gx::{Format, NUMBER_MAX};

/// Settings of a host session, times in milliseconds. 0 stands for the default everywhere.
#[derive(Clone, Debug, Default)]
#[repr(C)]
pub struct Settings {
    /// How long an answer may take to come; by default 250. What asks for one is not sent again sooner.
    pub answer_ms: c_ulong,
    /// How long no move may end until the newest one sent is sent again, in case something was lost; by default 1000.
    pub probe_ms: c_ulong,
    /// A session is given up when a move takes longer than this from its turn on; by default 120000.
    pub move_ms: c_ulong,
    /// A notice is complete when the line was quiet for this long, or another one has begun; by default 50.
    pub gap_ms: c_ulong,
    /// How often something is sent without any answer, or a session is asked for that the motion side does not keep,
    /// before it is given up; by default 8. Below 0: without end.
    pub attempts: c_int,
    /// Most moves that are sent and unfinished at a time, 1 to `GX_WINDOW_MAX`; by default that. More than the motion
    /// side queues are refused by it, and sent again.
    pub window: c_int,
    /// Not 0: commands are sent in ASCII, without short forms; position reports come in ASCII too.
    pub ascii: c_int,
    /// The number that the first session begins with, 0 to 16383.
    pub first_number: c_int,
}

impl Settings {
    /// All of them at their defaults.
    #[must_use]
    pub const fn new() -> Self {
        Self { answer_ms: 0, probe_ms: 0, move_ms: 0, gap_ms: 0, attempts: 0, window: 0, ascii: 0, first_number: 0 }
    }

    pub(super) fn answer(&self) -> u32 {
        span(self.answer_ms, 250)
    }

    pub(super) fn probe(&self) -> u32 {
        span(self.probe_ms, 1000)
    }

    pub(super) fn patience(&self) -> u32 {
        span(self.move_ms, 120_000)
    }

    pub(super) fn gap(&self) -> u32 {
        span(self.gap_ms, 50)
    }

    /// Whether something may be tried again that was tried so often.
    pub(super) fn allows(&self, attempts: u8) -> bool {
        let most = self.attempts();
        most == 0 || attempts < most
    }

    /// 0: no limit.
    fn attempts(&self) -> u8 {
        match u8::try_from(self.attempts) {
            Ok(0) => 8,
            Ok(attempts) => attempts,
            Err(_) if self.attempts < 0 => 0,
            Err(_) => u8::MAX,
        }
    }

    pub(super) fn window(&self) -> usize {
        match usize::try_from(self.window) {
            Ok(window @ 1..=GX_WINDOW_MAX) => window,
            _ => GX_WINDOW_MAX,
        }
    }

    pub(super) const fn format(&self) -> Format {
        if self.ascii == 0 { Format::Binary } else { Format::Ascii }
    }

    pub(super) fn first_number(&self) -> u16 {
        u16::try_from(self.first_number).unwrap_or_default() & NUMBER_MAX
    }
}

#[cfg(test)]
mod tests {
    use super::{Format, GX_WINDOW_MAX, Settings};
    use core::ffi::{c_int, c_ulong};

    #[test]
    fn zero_is_the_default_and_what_is_out_of_range_the_nearest_that_is_not() {
        let mut it = Settings::new();
        assert_eq!((it.answer(), it.probe(), it.patience(), it.gap()), (250, 1000, 120_000, 50));
        assert_eq!((it.attempts(), it.window(), it.format(), it.first_number()), (8, GX_WINDOW_MAX, Format::Binary, 0));
        (it.answer_ms, it.attempts, it.window, it.ascii, it.first_number) = (c_ulong::MAX, 1000, 1, 2, 16384);
        assert_eq!((it.answer(), it.attempts(), it.window()), (0x7FFF_FFFF, 255, 1));
        assert_eq!((it.format(), it.first_number()), (Format::Ascii, 0));
        (it.attempts, it.window, it.first_number) = (-1, c_int::MAX, -1);
        assert_eq!((it.attempts(), it.window(), it.first_number()), (0, GX_WINDOW_MAX, 0));
    }
}
