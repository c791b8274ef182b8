//! What a command brings about.

use super::order::{Opening, Verdict};
use super::{AXIS, Event, Motion};
use crate::counter::count;
use crate::gx::{Fault, Format, Item, MASK_AXES, Message, Number};

impl Motion {
    /// Deals with what was received, if anything.
    pub(super) fn look_at(&mut self, item: &Item) -> Option<()> {
        let message = item.message()?;
        let (number, format) = (item.number(), item.format());
        match &message {
            Message::Move(vector) | Message::Step(vector) => self.command(&message, vector.mask, number, format),
            Message::Reporting(period) => {
                self.reports.switch(*period, format);
                self.untold.put(Event::Reporting(*period));
                match number {
                    Some(number) => self.asked(number),
                    None => self.order.forget(),
                }
            }
            Message::Malformed(code) => {
                count(&mut self.health.malformed);
                if let Some(number) = number {
                    // Those behind it are out of order, as it tells itself.
                    self.order.refuses(number.value);
                }
                self.refuse(number, format, *code);
            }
            // A receiver of commands tells no others.
            _ => (),
        }
        Some(())
    }

    /// Reports were asked for, with a number.
    fn asked(&mut self, number: Number) {
        let opening = self.order.ask(number.value, self.only_in_order());
        if opening != Opening::None {
            self.queue.silence();
            self.notices.clear();
            self.untold.put(Event::Begun(Some(number)));
        }
        if let Opening::Behind(first) = opening {
            self.notices.push(Some(Number { value: first, format: number.format }), number.format, 0);
        }
        self.notices.push(Some(number), number.format, 0);
    }

    const fn only_in_order(&self) -> bool {
        self.settings.only_in_order != 0
    }

    fn command(&mut self, message: &Message<'_>, named: u8, number: Option<Number>, format: Format) {
        self.order.forget();
        let code = match self.order.judge(number.map(|number| number.value), self.only_in_order()) {
            Verdict::Next => match self.queue_up(message, named, number) {
                Ok(()) => return,
                Err(code) => code,
            },
            Verdict::Repeat(behind) => {
                count(&mut self.health.repeats);
                self.untold.put(Event::Repeated(number));
                if usize::from(behind) < self.queue.awaited().count() {
                    self.reports.one(format);
                } else if let Some(number) = number {
                    self.notices.push(Some(number), number.format, 0);
                }
                return;
            }
            Verdict::Refuse(code) => code,
        };
        count(&mut self.health.refused);
        if number.is_none_or(|number| self.order.refuses(number.value)) {
            self.refuse(number, format, code);
        } else {
            self.untold.put(Event::Refused(number, code));
        }
    }

    /// # Errors
    ///
    /// The code of the refusal.
    fn queue_up(&mut self, message: &Message<'_>, named: u8, number: Option<Number>) -> Result<(), u8> {
        if named & MASK_AXES & !self.settings.axes() != 0 {
            return Err(AXIS);
        }
        if !self.queue.has_room() {
            return Err(Fault::Busy as u8);
        }
        self.queue.push(message, named, number).map_err(|_| Fault::Limit as u8)?;
        self.order.taken();
        count(&mut self.health.moves);
        self.untold.put(Event::Queued(number));
        Ok(())
    }

    fn refuse(&mut self, number: Option<Number>, format: Format, code: u8) {
        self.notices.push(number, format, code);
        self.untold.put(Event::Refused(number, code));
    }
}
