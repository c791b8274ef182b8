//! The answers to the last commands, kept to be given again when a command is repeated.
//!
//! A repeat is the same line with the same `t`. But `t` wraps, and a host that was restarted counts from 0 again, so
//! the same line may also come as a new command. What is remembered is therefore no more than repeats need: as many
//! commands as the window in force has, for a time, and until the counter has come a good part of its way round.

use zerocopy::FromBytes;

/// How far the counter moves on before a command is forgotten: 256 less what a host may have counted unseen.
const AGE_MAX: u8 = 192;

/// The answer to a command.
#[derive(Clone, Copy, Debug, FromBytes)]
// In this order: on AVR what lies within 64 bytes takes shorter instructions.
#[repr(C)]
struct Answer<const REPLY: usize> {
    /// When the command was executed, or repeated last.
    since: u32,
    /// The command's checksum.
    sum: u16,
    /// The command's t.
    t: u8,
    /// Length of the answer; 0 when there is none.
    length: u8,
    /// The answer, a line with its LF.
    text: [u8; REPLY],
}

/// The answers to the last `WINDOW` commands. All zero is one without any.
#[derive(Clone, Debug, FromBytes)]
// In this order: on AVR what lies within 64 bytes takes shorter instructions.
#[repr(C)]
pub(super) struct Answers<const WINDOW: usize, const REPLY: usize> {
    newest: u8,
    /// Not 0: the newest command has just been executed, which may have taken longer than `now` says.
    pub(super) fresh: u8,
    slots: [Answer<REPLY>; WINDOW],
}

impl<const WINDOW: usize, const REPLY: usize> Answers<WINDOW, REPLY> {
    /// No answers.
    pub(super) const fn new() -> Self {
        const { assert!(0 < WINDOW && WINDOW <= 64 && REPLY <= 255) }
        let none = Answer { since: 0, sum: 0, t: 0, length: 0, text: [0; REPLY] };
        Self { slots: [none; WINDOW], newest: 0, fresh: 0 }
    }

    /// Forgets all of them.
    pub(super) fn forget(&mut self) {
        for slot in &mut self.slots {
            slot.length = 0;
        }
    }

    /// It is `now`. To be called first, so that the time that a command took does not count as time since.
    pub(super) fn settle(&mut self, now: u32) {
        if self.fresh != 0 {
            self.fresh = 0;
            self.newest_slot().since = now;
        }
    }

    /// Forgets what was executed or repeated last `span` milliseconds ago, before the clock comes round, and what will
    /// be too far back when the counter, at `next`, has moved on by so many steps.
    pub(super) fn forget_old(&mut self, now: u32, span: u32, next: u8, steps: u8) {
        for slot in &mut self.slots {
            if slot.length == 0 {
                continue;
            }
            let age = next.wrapping_sub(slot.t).checked_add(steps);
            if age.is_none_or(|age| age >= AGE_MAX) || now.wrapping_sub(slot.since) >= span {
                slot.length = 0;
            }
        }
    }

    /// Where the answer to a command is, if that is not forgotten. It is repeated `now`.
    pub(super) fn find(&mut self, t: u8, sum: u16, now: u32) -> Option<u8> {
        let mut place = 0_u8;
        for slot in &mut self.slots {
            if slot.length != 0 && slot.t == t && slot.sum == sum {
                slot.since = now;
                return Some(place);
            }
            place = place.wrapping_add(1);
        }
        None
    }

    /// The answer at a place.
    pub(super) fn get(&self, place: u8) -> Option<&[u8]> {
        self.slots.get(usize::from(place)).and_then(|slot| slot.text.get(..usize::from(slot.length)))
    }

    /// Makes room for an answer, in place of the oldest of `window`, which stays the same until all are forgotten.
    pub(super) fn begin(&mut self, window: u8) -> &mut [u8; REPLY] {
        let next = self.newest.wrapping_add(1);
        self.newest = if next < window { next } else { 0 };
        let slot = self.newest_slot();
        slot.length = 0;
        &mut slot.text
    }

