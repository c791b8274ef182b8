//! What `linksetup` settles (page "Ozeki Line Protocol", sections "Link Setup command" and "Link Setup event").

use core::ffi::c_uchar;

use super::super::encoder::Encoder;
use super::super::message::Message;
use super::super::value::Value;
use crate::config::OLP_WINDOW_MAX;

/// What a link does. Its fields are private; all zero is how each begins: no acks, no checksums, one command at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Setup {
    ack: c_uchar,
    checksum: c_uchar,
    /// Commands that may be unanswered; 0 stands for 1.
    window: c_uchar,
}

impl Setup {
    /// A setup: a window of 0 stands for 1, and one beyond `OLP_WINDOW_MAX` for that.
    #[must_use]
    pub fn new(ack: bool, checksum: bool, window: u16) -> Self {
        let mut setup = Self { ack: c_uchar::from(ack), checksum: c_uchar::from(checksum), window: 0 };
        setup.set_window(window);
        setup
    }

    /// Whether commands are acked.
    #[must_use]
    pub const fn acks(self) -> bool {
        self.ack != 0
    }

    /// Whether commands have checksums.
    #[must_use]
    pub const fn checks(self) -> bool {
        self.checksum != 0
    }

    /// Commands that may be unanswered.
    #[must_use]
    pub const fn window(self) -> u8 {
        if self.window == 0 { 1 } else { self.window }
    }

    /// Whether it can have that window.
    #[must_use]
    pub fn has_window(window: u16) -> bool {
        (1..=OLP_WINDOW_MAX).contains(&usize::from(window))
    }

    fn set_window(&mut self, window: u16) {
        #[expect(clippy::cast_possible_truncation, reason = "at most 64")]
        const MAX: u8 = OLP_WINDOW_MAX as u8;
        self.window = u8::try_from(window).unwrap_or(MAX).min(MAX);
    }

    /// Puts in force what a linksetup says. What it leaves out or nobody understands stays as it is: the answer tells.
    pub fn change(&mut self, message: &Message) {
        if let Some(ack) = message.get(b"ack") {
            if ack.is(b"on") {
                self.ack = 1;
            } else if ack.is(b"off") {
                self.ack = 0;
            }
        }
        if let Some(checksum) = message.get(b"checksum") {
            if checksum.is(b"fletcher16") {
                self.checksum = 1;
            } else if checksum.is(b"none") {
                self.checksum = 0;
            }
        }
        if let Some(window) = message.get(b"windowsize").and_then(Value::word) {
            self.set_window(window);
        }
    }

    /// Adds it to a line, with the window size where wanted.
    pub fn write(self, line: &mut Encoder, with_window: bool) {
        if with_window {
            line.int(b"windowsize", self.window().into());
        }
        line.text(b"ack", if self.acks() { b"on" } else { b"off" });
        line.text(b"checksum", if self.checks() { b"fletcher16" } else { b"none" });
    }
}

#[cfg(test)]
mod tests {
    use super::{Message, OLP_WINDOW_MAX, Setup};

    fn changed(setup: Setup, line: &[u8]) -> Setup {
        let mut setup = setup;
        setup.change(&Message::parse(line).unwrap());
        setup
    }

    #[test]
    fn what_is_not_said_or_not_understood_stays() {
        let on = Setup::new(true, true, 1);
        let off = Setup::new(false, false, 1);
        assert_eq!(changed(Setup::default(), b"c=linksetup").window(), 1);
        assert_eq!(changed(off, b"c=linksetup&ack=on&checksum=fletcher16&t=2&id=x"), on);
        assert_eq!(changed(on, b"c=linksetup&ack=off"), Setup::new(false, true, 1));
        assert_eq!(changed(on, b"c=linksetup&checksum=none"), Setup::new(true, false, 1));
        for line in
            [&b"c=linksetup&ack=ON&checksum=crc16&windowsize=x"[..], b"c=linksetup&ack&checksum&windowsize=65536"]
        {
            assert_eq!(changed(on, line), on, "{line:?}");
            assert_eq!(changed(off, line), off, "{line:?}");
        }
    }

    #[test]
    fn windows_are_bounded() {
        for (asked, got) in [("0", 1), ("1", 1), ("2", OLP_WINDOW_MAX.min(2)), ("65535", OLP_WINDOW_MAX)] {
            let line = [b"c=linksetup&windowsize=", asked.as_bytes()].concat();
            assert_eq!(usize::from(changed(Setup::default(), &line).window()), got, "{asked}");
        }
    }
}
