//! Moves of GX.

use std::collections::VecDeque;

use deltarobot_protocols::gx::host::{self, Event, Outcome, Settings};
use deltarobot_protocols::gx::{self, CommandReceiver, Control, Kind, Vector};
use serde_json::{Value, json};

use super::{Arguments, Link, Report, Session};
use crate::decoder::gx::{control_name, position, position_json, reason};
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

/// What is to be sent.
pub(super) enum Commands {
    /// Moves, with their texts.
    Moves(VecDeque<(String, Vector)>),
    /// What is asked for past the queue.
    Control(Control),
}

impl Commands {
    pub(super) fn parse(texts: &[String]) -> Result<Self, Failure> {
        let control = |text: &String| {
            let known = [Control::Query, Control::Hold, Control::Resume, Control::Stop];
            known.into_iter().find(|control| control_name(*control) == text)
        };
        match (texts, texts.iter().find_map(control)) {
            ([_], Some(control)) => Ok(Self::Control(control)),
            (_, Some(control)) => Err(Failure::Usage(format!("{}: it has to stand alone", control_name(control)))),
            _ => texts.iter().map(|text| parse(text)).collect::<Result<_, _>>().map(Self::Moves),
        }
    }
}

/// Reads a move in ASCII.
fn parse(text: &str) -> Result<(String, Vector), Failure> {
    let mut receiver = CommandReceiver::new();
    let line = format!("{}\n", text.trim_end());
    match receiver.receive(line.as_bytes()) {
        (taken, Some(Kind::Move)) if taken + 1 >= line.len() && receiver.number().is_none() => {
            Ok((text.to_owned(), *receiver.vector()))
        }
        (_, Some(Kind::Malformed)) => Err(Failure::Usage(format!("{text}: {}", reason(receiver.code())))),
        _ => {
            let text =
                format!("{text}: no move, such as V1000x400y300, without a number, nor query, hold, resume or stop");
            Err(Failure::Usage(text))
        }
    }
}

pub(super) fn send(
    arguments: &Arguments,
    commands: Commands,
    link: &mut Link,
    report: &mut Report,
) -> Result<Status, Failure> {
    let mut settings = Settings::default();
    settings.answer_ms = arguments.answer_ms(&link.device);
    settings.probe_ms = settings.answer_ms.saturating_mul(4);
    settings.gap_ms = u32::try_from(link.device.gap().as_millis()).unwrap_or(u32::MAX);
    settings.attempts = arguments.attempts.map_or(0, i16::from);
    settings.ascii = arguments.gx.ascii.into();
    settings.echo = arguments.gx.echo.into();
    let mut host = Host::new(settings);
    let (rest, control) = match commands {
        Commands::Moves(moves) => (moves, None),
        Commands::Control(control) => (VecDeque::new(), Some(control)),
    };
    if let Some(control) = control {
        host.control(control);
    }
    let mut sender = Sender { host, rest, sent: VecDeque::new(), control, has_session: false, status: None };
    link.run(&mut sender, report)
}

struct Sender {
    host: Host,
    rest: VecDeque<(String, Vector)>,
    /// The texts of those that have not ended.
    sent: VecDeque<String>,
    /// What is asked for past the queue and not answered; after an interruption a stop.
    control: Option<Control>,
    has_session: bool,
    /// How the first ended that was not finished.
    status: Option<Status>,
}

impl Sender {
    fn ended(&mut self, outcome: Outcome, code: u8, report: &mut Report) {
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

    /// How what was asked for has ended.
    fn answered(&mut self, outcome: &str, said: Option<&str>, more: Value, status: Status, report: &mut Report) {
        if let Some(control) = self.control.take() {
            report.ended(control_name(control), outcome, said, more);
            self.status.get_or_insert(status);
        }
    }
}

impl Session for Sender {
    fn handle(&mut self, now: u32, report: &mut Report) -> Option<Status> {
        let was_asked = self.control.is_some();
        while let Some(event) = self.host.poll(now) {
            match event {
                Event::Begun => self.has_session = true,
                Event::Ended(outcome, code) => self.ended(outcome, code, report),
                Event::Stopped(at) => {
                    let (said, more) = (position(at), json!({ "position": position_json(at) }));
                    self.answered("finished", Some(&said), more, Status::Finished, report);
                }
                Event::Status(status) if self.control.is_some_and(|control| is_answer(control, status)) => {
                    let said = format!("{}room for {} moves", if status.is_held { "held, " } else { "" }, status.free);
                    let more = json!({ "held": status.is_held, "free": status.free });
                    self.answered("finished", Some(&said), more, Status::Finished, report);
                }
                Event::Unanswered(_) => self.answered("not answered", None, json!({}), Status::TimedOut, report),
                _ => {}
            }
        }
        // What is not sent yet is not begun any more when one has failed.
        while self.status.is_none()
            && self.control.is_none()
            && let Some((text, target)) = self.rest.pop_front()
        {
            if self.host.move_to(&target).is_err() {
                self.rest.push_front((text, target));
                break;
            }
            self.sent.push_back(text);
        }
        let is_over = if was_asked { self.control.is_none() } else { self.sent.is_empty() };
        is_over.then(|| self.status.unwrap_or(Status::Finished))
    }

    /// The first time the machine is stopped, if it has moves.
    fn interrupt(&mut self) -> bool {
        let ends = self.control.is_some() || !self.has_session;
        if !ends {
            self.control = Some(Control::Stop);
            self.host.control(Control::Stop);
            self.status = Some(Status::Cancelled);
        }
        ends
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

/// Whether a status says that what was asked for is so.
fn is_answer(control: Control, status: gx::Status) -> bool {
    match control {
        Control::Query => true,
        Control::Hold => status.is_held,
        Control::Resume => !status.is_held,
        Control::Stop => false,
    }
}
