//! A command on its way.

use core::ffi::{c_int, c_uchar, c_uint, c_ulong, c_ushort};

use super::{COMMAND_MAX, Encoder, LineByte, Link, Message, Outcome, QueueError, Told};
use crate::clock::{left, stamp, time};
use crate::line::{Checksum, Value, fletcher16};

/// Bytes that a command's text and its id take together at most, when `&t=`, two digits, `&id=` and LF are to fit too.
const TEXT_MAX: usize = 54;

/// One command. Its fields are private.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Slot {
    /// When it was sent first and last.
    first_at: c_ulong,
    sent_at: c_ulong,
    /// What the caller knows it by.
    handle: c_int,
    /// Its place in the order in which commands are queued.
    order: c_uint,
    /// Places of its first and last line in the order in which lines are sent.
    first_line: c_uint,
    last_line: c_uint,
    /// By how much the counter had advanced when it was sent first.
    mark: c_uint,
    /// Checksum of the line.
    sum: c_ushort,
    /// How far it is; 0 when there is none.
    stage: c_uchar,
    /// How it ended.
    outcome: c_uchar,
    /// How often it was sent.
    sent: c_uchar,
    /// The line's number.
    t: c_uchar,
    /// Bits of `ACKED`, `LINKSETUP` and `SUMMED`.
    flags: c_uchar,
    /// The text as the caller built it, and behind that the id, encoded.
    command_length: c_uchar,
    id_length: c_uchar,
    /// Number of older commands that have ended, and may have been carried out after it.
    overtaken: c_uchar,
    text: [LineByte; TEXT_MAX],
}

/// There is no command.
const FREE: u8 = 0;
/// It waits for its turn, or to be fetched for sending.
const QUEUED: u8 = 1;
/// It was sent, and waits to be fetched for sending again.
const DUE: u8 = 2;
/// It was sent and waits for what comes back.
const SENT: u8 = 3;
/// It has ended, and that is to be told.
const ENDED: u8 = 4;

/// The device has acknowledged it.
const ACKED: u8 = 1;
/// It is a `linksetup`.
const LINKSETUP: u8 = 2;
/// It was sent with its checksum the last time.
const SUMMED: u8 = 4;

impl Slot {
    pub(super) const fn new() -> Self {
        Self {
            first_at: 0,
            sent_at: 0,
            handle: 0,
            order: 0,
            first_line: 0,
            last_line: 0,
            sum: 0,
            stage: FREE,
            outcome: 0,
            sent: 0,
            t: 0,
            mark: 0,
            flags: 0,
            command_length: 0,
            id_length: 0,
            overtaken: 0,
            text: [0; TEXT_MAX],
        }
    }

    const fn stage(&self) -> u8 {
        match self.stage {
            stage @ QUEUED..=ENDED => stage,
            _ => FREE,
        }
    }

    pub(super) const fn is_free(&self) -> bool {
        self.stage() == FREE
    }

    pub(super) const fn is_queued(&self) -> bool {
        self.stage() == QUEUED
    }

    pub(super) const fn is_due(&self) -> bool {
        self.stage() == DUE
    }

    pub(super) const fn waits(&self) -> bool {
        self.stage() == SENT
    }

    /// It was sent, and has not ended.
    pub(super) const fn is_out(&self) -> bool {
        matches!(self.stage(), DUE | SENT)
    }

    /// It has not ended.
    pub(super) const fn is_going_on(&self) -> bool {
        matches!(self.stage(), QUEUED..=SENT)
    }

    pub(super) const fn has_ended(&self) -> bool {
        self.stage() == ENDED
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

    pub(super) const fn handle(&self) -> c_int {
        self.handle
    }

    pub(super) const fn sum(&self) -> u16 {
        self.sum
    }

    pub(super) const fn sent(&self) -> u8 {
        self.sent
    }

    /// How many commands were queued since, up to that one.
    pub(super) const fn age(&self, order: c_uint) -> c_uint {
        order.wrapping_sub(self.order)
    }

    pub(super) const fn order(&self) -> c_uint {
        self.order
    }

    /// Takes a command in: an order and a handle are given to it. The slot has to be free; it stays so on errors.
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
        let command = message.line();
        let whole = command.iter().chain(id);
        let mut places = self.text.iter_mut();
        for byte in whole {
            *places.next().ok_or(QueueError::TooLong)? = *byte;
        }
        self.command_length = c_uchar::try_from(command.len()).map_err(|_| QueueError::TooLong)?;
        self.id_length = c_uchar::try_from(id.len()).map_err(|_| QueueError::TooLong)?;
        if self.write(99, checksum, &mut [0; COMMAND_MAX]).is_none() {
            return Err(QueueError::TooLong);
        }
        self.flags = if message.command().is(b"linksetup") { LINKSETUP } else { 0 };
        self.stage = QUEUED;
        self.sent = 0;
        self.overtaken = 0;
        Ok(())
    }

