//! The checksums of candidates that overlap, on hosts.

use super::Opcode;
use super::frame::{FRAME_END, FRAME_HEAD, FRAME_OVERHEAD};
use super::ring::{FRAME_MAX, Ring, pieces};
use crate::bytes;

/// Bytes that are summed ahead: more are a waste in small rings, of fewer more are summed again.
const AHEAD: usize = FRAME_MAX.wrapping_mul(4);

/// Frames up to this size are summed without a loop, which costs no more than two look-ups.
const SHORT: usize = 2 * bytes::BLOCK + FRAME_OVERHEAD;

/// Checksum and end.
const FRAME_TAIL: usize = FRAME_OVERHEAD.wrapping_sub(FRAME_HEAD);

/// The sums that one search needs. Complete candidates may overlap, so that a byte stands in many of them; but however
/// many fail, the search takes a time that grows with the ring's size alone: of those that are not short the first is
/// summed as it is, and for others behind it running sums are made, of which two tell the sum between them.
#[derive(Default)]
pub(super) struct Sums(Option<Running>);

impl Sums {
    /// Whether the checksum of a complete candidate is right.
    #[inline(always)]
    pub(super) fn prove(&mut self, ring: &Ring, start: usize, used: usize, opcode: Opcode, size: usize) -> bool {
        if FRAME_MAX <= SHORT || size <= SHORT {
            return ring.is_right(start, opcode, size);
        }
        if let Some(running) = &mut self.0 {
            let size = size.wrapping_sub(FRAME_TAIL);
            return running.sum(ring, start, used, size).wrapping_add(FRAME_END) == ring.byte(start.wrapping_add(size));
        }
        let intact = ring.is_right(start, opcode, size);
        if !intact {
            // One by one, which never becomes a call of memset.
            self.0 = Some(Running { sums: core::array::from_fn(|_| 0), used: 0 });
        }
        intact
    }
}

/// The sums of the first 0, 1, 2... bytes from some place in the ring on.
struct Running {
    sums: [u8; AHEAD],
    /// How many bytes the ring had from that place on; 0 before there is one.
    used: usize,
}

impl Running {
    /// The sum of so many bytes that begin at `start`, where the ring has `used` ones.
    #[inline(always)]
    fn sum(&mut self, ring: &Ring, start: usize, used: usize, size: usize) -> u8 {
        let place = self.used.wrapping_sub(used);
        match (self.sums.get(place), self.sums.get(place.wrapping_add(size))) {
            (Some(before), Some(all)) => all.wrapping_sub(*before),
            _ => self.begin(ring, start, used, size),
        }
    }

    /// The same, and from now on that is the place.
    #[inline(never)]
    fn begin(&mut self, ring: &Ring, start: usize, used: usize, size: usize) -> u8 {
        self.used = used;
        let (first, rest) = pieces(&ring.bytes, start, used.min(const { AHEAD.wrapping_sub(1) }));
        let [_, sums @ ..] = &mut self.sums;
        let (now, later) = sums.split_at_mut_checked(first.len()).unwrap_or_default();
        let mut sum = 0_u8;
        for (sums, bytes) in [(now, first), (later, rest)] {
            for (place, byte) in sums.iter_mut().zip(bytes) {
                sum = sum.wrapping_add(*byte);
                *place = sum;
            }
        }
        self.sums.get(size).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::{AHEAD, FRAME_HEAD, FRAME_MAX, FRAME_OVERHEAD, Ring, Running};
    use crate::config::DP_BUFSIZE;

    #[test]
    fn two_running_sums_tell_what_is_between_them() {
        let mut ring = Ring::new();
        for (byte, value) in ring.bytes.iter_mut().zip((0..=u8::MAX).cycle()) {
            *byte = value.wrapping_mul(167).wrapping_add(89);
        }
        for first in 0..DP_BUFSIZE {
            let mut running = Running { sums: [0; AHEAD], used: 0 };
            let mut passed = 0;
            while passed + FRAME_MAX <= DP_BUFSIZE {
                let start = (first + passed) % DP_BUFSIZE;
                for size in [FRAME_OVERHEAD, FRAME_HEAD, FRAME_MAX] {
                    let bytes = ring.bytes.iter().cycle().skip(start).take(size);
                    let expected = bytes.fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
                    assert_eq!(
                        running.sum(&ring, start, DP_BUFSIZE - passed, size),
                        expected,
                        "{first} {passed} {size}"
                    );
                }
                passed += 1 + passed % 4;
            }
        }
    }
}
