//! Summing, copying and finding bytes: the place where code differs between targets (the values of GX do too, see
//! `gx/receiver/binary.rs`). On hosts blocks of bytes are taken at a time, elsewhere one byte (some copy four);
//! `--cfg small_leaves` has hosts do that too, for tests.
//!
//! The standard copies become calls of memcpy, which the library does without.

use core::hint::black_box;

/// Whether blocks are taken at a time.
pub const WIDE: bool = cfg!(all(target_pointer_width = "64", not(small_leaves)));

/// Whether copies take four bytes at a time: on 32-bit Arm, where they can be loaded from any address. That is what
/// processors with atomics do (ARMv7-M and later), and ARMv6-M does not.
const HALVES: bool = cfg!(any(small_leaves, all(target_arch = "arm", target_has_atomic = "32")));

/// Bytes taken at a time where there are so many, and where there are fewer.
pub(crate) const BLOCK: usize = 16;
const WORD: usize = 8;
const HALF: usize = 4;

/// Bytes in a row, wherever they lie.
pub trait Bytes {
    /// Number of bytes.
    fn len(&self) -> usize;

    /// Whether there is none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The byte at that place; behind the last one, any.
    fn byte(&self, place: usize) -> u8;

    /// Adds bytes, `length` ones from `begin` on, to a sum modulo 256.
    fn add_up(&self, sum: u8, begin: usize, length: usize) -> u8;
}

impl Bytes for [u8] {
    #[inline(always)]
    fn len(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn byte(&self, place: usize) -> u8 {
        self.get(place).copied().unwrap_or_default()
    }

    #[inline(always)]
    fn add_up(&self, sum: u8, begin: usize, length: usize) -> u8 {
        add_up(sum, self.get(begin..begin.wrapping_add(length)).unwrap_or_default())
    }
}

/// Bytes in a ring: `length` ones from `begin` on, which is a place in it.
#[derive(Clone, Copy, Debug)]
pub struct Wrapped<'a, const SIZE: usize> {
    /// All of the ring.
    pub ring: &'a [u8; SIZE],
    /// Where the first byte is, below `SIZE`.
    pub begin: usize,
    /// How many there are, at most `SIZE`.
    pub length: usize,
}

impl<'a, const SIZE: usize> Wrapped<'a, SIZE> {
    /// Copies them, when there is room for all.
    #[inline(always)]
    pub fn copy_to<T>(self, to: &mut [T], item: impl Fn(u8) -> T + Copy) {
        let to = to.get_mut(..self.length).unwrap_or_default();
        if WIDE {
            // Most frames have no payload.
            if to.is_empty() {
                return;
            }
            let (first, rest) = self.pieces(0, self.length);
            let (to_first, to_rest) = to.split_at_mut_checked(first.len()).unwrap_or_default();
            copy(first, to_first, item);
            return copy(rest, to_rest, item);
        }
        let mut from = self.begin;
        for to in to {
            *to = item(self.ring.get(wrap::<SIZE>(from)).copied().unwrap_or_default());
            from = wrap::<SIZE>(from).wrapping_add(1);
        }
    }

    /// Some of them, up to the ring's end and from its beginning on.
    #[inline(always)]
    fn pieces(self, begin: usize, length: usize) -> (&'a [u8], &'a [u8]) {
        let (front, back) =
            self.ring.split_at_checked(wrap::<SIZE>(self.begin.wrapping_add(begin))).unwrap_or_default();
        match back.get(..length) {
            Some(first) => (first, &[]),
            None => (back, front.get(..length.wrapping_sub(back.len())).unwrap_or_default()),
        }
    }
}

impl<const SIZE: usize> Bytes for Wrapped<'_, SIZE> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.length
    }

    #[inline(always)]
    fn byte(&self, place: usize) -> u8 {
        self.ring.get(wrap::<SIZE>(self.begin.wrapping_add(place))).copied().unwrap_or_default()
    }

    #[inline(always)]
    fn add_up(&self, mut sum: u8, begin: usize, length: usize) -> u8 {
        if WIDE {
            if length == 0 {
                return sum;
            }
            let (first, rest) = self.pieces(begin, length);
            return add_up(add_up(sum, first), rest);
        }
        let mut from = self.begin.wrapping_add(begin);
        let mut left = length;
        while left > 0 {
            sum = sum.wrapping_add(self.ring.get(wrap::<SIZE>(from)).copied().unwrap_or_default());
            from = wrap::<SIZE>(from).wrapping_add(1);
            left = left.wrapping_sub(1);
        }
        sum
    }
}

