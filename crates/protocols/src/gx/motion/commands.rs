//! What a command brings about.

use super::order::{Begun, Verdict};
use super::{EventKind, HELD, Motion, STOPPING};
use crate::gx::{Control, Fault, Format, Kind, MASK_AXES, Numbered};
use crate::session::count;

impl<const QUEUE: usize> Motion<QUEUE> {
    /// Deals with what the receiver has found: that is at most one event, and one notice that answers it.
    pub(super) fn handle(&mut self, kind: Kind) {
        let (number, format) = (self.receiver.number, self.receiver.format());
        let mut fault = 0;
        let mut is_answered = number.is_some();
        let event = match kind {
            Kind::Move | Kind::Step => match self.take_move(kind == Kind::Step, number) {
                Verdict::Next => {
                    is_answered = false;
                    Some(EventKind::Queued)
                }
                Verdict::Repeat => {
                    count(&mut self.health.repeats);
                    if self.queue.awaited(number).is_some() {
                        self.reports.one(format);
                        is_answered = false;
                    }
                    Some(EventKind::Repeated)
                }
                Verdict::Refuse(why) => {
                    count(&mut self.health.refused);
                    fault = why as u8;
                    is_answered = !is_answered || self.order.refuses(number.value());
                    Some(EventKind::Refused)
                }
            },
            Kind::Reporting => Some(self.handle_reporting(number, format)),
            Kind::Control => {
                self.order.forget();
                if let Some(control) = Control::of(self.receiver.bits()) {
                    self.handle_control(control, format)
                } else {
                    fault = Fault::Unknown as u8;
                    is_answered = true;
                    Some(EventKind::Refused)
                }
            }
            // A receiver of commands finds nothing else.
            _ => {
                count(&mut self.health.malformed);
                if is_answered {
                    // Those behind it are out of order, as their error notice would say.
                    self.order.refuses(number.value());
                }
                fault = self.receiver.code();
                is_answered = true;
                Some(EventKind::Refused)
            }
        };
        if is_answered {
            self.notices.push(number, format, fault);
        }
        if event == Some(EventKind::Stop) {
            fault = Fault::Stopped as u8;
        }
        self.pending.set(event, number, fault);
    }

    /// Queues a move, if it is to be taken; else says why not.
    fn take_move(&mut self, is_step: bool, number: Numbered) -> Verdict {
        self.order.forget();
        let verdict = self.order.judge(number, self.settings.only_in_order != 0);
        if verdict != Verdict::Next {
            return verdict;
        }
        let vector = self.receiver.vector();
        if vector.mask & MASK_AXES & !self.settings.axes() != 0 {
            return Verdict::Refuse(Fault::Axis);
        }
        if self.queue.free() == 0 {
            return Verdict::Refuse(Fault::Busy);
        }
        if self.queue.push(vector, is_step, number).is_err() {
            return Verdict::Refuse(Fault::Limit);
        }
        self.order.taken();
        count(&mut self.health.moves);
        verdict
    }

    fn handle_reporting(&mut self, number: Numbered, format: Format) -> EventKind {
        self.reports.switch(self.receiver.period(), format);
        if !number.is_some() {
            self.order.forget();
            return EventKind::Reporting;
        }
        let begun = self.order.ask(number.value(), self.settings.only_in_order != 0);
        if begun == Begun::None {
            return EventKind::Reporting;
        }
        self.queue.begin_session();
        self.notices.clear();
        if let Begun::Behind(first) = begun {
            self.notices.push(Numbered::new(first, number.format()), format, 0);
        }
        EventKind::Begun
    }

    fn handle_control(&mut self, control: Control, format: Format) -> Option<EventKind> {
        let event = match control {
            Control::Query => None,
            Control::Hold => {
                self.halt = self.halt.max(HELD);
                Some(EventKind::Hold)
            }
            Control::Resume => {
                if self.halt == HELD {
                    self.halt = 0;
                }
                Some(EventKind::Resume)
            }
            Control::Stop => {
                self.halt = STOPPING;
                Some(EventKind::Stop)
            }
        };
        self.reports.answer(format, self.halt != STOPPING);
        event
    }
}
