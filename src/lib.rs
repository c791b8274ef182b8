//! The C ABI: one file a header of `include/libdeltarobot/`.
//!
//! A function here converts its pointers, calls the core and maps the answer, no more.
//!
//! What all of them rely on, and what C callers therefore have to keep to:
//!
//! - A pointer is NULL, which is answered with `DP_RC_ERROR_GENERIC`, or it points to a whole object of its type,
//!   aligned and writable where it is not `const`. The objects behind two arguments of a call do not overlap.
//! - Contents may be anything, uninitialised memory included.
//! - A call has its objects to itself: they are not touched by another thread or an interrupt while it runs.
//!   Different objects can be used at the same time.
//! - No reference to a caller's object is held while one of the caller's callbacks runs: a callback may call
//!   the library on the same objects.
//!
//! A function whose arguments depend on the sizes that the library was built for is exported twice: under its plain
//! name, for programs compiled with the original's header, and under one that contains the sizes, for those compiled
//! with ours, so that a program and a library of different sizes do not link. [`export`](deltarobot_export::export)
//! does both.
#![no_std]
#![allow(clippy::missing_safety_doc, reason = "`#[export]` adds the contract, which the lint does not see")]
#![cfg_attr(
    test,
    allow(
        clippy::arithmetic_side_effects,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::indexing_slicing,
        reason = "a test that can't go on fails"
    )
)]

#[cfg(any(feature = "std", test))]
extern crate std;

pub mod contouring_protocol;
pub mod controller;
pub mod gx;
pub mod gx_host;
pub mod gx_motion;
pub mod host;
pub mod kinematics;
mod layouts;
pub mod line_device;
pub mod line_host;
pub mod line_protocol;
mod memory;
#[cfg(all(feature = "panic-handler", not(feature = "std"), not(test)))]
mod panic_handler;
pub mod payload;
#[cfg(all(any(unix, windows), feature = "serial"))]
mod port;
pub mod protocol;
pub mod protocol_ext;
pub mod receiver;
mod ring;
#[cfg(all(any(unix, windows), feature = "serial"))]
pub mod serial;
pub mod sizes;
mod state;