/// Copies bytes into a ring from that place on, over its end to its beginning. They are no more than the ring holds.
#[inline(always)]
pub fn copy_into_ring<const SIZE: usize>(input: &[u8], ring: &mut [u8; SIZE], begin: usize) {
    if WIDE && input.len() != 1 {
        return copy_into_ring_wide(input, ring, begin);
    }
    let mut to = begin;
    for byte in input {
        if let Some(place) = ring.get_mut(wrap::<SIZE>(to)) {
            *place = *byte;
        }
        to = wrap::<SIZE>(to).wrapping_add(1);
    }
}

#[inline(never)]
fn copy_into_ring_wide<const SIZE: usize>(input: &[u8], ring: &mut [u8; SIZE], begin: usize) {
    let (front, back) = ring.split_at_mut_checked(begin).unwrap_or_default();
    let (first, rest) = input.split_at_checked(back.len()).unwrap_or((input, &[]));
    copy(first, back, |byte| byte);
    copy(rest, front, |byte| byte);
}

/// A place that may be past a ring's end, by less than its size.
#[inline(always)]
pub const fn wrap<const SIZE: usize>(place: usize) -> usize {
    if SIZE.is_power_of_two() {
        place & SIZE.wrapping_sub(1)
    } else if place >= SIZE {
        place.wrapping_sub(SIZE)
    } else {
        place
    }
}

/// Room, all zero, which the compiler does not see: of `[0_u8; SIZE]` it would make a call of memset or memcpy, and
/// firmware may have neither.
#[inline(always)]
pub fn zeros<const WORDS: usize>() -> [u16; WORDS] {
    [black_box(0); WORDS]
}

/// Adds the bytes to a sum modulo 256.
#[inline(always)]
pub fn add_up(mut sum: u8, mut bytes: &[u8]) -> u8 {
    if WIDE {
        while bytes.len() > 2 * BLOCK
            && let Some((blocks, rest)) = bytes.split_first_chunk::<{ 2 * BLOCK }>()
        {
            sum = blocks.iter().fold(sum, |sum, byte| sum.wrapping_add(*byte));
            bytes = rest;
        }
        if bytes.len() > BLOCK {
            return sum.wrapping_add(add_up_ends::<BLOCK>(bytes));
        }
        if bytes.len() >= WORD {
            return sum.wrapping_add(add_up_ends::<WORD>(bytes));
        }
        if bytes.len() >= HALF {
            return sum.wrapping_add(add_up_ends::<HALF>(bytes));
        }
    }
    for byte in bytes {
        sum = sum.wrapping_add(*byte);
    }
    sum
}

/// Sums N to twice N bytes: those at the beginning, and of those at the end the ones that are left. Processors do that
/// without a loop.
#[inline(always)]
fn add_up_ends<const N: usize>(bytes: &[u8]) -> u8 {
    const MASKS: [[u8; BLOCK]; 2] = [[0; BLOCK], [0xFF; BLOCK]];
    let left = bytes.len().wrapping_sub(N);
    let (Some(first), Some(last)) = (bytes.first_chunk::<N>(), bytes.last_chunk::<N>()) else { return 0 };
    let Some(masks) = MASKS.as_flattened().get(BLOCK.wrapping_sub(N).wrapping_add(left)..) else { return 0 };
    let Some(masks) = masks.first_chunk::<N>() else { return 0 };
    let mut sum = 0_u8;
    // A loop: of a fold the compiler may make a call.
    for ((first, last), mask) in first.iter().zip(last).zip(masks) {
        sum = sum.wrapping_add(*first).wrapping_add(last & mask);
    }
    sum
}

