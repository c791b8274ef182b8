//! Records of robots in MCAP files, as Foxglove, ROS 2 and the mcap packages of many languages read them.
//!
//! Each robot has four channels, `/NAME/bytes`, `/NAME/messages`, `/NAME/state` and `/NAME/events`, whose messages are
//! JSON. A file consists of chunks that are written whole, each with the schemas and channels that it is the first to
//! use: what a program that was killed has written is readable up to the last of them.

#![forbid(unsafe_code)]
#![allow(
    clippy::arithmetic_side_effects,
    clippy::missing_errors_doc,
    reason = "numbers here are times and sizes of what fits in memory, and the errors are all of one kind, in words"
)]
#![cfg_attr(test, allow(clippy::indexing_slicing, clippy::unwrap_used, reason = "a test that can't go on fails"))]

pub mod channels;
mod convert;
pub mod reader;
pub mod rotation;
pub mod writer;

pub use convert::main;
