//! Status reports, and in which of two layouts they are written (specification, section "Status Report").

use zerocopy::{FromBytes, Immutable, KnownLayout, TryFromBytes};

use super::{POSITION_SIZE, Position};

/// Bytes of a status report that say something; the specification's has no others.
pub(super) const REPORT_SIZE: usize = POSITION_SIZE.wrapping_add(1);

/// Where STAT stands in a status report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, TryFromBytes)]
#[repr(u8)]
pub enum Layout {
    /// Reading: more than 13 bytes are [`Firmware`](Self::Firmware)'s. 13 bytes may be either's: firmware like the
    /// shipped one sends so many where structs are not padded, as on AVR. Both readings are rated by what is plausible
    /// in them: STAT, when its reserved bits (5 to 7) are alike, all zero as this library sends them or all one as
    /// shipped firmware does; each displacement that is zero or of a magnitude from 1.1e-19 to 3.6e19, as the topmost
    /// byte of such a float, but for zero's, can't be STAT; and twice as much, each that is unknown, the NaN of shipped
    /// firmware, 0x7F800001, or that of most processors, 0x7FC00000, with either sign.
    ///
    /// The better reading is taken; of equal ones, [`Firmware`](Self::Firmware)'s, since nobody is known to send the
    /// other. A session, which has a [`SeenLayout`], takes the layout of the last report that was clear (of 14 bytes or
    /// more, or better by two), unless this one is clear too.
    ///
    /// Writing: as [`Firmware`](Self::Firmware), which no reader takes for anything else.
    #[default]
    Auto = 0,
    /// Specification v1.0: STAT, A, B, C; exactly 13 bytes.
    Spec = 1,
    /// Shipped firmware: A, B, C, STAT. Written as 16 bytes, the padding zero; read from 13 bytes on.
    Firmware = 2,
}

impl Layout {
    /// The layout that is stored as this number; [`Auto`](Self::Auto) where it is none's.
    pub fn of(stored: u8) -> Self {
        Self::try_read_from_bytes(&[stored]).unwrap_or_default()
    }
}

/// What the platform is doing: bits 0 and 1 of STAT.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum State {
    /// Nothing.
    Idle = 0,
    /// Homing.
    Homing = 1,
    /// Moving. (The specification misprints "homing".)
    Moving = 2,
    /// In error: nothing but a status request is fulfilled.
    Error = 3,
}

/// A status report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromBytes, Immutable, KnownLayout)]
pub struct Report {
    /// Where the platform is, if it knows.
    pub position: Position,
    stat: u8,
}

impl Report {
    /// The bits of STAT that mean something: state and end stops. The others are reserved.
    const STAT_BITS: u8 = 0x1F;

    /// A report of that position and STAT, whose reserved bits are cleared.
    #[inline]
    pub const fn new(position: Position, stat: u8) -> Self {
        Self { position, stat: stat & Self::STAT_BITS }
    }

    /// STAT, the reserved bits zero. Bits 2 to 4 are the end stops of the arms A to C, 1 when pressed.
    #[inline]
    pub const fn stat(&self) -> u8 {
        self.stat & Self::STAT_BITS
    }

    /// What the platform is doing.
    pub const fn state(&self) -> State {
        match self.stat & 3 {
            0 => State::Idle,
            1 => State::Homing,
            2 => State::Moving,
            _ => State::Error,
        }
    }

    /// Reads a payload; `None` when its length is wrong for the layout.
    pub fn read(payload: &[u8], layout: Layout) -> Option<Self> {
        Self::read_after(payload, layout, &mut SeenLayout::default())
    }

    /// The same in a session: where the payload may have either layout, what was seen before counts too.
    pub fn read_after(payload: &[u8], layout: Layout, seen: &mut SeenLayout) -> Option<Self> {
        let is_short = payload.len() == REPORT_SIZE;
        let stat_first = match layout {
            Layout::Auto if is_short => seen.is_stat_first(payload)?,
            Layout::Auto => {
                seen.0 = Layout::Firmware as u8;
                false
            }
            Layout::Spec if !is_short => return None,
            Layout::Spec => true,
            Layout::Firmware => false,
        };
        let (position, stat) = parts(payload, stat_first)?;
        Some(Self::new(position, stat))
    }
}

