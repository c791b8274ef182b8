//! What was seen of the controller during a request, as a hint at what may be wrong.

use deltarobot_protocols::deltarobot::host::{Health, Outcome};
use deltarobot_protocols::deltarobot::{Report, State};

/// Bytes that are kept of both directions.
const KEPT: usize = 256;

#[derive(Debug, Default)]
pub(crate) struct Seen {
    sent: Vec<u8>,
    received: Vec<u8>,
    count: usize,
}

/// Kinds of what was received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Nothing,
    Echo,
    Garbage,
    Frames,
}

impl Seen {
    pub(crate) fn sent(&mut self, frame: &[u8]) {
        keep(&mut self.sent, frame);
    }

    pub(crate) fn received(&mut self, bytes: &[u8]) {
        keep(&mut self.received, bytes);
        self.count += bytes.len();
    }

    fn kind(&self, health: &Health) -> Kind {
        if self.count == 0 {
            Kind::Nothing
        } else if self.sent.starts_with(&self.received) {
            Kind::Echo
        } else if health.frames == 0 {
            Kind::Garbage
        } else {
            Kind::Frames
        }
    }

    /// The kind of it, for programs.
    pub(crate) fn name(&self, health: &Health) -> &'static str {
        match self.kind(health) {
            Kind::Nothing => "nothing",
            Kind::Echo => "echo",
            Kind::Garbage => "garbage",
            Kind::Frames => "frames",
        }
    }

    /// Why a request may have ended so, where it was not as it should.
    pub(crate) fn reason(&self, outcome: Outcome, health: &Health, report: Option<Report>) -> Option<String> {
        match outcome {
            Outcome::TimedOut => Some(match self.kind(health) {
                Kind::Nothing => "nothing was received: is this the right port, and the controller switched on?".into(),
                Kind::Echo => "only what was sent came back: an echo, as from a loopback or crossed lines".into(),
                Kind::Garbage => format!(
                    "{} bytes were received, but no message: is the speed right (--baud)? `deltarobot monitor` shows \
                     them",
                    self.count
                ),
                Kind::Frames => "messages were received, but no answer to this request".into(),
            }),
            Outcome::Refused => Some(match report {
                Some(report) if report.state() == State::Error => {
                    "the controller sent NACK: it is in state ERROR".into()
                }
                Some(report) if !report.position.is_finite() => {
                    "the controller sent NACK: it does not know its position, and has to home first".into()
                }
                _ => "the controller sent NACK".into(),
            }),
            _ => None,
        }
    }
}

fn keep(all: &mut Vec<u8>, more: &[u8]) {
    let room = KEPT.saturating_sub(all.len());
    all.extend(more.iter().take(room));
}
