//! The receiving side: bytes, and the frames among them.

use zerocopy::{FromBytes, Immutable, KnownLayout};

use super::settings::Health;
use super::timers::NEVER;
use crate::deltarobot::{Frame, Receiver};
use crate::session::{count, left};

/// The receiving side of a host session.
#[derive(Clone, Debug, Default, FromBytes, Immutable, KnownLayout)]
pub(super) struct Link<const ROOM: usize> {
    /// When the last bytes came.
    arrived_at: u32,
    receiver: Receiver<ROOM>,
    /// Not 0: not all bytes were taken.
    has_more: u8,
}

impl<const ROOM: usize> Link<ROOM> {
    /// Takes as many bytes as there is room for.
    pub(super) fn receive(&mut self, input: &[u8], now: u32) -> usize {
        let taken = self.receiver.take(input);
        if taken != 0 {
            self.arrived_at = now;
        }
        self.has_more = u8::from(taken < input.len());
        taken
    }

    /// Fetches the next frame.
    pub(super) fn next(&mut self, now: u32, gap: u32, health: &mut Health) -> Option<Frame<'_>> {
        let is_quiet = self.has_more == 0 && left(now, self.arrived_at, gap) == 0;
        let frame = if is_quiet { self.receiver.next_idle(health) } else { self.receiver.next_observed(health) };
        let frame = frame.ok()?;
        count(&mut health.frames);
        Some(frame)
    }

    /// Whether bytes that were received wait to be taken; after that, it is for the caller to take care of them.
    pub(super) const fn take_has_more(&mut self) -> bool {
        core::mem::replace(&mut self.has_more, 0) != 0
    }

    /// How long until what is incomplete can be given up.
    pub(super) fn gap_left(&self, now: u32, gap: u32) -> u32 {
        if self.receiver.is_empty() { NEVER } else { left(now, self.arrived_at, gap) }
    }
}

#[cfg(test)]
mod tests {
    use super::{Health, Link, NEVER};
    use crate::deltarobot::receiver_room;

    fn feed(link: &mut Link<{ receiver_room(12) }>, health: &mut Health, bytes: &[u8]) -> std::vec::Vec<u8> {
        let (mut opcodes, mut rest) = (std::vec::Vec::new(), bytes);
        while !rest.is_empty() {
            let taken = link.receive(rest, 0);
            rest = &rest[taken..];
            assert_eq!(link.has_more != 0, !rest.is_empty());
            opcodes.extend(core::iter::from_fn(|| link.next(0, 50, health).map(|frame| frame.opcode.0)));
        }
        opcodes
    }

    #[test]
    fn garbage_and_checksum_failures_are_counted() {
        let (mut link, mut health) = (Link::default(), Health::default());
        assert_eq!(feed(&mut link, &mut health, b"xy$S\0\xB1:z$S\0\xB2:$A\x01H\xE8:$A\x01H\xE9:$$h\0\xC6:"), b"SAh");
        assert_eq!((health.frames, health.garbage_bytes, health.checksum_failures), (3, 3 + 5 + 6 + 1, 2));
        assert_eq!(health.malformed, 0);
    }

    #[test]
    fn a_frame_in_pieces_is_no_garbage() {
        let (mut link, mut health) = (Link::default(), Health::default());
        for byte in b"$A\x01H\xE8" {
            assert_eq!(feed(&mut link, &mut health, &[*byte]), b"");
        }
        assert_eq!(feed(&mut link, &mut health, b":"), b"A");
        assert_eq!((health.garbage_bytes, health.checksum_failures), (0, 0));
    }

    #[test]
    fn what_is_incomplete_is_given_up_after_the_gap() {
        let (mut link, mut health) = (Link::default(), Health::default());
        assert_eq!(feed(&mut link, &mut health, b"$M\x0C$S\0\xB1:"), b"");
        assert_eq!(link.gap_left(20, 50), 30);
        assert!(link.next(49, 50, &mut health).is_none());
        link.has_more = 1;
        assert!(link.next(50, 50, &mut health).is_none());
        assert!(link.take_has_more() && !link.take_has_more());
        assert_eq!(link.next(50, 50, &mut health).map(|frame| frame.opcode.0), Some(b'S'));
        assert_eq!((health.garbage_bytes, link.gap_left(50, 50)), (3, NEVER));
    }
}
