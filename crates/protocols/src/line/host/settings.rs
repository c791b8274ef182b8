//! What a session can be told at its beginning, and what the two ends have agreed upon.

use core::ffi::{c_int, c_uint, c_ulong};

use super::Message;
use crate::clock::span;
use crate::config::OLP_WINDOW_MAX;

/// Settings of a host session: 0 stands for the default everywhere. Times are in milliseconds, at most 2^31 - 1.
#[derive(Clone, Debug, Default)]
#[repr(C)]
pub struct Settings {
    /// How long an ack may take; 0: 500. (The page gives no times.)
    pub timeout_ms: c_ulong,
    /// How long an answer may take, from when the command was sent last; 0: as long as an ack.
    pub answer_ms: c_ulong,
    /// How long after a command was sent first it may still be repeated; 0: 2000. For longer than this, and the time
    /// that a line may be on its way, a device has to remember which commands it has carried out (`olp_device`: 3000
    /// by default).
    pub repeat_ms: c_ulong,
    /// How often a command may be repeated; 0: 3; below 0: never.
    pub repeats: c_int,
    /// Not 0: the device recognises repeated commands, so that they are repeated without acks too.
    pub recognises: c_int,
}

impl Settings {
    /// The default.
    #[must_use]
    pub const fn new() -> Self {
        Self { timeout_ms: 0, answer_ms: 0, repeat_ms: 0, repeats: 0, recognises: 0 }
    }

    pub(super) fn timeout(&self) -> u32 {
        span(self.timeout_ms, 500)
    }

    pub(super) fn answer(&self) -> u32 {
        span(self.answer_ms, self.timeout())
    }

    pub(super) fn repeat(&self) -> u32 {
        span(self.repeat_ms, 2000)
    }

    pub(super) fn repeats(&self) -> u8 {
        match u8::try_from(self.repeats) {
            Ok(0) => 3,
            Ok(repeats) => repeats.min(254),
            Err(_) if self.repeats < 0 => 0,
            Err(_) => 254,
        }
    }
}

/// What is in force on a link, as far as the host knows. All zero is what it begins with: neither acks nor checksums,
/// one command at a time (section "Link Setup command").
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Link {
    /// Not 0: the device acknowledges commands.
    pub ack: c_int,
    /// Not 0: commands have a Fletcher-16 checksum.
    pub checksum: c_int,
    /// Number of commands that may be unanswered, 0 to 65535; 0 is as good as 1. No more than `OLP_WINDOW_MAX` ever
    /// are.
    pub windowsize: c_uint,
}

impl Link {
    pub(super) fn window(&self) -> c_uint {
        let most = c_uint::try_from(OLP_WINDOW_MAX).unwrap_or(1);
        self.windowsize.clamp(1, most)
    }

    /// What a line `linksetup` or `linksetup_resp` says: each parameter that it has. `None` when one of them makes no
    /// sense.
    pub(super) fn of(message: &Message<'_>) -> Option<Told> {
        let mut told = Told { ack: None, checksum: None, windowsize: None };
        if let Some(value) = message.get(b"ack") {
            told.ack = Some(either(value.is(b"on"), value.is(b"off"))?);
        }
        if let Some(value) = message.get(b"checksum") {
            told.checksum = Some(either(value.is(b"fletcher16"), value.is(b"none"))?);
        }
        if let Some(value) = message.get(b"windowsize") {
            told.windowsize = Some(value.word()?);
        }
        Some(told)
    }

    /// Puts it in force; of the window, at most `most`. A window size that is not told is 1.
    pub(super) fn adopt(&mut self, told: Told, most: c_uint) {
        self.ack = told.ack.map_or(self.ack, c_int::from);
        self.checksum = told.checksum.map_or(self.checksum, c_int::from);
        self.windowsize = c_uint::from(told.windowsize.unwrap_or(1)).min(most).max(1);
    }
}

/// What a line says about the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Told {
    pub(super) ack: Option<bool>,
    pub(super) checksum: Option<bool>,
    pub(super) windowsize: Option<u16>,
}

fn either(yes: bool, no: bool) -> Option<bool> {
    (yes || no).then_some(yes)
}

#[cfg(test)]
mod tests {
    use super::{Link, Message, Settings};
    use core::ffi::c_ulong;

    #[test]
    fn zero_is_the_default_and_what_is_out_of_range_the_nearest_that_is_not() {
        let mut settings = Settings::new();
        assert_eq!((settings.timeout(), settings.answer(), settings.repeat()), (500, 500, 2000));
        assert_eq!(settings.repeats(), 3);
        (settings.timeout_ms, settings.repeats) = (c_ulong::MAX, 1000);
        assert_eq!((settings.timeout(), settings.answer(), settings.repeats()), (0x7FFF_FFFF, 0x7FFF_FFFF, 254));
        (settings.answer_ms, settings.repeats) = (900, -1);
        assert_eq!((settings.answer(), settings.repeats()), (900, 0));
    }

    #[test]
    fn what_lines_say() {
        for (line, before, after) in [
            (&b"c=linksetup_resp&ack=on&checksum=fletcher16&id=sf6z34&t=3"[..], (0, 0, 8), Some((1, 1, 1))),
            (b"c=linksetup&windowsize=8&ack=off&checksum=none&t=2", (1, 1, 1), Some((0, 0, 8))),
            (b"c=linksetup&windowsize=0&ack=on", (0, 1, 1), Some((1, 1, 1))),
            (b"c=linksetup&windowsize=65535", (1, 1, 1), Some((1, 1, 40000))),
            (b"c=linksetup&ack=oo", (0, 0, 1), None),
            (b"c=linksetup&ack=on&checksum=crc16", (0, 0, 1), None),
            (b"c=linksetup&windowsize=65536", (0, 0, 1), None),
        ] {
            let (ack, checksum, windowsize) = before;
            let mut link = Link { ack, checksum, windowsize };
            let told = Link::of(&Message::parse(line).unwrap());
            if let Some(told) = told {
                link.adopt(told, 40000);
            }
            assert_eq!(told.map(|_| (link.ack, link.checksum, link.windowsize)), after);
        }
        let windows = [(0, 1), (1, 1), (5, 5), (60000, super::OLP_WINDOW_MAX)];
        for (windowsize, window) in windows {
            let link = Link { windowsize, ..Link::default() };
            assert_eq!(usize::try_from(link.window()).unwrap(), window.min(super::OLP_WINDOW_MAX));
        }
    }
}
