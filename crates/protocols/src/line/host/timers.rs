//! Timeouts: retransmitting, giving up.

use super::event::Pending;
use super::{Outcome, Session, Slot};
use crate::session::count;

impl<const WINDOW: usize, const DEVICES: usize> Session<WINDOW, DEVICES> {
    /// How long until something is to be done; `None` when nothing is.
    pub(super) fn next_deadline(&self, now: u32) -> Option<u32> {
        if self.slots.iter().any(|slot| slot.is_due() || self.may_leave(slot)) {
            return Some(0);
        }
        self.slots.iter().filter_map(|slot| self.time_left(slot, now)).min()
    }

    /// Does what is due.
    pub(super) fn on_timer(&mut self, now: u32) {
        // Each of them once.
        for _ in 0..WINDOW {
            let Some(slot) = self.slots.iter().find(|slot| self.time_left(slot, now) == Some(0)) else { break };
            let handle = slot.handle();
            count(&mut self.health.timeouts);
            // Without acks, a device may have executed it and not recognise it.
            let safe = self.link.acks() || self.settings.recognises != 0 || slot.is_linksetup();
            if !(safe && self.may_retransmit(slot, now)) {
                self.give_up(handle);
            } else if let Some(slot) = self.slot(handle) {
                slot.retransmit();
                count(&mut self.health.repeats);
            }
        }
    }

    /// Retransmits a command at once, as the device asks for, when it may be.
    pub(super) fn retransmit_now(&mut self, handle: u16, certain: bool, now: u32) {
        let found = self.slots.iter().find(|slot| slot.is_out() && slot.handle() == handle);
        let may = found.is_some_and(|slot| (certain || slot.is_linksetup()) && self.may_retransmit(slot, now));
        if let Some(slot) = self.slot(handle).filter(|_| may) {
            slot.retransmit();
            count(&mut self.health.repeats);
        }
    }

    fn may_retransmit(&self, slot: &Slot, now: u32) -> bool {
        let recent = slot.is_recent(now, self.settings.repeat(), self.counter.advanced());
        slot.sent() <= self.settings.repeats() && (recent || slot.is_linksetup())
    }

    /// The command that is out and has that handle.
    fn slot(&mut self, handle: u16) -> Option<&mut Slot> {
        self.slots.iter_mut().find(|slot| slot.is_out() && slot.handle() == handle)
    }

    fn time_left(&self, slot: &Slot, now: u32) -> Option<u32> {
        let needs_ack = self.link.acks() && !slot.is_acked() && !slot.is_linksetup();
        let span = if needs_ack { self.settings.timeout() } else { self.settings.answer() };
        slot.is_waiting().then(|| slot.left(now, span))
    }

    fn give_up(&mut self, handle: u16) {
        let Some(slot) = self.slot(handle) else { return };
        let setup = if slot.is_linksetup() { slot.asks_for() } else { None };
        let acked = slot.is_acked();
        self.end(handle, Outcome::TimedOut);
        if let Some(mut setup) = setup {
            // What is in force is not known, and what the device remembers is as little as its window.
            setup.windowsize = None;
            if acked {
                self.link.adopt(setup, 1);
            }
            self.link.set_windowsize(1);
        }
    }

    /// Ends a command that was sent.
    pub(super) fn end(&mut self, handle: u16, outcome: Outcome) {
        let (order, newest) = (self.order, self.lines);
        let Some(slot) = self.slot(handle) else { return };
        slot.end(outcome);
        let (age, (first, last)) = (slot.age(order), slot.lines());
        self.pending.set(Pending::Ended);
        if first == last {
            return;
        }
        for newer in self.slots.iter_mut().filter(|newer| newer.is_out() && newer.age(order) < age) {
            newer.older_ended(last, newest);
        }
    }
}
