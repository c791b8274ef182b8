//! What goes out: commands, one at a time.

use super::{DRAINING, Host, Is, OPEN, Send};
use crate::gx::receiver::ESC;
use crate::gx::{Control, Format, Number, Vector, Written};
use crate::gx::{write_control, write_move, write_reporting, write_shortest};
use crate::session::count;

impl<const WINDOW: usize> Host<WINDOW> {
    /// Writes the next command to `room`, if it fits, and returns its length; 0 when there is none. To be called after
    /// [`poll`](Self::poll); `now` is when it leaves.
    pub fn output(&mut self, room: &mut [u8], now: u32) -> usize {
        if self.send.has(Send::Control) {
            return self.put_control(room, now);
        }
        // No other command may come between those that begin a session.
        let begins = self.send.has(Send::Handshake) || self.is_shaking_hands() && self.send.has(Send::Reporting);
        if begins || self.send.has(Send::Reporting) {
            return self.put_reporting(begins, room, now);
        }
        if let Some(index) = self.to_retransmit() {
            return self.retransmit(index, room, now);
        }
        if self.may_send() { self.put_next(room, now) } else { 0 }
    }

    fn put_control(&mut self, room: &mut [u8], now: u32) -> usize {
        let format = self.settings.format();
        // Behind the number of a move whose rest was lost, it would be answered by that number.
        let control = Control::of(self.control).unwrap_or(Control::Query);
        let length = put_behind(b'\n', room, |rest| write_control(format, None, control, rest));
        if length != 0 {
            self.send.clear(Send::Control);
            self.control_sent.send(now);
        }
        length
    }

    /// The request for reports, with a number where that begins a session.
    fn put_reporting(&mut self, begins: bool, room: &mut [u8], now: u32) -> usize {
        let format = self.settings.format();
        // ESC ends whatever came of a command before. Behind the number of a move whose rest was lost, a request that
        // has none would begin a session.
        let (first, number) =
            if begins { (ESC, Some(Number { value: self.handshake, format })) } else { (b'\n', None) };
        let length = put_behind(first, room, |rest| write_reporting(format, number, self.period, rest));
        if length != 0 {
            if self.send.has(Send::Handshake) {
                self.asked_at = now;
            } else if begins {
                self.is.set(Is::Repeated);
            }
            self.send.clear(Send::Handshake);
            self.send.clear(Send::Reporting);
            self.reports_at = now;
        }
        length
    }

    fn retransmit(&mut self, index: u8, room: &mut [u8], now: u32) -> usize {
        let mut target = Vector::new();
        if self.settings.echo == 0 {
            self.window.command_again(index, &mut target);
        } else {
            self.window.command_for_all(index, &mut target);
        }
        let format = self.settings.format();
        let number = Number { value: self.window.number(index), format };
        let length = write_move(format, Some(number), &target, room).unwrap_or(0);
        if length != 0 {
            self.window.make_absolute(index);
            if self.cursor < self.window.sent {
                self.cursor = index.wrapping_add(1);
            }
            self.send.clear(Send::Probe);
            self.asked_at = now;
            count(&mut self.health.repeats);
        }
        length
    }

    fn put_next(&mut self, room: &mut [u8], now: u32) -> usize {
        let index = self.window.sent;
        let mut target = Vector::new();
        let is_due = self.since_absolute.saturating_add(1) >= self.settings.absolute_every();
        // What only sends numbers back says nothing of what it makes of a command.
        let corrects = self.is.has(Is::OffPlan) || self.settings.echo != 0;
        if corrects {
            self.window.command_for_all(index, &mut target);
        } else {
            self.window.command(index, &mut target);
        }
        let format = self.settings.format();
        let number = Some(Number { value: self.window.number(index), format });
        let is_absolute = corrects || is_due || format == Format::Ascii;
        let length = if is_absolute {
            write_move(format, number, &target, room)
        } else {
            write_shortest(number, &target, self.window.before(index), room)
        };
        let length = length.unwrap_or(0);
        if length != 0 {
            if self.window.oldest().is_none() {
                self.progressed_at = now;
            }
            self.since_absolute = if is_absolute { 0 } else { self.since_absolute.saturating_add(1) };
            self.is.clear(Is::OffPlan);
            self.window.advance();
            self.cursor = self.window.sent;
            self.asked_at = now;
            count(&mut self.health.moves);
        }
        length
    }

    /// Which of the sent moves is to be sent again now.
    pub(super) fn to_retransmit(&self) -> Option<u8> {
        if !matches!(self.stage, OPEN | DRAINING) || self.is.has(Is::Held) || self.asked() == Some(Control::Stop) {
            return None;
        }
        let oldest = self.window.oldest()?;
        if self.cursor < self.window.sent {
            return Some(self.cursor.max(oldest));
        }
        (self.send.has(Send::Probe)).then(|| self.window.sent.wrapping_sub(1))
    }

    /// Whether a move is to be sent for the first time now.
    pub(super) fn may_send(&self) -> bool {
        let sent = self.window.sent;
        let unfinished = self.window.oldest().map_or(0, |oldest| usize::from(sent.wrapping_sub(oldest)));
        let held = self.is.has(Is::Held);
        let stops = self.asked() == Some(Control::Stop);
        self.stage == OPEN && !held && !stops && unfinished < self.settings.window(WINDOW) && self.window.has_next()
    }
}

/// Writes something behind a byte; returns the length, 0 if it does not fit.
fn put_behind(first: u8, room: &mut [u8], write: impl FnOnce(&mut [u8]) -> Written) -> usize {
    let [head, rest @ ..] = room else { return 0 };
    *head = first;
    write(rest).map_or(0, |length| length.wrapping_add(1))
}
