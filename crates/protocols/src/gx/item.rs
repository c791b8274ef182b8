//! What was received, as a value of its own.

use super::message::{Format, Kind, Number, Status};
use super::receiver::Receiver;
use super::vector::Vector;

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
        // What the mask does not flag is left over from earlier vectors.
        let found = self.vector();
        let axes = core::array::from_fn(|axis| found.axis(axis).unwrap_or_default());
        let vector = Vector { velocity: found.velocity().unwrap_or_default(), mask: found.mask, axes };
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

#[cfg(test)]
mod tests {
    use super::{Message, Vector};
    use crate::gx::CommandReceiver;

    #[test]
    fn values_that_are_not_flagged_are_zero() {
        let mut receiver = CommandReceiver::new();
        for (line, vector) in [
            (&b"V7x1y-2\n"[..], Vector { velocity: 7, mask: 0x43, axes: [1, -2, 0, 0, 0, 0] }),
            (b"c3\n", Vector { velocity: 0, mask: 0x20, axes: [0, 0, 0, 0, 0, 3] }),
        ] {
            let (_, kind) = receiver.receive(line);
            assert_eq!(receiver.item(kind.unwrap()).message, Message::Move(vector));
        }
    }
}