    pub(super) fn name_it(&mut self, order: c_uint, handle: c_int) {
        self.order = order;
        self.handle = handle;
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

    /// Whether a message is about the same device.
    pub(super) fn is_of(&self, id: Option<Value<'_>>) -> bool {
        id.is_some_and(|id| id.bytes().eq(self.id().bytes()))
    }

    /// Whether a message of that name is the answer.
    pub(super) fn is_answered_by(&self, name: Value<'_>) -> bool {
        name.bytes().eq(self.name().iter().chain(b"_resp").copied())
    }

    pub(super) const fn t(&self) -> u8 {
        self.t
    }

    /// What a linksetup asks for.
    pub(super) fn asks_for(&self) -> Option<Told> {
        Message::parse(self.command()).ok().and_then(|message| Link::of(&message))
    }

    /// The line with that number: its checksum, or `None` when it is too long.
    pub(super) fn sum_with(&self, t: u8, checksum: bool) -> Option<u16> {
        let mut line = [0; COMMAND_MAX];
        let length = self.write(t, checksum, &mut line)?;
        let tail = if checksum { b"&s=xxxx\n".len() } else { b"\n".len() };
        Some(fletcher16(line.get(..length.checked_sub(tail)?)?))
    }

    /// Whether the line, which has a number, is short enough to have a checksum too.
    pub(super) fn fits(&self, checksum: bool) -> bool {
        self.sum_with(self.t, checksum).is_some()
    }

    /// Writes the line with that number; its length, or `None` when it is too long.
    pub(super) fn write(&self, t: u8, checksum: bool, line: &mut [u8; COMMAND_MAX]) -> Option<usize> {
        let command = self.command();
        for (place, byte) in line.iter_mut().zip(command) {
            *place = *byte;
        }
        let mut encoder = Encoder::resume(line, command.len());
        encoder.int(b"t", t.into()).raw(b"id", self.id().raw());
        encoder.finish(checksum).ok()
    }

    /// It leaves for the first time.
    pub(super) fn leaves(&mut self, t: u8, sum: u16, advanced: c_uint, now: u32) {
        self.t = t;
        self.sum = sum;
        self.mark = advanced;
        self.first_at = stamp(now);
        self.sent = 0;
        self.flags &= LINKSETUP;
    }

    /// It was sent, as the line of that place in the order of all.
    pub(super) fn put_out(&mut self, checksum: bool, line: c_uint, now: u32) {
        if self.sent == 0 {
            self.first_line = line;
        }
        self.last_line = line;
        self.stage = SENT;
        self.sent_at = stamp(now);
        self.sent = self.sent.saturating_add(1);
        self.flags = if checksum { self.flags | SUMMED } else { self.flags & !SUMMED };
    }

    /// It was to be sent again, but can't be.
    pub(super) fn stay(&mut self, now: u32) {
        self.stage = SENT;
        self.sent_at = stamp(now);
        self.sent = self.sent.saturating_add(1);
    }

    /// Places of its first line and its last.
    pub(super) const fn lines(&self) -> (c_uint, c_uint) {
        (self.first_line, self.last_line)
    }

    /// Number of older commands that have ended, and may have been carried out after it.
    pub(super) fn overtaken(&self) -> c_uint {
        self.overtaken.into()
    }

    /// An older command has ended, of which that was the last of so many lines. If it was sent once more behind this
    /// one, it may have been carried out behind it.
    pub(super) fn see_end(&mut self, last_line: c_uint, newest: c_uint) {
        if newest.wrapping_sub(last_line) < newest.wrapping_sub(self.first_line) {
            self.overtaken = self.overtaken.saturating_add(1);
        }
    }

    pub(super) fn send_again(&mut self) {
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

    pub(super) fn end(&mut self, outcome: Outcome) {
        self.stage = ENDED;
        self.outcome = outcome as c_uchar;
    }

    pub(super) fn release(&mut self) -> Outcome {
        self.stage = FREE;
        Outcome::of(self.outcome)
    }

    /// How much of `span` is left since it was sent last.
    pub(super) fn left(&self, now: u32, span: u32) -> u32 {
        left(now, self.sent_at, span)
    }

    /// Whether it is so little since it was sent first that the device still remembers it.
    pub(super) fn is_recent(&self, now: u32, span: u32, advanced: c_uint) -> bool {
        let within = left(now, self.first_at, span.saturating_add(1)) > 0;
        within && advanced.wrapping_sub(self.mark) < 128
    }

    /// How long after it was sent last that was.
    pub(super) const fn elapsed(&self, at: c_ulong) -> u32 {
        time(at).wrapping_sub(time(self.sent_at))
    }
}

/// Whether a line is as the page wants it, and has none of the parameters that the session adds. What is received may
/// be otherwise, what is sent may not.
fn is_strict(message: &Message<'_>) -> bool {
    // Nothing between two of them is no parameter.
    let pieces = message.line().split(|byte| *byte == b'&').count();
    let name = message.command();
    let named = name.raw().iter().all(|byte| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'_'));
    !name.is_empty()
        && named
        && message.line().iter().all(u8::is_ascii_graphic)
        && pieces == message.len()
        && message.checksum() == Checksum::None
        && message.params().all(|param| {
            let plain = param.name.iter().all(|byte| matches!(byte, b'a'..=b'z' | b'0'..=b'9'));
            plain && !param.name.is_empty() && !matches!(param.name, b"t" | b"id")
        })
}

#[cfg(test)]
mod tests {
    use super::{COMMAND_MAX, QueueError, Slot};

    fn queued(command: &[u8], id: &[u8], checksum: bool) -> Result<Slot, QueueError> {
        let mut slot = Slot::new();
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
            b"c=a&X=1",
            b"c=a&x=\xC3",
            b"c=a&x=\r",
            b"c=a\nc=b",
            b"c=A",
            b"c=a&t=1",
            b"c=a&x=1&id=x",
            b"c=a&s=1234",
        ] {
            assert_eq!(queued(line, b"9o5qzg", false).err(), Some(QueueError::Malformed), "{line:?}");
        }
        assert_eq!(queued(b"c=a", b"", false).err(), Some(QueueError::Malformed));
        assert!(queued(b"c=a&s=5&x=-1.5%20_", b"9o5qzg", false).is_ok());
    }
}
