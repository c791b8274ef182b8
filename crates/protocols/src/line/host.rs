//! The PC's end of the link: commands go in, outcomes and what the devices report come out.
//!
//! A [`Host`] does no I/O: it is fed the bytes that were received and the time, and asked for the bytes to send and for
//! events. It keeps one line: [`receive`](Host::receive) takes bytes up to the end of a line, and more only when all
//! that the line meant has been returned.
//!
//! # A command
//!
//! is queued as its caller built it; the session adds `t` and `id`, and `s` where checksums are in force. It leaves
//! when none of those that are out is forgotten by the device for it: that remembers as many commands as the window
//! has, in the order in which they were executed. It ends exactly once, as [`Outcome`] tells:
//!
//! - Answered: `<name>_resp` from its id came; where acks are in force, behind its ack. (Never matched by `t`, which
//!   sources give differently. Of several that could be meant, the oldest is.) Or an `onerror` with the code `toolong`:
//!   it was executed, but can't be answered.
//! - Refused: `onerror` with the code `unknowncommand`, `unknownid` or `refused`, its `t` and its id came; where acks
//!   are in force, directly behind its ack, as that way of the line has no checksums.
//! - Timed out: neither came, though it was repeated.
//! - Restarted: the device has restarted meanwhile. A repeat could be executed a second time.
//!
//! # Retransmission
//!
//! A command that is sent again is the same line with the same `t`, by which some devices recognise it, and answer
//! again without executing it again. That is assumed only when [`Settings::recognises`] says so. Any device is sent a
//! command again when its ack (with the right checksum, where these are in force) is overdue. One that recognises
//! repeats is also sent a command whose answer is overdue, with acks or without, and, when it reports damage, at once
//! the oldest that it has not acknowledged. Others get that only if a single command is out and it was sent once: a
//! line that falls apart is reported more than once, and of several commands it is not known which was damaged.
//! `linksetup` always is sent again, as doing that twice is no harm.
//!
//! Timeouts follow the round trips that were measured (RFC 6298) and the line's speed. No more bytes are sent than the
//! device's receive buffer takes beside those that it has not answered yet. Without acks, no two commands of one name
//! and id are out at a time. With a window of more than 1, a repeated command is executed behind later ones.
//!
//! A repeat can be recognised only while the device remembers the command. Therefore none is sent later than
//! [`Settings::repeat_ms`] or after 128 other messages, and no new command has the number and the words of one of the
//! last 64. A program that has just started does not know these, and should begin with a `linksetup`, at which a device
//! forgets what it remembers. That travels alone: it waits until all before it have ended, and all behind it until it
//! has.
//!
//! # What can be relied on
//!
//! With acks and checksums, and a device that recognises repeats as [`crate::line`] does: a command is not carried out
//! twice; answered means executed once, refused not at all, but for damaged lines whose checksum is right by chance,
//! one in some 65000. Without checksums a command may be executed otherwise than it was sent; without acks, the answer
//! to one that has timed out may count for the next with that name and id, if it comes then.
//!
//! ```
//! use deltarobot_protocols::line::host::{Event, Host, Outcome, Settings};
//!
//! let mut host = Host::<256, 9, 16>::new(Settings::default());
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
mod estimator;
mod event;
mod incoming;
mod queue;
mod settings;
mod slot;
mod table;
mod timers;

use zerocopy::{FromBytes, FromZeros, Immutable, IntoBytes};

use super::encoder::COMMAND_MAX;
use super::message::Message;
use super::receiver::{Received, Receiver};
use crate::session::{Flags, RoundTrips, count};
use counter::Counter;
use estimator::Estimator;
use event::Pending;
pub use event::{Dropped, Event, Outcome};
pub use queue::QueueError;
use queue::Wanted;
use settings::SetupFields;
pub use settings::{Link, Settings};
use slot::Slot;
use table::Devices;
pub use table::{Device, ID_MAX, Listed, NAME_MAX, TYPE_MAX, VERSION_MAX};

/// A host session. All zero is a new one with default settings. `LINE` is one byte more than the longest line that is
/// received; `WINDOW` commands are kept at a time, one of them the session's own, and `DEVICES` devices.
#[derive(Clone, Debug, FromBytes)]
pub struct Host<const LINE: usize, const WINDOW: usize, const DEVICES: usize> {
    receiver: Receiver<LINE>,
    session: Session<WINDOW, DEVICES>,
}

/// A host session but for what it receives.
#[derive(Clone, Debug, FromBytes)]
struct Session<const WINDOW: usize, const DEVICES: usize> {
    settings: Settings,
    health: Health,
    /// When bytes were received last.
    heard_at: u32,
    /// When a line was fetched last, and how long from then on what was fetched leaves.
    fetched_at: u32,
    backlog: u32,
    acks: Estimator,
    answers: Estimator,
    link: Link,
    /// Place in the order and handle of the command queued last.
    order: u32,
    handle: u16,
    /// The window that was asked for last: a damaged answer shall not make it larger.
    asked: u16,
    /// Number of lines sent.
    lines: u32,
    /// Handle of the command whose ack was the last line, or 0; and of that which an event is about.
    acked: u16,
    concerned: u16,
    pending: Flags<Pending>,
    /// Number of messages lost.
    lost: u8,
    /// Not 0: the line in the receiver was handled; its events may be pending.
    handled: u8,
    /// Not 0: not all bytes were taken, so that it is too early for timeouts.
    partial: u8,
    /// Not 0: the device has just said what is in force.
    own_setup: u8,
    wanted: Wanted,
    counter: Counter,
    slots: [Slot; WINDOW],
    devices: Devices<DEVICES>,
}

