//! What robots are and do, as it is published.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use rumqttc::v5::mqttbytes::QoS;
use rumqttc::v5::mqttbytes::v5::PublishProperties;
use serde::Serialize;
use tokio::sync::broadcast::error::RecvError;
use tokio::time::interval;

use super::{Mqtt, connection, lost};
use crate::event::{Event, What};
use crate::state::State;

/// How often it is published how well lines work.
const HEALTH: Duration = Duration::from_secs(10);

/// The connection was lost.
struct Offline;

pub(super) struct Publisher {
    mqtt: Arc<Mqtt>,
    number: u64,
}

impl Publisher {
    pub(super) const fn new(mqtt: Arc<Mqtt>) -> Self {
        Self { mqtt, number: 0 }
    }

    pub(super) async fn run(mut self) {
        let mut session = self.mqtt.session.subscribe();
        loop {
            match session.wait_for(|number| *number != 0).await {
                Ok(number) => self.number = *number,
                Err(_) => return,
            }
            // Goes on until that connection is lost.
            let Err(Offline) = self.publish().await;
        }
    }

    async fn publish(&self) -> Result<std::convert::Infallible, Offline> {
        let mqtt = &self.mqtt;
        let mut events = mqtt.fleet.all.events.subscribe();
        let commands = format!("{}/+/command/+", mqtt.prefix);
        self.while_online(mqtt.client.subscribe(commands, QoS::AtLeastOnce)).await?;
        self.put("status".into(), true, connection::status("online").into_bytes()).await?;
        self.put_all().await?;
        let mut health = interval(HEALTH);
        loop {
            tokio::select! {
                () = lost(mqtt.session.subscribe(), self.number) => return Err(Offline),
                event = events.recv() => match event {
                    Ok(event) => self.put_event(&event).await?,
                    Err(RecvError::Lagged(count)) => {
                        mqtt.counts.dropped.fetch_add(count, Ordering::Relaxed);
                        self.put_all().await?;
                    }
                    Err(RecvError::Closed) => std::future::pending().await,
                },
                _ = health.tick() => {
                    for (name, robot) in &mqtt.fleet.robots {
                        let topic = format!("{name}/health");
                        self.put_json(topic, true, &robot.snapshot().health).await?;
                    }
                }
            }
        }
    }

    /// All states.
    async fn put_all(&self) -> Result<(), Offline> {
        for robot in self.mqtt.fleet.robots.values() {
            self.put_state(&robot.snapshot()).await?;
        }
        Ok(())
    }

    async fn put_state(&self, state: &State) -> Result<(), Offline> {
        self.put_json(format!("{}/state", state.name), true, state).await
    }

    async fn put_event(&self, event: &Event) -> Result<(), Offline> {
        match &event.what {
            What::State(state) => self.put_state(state).await,
            what => self.put_json(format!("{}/event", event.robot), false, what).await,
        }
    }

    async fn put_json(&self, topic: String, retain: bool, value: &impl Serialize) -> Result<(), Offline> {
        self.put(topic, retain, serde_json::to_vec(value).unwrap_or_default()).await
    }

    async fn put(&self, topic: String, retain: bool, json: Vec<u8>) -> Result<(), Offline> {
        let mqtt = &self.mqtt;
        let topic = format!("{}/{topic}", mqtt.prefix);
        self.while_online(mqtt.client.publish_with_properties(topic, QoS::AtLeastOnce, retain, json, is_json()))
            .await?;
        mqtt.counts.published.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }

    /// Waits for room, but not for another connection: until then it would be old.
    async fn while_online<T, E>(&self, sending: impl Future<Output = Result<T, E>>) -> Result<(), Offline> {
        tokio::select! {
            biased;
            () = lost(self.mqtt.session.subscribe(), self.number) => Err(Offline),
            sent = sending => sent.map(drop).map_err(|_| Offline),
        }
    }
}

/// What a payload is.
pub(super) fn is_json() -> PublishProperties {
    PublishProperties { content_type: Some("application/json".into()), ..PublishProperties::default() }
}
