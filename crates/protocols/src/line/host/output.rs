//! What goes out: lines, one at a time.

use super::event::Pending;
use super::{COMMAND_MAX, Outcome, Session, Slot};
use crate::session::left;

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
                self.pending.set(Pending::Ended);
                continue;
            };
            // A host that starts, or a device that does, has to find out about checksums.
            let flip = !first
                && slot.is_linksetup()
                && slot.transmission.sent() % 2 == 1
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
}
