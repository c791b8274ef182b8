//! The PC's end of the link: commands go in, outcomes and what the devices tell come out.
//!
//! A [`Host`] does no I/O: it is fed the bytes that were received and the time, and asked for the bytes to send and for
//! events. It keeps one line: [`receive`](Host::receive) takes bytes up to the end of a line, and more only when all
//! that the line meant has been told.
//!
//! # A command
//!
//! is queued as its caller built it; the session adds `t` and `id`, and `s` where checksums are in force. It leaves
//! when none of those that have been sent and have not ended is forgotten by the device for it: that remembers as
//! many commands as the window has, in the order in which they were carried out. It ends exactly once, as [`Outcome`]
//! tells:
//!
//! - Answered: `<name>_resp` from its id came; where acks are in force, behind its ack. (Never matched by `t`, which
//!   sources give differently. Of several that could be meant, the oldest is.)
//! - Refused: `onerror` with the code `unknowncommand`, `unknownid` or `refused`, its `t` and its id came; where acks
//!   are in force, directly behind its ack, as that way of the line has no checksums. `toolong` says that it was
//!   carried out, but can't be answered, so that counts as its answer.
//! - Timed out: neither came, though it was repeated.
//! - Restarted: the device has started anew meanwhile. A repeat could be carried out a second time.
//!
//! # Repeats
//!
//! A repeat is the same line with the same `t`, by which the device recognises it, and answers again without carrying
//! it out again. It is sent when the ack (with the right checksum, where these are in force) or the answer is
//! overdue, or at once when the device reports an error that is not about a command it could read: which one it could
//! not read it can't tell, so it is the oldest that it has not acknowledged.
//!
//! Without acks nothing is repeated for being overdue, unless [`Settings::recognises`] says that the device knows
//! repeats; but `linksetup` always is, as doing that twice is no harm.
//!
//! With a window of more than 1, a repeated command is carried out behind later ones. Where the order matters, wait.
//!
//! # What can be relied on
//!
//! With acks and checksums, and a device that recognises repeats as [`crate::line`] does: a command is not carried
//! out twice; answered means carried out once, refused means not at all. (A damaged line whose checksum is right by
//! chance, one in some 65000, is beyond that.) Without checksums a command may be carried out otherwise than it was
//! sent; without acks, the answer to a command that has timed out may count for the next one with that name and id,
//! if it comes then.
//!
//! A repeat can be recognised only while the device remembers the command. Therefore none is sent later than
//! [`Settings::repeat_ms`] or after 128 other messages, and no new command has the number and the words of one of the
//! last 64. But a program that has just started does not know these: it should begin with a `linksetup`, at which a
//! device forgets what it remembers. That travels alone: it waits until all before it have ended, and all behind it
//! until it has.
//!
//! ```
//! use deltarobot_protocols::line::host::{Event, Host, Outcome, Settings};
//!
//! let mut host = Host::new(Settings::new());
//! let handle = host.send(b"c=setswitch&state=1", b"9o5qzg").unwrap();
//! let mut line = [0; 64];
//! let length = host.output(&mut line, 64, 0);
//! assert_eq!(line[..length], *b"c=setswitch&state=1&t=0&id=9o5qzg\n");
//!
//! host.receive(b"c=setswitch_resp&state=1&pwm=254&id=9o5qzg&t=1\n", 5);
//! let Some(Event::Ended(ended, Outcome::Answered, Some(answer))) = host.poll(5) else { panic!("it is answered") };
//! assert_eq!(ended, handle);
//! assert_eq!(answer.get(b"pwm").unwrap().int(), Ok(254));
//! ```

mod counter;
mod event;
mod health;
mod incoming;
mod output;
mod queue;
mod settings;
mod slot;
mod table;
mod timers;

use core::ffi::{c_int, c_uchar, c_uint, c_ulong};

use super::encoder::COMMAND_MAX;
use super::message::Message;
use super::receiver::{LineByte, Received, Receiver};
use crate::clock::stamp;
use crate::config::OLP_WINDOW_MAX;
use crate::counter::count;
pub use counter::{Counter, Recent};
pub use event::{Dropped, Event, Outcome};
pub use health::Health;
pub use queue::QueueError;
use settings::Told;
pub use settings::{Link, Settings};
pub use slot::Slot;
pub use table::{Device, Devices, ID_MAX, Listed, NAME_MAX, TYPE_MAX, VERSION_MAX};

