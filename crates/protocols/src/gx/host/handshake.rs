//! How a session begins: see [`host`](super).

use super::{Host, Is, OPEN, Outcome, Pending, Send};
use crate::gx::NUMBER_MAX;
use crate::gx::motion::STRIDE;
use crate::session::count;

// Stages of a host, besides those that it names itself.

/// The number of the first request is waited for.
const FIRST: u8 = 3;
/// That of the second is; the first may come again meanwhile, as it was sent several times.
const LATE: u8 = 4;
/// That of the first again, and behind it that of the second.
const SECOND: u8 = 5;
/// That of the first has come again, and no other since.
const ECHOED: u8 = 6;

impl<const WINDOW: usize> Host<WINDOW> {
    pub(super) const fn is_shaking_hands(&self) -> bool {
        matches!(self.stage, FIRST..=ECHOED)
    }

    /// Asks for a session, with a number that was not used lately.
    pub(super) fn begin(&mut self) {
        let number =
            if self.is.has(Is::Used) { self.handshake.wrapping_add(STRIDE) } else { self.settings.first_number() };
        self.is.set(Is::Used);
        if self.settings.echo == 0 {
            self.ask(FIRST, number);
        } else {
            self.handshake = number & NUMBER_MAX;
            self.open();
        }
    }

    fn ask(&mut self, stage: u8, number: u16) {
        self.stage = stage;
        self.handshake = number & NUMBER_MAX;
        self.unanswered = 0;
        self.is.clear(Is::Repeated);
        self.send.set(Send::Handshake);
    }

    /// There was no answer.
    pub(super) fn ask_again(&mut self) {
        if self.gives_up() {
            self.give_up();
        } else {
            self.is.set(Is::Repeated);
            self.send.set(Send::Handshake);
        }
    }

    /// A number came back; `false` if it says nothing.
    pub(super) fn echoed(&mut self, number: u16) -> bool {
        let is_this = number == self.handshake;
        match self.stage {
            FIRST if is_this => {
                let stage = if self.is.has(Is::Repeated) { LATE } else { SECOND };
                self.ask(stage, number.wrapping_add(STRIDE));
            }
            // Behind this no late answer to the first can come: what it is answered by when it is sent once more
            // counts.
            LATE if is_this => self.ask(SECOND, number),
            ECHOED if is_this => self.open(),
            SECOND if is_this => self.order_missing(),
            SECOND | ECHOED if number == self.handshake.wrapping_sub(STRIDE) & NUMBER_MAX => self.stage = ECHOED,
            ECHOED => {
                self.stage = SECOND;
                return false;
            }
            _ => return false,
        }
        true
    }

    fn open(&mut self) {
        self.stage = OPEN;
        self.window.begin(self.handshake);
        (self.cursor, self.unanswered) = (0, 0);
        self.is.clear(Is::GoingBack);
        self.is.clear(Is::WentBack);
        self.is.clear(Is::Held);
        self.is.clear(Is::OffPlan);
        self.is.clear(Is::Suspect);
        self.since_absolute = 0;
        self.send.clear(Send::Probe);
        self.pending.set(Pending::Begun);
        count(&mut self.health.sessions);
    }

    /// The motion side has not had the first request, or keeps no order.
    fn order_missing(&mut self) {
        self.failed_handshakes = self.failed_handshakes.saturating_add(1);
        if self.settings.allows(self.failed_handshakes) {
            self.begin();
        } else {
            self.give_up();
        }
    }

    /// No session can be had.
    fn give_up(&mut self) {
        self.window.end(0, self.window.count, Outcome::TimedOut, 0);
        self.end_session(Outcome::TimedOut, 0);
    }
}

#[cfg(test)]
mod tests {
    use crate::gx::host::{Event, Host, Outcome, Settings};
    use crate::gx::motion::{Motion, tests::says};
    use crate::gx::{CommandReceiver, ENCODED_MAX, Vector, write_completed};

    /// How a move ends whose commands are answered like this, so many milliseconds late; and whether it was sent.
    fn end_of_a_move(
        latency: u32,
        asks_for_reports: bool,
        mut answer: impl FnMut(&[u8], u32) -> Vec<u8>,
    ) -> (Option<Outcome>, bool) {
        let mut host = Host::<4>::new(Settings::default());
        assert_eq!(host.move_to(&Vector { mask: 1, ..Vector::new() }), Ok(()));
        let mut answers: Vec<(u32, Vec<u8>)> = Vec::new();
        let end = (0..100_000).step_by(10).find_map(|now| {
            while answers.first().is_some_and(|(at, _)| *at <= now) {
                host.receive(&answers.remove(0).1, now);
                while let Some(event) = host.poll(now) {
                    if let Event::Ended(outcome, _) = event {
                        return Some(outcome);
                    }
                }
            }
            if asks_for_reports && now % 130 == 0 {
                host.report(100);
            }
            let mut frame = [0; ENCODED_MAX];
            let length = host.output(&mut frame, now);
            answers.push((now + latency, answer(&frame[..length], now)));
            None
        });
        (end, host.health().moves != 0)
    }

    /// Sends numbers back, and no more.
    fn echo(command: &[u8], _: u32) -> Vec<u8> {
        let (mut room, mut receiver) = ([0; ENCODED_MAX], CommandReceiver::new());
        receiver.receive(command);
        let length = receiver.number().map_or(0, |number| write_completed(number, &mut room).unwrap());
        [&room[..length], b"\n"].concat()
    }

    /// Requests are sent again before their answers have come, and so are answered several times.
    #[test]
    fn neither_late_answers_nor_reports_are_taken_for_order() {
        for latency in (0..2000).step_by(50) {
            for asks_for_reports in [false, true] {
                let end = end_of_a_move(latency, asks_for_reports, echo);
                assert_eq!(end, (Some(Outcome::TimedOut), false), "{latency} ms");
            }
        }
        assert_eq!(end_of_a_move(0, true, |_, _| b"=x1\n".to_vec()), (Some(Outcome::TimedOut), false));
    }

    #[test]
    fn order_is_found_however_late_the_answers_are() {
        for latency in (0..2000).step_by(50) {
            let mut motion = Motion::<4>::new();
            let end = end_of_a_move(latency, false, |command, now| {
                let mut said = says(&mut motion, command, now);
                if motion.next().is_some() {
                    motion.done();
                    said.extend(says(&mut motion, b"", now));
                }
                said
            });
            assert_eq!(end, (Some(Outcome::Finished), true), "{latency} ms");
        }
    }
}
