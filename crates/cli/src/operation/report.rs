//! What is said about requests.

use std::io::ErrorKind;
use std::time::Instant;

use deltarobot_protocols::deltarobot::Report;
use deltarobot_protocols::deltarobot::host::Outcome;
use serde_json::{Value, json};

use super::driver::{Driver, End, Request};
use crate::path::Machine;
use crate::screen::{Screen, complain};
use crate::status::{Failure, Status, system_text};
use crate::words;

/// Reports to the user. What becomes of standard output changes neither what the robot does nor how the program ends.
pub(crate) struct Reporter {
    /// `None`: nothing is said.
    screen: Option<Screen>,
    json: bool,
    began: Instant,
    /// Which of many requests it is: what is put before what is said, and into JSON.
    step: Option<(String, Value)>,
    /// Whose pose is said.
    machine: Option<Machine>,
}

impl Reporter {
    pub(crate) fn new(json: bool) -> Self {
        Self { screen: Some(Screen::new()), json, began: Instant::now(), step: None, machine: None }
    }

    pub(crate) fn silent() -> Self {
        Self { screen: None, json: false, began: Instant::now(), step: None, machine: None }
    }

    /// From now on the platform's pose is said too, where it is known.
    pub(crate) fn know(&mut self, machine: Option<Machine>) {
        self.machine = machine;
    }

    /// To the nearest hundredth of a millimetre, if the geometry is in metres.
    fn pose(&self, report: &Report) -> Option<[f64; 3]> {
        let pose = self.machine.as_ref()?.pose(report.position.0.map(f32::from_bits))?;
        Some(pose.map(|number| (f64::from(number) * 1e5).round() / 1e5))
    }

    /// Another request begins.
    pub(crate) fn begin(&mut self, text: String, json: Value) {
        self.began = Instant::now();
        self.step = Some((text, json));
        if let (Some(screen), Some((text, _)), false) = (&mut self.screen, &self.step, self.json) {
            let _ = screen.live(text);
        }
    }

    fn seconds(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    fn step_text(&self) -> String {
        self.step.as_ref().map_or(String::new(), |(text, _)| format!("{text}: "))
    }

    pub(super) fn state(&mut self, report: &Report) {
        // On a terminal the live line says it; of many requests, the outcomes are enough.
        if let Some(screen) = self.screen.as_mut().filter(|screen| !self.json && !screen.is_terminal())
            && self.step.is_none()
        {
            let _ = screen.line(&words::report(report));
        }
    }

    pub(super) fn progress(&mut self, report: &Report) {
        let text = format!("{}{}  {:.1} s", self.step_text(), words::report(report), self.seconds());
        if let Some(screen) = self.screen.as_mut().filter(|_| !self.json) {
            let _ = screen.live(&text);
        }
    }

    pub(super) fn error(&mut self) {
        if let Some(screen) = self.screen.as_mut().filter(|_| !self.json) {
            let _ = screen.line("the controller reports an error");
        }
    }

    /// Says how a request ended; returns the exit status for that.
    pub(crate) fn ended(&mut self, request: Request, end: End, driver: &Driver) -> Status {
        let (report, health) = (driver.last_report(), driver.health());
        let (name, status) = match end {
            End::Accepted => ("accepted", Status::Finished),
            End::Interrupted => ("interrupted", Status::Cancelled),
            End::Outcome(Outcome::Finished) => ("finished", Status::Finished),
            End::Outcome(Outcome::Refused) => ("refused", Status::NotDone),
            End::Outcome(Outcome::Failed) => ("failed", Status::NotDone),
            End::Outcome(Outcome::Cancelled) => ("cancelled", Status::Cancelled),
            End::Outcome(Outcome::TimedOut) => ("timed out", Status::TimedOut),
        };
        let reason = match end {
            End::Outcome(outcome) => driver.seen().reason(outcome, health, report),
            _ => None,
        };
        if self.json {
            let mut value = json!({
                "request": request.name(),
                "outcome": name.replace(' ', "_"),
                "seconds": (self.seconds() * 1000.0).round() / 1000.0,
                "status": report.map(|report| words::report_json(&report)),
                "link": {
                    "seen": driver.seen().name(health),
                    "frames": health.frames,
                    "malformed": health.malformed,
                    "strays": health.strays,
                    "garbage_bytes": health.garbage_bytes,
                    "checksum_failures": health.checksum_failures,
                    "timeouts": health.timeouts,
                    "repeats": health.retransmissions,
                    "round_trip_ms": health.round_trips.sum.checked_div(health.round_trips.count),
                },
            });
            add(&mut value, "reason", reason.clone().map(Value::from));
            if self.machine.is_some() {
                add(&mut value, "pose", Some(json!(report.and_then(|report| self.pose(&report)))));
            }
            self.conclude_json(value);
        } else {
            let report = report.map(|report| {
                let pose = self.pose(&report).map(|[x, y, z]| format!("  x={x} y={y} z={z}"));
                words::report(&report) + &pose.unwrap_or_default()
            });
            let line = match (request, end, report) {
                (Request::Status, End::Outcome(Outcome::Finished), Some(report)) => report,
                (_, End::Accepted, _) => format!("{}: accepted", request.name()),
                (_, _, report) => {
                    let report = report.map(|report| format!(": {report}")).unwrap_or_default();
                    format!("{} {name} after {:.1} s{report}", request.name(), self.seconds())
                }
            };
            self.conclude(&format!("{}{line}", self.step_text()));
        }
        if let Some(reason) = reason {
            complain(&format!("{}: {reason}", request.name()));
        }
        status
    }

    /// A request could not be made, or not be followed to its end.
    pub(crate) fn failed(&mut self, request: &str, failure: &Failure) {
        if self.json {
            self.conclude_json(json!({ "request": request, "outcome": "error", "error": failure.to_string() }));
        }
    }

    /// The user did not want to wait until it could be made.
    pub(crate) fn interrupted(&mut self, request: &str) -> Status {
        if self.json {
            self.conclude_json(json!({ "request": request, "outcome": "interrupted" }));
        }
        Status::Cancelled
    }

    fn conclude_json(&mut self, mut value: Value) {
        add(&mut value, "step", self.step.as_ref().map(|(_, step)| step.clone()));
        self.conclude(&value.to_string());
    }

    /// Of the last line, whoever reads it should know if it is missing.
    pub(crate) fn conclude(&mut self, line: &str) {
        let Some(screen) = &mut self.screen else { return };
        if let Err(error) = screen.line(line)
            && error.kind() != ErrorKind::BrokenPipe
        {
            complain(&format!("standard output: {}", system_text(&error)));
        }
    }
}

fn add(object: &mut Value, name: &str, value: Option<Value>) {
    if let (Some(object), Some(value)) = (object.as_object_mut(), value) {
        object.insert(name.into(), value);
    }
}
