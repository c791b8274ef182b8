//! What received messages mean for the requests.

use super::request::{Outcome, Stage};
use super::{Notice, Session};
use crate::deltarobot::{Message, Opcode, Report, State};
use crate::session::{Flags, count, flags, left};

flags! {
    /// What is known of the operation.
    pub(super) enum Fact {
        /// Homing or moving was reported since it was accepted.
        Running,
        /// It was accepted by an ack, so what has come since belongs to it.
        Acked,
        /// A cancel request may have reached the controller.
        Cancelled,
        /// A general error was reported while its answer was waited for.
        ErrorReported,
        /// While its answer was waited for, the platform was reported elsewhere than at the target.
        SeenElsewhere,
        /// It is being carried out, or was: reports say so, if no answer does.
        SeenRunning,
    }
}

impl Session {
    /// Deals with a received message.
    pub(super) fn handle(&mut self, message: &Message, now: u32) {
        match message {
            Message::Ack(opcode) => self.answered(*opcode, true, now),
            Message::Nack(opcode) => self.answered(*opcode, false, now),
            Message::StatusReport(report) => self.reported(report, now),
            Message::HomingFinished => self.finished(Opcode::HOMING, now),
            Message::MoveFinished => self.finished(Opcode::MOVE, now),
            Message::GeneralError => self.error_reported(),
            // A host's: an echo of the line, or another host.
            Message::Homing | Message::Status | Message::Move(_) | Message::Cancel => (),
        }
    }

    fn answered(&mut self, opcode: Opcode, accepted: bool, now: u32) {
        let guard = self.settings.guard();
        match opcode {
            Opcode::CANCEL if self.cancel.stage() == Stage::Sent && self.cancel.previous_left(now, guard) == 0 => {
                self.cancel.answer(false, now, &mut self.health);
                self.cancel.end(if accepted { Outcome::Finished } else { Outcome::Refused });
                if accepted {
                    self.cancelled(now);
                }
            }
            Opcode::STATUS if self.status.stage() == Stage::Sent && !accepted => self.status.end(Outcome::Refused),
            // Nobody asks for it, the report says as much.
            Opcode::STATUS if accepted => (),
            _ if opcode.0 == self.opcode && self.operation.is_unanswered() => self.operation_answered(accepted, now),
            _ => count(&mut self.health.strays),
        }
    }

    fn operation_answered(&mut self, accepted: bool, now: u32) {
        if accepted {
            self.operation.answer(true, now, &mut self.health);
            self.accept(Fact::Acked, now);
        } else if self.operation.stage() == Stage::Sent {
            self.operation.answer(false, now, &mut self.health);
            if self.operation.transmission.sent == 1 {
                self.operation.end(Outcome::Refused);
            } else {
                self.operation.stage = Stage::NackAfterRetry as u8;
                self.ask_status(now);
            }
        }
    }

    /// The operation is accepted; apart from its cancelling, this is all that is known of it from now on.
    fn accept(&mut self, fact: Fact, now: u32) {
        self.operation.stage = Stage::Accepted as u8;
        let is_cancelled = self.facts.has(Fact::Cancelled);
        self.facts = Flags::default();
        self.facts.set_to(Fact::Cancelled, is_cancelled);
        self.facts.set(fact);
        self.accepted_at = now;
        self.polled_at = now;
        self.notices.set(Notice::Accepted);
    }

    /// Accepted although its ack was never received: reports have shown it.
    pub(super) fn accept_by_reports(&mut self, now: u32) {
        self.accept(Fact::Running, now);
        self.heard_at = now;
        self.ask_status(now);
    }

    pub(super) fn ask_status(&mut self, now: u32) {
        self.status.ask();
        self.polled_at = now;
    }

    /// The controller has the cancel request: what was asked for before it is over, or was never received.
    fn cancelled(&mut self, now: u32) {
        if self.operation.is_unanswered() || self.operation.stage() == Stage::Accepted {
            self.operation.overtake();
            self.facts.set(Fact::Cancelled);
            self.polled_at = now;
        }
    }

    fn finished(&mut self, opcode: Opcode, now: u32) {
        if opcode.0 == self.opcode
            && self.operation.stage() == Stage::Accepted
            && self.facts.has(Fact::Acked)
            && !self.facts.has(Fact::Cancelled)
            && !self.operation.is_retry_in_flight(now, self.settings.guard())
        {
            self.operation.end(Outcome::Finished);
        }
    }

    fn error_reported(&mut self) {
        self.notices.set(Notice::GeneralError);
        if self.operation.is_unanswered() {
            self.facts.set(Fact::ErrorReported);
        } else if self.operation.stage() == Stage::Accepted {
            self.operation.end(Outcome::Failed);
        }
    }

    fn reported(&mut self, report: &Report, now: u32) {
        if self.has_report == 0 || self.report.state() != report.state() {
            self.notices.set(Notice::State);
        }
        self.has_report = 1;
        self.report = *report;
        self.notices.set(Notice::Status);
        self.polled_at = now;
        if self.status.stage() == Stage::Sent {
            self.status.answer(false, now, &mut self.health);
            self.status.end(Outcome::Finished);
        }
        match self.operation.stage() {
            Stage::Sent => self.look_for_evidence(report, now),
            Stage::NackAfterRetry => self.resolve_nack(report, now),
            Stage::Accepted => self.look_for_end(report, now),
            Stage::Free | Stage::Queued | Stage::Ended => (),
        }
    }

