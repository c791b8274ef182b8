//! What the sessions of the three protocols share: a clock that wraps, timeouts, retransmission, sets of flags (pending
//! events among them) and statistics.
//!
//! Times are milliseconds of the caller's clock, of which the lowest 32 bits count: they may wrap.
//!
//! All of this is kept in the sessions' state, which callers may hand over with any contents. So it consists of
//! integers, and every value of them means something.

use core::marker::PhantomData;

use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// How much of `span` is left at `now` when it began at `since`; 0 when it is over.
#[cfg_attr(target_pointer_width = "16", inline(never))]
pub const fn left(now: u32, since: u32, span: u32) -> u32 {
    span.saturating_sub(now.wrapping_sub(since))
}

/// The duration that a setting stands for, where 0 is the default. At most half of what wraps, so that its end is
/// noticed.
#[cfg_attr(target_pointer_width = "16", inline(never))]
pub const fn span(setting: u32, default: u32) -> u32 {
    match setting {
        0 => default,
        1..=LONGEST => setting,
        _ => LONGEST,
    }
}

const LONGEST: u32 = 0x7FFF_FFFF;

/// The number of times that a setting stands for, where 0 is the default and what is below 0 stands for `negative`.
pub fn times(setting: i16, default: u8, negative: u8) -> u8 {
    match setting {
        ..0 => negative,
        0 => default,
        _ => u8::try_from(setting).unwrap_or(u8::MAX),
    }
}

/// Counts up; wraps at 2^32.
#[cfg_attr(target_pointer_width = "16", inline(never))]
pub const fn count(counter: &mut u32) {
    *counter = counter.wrapping_add(1);
}

/// Something that is sent until it is answered or was sent often enough: when it was sent last, and how often.
///
/// Round trips are measured by what was [`sent`](Self::sent) once alone: of others it is not known which transmission
/// was answered.
#[derive(Clone, Copy, Debug, Default, FromBytes, Immutable, KnownLayout)]
pub struct Transmission {
    /// When it was sent last; kept when something else is to be sent.
    pub sent_at: u32,
    /// How often it was sent, up to 255.
    pub sent: u8,
}

impl Transmission {
    /// It is sent, for the first time or again.
    pub const fn send(&mut self, now: u32) {
        self.sent_at = now;
        self.sent = self.sent.saturating_add(1);
    }

    /// How long ago it was sent last.
    pub const fn elapsed(&self, now: u32) -> u32 {
        now.wrapping_sub(self.sent_at)
    }

    /// How much of `timeout` is left since it was sent last.
    pub const fn left(&self, now: u32, timeout: u32) -> u32 {
        left(now, self.sent_at, timeout)
    }
}

/// A flag that can be in a set of [`Flags`]; `flags!` makes such a type.
pub trait Flag: Copy {
    /// The bits of all flags.
    const ALL: u16;

    /// The flag's bit.
    fn bit(self) -> u16;

    /// The flag that has this bit.
    fn of_bit(bit: u16) -> Option<Self>;
}

/// A set of flags in an integer. Bits that stand for no flag are ignored.
#[derive(Clone, Copy, Debug, FromBytes, Immutable, KnownLayout)]
#[repr(transparent)]
pub struct Flags<F> {
    bits: u16,
    flag: PhantomData<F>,
}

impl<F: Flag> Flags<F> {
    /// Whether there is no flag.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.bits & F::ALL == 0
    }

    /// Whether the flag is set.
    #[inline]
    pub fn has(self, flag: F) -> bool {
        self.bits & flag.bit() != 0
    }

    /// Sets the flag.
    #[inline]
    pub fn set(&mut self, flag: F) {
        self.bits |= flag.bit();
    }

    /// Clears the flag.
    #[inline]
    pub fn clear(&mut self, flag: F) {
        self.bits &= !flag.bit();
    }

    /// Sets or clears the flag.
    #[inline]
    pub fn set_to(&mut self, flag: F, is_set: bool) {
        self.clear(flag);
        if is_set {
            self.set(flag);
        }
    }

    /// The first flag that is set, in the order in which they are declared.
    #[inline]
    pub fn first(self) -> Option<F> {
        let bits = self.bits & F::ALL;
        // The lowest bit: smaller than to count zeros where the processor can't.
        F::of_bit(bits & bits.wrapping_neg())
    }

    /// Clears the first flag that is set and returns it: the pump of pending events.
    #[inline]
    pub fn take_first(&mut self) -> Option<F> {
        let first = self.first()?;
        self.clear(first);
        Some(first)
    }
}

