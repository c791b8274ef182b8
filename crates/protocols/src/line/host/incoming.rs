//! What a line from the device means.

use super::event::Pending;
use super::queue::OWN_HANDLE;
use super::{Link, Message, Outcome, Session, SetupFields, Slot};
use crate::line::device::Fault;
use crate::line::message::same;
use crate::line::{Received, Value};
use crate::session::count;

impl<const WINDOW: usize, const DEVICES: usize> Session<WINDOW, DEVICES> {
    /// Handles what was received.
    pub(super) fn handle(&mut self, received: Received<'_>, now: u32) {
        self.handled = u8::from(received != Received::Nothing);
        match received {
            Received::Nothing => (),
            Received::TooLong => {
                count(&mut self.health.overlong);
                self.pending.set(Pending::TooLong);
            }
            Received::Line(line) => {
                if let Ok(message) = Message::parse(line) {
                    self.dispatch(&message, now);
                } else {
                    count(&mut self.health.malformed);
                    self.pending.set(Pending::Malformed);
                }
            }
        }
    }

    /// Handles a line.
    fn dispatch(&mut self, message: &Message<'_>, now: u32) {
        count(&mut self.health.lines);
        let name = message.command();
        if name.is(b"ack") {
            return self.acked(message);
        }
        // A refusal is trusted directly behind its command's ack alone.
        let acked = self.acked;
        self.acked = 0;
        if name.is(b"onerror") {
            return self.failed(message, acked, now);
        }
        self.counted(message);
        if name.is(b"welcome") {
            return self.welcome(message);
        }
        self.own_setup = 0;
        let linksetup = SetupFields::of(message);
        if name.is(b"linksetup")
            && let Some(fields) = linksetup
        {
            self.own_setup = 1;
            self.asked = fields.windowsize.unwrap_or(1);
            self.link.adopt(fields, self.asked);
            self.pending.set(Pending::Linksetup);
            return;
        }
        if !self.answered(message) {
            self.pending.set(Pending::Line);
        }
    }

    /// Counts a message that has a number.
    fn counted(&mut self, message: &Message<'_>) {
        if let Some(t) = last(message, b"t").and_then(Value::byte) {
            let lost = self.counter.saw(t);
            if lost > 0 {
                self.lost = lost;
                self.health.lost = self.health.lost.wrapping_add(u32::from(lost));
                self.pending.set(Pending::Lost);
            }
        }
    }

    fn acked(&mut self, message: &Message<'_>) {
        let heard_at = self.heard_at;
        self.acked = 0;
        let t = only(message, b"t").and_then(Value::byte);
        let id = only(message, b"id");
        let written = message.get(b"checksum");
        let sum = written.and_then(Value::hex);
        // A damaged name is no `null`.
        let null = written.map_or(!self.link.checks(), |written| written.is(b"null"));
        let found = self.slots.iter_mut().find(|slot| {
            let right = sum.map_or(null, |sum| sum == slot.sum);
            slot.is_out() && t == Some(slot.t) && slot.is_of(id) && right
        });
        let Some(slot) = found else { return count(&mut self.health.strays) };
        self.acked = slot.handle;
        if !slot.is_linksetup() {
            // The device may have its acks and checksums set by somebody else, or none.
            let mut link = self.link;
            link.ack = 1;
            link.checksum = u8::from(link.checks() && sum.is_some());
            if link != self.link {
                self.link = link;
                self.pending.set(Pending::Linksetup);
            }
        }
        if slot.acknowledge() {
            if slot.handle != OWN_HANDLE {
                self.concerned = slot.handle;
                self.pending.set(Pending::Acked);
            }
            if slot.transmission.sent == 1 {
                self.health.round_trips.add(slot.transmission.elapsed(heard_at));
                self.acks.add(slot.waited(heard_at));
            }
            let handle = slot.handle;
            self.heard_of(handle);
        }
    }

    /// Whether the line was the answer to a command.
    fn answered(&mut self, message: &Message<'_>) -> bool {
        let heard_at = self.heard_at;
        let name = message.command();
        let is_setup = name.is(b"linksetup_resp");
        let needs_ack = self.link.acks() && !is_setup;
        // Some devices encode less than they should: without acks, what two lines that ran together look like is enough.
        let id = if needs_ack { only(message, b"id") } else { message.get(b"id").filter(|_| !is_joined(message)) };
        let fields = if is_setup { SetupFields::of(message) } else { None };
        let slot = Self::oldest(&mut self.slots, self.order, |slot| {
            let asked = if is_setup { slot.asks_for() } else { None };
            // Each thing that was asked for has to be answered legibly.
            let legible = !is_setup
                || fields.zip(asked).is_some_and(|(fields, asked)| {
                    (fields.ack.is_some() || asked.ack.is_none())
                        && (fields.checksum.is_some() || asked.checksum.is_none())
                });
            let credible = slot.is_acked() || !needs_ack;
            slot.is_out() && credible && legible && slot.is_answered_by(name) && slot.is_of(id)
        });
        let found = slot.is_some();
        if let Some(slot) = slot {
            if slot.transmission.sent == 1 {
                if !slot.is_acked() {
                    self.health.round_trips.add(slot.transmission.elapsed(heard_at));
                }
                self.answers.add(slot.waited(heard_at));
            }
            let handle = slot.handle;
            self.heard_of(handle);
            self.end(handle, Outcome::Answered);
        } else if is_named_like_an_answer(name) {
            count(&mut self.health.strays);
        }
        if let Some(fields) = fields.filter(|fields| found || fields.ack.is_some() && fields.checksum.is_some()) {
            self.link.adopt(fields, self.asked);
            self.pending.set(Pending::Linksetup);
            self.ask_next();
        }
        found
    }

