//! A command on its way: its text, how far it is, and the line that is made of it.

use zerocopy::{FromBytes, TryFromBytes};

use super::queue::OWN_HANDLE;
use super::{Outcome, QueueError, Settings, SetupFields};
use crate::line::encoder::{is_name, is_param_name};
use crate::line::message::same;
use crate::line::{COMMAND_MAX, Encoder, Message, Value, fletcher16};
use crate::session::{Transmission, left};

/// Bytes that a command's text and its id take together at most, when `&t=`, two digits, `&id=` and LF are to fit too.
const TEXT_MAX: usize = 54;

/// One command.
#[derive(Clone, Debug, FromBytes)]
pub(super) struct Slot {
    /// When it was sent first.
    first_at: u32,
    pub(super) transmission: Transmission,
    /// When it began to wait for what comes next: when its line was fetched, or an older command was heard of.
    since: u32,
    /// How long from then on its line was not on the wire yet.
    delay: u32,
    /// Its place in the order in which commands are queued.
    pub(super) order: u32,
    /// Places of its first and last line in the order in which lines are sent.
    pub(super) first_line: u32,
    pub(super) last_line: u32,
    /// By how much the counter had advanced when it was sent first.
    mark: u32,
    /// What the caller knows it by.
    pub(super) handle: u16,
    /// Checksum of the line.
    pub(super) sum: u16,
    /// How far it is.
    stage: u8,
    /// How it ended.
    outcome: u8,
    /// The line's number.
    pub(super) t: u8,
    /// Bits of `ACKED`, `LINKSETUP` and `SUMMED`.
    flags: u8,
    /// Bytes of the line that was sent last.
    length: u8,
    /// Lengths of the two parts of the text.
    command_length: u8,
    id_length: u8,
    /// Number of older commands that have ended, and may have been executed after it.
    pub(super) overtaken: u8,
    /// The command as the caller built it, and behind that the id, encoded.
    text: [u8; TEXT_MAX],
}

/// There is no command; so too in any other stage than the following.
const FREE: u8 = 0;
/// It waits for its turn, or to be fetched for sending.
const QUEUED: u8 = 1;
/// It was sent, and waits to be fetched for sending again.
const DUE: u8 = 2;
/// It was sent and waits for what comes back.
const SENT: u8 = 3;
/// It has ended, which is to be reported.
const ENDED: u8 = 4;

/// The device has acknowledged it.
const ACKED: u8 = 1;
/// It is a `linksetup`.
const LINKSETUP: u8 = 2;
/// It was sent with its checksum the last time.
const SUMMED: u8 = 4;

impl Slot {
    pub(super) const fn is_free(&self) -> bool {
        !matches!(self.stage, QUEUED..=ENDED)
    }

    pub(super) const fn is_queued(&self) -> bool {
        self.stage == QUEUED
    }

    pub(super) const fn is_due(&self) -> bool {
        self.stage == DUE
    }

    pub(super) const fn is_waiting(&self) -> bool {
        self.stage == SENT
    }

    /// It was sent, and has not ended.
    pub(super) const fn is_out(&self) -> bool {
        matches!(self.stage, DUE | SENT)
    }

    /// It has not ended.
    pub(super) const fn is_going_on(&self) -> bool {
        matches!(self.stage, QUEUED..=SENT)
    }

    pub(super) const fn has_ended(&self) -> bool {
        self.stage == ENDED
    }

    pub(super) const fn is_acked(&self) -> bool {
        self.flags & ACKED != 0
    }

    pub(super) const fn is_linksetup(&self) -> bool {
        self.flags & LINKSETUP != 0
    }

    pub(super) const fn is_summed(&self) -> bool {
        self.flags & SUMMED != 0
    }

    /// How many commands were queued since, up to that one.
    pub(super) const fn age(&self, order: u32) -> u32 {
        order.wrapping_sub(self.order)
    }