/// A host session. Its fields are private; all zero is a new session with default settings.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Host {
    receiver: Receiver,
    session: Session,
}

/// A host session but for what it receives. Its fields are private.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Session {
    settings: Settings,
    health: Health,
    /// When bytes were received last.
    heard_at: c_ulong,
    link: Link,
    /// The window that was asked for last: a damaged answer shall not make it larger.
    asked: c_uint,
    /// Place in the order and handle of the command queued last.
    order: c_uint,
    handle: c_int,
    /// Number of lines sent.
    lines: c_uint,
    /// Handle of the command whose ack was the last line, or 0; and of that which an event is about.
    acked: c_int,
    concerned: c_int,
    /// What is to be told: bits of `TELL_*`.
    tell: c_int,
    /// The length of the line that was received, -1 of one that was too long, 0 when there is none.
    held: c_int,
    /// How and where the device that has signed in is listed.
    listed_at: c_int,
    listed: c_uchar,
    /// Number of messages lost.
    lost: c_uchar,
    /// Not 0: all that the line means has been concluded.
    understood: c_uchar,
    /// Not 0: not all bytes were taken, so that it is too early to look at the time.
    partial: c_uchar,
    /// Not 0: the device has just told what is in force.
    own_setup: c_uchar,
    counter: Counter,
    slots: [Slot; OLP_WINDOW_MAX],
    devices: Devices,
}

impl Host {
    /// A session that has just begun.
    #[must_use]
    pub const fn new(settings: Settings) -> Self {
        let session = Session {
            settings,
            health: Health::new(),
            heard_at: 0,
            link: Link { ack: 0, checksum: 0, windowsize: 0 },
            asked: 0,
            order: 0,
            handle: 0,
            lines: 0,
            acked: 0,
            concerned: 0,
            tell: 0,
            held: 0,
            listed_at: 0,
            listed: 0,
            lost: 0,
            understood: 0,
            partial: 0,
            own_setup: 0,
            counter: Counter::new(),
            slots: [const { Slot::new() }; OLP_WINDOW_MAX],
            devices: Devices::new(),
        };
        Self { receiver: Receiver::new(), session }
    }

    /// Replaces the settings. For a session that has just begun.
    pub fn set(&mut self, settings: &Settings) {
        // One by one, which never becomes a call of memcpy.
        let own = &mut self.session.settings;
        own.timeout_ms = settings.timeout_ms;
        own.answer_ms = settings.answer_ms;
        own.repeat_ms = settings.repeat_ms;
        own.repeats = settings.repeats;
        own.recognises = settings.recognises;
    }

    /// What is in force on the link.
    #[must_use]
    pub fn link(&self) -> Link {
        let Link { ack, checksum, windowsize } = self.session.link;
        Link { ack: (ack != 0).into(), checksum: (checksum != 0).into(), windowsize: windowsize.max(1) }
    }

    /// The devices that have signed in. Their places in this list do not change.
    #[must_use]
    pub fn devices(&self) -> &[Device] {
        self.session.devices.all()
    }

    /// A device that has signed in.
    #[must_use]
    pub fn device(&self, index: usize) -> Option<&Device> {
        self.session.devices.get(index)
    }

    /// How the link does.
    #[must_use]
    pub const fn health(&self) -> &Health {
        &self.session.health
    }

    /// Takes received bytes, up to the end of a line, and tells how many that were. [`poll`](Self::poll) makes room
    /// for the rest. `now` is when they came.
    pub fn receive(&mut self, input: &[u8], now: u32) -> usize {
        let session = &mut self.session;
        session.release();
        let mut taken = 0;
        if session.held == 0 {
            session.heard_at = stamp(now);
            let received;
            (taken, received) = self.receiver.take(input);
            match received {
                // A line's length fits an int.
                Received::Line(length) => session.held = c_int::try_from(length).unwrap_or_default(),
                Received::Overlong => session.held = -1,
                Received::Nothing => (),
            }
            session.understood = 0;
        }
        session.partial = (taken < input.len()).into();
        if session.partial != 0 {
            count(&mut session.health.overflows);
        }
        taken
    }

