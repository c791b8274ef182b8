//! A request on its way: what every kind of request has in common.

use core::ffi::{c_uchar, c_ulong};

use super::health::Health;
use crate::clock::{left, stamp, time};

/// One request at a time of each kind. Its fields are private.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Request {
    /// When it was sent last.
    sent_at: c_ulong,
    /// When its predecessor, of which answers may still come, was sent last.
    before_at: c_ulong,
    /// How far it is; 0 when there is none.
    stage: c_uchar,
    /// How often it was sent, as far as that counts.
    sent: c_uchar,
    /// Not 0: it was sent at all.
    used: c_uchar,
    /// Not 0: answers to the predecessor may still come.
    loose: c_uchar,
    /// Not 0: it was accepted by an ack.
    accepted: c_uchar,
}

/// There is no request.
pub(super) const FREE: u8 = 0;
/// It waits for its turn.
pub(super) const QUEUED: u8 = 1;
/// It was sent and waits for the answer.
pub(super) const SENT: u8 = 2;
/// It was refused, but only after a repeat: the first may have been accepted, and the second refused because of that.
pub(super) const DOUBTED: u8 = 3;
/// It was accepted.
pub(super) const ACCEPTED: u8 = 4;

impl Request {
    pub(super) const fn new() -> Self {
        Self { sent_at: 0, before_at: 0, stage: FREE, sent: 0, used: 0, loose: 0, accepted: 0 }
    }

    pub(super) const fn stage(&self) -> u8 {
        match self.stage {
            stage @ QUEUED..=ACCEPTED => stage,
            _ => FREE,
        }
    }

    pub(super) const fn is_free(&self) -> bool {
        self.stage() == FREE
    }

    /// A new request. Of the old one no answer can come any more if it was sent once and accepted: when such an
    /// operation ends, its ack is long gone by. Unless the line `doubles` frames: then the request may have been
    /// carried out twice.
    pub(super) fn queue(&mut self, doubles: bool) {
        if self.used != 0 {
            self.loose = u8::from(doubles || self.sent > 1 || self.accepted == 0);
            self.before_at = self.sent_at;
        }
        self.stage = QUEUED;
        self.sent = 0;
        self.used = 0;
        self.accepted = 0;
    }

    /// Something that was sent behind it was answered, so it was received, or is lost.
    pub(super) fn overtake(&mut self) {
        self.stage = ACCEPTED;
        self.sent = self.sent.min(1);
        self.accepted = 1;
    }

    /// Sends it for the first time or again.
    pub(super) fn send(&mut self, now: u32) {
        self.send_uncounted(now);
        self.sent = self.sent.saturating_add(1);
    }

    /// Sends it without counting that, since an answer would not be believed anyway.
    pub(super) fn send_uncounted(&mut self, now: u32) {
        self.sent_at = stamp(now);
        self.used = 1;
        self.stage = SENT;
    }

    /// It left only now.
    pub(super) fn put_out(&mut self, now: u32) {
        self.sent_at = stamp(now);
    }

    pub(super) const fn sent(&self) -> u8 {
        self.sent
    }

    /// It was answered, which takes it to that stage. Only of a request that was sent once it is known which sending
    /// was answered.
    pub(super) fn answer(&mut self, stage: u8, now: u32, health: &mut Health) {
        if self.sent == 1 && self.loose == 0 {
            health.round_trip(now.wrapping_sub(time(self.sent_at)));
        }
        self.accepted = u8::from(stage == ACCEPTED);
        self.stage = stage;
    }

    pub(super) fn set_stage(&mut self, stage: u8) {
        self.stage = stage;
    }

    /// How much of `span` is left since it was sent last.
    pub(super) const fn left(&self, now: u32, span: u32) -> u32 {
        left(now, self.sent_at, span)
    }

    /// How long answers to the predecessor may still come.
    pub(super) const fn loose_left(&self, now: u32, guard: u32) -> u32 {
        if self.loose == 0 { 0 } else { left(now, self.before_at, guard) }
    }

    /// Whether a repeat may still be on its way, or its answer.
    pub(super) const fn in_flight(&self, now: u32, guard: u32) -> bool {
        self.sent > 1 && self.left(now, guard) > 0
    }
}

#[cfg(test)]
mod tests {
    use super::{ACCEPTED, Health, Request};

    #[test]
    fn answers_to_a_request_may_still_come_unless_it_was_sent_once_and_accepted() {
        let loose = |sent: u32, accepted: bool, doubles: bool| {
            let (mut request, mut health) = (Request::new(), Health::new());
            request.queue(false);
            (0..sent).for_each(|time| request.send(time));
            if accepted {
                request.answer(ACCEPTED, 10, &mut health);
            }
            request.queue(doubles);
            // A request that is never sent does not change that.
            request.queue(doubles);
            request.loose_left(100, 500) > 0
        };
        assert!(!loose(0, false, true));
        assert!(!loose(1, true, false));
        assert!(loose(1, true, true));
        assert!(loose(1, false, false));
        assert!(loose(2, true, false));
    }
}
