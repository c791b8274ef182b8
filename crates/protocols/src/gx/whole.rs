//! The short way for hosts: the binary commands that most streams consist of, vectors of the first axes without a gap,
//! with or without a number, where they lie whole in what was received. No step for each byte.
//!
//! All else is left to the [`Scanner`](super::Scanner), which defines what bytes mean.

use core::ffi::c_int;

use super::command::{AXES, Format, Item, MASK_AXES, MOVE, NumberField, STEP};
use super::packed::{FOUR_HIGH, signed, unpack28};

const HIGHS: u64 = 0x8080_8080_8080_8080;
const NONE: NumberField = NumberField { value: 0, format: 0 };

/// Reads a vector of x and y, or deltas of x, y and z or of all axes, if `bytes` begin with one. Tells the length of
/// the command: 0 if it is not there whole, `None` if it is another.
#[inline(always)]
pub(super) fn read_frequent(bytes: &[u8], item: &mut Item) -> Option<usize> {
    let Some(first) = bytes.first_chunk() else { return Some(0) };
    let head = u32::from_le_bytes(*first);
    if let Some(size) = read_plane(bytes, head, NONE, item) {
        return Some(size);
    }
    let Some((number, rest)) = numbered(bytes) else { return read_short(bytes, head, NONE, item) };
    let Some(first) = rest.first_chunk() else { return Some(0) };
    let head = u32::from_le_bytes(*first);
    let size = match read_plane(rest, head, number, item) {
        None => read_short(rest, head, number, item)?,
        Some(size) => size,
    };
    Some(if size == 0 { 0 } else { size.wrapping_add(3) })
}

/// Reads one of the others, if `bytes` begin with one. Tells the length of the command, else 0.
#[inline(always)]
pub(super) fn read_row(bytes: &[u8], item: &mut Item) -> usize {
    let (number, rest) = numbered(bytes).unwrap_or((NONE, bytes));
    let Some(start) = rest.first_chunk() else { return 0 };
    // The mask, and before it the start byte.
    let size = match u16::from_le_bytes(*start) {
        0x812A => read_deltas::<3>(rest, number, item),
        0x8F2A => read_deltas::<6>(rest, number, item),
        0x9F2A => read_deltas::<7>(rest, number, item),
        0x8121 => read_positions::<1>(rest, number, item),
        0x8721 => read_positions::<3>(rest, number, item),
        0x8F21 => read_positions::<4>(rest, number, item),
        0x9F21 => read_positions::<5>(rest, number, item),
        0xBF21 => read_positions::<6>(rest, number, item),
        _ => 0,
    };
    if size == 0 { 0 } else { size.wrapping_add(bytes.len()).wrapping_sub(rest.len()) }
}

/// The packed number that `bytes` begin with, and what is behind it.
#[inline(always)]
fn numbered(bytes: &[u8]) -> Option<(NumberField, &[u8])> {
    let (first, _) = bytes.split_first_chunk()?;
    let head = u32::from_le_bytes(*first);
    if head & 0x0080_80FF != 0x0080_8023 {
        return None;
    }
    let [low, high, ..] = (head >> 8 & 0x7F | head >> 9 & 0x3F80).to_le_bytes();
    let number = NumberField { value: u16::from_le_bytes([low, high]), format: Format::Binary as u8 };
    Some((number, bytes.get(3..)?))
}

/// Reads a vector of x and y, without velocity, if `bytes` begin with that; `head` is their first four.
/// Tells the length, 0 where it is not there whole.
#[inline(always)]
fn read_plane(bytes: &[u8], head: u32, number: NumberField, item: &mut Item) -> Option<usize> {
    if head & 0x8080_FFFF == 0x8080_832A {
        item.number = number;
        fill(item, STEP, 3);
        put_plane(item, (head << 9).cast_signed() >> 25, (head << 1).cast_signed() >> 25);
        return Some(4);
    }
    if head & 0xFFFF != 0x8321 {
        return None;
    }
    let Some(groups) = bytes.get(2..).and_then(<[u8]>::first_chunk) else { return Some(0) };
    let groups = u64::from_le_bytes(*groups);
    if groups & HIGHS != HIGHS {
        return Some(0);
    }
    item.number = number;
    fill(item, MOVE, 3);
    put_plane(item, signed(unpack28(half(groups)), false), signed(unpack28(half(groups >> 32)), false));
    Some(10)
}

/// Reads deltas of x, y and z or of all axes, without velocity, as [`read_plane`] does.
#[inline(always)]
fn read_short(bytes: &[u8], head: u32, number: NumberField, item: &mut Item) -> Option<usize> {
    match head & 0xFFFF {
        0xBF2A => Some(read_deltas::<8>(bytes, number, item)),
        0x872A => Some(read_deltas::<5>(bytes, number, item)),
        _ => None,
    }
}

