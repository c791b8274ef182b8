//! Commands from the broker: `PREFIX/NAME/command/home`, `move` and `cancel`.
//!
//! A motion that is late must not happen. So a command says how long it is good for, by its message expiry interval or
//! by a date in it; what was retained, or has come before, is refused.

use std::collections::VecDeque;
use std::str;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use chrono::{DateTime, Utc};
use rumqttc::v5::mqttbytes::QoS;
use rumqttc::v5::mqttbytes::v5::{Publish, PublishProperties};
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use super::arrival::Arrival;
use super::publisher::is_json;
use super::{Mqtt, lost};
use crate::api::parse;
use crate::locked;
use crate::problem::{Kind, Problem};
use crate::robot::{Command, Goal, Robot};

/// Commands that are being carried out.
const RUNNING_MAX: usize = 1000;
/// Commands that are remembered, so that none is carried out twice.
const REMEMBERED: usize = 1000;
/// Who drives, as others see it.
const CLIENT: &str = "mqtt";

/// What a command says.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Payload {
    displacements: Option<[f32; 3]>,
    position: Option<[f32; 3]>,
    relative: bool,
    /// Not to be begun after that.
    expires: Option<DateTime<Utc>>,
}

/// What is wanted.
enum Wanted {
    Cancel,
    Motion(Command, Instant),
}

pub(super) struct Commands {
    mqtt: Arc<Mqtt>,
    may_drive: bool,
    arrival: Arc<Arrival>,
    running: Arc<Semaphore>,
    /// By response topic and correlation data.
    seen: Mutex<VecDeque<(String, Vec<u8>)>>,
}

impl Commands {
    pub(super) fn new(mqtt: Arc<Mqtt>, may_drive: bool) -> Arc<Self> {
        let running = Arc::new(Semaphore::new(RUNNING_MAX));
        Arc::new(Self { mqtt, may_drive, arrival: Arrival::new(), running, seen: Mutex::default() })
    }

    /// Begins with a command; does not wait for its end.
    pub(super) fn take(self: &Arc<Self>, publish: &Publish) {
        let arrived = self.arrival.of_now();
        let answer_to = publish.properties.clone().unwrap_or_default();
        let checked = self.check(publish, &answer_to, arrived);
        let (commands, topic) = (Arc::clone(self), publish.topic.clone());
        tokio::spawn(async move {
            let (outcome, count) = match commands.perform(checked).await {
                Ok(outcome) => (outcome, &commands.mqtt.counts.commands),
                Err(problem) => (json!({ "problem": problem.body() }), &commands.mqtt.counts.refused),
            };
            count.fetch_add(1, Ordering::Relaxed);
            commands.answer(str::from_utf8(&topic).unwrap_or_default(), answer_to, outcome).await;
        });
    }

    async fn perform(
        &self,
        checked: Result<(Arc<Robot>, Wanted, OwnedSemaphorePermit), Problem>,
    ) -> Result<Value, Problem> {
        let (robot, wanted, _running) = checked?;
        match wanted {
            Wanted::Cancel => Ok(json!({ "outcome": robot.cancel().await? })),
            Wanted::Motion(command, expires) => {
                let number = *self.mqtt.session.borrow();
                // Who drives can't be heard any more when the connection is lost.
                tokio::select! {
                    operation = robot.perform(command, CLIENT, Some(expires)) => {
                        let operation = operation?;
                        Ok(json!({ "outcome": operation.outcome, "operation": operation }))
                    }
                    () = lost(self.mqtt.session.subscribe(), number) => {
                        Err(Problem::new(Kind::Down, "the connection to the broker was lost"))
                    }
                }
            }
        }
    }