    fn failed(&mut self, message: &Message<'_>, acked: u16, now: u32) {
        count(&mut self.health.errors);
        self.pending.set(Pending::Error);
        self.concerned = 0;
        self.own_setup = 0;
        let code = message.text(b"code");
        let is = |fault: Fault| code.is(fault.code());
        let executed = is(Fault::TooLong);
        if executed || is(Fault::UnknownCommand) || is(Fault::UnknownId) || is(Fault::Refused) {
            self.refused(message, acked, if executed { Outcome::Answered } else { Outcome::Refused });
        } else {
            self.counted(message);
            self.damaged(is(Fault::Checksum), now);
        }
    }

    /// The device has read a command, and refuses it or can't answer it.
    fn refused(&mut self, message: &Message<'_>, acked: u16, outcome: Outcome) {
        let (t, id) = (only(message, b"t").and_then(Value::byte), only(message, b"id"));
        let link = self.link;
        let found = self.slots.iter_mut().find(|slot| {
            let directly = slot.handle == acked || !link.acks() || slot.is_linksetup();
            slot.is_out() && directly && t == Some(slot.t) && slot.is_of(id)
        });
        let Some(slot) = found else { return count(&mut self.health.strays) };
        self.concerned = slot.handle;
        // What was refused may be a damaged repeat of what was executed.
        if slot.transmission.sent == 1 || link.checks() {
            let handle = slot.handle;
            self.heard_of(handle);
            self.end(handle, outcome);
        }
    }

    /// The device has received damage: probably of the oldest command that it has said nothing about.
    fn damaged(&mut self, by_checksum: bool, now: u32) {
        let link = self.link;
        let needed = link.acks();
        let out = self.slots.iter().filter(|slot| slot.is_out()).count();
        let Some(slot) = Self::oldest(&mut self.slots, self.order, |slot| {
            slot.is_out() && !(slot.is_acked() && (needed || slot.is_linksetup()))
        }) else {
            return;
        };
        self.concerned = slot.handle;
        if by_checksum && !link.checks() && !slot.is_summed() {
            self.link.checksum = 1;
            self.pending.set(Pending::Linksetup);
        }
        // A line that falls apart is reported more than once, and of several commands it is not known which was damaged:
        // a device that does not recognise repeats would execute one twice.
        let certain = self.settings.recognises != 0 || out == 1 && slot.transmission.sent == 1;
        let safe = certain || slot.is_linksetup();
        if slot.is_waiting() && safe && slot.may_be_repeated(&self.settings, self.counter.advanced, now) {
            slot.retransmit();
            count(&mut self.health.repeats);
        }
    }

    fn welcome(&mut self, message: &Message<'_>) {
        self.pending.set(Pending::Welcome);
        if !self.devices.welcome(message) {
            return;
        }
        // It has restarted, and knows nothing of what was before.
        count(&mut self.health.restarts);
        self.counter.restart();
        self.asked = if self.own_setup == 0 { 1 } else { self.asked };
        for slot in &mut self.slots {
            // Sending these again may be sending them twice. Setting up a link twice is no harm.
            if slot.is_out() && !slot.is_linksetup() {
                slot.end(Outcome::Restarted);
                self.pending.set(Pending::Ended);
            }
        }
        let link = Link::default();
        if self.own_setup == 0 && link != self.link {
            self.link = link;
            self.pending.set(Pending::Linksetup);
        }
        self.ask_again();
    }

    /// The slot of those that has waited longest.
    pub(super) fn oldest(slots: &mut [Slot], order: u32, is_one: impl Fn(&Slot) -> bool) -> Option<&mut Slot> {
        slots.iter_mut().filter(|slot| is_one(slot)).max_by_key(|slot| slot.age(order))
    }
}

/// The parameter `t` or `id`, if the line is in one piece: damaged ends would mix what is said about two commands.
fn only<'a>(message: &Message<'a>, name: &[u8]) -> Option<Value<'a>> {
    message.get(name).filter(|_| !is_torn(message) && !is_joined(message))
}

/// Whether there is a `=` in a value: nobody sends it unencoded, but a damaged separator or end leaves it there.
fn is_torn(message: &Message<'_>) -> bool {
    message.params().any(|param| param.value.raw().iter().any(|byte| matches!(byte, b'=')))
}

/// Whether it looks like two lines that lost the end between them.
fn is_joined(message: &Message<'_>) -> bool {
    let has_bad_t = message.get(b"t").is_some_and(|t| t.byte().is_none());
    let repeats = |name: &[u8]| message.params().value(name, 1).is_some();
    has_bad_t || repeats(b"t") || repeats(b"id")
}

/// The last parameter of a name: the link's own are behind the others.
fn last<'a>(message: &Message<'a>, name: &[u8]) -> Option<Value<'a>> {
    message.params().filter(|param| same(param.name, name)).last().map(|param| param.value)
}

fn is_named_like_an_answer(name: Value<'_>) -> bool {
    let before = name.len().saturating_sub(b"_resp".len());
    before > 0 && name.bytes().skip(before).eq(*b"_resp")
}