    /// Takes a command in, if there is none: on errors there is none still.
    pub(super) fn queue(&mut self, command: &[u8], id: &[u8], checksum: bool) -> Result<(), QueueError> {
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
        let command = message.line;
        let mut places = self.text.iter_mut();
        for byte in command.iter().chain(id) {
            *places.next().ok_or(QueueError::TooLong)? = *byte;
        }
        self.command_length = u8::try_from(command.len()).map_err(|_| QueueError::TooLong)?;
        self.id_length = u8::try_from(id.len()).map_err(|_| QueueError::TooLong)?;
        self.flags = if message.command().is(b"linksetup") { LINKSETUP } else { 0 };
        self.write(99, checksum, &mut [0; COMMAND_MAX]).ok_or(QueueError::TooLong)?;
        self.stage = QUEUED;
        self.transmission.sent = 0;
        self.overtaken = 0;
        Ok(())
    }

    /// It leaves for the first time.
    pub(super) fn start(&mut self, t: u8, sum: u16, advanced: u32, now: u32) {
        self.t = t;
        self.sum = sum;
        self.mark = advanced;
        self.first_at = now;
        self.transmission.sent = 0;
        self.flags &= LINKSETUP;
    }

    /// It was sent, as the line of that place in the order of all, and will have left after `delay`.
    pub(super) fn sent_as(&mut self, checksum: bool, line: u32, length: usize, now: u32, delay: u32) {
        if self.transmission.sent == 0 {
            self.first_line = line;
        }
        self.last_line = line;
        self.length = u8::try_from(length).unwrap_or(u8::MAX);
        self.stage = SENT;
        self.transmission.send(now);
        (self.since, self.delay) = (now, delay);
        self.flags = if checksum { self.flags | SUMMED } else { self.flags & !SUMMED };
    }

    /// It was to be sent again, but can't be.
    pub(super) fn skip_retransmission(&mut self, now: u32) {
        self.stage = SENT;
        self.transmission.send(now);
        (self.since, self.delay) = (now, 0);
    }

    /// An older command has ended. If its last line was behind the first of this one, it may have been executed behind.
    pub(super) fn older_ended(&mut self, last_line: u32, newest: u32) {
        if newest.wrapping_sub(last_line) < newest.wrapping_sub(self.first_line) {
            self.overtaken = self.overtaken.saturating_add(1);
        }
    }

    pub(super) fn retransmit(&mut self) {
        self.stage = DUE;
    }

    /// Its ack came: whether it is the first.
    pub(super) fn acknowledge(&mut self) -> bool {
        let first = !self.is_acked();
        self.flags |= ACKED;
        // What it waits for now is the answer.
        self.stage = SENT;
        first
    }

    /// It has ended, which is not reported of the session's own.
    pub(super) fn end(&mut self, outcome: Outcome) {
        self.stage = if self.handle == OWN_HANDLE { FREE } else { ENDED };
        self.outcome = outcome as u8;
    }

    pub(super) fn release(&mut self) -> Outcome {
        self.stage = FREE;
        // Any other value than it was given means that the session's memory was overwritten.
        Outcome::try_read_from_bytes(&[self.outcome]).unwrap_or(Outcome::TimedOut)
    }

    /// How much of `span` is left, for which it waits once its line has left.
    pub(super) fn left(&self, now: u32, span: u32) -> u32 {
        left(now, self.since, span.saturating_add(self.delay))
    }

    /// How long it has waited.
    pub(super) const fn waited(&self, at: u32) -> u32 {
        at.wrapping_sub(self.since).saturating_sub(self.delay)
    }

    /// An older command was heard of: before, nothing can have been heard of this one.
    pub(super) const fn older_heard(&mut self, at: u32) {
        if self.waited(at) > 0 {
            (self.since, self.delay) = (at, 0);
        }
    }

    /// Bytes that may lie in the device's receive buffer.
    pub(super) fn in_flight(&self, acks: bool) -> u32 {
        if self.is_waiting() && !(acks && self.is_acked()) { self.length.into() } else { 0 }
    }

    /// Whether it may be sent once more.
    pub(super) fn may_be_repeated(&self, settings: &Settings, advanced: u32, now: u32) -> bool {
        let recent = self.is_recent(settings.repeat(), advanced, now);
        self.transmission.sent <= settings.repeats() && (recent || self.is_linksetup())
    }

