//! A real broker, and a client of it.

use std::cell::RefCell;
use std::net::TcpListener;
use std::sync::mpsc::{Receiver, channel};

use rumqttc::v5::mqttbytes::QoS;
use rumqttc::v5::mqttbytes::v5::{Packet, Publish, PublishProperties};
use rumqttc::v5::{Client, Event, MqttOptions};
use serde_json::Value;

use super::*;
use crate::support::has_tool;

/// mosquitto, on a port of its own.
pub(super) struct Broker {
    child: Child,
    pub(super) port: u16,
    settings: PathBuf,
}

impl Broker {
    /// Starts one that anybody may use; `None` where there is none, after saying so.
    pub(super) fn start() -> Option<Self> {
        Self::with("allow_anonymous true\n")
    }

    /// One with these lines of settings behind its listener.
    pub(super) fn with(lines: &str) -> Option<Self> {
        if !has_tool(&mosquitto(), "-h") {
            return None;
        }
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let settings = empty("broker").join("mosquitto.conf");
        let text =
            format!("listener {port} 127.0.0.1\nuser root\nmax_inflight_messages 1000\nmax_queued_messages 0\n{lines}");
        fs::write(&settings, text).unwrap();
        Some(Self { child: Self::run(&settings, port), port, settings })
    }

    fn run(settings: &Path, port: u16) -> Child {
        let mut command = Command::new(mosquitto());
        command.arg("-c").arg(settings).stdout(Stdio::null()).stderr(Stdio::null());
        let child = command.spawn().unwrap();
        found("the broker listens", || TcpStream::connect(("127.0.0.1", port)).ok());
        child
    }

    pub(super) fn kill(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    pub(super) fn again(&mut self) {
        self.child = Self::run(&self.settings, self.port);
    }

    /// Settings of `serve` that name it.
    pub(super) fn settings(&self, more: &str) -> String {
        format!("[mqtt]\nurl = \"mqtt://127.0.0.1:{}\"\n{more}\n", self.port)
    }
}

impl Drop for Broker {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Its path: where administrators' programs are, if not in PATH.
fn mosquitto() -> String {
    let path = std::env::var("PATH").unwrap_or_default() + ":/usr/sbin:/usr/local/sbin";
    let found = std::env::split_paths(&path).map(|directory| directory.join("mosquitto")).find(|path| path.is_file());
    found.map_or_else(|| "mosquitto".into(), |path| utf8(&path).to_owned())
}

/// A client that listens to some topics.
pub(super) struct Listener {
    pub(super) client: Client,
    heard: Receiver<Publish>,
    /// Answers that came while something else was waited for: two commands may be answered in any order.
    answers: RefCell<Vec<Publish>>,
}

impl Listener {
    pub(super) fn new(port: u16, topics: &[&str]) -> Self {
        Self::by(MqttOptions::new(format!("test-{}", empty("client").display()), "127.0.0.1", port), topics)
    }

    pub(super) fn by(mut options: MqttOptions, topics: &[&str]) -> Self {
        options.set_keep_alive(Duration::from_secs(60));
        let (client, mut connection) = Client::new(options, 1000);
        let (sender, heard) = channel();
        let (ready, is_ready) = channel();
        let count = topics.len();
        std::thread::spawn(move || {
            let mut subscribed = 0;
            for event in connection.iter() {
                match event {
                    Ok(Event::Incoming(Packet::Publish(publish))) => {
                        if sender.send(publish).is_err() {
                            return;
                        }
                    }
                    Ok(Event::Incoming(Packet::SubAck(_))) => {
                        subscribed += 1;
                        if subscribed == count {
                            let _ = ready.send(());
                        }
                    }
                    Ok(_) => (),
                    // The broker was killed, or is slow to start.
                    Err(_) => std::thread::sleep(Duration::from_millis(50)),
                }
            }
        });
        for topic in topics {
            client.subscribe(*topic, QoS::AtLeastOnce).unwrap();
        }
        is_ready.recv_timeout(TIMEOUT).expect("the broker takes subscriptions");
        Self { client, heard, answers: RefCell::default() }
    }

    /// Waits for a message like that: its topic, its JSON, and all of it.
    pub(super) fn hear(&self, what: &str, is_it: impl Fn(&str, &Value, &Publish) -> bool) -> (Value, Publish) {
        let began = Instant::now();
        while began.elapsed() < TIMEOUT {
            let Ok(publish) = self.heard.recv_timeout(Duration::from_millis(100)) else { continue };
            let topic = std::str::from_utf8(&publish.topic).unwrap();
            // Commands of this client itself may have none.
            let json = serde_json::from_slice(&publish.payload).unwrap_or_default();
            if is_it(topic, &json, &publish) {
                return (json, publish);
            }
            if topic == "answers" {
                self.answers.borrow_mut().push(publish);
            }
        }
        panic!("in vain: {what}");
    }

    /// Waits until that topic says so.
    pub(super) fn hear_on(&self, on: &str, is_it: impl Fn(&Value) -> bool) -> Value {
        self.hear(on, |topic, json, _| topic == on && is_it(json)).0
    }

    pub(super) fn say(&self, topic: &str, payload: &str, retain: bool, properties: PublishProperties) {
        self.client.publish_with_properties(topic, QoS::AtLeastOnce, retain, payload.to_owned(), properties).unwrap();
    }

    /// Sends a command that is good for so many seconds, and gives the answer.
    pub(super) fn ask(&self, command: &str, payload: &str, seconds: Option<u32>) -> Value {
        static COUNT: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
        let word = format!("ask-{}", COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed));
        self.say(&format!("deltarobot/sim1/command/{command}"), payload, false, asked(&word, seconds));
        self.answer(&word)
    }

    pub(super) fn answer(&self, word: &str) -> Value {
        let is_it = |publish: &Publish| {
            let properties = publish.properties.clone().unwrap_or_default();
            publish.topic == "answers" && properties.correlation_data.is_some_and(|data| data == word.as_bytes())
        };
        let earlier = self.answers.borrow_mut().extract_if(.., |publish| is_it(publish)).next();
        match earlier {
            Some(publish) => serde_json::from_slice(&publish.payload).unwrap(),
            None => self.hear(&format!("the answer to {word}"), |_, _, publish| is_it(publish)).0,
        }
    }
}

/// Properties of a command.
pub(super) fn asked(word: &str, seconds: Option<u32>) -> PublishProperties {
    PublishProperties {
        response_topic: Some("answers".into()),
        correlation_data: Some(word.to_owned().into()),
        message_expiry_interval: seconds,
        ..PublishProperties::default()
    }
}
