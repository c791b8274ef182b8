//! A path as the shortest stream of commands.

use zerocopy::{FromBytes, Immutable, KnownLayout};

use super::encoder::{EncodeError, Written, write_shortest};
use super::message::Number;
use super::vector::{AXES, MASK_AXES, Vector};

/// Writes a path: each position of a list is one command, the shortest that leads there from the one before.
///
/// A command names only the axes that change, and the velocity only if that changes. A position that is repeated is a
/// short command of one axis that does not move: [`Vector::follow`] along the commands gives the same list.
///
/// All zero: the path is of no axis.
#[derive(Clone, Debug, Default, PartialEq, Eq, FromBytes, Immutable, KnownLayout)]
pub struct Contour {
    /// The axes of the path and its velocity, if it has one.
    target: Vector,
    /// Position and velocity that the commands so far lead to, as far as they are known.
    at: Vector,
}

impl Contour {
    /// A path of these axes (bit i is axis i; other bits are ignored), the position where it begins unknown.
    pub const fn new(axes: u8) -> Self {
        let mut target = Vector::new();
        target.mask = axes & MASK_AXES;
        Self { target, at: Vector::new() }
    }

    /// Makes it a path of other axes; returns whether it has any.
    pub const fn set_axes(&mut self, axes: u8) -> bool {
        self.target.mask = axes & MASK_AXES;
        self.target.mask != 0
    }

    /// Sets where the machine is, and how fast it was ordered to move, as far as the mask says so.
    pub fn starts_at(&mut self, start: &Vector) {
        self.at.copy(start);
    }

    /// What is known of position and velocity no longer holds: after an error notice, the next command is a long one.
    pub const fn forget(&mut self) {
        self.at.mask = 0;
    }

    /// Writes the command that leads to the next position; returns its length in bytes. Axes that are not the path's
    /// are ignored; without a velocity, that of the last segment holds. After an error the path still ends where it did.
    pub fn segment(
        &mut self,
        number: Option<Number>,
        position: &[i32; AXES],
        velocity: Option<u16>,
        room: &mut [u8],
    ) -> Written {
        let axes = self.target.mask & MASK_AXES;
        let before = self.target.velocity();
        let wanted = velocity.or(before);
        if axes == 0 {
            return Err(EncodeError::Empty);
        }
        for (place, value) in self.target.axes.iter_mut().zip(position) {
            *place = *value;
        }
        self.flag(axes, wanted.filter(|_| wanted != self.at.velocity()));
        let written = write_shortest(number, &self.target, &self.at, room);
        if written.is_ok() {
            self.at.merge(&self.target);
        }
        self.flag(axes, if written.is_ok() { wanted } else { before });
        written
    }

    /// Sets the mask of the target.
    const fn flag(&mut self, axes: u8, velocity: Option<u16>) {
        self.target.mask = axes;
        if let Some(velocity) = velocity {
            self.target.set_velocity(velocity);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CommandReceiver, ENCODED_MAX, Kind, POSITION_MAX, POSITION_MIN};
    use super::*;
    use proptest::prelude::*;

    /// Positions near the one before, and anywhere; -1, -64 and the like often.
    fn path() -> impl Strategy<Value = Vec<[(bool, i32); AXES]>> {
        let value = prop_oneof![
            4 => (Just(true), -70..=70),
            1 => (Just(true), Just(0)),
            1 => (Just(false), POSITION_MIN..=POSITION_MAX),
            1 => (Just(false), prop_oneof![Just(POSITION_MIN), Just(POSITION_MAX), Just(-1), Just(2_097_152)]),
        ];
        prop::collection::vec(prop::array::uniform6(value), 1..40)
    }

    proptest! {
        #[test]
        fn any_path_comes_back(
            axes in 1..=MASK_AXES,
            path in path(),
            velocities in prop::collection::vec(prop::option::of(0..=16383_u16), 40),
        ) {
            let mut contour = Contour::new(axes);
            let mut receiver = CommandReceiver::new();
            let (mut here, mut decoded) = ([0_i32; AXES], Vector::new());
            for (step, velocity) in path.iter().zip(&velocities) {
                for (place, (near, value)) in here.iter_mut().zip(step) {
                    *place = if *near { (*place + value).clamp(POSITION_MIN, POSITION_MAX) } else { *value };
                }
                let mut room = [0; ENCODED_MAX];
                let length = contour.segment(None, &here, *velocity, &mut room).unwrap();
                let (taken, kind) = receiver.receive(&room[..length]);
                prop_assert_eq!(taken, length);
                prop_assert_eq!(decoded.follow(receiver.vector(), kind == Some(Kind::Step)), Ok(()));
                for axis in (0..AXES).filter(|axis| axes >> axis & 1 == 1) {
                    prop_assert_eq!(decoded.axis(axis), Some(here[axis]));
                }
                if velocity.is_some() {
                    prop_assert_eq!(decoded.velocity(), *velocity);
                }
            }
        }
    }
}
