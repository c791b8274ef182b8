//! A command on its way.

mod text;

use zerocopy::FromBytes;

use super::Outcome;
use crate::session::{Transmission, left};

/// Bytes that a command's text and its id take together at most, when `&t=`, two digits, `&id=` and LF are to fit too.
const TEXT_MAX: usize = 54;

/// One command.
#[derive(Clone, Debug, FromBytes)]
pub(super) struct Slot {
    /// When it was sent first.
    first_at: u32,
    pub(super) transmission: Transmission,
    /// When it began to wait for what comes next: when its line was fetched, or an older command was heard of.
    since: u32,
    /// How long from then on its line was not on the wire yet.
    delay: u32,
    /// Its place in the order in which commands are queued.
    pub(super) order: u32,
    /// Places of its first and last line in the order in which lines are sent.
    pub(super) first_line: u32,
    pub(super) last_line: u32,
    /// By how much the counter had advanced when it was sent first.
    mark: u32,
    /// What the caller knows it by.
    pub(super) handle: u16,
    /// Checksum of the line.
    pub(super) sum: u16,
    /// How far it is.
    stage: u8,
    /// How it ended.
    outcome: u8,
    /// The line's number.
    pub(super) t: u8,
    /// Bits of `ACKED`, `LINKSETUP` and `SUMMED`.
    flags: u8,
    /// Bytes of the line that was sent last.
    length: u8,
    /// Lengths of the two parts of the text.
    command_length: u8,
    id_length: u8,
    /// Number of older commands that have ended, and may have been executed after it.
    pub(super) overtaken: u8,
    /// The command as the caller built it, and behind that the id, encoded.
    text: [u8; TEXT_MAX],
}

/// There is no command; so too in any other stage than the following.
const FREE: u8 = 0;
/// It waits for its turn, or to be fetched for sending.
const QUEUED: u8 = 1;
/// It was sent, and waits to be fetched for sending again.
const DUE: u8 = 2;
/// It was sent and waits for what comes back.
const SENT: u8 = 3;
/// It has ended, which is to be reported.
const ENDED: u8 = 4;

/// The device has acknowledged it.
const ACKED: u8 = 1;
/// It is a `linksetup`.
const LINKSETUP: u8 = 2;
/// It was sent with its checksum the last time.
const SUMMED: u8 = 4;

impl Slot {
    pub(super) const fn is_free(&self) -> bool {
        !matches!(self.stage, QUEUED..=ENDED)
    }

    pub(super) const fn is_queued(&self) -> bool {
        self.stage == QUEUED
    }

    pub(super) const fn is_due(&self) -> bool {
        self.stage == DUE
    }

    pub(super) const fn is_waiting(&self) -> bool {
        self.stage == SENT
    }

    /// It was sent, and has not ended.
    pub(super) const fn is_out(&self) -> bool {
        matches!(self.stage, DUE | SENT)
    }

    /// It has not ended.
    pub(super) const fn is_going_on(&self) -> bool {
        matches!(self.stage, QUEUED..=SENT)
    }

    pub(super) const fn has_ended(&self) -> bool {
        self.stage == ENDED
    }

    pub(super) const fn is_acked(&self) -> bool {
        self.flags & ACKED != 0
    }

    pub(super) const fn is_linksetup(&self) -> bool {
        self.flags & LINKSETUP != 0
    }

    pub(super) const fn is_summed(&self) -> bool {
        self.flags & SUMMED != 0
    }

    /// How many commands were queued since, up to that one.
    pub(super) const fn age(&self, order: u32) -> u32 {
        order.wrapping_sub(self.order)
    }

    /// It leaves for the first time.
    pub(super) fn start(&mut self, t: u8, sum: u16, advanced: u32, now: u32) {
        self.t = t;
        self.sum = sum;
        self.mark = advanced;
        self.first_at = now;
        self.transmission.restart();
        self.flags &= LINKSETUP;
    }

    /// It was sent, as the line of that place in the order of all, and will have left after `delay`.
    pub(super) fn sent_as(&mut self, checksum: bool, line: u32, length: usize, now: u32, delay: u32) {
        if self.transmission.sent() == 0 {
            self.first_line = line;
        }
        self.last_line = line;
        self.length = u8::try_from(length).unwrap_or(u8::MAX);
        self.stage = SENT;
        self.transmission.send(now);
        (self.since, self.delay) = (now, delay);
        self.flags = if checksum { self.flags | SUMMED } else { self.flags & !SUMMED };
    }

    /// It was to be sent again, but can't be.
    pub(super) fn skip_retransmission(&mut self, now: u32) {
        self.stage = SENT;
        self.transmission.send(now);
        (self.since, self.delay) = (now, 0);
    }

    /// An older command has ended, of which that was the last of so many lines. If it was sent once more behind this
    /// one, it may have been executed behind it.
    pub(super) fn older_ended(&mut self, last_line: u32, newest: u32) {
        if newest.wrapping_sub(last_line) < newest.wrapping_sub(self.first_line) {
            self.overtaken = self.overtaken.saturating_add(1);
        }
    }

    pub(super) fn retransmit(&mut self) {
        self.stage = DUE;
    }

    /// Its ack came: whether it is the first.
    pub(super) fn acknowledge(&mut self) -> bool {
        let first = !self.is_acked();
        self.flags |= ACKED;
        // What it waits for now is the answer.
        self.stage = SENT;
        first
    }

    pub(super) fn end(&mut self, outcome: Outcome) {
        self.stage = ENDED;
        self.outcome = outcome as u8;
    }

    pub(super) fn release(&mut self) -> Outcome {
        self.stage = FREE;
        Outcome::of(self.outcome)
    }

    /// How much of `span` is left, for which it waits once its line has left.
    pub(super) fn left(&self, now: u32, span: u32) -> u32 {
        left(now, self.since, span.saturating_add(self.delay))
    }

    /// How long it has waited.
    pub(super) const fn waited(&self, at: u32) -> u32 {
        at.wrapping_sub(self.since).saturating_sub(self.delay)
    }

    /// An older command was heard of: before, nothing can have been heard of this one.
    pub(super) const fn older_heard(&mut self, at: u32) {
        if self.waited(at) > 0 {
            (self.since, self.delay) = (at, 0);
        }
    }

    /// Bytes that may lie in the device's receive buffer.
    pub(super) fn in_flight(&self, acks: bool) -> u32 {
        if self.is_waiting() && !(acks && self.is_acked()) { self.length.into() } else { 0 }
    }

    /// Whether it is so little since it was sent first that the device still remembers it.
    pub(super) fn is_recent(&self, now: u32, span: u32, advanced: u32) -> bool {
        let within = left(now, self.first_at, span.saturating_add(1)) > 0;
        within && advanced.wrapping_sub(self.mark) < 128
    }
}
