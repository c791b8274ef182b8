//! What comes in: bytes, the frames among them, and what is wrong with the rest.

use core::ffi::{c_uchar, c_ulong};

use super::health::Health;
use crate::clock::{left, stamp};
use crate::config::{DP_BUFSIZE, DP_DATA_MAX_SIZE};
use crate::counter::count;
use crate::deltarobot::{FRAME_END, FRAME_OVERHEAD, FRAME_START, Message, Opcode, PAYLOAD_MAX, Place, Ring};

/// The receiving side of a host session. Its fields are private.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Link {
    ring: Ring,
    /// When the last bytes came.
    arrived_at: c_ulong,
    /// Looking for frames with a wrong checksum: how many bytes of a head or tail are there (0 to 4), how many of the
    /// payload are missing, and the sum so far.
    place: c_uchar,
    missing: c_uchar,
    sum: c_uchar,
}

impl Link {
    pub(super) const fn new() -> Self {
        Self { ring: Ring::new(), arrived_at: 0, place: 0, missing: 0, sum: 0 }
    }

    /// Takes as many bytes as there is room for.
    pub(super) fn receive(&mut self, input: &[u8], now: u32, health: &mut Health) -> usize {
        let taken = input.get(..self.ring.room()).unwrap_or(input);
        if taken.len() < input.len() {
            count(&mut health.overflows);
        }
        if !taken.is_empty() {
            self.arrived_at = stamp(now);
        }
        for byte in taken {
            self.watch(*byte, health);
        }
        // Can't overflow: there is room for them.
        let _ = self.ring.append(taken);
        taken.len()
    }

    /// Takes out the next frame: its opcode and the length of its payload, which is copied to `data` as far as that
    /// goes, and its beginning to `head`. (It is not returned as a message, since moving one of these is a call of
    /// memcpy.)
    pub(super) fn next<P: Place>(
        &mut self,
        now: u32,
        gap: u32,
        head: &mut [u8; PAYLOAD_MAX],
        data: &mut [P],
        health: &mut Health,
    ) -> Option<(Opcode, usize)> {
        let before = self.used();
        if before == 0 {
            return None;
        }
        let quiet = left(now, self.arrived_at, gap) == 0;
        let frame = if quiet { self.ring.next_frame_idle() } else { self.ring.next_frame() };
        let received = frame.ok().map(|frame| {
            frame.payload.copy_to(data);
            Message::head(&frame, head);
            (frame.opcode, frame.payload.len())
        });
        let mut gone = before.wrapping_sub(self.used());
        if let Some((_, length)) = received {
            count(&mut health.frames);
            gone = gone.wrapping_sub(length.wrapping_add(FRAME_OVERHEAD));
        }
        // A ring's size fits an int.
        health.garbage_bytes = health.garbage_bytes.wrapping_add(c_ulong::try_from(gone).unwrap_or_default());
        received
    }

    /// How long until what is incomplete can be given up; `None` when there is nothing.
    pub(super) fn gap_left(&self, now: u32, gap: u32) -> Option<u32> {
        (self.used() != 0).then(|| left(now, self.arrived_at, gap))
    }

    fn used(&self) -> usize {
        DP_BUFSIZE.wrapping_sub(self.ring.room())
    }

    /// Counts frames that are whole but for their checksum. The ring does not tell them from other garbage. This look
    /// goes over the bytes once and does not turn back, so it misses frames inside of false ones.
    fn watch(&mut self, byte: u8, health: &mut Health) {
        let next = match (self.place, byte) {
            (1, _) if Opcode(byte).is_known() => 2,
            (2, _) if usize::from(byte) <= DP_DATA_MAX_SIZE => {
                self.missing = byte;
                3
            }
            (3, _) if self.missing > 0 => {
                self.missing = self.missing.wrapping_sub(1);
                3
            }
            (3, _) => {
                // From here on, the sum is what the checksum is off by.
                self.sum = self.sum.wrapping_add(FRAME_END).wrapping_sub(byte);
                self.place = 4;
                return;
            }
            (4, FRAME_END) => {
                if self.sum != 0 {
                    count(&mut health.checksum_failures);
                }
                0
            }
            (_, FRAME_START) => {
                self.sum = 0;
                1
            }
            _ => 0,
        };
        self.place = next;
        self.sum = self.sum.wrapping_add(byte);
    }
}

#[cfg(test)]
mod tests {
    use super::{Health, Link, Opcode};

    fn feed(link: &mut Link, health: &mut Health, bytes: &[u8]) -> std::vec::Vec<u8> {
        assert_eq!(link.receive(bytes, 0, health), bytes.len());
        let mut opcodes = std::vec::Vec::new();
        while let Some((opcode, _)) = link.next(0, 50, &mut [0; 16], &mut [0; 0], health) {
            opcodes.push(opcode.0);
        }
        opcodes
    }

    #[test]
    fn garbage_and_checksum_failures_are_counted() {
        let (mut link, mut health) = (Link::new(), Health::new());
        assert_eq!(feed(&mut link, &mut health, b"xy$S\0\xB1:z$S\0\xB2:$A\x01H\xE8:$A\x01H\xE9:$$h\0\xC6:"), b"SAh");
        assert_eq!((health.frames, health.garbage_bytes, health.checksum_failures), (3, 3 + 5 + 6 + 1, 2));
        assert_eq!(health.malformed, 0);
    }

    #[test]
    fn a_frame_in_pieces_is_no_garbage() {
        let (mut link, mut health) = (Link::new(), Health::new());
        for byte in b"$A\x01H\xE8" {
            assert_eq!(feed(&mut link, &mut health, &[*byte]), b"");
        }
        assert_eq!(feed(&mut link, &mut health, b":"), b"A");
        assert_eq!((health.garbage_bytes, health.checksum_failures), (0, 0));
    }

    #[test]
    fn what_is_incomplete_is_given_up_after_the_gap() {
        let (mut link, mut health) = (Link::new(), Health::new());
        assert_eq!(feed(&mut link, &mut health, b"$M\x0C$S\0\xB1:"), b"");
        assert_eq!(link.gap_left(20, 50), Some(30));
        assert!(link.next(49, 50, &mut [0; 16], &mut [0; 0], &mut health).is_none());
        let received = link.next(50, 50, &mut [0; 16], &mut [0; 0], &mut health);
        assert_eq!((received, health.garbage_bytes), (Some((Opcode::STATUS, 0)), 3));
        assert_eq!(link.gap_left(50, 50), None);
    }
}
