//! Summing and copying bytes.
//!
//! The standard copies become calls of memcpy, which the library does without (see the crate's `no_builtins`). On hosts these
//! take eight bytes at a time.

use crate::config::FAST;

/// Bytes taken at a time.
pub(super) const WORD: usize = 8;

/// The sum of the bytes modulo 256.
#[inline(always)]
pub(super) fn sum(bytes: &[u8]) -> u8 {
    if FAST && bytes.len() >= WORD {
        return sum_of_words(bytes);
    }
    let mut sum = 0_u8;
    for byte in bytes {
        sum = sum.wrapping_add(*byte);
    }
    sum
}

/// The sum of at least [`WORD`] bytes. Not inlined, to leave its callers' registers to their short ways.
#[inline(never)]
fn sum_of_words(bytes: &[u8]) -> u8 {
    let (words, tail) = bytes.as_chunks::<WORD>();
    let mut lanes = 0_u64;
    for word in words {
        // Turning the lanes changes nothing but keeps the compiler from making four sums of it, for a few words.
        lanes = lanes.rotate_left(16).wrapping_add(pairs(u64::from_le_bytes(*word)));
    }
    // What no whole word was left for stands at the end of the last eight bytes.
    if let Some(last) = bytes.last_chunk::<WORD>() {
        let summed = (WORD.wrapping_sub(tail.len()) as u32).wrapping_mul(8);
        lanes = lanes.wrapping_add(pairs(u64::from_le_bytes(*last).checked_shr(summed).unwrap_or(0)));
    }
    sum_of_pairs(lanes)
}

#[inline(always)]
const fn sum_of_pairs(pairs: u64) -> u8 {
    let [.., low, _] = pairs.wrapping_mul(0x0001_0001_0001_0001).to_le_bytes();
    low
}

/// Sums of two neighbours each, 16 bits apart: so many can be added up before one runs into the next.
#[inline(always)]
const fn pairs(word: u64) -> u64 {
    const EVEN: u64 = 0x00FF_00FF_00FF_00FF;
    (word & EVEN).wrapping_add((word >> 8) & EVEN)
}

/// Copies as many items as both have. `item` makes a byte what `to` consists of.
#[inline(always)]
pub(super) fn copy<T>(from: &[u8], to: &mut [T], item: impl Fn(u8) -> T + Copy) {
    let length = from.len().min(to.len());
    let (Some(from), Some(to)) = (from.get(..length), to.get_mut(..length)) else { return };
    if FAST {
        let (words, _) = from.as_chunks::<WORD>();
        let (places, _) = to.as_chunks_mut::<WORD>();
        for (place, word) in places.iter_mut().zip(words) {
            *place = word.map(item);
        }
        if let (Some(word), Some(place)) = (from.last_chunk::<WORD>(), to.last_chunk_mut::<WORD>()) {
            *place = word.map(item);
            return;
        }
    }
    for (place, byte) in to.iter_mut().zip(from) {
        *place = item(*byte);
    }
}
