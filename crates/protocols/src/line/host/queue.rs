//! Commands that are to be sent, the lines that go out, and the link setting that was asked for: a device that restarts
//! is asked for it again, before the next command.

use zerocopy::FromBytes;

use super::event::Pending;
use super::{COMMAND_MAX, Host, ID_MAX, Outcome, Session, SetupFields, Slot};
use crate::line::Encoder;
use crate::session::left;

/// Why a command was not queued.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QueueError {
    /// As many commands as can be kept have not ended, or their end was not fetched.
    Busy,
    /// It is no command that may be sent: see [`Host::send`].
    Malformed,
    /// The line would be longer than [`COMMAND_MAX`].
    TooLong,
}

impl<const LINE: usize, const WINDOW: usize, const DEVICES: usize> Host<LINE, WINDOW, DEVICES> {
    /// Queues a command for the device of that id, and returns its handle: 1 to 32767.
    ///
    /// `command` is the beginning of the line, e.g. `c=setswitch&state=1`: printable ASCII, without a checksum and
    /// without parameters `t` and `id`, which are added. It has to leave room for these: for a `t` of two digits, and
    /// for `s` where checksums are in force.
    pub fn send(&mut self, command: &[u8], id: &[u8]) -> Result<u16, QueueError> {
        let session = &mut self.session;
        let checksum = session.link.checks();
        let slots = &mut session.slots;
        let mut handle = session.handle;
        loop {
            handle = if (1..32767).contains(&handle) { handle.wrapping_add(1) } else { 1 };
            if !slots.iter().any(|slot| !slot.is_free() && slot.handle == handle) {
                break;
            }
        }
        // One is left for a linksetup of the session's own.
        let kept = slots.iter().filter(|slot| !slot.is_free() && slot.handle != OWN_HANDLE).count();
        if kept >= WINDOW.wrapping_sub(1) {
            return Err(QueueError::Busy);
        }
        let slot = slots.iter_mut().find(|slot| slot.is_free()).ok_or(QueueError::Busy)?;
        let order = session.order.wrapping_add(1);
        slot.queue(command, id, checksum)?;
        (slot.order, slot.handle) = (order, handle);
        if slot.is_linksetup()
            && let Some(asked) = slot.asks_for()
        {
            session.wanted.add(asked, id);
        }
        (session.order, session.handle) = (order, handle);
        Ok(handle)
    }

    /// Queues a `linksetup` with those of these parameters that are given. Three are one too many for a line.
    pub fn setup(
        &mut self,
        id: &[u8],
        ack: Option<bool>,
        checksum: Option<bool>,
        windowsize: Option<u16>,
    ) -> Result<u16, QueueError> {
        let mut room = [0; COMMAND_MAX];
        let length = setup_line(&mut room, SetupFields { ack, checksum, windowsize })?;
        self.send(room.get(..length).unwrap_or_default(), id)
    }
}

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
    /// Still to be asked for again: 2: acks and checksums, and then, as all of them make a line too long, 1: the window.
    missing: u8,
    id_length: u8,
    id: [u8; ID_MAX],
}

impl Wanted {
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
    /// Writes the next line to send, if it fits in that room, and returns its length; 0 when there is none.
    pub(super) fn output(&mut self, line: &mut [u8; COMMAND_MAX], room: usize, now: u32) -> usize {
        let checksum = self.link.checks();
        // Each command once, until there is one to send.
        for _ in 0..WINDOW {
            let Some(slot) = self.next_to_send().and_then(|index| self.slots.get_mut(index)) else { break };
            let (first, handle) = (slot.is_queued(), slot.handle);
            if !first && !slot.is_linksetup() && !slot.is_recent(self.settings.repeat(), self.counter.advanced, now) {
                // It had to wait for others until the device may have forgotten it.
                self.end(handle, Outcome::TimedOut);
                continue;
            }
            let t = if first { self.counter.choose(|t| slot.sum_with(t, checksum)) } else { Some(slot.t) };
            let Some(t) = t else {
                slot.end(Outcome::TooLong);
                if handle != OWN_HANDLE {
                    self.pending.set(Pending::Ended);
                }
                continue;
            };
            // A host that starts, or a device that does, has to find out about checksums.
            let flip = !first
                && slot.is_linksetup()
                && slot.transmission.sent % 2 == 1
                && slot.sum_with(slot.t, !checksum).is_some();
            let checksum = checksum != flip;
            let Some(length) = slot.write(t, checksum, line) else {
                slot.skip_retransmission(now);
                continue;
            };
            if length > room {
                break;
            }
            if first {
                let sum = slot.sum_with(t, checksum).unwrap_or_default();
                self.counter.sends(t, sum);
                slot.start(t, sum, self.counter.advanced, now);
                if slot.is_linksetup()
                    && let Some(windowsize) = slot.asks_for().and_then(|asked| asked.windowsize)
                {
                    self.asked = windowsize;
                }
            }
            self.lines = self.lines.wrapping_add(1);
            let time = self.settings.line_time(u16::try_from(length).unwrap_or_default());
            self.backlog = left(now, self.fetched_at, self.backlog).saturating_add(time);
            self.fetched_at = now;
            slot.sent_as(checksum, self.lines, length, now, self.backlog);
            return length;
        }
        0
    }