    fn check(
        &self,
        publish: &Publish,
        properties: &PublishProperties,
        arrived: (Instant, DateTime<Utc>),
    ) -> Result<(Arc<Robot>, Wanted, OwnedSemaphorePermit), Problem> {
        let refused = |kind, text: &str| Err(Problem::new(kind, text));
        let topic = str::from_utf8(&publish.topic).unwrap_or_default();
        let rest = topic.strip_prefix(&self.mqtt.prefix).and_then(|rest| rest.strip_prefix('/'));
        let Some((name, word)) = rest.and_then(|rest| rest.split_once("/command/")) else {
            return refused(Kind::NotFound, "that is no topic of commands");
        };
        let robot = Arc::clone(self.mqtt.fleet.robot(name)?);
        if publish.retain {
            return refused(Kind::Expired, "the message was retained");
        }
        let (command, expires) = read(word, &publish.payload)?;
        let wanted = match command {
            None => Wanted::Cancel,
            Some(_) if !self.may_drive => {
                return refused(Kind::Forbidden, "`commands = true` in [mqtt] allows to drive");
            }
            Some(command) => {
                if publish.dup || self.was_seen(properties) {
                    return refused(Kind::Expired, "the message has come before");
                }
                Wanted::Motion(command, deadline(properties, expires, arrived)?)
            }
        };
        let running = Arc::clone(&self.running).try_acquire_owned();
        running
            .map(|running| (robot, wanted, running))
            .map_err(|_| Problem::new(Kind::Overload, "too many commands are being carried out"))
    }

    /// Whether a command with this response topic and correlation data has come before.
    fn was_seen(&self, properties: &PublishProperties) -> bool {
        let (Some(topic), Some(data)) = (&properties.response_topic, &properties.correlation_data) else {
            return false;
        };
        let mut seen = locked(&self.seen);
        if seen.iter().any(|(seen_topic, seen_data)| seen_topic == topic && seen_data == data) {
            return true;
        }
        seen.push_back((topic.clone(), data.to_vec()));
        if seen.len() > REMEMBERED {
            seen.pop_front();
        }
        false
    }

    /// Says how it ended, if that is wanted.
    async fn answer(&self, topic: &str, answer_to: PublishProperties, mut outcome: Value) {
        let Some(to) = answer_to.response_topic else { return };
        let own = format!("{}/", self.mqtt.prefix);
        let is_topic = !to.is_empty() && !to.contains(['+', '#', '\0']);
        // One of ours would be taken for a command, or for a state.
        if !is_topic || to.starts_with(&own) && !to.starts_with(&format!("{own}response/")) {
            return;
        }
        if let Some(outcome) = outcome.as_object_mut() {
            outcome.insert("command".into(), topic.strip_prefix(&own).unwrap_or_default().into());
        }
        let properties = PublishProperties { correlation_data: answer_to.correlation_data, ..is_json() };
        // While there is no connection, nobody waits for it.
        if self.mqtt.is_online() {
            let sent =
                self.mqtt.client.publish_with_properties(to, QoS::AtLeastOnce, false, outcome.to_string(), properties);
            let _ = tokio::time::timeout(Duration::from_secs(10), sent).await;
        }
    }
}

/// The command of that name with that payload, and its date; no command is to cancel.
pub(crate) fn read(word: &str, payload: &[u8]) -> Result<(Option<Command>, Option<DateTime<Utc>>), Problem> {
    let payload: Payload =
        parse(payload).map_err(|problem| Problem::new(problem.kind, format!("the payload: {}", problem.detail)))?;
    let command = match (word, payload.displacements, payload.position) {
        ("cancel", None, None) => None,
        ("home", None, None) => Some(Command::Home),
        ("move", displacements, position) => Some(Command::Move(Goal::new(displacements, position, payload.relative)?)),
        ("cancel" | "home", ..) => return Err(Problem::new(Kind::Malformed, "that takes no place")),
        _ => return Err(Problem::new(Kind::NotFound, "commands are home, move and cancel")),
    };
    Ok((command, payload.expires))
}

/// Until when a motion may begin.
fn deadline(
    properties: &PublishProperties,
    expires: Option<DateTime<Utc>>,
    (arrived, now): (Instant, DateTime<Utc>),
) -> Result<Instant, Problem> {
    let by_message = properties.message_expiry_interval.map(|seconds| arrived + Duration::from_secs(seconds.into()));
    let late = || Problem::new(Kind::Expired, "it has expired");
    let by_date = match expires {
        Some(date) => Some(Instant::now() + (date - now).to_std().map_err(|_| late())?),
        None => None,
    };
    let deadline = by_message.into_iter().chain(by_date).min().ok_or_else(|| {
        let text = "a motion needs a message expiry interval, or `expires`: it must not begin late";
        Problem::new(Kind::Malformed, text)
    })?;
    if deadline <= Instant::now() { Err(late()) } else { Ok(deadline) }
}
