//! Summing and copying bytes, on hosts eight at a time.
//!
//! The standard copies become calls of memcpy, which the library does without (see the crate's `no_builtins`).

use crate::config::FAST;

/// Bytes taken at a time.
const WORD: usize = 8;

/// Adds the bytes to a sum modulo 256.
#[inline(always)]
pub(super) fn add_up(mut sum: u8, mut bytes: &[u8]) -> u8 {
    if FAST && bytes.len() >= WORD {
        let (words, rest) = bytes.as_chunks::<WORD>();
        for word in words {
            // Of a fixed number of bytes: processors have instructions for that.
            sum = sum.wrapping_add(word.iter().fold(0, |sum, byte| sum.wrapping_add(*byte)));
        }
        bytes = rest;
    }
    for byte in bytes {
        sum = sum.wrapping_add(*byte);
    }
    sum
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

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use super::{add_up, copy};

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
    fn as_many_bytes_are_copied_as_both_sides_have() {
        for from in 0..=255 {
            for to in [from, 0, 1, 7, 8, 9, 100, 255] {
                let (source, mut copied, mut expected) = (some(from), vec![0; to], vec![0; to]);
                for (place, byte) in expected.iter_mut().zip(&source) {
                    *place = *byte;
                }
                copy(&source, &mut copied, |byte| byte);
                assert_eq!(copied, expected, "{from} bytes to {to}");
            }
        }
    }
}
