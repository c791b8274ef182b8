//! Memory of callers that is not initialised yet.

/// Sets a value to zero without a call of memset, byte by byte.
///
/// # Safety
///
/// out points to writable memory of that type.
pub(super) unsafe fn zero<T>(out: *mut T) {
    for place in 0..size_of::<T>() {
        // SAFETY: as the contract of this function asks.
        unsafe { out.cast::<u8>().add(place).write(0) };
    }
}