impl<F> Default for Flags<F> {
    fn default() -> Self {
        Self { bits: 0, flag: PhantomData }
    }
}

/// Declares an enum of at most 16 flags, of which [`Flags`] makes sets.
macro_rules! flags {
    ($(#[$attribute:meta])* $visibility:vis enum $name:ident { $($(#[$about:meta])* $flag:ident),+ $(,)? }) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        $visibility enum $name { $($(#[$about])* $flag),+ }

        impl $crate::session::Flag for $name {
            const ALL: u16 = 0 $(| 1 << Self::$flag as u8)+;

            #[inline]
            fn bit(self) -> u16 {
                1_u16.wrapping_shl(self as u32)
            }

            #[inline]
            fn of_bit(bit: u16) -> Option<Self> {
                $(if bit == 1 << Self::$flag as u8 {
                    return Some(Self::$flag);
                })+
                None
            }
        }
    };
}
pub(crate) use flags;

/// Statistics of round-trip times, in milliseconds.
#[derive(Clone, Copy, Debug, Default, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct RoundTrips {
    /// How many were measured.
    pub count: u32,
    /// The last one.
    pub last: u32,
    /// The shortest, when there was one.
    pub min: u32,
    /// The longest.
    pub max: u32,
    /// All of them together; wraps at 2^32.
    pub sum: u32,
}

impl RoundTrips {
    /// Adds a measured one.
    pub const fn add(&mut self, time: u32) {
        self.last = time;
        if self.count == 0 || time < self.min {
            self.min = time;
        }
        if time > self.max {
            self.max = time;
        }
        self.sum = self.sum.wrapping_add(time);
        count(&mut self.count);
    }
}

#[cfg(test)]
mod tests {
    use super::{Flag, Flags, RoundTrips, Transmission, left, span, times};
    use zerocopy::FromBytes;

    #[test]
    fn time_wraps() {
        assert_eq!(left(100, 90, 50), 40);
        assert_eq!(left(140, 90, 50), 0);
        assert_eq!(left(5, u32::MAX - 4, 50), 40);
        assert_eq!(left(45, u32::MAX - 4, 50), 0);
    }

    #[test]
    fn settings_have_defaults_and_a_limit() {
        assert_eq!((span(0, 500), span(3, 500), span(u32::MAX, 500)), (500, 3, 0x7FFF_FFFF));
        assert_eq!([-1, 0, 1, 255, 256, i16::MAX].map(|setting| times(setting, 4, 9)), [9, 4, 1, 255, 255, 255]);
    }

    #[test]
    fn a_transmission_is_counted_and_timed() {
        let mut transmission = Transmission::default();
        transmission.send(10);
        transmission.send(u32::MAX);
        assert_eq!((transmission.sent, transmission.sent_at), (2, u32::MAX));
        assert_eq!((transmission.elapsed(4), transmission.left(4, 12)), (5, 7));
        (0..300).for_each(|now| transmission.send(now));
        assert_eq!((transmission.sent, transmission.sent_at), (255, 299));
    }

    flags! {
        enum Notice { Early, Middle, Late }
    }

    #[test]
    fn flags_come_out_in_their_order() {
        let mut pending = Flags::default();
        assert!(pending.is_empty());
        pending.set(Notice::Late);
        pending.set(Notice::Early);
        assert!(pending.has(Notice::Late) && !pending.has(Notice::Middle) && !pending.is_empty());
        assert_eq!(pending.first(), Some(Notice::Early));
        assert_eq!([(); 3].map(|()| pending.take_first()), [Some(Notice::Early), Some(Notice::Late), None]);
        for is_set in [true, true, false, false] {
            pending.set_to(Notice::Middle, is_set);
            assert_eq!(pending.has(Notice::Middle), is_set);
        }
        assert!(pending.is_empty());
    }

    #[test]
    fn any_contents_are_a_set() {
        for bits in 0..=u16::MAX {
            let mut set = Flags::<Notice>::read_from_bytes(&bits.to_ne_bytes()).unwrap();
            assert_eq!(set.is_empty(), bits.trailing_zeros() >= 3);
            let taken: Vec<_> = core::iter::from_fn(|| set.take_first()).map(Flag::bit).collect();
            assert_eq!(taken.iter().sum::<u16>(), bits & 7);
            assert!(taken.is_sorted() && set.is_empty());
        }
    }

    #[test]
    fn round_trips() {
        let mut times = RoundTrips::default();
        for time in [7, 3, 11] {
            times.add(time);
        }
        assert_eq!((times.count, times.last, times.min, times.max, times.sum), (3, 11, 3, 11, 21));
    }
}