    /// No answer has come yet. What was sent before the request arrived says nothing about it.
    fn look_for_evidence(&mut self, report: &Report, now: u32) {
        if left(now, self.started_at, self.settings.guard()) > 0 {
            return;
        }
        let is_at_target = self.is_at_target(report);
        let has_arrived = report.state() == State::Idle && is_at_target && self.facts.has(Fact::SeenElsewhere);
        if self.is_running(report) || has_arrived {
            self.facts.set(Fact::SeenRunning);
        }
        if !is_at_target && report.position.is_known() {
            self.facts.set(Fact::SeenElsewhere);
        }
    }

    /// A retransmission was refused, and this was sent after that.
    fn resolve_nack(&mut self, report: &Report, now: u32) {
        if self.operation.is_retry_in_flight(now, self.settings.guard()) {
            return;
        }
        if self.is_running(report) {
            self.accept(Fact::Running, now);
        } else {
            self.operation.end(Outcome::Refused);
        }
    }

    /// Whether the platform does what was requested.
    fn is_running(&self, report: &Report) -> bool {
        match report.state() {
            State::Homing => self.opcode == Opcode::HOMING.0,
            State::Moving => self.opcode == Opcode::MOVE.0,
            State::Idle | State::Error => false,
        }
    }

    fn look_for_end(&mut self, report: &Report, now: u32) {
        match report.state() {
            State::Homing | State::Moving => self.facts.set(Fact::Running),
            State::Error => self.operation.end(Outcome::Failed),
            // The answer to the cancel request says whether it was that which ended the operation.
            State::Idle if self.cancel.is_going_on() => (),
            State::Idle if self.operation.is_retry_in_flight(now, self.settings.guard()) => (),
            State::Idle if self.facts.has(Fact::Cancelled) => self.operation.end(Outcome::Cancelled),
            // It may not run yet.
            State::Idle
                if !self.facts.has(Fact::Running) && left(now, self.accepted_at, self.settings.settle()) > 0 => {}
            State::Idle => {
                let is_homing = self.opcode == Opcode::HOMING.0;
                let is_done = if is_homing { report.position.is_known() } else { self.is_at_target(report) };
                self.operation.end(match is_done {
                    true => Outcome::Finished,
                    false if self.facts.has(Fact::Acked) => Outcome::Failed,
                    // What was taken for it may have been another.
                    false => Outcome::TimedOut,
                });
            }
        }
    }

    /// Whether a move would end there.
    fn is_at_target(&self, report: &Report) -> bool {
        self.opcode == Opcode::MOVE.0 && report.position.is_near(self.target, self.settings.tolerance())
    }
}

#[cfg(test)]
mod tests {
    use crate::deltarobot::host::{Event, Host, Outcome, REQUEST_MAX, Settings};
    use crate::deltarobot::{Message, Opcode, Position, Report, receiver_room};

    const TARGET: Position = Position([0x3F80_0000, 0x4000_0000, 0xC060_0000]);
    const ELSEWHERE: Position = Position([0x4000_0000; 3]);
    const IDLE: u8 = 0;
    const MOVING: u8 = 2;

    type Session = Host<{ receiver_room(16) }>;

    /// What the session reports when that comes, other than reports.
    fn event(host: &mut Session, message: Message, now: u32) -> Option<Event> {
        host.session.handle(&message, now);
        core::iter::from_fn(|| host.session.next_event()).find(|event| !matches!(event, Event::Status | Event::State))
    }

    fn moving() -> Session {
        let mut host = Host::new(Settings::default());
        assert_eq!(host.move_to(TARGET), Ok(()));
        assert_eq!(host.poll(0, &mut [0; 0]), None);
        let mut frame = [0; REQUEST_MAX];
        assert_eq!((host.output(&mut frame, 16, 0), host.output(&mut frame, 17, 0)), (0, 17));
        assert_eq!(frame[..17], *b"$M\x0C\0\0\x80\x3F\0\0\0\x40\0\0\x60\xC0\xD6:");
        assert_eq!(host.output(&mut frame, 17, 0), 0);
        assert_eq!(event(&mut host, Message::Ack(Opcode::MOVE), 1), Some(Event::Accepted(Opcode::MOVE)));
        host
    }

    #[test]
    fn a_move_ends_once_and_by_where_the_platform_stands() {
        let ended = |outcome| Some(Event::Ended(Opcode::MOVE, outcome));
        for reports in [
            [(ELSEWHERE, MOVING, 2, None), (TARGET, IDLE, 3, ended(Outcome::Finished))],
            [(ELSEWHERE, MOVING, 2, None), (ELSEWHERE, IDLE, 3, ended(Outcome::Failed))],
            [(ELSEWHERE, MOVING, 2, None), (Position::UNKNOWN, IDLE, 3, ended(Outcome::Failed))],
            // Idle right behind the ACK ends nothing.
            [(TARGET, IDLE, 500, None), (TARGET, IDLE, 501, ended(Outcome::Finished))],
        ] {
            let mut host = moving();
            for (position, stat, now, end) in reports {
                let report = Message::StatusReport(Report::new(position, stat));
                assert_eq!(event(&mut host, report, now), end, "{reports:?}");
            }
            for message in [Message::MoveFinished, Message::StatusReport(Report::new(TARGET, IDLE))] {
                assert_eq!(event(&mut host, message, 600), None);
            }
        }
    }
}
