//! What is told about a request.

use std::io::ErrorKind;
use std::time::Instant;

use deltarobot_protocols::deltarobot::host::{Health, Outcome};
use deltarobot_protocols::deltarobot::{Opcode, Report};
use serde_json::json;

use crate::screen::{Screen, complain};
use crate::status::text;
use crate::words;

/// Tells the user. What becomes of standard output changes nothing about what the robot does, or how the program ends.
pub(super) struct Teller {
    screen: Screen,
    json: bool,
    began: Instant,
}

impl Teller {
    pub(super) fn new(json: bool) -> Self {
        Self { screen: Screen::new(), json, began: Instant::now() }
    }

    /// The session's clock, in milliseconds.
    #[expect(clippy::cast_possible_truncation, reason = "it may wrap")]
    pub(super) fn now(&self) -> u32 {
        self.began.elapsed().as_millis() as u32
    }

    fn seconds(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    pub(super) fn accepted(&mut self, opcode: Opcode) {
        let line = if self.json {
            json!({ "request": request_name(opcode), "outcome": "accepted" }).to_string()
        } else {
            format!("{}: accepted", request_name(opcode))
        };
        self.conclude(&line);
    }

    pub(super) fn state(&mut self, report: &Report) {
        // On a terminal the live line says it.
        if !self.json && !self.screen.is_terminal() {
            let _ = self.screen.line(&words::report(report));
        }
    }

    pub(super) fn progress(&mut self, report: &Report) {
        if !self.json {
            let _ = self.screen.live(&format!("{}  {:.1} s", words::report(report), self.seconds()));
        }
    }

    pub(super) fn error(&mut self) {
        if !self.json {
            let _ = self.screen.line("the controller reports an error");
        }
    }

    pub(super) fn ended(&mut self, opcode: Opcode, outcome: Outcome, report: Option<Report>, health: &Health) {
        let line = if self.json {
            json!({
                "request": request_name(opcode),
                "outcome": outcome_name(outcome).replace(' ', "_"),
                "seconds": (self.seconds() * 1000.0).round() / 1000.0,
                "status": report.map(|report| words::report_json(&report)),
                "link": {
                    "frames": health.frames,
                    "malformed": health.malformed,
                    "strays": health.strays,
                    "garbage_bytes": health.garbage_bytes,
                    "checksum_failures": health.checksum_failures,
                    "timeouts": health.timeouts,
                    "repeats": health.retransmissions,
                    "round_trip_ms": health.round_trips.sum.checked_div(health.round_trips.count),
                },
            })
            .to_string()
        } else {
            let report = report.map(|report| words::report(&report));
            match (opcode, outcome, report) {
                (Opcode::STATUS, Outcome::Finished, Some(report)) => report,
                (_, _, report) => {
                    let report = report.map(|report| format!(": {report}")).unwrap_or_default();
                    format!("{} {} after {:.1} s{report}", request_name(opcode), outcome_name(outcome), self.seconds())
                }
            }
        };
        self.conclude(&line);
    }

    /// Of the last line, whoever reads it should know if it is missing.
    fn conclude(&mut self, line: &str) {
        if let Err(error) = self.screen.line(line)
            && error.kind() != ErrorKind::BrokenPipe
        {
            complain(&text("standard output", &error));
        }
    }
}

/// The name of the subcommand that makes a request.
const fn request_name(opcode: Opcode) -> &'static str {
    match opcode {
        Opcode::HOMING => "home",
        Opcode::MOVE => "move",
        Opcode::STATUS => "status",
        _ => "cancel",
    }
}

const fn outcome_name(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Finished => "finished",
        Outcome::Refused => "refused",
        Outcome::Failed => "failed",
        Outcome::Cancelled => "cancelled",
        Outcome::TimedOut => "timed out",
    }
}
