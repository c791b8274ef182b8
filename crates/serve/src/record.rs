//! Records of all robots, in MCAP files. A thread of its own writes them: a slow disk delays nobody.

use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime};

use deltarobot_cli::hex::hex;
use deltarobot_cli::recording::Entry;
use deltarobot_cli::status::{Failure, system_text};
use deltarobot_records::channels::{Channel, Robot};
use deltarobot_records::rotation::{Limits, Naming, Recorder};
use serde::{Deserialize, Deserializer};
use serde_json::{Value, json};
use tokio::sync::broadcast::Receiver as Events;
use tokio::sync::broadcast::error::RecvError;

use crate::complain;
use crate::event::{Event, Message, What};
use crate::fleet::Fleet;
use crate::locked;
use crate::state::{Link, State};

/// What waits for the disk. What is more is lost, and counted.
const WAITING_MAX: usize = 1 << 16;
/// How often it is looked whether what came has to be written.
const LOOK: Duration = Duration::from_millis(250);
/// How long it is waited before writing is tried again, on a disk that is full.
const RETRY: Duration = Duration::from_secs(5);

/// Records, in the file of settings.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    directory: PathBuf,
    /// A file's size, such as `100M`.
    #[serde(default, deserialize_with = "size")]
    rotate: Option<u64>,
    /// And how long it goes.
    rotate_after_s: Option<u32>,
}

fn size<'de, D: Deserializer<'de>>(value: D) -> Result<Option<u64>, D::Error> {
    deltarobot_cli::size(&String::deserialize(value)?).map(Some).map_err(serde::de::Error::custom)
}

/// How it goes, for everybody.
#[derive(Debug, Default)]
pub(crate) struct Progress {
    /// Bytes in all files.
    pub(crate) written: AtomicU64,
    /// Messages that were lost.
    pub(crate) lost: AtomicU64,
    /// Why nothing can be written now.
    pub(crate) error: Mutex<Option<String>>,
}

impl Progress {
    /// Why nothing can be written now.
    pub(crate) fn error(&self) -> Option<String> {
        locked(&self.error).clone()
    }
}

/// The thread that writes.
pub(crate) struct Records {
    sender: SyncSender<Item>,
    /// How it goes.
    pub(crate) progress: Arc<Progress>,
    thread: JoinHandle<()>,
}

enum Item {
    Put { robot: Arc<str>, channel: Channel, time: u64, json: Vec<u8> },
    End,
}

impl Records {
    /// Begins.
    pub(crate) fn start(settings: &Settings, fleet: &Arc<Fleet>) -> Result<Self, Failure> {
        let progress = Arc::clone(&fleet.all.records);
        let limits = Limits {
            size: Some(settings.rotate.unwrap_or(100 << 20)),
            time: Some(Duration::from_secs(settings.rotate_after_s.unwrap_or(3600).into())),
        };
        let mut recorder = Recorder::new(Naming::Dated(settings.directory.clone()), limits);
        // Whoever has mistyped the directory's name wants to know it now.
        recorder.begin().map_err(|error| Failure::of_file(settings.directory.display(), &error))?;
        let (sender, items) = sync_channel(WAITING_MAX);
        let writer = Writer { recorder, progress: Arc::clone(&progress), robots: BTreeMap::new(), failed: None };
        let thread = thread::Builder::new().name("records".into()).spawn(move || writer.run(&items));
        let thread = thread.map_err(|error| Failure::of_file("threads", &error))?;
        for robot in fleet.robots.values() {
            let feed = Feed::new(sender.clone(), Arc::clone(&progress), Arc::clone(robot.name()));
            tokio::spawn(feed.bytes(robot.bytes.subscribe()));
        }
        let all = || Feed::new(sender.clone(), Arc::clone(&progress), "".into());
        tokio::spawn(all().events(fleet.all.events.subscribe()));
        tokio::spawn(all().events(fleet.all.messages.subscribe()));
        Ok(Self { sender, progress, thread })
    }

    /// Closes the file.
    pub(crate) fn end(self) {
        let _ = self.sender.send(Item::End);
        let _ = self.thread.join();
    }
}

/// What brings the thread what happens.
struct Feed {
    sender: SyncSender<Item>,
    progress: Arc<Progress>,
    robot: Arc<str>,
    began: Instant,
    links: BTreeMap<Arc<str>, (Link, Option<String>)>,
}

impl Feed {
    fn new(sender: SyncSender<Item>, progress: Arc<Progress>, robot: Arc<str>) -> Self {
        Self { sender, progress, robot, began: Instant::now(), links: BTreeMap::new() }
    }