/// Reads a vector of deltas of that size.
#[inline(always)]
fn read_deltas<const SIZE: usize>(bytes: &[u8], number: NumberField, item: &mut Item) -> usize {
    let unused = 8_usize.wrapping_sub(SIZE);
    let word = match (bytes.first_chunk(), bytes.first_chunk::<SIZE>()) {
        (Some(eight), _) => u64::from_le_bytes(*eight),
        (None, Some(bytes)) => bytes.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte)),
        (None, None) => return 0,
    };
    let deltas = word << unused.wrapping_shl(3) >> unused.wrapping_shl(3) >> 16;
    if deltas & HIGHS != HIGHS >> 16 >> unused.wrapping_shl(3) {
        return 0;
    }
    item.number = number;
    fill(item, STEP, MASK_AXES >> unused);
    // So much more than they are, and so no negative ones.
    let more = deltas & !HIGHS ^ 0x4040_4040_4040_4040;
    item.vector.axes = [0; AXES];
    for (place, more) in item.vector.axes.iter_mut().zip(more.to_le_bytes()).take(SIZE.wrapping_sub(2)) {
        *place = i32::from(more).wrapping_sub(0x40);
    }
    SIZE
}

/// Reads a vector of so many positions.
#[inline(always)]
fn read_positions<const COUNT: usize>(bytes: &[u8], number: NumberField, item: &mut Item) -> usize {
    let (groups, _) = bytes.get(2..).unwrap_or_default().as_chunks();
    let Some(groups) = groups.first_chunk::<COUNT>() else { return 0 };
    let groups = groups.map(u32::from_le_bytes);
    if groups.iter().fold(FOUR_HIGH, |all, groups| all & groups) != FOUR_HIGH {
        return 0;
    }
    item.number = number;
    fill(item, MOVE, MASK_AXES >> AXES.wrapping_sub(COUNT));
    item.vector.axes = [0; AXES];
    for (place, groups) in item.vector.axes.iter_mut().zip(groups) {
        *place = signed(unpack28(groups), false);
    }
    (COUNT << 2).wrapping_add(2)
}

/// Fills in all but the number and the axes.
#[inline(always)]
fn fill(item: &mut Item, kind: c_int, mask: u8) {
    item.kind = kind;
    item.format = Format::Binary as u8;
    item.code = 0;
    item.period = 0;
    item.vector.velocity = 0;
    item.vector.mask = mask;
}

#[inline(always)]
fn put_plane(item: &mut Item, x: i32, y: i32) {
    item.vector.axes = [0; AXES];
    let [x_place, y_place, ..] = &mut item.vector.axes;
    (*x_place, *y_place) = (x, y);
}

/// The lower half.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "that is what it does")]
const fn half(word: u64) -> u32 {
    word as u32
}

#[cfg(test)]
mod tests {
    use crate::gx::{CommandReceiver, ENCODED_MAX, Format, Item, MASK_AXES, Number, Vector, write_move, write_step};
    use proptest::prelude::*;
    use std::vec::Vec;

    /// What is told of these bytes when they come in pieces of this size.
    fn told(bytes: &[u8], size: usize) -> Vec<Item> {
        let (mut receiver, mut items) = (CommandReceiver::new(), Vec::new());
        for piece in bytes.chunks(size) {
            let mut rest = piece;
            while !rest.is_empty() {
                let mut item = Item::new();
                rest = &rest[receiver.receive(rest, &mut item)..];
                items.extend(item.message().is_some().then_some(item));
            }
        }
        items
    }

    /// Binary moves, most of them of the first axes and without velocity, as they are taken here.
    fn moves() -> impl Strategy<Value = Vec<u8>> {
        let mask = prop_oneof![3 => (1..=6).prop_map(|count| MASK_AXES >> (6 - count)), 1 => 1..=0x7F_u8];
        let number = prop::option::of((0..=16383_u16).prop_map(|value| Number { value, format: Format::Binary }));
        (mask, number, any::<bool>(), prop::array::uniform6(-63..=63), 0..=2_000_000).prop_map(
            |(mask, number, is_short, deltas, scale)| {
                let mut vector = Vector { velocity: 9, mask, axes: deltas };
                let mut room = [0; ENCODED_MAX];
                let length = if is_short {
                    write_step(number, &vector, &mut room)
                } else {
                    vector.axes = deltas.map(|delta| delta * scale);
                    write_move(Format::Binary, number, &vector, &mut room)
                };
                room[..length.unwrap()].to_vec()
            },
        )
    }

    proptest! {
        /// Byte by byte, all goes to the scanner.
        #[test]
        fn whole_commands_mean_what_their_bytes_do(
            moves in prop::collection::vec(moves(), 1..20),
            damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
        ) {
            let mut bytes = moves.concat();
            for (place, byte) in damage {
                let place = place.index(bytes.len());
                bytes[place] = byte;
            }
            let expected = told(&bytes, 1);
            for size in [2, 3, 5, 13, 26, 64, bytes.len()] {
                prop_assert_eq!(told(&bytes, size), expected.clone());
            }
        }
    }
}
