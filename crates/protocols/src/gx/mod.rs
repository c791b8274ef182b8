//! The GX binary vector protocol (source: the proposal "Proposed GX Protocol", with its C code): vector moves in the
//! fewest bytes, beside their ASCII form.
//!
//! ```
//! use deltarobot_protocols::gx::{CommandReceiver, Kind, Vector, write_step};
//!
//! let mut deltas = Vector::new();
//! deltas.set(0, 1);
//! deltas.set(1, -1);
//! let mut room = [0; 4];
//! assert_eq!(write_step(None, &deltas, &mut room), Ok(4));
//! assert_eq!(room, *b"\x2A\x83\x81\xFF");
//!
//! let mut receiver = CommandReceiver::new();
//! assert_eq!(receiver.receive(&room), (4, Some(Kind::Step)));
//! assert_eq!(receiver.vector(), &deltas);
//! ```

mod contour;
mod encoder;
pub mod host;
mod item;
mod message;
pub mod motion;
mod packed;
mod receiver;
mod vector;

pub use contour::Contour;
pub use encoder::{
    ENCODED_MAX, EncodeError, Written, write_completed, write_confirmed, write_control, write_move, write_position,
    write_refused, write_reporting, write_shortest, write_status, write_step,
};
pub use item::{Item, Message};
pub use message::{CODE_FREE, Control, Fault, Format, Kind, Number, Numbered, Status};
pub use packed::{CODE_MAX, DELTA_MAX, DELTA_MIN, NUMBER_MAX, PERIOD_MAX, POSITION_MAX, POSITION_MIN, VELOCITY_MAX};
pub use receiver::{CommandReceiver, NoticeReceiver, Receiver};
pub use vector::{AXES, Lost, MASK_AXES, MASK_VELOCITY, Vector};
