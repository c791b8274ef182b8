//! Fletcher-16 in ones' complement (source: the page "Fletcher 16 Checksum generator").
//!
//! Neither byte of a sum is ever 0: 255 stands for a residue of 0. So a sum is all that is needed to go on from.

use crate::bytes::fletcher;

/// The sum of no bytes.
pub const EMPTY_SUM: u16 = 0xFFFF;

/// The checksum of some bytes.
#[inline]
pub fn fletcher16(bytes: &[u8]) -> u16 {
    fletcher16_more(EMPTY_SUM, bytes)
}

/// The checksum of the bytes that have the checksum `sum` and more behind them.
pub fn fletcher16_more(sum: u16, bytes: &[u8]) -> u16 {
    fletcher(sum, bytes)
}

#[cfg(test)]
mod tests {
    use super::{EMPTY_SUM, fletcher16, fletcher16_more};

    /// As the page words it: folded after each addition.
    fn plain(bytes: &[u8]) -> u16 {
        let (mut first, mut second) = (0xFF_u16, 0xFF_u16);
        for byte in bytes {
            first += u16::from(*byte);
            first = (first & 0xFF) + (first >> 8);
            second += first;
            second = (second & 0xFF) + (second >> 8);
        }
        second << 8 | first
    }

    #[test]
    fn known_sums() {
        for (line, sum) in [
            (&b"c=linksetup&ack=on&checksum=fletcher16&t=2&id=sf6z34"[..], 0xd293),
            (b"c=setswitch&state=1&t=11&id=9o5qzg", 0xa3d6),
            (b"c=go&x=34&y=18&a=2&spd=3343.73&eas=1&t=4&id=c3v3rD", 0x360d),
            (b"", 0xFFFF),
            (b"\0\0\0", 0xFFFF),
            (b"\xFF", 0xFFFF),
            (b"\x01", 0x0101),
        ] {
            assert_eq!(fletcher16(line), sum, "{line:?}");
        }
    }

    #[test]
    fn any_bytes_in_any_pieces_as_byte_by_byte() {
        let noise: Vec<u8> = (0..20_000_u32).map(|at| at.wrapping_mul(0x9E37_79B9).to_be_bytes()[0]).collect();
        for bytes in [noise, vec![0xFF; 20_000], vec![0xFE; 20_000], vec![1; 20_000]] {
            for length in (0..300).chain([4095, 4096, 4097, 8192, 8193, 20_000]) {
                assert_eq!(fletcher16(&bytes[..length]), plain(&bytes[..length]), "{length}");
                let (head, tail) = bytes[..length].split_at(length / 3);
                assert_eq!(fletcher16_more(fletcher16_more(EMPTY_SUM, head), tail), plain(&bytes[..length]));
            }
        }
    }
}
