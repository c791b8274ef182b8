//! Three serial protocols of motion control, for either end of the line: the deltarobot message format, the Ozeki line
//! protocol, and GX binary vectors.
//!
//! Nothing allocates, blocks or does I/O, and nothing keeps state of its own.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
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
#![allow(missing_docs, unreachable_pub)]
#![allow(clippy::missing_errors_doc, reason = "the error types say when")]
#![allow(clippy::must_use_candidate, reason = "that is nearly every function here")]

pub mod bytes;
pub mod decimal;
pub mod deltarobot;
pub mod gx;
pub mod kinematics;
pub mod line;
pub mod session;
