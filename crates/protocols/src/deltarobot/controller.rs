//! The controller's end of the link: what to do about a request, and what to answer.
//!
//! A [`Dispatcher`] calls nothing and sends nothing. Firmware (through [`crate::ffi::controller`]) goes through a
//! request in steps: [`order`](Dispatcher::order) takes it out of the ring, [`judge`](Dispatcher::judge) looks at it in
//! the light of the platform's state, and if that asks for it, the motors are started and [`began`](Dispatcher::began)
//! is told. In between nothing is borrowed, so the firmware's functions may use the controller themselves.
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
//! Beyond these, an `H` or `C` with a payload is refused, and so is what the firmware's own function refuses. A
//! request for what is being done already, sent again because its ack was lost, is accepted without starting anew.
//!
//! At the end of an operation there is an `s`, and before it, where asked for, the specification's `h`, `m` or `e`.
//!
//! ```
//! use deltarobot_protocols::deltarobot::controller::{Dispatcher, Judgement};
//! use deltarobot_protocols::deltarobot::{Message, Position, Report};
//!
//! let mut controller = Dispatcher::new();
//! controller.ring().append(b"$H\0\xA6:").unwrap();
//! let order = controller.order(false).unwrap();
//! let judgement = controller.judge(&order, &Report::new(Position::UNKNOWN, 0));
//! assert_eq!(judgement, Judgement::Home);
//! // The arms start; `A` and `s` are sent; some time later they stand.
//! controller.began(&judgement);
//! assert_eq!(controller.ended(&Report::new(Position([0; 3]), 0)), Some(Some(Message::HomingFinished)));
//! ```

use core::ffi::{c_int, c_uchar};

use super::{Layout, Message, NoFrame, Opcode, POSITION_SIZE, Position, Report, Ring, State};

/// A controller. Its fields are private; all zero is one that does nothing and answers like shipped firmware.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Dispatcher {
    ring: Ring,
    /// Not 0: refuses an operation while another is going on.
    refuses_busy: c_int,
    /// Opcode of the operation going on; a cancel request's until the platform stands; 0 when there is none.
    operation: c_uchar,
    /// The target of a move going on.
    target: [c_uchar; 12],
}

/// A request as it came, valid or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    /// What is requested.
    pub opcode: Opcode,
    /// `None` when the length is wrong for the opcode.
    message: Option<Message>,
}

/// What to do about a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judgement {
    /// Start homing, and accept if that works.
    Home,
    /// Start moving there, and accept if that works.
    Move(Position),
    /// Stop, and accept if that works.
    Cancel,
    /// Accept it, it is being done already.
    Repeated,
    /// Only report the status.
    Report,
    /// Refuse it.
    Refuse,
    /// Refuse it, and don't report the status.
    RefuseOnly,
}

impl Dispatcher {
    /// A controller with nothing to do.
    #[must_use]
    pub const fn new() -> Self {
        Self { ring: Ring::new(), refuses_busy: 0, operation: 0, target: [0; POSITION_SIZE] }
    }

    /// Whether an operation is refused while another is going on. Otherwise, as at first, it takes that one's place.
    pub const fn refuse_busy(&mut self, refuses: bool) {
        self.refuses_busy = refuses as c_int;
    }

    /// The ring that received bytes go into.
    pub const fn ring(&mut self) -> &mut Ring {
        &mut self.ring
    }

    /// Takes the next request out of the ring; `None` when there is none. Other messages are passed over, and, when the
    /// line is `idle`, incomplete ones too.
    pub fn order(&mut self, idle: bool) -> Option<Order> {
        loop {
            let frame = if idle { self.ring.next_frame_idle() } else { self.ring.next_frame() };
            let frame = match frame {
                Ok(frame) => frame,
                Err(NoFrame::Waiting | NoFrame::Garbage) => return None,
            };
            if matches!(frame.opcode, Opcode::HOMING | Opcode::MOVE | Opcode::CANCEL | Opcode::STATUS) {
                let message = Message::of_frame(&frame, Layout::Auto);
                return Some(Order { opcode: frame.opcode, message });
            }
        }
    }

