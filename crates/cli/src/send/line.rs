//! Commands of the line protocol.

use deltarobot_protocols::line::COMMAND_MAX;
use deltarobot_protocols::line::host::{self, Event, Outcome, QueueError, Settings};
use serde_json::json;

use super::{Arguments, Link, Report, Session};
use crate::protocol::Protocol;
use crate::status::{Failure, Status};

/// The longest line of a device, commands and devices that are kept.
type Host = host::Host<1024, 8, 64>;

#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Options of --protocol line")]
pub(super) struct LineOptions {
    /// The id of the device that the commands are for
    #[arg(long, value_name = "ID")]
    id: Option<String>,
    /// Puts acks in force first
    #[arg(long)]
    ack: bool,
    /// Puts checksums in force first
    #[arg(long)]
    checksum: bool,
    /// The device recognises repeated commands: what may have been executed is sent again too
    #[arg(long)]
    recognises_repeats: bool,
}

impl LineOptions {
    /// The first of them that was given.
    pub(super) fn given(&self) -> Option<&'static str> {
        let given = [
            ("--id", self.id.is_some()),
            ("--ack", self.ack),
            ("--checksum", self.checksum),
            ("--recognises-repeats", self.recognises_repeats),
        ];
        given.into_iter().find_map(|(option, is_given)| is_given.then_some(option))
    }

    pub(super) fn check(&self, protocol: Protocol) -> Result<(), Failure> {
        if protocol == Protocol::Line && self.id.is_none() {
            return Err(Failure::Usage("--id is needed with --protocol line; `deltarobot monitor` shows ids".into()));
        }
        Ok(())
    }
}

pub(super) fn send(arguments: &Arguments, link: &mut Link, report: &mut Report) -> Result<Status, Failure> {
    let options = &arguments.line;
    let mut settings = Settings::default();
    // Twice what others take: at 9600 baud a line takes 67 ms.
    settings.timeout_ms = arguments.answer_ms(&link.device).saturating_mul(2);
    settings.repeat_ms = settings.timeout_ms.saturating_mul(5).max(4000);
    settings.recognises = options.recognises_repeats.into();
    settings.baud = link.device.baud();
    settings.repeats =
        arguments.attempts.map_or(0, |attempts| if attempts == 1 { -1 } else { i16::from(attempts) - 1 });
    let mut sender = Sender {
        host: Host::new(settings),
        id: options.id.clone().unwrap_or_default(),
        rest: arguments.commands.clone().into_iter(),
        current: None,
    };
    if options.ack || options.checksum {
        let (ack, checksum) = (options.ack.then_some(true), options.checksum.then_some(true));
        let handle = sender.host.setup(sender.id.as_bytes(), ack, checksum, None);
        sender.current = Some((handle.map_err(|error| usage("linksetup", error))?, "linksetup".into()));
    } else {
        sender.next(report)?;
    }
    loop {
        match link.run(&mut sender, report)? {
            Status::Finished if sender.next(report)? => (),
            status => return Ok(status),
        }
    }
}

fn usage(command: &str, error: QueueError) -> Failure {
    let reason = match error {
        QueueError::Busy => "too many commands".into(),
        QueueError::Malformed => {
            "no command: it is printable ASCII, `c=NAME&PARAMETER=VALUE`, without `t`, `id` and a checksum".into()
        }
        QueueError::TooLong => format!("with `t` and `id` the line would be longer than {COMMAND_MAX} bytes"),
    };
    Failure::Usage(format!("{command}: {reason}"))
}

struct Sender {
    host: Host,
    id: String,
    rest: std::vec::IntoIter<String>,
    /// The handle of the command that is under way, and its text.
    current: Option<(u16, String)>,
}

impl Sender {
    /// Begins with the next command; returns false when there is none.
    fn next(&mut self, report: &mut Report) -> Result<bool, Failure> {
        let Some(command) = self.rest.next() else { return Ok(false) };
        let text = if command.starts_with("c=") { command } else { format!("c={command}") };
        let handle = self.host.send(text.as_bytes(), self.id.as_bytes()).map_err(|error| usage(&text, error))?;
        self.current = Some((handle, text));
        report.began = std::time::Instant::now();
        Ok(true)
    }
}

impl Session for Sender {
    fn handle(&mut self, now: u32, report: &mut Report) -> Option<Status> {
        while let Some(event) = self.host.poll(now) {
            let Event::Ended(handle, outcome, answer) = event else { continue };
            let Some((_, command)) = self.current.take_if(|(current, _)| *current == handle) else { continue };
            let (name, status) = match outcome {
                Outcome::Answered => ("answered", Status::Finished),
                Outcome::Refused => ("refused", Status::NotDone),
                Outcome::TooLong => ("too long with a checksum", Status::NotDone),
                Outcome::TimedOut => ("timed out", Status::TimedOut),
                Outcome::Restarted => ("lost, as the device has restarted", Status::TimedOut),
            };
            let answer = answer.map(|answer| String::from_utf8_lossy(answer.line).into_owned());
            report.ended(&command, name, answer.as_deref(), json!({ "answer": answer }));
            return Some(status);
        }
        None
    }

    fn output(&mut self, room: &mut [u8], now: u32) -> usize {
        room.first_chunk_mut().map_or(0, |line| self.host.output(line, COMMAND_MAX, now))
    }

    fn receive(&mut self, bytes: &[u8], now: u32) -> usize {
        self.host.receive(bytes, now)
    }

    fn interrupt(&mut self) -> bool {
        true
    }

    fn next_deadline(&self, now: u32) -> Option<u32> {
        self.host.next_deadline(now)
    }
}
