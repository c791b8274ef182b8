//! Bytes and messages as they pass, for those who want them.

use std::sync::Arc;
use std::time::{Duration, Instant};

use deltarobot_cli::decoder::deltarobot::Frames;
use deltarobot_cli::decoder::{Decoder, Piece};
use deltarobot_cli::recording::{Entry, Side};

use super::Robot;
use crate::event::{Event, Message, What};
use crate::state::stamp;

pub(super) struct Tap {
    robot: Arc<Robot>,
    gap: Duration,
    decoder: Frames,
    /// When something came from either side, which has not been given up yet.
    heard: [Option<Instant>; 2],
}

const SIDES: [Side; 2] = [Side::Host, Side::Controller];

impl Tap {
    pub(super) fn new(robot: &Arc<Robot>, gap: Duration) -> Self {
        let robot = Arc::clone(robot);
        Self { robot, gap, decoder: Frames::default(), heard: [None; 2] }
    }

    fn has_readers(&self) -> bool {
        self.robot.messages.receiver_count() > 0 || self.robot.all.messages.receiver_count() > 0
    }

    pub(super) fn passed(&mut self, from: Side, bytes: &[u8]) {
        if self.robot.bytes.receiver_count() > 0 {
            let entry = Entry { time: self.robot.began.elapsed(), from, bytes: bytes.to_vec() };
            // They may have gone in between.
            let _ = self.robot.bytes.send(Arc::new(entry));
        }
        if self.has_readers() {
            for (heard, side) in self.heard.iter_mut().zip(SIDES) {
                if side == from {
                    *heard = Some(Instant::now());
                }
            }
            let pieces = self.decoder.feed(Some(from), bytes);
            self.emit(pieces);
        }
    }

    /// Time has passed.
    pub(super) fn idle(&mut self) {
        for (at, from) in SIDES.into_iter().enumerate() {
            let Some(heard) = self.heard.get_mut(at) else { continue };
            let Some(silence) = heard.map(|heard| heard.elapsed()) else { continue };
            if silence >= self.gap {
                *heard = None;
            }
            let pieces = self.decoder.idle(Some(from), silence, self.gap);
            self.emit(pieces);
        }
    }

    fn emit(&self, pieces: Vec<Piece>) {
        for piece in pieces {
            let what = What::Message(Message::new(stamp(), piece));
            let event = Arc::new(Event::new(Arc::clone(self.robot.name()), what));
            let _ = self.robot.messages.send(Arc::clone(&event));
            let _ = self.robot.all.messages.send(event);
        }
    }
}