/// Counters of a host session since it began; they wrap.
#[derive(Clone, Debug, Default, FromBytes, IntoBytes, Immutable)]
#[repr(C)]
pub struct Health {
    /// Lines received that can be read.
    pub lines: u32,
    /// Of these, acks, answers and refusals that nothing was waiting for.
    pub strays: u32,
    /// Lines that can't be read.
    pub malformed: u32,
    /// Lines that were too long.
    pub overlong: u32,
    /// Messages that the device has sent, as the gaps in their numbers show, and that were not received.
    pub lost: u32,
    /// Errors that the device has reported.
    pub errors: u32,
    /// Times that the device restarted.
    pub restarts: u32,
    /// Calls of `Host::receive` that did not take all bytes, because events were to be fetched first.
    pub overflows: u32,
    /// Acks and answers that did not come in time.
    pub timeouts: u32,
    /// Commands that were retransmitted, because of that or because the device has asked for it.
    pub repeats: u32,
    /// Round trips: from a command that was sent once to what came back first.
    pub round_trips: RoundTrips,
}

impl<const LINE: usize, const WINDOW: usize, const DEVICES: usize> Host<LINE, WINDOW, DEVICES> {
    /// A session that has just begun.
    pub fn new(settings: Settings) -> Self {
        const { assert!(1 < WINDOW && WINDOW <= 65 && DEVICES <= 255) }
        Self { receiver: Receiver::new(), session: Session { settings, ..Session::new_zeroed() } }
    }

    /// Replaces the settings. For a session that has just begun.
    pub const fn set(&mut self, settings: Settings) {
        self.session.settings = settings;
    }

    /// What is in force on the link.
    pub const fn link(&self) -> Link {
        self.session.link
    }

    /// The devices that have signed in. Their places in this list do not change.
    pub fn devices(&self) -> &[Device] {
        self.session.devices.all()
    }

    /// How the link does.
    pub const fn health(&self) -> &Health {
        &self.session.health
    }

    /// Takes received bytes, up to the end of a line, and returns how many that were. [`poll`](Self::poll) makes room
    /// for the rest. `now` is when they came.
    pub fn receive(&mut self, input: &[u8], now: u32) -> usize {
        let session = &mut self.session;
        if session.handled != 0 && session.pending.is_empty() {
            self.receiver.release();
        }
        if self.receiver.received() == Received::Nothing {
            session.heard_at = now;
            session.handled = 0;
        }
        let taken = self.receiver.take(input);
        session.partial = (taken < input.len()).into();
        if session.partial != 0 {
            count(&mut session.health.overflows);
        }
        taken
    }

    /// The next event; `None` when nothing has happened.
    pub fn poll(&mut self, now: u32) -> Option<Event<'_>> {
        let Self { receiver, session } = self;
        if session.pending.is_empty() && session.handled == 0 {
            session.handle(receiver.received(), now);
        }
        if session.pending.is_empty() {
            if session.handled != 0 {
                receiver.release();
            }
            // What was received already may end what would time out.
            if session.partial == 0 {
                session.on_timer(now);
            }
            session.partial = 0;
        }
        let line = if let Received::Line(line) = receiver.received() { line } else { &[] };
        session.next_event(line)
    }

    /// Writes the next line to send, if it fits in that room, and returns its length; 0 when there is none. To be
    /// called after [`poll`](Self::poll); `now` is when it leaves.
    pub fn output(&mut self, line: &mut [u8; COMMAND_MAX], room: usize, now: u32) -> usize {
        self.session.output(line, room, now)
    }

    /// How many milliseconds may pass until [`poll`](Self::poll) or [`output`](Self::output) has something to do
    /// without having received anything; `None` when only receiving or a command brings anything about. To be asked
    /// when there are no events and no lines left.
    pub fn next_deadline(&self, now: u32) -> Option<u32> {
        let unhandled = self.session.handled == 0 && self.receiver.has_ended();
        if unhandled || !self.session.pending.is_empty() {
            return Some(0);
        }
        self.session.next_deadline(now)
    }
}

#[cfg(test)]
mod tests {
    use super::{COMMAND_MAX, Settings};
    use proptest::prelude::*;

    type Host = super::Host<256, 9, 16>;

    #[test]
    fn a_line_came_when_it_was_taken() {
        let mut host = Host::new(Settings::default());
        host.send(b"c=set", b"x").unwrap();
        host.output(&mut [0; COMMAND_MAX], COMMAND_MAX, 20);
        host.receive(b"c=set_resp&id=x\n", 30);
        assert_eq!(host.receive(b"c=later\n", 90), 0);
        host.poll(100);
        assert_eq!(host.health().round_trips.last, 10);
    }

    /// All that a session reports and sends when these bytes come in pieces.
    fn told(pieces: &[&[u8]]) -> Vec<String> {
        let mut host = Host::new(Settings { recognises: 1, ..Settings::default() });
        let mut told = Vec::new();
        for command in [&b"c=set&n=1"[..], b"c=set&n=2", b"c=linksetup&ack=on"] {
            host.send(command, b"x").unwrap();
        }
        for piece in pieces {
            let mut rest = *piece;
            loop {
                rest = &rest[host.receive(rest, 0)..];
                while let Some(event) = host.poll(0) {
                    told.push(format!("{event:?}"));
                }
                let mut line = [0; COMMAND_MAX];
                while let length @ 1.. = host.output(&mut line, COMMAND_MAX, 0) {
                    told.push(String::from_utf8(line[..length].to_vec()).unwrap());
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
            let mut rest = &bytes[..];
            let cut = cuts.iter().filter_map(|cut| rest.split_off(..rest.len().min(*cut)));
            let pieces: Vec<_> = [&[][..]].into_iter().chain(cut).collect();
            // The commands leave before the first byte, too.
            prop_assert_eq!(told(&[&[], &bytes]), told(&pieces));
        }
    }
}