/// What the clear ones of a session's reports have shown of their layout. All zero: nothing yet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromBytes, Immutable, KnownLayout)]
pub struct SeenLayout(u8);

impl SeenLayout {
    /// Whether 13 bytes begin with STAT: see [`Layout::Auto`].
    fn is_stat_first(&mut self, payload: &[u8]) -> Option<bool> {
        let (spec, firmware) = (rating(payload, true)?, rating(payload, false)?);
        if spec.abs_diff(firmware) > 1 {
            self.0 = if spec > firmware { Layout::Spec } else { Layout::Firmware } as u8;
        }
        Some(match Layout::of(self.0) {
            Layout::Auto => spec > firmware,
            seen => seen == Layout::Spec,
        })
    }
}

/// Position and STAT in one of the layouts.
fn parts(payload: &[u8], stat_first: bool) -> Option<(Position, u8)> {
    let &[first, .., last] = payload.first_chunk::<REPORT_SIZE>()?;
    let position = Position::read(payload.get(usize::from(stat_first)..)?)?;
    Some((position, if stat_first { first } else { last }))
}

/// How plausible that layout is, 0 to 7: see [`Layout::Auto`].
fn rating(payload: &[u8], stat_first: bool) -> Option<u8> {
    let (position, stat) = parts(payload, stat_first)?;
    let mut rating = u8::from(matches!(stat & !Report::STAT_BITS, 0 | 0xE0));
    for bits in position.0 {
        rating = rating.wrapping_add(match bits & 0x7FFF_FFFF {
            0 | 0x2000_0000..0x6000_0000 => 1,
            0x7FC0_0000 | 0x7F80_0001 => 2,
            _ => 0,
        });
    }
    Some(rating)
}

#[cfg(test)]
mod tests {
    use super::{Layout, Position, Report, SeenLayout, State};
    use proptest::{prelude::Rng, test_runner::TestRunner};

    const REPORT: Report = Report::new(Position([0x3F80_0000, 0x7F80_0001, 0xC060_0000]), 0b0001_0110);
    const FIRMWARE: [u8; 16] = [0, 0, 0x80, 0x3F, 1, 0, 0x80, 0x7F, 0, 0, 0x60, 0xC0, 0xF6, 0xDE, 0xAD, 0xBE];
    const SPEC: [u8; 13] = [0x16, 0, 0, 0x80, 0x3F, 1, 0, 0x80, 0x7F, 0, 0, 0x60, 0xC0];

    #[test]
    fn states_are_the_two_lowest_bits_and_reserved_ones_are_masked() {
        for (bits, state) in [(0, State::Idle), (1, State::Homing), (2, State::Moving), (3, State::Error)] {
            let report = Report::new(Position::UNKNOWN, 0xFC | bits);
            assert_eq!((report.state(), report.stat()), (state, 0x1C | bits));
        }
        assert_eq!(Report::read(&FIRMWARE, Layout::Auto).unwrap().stat(), 0x16);
    }

    #[test]
    fn more_than_13_bytes_are_floats_first_and_fewer_are_none() {
        for length in 0..=32 {
            let mut bytes = [0xE1; 32];
            bytes[..16].copy_from_slice(&FIRMWARE);
            for layout in [Layout::Auto, Layout::Firmware] {
                assert_eq!(Report::read(&bytes[..length], layout) == Some(REPORT), length >= 13, "{length}");
            }
            assert_eq!(Report::read(&bytes[..length], Layout::Spec).is_some(), length == 13, "{length}");
        }
    }

