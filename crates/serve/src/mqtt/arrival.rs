//! When a message arrived, where this program may have been held up.
//!
//! A program that was stopped, or whose machine was too busy for it, finds messages whose time of arrival it can't know.
//! They count as having arrived when it was held up.
//!
//! Dates by which commands expire are compared with a clock that is never set back: else what had expired would be good
//! again.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use chrono::{DateTime, TimeDelta, Utc};
use tokio::time::{MissedTickBehavior, interval};

use crate::locked;

/// How often it is looked.
const TICK: Duration = Duration::from_millis(100);
/// From this on it counts as held up.
const HELD_UP: Duration = Duration::from_millis(500);
/// So long after that, what is read may have been waiting.
const SETTLE: Duration = Duration::from_secs(2);

/// Keeps an eye on the clock.
#[derive(Debug)]
pub(super) struct Arrival(Mutex<Seen>);

#[derive(Clone, Copy, Debug)]
struct Seen {
    last: Instant,
    /// What date that was, by the latest that the system's clock has shown.
    date: DateTime<Utc>,
    /// When the program was held up last, and until when.
    held_up: Option<(Instant, Instant)>,
}

impl Arrival {
    pub(super) fn new() -> Arc<Self> {
        let arrival = Arc::new(Self(Seen { last: Instant::now(), date: Utc::now(), held_up: None }.into()));
        let watched = Arc::clone(&arrival);
        tokio::spawn(async move {
            let mut ticks = interval(TICK);
            ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
            loop {
                ticks.tick().await;
                locked(&watched.0).look(Instant::now(), Utc::now());
            }
        });
        arrival
    }

    /// When what is read now arrived, at the earliest, and what date it is.
    pub(super) fn of_now(&self) -> (Instant, DateTime<Utc>) {
        let mut seen = locked(&self.0);
        let arrived = seen.arrival(Instant::now(), Utc::now());
        (arrived, seen.date)
    }
}

impl Seen {
    fn look(&mut self, now: Instant, date: DateTime<Utc>) {
        let passed = now.saturating_duration_since(self.last);
        if passed >= HELD_UP {
            self.held_up = Some((self.last, now));
        }
        let passed = TimeDelta::from_std(passed).unwrap_or_default();
        (self.last, self.date) = (now, date.max(self.date + passed));
    }

    fn arrival(&mut self, now: Instant, date: DateTime<Utc>) -> Instant {
        self.look(now, date);
        match self.held_up {
            Some((from, until)) if now.saturating_duration_since(until) < SETTLE => from,
            _ => now,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{DateTime, Duration, Instant, Seen, TimeDelta};

    #[test]
    fn what_waited_while_the_program_was_held_up_is_as_old_as_that() {
        let (began, date) = (Instant::now(), DateTime::UNIX_EPOCH);
        let at = |ms| began + Duration::from_millis(ms);
        let mut seen = Seen { last: began, date, held_up: None };
        assert_eq!(seen.arrival(at(100), date), at(100));
        assert_eq!(seen.arrival(at(5100), date), at(100));
        // Another one, read a little later.
        seen.look(at(5200), date);
        assert_eq!(seen.arrival(at(5250), date), at(100));
        for tick in 53..80 {
            seen.look(at(tick * 100), date);
        }
        assert_eq!(seen.arrival(at(8000), date), at(8000));
    }

    #[test]
    fn a_clock_that_is_set_back_goes_on_here() {
        let (began, date) = (Instant::now(), DateTime::UNIX_EPOCH);
        let (at, after) = (|ms| began + Duration::from_millis(ms), |ms| date + TimeDelta::milliseconds(ms));
        let mut seen = Seen { last: began, date, held_up: None };
        for (ms, shown, kept) in [(100, 100, 100), (200, -9_800, 200), (300, -9_700, 300), (400, 5_000, 5_000)] {
            seen.look(at(ms), after(shown));
            assert_eq!(seen.date, after(kept));
        }
    }
}
