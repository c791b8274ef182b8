//! An MQTT 5 broker: the states and events of robots go there, commands come from it.
//!
//! A session with the broker is always a new one: what the broker would have kept while nobody was connected, and what
//! waits here when the connection is lost, is thrown away. Each connection begins with the states as they are then.

mod arrival;
pub(crate) mod commands;
mod connection;
mod publisher;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use deltarobot_cli::status::Failure;
use rumqttc::Outgoing;
use rumqttc::v5::mqttbytes::QoS;
use rumqttc::v5::mqttbytes::v5::Packet;
use rumqttc::v5::{AsyncClient, Event};
use serde::Deserialize;
use tokio::sync::watch;
use tokio::task::JoinHandle;

use crate::complain;
use crate::fleet::Fleet;
use commands::Commands;
use publisher::Publisher;

/// Requests to the broker that wait for the connection's task.
const REQUESTS_MAX: usize = 256;
/// How long it is waited before the broker is tried again, at first and at last.
const RETRY: [Duration; 2] = [Duration::from_millis(250), Duration::from_secs(15)];
/// How long the end of the program waits for the broker.
const END_TIME: Duration = Duration::from_secs(2);

/// The broker, in the file of settings.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    /// `mqtt://HOST:PORT`, or `mqtts://HOST:PORT` with TLS.
    url: String,
    /// What all topics begin with.
    #[serde(default = "prefix")]
    prefix: String,
    /// What the broker knows this program as.
    client_id: Option<String>,
    user: Option<String>,
    password_file: Option<PathBuf>,
    /// Who vouches for the broker; the system's authorities unless it is said.
    ca_file: Option<PathBuf>,
    /// What this program vouches for itself with.
    cert_file: Option<PathBuf>,
    key_file: Option<PathBuf>,
    /// Whether who may publish there may also drive. To cancel is always possible.
    #[serde(default)]
    commands: bool,
}

fn prefix() -> String {
    "deltarobot".into()
}

/// The connection to the broker, for everybody here.
pub(crate) struct Mqtt {
    client: AsyncClient,
    prefix: String,
    fleet: Arc<Fleet>,
    /// Counts connections; 0 while there is none.
    session: watch::Sender<u64>,
    /// What has happened.
    pub(crate) counts: Counts,
}

/// What has happened.
#[derive(Debug, Default)]
pub(crate) struct Counts {
    /// Connections.
    pub(crate) connections: AtomicU64,
    /// Messages that the broker was given.
    pub(crate) published: AtomicU64,
    /// Events that were lost, because the broker took them too slowly.
    pub(crate) dropped: AtomicU64,
    /// Commands that were carried out.
    pub(crate) commands: AtomicU64,
    /// Commands that were refused.
    pub(crate) refused: AtomicU64,
}

impl Mqtt {
    /// Connects, again and again if need be.
    pub(crate) fn start(settings: &Settings, fleet: Arc<Fleet>) -> Result<(Arc<Self>, JoinHandle<()>), Failure> {
        let options = connection::options(settings)?;
        let (client, connection) = AsyncClient::new(options, REQUESTS_MAX);
        let mqtt = Arc::new(Self {
            client,
            prefix: settings.prefix.clone(),
            fleet,
            session: watch::Sender::new(0),
            counts: Counts::default(),
        });
        let commands = Commands::new(Arc::clone(&mqtt), settings.commands);
        tokio::spawn(Publisher::new(Arc::clone(&mqtt)).run());
        let task = tokio::spawn(Arc::clone(&mqtt).run(connection, commands));
        Ok((mqtt, task))
    }

    /// Whether there is a connection.
    pub(crate) fn is_online(&self) -> bool {
        *self.session.borrow() != 0
    }

    /// Says that this program ends, and disconnects.
    pub(crate) async fn end(&self, task: JoinHandle<()>) {
        let ending = async {
            if self.is_online() {
                let status = connection::status("offline");
                let _ =
                    self.client.publish(connection::status_topic(&self.prefix), QoS::AtLeastOnce, true, status).await;
                let _ = self.client.disconnect().await;
                let _ = task.await;
            }
        };
        let _ = tokio::time::timeout(END_TIME, ending).await;
    }

    async fn run(self: Arc<Self>, mut connection: rumqttc::v5::EventLoop, commands: Arc<Commands>) {
        let [shortest, longest] = RETRY;
        let (mut pause, mut said) = (shortest, None);
        loop {
            match connection.poll().await {
                Ok(Event::Incoming(Packet::ConnAck(_))) => {
                    let number = self.counts.connections.fetch_add(1, Ordering::Relaxed) + 1;
                    self.session.send_replace(number);
                    (pause, said) = (shortest, None);
                }
                Ok(Event::Incoming(Packet::Publish(publish))) => commands.take(&publish),
                Ok(Event::Outgoing(Outgoing::Disconnect)) => return,
                Ok(_) => (),
                Err(error) => {
                    self.session.send_replace(0);
                    let text = connection::text(&error);
                    if said.as_ref() != Some(&text) {
                        complain(&format!("mqtt: {text}; trying again"));
                        said = Some(text);
                    }
                    tokio::time::sleep(pause).await;
                    pause = (2 * pause).min(longest);
                }
            }
        }
    }
}

/// Waits until that connection is lost.
async fn lost(mut session: watch::Receiver<u64>, number: u64) {
    // When nobody can publish any more, the program ends.
    let _ = session.wait_for(|now| *now != number).await;
}