    #[test]
    fn a_session_remembers_the_layout_of_clear_reports() {
        // As STAT first: a tiny A. As floats first: STAT and a tiny C. Nothing is clear.
        let unclear = [0, 0, 0, 0, 0x01, 0, 0, 0, 0, 0, 0, 0, 0x01];
        let read = |seen: &mut SeenLayout, payload: &[u8]| Report::read_after(payload, Layout::Auto, seen).unwrap();
        let as_layout = |layout| Report::read(&unclear, layout).unwrap();
        assert_ne!(as_layout(Layout::Spec), as_layout(Layout::Firmware));

        let mut seen = SeenLayout::default();
        let alone = read(&mut seen, &unclear);
        assert_eq!((alone, seen), (Report::read(&unclear, Layout::Auto).unwrap(), SeenLayout::default()));
        assert_eq!(read(&mut seen, &SPEC), REPORT);
        assert_eq!(read(&mut seen, &unclear), as_layout(Layout::Spec));
        assert_eq!(read(&mut seen, &FIRMWARE), REPORT);
        assert_eq!(read(&mut seen, &unclear), as_layout(Layout::Firmware));
        assert_eq!(read(&mut seen, &SPEC), REPORT);
        assert_eq!(read(&mut seen, &FIRMWARE[..13]), REPORT);
        assert_eq!(read(&mut seen, &unclear), as_layout(Layout::Firmware));
    }

    /// A float of a magnitude below `limit`.
    #[expect(clippy::cast_precision_loss, reason = "any float will do")]
    fn below(random: u32, limit: f32) -> u32 {
        (random.cast_signed() as f32 / 2_147_483_648.0 * limit).to_bits()
    }

    fn steps(random: u32) -> u32 {
        (f32::from(u16::try_from(random >> 20).unwrap()) * 2.5 - 2000.0).to_bits()
    }

    /// Positions that a kind of robot reports, of random numbers, and how many in 16,000 have to be read right: alone,
    /// and in a session that reports nothing else.
    type Kind = (&'static str, fn([u32; 3]) -> [u32; 3], u32, u32);

    const KINDS: [Kind; 13] = [
        ("up to 1000", |random| random.map(|it| below(it, 1000.0)), 16_000, 16_000),
        ("up to 1e-15", |random| random.map(|it| below(it, 1e-15)), 15_984, 16_000),
        ("up to 1e19", |random| random.map(|it| below(it, 1e19)), 16_000, 16_000),
        ("encoder steps", |random| random.map(steps), 16_000, 16_000),
        ("some arms zero", |random| random.map(|it| if it % 2 == 0 { 0 } else { steps(it) }), 16_000, 16_000),
        ("minus zero", |random| random.map(|it| it & 0x8000_0000), 16_000, 16_000),
        ("zero", |_| [0; 3], 16_000, 16_000),
        ("signalling NaN", |_| [0x7F80_0001; 3], 16_000, 16_000),
        ("NaN", |_| [0x7FC0_0000; 3], 16_000, 16_000),
        ("minus NaN", |_| [0xFFC0_0000; 3], 16_000, 16_000),
        ("one signalling NaN", |[a, _, c]| [steps(a), 0x7F80_0001, steps(c)], 16_000, 16_000),
        ("one minus NaN", |[a, b, _]| [steps(a), steps(b), 0xFFC0_0000], 16_000, 16_000),
        ("any bits", |random| random, 8_800, 12_800),
    ];

    #[test]
    fn reports_of_13_bytes_are_read_as_they_were_meant() {
        let mut random = TestRunner::deterministic().new_rng();
        for (name, position, least_alone, least_in_session) in KINDS {
            for (stat_first, reserved) in [(true, 0), (true, 0xE0), (false, 0), (false, 0xE0)] {
                let (mut alone, mut in_session, mut seen) = (0, 0, SeenLayout::default());
                // All states and end stops.
                for stat in (0..32).cycle().take(16_000) {
                    let report = Report::new(Position(position(random.random())), stat);
                    let (stat, floats) = ([stat | reserved], report.position.to_wire());
                    let payload =
                        if stat_first { [&stat[..], &floats].concat() } else { [&floats[..], &stat].concat() };
                    alone += u32::from(Report::read(&payload, Layout::Auto) == Some(report));
                    in_session += u32::from(Report::read_after(&payload, Layout::Auto, &mut seen) == Some(report));
                }
                assert!(alone >= least_alone && in_session >= least_in_session, "{name}: {alone}, {in_session}");
            }
        }
    }
}
