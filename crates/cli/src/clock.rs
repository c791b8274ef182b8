//! The time of arrival of what comes.

use std::time::{Duration, Instant};

use crate::status::Failure;

/// What comes is looked for at least this often. It is shorter than every gap that ends a message.
pub const SLICE: Duration = Duration::from_millis(25);

/// A clock that stands still while bytes wait to be read.
///
/// A program that is held up (by a signal, a slow reader of its output, a busy machine) finds bytes whose time of
/// arrival it can't know. It must not take the time that it was held up for silence on the line. So this clock shows
/// the last time at which nothing was waiting; bytes that were read move it on by at most [`SLICE`].
#[derive(Debug)]
pub struct Clock {
    began: Instant,
    now: Duration,
}

impl Clock {
    /// It begins now.
    #[must_use]
    pub fn new() -> Self {
        Self { began: Instant::now(), now: Duration::ZERO }
    }

    /// When what was received last arrived, or until when nothing did.
    pub const fn now(&self) -> Duration {
        self.now
    }

    /// The same in milliseconds, as sessions count them.
    #[expect(clippy::cast_possible_truncation, reason = "it may wrap")]
    pub const fn now_ms(&self) -> u32 {
        self.now.as_millis() as u32
    }

    /// Calls `look`, which waits for at most so long, until it has received something or that time is over (a signal
    /// ends it too). At most a [`SLICE`] of it is waited.
    pub fn receive<T>(
        &mut self,
        time: Duration,
        mut look: impl FnMut(Duration) -> Result<Option<T>, Failure>,
    ) -> Result<Option<T>, Failure> {
        for wait in [Duration::ZERO, time.min(SLICE), Duration::ZERO] {
            let before = self.began.elapsed();
            if let Some(received) = look(wait)? {
                self.now = self.began.elapsed().min(self.now + SLICE);
                return Ok(Some(received));
            }
            // It may have waited long before it looked.
            if wait.is_zero() {
                self.now = before;
            }
            if time.is_zero() {
                break;
            }
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::{Clock, Duration, SLICE};
    use std::thread::sleep;

    #[test]
    fn time_that_bytes_waited_is_no_silence() {
        let mut clock = Clock::new();
        let held_up = 4 * SLICE;
        sleep(held_up);
        assert_eq!(clock.receive(SLICE, |_| Ok(Some(1))).unwrap(), Some(1));
        assert_eq!(clock.now(), SLICE);
        // Held up between looking and noting that nothing was there.
        let mut looks = 0;
        let nothing = clock.receive(Duration::ZERO, |_| {
            sleep(held_up);
            looks += 1;
            Ok(None::<()>)
        });
        assert!(nothing.unwrap().is_none() && looks == 1);
        assert!((held_up..2 * held_up).contains(&clock.now()), "{:?}", clock.now());
    }
}
