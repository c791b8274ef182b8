//! What a host session reports.

use crate::gx::{Control, Status, Vector};
use crate::session::flags;

/// How a move ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Outcome {
    /// It was carried out.
    Finished = 1,
    /// The motion side did not accept it. It was not carried out.
    Refused = 2,
    /// The motion side accepted it, and has stopped before it was carried out to its end.
    Failed = 3,
    /// It was not begun, since one before it was refused or has failed, or the session ended before it was sent.
    Dropped = 4,
    /// Nothing is known: no answer for too long, or it lasted too long.
    TimedOut = 5,
    /// Nothing is known: the motion side was restarted, or does not take this for a session any more.
    Lost = 6,
    /// It was carried out, but the check says not as requested: a command was damaged. The next move is sent in
    /// positions of all axes, which corrects it.
    Deviated = 7,
}

impl Outcome {
    pub(super) const fn of(stored: u8) -> Option<Self> {
        Some(match stored {
            0 => return None,
            1 => Self::Finished,
            2 => Self::Refused,
            3 => Self::Failed,
            4 => Self::Dropped,
            6 => Self::Lost,
            7 => Self::Deviated,
            _ => Self::TimedOut,
        })
    }
}

/// Something that happened in a host session.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event<'a> {
    /// The position was reported.
    Report(&'a Vector),
    /// An error notice came: with this code, about the command with this number if it had one. What is to be done about
    /// it, the session does.
    Error(u8, Option<u16>),
    /// A session has begun.
    Begun,
    /// The oldest of the moves whose ends were not fetched has ended. The code is that of the error notice, or 0.
    Ended(Outcome, u8),
    /// A report that does not fit what was requested: the next move corrects that.
    Drift(&'a Vector),
    /// The status came: by request, or since the machine holds or goes on.
    Status(Status),
    /// The machine was stopped there, and forgot all moves; the velocity is the one in force.
    Stopped(&'a Vector),
    /// What was asked for past the queue got no answer, or was refused.
    Unanswered(Control),
}

flags! {
    /// The events that wait to be fetched before the ends of moves, in this order.
    pub(super) enum Pending { Begun, Report, Drift, Stopped, Error, Status, Unanswered }
}