    /// Whether it is so little since it was sent first that the device still remembers it.
    pub(super) fn is_recent(&self, span: u32, advanced: u32, now: u32) -> bool {
        let within = left(now, self.first_at, span.saturating_add(1)) > 0;
        within && advanced.wrapping_sub(self.mark) < 128
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
    pub(super) fn is_like(&self, other: &Self) -> bool {
        same(self.name(), other.name()) && same(self.id().raw(), other.id().raw())
    }

    /// Bytes of the line at most.
    pub(super) fn longest(&self, checksum: bool) -> u32 {
        let added = if checksum { "&t=255&id=\n&s=xxxx".len() } else { "&t=255&id=\n".len() };
        let length = added.saturating_add(self.command_length.into()).saturating_add(self.id_length.into());
        u32::try_from(length).unwrap_or(u32::MAX)
    }

    /// Whether a message is about the same device.
    pub(super) fn is_of(&self, id: Option<Value<'_>>) -> bool {
        id.is_some_and(|id| id.bytes().eq(self.id().bytes()))
    }

    /// Whether a message of that name is the answer.
    pub(super) fn is_answered_by(&self, name: Value<'_>) -> bool {
        name.bytes().eq(self.name().iter().chain(b"_resp").copied())
    }

    /// The parameters of a linksetup.
    pub(super) fn asks_for(&self) -> Option<SetupFields> {
        Message::parse(self.command()).ok().and_then(|message| SetupFields::of(&message))
    }

    /// The line with that number: its checksum, or `None` when it is too long.
    pub(super) fn sum_with(&self, t: u8, checksum: bool) -> Option<u16> {
        let mut line = [0; COMMAND_MAX];
        let length = self.write(t, checksum, &mut line)?;
        let tail = if checksum { b"&s=xxxx\n".len() } else { b"\n".len() };
        Some(fletcher16(line.get(..length.checked_sub(tail)?)?))
    }

    /// Writes the line with that number; its length, or `None` when it is too long.
    pub(super) fn write(&self, t: u8, checksum: bool, line: &mut [u8; COMMAND_MAX]) -> Option<usize> {
        let command = self.command();
        for (place, byte) in line.iter_mut().zip(command) {
            *place = *byte;
        }
        let mut encoder = Encoder::resume(line, command.len());
        encoder.word(b"t", t.into()).raw(b"id", self.id().raw());
        encoder.finish(checksum).ok()
    }
}

/// Whether a line is as the page wants what is sent, and has none of the parameters that the session adds.
fn is_strict(message: &Message<'_>) -> bool {
    // Nothing between two of them is no parameter.
    let pieces = message.line.split(|byte| *byte == b'&').count();
    is_name(message.command().raw())
        && message.line.iter().all(u8::is_ascii_graphic)
        && pieces == message.count
        && message.params().all(|param| is_param_name(param.name) && !matches!(param.name, b"t" | b"id"))
}

#[cfg(test)]
mod tests {
    use super::{COMMAND_MAX, QueueError, Slot};
    use zerocopy::FromZeros;

    fn queued(command: &[u8], id: &[u8], checksum: bool) -> Result<Slot, QueueError> {
        let mut slot = Slot::new_zeroed();
        slot.queue(command, id, checksum)?;
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
        let setup = b"c=linksetup&windowsize=1&ack=on&checksum=fletcher16";
        assert_eq!(queued(setup, b"sf6z34", false).err(), Some(QueueError::TooLong));
    }

    #[test]
    fn lines_that_are_not_sent() {
        let commands = ["", "x=1", "c=", "c", "c=a b", "c=a-b", "c=a\nc=b"];
        let params =
            ["c=a&x=1 2", "c=a&x=%4", "c=a&&x=1", "c=a&x=1&", "c=a&=1", "c=a&x-y=1", "c=a&x=\u{c3}", "c=a&x=\r"];
        let reserved = ["c=a&t=1", "c=a&x=1&id=x", "c=a&s=1234", "c=a&s=5&x=1", "c=a&s", "c=a&s&x=1"];
        for line in commands.iter().chain(&params).chain(&reserved) {
            assert_eq!(queued(line.as_bytes(), b"9o5qzg", false).err(), Some(QueueError::Malformed), "{line:?}");
        }
        assert_eq!(queued(b"c=a", b"", false).err(), Some(QueueError::Malformed));
        assert!(queued(b"c=Set_2&Id=5&num_blocks=-1.5%20_", b"9o5qzg", false).is_ok());
    }
}
