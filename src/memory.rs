//! Memory of callers, as pointers and sizes from C describe it, and numbers as C has them.

use core::ffi::{CStr, c_char, c_int, c_long, c_ulong, c_void};
use core::mem::MaybeUninit;
use core::slice;

/// Sets a value to zero, by volatile writes, or they would become a call of memset.
///
/// # Safety
///
/// out points to writable memory of that type.
pub(super) unsafe fn zero<T>(out: *mut T) {
    for place in 0..size_of::<T>() {
        // SAFETY: within what out points to, which is writable.
        unsafe { out.cast::<u8>().add(place).write_volatile(0) };
    }
}

/// The bytes that a pointer and a size from C stand for, or `None` where they stand for nothing.
///
/// # Safety
///
/// buf is NULL or points to that many readable bytes, which nobody writes while the slice lives.
#[inline(always)]
pub(super) unsafe fn bytes_of<'a>(buf: *const c_void, bytes: c_int) -> Option<&'a [u8]> {
    match usize::try_from(bytes) {
        Ok(0) => Some(&[]),
        // SAFETY: not NULL, so it points to so many bytes.
        Ok(length) if !buf.is_null() => Some(unsafe { slice::from_raw_parts(buf.cast(), length) }),
        _ => None,
    }
}

/// A number of bytes that an int holds: a ring's, a frame's, or a part of what C gave as an int.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "see above")]
pub(super) const fn int(bytes: usize) -> c_int {
    bytes as c_int
}

/// Milliseconds as C's long has them, which may have 32 bits.
#[allow(clippy::unnecessary_fallible_conversions, reason = "where it has 64")]
pub(super) fn long(time: u32) -> c_long {
    c_long::try_from(time).unwrap_or(c_long::MAX)
}

/// A time of a caller's clock: the lowest 32 bits count.
#[allow(clippy::cast_possible_truncation, reason = "where unsigned long has 64 bits")]
pub(super) const fn time(now_ms: c_ulong) -> u32 {
    now_ms as u32
}

/// A duration from a caller's settings, as much of it as 32 bits hold.
#[allow(clippy::unnecessary_fallible_conversions, reason = "where unsigned long has 32 bits")]
pub(super) fn duration(ms: c_ulong) -> u32 {
    u32::try_from(ms).unwrap_or(u32::MAX)
}

/// A number from a caller's settings, as much of it as 16 bits hold.
pub(super) fn short(number: c_int) -> i16 {
    i16::try_from(number).unwrap_or(if number < 0 { i16::MIN } else { i16::MAX })
}

/// An int, which may have 16 bits.
#[allow(clippy::useless_conversion, reason = "where it has 32")]
pub(super) fn number(number: c_int) -> i32 {
    number.into()
}

/// Copies counters into a struct of C's that consists of as many, in the same order.
#[allow(clippy::useless_conversion, reason = "where unsigned long has 32 bits")]
pub(super) fn copy_counters<const COUNT: usize>(from: &[u32; COUNT], to: &mut [c_ulong; COUNT]) {
    for (place, counter) in to.iter_mut().zip(from) {
        *place = (*counter).into();
    }
}

/// The room that a pointer and a size from C stand for, or `None` where they stand for nothing.
///
/// # Safety
///
/// buf is NULL or points to that many writable bytes, which nobody else touches while the slice lives.
pub(super) unsafe fn room_of<'a>(buf: *mut c_void, cap: c_int) -> Option<&'a mut [MaybeUninit<u8>]> {
    match usize::try_from(cap) {
        Ok(0) => Some(&mut []),
        // SAFETY: not NULL, so it points to so many writable bytes.
        Ok(length) if !buf.is_null() => Some(unsafe { slice::from_raw_parts_mut(buf.cast(), length) }),
        _ => None,
    }
}

/// Fills a buffer of C's with as many messages as fit: `next` writes one, is told how much room is left, and tells the
/// length, 0 when there is none that fits. Returns how many bytes were written, or `None` where pointer and size stand
/// for nothing.
///
/// # Safety
///
/// buf is NULL or points to that many writable bytes, which nobody else touches meanwhile.
pub(super) unsafe fn fill<const LONGEST: usize>(
    buf: *mut c_void,
    cap: c_int,
    mut next: impl FnMut(&mut [u8; LONGEST], usize) -> usize,
) -> Option<c_int> {
    // SAFETY: room_of()'s contract is this function's.
    let room = unsafe { room_of(buf, cap) }?;
    let mut message = [0; LONGEST];
    let mut written = 0_usize;
    loop {
        let left = room.get_mut(written..).unwrap_or_default();
        let length = next(&mut message, left.len());
        if length == 0 {
            return Some(int(written));
        }
        for (place, byte) in left.iter_mut().zip(message.iter().take(length)) {
            place.write(*byte);
        }
        written = written.wrapping_add(length);
    }
}

/// A string of C's, or `None` for NULL. Not by a call of strlen.
///
/// # Safety
///
/// text is NULL or points to bytes of which one is zero, and which nobody writes while the reference lives.
pub(super) unsafe fn string_of<'a>(text: *const c_char) -> Option<&'a CStr> {
    if text.is_null() {
        return None;
    }
    let mut size = 1_usize;
    // SAFETY: no byte behind the zero one is read.
    while unsafe { text.add(size.wrapping_sub(1)).read() } != 0 {
        size = size.wrapping_add(1);
    }
    // SAFETY: these were just read, and the last is the only zero byte.
    Some(unsafe { CStr::from_bytes_with_nul_unchecked(slice::from_raw_parts(text.cast(), size)) })
}

/// The bytes of a string of C's, or `None` for NULL.
///
/// # Safety
///
/// As for [`string_of`].
#[cfg_attr(target_pointer_width = "16", inline(never))]
pub(super) unsafe fn text_of<'a>(text: *const c_char) -> Option<&'a [u8]> {
    // SAFETY: the same contract.
    unsafe { string_of(text) }.map(CStr::to_bytes)
}
