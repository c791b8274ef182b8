//! The Ozeki line protocol: lines of text between a PC and the devices behind a microcontroller (source: the page
//! "Ozeki Line Protocol").
//!
//! A line is a list of parameters, the first of which says what it is about:
//! `c=setswitch&state=1&t=11&id=9o5qzg`.
//!
//! ```
//! use deltarobot_protocols::line::{Encoder, Message};
//!
//! let message = Message::parse(b"c=heaterinfo&temp=110.44&state=0&id=M1F910&t=2").unwrap();
//! assert!(message.command().is(b"heaterinfo"));
//! assert_eq!(message.text(b"temp").float(), Ok(110.44));
//!
//! let mut room = [0; 64];
//! let mut encoder = Encoder::command(&mut room, b"setswitch");
//! encoder.word(b"state", 1).word(b"t", 11).text(b"id", b"9o5qzg");
//! let length = encoder.finish(true).unwrap();
//! assert_eq!(room[..length], *b"c=setswitch&state=1&t=11&id=9o5qzg&s=a3d6\n");
//! ```

mod checksum;
pub mod device;
mod encoder;
pub mod host;
mod integer;
mod message;
mod receiver;
mod value;

pub use crate::decimal::DECIMALS_MAX;
pub use checksum::{EMPTY_SUM, fletcher16, fletcher16_more};
pub use encoder::{COMMAND_MAX, EncodeError, Encoder};
pub use integer::{Integer, IntegerText};
pub use message::{Checksum, Malformed, Message, Param, Params};
pub use receiver::{Received, Receiver};
pub use value::{Decoded, NumberError, Value};
