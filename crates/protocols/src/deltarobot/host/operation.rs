//! What received messages mean for the requests.

use core::ffi::c_int;

use super::event::{TELL_ACCEPTED, TELL_ERROR, TELL_STATE, TELL_STATUS};
use super::request::{ACCEPTED, DOUBTED, SENT};
use super::{Host, Outcome, SEND_STATUS};
use crate::clock::{left, stamp};
use crate::counter::count;
use crate::deltarobot::{Message, Opcode, Position, Report, State};

/// Homing or moving was reported since the operation was accepted.
const RUNNING: c_int = 1;
/// It was accepted by an ack, so what has come since belongs to it.
const ACKED: c_int = 1 << 1;
/// A cancel request may have reached the controller.
pub(super) const CANCELLED: c_int = 1 << 2;
/// A general error was reported while its answer was waited for.
pub(super) const ERRED: c_int = 1 << 3;
/// While its answer was waited for, the platform was reported elsewhere than at the target.
const ELSEWHERE: c_int = 1 << 4;
/// It is being carried out, or was: reports say so, if no answer does.
pub(super) const EVIDENT: c_int = 1 << 5;

impl Host {
    pub(super) fn understand(&mut self, message: &Message, now: u32) {
        match message {
            Message::Ack(opcode) => self.answered(*opcode, true, now),
            Message::Nack(opcode) => self.answered(*opcode, false, now),
            Message::StatusReport(report) => self.reported(report, now),
            Message::HomingFinished => self.finished(Opcode::HOMING, now),
            Message::MoveFinished => self.finished(Opcode::MOVE, now),
            Message::GeneralError => self.erred(),
            // A host's: an echo of the line, or another host.
            Message::Homing | Message::Status | Message::Move(_) | Message::Cancel => (),
        }
    }

    fn answered(&mut self, opcode: Opcode, accepted: bool, now: u32) {
        match opcode {
            Opcode::CANCEL
                if self.cancel.stage() == SENT && self.cancel.loose_left(now, self.settings.guard()) == 0 =>
            {
                self.cancel.answer(SENT, now, &mut self.health);
                if accepted {
                    self.end_cancel(Outcome::Finished);
                    self.cancelled(now);
                } else {
                    self.end_cancel(Outcome::Refused);
                }
            }
            Opcode::STATUS if self.status.stage() == SENT && !accepted => self.end_status(Outcome::Refused),
            // Nobody asks for it, the report says as much.
            Opcode::STATUS if accepted => (),
            _ if opcode.0 == self.opcode && matches!(self.operation.stage(), SENT | DOUBTED) => {
                self.operation_answered(accepted, now);
            }
            _ => count(&mut self.health.strays),
        }
    }

    fn operation_answered(&mut self, accepted: bool, now: u32) {
        if accepted {
            self.operation.answer(ACCEPTED, now, &mut self.health);
            self.accept(ACKED, now);
        } else if self.operation.stage() == SENT {
            self.operation.answer(DOUBTED, now, &mut self.health);
            if self.operation.sent() == 1 {
                self.end_operation(Outcome::Refused);
            } else {
                self.ask_for_the_state(now);
            }
        }
    }

    /// The operation is accepted; `known` is what is known of it from now on besides its cancelling.
    pub(super) fn accept(&mut self, known: c_int, now: u32) {
        self.operation.set_stage(ACCEPTED);
        self.known = self.known & CANCELLED | known;
        self.accepted_at = stamp(now);
        self.polled_at = stamp(now);
        self.tell |= TELL_ACCEPTED;
    }

    /// Accepted although its ack was never received: what is reported tells as much.
    pub(super) fn accept_by_evidence(&mut self, now: u32) {
        self.accept(RUNNING, now);
        self.heard_at = stamp(now);
        self.ask_for_the_state(now);
    }

    pub(super) fn ask_for_the_state(&mut self, now: u32) {
        self.send |= SEND_STATUS;
        self.polled_at = stamp(now);
    }

    /// The controller has the cancel request: what was asked for before it is over, or was never received.
    fn cancelled(&mut self, now: u32) {
        if matches!(self.operation.stage(), SENT | DOUBTED | ACCEPTED) {
            self.operation.overtake();
            self.known |= CANCELLED;
            self.polled_at = stamp(now);
        }
    }

    fn finished(&mut self, opcode: Opcode, now: u32) {
        if opcode.0 == self.opcode
            && self.operation.stage() == ACCEPTED
            && self.known & (ACKED | CANCELLED) == ACKED
            && !self.operation.in_flight(now, self.settings.guard())
        {
            self.end_operation(Outcome::Finished);
        }
    }

    fn erred(&mut self) {
        self.tell |= TELL_ERROR;
        match self.operation.stage() {
            SENT | DOUBTED => self.known |= ERRED,
            ACCEPTED => self.end_operation(Outcome::Failed),
            _ => (),
        }
    }

    fn reported(&mut self, report: &Report, now: u32) {
        let known_before = self.last_report();
        self.reported = 1;
        self.stat = report.stat();
        self.position = report.position.to_wire();
        self.tell |= TELL_STATUS;
        if known_before.map(|before| before.state()) != Some(report.state()) {
            self.tell |= TELL_STATE;
        }
        self.polled_at = stamp(now);
        if self.status.stage() == SENT {
            self.status.answer(SENT, now, &mut self.health);
            self.end_status(Outcome::Finished);
        }
        match self.operation.stage() {
            SENT => self.look_for_evidence(report, now),
            DOUBTED => self.resolve_doubt(report, now),
            ACCEPTED => self.look_for_the_end(report, now),
            _ => (),
        }
    }

