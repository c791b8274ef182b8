//! The short way for hosts: the binary commands that most streams consist of, moves of x and y and short ones of all
//! axes, where they lie whole in what was received. No step for each byte, and none for each axis.
//!
//! All else is left to the [`Scanner`](super::Scanner), which defines what bytes mean.

use core::ffi::c_int;

use super::command::{AXES, Format, Item, MASK_AXES, MOVE, NumberField, STEP};
use super::packed::{FOUR_HIGH, HIGH, signed, unpack28};

const HIGHS: u64 = 0x8080_8080_8080_8080;
const NONE: NumberField = NumberField { value: 0, format: 0 };

/// Reads a vector of x and y, or deltas of all axes, if `bytes` begin with that. Tells the length of the command, else
/// 0.
#[inline(always)]
pub(super) fn read_frequent(bytes: &[u8], item: &mut Item) -> usize {
    let Some(first) = bytes.first_chunk() else { return 0 };
    let head = u32::from_le_bytes(*first);
    if let Some(length) = read_plane(bytes, head, NONE, item) {
        return length;
    }
    if head & 0xFFFF == 0xBF2A
        && let Some(first) = bytes.first_chunk()
    {
        let word = u64::from_le_bytes(*first);
        if word >> 16 & HIGHS == HIGHS >> 16 {
            item.number = NONE;
            fill(item, STEP, MASK_AXES);
            put_deltas(word >> 16, item);
            return 8;
        }
    }
    if let Some((number, rest)) = numbered(bytes)
        && let Some(first) = rest.first_chunk()
        && let Some(length) = read_plane(rest, u32::from_le_bytes(*first), number, item)
    {
        return length.wrapping_add(3);
    }
    0
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

/// Reads a vector of the first axes without a gap, as [`read_frequent`] does.
#[inline(always)]
pub(super) fn read_row(bytes: &[u8], item: &mut Item) -> usize {
    // Filled in at once, so that it need not be carried along.
    item.number = NONE;
    let mut rest = bytes;
    if let Some((number, behind)) = numbered(bytes) {
        item.number = number;
        rest = behind;
    }
    let Some((&[start, mask], values)) = rest.split_first_chunk() else { return 0 };
    let count = (!mask).trailing_zeros();
    // A packed byte, without velocity, and without a gap between the axes that there are.
    if mask.wrapping_shr(count) != HIGH.wrapping_shr(count) || mask <= HIGH {
        return 0;
    }
    let size = match start {
        b'*' => read_deltas(rest, count, item).map(|()| count as usize),
        b'!' => read_positions(values, count as usize, item).map(|()| (count as usize) << 2),
        _ => None,
    };
    let Some(size) = size else { return 0 };
    fill(item, if start == b'*' { STEP } else { MOVE }, mask & MASK_AXES);
    size.wrapping_add(bytes.len()).wrapping_sub(values.len())
}

/// Reads so many deltas, behind two bytes.
#[inline(always)]
fn read_deltas(bytes: &[u8], count: u32, item: &mut Item) -> Option<()> {
    let word = match bytes.first_chunk() {
        Some(eight) => u64::from_le_bytes(*eight),
        // Bytes that are not there are no packed ones.
        None => bytes.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte)),
    };
    let these = !(u64::MAX.wrapping_shl(count << 3));
    let deltas = word >> 16 & these;
    if deltas & HIGHS != these & HIGHS {
        return None;
    }
    put_deltas(deltas, item);
    Some(())
}

/// Fills in the deltas of a word, the first one lowest, zeros behind the last one.
#[inline(always)]
fn put_deltas(deltas: u64, item: &mut Item) {
    // So much more than they are, and so no negative ones.
    let more = deltas & !HIGHS ^ 0x4040_4040_4040_4040;
    for (place, more) in item.vector.axes.iter_mut().zip(more.to_le_bytes()) {
        *place = i32::from(more).wrapping_sub(0x40);
    }
}

/// Reads so many positions.
#[inline(always)]
fn read_positions(bytes: &[u8], count: usize, item: &mut Item) -> Option<()> {
    let (groups, _) = bytes.as_chunks();
    let groups = groups.get(..count)?;
    let mut all = FOUR_HIGH;
    item.vector.axes = [0; AXES];
    for (place, groups) in item.vector.axes.iter_mut().zip(groups) {
        let groups = u32::from_le_bytes(*groups);
        all &= groups;
        *place = signed(unpack28(groups), false);
    }
    (all == FOUR_HIGH).then_some(())
}

/// Reads a vector of x and y, without velocity; `head` is its first four bytes.
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
    let [_, _, groups @ ..] = bytes else { return None };
    let groups = u64::from_le_bytes(*groups.first_chunk()?);
    if groups & HIGHS != HIGHS {
        return None;
    }
    item.number = number;
    fill(item, MOVE, 3);
    put_plane(item, signed(unpack28(half(groups)), false), signed(unpack28(half(groups >> 32)), false));
    Some(10)
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
