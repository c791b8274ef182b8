//! What `linksetup` sets (page "Ozeki Line Protocol", sections "Link Setup command" and "Link Setup event").

use zerocopy::FromBytes;

use super::super::message::Message;
use super::super::value::Value;

/// What a link does. All zero is how each begins: no acks, no checksums, one command at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromBytes)]
pub struct Setup {
    ack: u8,
    checksum: u8,
    /// Commands that may be unanswered; 0 stands for 1.
    window: u8,
}

impl Setup {
    /// A setup: a window of 0 stands for 1.
    pub const fn new(ack: bool, checksum: bool, window: u8) -> Self {
        Self { ack: ack as u8, checksum: checksum as u8, window }
    }

    /// Whether commands are acked.
    pub const fn acks(self) -> bool {
        self.ack != 0
    }

    /// Whether commands have checksums.
    pub const fn checks(self) -> bool {
        self.checksum != 0
    }

    /// Commands that may be unanswered.
    pub const fn window(self) -> u8 {
        if self.window == 0 { 1 } else { self.window }
    }

    /// Puts in force what a linksetup says, but a window of at most `most`. What it leaves out or says otherwise than
    /// the page stays as it is: the answer has what is in force. Whether it says anything about the window.
    pub fn change(&mut self, message: &Message, most: u8) -> bool {
        self.ack = choice(message.text(b"ack"), b"on", b"off", self.ack);
        self.checksum = choice(message.text(b"checksum"), b"fletcher16", b"none", self.checksum);
        let window = message.get(b"windowsize");
        if let Some(window) = window.and_then(Value::word) {
            self.window = u8::try_from(window).unwrap_or(most).min(most);
        }
        window.is_some()
    }
}

/// 1 or 0 as a value says by one word or the other, or what it was.
fn choice(value: Value<'_>, on: &[u8], off: &[u8], was: u8) -> u8 {
    if value.is(on) {
        1
    } else if value.is(off) {
        0
    } else {
        was
    }
}

#[cfg(test)]
mod tests {
    use super::{Message, Setup};

    fn changed(mut setup: Setup, line: &[u8]) -> Setup {
        setup.change(&Message::parse(line).unwrap(), 8);
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
        for (asked, got) in [("0", 1), ("1", 1), ("2", 2), ("8", 8), ("9", 8), ("256", 8), ("65535", 8)] {
            let line = [b"c=linksetup&windowsize=", asked.as_bytes()].concat();
            assert_eq!(changed(Setup::default(), &line).window(), got, "{asked}");
        }
    }
}
