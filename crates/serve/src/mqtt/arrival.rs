//! When a message arrived, where this program may have been held up.
//!
//! A program that was stopped, or whose machine was too busy for it, finds messages whose time of arrival it can't know.
//! They count as having arrived when it was held up.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

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
    /// When the program was held up last, and until when.
    held_up: Option<(Instant, Instant)>,
}

impl Arrival {
    pub(super) fn new() -> Arc<Self> {
        let arrival = Arc::new(Self(Seen { last: Instant::now(), held_up: None }.into()));
        let watched = Arc::clone(&arrival);
        tokio::spawn(async move {
            let mut ticks = interval(TICK);
            ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
            loop {
                ticks.tick().await;
                locked(&watched.0).look(Instant::now());
            }
        });
        arrival
    }

    /// When what is read now arrived, at the earliest.
    pub(super) fn of_now(&self) -> Instant {
        locked(&self.0).arrival(Instant::now())
    }
}

impl Seen {
    fn look(&mut self, now: Instant) {
        if now.saturating_duration_since(self.last) >= HELD_UP {
            self.held_up = Some((self.last, now));
        }
        self.last = now;
    }

    fn arrival(&mut self, now: Instant) -> Instant {
        self.look(now);
        match self.held_up {
            Some((from, until)) if now.saturating_duration_since(until) < SETTLE => from,
            _ => now,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Duration, Instant, Seen};

    #[test]
    fn what_waited_while_the_program_was_held_up_is_as_old_as_that() {
        let began = Instant::now();
        let at = |ms| began + Duration::from_millis(ms);
        let mut seen = Seen { last: began, held_up: None };
        assert_eq!(seen.arrival(at(100)), at(100));
        assert_eq!(seen.arrival(at(5100)), at(100));
        // Another one, read a little later.
        seen.look(at(5200));
        assert_eq!(seen.arrival(at(5250)), at(100));
        for tick in 53..80 {
            seen.look(at(tick * 100));
        }
        assert_eq!(seen.arrival(at(8000)), at(8000));
    }
}
