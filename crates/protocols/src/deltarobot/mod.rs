//! The deltarobot message format (specification v1.0): frames and the ring they are found in.
//!
//! Bytes from the wire go into a [`Receiver`], which gives back a [`Frame`] at a time; [`encode`] makes the bytes of a
//! frame. The sessions of both ends are [`host`] and [`controller`]. The grammar itself is [`judge`].
//!
//! ```
//! use deltarobot_protocols::deltarobot::{Layout, Message, Opcode, Receiver, encode, receiver_room};
//!
//! let mut room = [0; 16];
//! let length = encode(Opcode::ACK, b"M", &mut room).unwrap();
//! assert_eq!(room[..length], *b"$A\x01M\xED:");
//!
//! let mut receiver = Receiver::<{ receiver_room(32) }>::new();
//! let mut input = &room[..length];
//! let frame = receiver.next_of(&mut input).unwrap();
//! let message = Message::read(frame.opcode, frame.payload, Layout::Auto);
//! assert_eq!(message, Some(Message::Ack(Opcode::MOVE)));
//! ```

pub mod controller;
mod frame;
pub mod host;
mod message;
mod opcode;
mod position;
mod receiver;
mod report;
mod text;

pub use frame::{
    FRAME_END, FRAME_HEAD, FRAME_OVERHEAD, FRAME_START, Fault, Frame, NoFrame, Place, Verdict, encode, judge,
    judge_head, judge_tail,
};
pub use message::{Message, PAYLOAD_MAX};
pub use opcode::Opcode;
pub use position::{POSITION_SIZE, Position};
pub use receiver::{Full, Observer, Receiver, receiver_room};
pub use report::{Layout, Report, SeenLayout, State};
pub use text::{TEXT_MAX, describe};
