//! What goes out: commands, one at a time.

use super::{DRAINING, Host, IS_HELD, IS_REPEATED, OPEN, SEND_OPENING, SEND_PROBE, SEND_REPORTING};
use crate::clock::stamp;
use crate::counter::count;
use crate::gx::scanner::ESC;
use crate::gx::{ENCODED_MAX, EncodeError, Format, Number, Vector};
use crate::gx::{fitting, write_move, write_reporting, write_shortest};

impl Host {
    /// Writes the next command, if it fits in `room` bytes, and returns its length; 0 when there is none. To be called
    /// after [`poll`](Self::poll); `now` is when it leaves.
    pub fn output(&mut self, frame: &mut [u8; ENCODED_MAX], room: usize, now: u32) -> usize {
        // No other command may come between those that begin a session.
        let begins = self.is_opening() && self.send & SEND_REPORTING != 0;
        if begins || self.send & SEND_OPENING != 0 {
            return self.put_opening(frame, room, now);
        }
        if self.send & SEND_REPORTING != 0 {
            return self.put_reporting(frame, room, now);
        }
        if let Some(index) = self.to_repeat() {
            return self.put_again(index, frame, room, now);
        }
        if self.may_send() { self.put_next(frame, room, now) } else { 0 }
    }

    fn put_opening(&mut self, frame: &mut [u8; ENCODED_MAX], room: usize, now: u32) -> usize {
        let format = self.settings.format();
        let number = Some(Number { value: self.opening, format });
        // ESC ends whatever came of a command before.
        let length = put_behind(ESC, frame, |rest| write_reporting(format, number, self.period, rest));
        let length = fitting(length, room);
        if length != 0 {
            if self.send & SEND_OPENING != 0 {
                self.asked_at = stamp(now);
            } else {
                self.is |= IS_REPEATED;
            }
            self.send &= !(SEND_OPENING | SEND_REPORTING);
            self.reports_at = stamp(now);
        }
        length
    }

    fn put_reporting(&mut self, frame: &mut [u8; ENCODED_MAX], room: usize, now: u32) -> usize {
        // Behind the number of a move whose rest was lost, it would begin a session.
        let length = put_behind(b'\n', frame, |rest| write_reporting(self.settings.format(), None, self.period, rest));
        let length = fitting(length, room);
        if length != 0 {
            self.send &= !SEND_REPORTING;
            self.reports_at = stamp(now);
        }
        length
    }

    fn put_again(&mut self, index: u8, frame: &mut [u8; ENCODED_MAX], room: usize, now: u32) -> usize {
        let mut target = Vector::new();
        self.window.command_again(index, &mut target);
        let format = self.settings.format();
        let number = Number { value: self.window.number(index), format };
        let length = fitting(write_move(format, Some(number), &target, frame), room);
        if length != 0 {
            self.window.make_absolute(index);
            if self.cursor < self.window.sent() {
                self.cursor = index.wrapping_add(1);
            }
            self.send &= !SEND_PROBE;
            self.asked_at = stamp(now);
            count(&mut self.health.repeats);
        }
        length
    }

    fn put_next(&mut self, frame: &mut [u8; ENCODED_MAX], room: usize, now: u32) -> usize {
        let index = self.window.sent();
        let mut target = Vector::new();
        self.window.command(index, &mut target);
        let format = self.settings.format();
        let number = Some(Number { value: self.window.number(index), format });
        let from = self.window.before(index);
        let length = match format {
            Format::Binary => write_shortest(number, &target, from, frame),
            Format::Ascii => write_move(format, number, &target, frame),
        };
        let length = fitting(length, room);
        if length != 0 {
            if self.window.oldest().is_none() {
                self.progressed_at = stamp(now);
            }
            self.window.advance();
            self.cursor = self.window.sent();
            self.asked_at = stamp(now);
            count(&mut self.health.moves);
        }
        length
    }

    /// Which of the sent moves is to be sent again now.
    pub(super) fn to_repeat(&self) -> Option<u8> {
        if !matches!(self.stage, OPEN | DRAINING) || self.is & IS_HELD != 0 {
            return None;
        }
        let oldest = self.window.oldest()?;
        if self.cursor < self.window.sent() {
            return Some(self.cursor.max(oldest));
        }
        (self.send & SEND_PROBE != 0).then(|| self.window.sent().wrapping_sub(1))
    }

    /// Whether a move is to be sent for the first time now.
    pub(super) fn may_send(&self) -> bool {
        let sent = self.window.sent();
        let unfinished = self.window.oldest().map_or(0, |oldest| usize::from(sent.wrapping_sub(oldest)));
        let held = self.is & IS_HELD != 0;
        self.stage == OPEN && !held && unfinished < self.settings.window() && self.window.has_next()
    }
}

/// Writes something behind a byte.
fn put_behind(
    first: u8,
    frame: &mut [u8; ENCODED_MAX],
    write: impl FnOnce(&mut [u8]) -> Result<usize, EncodeError>,
) -> Result<usize, EncodeError> {
    let [head, rest @ ..] = frame;
    *head = first;
    write(rest).map(|length| length.wrapping_add(1))
}
