//! The numbers `t` of messages.
//!
//! The page counts the messages of both ends together, acks excepted, so the next number is one more than the last
//! that was sent or seen. Both ends send when they like: a number that is not ahead is of a message that crossed one
//! of ours, and means nothing. The device pages count each direction apart: a device does when its numbers go up one by
//! one whatever we send.

use zerocopy::FromBytes;

/// Commands that are remembered: as many as any device may remember.
const RECENT: usize = 64;

/// The counter of a session.
#[derive(Clone, Debug, FromBytes)]
pub(super) struct Counter {
    /// Numbers and checksums of the last commands: newer ones take the place of the oldest.
    recent: [Recent; RECENT],
    /// By how much the number has advanced in all: damaged ones may turn it round more than once.
    pub(super) advanced: u32,
    /// Where the next goes.
    place: u8,
    /// The next number.
    next: u8,
    /// Not 0: something was counted: before, lines that have `t=0` are not, as the sample conversation shows.
    counts: u8,
    /// Not 0: a number of the device's is known, from which gaps are counted.
    heard: u8,
    /// The newest of the device's numbers.
    last: u8,
    /// Not 0: the device counts its own messages alone, as the device pages have it.
    apart: u8,
}

/// A command that the device may remember.
#[derive(Clone, Copy, Debug, FromBytes)]
struct Recent {
    sum: u16,
    t: u8,
    used: u8,
}

impl Counter {
    /// A line of the device's had this number. Returns how many are missing before it.
    pub(super) fn saw(&mut self, t: u8) -> u8 {
        if t == 0 && self.counts == 0 {
            return 0;
        }
        if self.counts == 0 {
            self.next = t;
        }
        self.counts = 1;
        let (mut missing, mut is_newest) = (0, true);
        if self.heard != 0 {
            let together = t.wrapping_sub(self.next).cast_signed();
            let apart = t.wrapping_sub(self.last).wrapping_sub(1).cast_signed();
            if together == 0 {
                self.apart = 0;
            } else if apart == 0 {
                self.apart = 1;
            } else {
                missing = u8::try_from(if self.apart == 0 { together } else { apart }).unwrap_or_default();
            }
            is_newest = apart >= 0;
        }
        self.heard = 1;
        if is_newest {
            self.last = t;
        }
        self.advance_behind(t);
        missing
    }

    /// The device has restarted, and counts from 0.
    pub(super) fn restart(&mut self) {
        self.next = 0;
        self.counts = 0;
        self.heard = 0;
        self.apart = 0;
    }

    /// Chooses a new command's number; `sum` is its checksum with a number, `None` when it is too long with that.
    ///
    /// It is the next one, unless the device could take the command for an older one with the same number and words,
    /// or the number has too many digits. Then it is one that no recent command has.
    pub(super) fn choose(&self, sum: impl Fn(u8) -> Option<u16>) -> Option<u8> {
        let free = |t: u8| sum(t).is_some_and(|sum| !self.recent().any(|old| old.t == t && old.sum == sum));
        let unused = |t: u8| sum(t).is_some() && !self.recent().any(|old| old.t == t);
        let behind = |step: u8| self.next.wrapping_add(step);
        if free(self.next) {
            return Some(self.next);
        }
        (1..=u8::MAX).map(behind).find(|t| unused(*t)).or_else(|| (0..=u8::MAX).map(behind).find(|t| free(*t)))
    }

    /// A command with this number and checksum is sent for the first time.
    pub(super) fn sends(&mut self, t: u8, sum: u16) {
        let place = usize::from(self.place);
        if let Some(recent) = self.recent.get_mut(place) {
            *recent = Recent { sum, t, used: 1 };
        }
        self.place = if place.wrapping_add(1) < RECENT { self.place.wrapping_add(1) } else { 0 };
        self.counts = 1;
        self.advance_behind(t);
    }

    fn advance_behind(&mut self, t: u8) {
        let next = t.wrapping_add(1);
        let ahead = next.wrapping_sub(self.next);
        if ahead.cast_signed() > 0 {
            self.advanced = self.advanced.wrapping_add(ahead.into());
            self.next = next;
        }
    }

    fn recent(&self) -> impl Iterator<Item = &Recent> {
        self.recent.iter().filter(|recent| recent.used != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::Counter;
    use zerocopy::FromZeros;

    #[test]
    fn counts_both_ends_together() {
        let mut counter = Counter::new_zeroed();
        assert_eq!((counter.saw(0), counter.saw(0)), (0, 0));
        assert_eq!(counter.choose(|_| Some(7)), Some(0));
        counter.sends(0, 7);
        assert_eq!((1..11).map(|t| counter.saw(t)).sum::<u8>(), 0);
        assert_eq!(counter.choose(|_| Some(7)), Some(11));
        counter.sends(11, 7);
        // Crossed the command.
        assert_eq!((counter.saw(11), counter.next), (0, 12));
        assert_eq!((counter.saw(12), counter.saw(16), counter.saw(14)), (0, 3, 0));
        assert_eq!(counter.next, 17);
        counter.restart();
        assert_eq!((counter.saw(40), counter.saw(41)), (0, 0));
    }

    #[test]
    fn a_device_that_counts_its_own_messages_alone() {
        let mut counter = Counter::new_zeroed();
        assert_eq!((0..4).map(|t| counter.saw(t)).sum::<u8>(), 0);
        for t in 4..250 {
            counter.sends(counter.choose(|t| Some(t.into())).unwrap(), 7);
            counter.sends(counter.choose(|t| Some(t.into())).unwrap(), 8);
            assert_eq!(counter.saw(t), 0, "{t}");
        }
        assert_eq!((counter.saw(253), counter.saw(254), counter.saw(255), counter.saw(1)), (3, 0, 0, 1));
    }

    #[test]
    fn no_gap_in_front_of_the_first_number() {
        let mut counter = Counter::new_zeroed();
        counter.sends(0, 1);
        assert_eq!((counter.saw(57), counter.saw(59)), (0, 1));
        let mut counter = Counter::new_zeroed();
        assert_eq!((counter.saw(250), counter.next, counter.saw(3), counter.next), (0, 251, 8, 4));
    }

    #[test]
    fn a_number_is_not_used_again_for_the_same_command_while_it_may_be_remembered() {
        let mut counter = Counter::new_zeroed();
        counter.sends(0, 7);
        assert!((1..=255).all(|t| counter.saw(t) == 0));
        assert_eq!(counter.choose(|_| Some(8)), Some(0));
        assert_eq!(counter.choose(|_| Some(7)), Some(1));
        counter.sends(1, 7);
        (0..super::RECENT).for_each(|_| counter.sends(200, 9));
        counter.restart();
        assert_eq!(counter.choose(|_| Some(7)), Some(0));
    }

    #[test]
    fn a_number_with_few_digits_does_not_turn_the_counter_back() {
        let mut counter = Counter::new_zeroed();
        assert_eq!(counter.saw(119), 0);
        let short = |sum| move |t| (t < 100).then_some(sum);
        for sum in 0..300 {
            // Always one that no recent command has.
            let t = counter.choose(short(sum)).unwrap();
            assert!(!counter.recent().any(|recent| recent.t == t));
            counter.sends(t, sum);
            assert_eq!(counter.next, 120);
        }
        assert_eq!(counter.choose(|_| None), None);
    }
}