    /// Where the next command to send is, retransmissions first; `None` while the device's receive buffer has no room.
    pub(super) fn next_to_send(&self) -> Option<usize> {
        let any_due = self.slots.iter().any(Slot::is_due);
        let slots = self.slots.iter().enumerate();
        let may_go = slots.filter(|(_, slot)| if any_due { slot.is_due() } else { self.may_leave(slot) });
        let (index, slot) = may_go.max_by_key(|(_, slot)| slot.age(self.order))?;
        let acks = self.link.acks();
        let others = self.slots.iter().filter(|other| !core::ptr::eq(*other, slot));
        let in_flight = others.fold(0_u32, |sum, other| sum.saturating_add(other.in_flight(acks)));
        let fits = in_flight.saturating_add(slot.longest(self.link.checks())) <= self.settings.room();
        (in_flight == 0 || fits).then_some(index)
    }

    /// Whether a queued command's turn has come.
    fn may_leave(&self, slot: &Slot) -> bool {
        let most = u32::try_from(WINDOW.saturating_sub(1)).unwrap_or_default();
        slot.is_queued()
            // Those before it.
            && self.slots.iter().all(|other| {
                let ahead = other.age(self.order) > slot.age(self.order);
                let bars = other.is_queued()
                    || other.is_linksetup()
                    || slot.is_linksetup()
                    // Without acks only the answer says which of them was executed.
                    || !self.link.acks() && other.is_like(slot)
                    || self.behind(other, slot) >= u32::from(self.link.windowsize()).min(most);
                !(ahead && other.is_going_on() && bars)
            })
    }

    /// How many commands may be executed behind the one that was sent, when the new one is sent too: those sent
    /// after it, and older ones that may have to be retransmitted, or were.
    fn behind(&self, slot: &Slot, new: &Slot) -> u32 {
        let is_older = |other: &&Slot| other.is_out() && other.age(self.order) > slot.age(self.order);
        let older = self.slots.iter().filter(is_older).count();
        let older = u32::try_from(older).unwrap_or(u32::MAX);
        slot.age(new.order).saturating_add(slot.overtaken.into()).saturating_add(older)
    }

    /// The device has restarted: what is in force may not be what was asked for.
    pub(super) fn ask_again(&mut self) {
        self.wanted.missing = 2;
        self.ask_next();
    }

    /// Queues what is still to be asked for again, in front of all commands, unless a linksetup is under way.
    pub(super) fn ask_next(&mut self) {
        if self.wanted.missing == 0 || self.slots.iter().any(|slot| slot.is_going_on() && slot.is_linksetup()) {
            return;
        }
        let mut fields = self.wanted.fields();
        let differs = |wanted: Option<bool>, is: bool| wanted.is_some_and(|wanted| wanted != is);
        let differ = differs(fields.ack, self.link.acks()) || differs(fields.checksum, self.link.checks());
        if self.wanted.missing > 1 && differ {
            self.wanted.missing = 1;
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
        let oldest = queued.max_by_key(|slot| slot.age(self.order)).map(|slot| slot.order);
        if oldest.is_none() {
            self.order = self.order.wrapping_add(1);
        }
        let order = oldest.map_or(self.order, |order| order.wrapping_sub(1));
        let (wanted, checksum) = (&self.wanted, self.link.checks());
        let id = wanted.id.get(..wanted.id_length.into()).unwrap_or_default();
        let Some(slot) = self.slots.iter_mut().find(|slot| slot.is_free()) else { return };
        // What does not fit, with an id that is too long, is not asked for.
        let _ = slot.queue(room.get(..length).unwrap_or_default(), id, checksum);
        (slot.order, slot.handle) = (order, OWN_HANDLE);
    }
}

/// Writes `c=linksetup` and those parameters that are said.
fn setup_line(room: &mut [u8; COMMAND_MAX], fields: SetupFields) -> Result<usize, QueueError> {
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
    encoder.error().map_or(Ok(encoder.length()), |_| Err(QueueError::TooLong))
}

#[cfg(test)]
mod tests {
    use super::QueueError;
    use crate::line::host::{Settings, Slot};
    use zerocopy::FromZeros;

    /// With a window of 8.
    type Host = super::Host<81, 9, 1>;

    #[test]
    fn handles_are_those_of_no_other_command() {
        let mut host = Host::new(Settings::default());
        assert_eq!(host.send(b"c=a", b"x"), Ok(1));
        host.session.handle = 32766;
        for handle in [32767, 2, 3, 4, 5, 6, 7] {
            assert_eq!(host.send(b"c=a", b"x"), Ok(handle));
        }
        assert_eq!(host.send(b"c=a", b"x"), Err(QueueError::Busy));
        host.session.slots[0] = Slot::new_zeroed();
        assert_eq!(host.send(b"c=a&t=1", b"x"), Err(QueueError::Malformed));
        assert!(host.send(b"c=a", b"x").is_ok());
    }
}
