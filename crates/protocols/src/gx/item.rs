//! What was received, as a value of its own.

use super::message::{Format, Kind, Number, Status};
use super::receiver::Receiver;
use super::vector::{Vector, bit};

/// A command or notice that a [`Receiver`] found, apart from it: for programs that keep or print them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item {
    /// The number that stood in front of it.
    pub number: Option<Number>,
    /// How it was written.
    pub format: Format,
    /// What it says.
    pub message: Message,
}

/// What an [`Item`] says: see [`Kind`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message {
    Move(Vector),
    Step(Vector),
    Reporting(u16),
    Malformed(u8),
    Completed,
    Refused(u8),
    Position(Vector),
    Confirmed { number: u8, check: u8 },
    Control(u16),
    Status(Status),
}

impl<const NOTICES: bool> Receiver<NOTICES> {
    /// What was found by the last call, which returned this kind.
    pub fn item(&self, kind: Kind) -> Item {
        let number = self.number();
        let mut vector = *self.vector();
        let mask = vector.mask;
        for (axis, value) in vector.axes.iter_mut().enumerate() {
            *value = if mask & bit(axis) == 0 { 0 } else { *value };
        }
        let message = match kind {
            Kind::Move => Message::Move(vector),
            Kind::Step => Message::Step(vector),
            Kind::Position => Message::Position(vector),
            Kind::Reporting => Message::Reporting(self.period()),
            Kind::Malformed => Message::Malformed(self.code()),
            Kind::Completed => Message::Completed,
            Kind::Refused => Message::Refused(self.code()),
            Kind::Confirmed => {
                let (number, check) = self.confirmed();
                Message::Confirmed { number, check }
            }
            Kind::Control => Message::Control(self.bits()),
            Kind::Status => Message::Status(Status::of(self.bits())),
        };
        let format = if kind == Kind::Completed { self.number.format() } else { self.format() };
        Item { number, format, message }
    }
}
