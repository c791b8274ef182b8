//! The settings of a session, and what the two ends have agreed upon.

use zerocopy::FromBytes;

use super::Message;
use crate::session::{span, times};

/// Settings of a host session: 0 stands for the default everywhere. Times are in milliseconds, at most 2^31 - 1.
#[derive(Clone, Copy, Debug, Default, FromBytes)]
pub struct Settings {
    /// How long to wait for an ack at least, and before a round trip was measured; 0: 500. (The page gives no times.)
    pub timeout_ms: u32,
    /// The same for an answer; 0: as long as for an ack.
    pub answer_ms: u32,
    /// How long after a command was first sent it may be sent again; 0: 4000. A device has to remember it for longer.
    pub repeat_ms: u32,
    /// How often a command may be retransmitted; 0: 3; below 0: never.
    pub repeats: i16,
    /// Not 0: the device recognises repeated commands, so that they are retransmitted without acks too.
    pub recognises: u8,
    /// The line's speed in baud, for when a line has left and how long a reply takes; 0: it is not known.
    pub baud: u32,
    /// Bytes that the device's receive buffer takes; 0: 63, as an Arduino's; below 0: any number.
    pub receive_room: i16,
}

impl Settings {
    pub(super) fn timeout(&self) -> u32 {
        span(self.timeout_ms, 500)
    }

    pub(super) fn answer(&self) -> u32 {
        span(self.answer_ms, self.timeout())
    }

    pub(super) fn repeat(&self) -> u32 {
        span(self.repeat_ms, 4000)
    }

    /// How long so many bytes are on the line, of 10 bits each, rounded up.
    pub(super) fn line_time(&self, bytes: u16) -> u32 {
        let bits = u32::from(bytes).saturating_mul(10_000);
        bits.saturating_add(self.baud.saturating_sub(1)).checked_div(self.baud).unwrap_or_default()
    }

    pub(super) fn room(&self) -> u32 {
        match self.receive_room {
            0 => 63,
            room => u32::try_from(room).unwrap_or(u32::MAX),
        }
    }

    pub(super) fn repeats(&self) -> u8 {
        times(self.repeats, 3, 0).min(254)
    }
}

/// What is in force on a link, as known; all zero: no acks, no checksums, a window of 1 ("Link Setup command").
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromBytes)]
pub struct Link {
    pub(super) ack: u8,
    pub(super) checksum: u8,
    /// 0 stands for 1, which is never here.
    pub(super) windowsize: u16,
}

impl Link {
    /// Whether the device acknowledges commands.
    pub const fn acks(&self) -> bool {
        self.ack != 0
    }

    /// Whether commands have a checksum.
    pub const fn checks(&self) -> bool {
        self.checksum != 0
    }

    /// Number of commands that may be unanswered, 1 to 65535, as far as the device is concerned.
    pub const fn windowsize(&self) -> u16 {
        if self.windowsize == 0 { 1 } else { self.windowsize }
    }

    /// Puts it in force; of the window, at most `most`. A window size that is not said is 1.
    pub(super) fn adopt(&mut self, fields: SetupFields, most: u16) {
        self.ack = fields.ack.map_or(self.ack, u8::from);
        self.checksum = fields.checksum.map_or(self.checksum, u8::from);
        self.windowsize = fields.windowsize.map(|size| size.min(most)).filter(|size| *size > 1).unwrap_or(0);
    }
}

/// What a line says about the link.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SetupFields {
    pub(super) ack: Option<bool>,
    pub(super) checksum: Option<bool>,
    pub(super) windowsize: Option<u16>,
}

impl SetupFields {
    /// What a line `linksetup` or `linksetup_resp` says; `None` when one of these parameters makes no sense.
    pub(super) fn of(message: &Message<'_>) -> Option<Self> {
        let mut fields = Self::default();
        if let Some(value) = message.get(b"ack") {
            fields.ack = Some(either(value.is(b"on"), value.is(b"off"))?);
        }
        if let Some(value) = message.get(b"checksum") {
            fields.checksum = Some(either(value.is(b"fletcher16"), value.is(b"none"))?);
        }
        if let Some(value) = message.get(b"windowsize") {
            fields.windowsize = Some(value.word()?);
        }
        Some(fields)
    }
}

fn either(yes: bool, no: bool) -> Option<bool> {
    (yes || no).then_some(yes)
}

#[cfg(test)]
mod tests {
    use super::{Link, Message, Settings, SetupFields};

    #[test]
    fn zero_is_the_default_and_what_is_out_of_range_the_nearest_that_is_not() {
        let mut settings = Settings::default();
        assert_eq!((settings.timeout(), settings.answer(), settings.repeat()), (500, 500, 4000));
        assert_eq!(settings.repeats(), 3);
        (settings.timeout_ms, settings.repeats) = (u32::MAX, 1000);
        assert_eq!((settings.timeout(), settings.answer(), settings.repeats()), (0x7FFF_FFFF, 0x7FFF_FFFF, 254));
        (settings.answer_ms, settings.repeats) = (900, -1);
        assert_eq!((settings.answer(), settings.repeats()), (900, 0));
        assert_eq!((settings.line_time(64), settings.room()), (0, 63));
        (settings.baud, settings.receive_room) = (2400, -1);
        assert_eq!((settings.line_time(24), settings.line_time(25), settings.room()), (100, 105, u32::MAX));
        (settings.baud, settings.receive_room) = (u32::MAX, 128);
        assert_eq!((settings.line_time(24), settings.room()), (1, 128));
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
            let fields = SetupFields::of(&Message::parse(line).unwrap());
            if let Some(fields) = fields {
                link.adopt(fields, 40000);
            }
            assert_eq!(fields.map(|_| (link.ack, link.checksum, link.windowsize())), after);
        }
    }
}