/// Copies as many items as both have. `item` makes a byte what `to` consists of.
#[inline(always)]
pub fn copy<T>(from: &[u8], to: &mut [T], item: impl Fn(u8) -> T + Copy) {
    let length = from.len().min(to.len());
    let (Some(mut from), Some(mut to)) = (from.get(..length), to.get_mut(..length)) else { return };
    if WIDE {
        while from.len() > 2 * BLOCK {
            let (Some((block, rest)), Some((place, places))) =
                (from.split_first_chunk::<BLOCK>(), to.split_first_chunk_mut::<BLOCK>())
            else {
                return;
            };
            *place = block.map(item);
            (from, to) = (rest, places);
        }
        if from.len() > BLOCK {
            return copy_ends::<BLOCK, T>(from, to, item);
        }
        if from.len() >= WORD {
            return copy_ends::<WORD, T>(from, to, item);
        }
        if from.len() >= HALF {
            return copy_ends::<HALF, T>(from, to, item);
        }
    }
    if HALVES {
        let ((halves, rest), (places, behind)) = (from.as_chunks::<HALF>(), to.as_chunks_mut::<HALF>());
        for (place, half) in places.iter_mut().zip(halves) {
            // Not by map, which becomes a loop.
            let [first, second, third, fourth] = *half;
            *place = [item(first), item(second), item(third), item(fourth)];
        }
        (from, to) = (rest, behind);
    }
    for (place, byte) in to.iter_mut().zip(from) {
        *place = item(*byte);
    }
}

/// Copies N to twice N bytes: the first and the last ones, of which some may be the same.
#[inline(always)]
fn copy_ends<const N: usize, T>(from: &[u8], to: &mut [T], item: impl Fn(u8) -> T + Copy) {
    let (Some(first), Some(last)) = (from.first_chunk::<N>(), from.last_chunk::<N>()) else { return };
    let (first, last) = (first.map(item), last.map(item));
    if let Some(place) = to.first_chunk_mut::<N>() {
        *place = first;
    }
    if let Some(place) = to.last_chunk_mut::<N>() {
        *place = last;
    }
}

/// Copies bytes to as many places, and adds them to a sum modulo 256.
#[inline(always)]
pub fn copy_and_add_up<T>(mut sum: u8, from: &[u8], to: &mut [T], item: impl Fn(u8) -> T + Copy) -> u8 {
    if WIDE {
        // Most frames have no payload.
        if !from.is_empty() {
            sum = add_up(sum, from);
            copy(from, to, item);
        }
        return sum;
    }
    for (place, byte) in to.iter_mut().zip(from) {
        *place = item(*byte);
        sum = sum.wrapping_add(*byte);
    }
    sum
}

/// Fletcher's two sums in one, second above first and each modulo 255, of those before `sum` and more bytes. 0 is 255,
/// unless it was 0 before.
#[inline(always)]
pub fn fletcher(sum: u16, bytes: &[u8]) -> u16 {
    let [mut second, mut first] = sum.to_be_bytes();
    if WIDE {
        let (mut sums, mut more) = (u32::from(first), u32::from(second));
        let (words, rest) = bytes.as_chunks::<WORD>();
        // Sums of 5,802 bytes would still fit.
        for block in words.chunks(512) {
            for word in block {
                let (plain, weighted) = fletcher_word(*word);
                more = more.wrapping_add(sums.wrapping_mul(8)).wrapping_add(weighted);
                sums = sums.wrapping_add(plain);
            }
            (sums, more) = (folded(sums), folded(more));
        }
        for byte in rest {
            sums = sums.wrapping_add(u32::from(*byte));
            more = more.wrapping_add(sums);
        }
        ([first, ..], [second, ..]) = (folded(sums).to_le_bytes(), folded(more).to_le_bytes());
    } else {
        for byte in bytes {
            first = plus(first, *byte);
            second = plus(second, first);
        }
    }
    u16::from_be_bytes([second, first])
}

/// Adds in ones' complement: a carry goes back in.
const fn plus(sum: u8, more: u8) -> u8 {
    let (sum, carry) = sum.overflowing_add(more);
    sum.wrapping_add(carry as u8)
}

/// What a word adds to the first sum, and to the second besides eight times the first: each byte as often as it is in a
/// sum that is added there, 8 times to once.
#[inline(always)]
const fn fletcher_word(word: [u8; WORD]) -> (u32, u32) {
    const LANES: u64 = 0x00FF_00FF_00FF_00FF;
    let word = u64::from_le_bytes(word);
    let (even, odd) = (word & LANES, word >> 8 & LANES);
    // A product's highest lane is the sum of all lanes, each times the factor that stands opposite; none overflows.
    let plain = even.wrapping_add(odd).wrapping_mul(0x0001_0001_0001_0001) >> 48;
    let weighted =
        (even.wrapping_mul(0x0008_0006_0004_0002) >> 48).wrapping_add(odd.wrapping_mul(0x0007_0005_0003_0001) >> 48);
    (plain as u32, weighted as u32)
}

