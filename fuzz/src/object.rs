//! Structs of the C ABI as C programs have them: memory.

use std::alloc::{Layout, alloc_zeroed, dealloc};
use std::ffi::{c_int, c_void};
use std::mem::zeroed;

use crate::input::Input;

/// An object: all zero at first, and an allocation of its own, so that the address sanitizer sees the first byte too
/// far.
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

    /// Where two pointers lie in it, next to each other.
    pub fn places_of(&self, pointers: [*const c_void; 2]) -> std::ops::Range<usize> {
        let size = size_of::<*const c_void>();
        let place_of = |pointer| {
            let mut places = (0..size_of::<T>()).step_by(size);
            places.find(|place| unsafe { self.0.cast::<u8>().add(*place).cast::<*const c_void>().read() } == pointer)
        };
        let places = pointers.map(|pointer| place_of(pointer).expect("the pointer is kept"));
        let start = *places.iter().min().unwrap();
        assert_eq!(places.iter().max(), Some(&(start + size)));
        start..start + 2 * size
    }

    /// Whether all of a view lies in it.
    pub fn holds(&self, view: &[u8]) -> bool {
        let (start, from) = (self.0.addr(), view.as_ptr().addr());
        start <= from && from + view.len() <= start + size_of::<T>()
    }
}

/// A struct of the C ABI that is not private: integers, floats, pointers that may be null, arrays and structs of them.
pub trait Plain: Sized {
    #[must_use]
    fn zero() -> Self {
        // SAFETY: all of these can be zero.
        unsafe { zeroed() }
    }

    #[must_use]
    fn copy(&self) -> Self {
        // SAFETY: all of these can be copied.
        unsafe { std::ptr::read(self) }
    }

    /// Its bytes, those of any padding included.
    fn bytes(&self) -> &[u8] {
        // SAFETY: so many bytes, which are initialised where it began as zero.
        unsafe { std::slice::from_raw_parts(std::ptr::from_ref(self).cast(), size_of::<Self>()) }
    }
}

/// An event of a session.
pub trait Event: Plain {
    fn kind(&mut self) -> &mut c_int;
}

macro_rules! plain {
    ($($module:ident: $($name:ident)*;)*) => {$($(impl Plain for deltarobot::$module::$name {})*)*};
}
macro_rules! events {
    ($($($module:ident)::*;)*) => {$(
        impl Plain for deltarobot::$($module)::* {}
        impl Event for deltarobot::$($module)::* {
            fn kind(&mut self) -> &mut c_int {
                &mut self.kind
            }
        }
    )*};
}
plain! {
    protocol: ProtocolData ProtocolMsg StatusReport Position;
    host: HostHealth;
    gx: Vector Number Item Commands Notices;
    line_protocol: LineMessage LineParam LineText LineEncoder;
    line_host: HostLink HostHealth HostDevice;
    line_device: DeviceHealth;
    gx_host: HostHealth;
    gx_motion: MotionHealth;
    contouring_protocol: CPVectorCommand CPPackedVectorCommandBuffer;
}
events! {
    host::event::HostEvent;
    line_host::HostEvent;
    gx_host::event::HostEvent;
    gx_motion::MotionEvent;
}
impl Plain for deltarobot::gx::write::Contour {}
