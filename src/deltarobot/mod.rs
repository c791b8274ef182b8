//! The deltarobot message format (specification v1.0): frames and the ring they are found in.
//!
//! Bytes from the wire go into a [`Ring`], which gives back a [`Frame`] at a time; [`encode`] makes
//! the bytes of a frame.
#![forbid(unsafe_code)]

mod frame;
mod opcode;
mod ring;

pub use frame::{FRAME_END, FRAME_HEAD, FRAME_MAX, FRAME_OVERHEAD, FRAME_START, Frame, Payload, encode};
pub use opcode::Opcode;
pub use ring::{NoFrame, Overflow, Ring, RingByte};
