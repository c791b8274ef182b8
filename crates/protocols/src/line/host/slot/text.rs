//! A command's text, and the line that is made of it.

use super::{LINKSETUP, QUEUED, Slot};
use crate::line::encoder::{is_name, is_param_name};
use crate::line::host::{Link, QueueError, SetupFields};
use crate::line::message::same;
use crate::line::{COMMAND_MAX, Encoder, Message, Value, fletcher16};

impl Slot {
    /// Takes a command in, if there is none: on errors there is none still.
    pub(in crate::line::host) fn queue(
        &mut self,
        command: &[u8],
        id: &[u8],
        checksum: bool,
        order: u32,
        handle: u16,
    ) -> Result<(), QueueError> {
        let message = Message::parse(command).ok().filter(is_strict).ok_or(QueueError::Malformed)?;
        if id.is_empty() {
            return Err(QueueError::Malformed);
        }
        let mut room = [0; COMMAND_MAX];
        let mut encoded = Encoder::resume(&mut room, 0);
        encoded.text(b"id", id);
        if encoded.error().is_some() {
            return Err(QueueError::TooLong);
        }
        let end = encoded.length();
        let id = room.get(b"&id=".len()..end).unwrap_or_default();
        let command = message.line();
        let mut places = self.text.iter_mut();
        for byte in command.iter().chain(id) {
            *places.next().ok_or(QueueError::TooLong)? = *byte;
        }
        self.command_length = u8::try_from(command.len()).map_err(|_| QueueError::TooLong)?;
        self.id_length = u8::try_from(id.len()).map_err(|_| QueueError::TooLong)?;
        self.flags = if message.command().is(b"linksetup") { LINKSETUP } else { 0 };
        self.write(99, checksum, &mut [0; COMMAND_MAX]).ok_or(QueueError::TooLong)?;
        self.stage = QUEUED;
        self.transmission.restart();
        self.overtaken = 0;
        (self.order, self.handle) = (order, handle);
        Ok(())
    }

    fn command(&self) -> &[u8] {
        self.text.get(..usize::from(self.command_length)).unwrap_or_default()
    }

    fn id(&self) -> Value<'_> {
        let begin = usize::from(self.command_length);
        let end = begin.saturating_add(usize::from(self.id_length));
        Value::new(self.text.get(begin..end).unwrap_or_default())
    }

    /// The name of the command, as it stands in the text behind `c=`.
    fn name(&self) -> &[u8] {
        let behind = self.command().get(b"c=".len()..).unwrap_or_default();
        behind.split(|byte| *byte == b'&').next().unwrap_or_default()
    }

    /// Whether it has the same name and is for the same device, so that an answer may be either's.
    pub(in crate::line::host) fn is_like(&self, other: &Self) -> bool {
        same(self.name(), other.name()) && same(self.id().raw(), other.id().raw())
    }

    /// Bytes of the line at most.
    pub(in crate::line::host) fn longest(&self, checksum: bool) -> u32 {
        let added = if checksum { "&t=255&id=\n&s=xxxx".len() } else { "&t=255&id=\n".len() };
        let length = added.saturating_add(self.command_length.into()).saturating_add(self.id_length.into());
        u32::try_from(length).unwrap_or(u32::MAX)
    }

    /// Whether a message is about the same device.
    pub(in crate::line::host) fn is_of(&self, id: Option<Value<'_>>) -> bool {
        id.is_some_and(|id| id.bytes().eq(self.id().bytes()))
    }

    /// Whether a message of that name is the answer.
    pub(in crate::line::host) fn is_answered_by(&self, name: Value<'_>) -> bool {
        name.bytes().eq(self.name().iter().chain(b"_resp").copied())
    }

    /// The parameters of a linksetup.
    pub(in crate::line::host) fn asks_for(&self) -> Option<SetupFields> {
        Message::parse(self.command()).ok().and_then(|message| Link::of(&message))
    }

    /// The line with that number: its checksum, or `None` when it is too long.
    pub(in crate::line::host) fn sum_with(&self, t: u8, checksum: bool) -> Option<u16> {
        let mut line = [0; COMMAND_MAX];
        let length = self.write(t, checksum, &mut line)?;
        let tail = if checksum { b"&s=xxxx\n".len() } else { b"\n".len() };
        Some(fletcher16(line.get(..length.checked_sub(tail)?)?))
    }

    /// Writes the line with that number; its length, or `None` when it is too long.
    pub(in crate::line::host) fn write(&self, t: u8, checksum: bool, line: &mut [u8; COMMAND_MAX]) -> Option<usize> {
        let command = self.command();
        for (place, byte) in line.iter_mut().zip(command) {
            *place = *byte;
        }
        let mut encoder = Encoder::resume(line, command.len());
        encoder.word(b"t", t.into()).raw(b"id", self.id().raw());
        encoder.finish(checksum).ok()
    }
}