/// The same residue modulo 255, 1 to 255; 0 only of 0.
const fn folded(sum: u32) -> u32 {
    let sum = (sum & 0xFFFF).wrapping_add(sum >> 16);
    let sum = (sum & 0xFF).wrapping_add(sum >> 8);
    let sum = (sum & 0xFF).wrapping_add(sum >> 8);
    (sum & 0xFF).wrapping_add(sum >> 8)
}

/// Divides a number, whose lowest byte is the first, by ten, and returns what is left. Not by a division where there is
/// none: that takes a kilobyte of flash on some controllers.
pub fn divide_by_ten(number: &mut [u8]) -> u8 {
    let mut left = 0_u8;
    for byte in number.iter_mut().rev() {
        if WIDE {
            let value = u16::from_be_bytes([left, *byte]);
            [*byte, left] = [(value / 10).to_le_bytes()[0], (value % 10).to_le_bytes()[0]];
        } else if left == 0 {
            // A tenth: 205 / 2048, near enough for a byte.
            let [_, tenth] = u16::from(*byte).wrapping_mul(205).to_le_bytes();
            let tenth = tenth >> 3;
            left = byte.wrapping_sub(tenth.wrapping_mul(10));
            *byte = tenth;
        } else {
            let mut bits = 8_u8;
            while bits > 0 {
                left = left << 1 | *byte >> 7;
                *byte <<= 1;
                if left >= 10 {
                    left = left.wrapping_sub(10);
                    *byte |= 1;
                }
                bits = bits.wrapping_sub(1);
            }
        }
    }
    left
}

/// How many bytes are in front of the first that is below a limit, of at most 128.
#[inline(always)]
pub fn before_less(bytes: &[u8], limit: u8) -> usize {
    const ONES: u64 = 0x0101_0101_0101_0101;
    let mut before = 0_usize;
    let mut rest = bytes;
    while WIDE && let Some((word, behind)) = rest.split_first_chunk::<WORD>() {
        let word = u64::from_le_bytes(*word);
        // The high bit of each such byte, and of some above the first, which don't matter.
        let less = word.wrapping_sub(ONES.wrapping_mul(limit.into())) & !word & ONES << 7;
        if less != 0 {
            return before.wrapping_add(less.trailing_zeros() as usize >> 3);
        }
        before = before.wrapping_add(WORD);
        rest = behind;
    }
    for byte in rest {
        if *byte < limit {
            break;
        }
        before = before.wrapping_add(1);
    }
    before
}

#[cfg(test)]
mod tests {
    use super::{add_up, before_less, copy};

    fn some(length: usize) -> Vec<u8> {
        (0..=u8::MAX).map(|place| place.wrapping_mul(167).wrapping_add(89)).take(length).collect()
    }

    #[test]
    fn sums_are_those_of_one_byte_after_the_other() {
        for length in 0..=255 {
            let bytes = some(length);
            let sum = bytes.iter().fold(200, |sum: u8, byte| sum.wrapping_add(*byte));
            assert_eq!(add_up(200, &bytes), sum, "{length} bytes");
        }
        assert_eq!(add_up(0, &[0xFF; 255]), 1);
    }

    #[test]
    fn the_first_byte_below_a_limit_is_found() {
        for length in 0..40 {
            let above: Vec<u8> = [b'\'', 0x80, 0x7F, 0xA6, 0xFF].into_iter().cycle().take(length).collect();
            assert_eq!(before_less(&above, b'\''), length);
            for (at, below) in (0..length).flat_map(|at| [(at, b'&'), (at, 0)]) {
                let mut bytes = above.clone();
                bytes[at..].iter_mut().step_by(3).for_each(|byte| *byte = below);
                assert_eq!(before_less(&bytes, b'\''), at, "{bytes:?}");
            }
        }
    }

    #[test]
    fn as_many_bytes_are_copied_as_both_sides_have() {
        for from in 0..=255 {
            for to in [from, 0, 1, 7, 8, 9, 100, 255] {
                let (source, mut copied, both) = (some(from), vec![0; to], from.min(to));
                copy(&source, &mut copied, |byte| byte);
                assert_eq!(copied, [&source[..both], &vec![0; to - both]].concat(), "{from} bytes to {to}");
            }
        }
    }
}