    /// The room of the answer begun last.
    pub(super) fn room(&mut self) -> &mut [u8; REPLY] {
        &mut self.newest_slot().text
    }

    /// Keeps the answer begun last, of that length, for repeats. By a sum of 0, which no line has, it is not found.
    pub(super) fn keep(&mut self, t: u8, sum: u16, length: usize) {
        self.fresh = 1;
        let slot = self.newest_slot();
        slot.t = t;
        slot.sum = sum;
        slot.length = u8::try_from(length).unwrap_or_default();
    }

    fn newest_slot(&mut self) -> &mut Answer<REPLY> {
        let place = if usize::from(self.newest) < WINDOW { usize::from(self.newest) } else { 0 };
        #[expect(clippy::indexing_slicing, reason = "in range, as the line above sees to")]
        &mut self.slots[place]
    }
}

#[cfg(test)]
mod tests {
    type Answers = super::Answers<8, 64>;
    const SPAN: u32 = 3000;

    fn keep(answers: &mut Answers, t: u8, sum: u16, text: &[u8], window: u8) {
        answers.begin(window)[..text.len()].copy_from_slice(text);
        answers.keep(t, sum, text.len());
    }

    fn found(answers: &mut Answers, t: u8, sum: u16, now: u32) -> Option<Vec<u8>> {
        answers.settle(now);
        let next = answers.newest_slot().t.wrapping_add(1);
        answers.forget_old(now, SPAN, next, 0);
        let place = answers.find(t, sum, now)?;
        answers.get(place).map(<[u8]>::to_vec)
    }

    #[test]
    fn the_last_window_of_them() {
        for window in [1, 2, 8] {
            let mut answers = Answers::new();
            for t in 0..100 {
                keep(&mut answers, t, 7, &[t], window);
                for old in 0..=t {
                    let kept = t - old < window;
                    let answer = found(&mut answers, old, 7, 1000);
                    assert_eq!(answer, kept.then_some([old].to_vec()), "{old} at {t}, {window}");
                }
                assert_eq!(found(&mut answers, t, 8, 1000), None);
            }
            answers.forget();
            assert_eq!(found(&mut answers, 99, 7, 1000), None);
        }
    }

    #[test]
    fn kept_for_a_time_that_repeats_renew() {
        let mut answers = Answers::new();
        keep(&mut answers, 1, 2, b"x", 1);
        // It took longer than answers are kept.
        answers.settle(50_000);
        answers.settle(51_000);
        for now in [52_999, 55_998, 58_997] {
            assert_eq!(found(&mut answers, 1, 2, now), Some(b"x".to_vec()), "{now}");
        }
        assert_eq!(found(&mut answers, 1, 2, 61_997), None);
        // Not even when the clock has come round.
        assert_eq!(found(&mut answers, 1, 2, 58_997), None);
    }

    #[test]
    fn forgotten_before_the_counter_comes_round() {
        for steps in [1, 2, 50, 127] {
            let mut answers = Answers::new();
            keep(&mut answers, 250, 2, b"x", 1);
            for age in (1..192_u8).step_by(steps.into()) {
                answers.forget_old(0, SPAN, 250_u8.wrapping_add(age), steps);
                assert_eq!(answers.find(250, 2, 0).is_some(), age < 192 - steps, "{age}");
            }
        }
    }

    #[test]
    fn any_contents_do_no_harm() {
        let mut answers = Answers::new();
        answers.newest = 255;
        answers.fresh = 9;
        answers.slots[0].length = 255;
        answers.settle(1);
        let _ = found(&mut answers, 0, 0, 0);
        keep(&mut answers, 1, 2, b"y", 255);
        assert_eq!(found(&mut answers, 1, 2, 0), Some(b"y".to_vec()));
    }
}
