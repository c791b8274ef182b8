//! The deltarobot message format (specification v1.0): frames and the ring they are found in.
//!
//! Bytes from the wire go into a [`Ring`], which gives back a [`Frame`] at a time; [`encode`] makes the bytes of a
//! frame. The sessions of both ends are [`host`] and [`controller`].
//!
//! ```
//! use deltarobot_protocols::deltarobot::{FRAME_MAX, Layout, Message, Opcode, Ring, encode};
//!
//! let mut room = [0; FRAME_MAX];
//! let length = encode(Opcode::ACK, b"M", &mut room).unwrap();
//! assert_eq!(room[..length], *b"$A\x01M\xED:");
//!
//! let mut ring = Ring::new();
//! ring.append(&room[..length]).unwrap();
//! let frame = ring.next_frame().unwrap();
//! assert_eq!(frame.opcode, Opcode::ACK);
//! assert!(frame.payload.iter().eq(*b"M"));
//! assert_eq!(Message::of_frame(&frame, Layout::Auto), Some(Message::Ack(Opcode::MOVE)));
//! ```
#![forbid(unsafe_code)]

pub mod bytes;
pub mod controller;
mod frame;
pub mod host;
mod opcode;
mod payload;
mod position;
mod ring;
mod search;
mod shortcut;
mod sums;
mod text;

pub use frame::{FRAME_END, FRAME_HEAD, FRAME_MAX, FRAME_OVERHEAD, FRAME_START, Frame, Payload, Place, encode};
pub use opcode::Opcode;
pub use payload::{Layout, Message, PAYLOAD_MAX, Report, State};
pub use position::{POSITION_SIZE, Position};
pub use ring::{NoFrame, Overflow, Ring, RingByte};
pub use shortcut::{Glance, Proof};
pub use text::{TEXT_MAX, describe};
