//! The deltarobot message format (specification v1.0): frames and the ring they are found in.
//!
//! Bytes from the wire go into a [`Ring`], which gives back a [`Frame`] at a time; [`encode`] makes
//! the bytes of a frame.
#![forbid(unsafe_code)]

pub(crate) mod bytes;
mod controller;
mod frame;
mod host;
mod opcode;
mod payload;
mod position;
mod ring;
mod shortcut;
mod sums;
mod text;

pub use controller::{Dispatcher, Judgement, Order};
pub use frame::{FRAME_END, FRAME_HEAD, FRAME_MAX, FRAME_OVERHEAD, FRAME_START, Frame, Payload, encode};
pub use host::{Busy, Event, Health, Host, Link, Outcome, Request, Settings};
pub use opcode::Opcode;
pub use payload::{Layout, Message, PAYLOAD_MAX, Report, State};
pub use position::{POSITION_SIZE, Position};
pub(crate) use ring::Candidate;
pub use ring::{NoFrame, Overflow, Ring, RingByte};
pub(crate) use shortcut::{Glance, Proof};
pub use text::{TEXT_MAX, describe};
