//! State that callers allocate: what C sees is room, what lies in it belongs to the core.

use crate::memory::zero;

/// What rooms consist of whose states hold pointers: in 64-bit Windows these are larger than a C `long`.
#[cfg(all(windows, target_pointer_width = "64"))]
pub(crate) type Word = usize;
/// What rooms consist of whose states hold pointers.
#[cfg(not(all(windows, target_pointer_width = "64")))]
pub(crate) type Word = core::ffi::c_ulong;

/// A struct of the C ABI that is nothing but room for a state of the core's.
///
/// # Safety
///
/// The struct has at least the size and alignment of the state. [`state!`] checks that.
pub(crate) unsafe trait Room: Sized {
    /// What lies in it. Any bytes are one; all zero is a new one.
    type State: zerocopy::FromBytes;

    /// The state in an object of C's, or `None` for NULL.
    ///
    /// # Safety
    ///
    /// room is NULL or points to a whole object, aligned and writable, which nobody else touches while the reference
    /// lives.
    #[inline(always)]
    unsafe fn get<'a>(room: *mut Self) -> Option<&'a mut Self::State> {
        // SAFETY: the object is large enough and aligned for a state, and any bytes are one (see Room).
        unsafe { room.cast::<Self::State>().as_mut() }
    }

    /// The same for an object that is only read.
    ///
    /// # Safety
    ///
    /// room is NULL or points to a whole object, aligned, which nobody writes while the reference lives.
    #[inline(always)]
    unsafe fn peek<'a>(room: *const Self) -> Option<&'a Self::State> {
        // SAFETY: as in get().
        unsafe { room.cast::<Self::State>().as_ref() }
    }

    /// Makes any memory a new state, or returns `None` for NULL.
    ///
    /// # Safety
    ///
    /// As for [`Room::get`].
    unsafe fn init<'a>(room: *mut Self) -> Option<&'a mut Self::State> {
        if room.is_null() {
            return None;
        }
        // SAFETY: the same contract.
        unsafe {
            zero(room);
            Self::get(room)
        }
    }
}

/// `state!(Host: core::Host<WINDOW>)` declares what lies in a `#[repr(C)] struct Host { opaque: [c_ulong; WORDS] }`.
macro_rules! state {
    ($room:ident: $state:ty) => {
        const _: () = {
            assert!(size_of::<$state>() <= size_of::<$room>(), "the room is too small for its state");
            assert!(align_of::<$state>() <= align_of::<$room>(), "the room is not aligned for its state");
        };
        // SAFETY: asserted above.
        unsafe impl $crate::state::Room for $room {
            type State = $state;
        }
    };
}
pub(crate) use state;
