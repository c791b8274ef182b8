//! The link setting that was asked for: a device that restarts is asked for it again, before the next command.

use zerocopy::FromBytes;

use super::{COMMAND_MAX, ID_MAX, QueueError, Session, SetupFields, Slot};
use crate::line::{EncodeError, Encoder};

/// The handle of commands of the session's own, of which no end is reported.
pub(super) const OWN_HANDLE: u16 = 0;

/// What all linksetups together have asked for.
#[derive(Clone, Debug, FromBytes)]
pub(super) struct Wanted {
    /// 0: not said, 1: off, 2: on.
    ack: u8,
    checksum: u8,
    /// 0: not said.
    windowsize: u16,
    /// Bits of `OPTIONS` and `WINDOW`: still to be asked for again.
    missing: u8,
    id_length: u8,
    id: [u8; ID_MAX],
}

/// Acks and checksums. With the window they make a line too long, so that goes by another.
const OPTIONS: u8 = 1;
const WINDOWSIZE: u8 = 2;

impl Wanted {
    pub(super) const fn new() -> Self {
        Self { ack: 0, checksum: 0, windowsize: 0, missing: 0, id_length: 0, id: [0; ID_MAX] }
    }

    /// A linksetup asks for this, of the device with that id. With one that is too long nothing is asked for again.
    pub(super) fn add(&mut self, asked: SetupFields, id: &[u8]) {
        self.ack = asked.ack.map_or(self.ack, |ack| u8::from(ack).wrapping_add(1));
        self.checksum = asked.checksum.map_or(self.checksum, |checksum| u8::from(checksum).wrapping_add(1));
        self.windowsize = asked.windowsize.unwrap_or(self.windowsize);
        self.id_length = u8::try_from(id.len()).ok().filter(|length| usize::from(*length) <= ID_MAX).unwrap_or(0);
        for (place, byte) in self.id.iter_mut().zip(id) {
            *place = *byte;
        }
    }

    fn fields(&self) -> SetupFields {
        let option = |value: u8| (value != 0).then_some(value > 1);
        let windowsize = Some(self.windowsize).filter(|size| *size != 0);
        SetupFields { ack: option(self.ack), checksum: option(self.checksum), windowsize }
    }
}

impl<const WINDOW: usize, const DEVICES: usize> Session<WINDOW, DEVICES> {
    /// The device has restarted: what is in force may not be what was asked for.
    pub(super) fn ask_again(&mut self) {
        self.wanted.missing = OPTIONS | WINDOWSIZE;
        self.ask_next();
    }

    /// Queues what is still to be asked for again, in front of all commands, unless a linksetup is under way.
    pub(super) fn ask_next(&mut self) {
        if self.wanted.missing == 0 || self.slots.iter().any(|slot| slot.is_going_on() && slot.is_linksetup()) {
            return;
        }
        let mut fields = self.wanted.fields();
        let differs = |wanted: Option<bool>, is: bool| wanted.is_some_and(|wanted| wanted != is);
        let asks_options = self.wanted.missing & OPTIONS != 0
            && (differs(fields.ack, self.link.acks()) || differs(fields.checksum, self.link.checks()));
        self.wanted.missing &= !OPTIONS;
        if asks_options {
            fields.windowsize = None;
        } else {
            self.wanted.missing = 0;
            (fields.ack, fields.checksum) = (None, None);
            fields.windowsize = fields.windowsize.filter(|windowsize| *windowsize > self.link.windowsize());
            if fields.windowsize.is_none() {
                return;
            }
        }
        let mut room = [0; COMMAND_MAX];
        let Ok(length) = setup_line(&mut room, fields) else { return };
        let queued = self.slots.iter().filter(|slot| slot.is_queued());
        let oldest = queued.max_by_key(|slot| slot.age(self.order)).map(Slot::order);
        if oldest.is_none() {
            self.order = self.order.wrapping_add(1);
        }
        let order = oldest.map_or(self.order, |order| order.wrapping_sub(1));
        let (wanted, checksum) = (&self.wanted, self.link.checks());
        let id = wanted.id.get(..wanted.id_length.into()).unwrap_or_default();
        let Some(slot) = self.slots.iter_mut().find(|slot| slot.is_free()) else { return };
        // What does not fit, with an id that is too long, is not asked for.
        let _ = slot.queue(room.get(..length).unwrap_or_default(), id, checksum, order, OWN_HANDLE);
    }
}

/// Writes `c=linksetup` and those parameters that are said.
pub(super) fn setup_line(room: &mut [u8; COMMAND_MAX], fields: SetupFields) -> Result<usize, QueueError> {
    let SetupFields { ack, checksum, windowsize } = fields;
    let mut encoder = Encoder::command(room, b"linksetup");
    if let Some(windowsize) = windowsize {
        encoder.word(b"windowsize", windowsize);
    }
    if let Some(ack) = ack {
        encoder.text(b"ack", if ack { b"on" } else { b"off" });
    }
    if let Some(checksum) = checksum {
        encoder.text(b"checksum", if checksum { b"fletcher16" } else { b"none" });
    }
    if encoder.error() == Some(EncodeError::TooLong) {
        return Err(QueueError::TooLong);
    }
    Ok(encoder.length())
}
