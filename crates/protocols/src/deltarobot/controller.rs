//! The controller's end of the link: what to do about a request, and what to answer.
//!
//! A [`Controller`] calls nothing and sends nothing. Firmware goes through a request in steps:
//! [`request`](Controller::request) fetches it, [`decide`](Controller::decide) says what to do about it in the
//! platform's present state, and if that asks for it, the motors are started and [`started`](Controller::started) is
//! called. In between nothing is borrowed, so the firmware's functions may use the controller themselves.
//!
//! The answers are those of the shipped firmware, which checks in this order:
//!
//! | request | answer |
//! |---|---|
//! | `H` | `A`, or `N` in error state; then `s` |
//! | `M` | `N` alone when the position is unknown; else `A`, or `N` in error state and when the target is not 12 bytes or has a NaN; then `s` |
//! | `C` | `A`, or `N` in error state; then `s` |
//! | `S` | `s` |
//!
//! Beyond these, an `H` or `C` with a payload is refused, and so is what the firmware's own function refuses. A request
//! for what is being done already, retransmitted because its ack was lost, is accepted without starting again.
//!
//! At the end of an operation there is an `s`, and before it, where asked for, the specification's `h`, `m` or `e`.
//!
//! ```
//! use deltarobot_protocols::deltarobot::controller::{Controller, Decision};
//! use deltarobot_protocols::deltarobot::{Opcode, Position, Report, receiver_room};
//!
//! let mut controller = Controller::<{ receiver_room(32) }>::default();
//! assert_eq!(controller.receive(b"$H\0\xA6:"), 5);
//! let request = controller.request(false).unwrap();
//! let decision = controller.decide(&request, &Report::new(Position::UNKNOWN, 0));
//! assert_eq!(decision, Decision::Home);
//! // The arms start; `A` and `s` are sent; some time later they stand.
//! controller.started(&decision);
//! assert_eq!(controller.ended(&Report::new(Position([0; 3]), 0)), Some(Some(Opcode::HOMING_REPL)));
//! ```

use zerocopy::{FromBytes, Immutable, KnownLayout};

use super::{Opcode, POSITION_SIZE, Position, Receiver, Report, State};

/// A controller with a [`Receiver`] of `ROOM` bytes. All zero is one that does nothing and answers like shipped
/// firmware.
#[derive(Clone, Debug, Default, FromBytes, Immutable, KnownLayout)]
pub struct Controller<const ROOM: usize> {
    /// The target of a move going on.
    target: Position,
    receiver: Receiver<ROOM>,
    /// Opcode of the operation going on; a cancel request's until the platform stands; 0 when there is none.
    operation: u8,
    /// Not 0: refuses an operation while another is going on.
    refuses_busy: u8,
}

/// A request as it came, valid or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// What is requested.
    pub opcode: Opcode,
    /// Whether the length is right for the opcode.
    is_whole: bool,
    /// Of a move.
    target: Position,
}

/// What to do about a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// Start homing, and accept if that works.
    Home,
    /// Start moving there, and accept if that works.
    Move(Position),
    /// Stop, and accept if that works.
    Cancel,
    /// Accept it, it is being done already.
    Accept,
    /// Only report the status.
    Report,
    /// Refuse it.
    Refuse,
    /// Refuse it, and don't report the status.
    RefuseOnly,
}

impl<const ROOM: usize> Controller<ROOM> {
    /// Whether an operation is refused while another is going on. Otherwise, as at first, it takes that one's place.
    pub const fn refuse_busy(&mut self, refuses: bool) {
        self.refuses_busy = refuses as u8;
    }

    /// Takes received bytes, as many as there is room for, and returns how many. The others fit when
    /// [`request`](Self::request) has no more.
    pub fn receive(&mut self, input: &[u8]) -> usize {
        self.receiver.take(input)
    }