    /// The next event; `None` when nothing has happened.
    pub fn poll(&mut self, now: u32) -> Option<Event<'_>> {
        let Self { receiver, session } = self;
        let line = receiver.line(usize::try_from(session.held).unwrap_or_default());
        let mut happened = session.next_to_tell();
        if happened.is_none() && session.held != 0 && session.understood == 0 {
            session.understood = 1;
            session.look_at(line, now);
            happened = session.next_to_tell();
        }
        if happened.is_none() {
            session.release();
            // What was received already may end what would time out.
            if session.partial == 0 {
                session.look_at_the_time(now);
            }
            session.partial = 0;
            happened = session.next_to_tell();
        }
        session.event(happened?, line)
    }

    /// Writes the next line to send, if it fits in that room, and tells its length; 0 when there is none. To be
    /// called after [`poll`](Self::poll); `now` is when it leaves.
    pub fn output(&mut self, line: &mut [u8; COMMAND_MAX], room: usize, now: u32) -> usize {
        self.session.output(line, room, now)
    }

    /// How many milliseconds may pass until [`poll`](Self::poll) or [`output`](Self::output) has something to do
    /// without having received anything; `None` when only receiving or a command brings anything about. To be asked
    /// when there are no events and no lines left.
    #[must_use]
    pub fn next_deadline(&self, now: u32) -> Option<u32> {
        let session = &self.session;
        if session.tell != 0 || session.held != 0 && session.understood == 0 {
            return Some(0);
        }
        session.next_deadline(now)
    }
}

impl Session {
    /// Lets go of the line, when all that it means has been told.
    fn release(&mut self) {
        if self.held != 0 && self.understood != 0 && self.tell == 0 {
            self.held = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{COMMAND_MAX, Host, Settings};
    use proptest::prelude::*;
    use std::format;
    use std::string::String;
    use std::vec::Vec;

    #[test]
    fn a_line_came_when_it_was_taken() {
        let mut host = Host::new(Settings::new());
        host.send(b"c=set", b"x").unwrap();
        host.output(&mut [0; COMMAND_MAX], COMMAND_MAX, 20);
        host.receive(b"c=set_resp&id=x\n", 30);
        assert_eq!(host.receive(b"c=later\n", 90), 0);
        host.poll(100);
        assert_eq!(host.health().rtt_last, 10);
    }

    /// All that a session tells and sends when these bytes come in pieces.
    fn told(pieces: &[&[u8]]) -> Vec<String> {
        let mut host = Host::new(Settings { recognises: 1, ..Settings::new() });
        let mut told = Vec::new();
        for command in [&b"c=set&n=1"[..], b"c=set&n=2", b"c=linksetup&ack=on"] {
            host.send(command, b"x").unwrap();
        }
        for piece in pieces {
            let mut rest = *piece;
            loop {
                let taken = host.receive(rest, 0);
                rest = &rest[taken..];
                while let Some(event) = host.poll(0) {
                    told.push(format!("{event:?}"));
                }
                let mut line = [0; COMMAND_MAX];
                for _ in 0..100 {
                    match host.output(&mut line, COMMAND_MAX, 0) {
                        0 => break,
                        length => told.push(String::from_utf8(line[..length].to_vec()).unwrap()),
                    }
                }
                if rest.is_empty() {
                    break;
                }
            }
        }
        told
    }

    /// Lines that mean something, whole or not.
    fn traffic() -> impl Strategy<Value = Vec<u8>> {
        const LINES: [&[u8]; 11] = [
            b"c=ack&checksum=null&t=0&id=x\n",
            b"c=ack&checksum=null&t=1&id=x\r\n",
            b"c=set_resp&id=x&t=1\n",
            b"c=onerror&code=checksum&t=2&id=x\n",
            b"c=onerror&code=unknownid&t=1&id=x\n",
            b"c=linksetup&windowsize=3&ack=on&checksum=fletcher16&t=9&id=x\n",
            b"c=linksetup_resp&ack=on&checksum=none&id=x&t=9\n",
            b"c=welcome&id=x&type=y\n",
            b"c=heaterinfo&temp=1&t=200\n",
            b"c=x&y=%\n",
            b"c=se",
        ];
        let line = prop::sample::select(&LINES[..]);
        prop::collection::vec(line, 0..12).prop_map(|lines| lines.concat())
    }

    proptest! {
        #[test]
        fn pieces_make_no_difference(bytes in traffic(), cuts in prop::collection::vec(1..40_usize, 400)) {
            let mut pieces = Vec::from([&[][..]]);
            let mut rest = &bytes[..];
            for cut in cuts {
                let (piece, behind) = rest.split_at(cut.min(rest.len()));
                pieces.push(piece);
                rest = behind;
            }
            // The commands leave before the first byte, too.
            prop_assert_eq!(told(&[&[], &bytes]), told(&pieces));
        }
    }
}
