//! The receivers of both ends: bytes in any portions go in, commands or notices come out.

use super::command::Item;
use super::scanner::{IDLE, Scanner};
use super::whole;
use crate::config::FAST;

/// Receives commands: the motion side's. All zero is a new one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct CommandReceiver {
    scanner: Scanner,
}

/// Receives notices: the host's. All zero is a new one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct NoticeReceiver {
    scanner: Scanner,
}

impl CommandReceiver {
    /// A receiver that has received nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self { scanner: Scanner::new() }
    }

    /// Takes bytes up to the end of a command, and tells how many: all of them if none ends there, and then the item
    /// holds no message. A malformed command may end before the first of them, so call again as long as bytes are left,
    /// also if none was taken.
    ///
    /// Each malformed command is one [`Malformed`](super::Message::Malformed), with its number if that was complete.
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    pub fn receive(&mut self, bytes: &[u8], item: &mut Item) -> usize {
        if FAST && self.scanner.state == IDLE {
            match whole::read_frequent(bytes, item) {
                None => return self.receive_other(bytes, item),
                Some(0) => (),
                Some(taken) => return taken,
            }
        }
        self.scanner.scan::<false>(bytes, item)
    }

    /// Not inlined, which leaves registers to what is frequent.
    #[inline(never)]
    fn receive_other(&mut self, bytes: &[u8], item: &mut Item) -> usize {
        let taken = whole::read_row(bytes, item);
        if taken == 0 { self.scanner.scan::<false>(bytes, item) } else { taken }
    }

    /// To be called when the line has been quiet for longer than a command takes: what is incomplete is given up, and
    /// told as malformed.
    pub fn idle(&mut self, item: &mut Item) {
        self.scanner.idle::<false>(item);
    }

    /// Forgets what has come of a command, as ESC does.
    pub fn reset(&mut self) {
        self.scanner.forget();
    }
}

impl NoticeReceiver {
    /// A receiver that has received nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self { scanner: Scanner::new() }
    }

    /// Takes bytes up to the end of a notice, and tells how many: see [`CommandReceiver::receive`].
    ///
    /// A packed number is a whole notice, but may be the beginning of an error notice too: it is told when the next
    /// byte has come, or the line is [`idle`](Self::idle).
    #[inline]
    pub fn receive(&mut self, bytes: &[u8], item: &mut Item) -> usize {
        self.scanner.scan::<true>(bytes, item)
    }

    /// To be called when the line has been quiet for longer than a notice takes: a completion that could have become an
    /// error notice is told, and anything else that is incomplete is given up and told as malformed.
    pub fn idle(&mut self, item: &mut Item) {
        self.scanner.idle::<true>(item);
    }

    /// Forgets what has come of a notice.
    pub fn reset(&mut self) {
        self.scanner.forget();
    }
}