    /// Fetches the next request. Other messages are passed over, and, when the line is `idle`, incomplete ones too.
    pub fn request(&mut self, idle: bool) -> Option<Request> {
        loop {
            let frame = if idle { self.receiver.next_idle(&mut ()) } else { self.receiver.next() }.ok()?;
            let length = match frame.opcode {
                Opcode::MOVE => POSITION_SIZE,
                Opcode::HOMING | Opcode::CANCEL | Opcode::STATUS => 0,
                _ => continue,
            };
            return Some(Request {
                opcode: frame.opcode,
                is_whole: frame.payload.len() == length,
                target: Position::read(frame.payload).unwrap_or(Position::UNKNOWN),
            });
        }
    }

    /// What to do about a request while the platform's state is that.
    pub fn decide(&self, request: &Request, now: &Report) -> Decision {
        let state = now.state();
        match request.opcode {
            Opcode::STATUS => return Decision::Report,
            Opcode::MOVE if !now.position.is_known() => return Decision::RefuseOnly,
            _ if state == State::Error || !request.is_whole => return Decision::Refuse,
            Opcode::CANCEL => return Decision::Cancel,
            Opcode::MOVE if !request.target.is_known() => return Decision::Refuse,
            _ => (),
        }
        let is_running = matches!(state, State::Homing | State::Moving);
        let is_same = is_running && self.operation == request.opcode.0;
        let is_move = request.opcode == Opcode::MOVE;
        if is_same && (!is_move || request.target.is_same(self.target)) {
            Decision::Accept
        } else if is_running && self.refuses_busy != 0 {
            Decision::Refuse
        } else if is_move {
            Decision::Move(request.target)
        } else {
            Decision::Home
        }
    }

    /// The platform has begun to do what was decided.
    pub fn started(&mut self, decision: &Decision) {
        match decision {
            Decision::Home => self.operation = Opcode::HOMING.0,
            Decision::Move(target) => {
                self.operation = Opcode::MOVE.0;
                self.target = *target;
            }
            // Nothing is finished by standing still, but where something was going on, standing still is reported.
            Decision::Cancel if self.operation != 0 => self.operation = Opcode::CANCEL.0,
            _ => (),
        }
    }

    /// Whether the state is to be looked at: an operation is going on.
    pub const fn is_active(&self) -> bool {
        self.operation != 0
    }

    /// The status is reported in an answer: there is no need to report again that the platform stands.
    pub fn reported(&mut self, now: &Report) {
        if self.operation == Opcode::CANCEL.0 && !matches!(now.state(), State::Homing | State::Moving) {
            self.operation = 0;
        }
    }

    /// Whether the operation going on is over, and if so, the opcode of the specification's message about that.
    pub fn ended(&mut self, now: &Report) -> Option<Option<Opcode>> {
        let end = match (now.state(), Opcode(self.operation)) {
            (_, Opcode(0)) | (State::Homing | State::Moving, _) => return None,
            (State::Error, _) => Some(Opcode::GENERAL_ERR),
            (State::Idle, Opcode::HOMING) => Some(Opcode::HOMING_REPL),
            (State::Idle, Opcode::MOVE) => Some(Opcode::MOVE_REPL),
            (State::Idle, _) => None,
        };
        self.operation = 0;
        Some(end)
    }
}

#[cfg(test)]
mod tests {
    use super::{Decision, Opcode, Position, Report};
    use crate::deltarobot::receiver_room;

    type Controller = super::Controller<{ receiver_room(12) }>;

    const HOME: Position = Position([0; 3]);
    const TARGET: Position = Position([0x3F80_0000, 0x4000_0000, 0xC060_0000]);
    const MOVE: &[u8] = b"$M\x0C\0\0\x80\x3F\0\0\0\x40\0\0\x60\xC0\xD6:";

    fn decision(controller: &mut Controller, frame: &[u8], position: Position, state: u8) -> Decision {
        assert_eq!(controller.receive(frame), frame.len());
        let request = controller.request(false).unwrap();
        controller.decide(&request, &Report::new(position, state))
    }