    /// What to do about a request while the platform's state is that.
    #[must_use]
    pub fn judge(&self, order: &Order, now: &Report) -> Judgement {
        let state = now.state();
        match order.opcode {
            Opcode::STATUS => return Judgement::Report,
            Opcode::MOVE if !now.position.is_known() => return Judgement::RefuseOnly,
            _ if state == State::Error => return Judgement::Refuse,
            _ => (),
        }
        let runs = matches!(state, State::Homing | State::Moving);
        let same = runs && self.operation == order.opcode.0;
        match order.message {
            Some(Message::Cancel) => Judgement::Cancel,
            Some(Message::Move(target)) if !target.is_known() => Judgement::Refuse,
            Some(Message::Move(target)) if same && target.is_same(Position::from_wire(&self.target)) => {
                Judgement::Repeated
            }
            Some(Message::Homing) if same => Judgement::Repeated,
            Some(_) if runs && self.refuses_busy != 0 => Judgement::Refuse,
            Some(Message::Homing) => Judgement::Home,
            Some(Message::Move(target)) => Judgement::Move(target),
            _ => Judgement::Refuse,
        }
    }

    /// The platform began to do what was judged.
    pub fn began(&mut self, judgement: &Judgement) {
        match judgement {
            Judgement::Home => self.operation = Opcode::HOMING.0,
            Judgement::Move(target) => {
                self.operation = Opcode::MOVE.0;
                self.target = target.to_wire();
            }
            // Nothing is finished by standing still, but where something was going on, standing still is reported.
            Judgement::Cancel if self.operation != 0 => self.operation = Opcode::CANCEL.0,
            _ => (),
        }
    }

    /// Whether the state is to be looked at: an operation is going on.
    #[must_use]
    pub const fn is_active(&self) -> bool {
        self.operation != 0
    }

    /// The status is about to be reported in an answer: there is no need to report again that the platform stands.
    pub fn reports(&mut self, now: &Report) {
        if self.operation == Opcode::CANCEL.0 && !matches!(now.state(), State::Homing | State::Moving) {
            self.operation = 0;
        }
    }

    /// Whether the operation going on is over, and if so, what the specification has to say about that.
    pub fn ended(&mut self, now: &Report) -> Option<Option<Message>> {
        let end = match (now.state(), Opcode(self.operation)) {
            (_, Opcode(0)) | (State::Homing | State::Moving, _) => return None,
            (State::Error, _) => Some(Message::GeneralError),
            (State::Idle, Opcode::HOMING) => Some(Message::HomingFinished),
            (State::Idle, Opcode::MOVE) => Some(Message::MoveFinished),
            (State::Idle, _) => None,
        };
        self.operation = 0;
        Some(end)
    }
}

impl Default for Dispatcher {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::{Dispatcher, Judgement, Message, Opcode, Position, Report};

    const HOME: Position = Position([0; 3]);
    const TARGET: Position = Position([0x3F80_0000, 0x4000_0000, 0xC060_0000]);
    const MOVE: &[u8] = b"$M\x0C\0\0\x80\x3F\0\0\0\x40\0\0\x60\xC0\xD6:";

    fn judged(controller: &mut Dispatcher, frame: &[u8], position: Position, state: u8) -> Judgement {
        controller.ring().append(frame).unwrap();
        let order = controller.order(false).unwrap();
        controller.judge(&order, &Report::new(position, state))
    }

