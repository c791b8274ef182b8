//! The C tests: programs in C and C++ that use the library as its users do, compiled and run against what `make`
//! ships.

#![allow(
    clippy::arithmetic_side_effects,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that can't go on fails"
)]

#[path = "common/examples.rs"]
mod examples;
#[path = "common/headers.rs"]
mod headers;
#[path = "common/layouts.rs"]
mod layouts;
#[path = "deltarobot/oracle.rs"]
mod oracle;
mod packaging;
mod programs;
#[path = "common/support.rs"]
mod support;
#[path = "deltarobot/traces.rs"]
mod traces;