/// Whether a line is as the page wants it, and has none of the parameters that the session adds. What is received may
/// be otherwise, what is sent may not.
fn is_strict(message: &Message<'_>) -> bool {
    // Nothing between two of them is no parameter.
    let pieces = message.line().split(|byte| *byte == b'&').count();
    is_name(message.command().raw())
        && message.line().iter().all(u8::is_ascii_graphic)
        && pieces == message.len()
        && message.params().all(|param| is_param_name(param.name) && !matches!(param.name, b"t" | b"id"))
}

#[cfg(test)]
mod tests {
    use super::{COMMAND_MAX, QueueError, Slot};
    use zerocopy::FromZeros;

    fn queued(command: &[u8], id: &[u8], checksum: bool) -> Result<Slot, QueueError> {
        let mut slot = Slot::new_zeroed();
        slot.queue(command, id, checksum, 1, 1)?;
        assert!(slot.is_queued());
        Ok(slot)
    }

    #[test]
    fn the_lines_of_the_page() {
        for (command, t, id, checksum, line) in [
            (&b"c=setswitch&state=1"[..], 11, &b"9o5qzg"[..], false, &b"c=setswitch&state=1&t=11&id=9o5qzg\n"[..]),
            (b"c=setswitch&state=1", 11, b"9o5qzg", true, b"c=setswitch&state=1&t=11&id=9o5qzg&s=a3d6\n"),
            (b"c=x", 255, b"a b", false, b"c=x&t=255&id=a%20b\n"),
        ] {
            let slot = queued(command, id, checksum).unwrap();
            let mut out = [0; COMMAND_MAX];
            let length = slot.write(t, checksum, &mut out).unwrap();
            assert_eq!(out[..length], *line);
        }
        let slot = queued(b"c=linksetup&ack=on&checksum=fletcher16", b"sf6z34", true).unwrap();
        assert!(slot.is_linksetup());
        assert_eq!((slot.sum_with(2, false), slot.sum_with(2, true)), (Some(0xd293), Some(0xd293)));
        let slot = queued(b"c=setswitch&state=1", b"9o5qzg", false).unwrap();
        assert!(slot.is_of(Some(super::Value::new(b"%39o5qzg"))) && !slot.is_of(Some(super::Value::new(b"9o5qz"))));
        assert!(slot.is_answered_by(super::Value::new(b"setswitch_resp")));
        assert!(!slot.is_answered_by(super::Value::new(b"setswitch")) && !slot.is_of(None));
    }

    #[test]
    fn lines_that_are_too_long() {
        let go = b"c=go&x=10&y=10&z=10&a=50&b=50&c=50&spd=100&eas=1";
        let slot = queued(go, b"IqlZci", false).unwrap();
        assert!(slot.sum_with(99, false).is_some() && slot.sum_with(100, false).is_none());
        assert_eq!(queued(go, b"IqlZci", true).err(), Some(QueueError::TooLong));
        assert_eq!(queued(go, b"IqlZcix", false).err(), Some(QueueError::TooLong));
        assert_eq!(queued(go, &[b'x'; 300], false).err(), Some(QueueError::TooLong));
        assert_eq!(queued(b"c=linksetup&windowsize=1&ack=on&checksum=fletcher16", b"sf6z34", false).err(), {
            Some(QueueError::TooLong)
        });
    }

    #[test]
    fn lines_that_are_not_sent() {
        for line in [
            &b""[..],
            b"x=1",
            b"c=",
            b"c",
            b"c=a b",
            b"c=a&x=1 2",
            b"c=a&x=%4",
            b"c=a&&x=1",
            b"c=a&x=1&",
            b"c=a&=1",
            b"c=a&x-y=1",
            b"c=a&x=\xC3",
            b"c=a&x=\r",
            b"c=a\nc=b",
            b"c=a-b",
            b"c=a&t=1",
            b"c=a&x=1&id=x",
            b"c=a&s=1234",
            b"c=a&s=5&x=1",
            b"c=a&s",
            b"c=a&s&x=1",
        ] {
            assert_eq!(queued(line, b"9o5qzg", false).err(), Some(QueueError::Malformed), "{line:?}");
        }
        assert_eq!(queued(b"c=a", b"", false).err(), Some(QueueError::Malformed));
        assert!(queued(b"c=Set_2&Id=5&num_blocks=-1.5%20_", b"9o5qzg", false).is_ok());
    }
}