    #[test]
    fn judges_like_shipped_firmware() {
        let mut it = Dispatcher::new();
        for (frame, position, state, expected) in [
            (&b"$H\0\xA6:"[..], Position::UNKNOWN, 0, Judgement::Home),
            (b"$H\0\xA6:", HOME, 2, Judgement::Home),
            (b"$H\0\xA6:", HOME, 3, Judgement::Refuse),
            (b"$H\x01\0\xA7:", HOME, 0, Judgement::Refuse),
            (b"$C\0\xA1:", Position::UNKNOWN, 1, Judgement::Cancel),
            (b"$C\0\xA1:", HOME, 3, Judgement::Refuse),
            (b"$S\0\xB1:", HOME, 3, Judgement::Report),
            (MOVE, HOME, 0, Judgement::Move(TARGET)),
            (MOVE, HOME, 1, Judgement::Move(TARGET)),
            (MOVE, HOME, 3, Judgement::Refuse),
            (MOVE, Position::UNKNOWN, 0, Judgement::RefuseOnly),
            (MOVE, Position::UNKNOWN, 3, Judgement::RefuseOnly),
            (b"$M\x01\0\xAC:", HOME, 0, Judgement::Refuse),
            (b"$M\x0C\x01\0\x80\x7F\0\0\0\x40\0\0\x60\xC0\x17:", HOME, 0, Judgement::Refuse),
        ] {
            assert_eq!(judged(&mut it, frame, position, state), expected, "{frame:?} in state {state}");
        }
    }

    #[test]
    fn what_is_being_done_is_not_started_again() {
        let mut it = Dispatcher::new();
        it.refuse_busy(true);
        it.began(&Judgement::Move(TARGET));
        assert_eq!(judged(&mut it, MOVE, HOME, 2), Judgement::Repeated);
        assert_eq!(judged(&mut it, b"$H\0\xA6:", HOME, 2), Judgement::Refuse);
        it.began(&Judgement::Move(HOME));
        assert_eq!(judged(&mut it, MOVE, HOME, 2), Judgement::Refuse);
        it.began(&Judgement::Home);
        assert_eq!(judged(&mut it, b"$H\0\xA6:", HOME, 1), Judgement::Repeated);
        assert_eq!(judged(&mut it, MOVE, HOME, 1), Judgement::Refuse);
        assert_eq!(judged(&mut it, b"$C\0\xA1:", HOME, 1), Judgement::Cancel);
    }

    #[test]
    fn an_operation_ends_once() {
        let mut it = Dispatcher::new();
        let report = |state| Report::new(HOME, state);
        for (judgement, state, end) in [
            (Judgement::Home, 0, Some(Some(Message::HomingFinished))),
            (Judgement::Move(TARGET), 0, Some(Some(Message::MoveFinished))),
            (Judgement::Home, 3, Some(Some(Message::GeneralError))),
        ] {
            assert!(!it.is_active());
            it.began(&judgement);
            assert!(it.is_active());
            assert_eq!(it.ended(&report(1)), None);
            assert_eq!(it.ended(&report(state)), end);
            assert_eq!(it.ended(&report(state)), None);
        }
        it.began(&Judgement::Cancel);
        assert!(!it.is_active());
        it.began(&Judgement::Home);
        it.began(&Judgement::Cancel);
        it.reports(&report(1));
        assert_eq!(it.ended(&report(0)), Some(None));
        it.began(&Judgement::Home);
        it.began(&Judgement::Cancel);
        it.reports(&report(0));
        assert_eq!(it.ended(&report(0)), None);
    }

    #[test]
    fn only_requests_are_orders() {
        let mut it = Dispatcher::new();
        it.ring().append(b"$A\x01H\xE8:$h\0\xC6:$S\0\xB1:$M").unwrap();
        assert_eq!(it.order(false).unwrap().opcode, Opcode::STATUS);
        assert_eq!(it.order(false), None);
        it.ring().append(b"\x0C$C\0\xA1:").unwrap();
        assert_eq!(it.order(false), None);
        assert_eq!(it.order(true).unwrap().opcode, Opcode::CANCEL);
    }
}