    /// No answer has come yet. What was sent before the request arrived says nothing about it.
    fn look_for_evidence(&mut self, report: &Report, now: u32) {
        if left(now, self.started_at, self.settings.guard()) > 0 {
            return;
        }
        let at_target = self.is_at_target(report);
        if self.shows(report) || report.state() == State::Idle && at_target && self.known & ELSEWHERE != 0 {
            self.known |= EVIDENT;
        }
        if !at_target && report.position.is_known() {
            self.known |= ELSEWHERE;
        }
    }

    /// A repeat was refused, and this was sent after that.
    fn resolve_doubt(&mut self, report: &Report, now: u32) {
        if self.operation.in_flight(now, self.settings.guard()) {
            return;
        }
        if self.shows(report) {
            self.accept(RUNNING, now);
        } else {
            self.end_operation(Outcome::Refused);
        }
    }

    /// Whether the platform does what was requested.
    fn shows(&self, report: &Report) -> bool {
        match report.state() {
            State::Homing => self.opcode == Opcode::HOMING.0,
            State::Moving => self.opcode == Opcode::MOVE.0,
            State::Idle | State::Error => false,
        }
    }

    fn look_for_the_end(&mut self, report: &Report, now: u32) {
        match report.state() {
            State::Homing | State::Moving => self.known |= RUNNING,
            State::Error => self.end_operation(Outcome::Failed),
            // The answer to the cancel request tells whether it was that which ended the operation.
            State::Idle if !self.cancel.is_free() => (),
            State::Idle if self.operation.in_flight(now, self.settings.guard()) => (),
            State::Idle if self.known & CANCELLED != 0 => self.end_operation(Outcome::Cancelled),
            // It may not run yet.
            State::Idle if self.known & RUNNING == 0 && left(now, self.accepted_at, self.settings.settle()) > 0 => {}
            State::Idle => {
                let done = if self.opcode == Opcode::HOMING.0 {
                    report.position.is_known()
                } else {
                    self.is_at_target(report)
                };
                self.end_operation(match done {
                    true => Outcome::Finished,
                    false if self.known & ACKED != 0 => Outcome::Failed,
                    // What was taken for it may have been another.
                    false => Outcome::TimedOut,
                });
            }
        }
    }

    /// Whether a move would end there.
    fn is_at_target(&self, report: &Report) -> bool {
        self.opcode == Opcode::MOVE.0
            && report.position.is_near(Position::from_wire(&self.target), self.settings.tolerance())
    }
}

#[cfg(test)]
mod tests {
    use crate::deltarobot::host::{Event, Host, Outcome, REQUEST_MAX, Settings};
    use crate::deltarobot::{Layout, Message, Opcode, PAYLOAD_MAX, Position, Report};

    const TARGET: Position = Position([0x3F80_0000, 0x4000_0000, 0xC060_0000]);
    const ELSEWHERE: Position = Position([0x4000_0000; 3]);
    const MOVING: u8 = 2;

    /// What the session tells when that comes, other than reports.
    fn tells(host: &mut Host, message: Message, now: u32) -> Option<Event> {
        let mut payload = [0; PAYLOAD_MAX];
        let length = message.write(Layout::Auto, &mut payload);
        host.understand(&Message::read(message.opcode(), payload.get(..length)?, Layout::Auto)?, now);
        core::iter::from_fn(|| host.event()).find(|event| !matches!(event, Event::Status(_) | Event::State(_)))
    }

    fn moving() -> Host {
        let mut host = Host::new(Settings::new());
        assert_eq!(host.move_to(TARGET), Ok(()));
        assert_eq!(host.poll(0, &mut [0; 0]), None);
        let mut frame = [0; REQUEST_MAX];
        assert_eq!((host.output(&mut frame, 16, 0), host.output(&mut frame, 17, 0)), (0, 17));
        assert_eq!(frame[..17], *b"$M\x0C\0\0\x80\x3F\0\0\0\x40\0\0\x60\xC0\xD6:");
        assert_eq!(host.output(&mut frame, 17, 0), 0);
        assert_eq!(tells(&mut host, Message::Ack(Opcode::MOVE), 1), Some(Event::Accepted(Opcode::MOVE)));
        host
    }

    fn report(position: Position, stat: u8) -> Message {
        Message::StatusReport(Report::new(position, stat))
    }

    const fn ended(outcome: Outcome) -> Event {
        Event::Ended(Opcode::MOVE, outcome)
    }

    #[test]
    fn an_operation_ends_once() {
        let mut host = moving();
        assert_eq!(tells(&mut host, report(ELSEWHERE, MOVING), 2), None);
        assert_eq!(tells(&mut host, report(TARGET, 0), 3), Some(ended(Outcome::Finished)));
        assert_eq!(tells(&mut host, Message::MoveFinished, 4), None);
        assert_eq!(tells(&mut host, report(TARGET, 0), 5), None);
    }

    #[test]
    fn idle_right_behind_the_ack_ends_nothing() {
        let mut host = moving();
        assert_eq!(tells(&mut host, report(TARGET, 0), 500), None);
        assert_eq!(tells(&mut host, report(TARGET, 0), 501), Some(ended(Outcome::Finished)));
    }

    #[test]
    fn standing_elsewhere_is_a_failure() {
        for position in [ELSEWHERE, Position::UNKNOWN] {
            let mut host = moving();
            assert_eq!(tells(&mut host, report(ELSEWHERE, MOVING), 2), None);
            assert_eq!(tells(&mut host, report(position, 0), 3), Some(ended(Outcome::Failed)));
        }
    }
}
