//! The lines that a link sends, and what they are filled with.

use zerocopy::FromBytes;

use super::{Fault, ID_MAX, LINKSETUP, Request, Setup, is_id};
use crate::line::encoder::Encoder;

/// Room for any line of the link's own.
pub const LINK_LINE_MAX: usize = 80;

/// What lines are filled with.
#[derive(Clone, Debug, FromBytes)]
#[repr(C)]
pub(super) struct Lines {
    /// The t of the next message.
    pub(super) next: u8,
    pub(super) setup: Setup,
    /// Not 0: lines about the setup have the window even if that is 1.
    pub(super) has_window: u8,
    /// The command that was accepted last.
    pub(super) request: Request,
    /// The device that lines are of, if a device can have that id.
    id_length: u8,
    id: [u8; ID_MAX],
}

impl Lines {
    pub(super) const fn new() -> Self {
        let request = Request { t: 0, has_t: 0, place: 0, sum: 0 };
        let setup = Setup::new(false, false, 0);
        Self { next: 0, setup, has_window: 0, request, id_length: 0, id: [0; ID_MAX] }
    }

    #[cfg_attr(target_pointer_width = "16", inline(never))]
    pub(super) fn speak_for(&mut self, id: &[u8]) {
        self.id_length = 0;
        if is_id(id) {
            for (place, byte) in self.id.iter_mut().zip(id) {
                *place = *byte;
                self.id_length = self.id_length.wrapping_add(1);
            }
        }
    }

    /// The device that lines are of.
    #[cfg_attr(target_pointer_width = "16", inline(never))]
    pub(super) fn id(&self) -> &[u8] {
        self.id.get(..usize::from(self.id_length)).unwrap_or_default()
    }

    /// Ends a line by id and t.
    #[cfg_attr(target_pointer_width = "16", inline(never))]
    pub(super) fn end(&self, line: &mut Encoder, id: &[u8]) -> usize {
        add_id(line, id);
        line.number(b"&t=", self.next.into());
        line.finish(false).unwrap_or(0)
    }

    /// Ends a line by t, the command's if it answers one that has one, and id.
    #[cfg_attr(target_pointer_width = "16", inline(never))]
    pub(super) fn end_by_id(&self, line: &mut Encoder, answers: bool) -> usize {
        let mut t = self.next;
        if answers {
            t = self.request.t;
        }
        if !answers || self.request.has_t != 0 {
            line.number(b"&t=", t.into());
        }
        add_id(line, self.id());
        line.finish(false).unwrap_or(0)
    }

    /// Writes an ack.
    #[cfg_attr(target_pointer_width = "16", inline(never))]
    pub(super) fn write_ack(&self, room: &mut [u8]) -> usize {
        let mut line = Encoder::resume(room, 0);
        line.put_all(b"c=ack&checksum=");
        if self.setup.checks() {
            line.put_hex(self.request.sum);
        } else {
            line.put_all(b"null");
        }
        self.end_by_id(&mut line, true)
    }

    /// Writes an `onerror`, which answers the command or is an event.
    #[cfg_attr(target_pointer_width = "16", inline(never))]
    pub(super) fn write_fault(&self, fault: Fault, answers: bool, room: &mut [u8]) -> usize {
        let mut line = Encoder::resume(room, 0);
        line.put_all(b"c=onerror&code=");
        line.put_all(fault.code());
        self.end_by_id(&mut line, answers)
    }

    /// Writes which setup is in force.
    #[cfg_attr(target_pointer_width = "16", inline(never))]
    pub(super) fn write_setup(&self, answers: bool, room: &mut [u8]) -> usize {
        let mut line = Encoder::resume(room, 0);
        line.put_all(b"c=");
        line.put_all(LINKSETUP);
        if answers {
            line.put_all(b"_resp");
        }
        if self.has_window != 0 || self.setup.window() != 1 {
            line.word(b"windowsize", self.setup.window().into());
        }
        line.text(b"ack", if self.setup.acks() { b"on" } else { b"off" });
        line.text(b"checksum", if self.setup.checks() { b"fletcher16" } else { b"none" });
        if answers { self.end(&mut line, self.id()) } else { self.end_by_id(&mut line, false) }
    }
}

#[cfg_attr(target_pointer_width = "16", inline(never))]
fn add_id(line: &mut Encoder, id: &[u8]) {
    if !id.is_empty() {
        line.put_all(b"&id=");
        line.put_all(id);
    }
}
