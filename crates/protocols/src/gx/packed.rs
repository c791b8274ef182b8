//! Numbers as bytes with the high bit set: seven bits each, the least significant group first (the proposal's
//! `PackIntoCPPacked7`, `14` and `28`).

/// The high bit, by which binary values differ from everything that is ASCII.
pub const HIGH: u8 = 0x80;
/// Positions that 28 bits hold, in steps.
pub const POSITION_MIN: i32 = -(1 << 27);
/// See [`POSITION_MIN`].
pub const POSITION_MAX: i32 = (1 << 27) - 1;
/// The least delta that 7 bits hold. It is decoded, but not written: the proposal speaks of 63 steps either way.
pub const DELTA_MIN: i32 = -64;
/// The largest delta, in steps.
pub const DELTA_MAX: i32 = 63;
/// The largest velocity, in steps per second: 14 bits.
pub const VELOCITY_MAX: u16 = 0x3FFF;
/// The largest command number: 14 bits.
pub const NUMBER_MAX: u16 = 0x3FFF;
/// The longest time between two position reports, in milliseconds: 14 bits.
pub const PERIOD_MAX: u16 = 0x3FFF;
/// The largest code of an error notice: 7 bits.
pub const CODE_MAX: u8 = 0x7F;

/// Whether 28 bits hold a position: its highest byte is -8 to 7 then.
#[inline(always)]
pub const fn is_position(value: i32) -> bool {
    let [_, _, _, high] = value.to_le_bytes();
    high.wrapping_add(8) < 16
}

/// Whether a delta can be written.
#[inline(always)]
pub const fn is_delta(value: i32) -> bool {
    value.wrapping_add(DELTA_MAX).cast_unsigned() <= DELTA_MAX.cast_unsigned() << 1
}

/// The lowest seven bits.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "that is what it does")]
pub const fn low(value: u32) -> u8 {
    value as u8 & !HIGH
}

/// The seven lower bits of 14, and the seven upper ones.
#[inline(always)]
pub const fn halves(value: u16) -> [u8; 2] {
    let value = value as u32;
    [low(value), low(value >> 7)]
}

/// Seven bits after another as they arrive: the last ones that came are the highest.
#[inline(always)]
pub const fn push(groups: u32, byte: u8) -> u32 {
    groups >> 7 | (byte as u32) << 25
}

/// The signed value of one group. Of the byte, as small machines shift 32 bits one by one.
#[inline(always)]
pub const fn signed7(byte: u8) -> i32 {
    ((byte << 1).cast_signed() >> 1) as i32
}

/// The signed value of the last four groups.
#[inline(always)]
pub const fn signed28(groups: u32) -> i32 {
    groups.cast_signed() >> 4
}

/// The value of the last two groups.
#[inline(always)]
pub const fn unsigned14(groups: u32) -> u16 {
    (groups >> 18) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pushed(bytes: &[u8]) -> u32 {
        bytes.iter().fold(0, |bytes, byte| push(bytes, *byte))
    }

    #[test]
    fn the_vectors_of_the_long_form() {
        for (value, bytes) in [
            (1000, [0xE8, 0x87, 0x80, 0x80]),
            (-1000, [0x98, 0xF8, 0xFF, 0xFF]),
            (0, [0x80; 4]),
            (-1, [0xFF; 4]),
            (POSITION_MAX, [0xFF, 0xFF, 0xFF, 0xBF]),
            (POSITION_MIN, [0x80, 0x80, 0x80, 0xC0]),
            (2_097_152, [0x80, 0x80, 0x80, 0x81]),
        ] {
            assert_eq!(signed28(pushed(&bytes)), value);
        }
    }

    #[test]
    fn positions_have_28_bits() {
        for (value, fits) in [(POSITION_MIN, true), (POSITION_MIN - 1, false), (i32::MIN, false), (i32::MAX, false)] {
            assert!(is_position(value) == fits && is_position(-1 - value) == fits, "{value}");
        }
    }

    #[test]
    fn every_delta_and_every_velocity() {
        for delta in DELTA_MIN..=DELTA_MAX {
            assert_eq!(signed7(low(delta.cast_unsigned()) | HIGH), delta);
        }
        for velocity in 0..=VELOCITY_MAX {
            assert_eq!(unsigned14(pushed(&halves(velocity).map(|half| half | HIGH))), velocity);
        }
        assert_eq!(halves(1000), [0x68, 0x07]);
    }
}