    #[test]
    fn decides_like_shipped_firmware() {
        let mut it = Controller::default();
        for (frame, position, state, expected) in [
            (&b"$H\0\xA6:"[..], Position::UNKNOWN, 0, Decision::Home),
            (b"$H\0\xA6:", HOME, 2, Decision::Home),
            (b"$H\0\xA6:", HOME, 3, Decision::Refuse),
            (b"$H\x01\0\xA7:", HOME, 0, Decision::Refuse),
            (b"$C\0\xA1:", Position::UNKNOWN, 1, Decision::Cancel),
            (b"$C\0\xA1:", HOME, 3, Decision::Refuse),
            (b"$S\0\xB1:", HOME, 3, Decision::Report),
            (MOVE, HOME, 0, Decision::Move(TARGET)),
            (MOVE, HOME, 1, Decision::Move(TARGET)),
            (MOVE, HOME, 3, Decision::Refuse),
            (MOVE, Position::UNKNOWN, 0, Decision::RefuseOnly),
            (MOVE, Position::UNKNOWN, 3, Decision::RefuseOnly),
            (b"$M\x01\0\xAC:", HOME, 0, Decision::Refuse),
            (b"$M\x0C\x01\0\x80\x7F\0\0\0\x40\0\0\x60\xC0\x17:", HOME, 0, Decision::Refuse),
        ] {
            assert_eq!(decision(&mut it, frame, position, state), expected, "{frame:?} in state {state}");
        }
    }

    #[test]
    fn what_is_being_done_is_not_started_again() {
        let mut it = Controller::default();
        it.refuse_busy(true);
        it.started(&Decision::Move(TARGET));
        assert_eq!(decision(&mut it, MOVE, HOME, 2), Decision::Accept);
        assert_eq!(decision(&mut it, b"$H\0\xA6:", HOME, 2), Decision::Refuse);
        it.started(&Decision::Move(HOME));
        assert_eq!(decision(&mut it, MOVE, HOME, 2), Decision::Refuse);
        it.started(&Decision::Home);
        assert_eq!(decision(&mut it, b"$H\0\xA6:", HOME, 1), Decision::Accept);
        assert_eq!(decision(&mut it, MOVE, HOME, 1), Decision::Refuse);
        assert_eq!(decision(&mut it, b"$C\0\xA1:", HOME, 1), Decision::Cancel);
    }

    #[test]
    fn an_operation_ends_once() {
        let mut it = Controller::default();
        let report = |state| Report::new(HOME, state);
        for (decision, state, end) in [
            (Decision::Home, 0, Some(Some(Opcode::HOMING_REPL))),
            (Decision::Move(TARGET), 0, Some(Some(Opcode::MOVE_REPL))),
            (Decision::Home, 3, Some(Some(Opcode::GENERAL_ERR))),
        ] {
            assert!(!it.is_active());
            it.started(&decision);
            assert!(it.is_active());
            assert_eq!(it.ended(&report(1)), None);
            assert_eq!(it.ended(&report(state)), end);
            assert_eq!(it.ended(&report(state)), None);
        }
        it.started(&Decision::Cancel);
        assert!(!it.is_active());
        for (reported, end) in [(1, Some(None)), (0, None)] {
            it.started(&Decision::Home);
            it.started(&Decision::Cancel);
            it.reported(&report(reported));
            assert_eq!(it.ended(&report(0)), end);
        }
    }

    #[test]
    fn other_messages_are_passed_over() {
        let mut it = Controller::default();
        it.receive(b"$A\x01H\xE8:$h\0\xC6:$S\0\xB1:$M");
        assert_eq!(it.request(false).unwrap().opcode, Opcode::STATUS);
        assert_eq!(it.request(false), None);
        it.receive(b"\x0C$C\0\xA1:");
        assert_eq!(it.request(false), None);
        assert_eq!(it.request(true).unwrap().opcode, Opcode::CANCEL);
    }
}
