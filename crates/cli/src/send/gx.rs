//! Moves of GX.

use std::collections::VecDeque;

use deltarobot_protocols::gx::host::{self, Event, Outcome, Settings};
use deltarobot_protocols::gx::{CommandReceiver, Kind, Vector};
use serde_json::json;

use super::{Arguments, Link, Report, Session};
use crate::decoder::gx::reason;
use crate::status::{Failure, Status};

type Host = host::Host<16>;

#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Options of --protocol gx")]
pub(super) struct GxOptions {
    /// Sends in ASCII; in binary by default
    #[arg(long)]
    ascii: bool,
    /// The machine only sends numbers back, as the posted proposal has it: one move at a time, without a session
    #[arg(long)]
    echo: bool,
}

impl GxOptions {
    /// The first of them that was given.
    pub(super) fn given(&self) -> Option<&'static str> {
        self.ascii.then_some("--ascii").or_else(|| self.echo.then_some("--echo"))
    }
}

/// Reads a move in ASCII.
pub(super) fn parse(text: &str) -> Result<(String, Vector), Failure> {
    let mut receiver = CommandReceiver::new();
    let line = format!("{}\n", text.trim_end());
    match receiver.receive(line.as_bytes()) {
        (taken, Some(Kind::Move)) if taken + 1 >= line.len() && receiver.number().is_none() => {
            Ok((text.to_owned(), *receiver.vector()))
        }
        (_, Some(Kind::Malformed)) => Err(Failure::Usage(format!("{text}: {}", reason(receiver.code())))),
        _ => Err(Failure::Usage(format!("{text}: no move, such as V1000x400y300, without a number"))),
    }
}

pub(super) fn send(
    arguments: &Arguments,
    moves: &[(String, Vector)],
    link: &mut Link,
    report: &mut Report,
) -> Result<Status, Failure> {
    let mut settings = Settings::new();
    settings.answer_ms = arguments.answer_ms(&link.device);
    settings.probe_ms = settings.answer_ms.saturating_mul(4);
    settings.gap_ms = u32::try_from(link.device.gap().as_millis()).unwrap_or(u32::MAX);
    settings.attempts = arguments.attempts.map_or(0, i16::from);
    settings.ascii = arguments.gx.ascii.into();
    settings.echo = arguments.gx.echo.into();
    let mut sender = Sender {
        host: Host::new(settings),
        rest: moves.iter().cloned().collect(),
        sent: VecDeque::new(),
        status: None,
    };
    link.run(&mut sender, report)
}

struct Sender {
    host: Host,
    rest: VecDeque<(String, Vector)>,
    /// The texts of those that have not ended.
    sent: VecDeque<String>,
    /// How the first ended that was not finished.
    status: Option<Status>,
}

impl Session for Sender {
    fn handle(&mut self, now: u32, report: &mut Report) -> Option<Status> {
        while let Some(event) = self.host.poll(now) {
            let Event::Ended(outcome, code) = event else { continue };
            let (name, status) = match outcome {
                Outcome::Finished => ("finished", Status::Finished),
                Outcome::Refused => ("refused", Status::NotDone),
                Outcome::Failed => ("failed", Status::NotDone),
                Outcome::Dropped => ("dropped", Status::NotDone),
                Outcome::TimedOut => ("timed out", Status::TimedOut),
                Outcome::Lost => ("lost, as the machine has restarted", Status::TimedOut),
                Outcome::Deviated => ("finished elsewhere, as a command was damaged", Status::NotDone),
            };
            let reason = (code != 0).then(|| reason(code));
            let command = self.sent.pop_front().unwrap_or_default();
            report.ended(&command, name, reason.as_deref(), json!({ "reason": reason }));
            if status != Status::Finished {
                self.status.get_or_insert(status);
            }
        }
        // What is not sent yet is not begun any more when one has failed.
        while self.status.is_none()
            && let Some((text, target)) = self.rest.pop_front()
        {
            if self.host.move_to(&target).is_err() {
                self.rest.push_front((text, target));
                break;
            }
            self.sent.push_back(text);
        }
        self.sent.is_empty().then(|| self.status.unwrap_or(Status::Finished))
    }

    fn output(&mut self, room: &mut [u8], now: u32) -> usize {
        self.host.output(room, now)
    }

    fn receive(&mut self, bytes: &[u8], now: u32) -> usize {
        self.host.receive(bytes, now)
    }

    fn next_deadline(&self, now: u32) -> Option<u32> {
        self.host.next_deadline(now)
    }
}
