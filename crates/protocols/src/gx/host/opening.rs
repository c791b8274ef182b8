//! How a session begins: see [`host`](super).

use core::ffi::c_uchar;

use super::event::{Outcome, TELL_BEGUN};
use super::{Host, IS_BACK, IS_HELD, IS_REPEATED, IS_USED, IS_WARY, OPEN, SEND_OPENING, SEND_PROBE};
use crate::counter::count;
use crate::gx::NUMBER_MAX;
use crate::gx::motion::STRIDE;

// Stages of a host, besides those that it names itself.

/// The number of the first request is waited for.
const FIRST: c_uchar = 3;
/// That of the second is; the first may come again meanwhile, as it was sent several times.
const LATE: c_uchar = 4;
/// That of the first again, and behind it that of the second.
const SECOND: c_uchar = 5;
/// That of the first has come again, and no other since.
const ECHOED: c_uchar = 6;

impl Host {
    pub(super) const fn is_opening(&self) -> bool {
        matches!(self.stage, FIRST..=ECHOED)
    }

    /// Asks for a session, with a number that was not used lately.
    pub(super) fn begin(&mut self) {
        let number = match self.is & IS_USED {
            0 => self.settings.first_number(),
            _ => self.opening.wrapping_add(STRIDE),
        };
        self.is |= IS_USED;
        self.ask(FIRST, number);
    }

    fn ask(&mut self, stage: c_uchar, number: u16) {
        self.stage = stage;
        self.opening = number & NUMBER_MAX;
        self.unanswered = 0;
        self.is &= !IS_REPEATED;
        self.send |= SEND_OPENING;
    }

    /// There was no answer.
    pub(super) fn ask_again(&mut self) {
        if self.gives_up() {
            self.never_opens();
        } else {
            self.is |= IS_REPEATED;
            self.send |= SEND_OPENING;
        }
    }

    /// A number came back; `false` if it says nothing.
    pub(super) fn echoed(&mut self, number: u16) -> bool {
        let is_this = number == self.opening;
        match self.stage {
            FIRST if is_this => {
                let stage = if self.is & IS_REPEATED == 0 { SECOND } else { LATE };
                self.ask(stage, number.wrapping_add(STRIDE));
            }
            // Behind this no late answer to the first can come: what it is answered by when it is sent once more
            // counts.
            LATE if is_this => self.ask(SECOND, number),
            ECHOED if is_this => self.opens(),
            SECOND if is_this => self.doubts_order(),
            SECOND | ECHOED if number == self.opening.wrapping_sub(STRIDE) & NUMBER_MAX => self.stage = ECHOED,
            ECHOED => {
                self.stage = SECOND;
                return false;
            }
            _ => return false,
        }
        true
    }

    fn opens(&mut self) {
        self.stage = OPEN;
        self.window.begin(self.opening);
        (self.cursor, self.unanswered) = (0, 0);
        self.is &= !(IS_BACK | IS_HELD | IS_WARY);
        self.send &= !SEND_PROBE;
        self.tell |= TELL_BEGUN;
        count(&mut self.health.sessions);
    }

    /// The motion side has not had the first request, or keeps no order.
    fn doubts_order(&mut self) {
        self.doubts = self.doubts.saturating_add(1);
        if self.settings.allows(self.doubts) {
            self.begin();
        } else {
            self.never_opens();
        }
    }

    /// No session can be had.
    fn never_opens(&mut self) {
        self.window.end(0, self.window.len(), Outcome::TimedOut, 0);
        self.end_session(Outcome::TimedOut, 0);
    }
}

#[cfg(test)]
mod tests {
    use crate::gx::host::{Event, Host, Outcome, Settings};
    use crate::gx::motion::{self, Motion};
    use crate::gx::{CommandReceiver, ENCODED_MAX, Item, Vector, write_completed};
    use std::vec::Vec;

    /// How a move ends whose commands are answered like this, so many milliseconds late; and whether it was sent.
    fn end_of_a_move(
        latency: u32,
        asks_for_reports: bool,
        mut answer: impl FnMut(&[u8], u32) -> Vec<u8>,
    ) -> (Option<Outcome>, bool) {
        let mut host = Host::new(Settings::new());
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
            let length = host.output(&mut frame, ENCODED_MAX, now);
            answers.push((now + latency, answer(&frame[..length], now)));
            None
        });
        (end, host.health().moves != 0)
    }

    /// Sends numbers back, and no more.
    fn echo(command: &[u8], _: u32) -> Vec<u8> {
        let (mut room, mut item) = ([0; ENCODED_MAX], Item::new());
        CommandReceiver::new().receive(command, &mut item);
        let length = item.number().map_or(0, |number| write_completed(number, &mut room).unwrap());
        [&room[..length], b"\n"].concat()
    }

    /// Requests are sent again before their answers have come, and so are answered several times.
    #[test]
    fn late_answers_are_not_taken_for_order() {
        for latency in (0..2000).step_by(50) {
            for asks_for_reports in [false, true] {
                let end = end_of_a_move(latency, asks_for_reports, echo);
                assert_eq!(end, (Some(Outcome::TimedOut), false), "{latency} ms");
            }
        }
    }

    #[test]
    fn order_is_found_however_late_the_answers_are() {
        for latency in (0..2000).step_by(50) {
            let mut motion = Motion::new(motion::Settings::new());
            let end = end_of_a_move(latency, false, |command, now| {
                motion.receive(command, now);
                while motion.poll(now).is_some() {}
                if motion.next().is_some() {
                    motion.done();
                }
                let (mut frame, mut said) = ([0; ENCODED_MAX], Vec::new());
                loop {
                    match motion.output(&mut frame, ENCODED_MAX, now) {
                        0 => return said,
                        length => said.extend(&frame[..length]),
                    }
                }
            });
            assert_eq!(end, (Some(Outcome::Finished), true), "{latency} ms");
        }
    }

    #[test]
    fn reports_are_no_answers() {
        let end = end_of_a_move(0, true, |_, _| b"=x1\n".to_vec());
        assert_eq!(end, (Some(Outcome::TimedOut), false));
    }
}