    /// Until nothing more can come, or nobody writes any more.
    async fn bytes(self, mut events: Events<Arc<Entry>>) {
        loop {
            match events.recv().await {
                Ok(entry) => {
                    let time = self.began.elapsed().as_micros();
                    #[expect(clippy::cast_precision_loss, reason = "microseconds of a century are exact")]
                    let time = time as f64 / 1e6;
                    let json = json!({ "time": time, "from": entry.from.name(), "bytes": hex(&entry.bytes) });
                    self.put(&self.robot, Channel::Bytes, &json);
                }
                Err(RecvError::Lagged(count)) => self.lose(count),
                Err(RecvError::Closed) => return,
            }
        }
    }

    async fn events(mut self, mut events: Events<Arc<Event>>) {
        loop {
            match events.recv().await {
                Ok(event) => self.event(&event),
                Err(RecvError::Lagged(count)) => self.lose(count),
                Err(RecvError::Closed) => return,
            }
        }
    }

    fn event(&mut self, event: &Event) {
        let robot = &event.robot;
        match &event.what {
            What::State(state) => {
                let link = (state.link, state.link_error.clone());
                if self.links.get(robot) != Some(&link) {
                    let json = json!({ "event": "link", "link": state.link, "error": state.link_error });
                    self.put(robot, Channel::Events, &json);
                    self.links.insert(Arc::clone(robot), link);
                }
                self.put(robot, Channel::State, &state_json(state));
            }
            What::Message(message) => self.put(robot, Channel::Messages, &message_json(message)),
            What::Ended { operation, .. } => {
                self.put(robot, Channel::Events, &json!({ "event": "ended", "operation": operation }));
            }
            What::Driver { driver, .. } => {
                self.put(robot, Channel::Events, &json!({ "event": "driver", "driver": driver }));
            }
            What::Path { run, .. } => self.put(robot, Channel::Events, &json!({ "event": "path", "run": run })),
        }
    }

    fn put(&self, robot: &Arc<str>, channel: Channel, json: &Value) {
        let time = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_nanos();
        let time = u64::try_from(time).unwrap_or(u64::MAX);
        let item = Item::Put { robot: Arc::clone(robot), channel, time, json: json.to_string().into_bytes() };
        // When it is disconnected, the program ends.
        if let Err(TrySendError::Full(_)) = self.sender.try_send(item) {
            self.lose(1);
        }
    }

    fn lose(&self, count: u64) {
        self.progress.lost.fetch_add(count, Ordering::Relaxed);
    }
}

fn state_json(state: &State) -> Value {
    let word = serde_json::to_value(state.state).ok().and_then(|word| Some(word.as_str()?.to_ascii_uppercase()));
    json!({
        "state": word,
        "position": state.displacements,
        "stops": state.end_stops,
        "pose": state.pose,
        "target": state.target,
        "seq": state.seq,
    })
}

fn message_json(message: &Message) -> Value {
    let mut json = Value::Object(message.json.clone());
    if let Some(object) = json.as_object_mut() {
        object.insert("from".into(), message.from.into());
        object.insert("text".into(), message.text.clone().into());
        object.entry("bytes").or_insert_with(|| message.bytes.clone().into());
    }
    json
}

/// What writes.
struct Writer {
    recorder: Recorder,
    progress: Arc<Progress>,
    robots: BTreeMap<Arc<str>, Robot>,
    /// When writing failed.
    failed: Option<Instant>,
}

impl Writer {
    fn run(mut self, items: &Receiver<Item>) {
        loop {
            match items.recv_timeout(LOOK) {
                Ok(Item::Put { robot, channel, time, json }) => self.put(&robot, channel, time, &json),
                Ok(Item::End) | Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => {
                    let result = self.recorder.flush_if_due();
                    self.note(result);
                }
            }
            self.progress.written.store(self.recorder.written(), Ordering::Relaxed);
        }
        let result = self.recorder.finish();
        self.note(result);
    }

    fn put(&mut self, robot: &Arc<str>, channel: Channel, time: u64, json: &[u8]) {
        if self.failed.is_some_and(|failed| failed.elapsed() < RETRY) {
            self.progress.lost.fetch_add(1, Ordering::Relaxed);
            return;
        }
        let known = self.robots.entry(Arc::clone(robot));
        let robot = known.or_insert_with_key(|name| Robot { name: name.to_string(), gap: None, is_dated: true });
        let result = self.recorder.put(robot, channel, time, json);
        if result.is_err() {
            self.progress.lost.fetch_add(1, Ordering::Relaxed);
        } else if self.failed.is_some() {
            // It is good again once something has really been written.
            let result = self.recorder.flush();
            self.note(result);
            return;
        }
        if result.is_err() {
            self.note(result);
        }
    }

    /// Says what is the matter, once.
    fn note(&mut self, result: io::Result<()>) {
        let error = result.err().map(|error| system_text(&error));
        if error.is_none() && self.failed.is_none() {
            return;
        }
        self.failed = error.as_ref().map(|_| Instant::now());
        let mut said = locked(&self.progress.error);
        if *said != error {
            let text = error.as_ref().map_or_else(|| "going on".into(), |error| format!("{error}; trying again"));
            complain(&format!("records: {text}"));
            *said = error;
        }
    }
}
