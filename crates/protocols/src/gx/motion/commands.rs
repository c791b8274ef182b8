//! What a command brings about.

use super::order::{Begun, Verdict};
use super::{HELD, Motion, STOPPING, event};
use crate::gx::{Control, Fault, Format, Kind, MASK_AXES, Numbered};
use crate::session::count;

impl<const QUEUE: usize> Motion<QUEUE> {
    /// Deals with what the receiver has found.
    pub(super) fn handle(&mut self, kind: Kind) {
        let (number, format) = (self.receiver.numbered(), self.receiver.format());
        match kind {
            Kind::Move | Kind::Step => self.handle_move(kind == Kind::Step, number, format),
            Kind::Reporting => self.handle_reporting(number, format),
            Kind::Control => self.handle_control(number, format),
            // A receiver of commands finds nothing else.
            _ => {
                count(&mut self.health.malformed);
                if number.is_some() {
                    // Those behind it are out of order, as their error notice would say.
                    self.order.refuses(number.value());
                }
                self.refuse(number, format, self.receiver.code());
            }
        }
    }

    fn handle_reporting(&mut self, number: Numbered, format: Format) {
        let period = self.receiver.period();
        self.reports.switch(period, format);
        self.pending.set_reporting(period);
        if !number.is_some() {
            self.order.forget();
            return;
        }
        let begun = self.order.ask(number.value(), self.settings.only_in_order != 0);
        if begun != Begun::None {
            self.queue.begin_session();
            self.notices.clear();
            self.pending.set(event::BEGUN, number, 0);
        }
        if let Begun::Behind(first) = begun {
            self.notices.push(Numbered::new(first, number.format()), format, 0);
        }
        self.notices.push(number, format, 0);
    }

    fn handle_control(&mut self, number: Numbered, format: Format) {
        self.order.forget();
        match Control::of(self.receiver.bits()) {
            Some(Control::Query) => {}
            Some(Control::Hold) => {
                self.halt = self.halt.max(HELD);
                self.pending.set(event::HOLD, number, 0);
            }
            Some(Control::Resume) => {
                if self.halt == HELD {
                    self.halt = 0;
                }
                self.pending.set(event::RESUME, number, 0);
            }
            Some(Control::Stop) => self.demand_stop(Fault::Stopped, format),
            None => return self.refuse(number, format, Fault::Unknown as u8),
        }
        self.reports.answer(format, self.halt != STOPPING);
        if number.is_some() {
            self.notices.push(number, format, 0);
        }
    }

    /// The machine is to stop, and to say so.
    pub(super) fn demand_stop(&mut self, fault: Fault, format: Format) {
        self.halt = STOPPING;
        self.pending.set(event::STOP, Numbered::NONE, fault as u8);
        self.reports.answer(format, false);
    }

    fn handle_move(&mut self, is_step: bool, number: Numbered, format: Format) {
        self.order.forget();
        let fault = match self.order.judge(number, self.settings.only_in_order != 0) {
            Verdict::Next => match self.queue_up(is_step, number) {
                Ok(()) => return,
                Err(fault) => fault,
            },
            Verdict::Repeat => {
                count(&mut self.health.repeats);
                self.pending.set(event::REPEATED, number, 0);
                if self.queue.awaits(number) {
                    self.reports.one(format);
                } else {
                    self.notices.push(number, format, 0);
                }
                return;
            }
            Verdict::Refuse(fault) => fault,
        };
        count(&mut self.health.refused);
        if !number.is_some() || self.order.refuses(number.value()) {
            self.refuse(number, format, fault as u8);
        } else {
            self.pending.set(event::REFUSED, number, fault as u8);
        }
    }

    /// # Errors
    ///
    /// The reason of the refusal.
    fn queue_up(&mut self, is_step: bool, number: Numbered) -> Result<(), Fault> {
        let vector = self.receiver.vector();
        if vector.mask & MASK_AXES & !self.settings.axes() != 0 {
            return Err(Fault::Axis);
        }
        if !self.queue.has_room() {
            return Err(Fault::Busy);
        }
        self.queue.push(vector, is_step, number).map_err(|_| Fault::Limit)?;
        self.order.taken();
        count(&mut self.health.moves);
        self.pending.set(event::QUEUED, number, 0);
        Ok(())
    }

    fn refuse(&mut self, number: Numbered, format: Format, code: u8) {
        self.notices.push(number, format, code);
        self.pending.set(event::REFUSED, number, code);
    }
}
