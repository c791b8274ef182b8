//! Timeouts: retransmitting, giving up.

use super::event::Pending;
use super::queue::OWN_HANDLE;
use super::{Outcome, Session, Slot};
use crate::session::count;

/// Bytes of an ack and an answer, about.
const REPLY_MAX: u16 = 192;

impl<const WINDOW: usize, const DEVICES: usize> Session<WINDOW, DEVICES> {
    /// How long until something is to be done; `None` when nothing is.
    pub(super) fn next_deadline(&self, now: u32) -> Option<u32> {
        if self.next_to_send().is_some() {
            return Some(0);
        }
        self.slots.iter().filter_map(|slot| self.time_left(slot, now)).min()
    }

    /// Does what is due.
    pub(super) fn on_timer(&mut self, now: u32) {
        let (mut ack_overdue, mut answer_overdue) = (false, false);
        // Each of them once.
        for _ in 0..WINDOW {
            let Some(slot) = self.slots.iter().find(|slot| self.time_left(slot, now) == Some(0)) else { break };
            let handle = slot.handle;
            count(&mut self.health.timeouts);
            // A device that has acknowledged it executes it again, and without acks it may have executed it.
            let unheard = self.link.acks() && !slot.is_acked();
            let safe = unheard || self.settings.recognises != 0 || slot.is_linksetup();
            if self.needs_ack(slot) {
                ack_overdue = true;
            } else {
                answer_overdue = true;
            }
            if !(safe && slot.may_be_repeated(&self.settings, self.counter.advanced, now)) {
                self.give_up(handle);
            } else if let Some(slot) = self.slot(handle) {
                slot.retransmit();
                count(&mut self.health.repeats);
            }
        }
        if ack_overdue {
            self.acks.back_off();
        }
        if answer_overdue {
            self.answers.back_off();
        }
    }

    /// The command that is out and has that handle.
    fn slot(&mut self, handle: u16) -> Option<&mut Slot> {
        self.slots.iter_mut().find(|slot| slot.is_out() && slot.handle == handle)
    }

    /// Whether an ack is what it waits for.
    fn needs_ack(&self, slot: &Slot) -> bool {
        self.link.acks() && !slot.is_acked() && !slot.is_linksetup()
    }

    fn time_left(&self, slot: &Slot, now: u32) -> Option<u32> {
        let settings = &self.settings;
        let (least, estimator) =
            if self.needs_ack(slot) { (settings.timeout(), &self.acks) } else { (settings.answer(), &self.answers) };
        // Besides, the longest reply has to come.
        let least = least.saturating_add(settings.line_time(REPLY_MAX));
        slot.is_waiting().then(|| slot.left(now, estimator.timeout(least, settings.repeat() >> 1)))
    }

    /// Something was heard of a command, at `heard_at`: only now can anything be heard of those behind it.
    pub(super) fn heard_of(&mut self, handle: u16) {
        let (order, at) = (self.order, self.heard_at);
        let Some(age) = self.slot(handle).map(|slot| slot.age(order)) else { return };
        for newer in self.slots.iter_mut().filter(|newer| newer.is_out() && newer.age(order) < age) {
            newer.older_heard(at);
        }
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
            self.link.windowsize = 0;
            self.ask_next();
        }
    }

    /// Ends a command that was sent.
    pub(super) fn end(&mut self, handle: u16, outcome: Outcome) {
        let (order, newest) = (self.order, self.lines);
        let Some(slot) = self.slot(handle) else { return };
        slot.end(outcome);
        let (age, first, last) = (slot.age(order), slot.first_line, slot.last_line);
        if handle != OWN_HANDLE {
            self.pending.set(Pending::Ended);
        }
        if first == last {
            return;
        }
        for newer in self.slots.iter_mut().filter(|newer| newer.is_out() && newer.age(order) < age) {
            newer.older_ended(last, newest);
        }
    }
}
