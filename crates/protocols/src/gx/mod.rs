//! The GX binary vector protocol (source: the proposal "Proposed GX Protocol", with its C code): vector moves in the
//! fewest bytes, beside their ASCII form.
//!
//! ```
//! use deltarobot_protocols::gx::{CommandReceiver, Item, Message, Vector, write_step};
//!
//! let mut deltas = Vector::new();
//! deltas.set(0, 1);
//! deltas.set(1, -1);
//! let mut room = [0; 4];
//! assert_eq!(write_step(None, &deltas, &mut room), Ok(4));
//! assert_eq!(room, *b"\x2A\x83\x81\xFF");
//!
//! let (mut receiver, mut item) = (CommandReceiver::new(), Item::new());
//! assert_eq!(receiver.receive(&room, &mut item), 4);
//! assert_eq!(item.message(), Some(Message::Step(&deltas)));
//! ```
#![forbid(unsafe_code)]

mod command;
mod contour;
mod encoder;
pub mod host;
pub mod motion;
mod packed;
mod receiver;
mod scanner;
mod whole;

pub use command::{AXES, Fault, Format, Item, Lost, MASK_AXES, MASK_VELOCITY, Message, Number, NumberField, Vector};
pub use command::{COMPLETED, MALFORMED, MOVE, POSITION, REFUSED, REPORTING, STEP};
pub use contour::Contour;
use encoder::fitting;
pub use encoder::{
    ENCODED_MAX, EncodeError, write_completed, write_move, write_position, write_refused, write_reporting,
    write_shortest, write_step,
};
pub use packed::{CODE_MAX, DELTA_MAX, DELTA_MIN, NUMBER_MAX, PERIOD_MAX, POSITION_MAX, POSITION_MIN, VELOCITY_MAX};
pub use receiver::{CommandReceiver, NoticeReceiver};
pub use scanner::Scanner;
