//! Commands that are to be sent.

use super::setup_again::{OWN_HANDLE, setup_line};
use super::{COMMAND_MAX, Host, SetupFields};

/// Why a command was not queued.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QueueError {
    /// As many commands as can be kept have not ended, or their end was not fetched.
    Busy,
    /// It is no command that may be sent: see [`Host::send`].
    Malformed,
    /// The line would be longer than [`COMMAND_MAX`].
    TooLong,
}

impl<const LINE: usize, const WINDOW: usize, const DEVICES: usize> Host<LINE, WINDOW, DEVICES> {
    /// Queues a command for the device of that id, and returns its handle: 1 to 32767.
    ///
    /// `command` is the beginning of the line, e.g. `c=setswitch&state=1`: printable ASCII, without a checksum and
    /// without parameters `t` and `id`, which are added. It has to leave room for these: for a `t` of two digits, and
    /// for `s` where checksums are in force.
    ///
    /// # Errors
    ///
    /// See [`QueueError`].
    pub fn send(&mut self, command: &[u8], id: &[u8]) -> Result<u16, QueueError> {
        let session = &mut self.session;
        let checksum = session.link.checks();
        let slots = &mut session.slots;
        let mut handle = session.handle;
        loop {
            handle = if (1..32767).contains(&handle) { handle.wrapping_add(1) } else { 1 };
            if !slots.iter().any(|slot| !slot.is_free() && slot.handle() == handle) {
                break;
            }
        }
        // One is left for a linksetup of the session's own.
        let kept = slots.iter().filter(|slot| !slot.is_free() && slot.handle() != OWN_HANDLE).count();
        if kept >= WINDOW.wrapping_sub(1) {
            return Err(QueueError::Busy);
        }
        let slot = slots.iter_mut().find(|slot| slot.is_free()).ok_or(QueueError::Busy)?;
        let order = session.order.wrapping_add(1);
        slot.queue(command, id, checksum, order, handle)?;
        if slot.is_linksetup()
            && let Some(asked) = slot.asks_for()
        {
            session.wanted.add(asked, id);
        }
        (session.order, session.handle) = (order, handle);
        Ok(handle)
    }

    /// Queues a `linksetup` with those of these parameters that are given. Three are one too many for a line.
    ///
    /// # Errors
    ///
    /// As for [`send`](Self::send).
    pub fn setup(
        &mut self,
        id: &[u8],
        ack: Option<bool>,
        checksum: Option<bool>,
        windowsize: Option<u16>,
    ) -> Result<u16, QueueError> {
        let mut room = [0; COMMAND_MAX];
        let length = setup_line(&mut room, SetupFields { ack, checksum, windowsize })?;
        self.send(room.get(..length).unwrap_or_default(), id)
    }
}

#[cfg(test)]
mod tests {
    use super::QueueError;
    use crate::line::host::{Settings, Slot};

    const WINDOW: usize = 8;
    type Host = super::Host<81, { WINDOW + 1 }, 1>;

    #[test]
    fn handles_are_those_of_no_other_command() {
        let mut host = Host::new(Settings::new());
        assert_eq!(host.send(b"c=a", b"x"), Ok(1));
        host.session.handle = 32766;
        for place in 1..WINDOW {
            let handle = if place == 1 { 32767 } else { u16::try_from(place).unwrap() };
            assert_eq!(host.send(b"c=a", b"x"), Ok(handle));
        }
        assert_eq!(host.send(b"c=a", b"x"), Err(QueueError::Busy));
        host.session.slots[0] = Slot::new();
        assert_eq!(host.send(b"c=a&t=1", b"x"), Err(QueueError::Malformed));
        assert!(host.send(b"c=a", b"x").is_ok());
    }
}
