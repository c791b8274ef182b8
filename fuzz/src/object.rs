//! Memory for objects whose fields are private.

use std::alloc::{Layout, alloc_zeroed, dealloc};
use std::ffi::c_void;

use crate::input::Input;

/// An object: all zero at first, and an allocation of its own, so that the address sanitizer sees the first byte too
/// far. Of the library's type only the size is used, which C tests compare with the header's.
pub struct Object<T>(*mut T);

impl<T> Default for Object<T> {
    fn default() -> Self {
        Self(unsafe { alloc_zeroed(Layout::new::<T>()) }.cast())
    }
}

impl<T> Drop for Object<T> {
    fn drop(&mut self) {
        unsafe { dealloc(self.0.cast(), Layout::new::<T>()) };
    }
}

impl<T> Object<T> {
    pub fn ptr(&self) -> *mut T {
        self.0
    }

    /// Overwrites some of it with some bytes, over and over, but for what is in `spared`.
    pub fn scribble(&mut self, input: &mut Input, spared: std::ops::Range<usize>) {
        let at = usize::from(u16::from_le_bytes(input.bytes())) % size_of::<T>();
        let length = usize::from(input.byte());
        let count = 1 + usize::from(input.byte() % 16);
        let bytes = input.slice(count);
        let places = (at..size_of::<T>()).take(length);
        for (place, byte) in places.zip(bytes.iter().cycle()).filter(|(place, _)| !spared.contains(place)) {
            unsafe { self.0.cast::<u8>().add(place).write(*byte) };
        }
    }

    /// Where a pointer lies in it.
    pub fn place_of(&self, pointer: *const c_void) -> usize {
        let words = (0..size_of::<T>()).step_by(align_of::<*const c_void>());
        let found: Vec<_> = words
            .filter(|place| unsafe { self.0.cast::<u8>().add(*place).cast::<*const c_void>().read() } == pointer)
            .collect();
        assert_eq!(found.len(), 1);
        found[0]
    }

    /// Whether all of a view lies in it.
    pub fn holds(&self, view: &[u8]) -> bool {
        let (start, from) = (self.0.addr(), view.as_ptr().addr());
        start <= from && from + view.len() <= start + size_of::<T>()
    }
}
