//! Three serial protocols of motion control, for either end of the line, with a C ABI: a drop-in replacement for the C
//! library that speaks the deltarobot message format, the Ozeki line protocol, and GX binary vectors.
//!
//! Three rings, each of which knows only the one inside it:
//!
//! 1. the core: [`deltarobot`], [`mod@line`] and [`gx`], the protocols in safe Rust that knows no C.
//! 2. [`ffi`]: the C ABI. Converts pointers, calls the core, returns its answer. The headers in `include/` are
//!    generated from it.
//! 3. the artifact: what turns the crate into `libdeltarobot.a` and `.so`, a panic handler that the linker finds
//!    unreachable.
//!
//! Nothing allocates, nothing blocks (but for the serial port), nothing keeps state of its own: every byte lives in
//! structs of the caller's, so the library takes no RAM and two threads may use two objects at once.
//!
//! Some sizes are fixed when the library is built: see [`config`].
//!
//! ```
//! use deltarobot::deltarobot::{Opcode, Ring};
//!
//! let mut ring = Ring::new();
//! ring.append(b"noise $S\x00\xB1:").unwrap();
//! let Ok(frame) = ring.next_frame() else { panic!("the frame is intact") };
//! assert_eq!(frame.opcode, Opcode::STATUS);
//! assert!(frame.payload.is_empty());
//! ```
#![no_std]
// Firmware may have no memcpy to link, and what `make` ships depends on no library: without this the
// compiler would turn copy loops into calls of memcpy.
#![no_builtins]
#![cfg_attr(
    test,
    allow(
        clippy::arithmetic_side_effects,
        clippy::indexing_slicing,
        clippy::panic,
        clippy::unwrap_used,
        reason = "a test that can't go on fails"
    )
)]

#[cfg(feature = "std")]
extern crate std;

mod clock;
pub mod config;
mod counter;
mod decimal;
pub mod deltarobot;
pub mod ffi;
pub mod gx;
pub mod line;
#[cfg(all(feature = "panic-handler", not(feature = "std"), not(test)))]
mod panic_handler;
#[cfg(all(unix, feature = "serial"))]
pub mod serial;
