//! WebSockets: events to those who watch, and leases that last as long as a connection.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use axum::extract::ws::{CloseFrame, Message, Utf8Bytes, WebSocket, close_code};
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::sync::broadcast::Receiver;
use tokio::sync::broadcast::error::RecvError;
use tokio::time::{interval, timeout};

use crate::event::{Event, What};
use crate::fleet::Fleet;
use crate::lease::Wish;
use crate::problem::{Kind, Problem};
use crate::robot::Robot;
use crate::state::stamp;
use crate::trace::Traces;

/// Bytes of a message from a client.
pub(crate) const MESSAGE_MAX: usize = 4 << 10;
/// Leases that one connection may have.
const LEASES_MAX: usize = 256;
/// How often the client is asked whether it is there.
const PING: Duration = Duration::from_secs(5);
/// How long a client may be silent, or take nothing: one that drives, and one that only watches.
const DRIVER_TIME: Duration = Duration::from_secs(15);
/// See above.
const WATCHER_TIME: Duration = Duration::from_secs(60);

/// What a connection is for.
pub(crate) struct Watch {
    /// All robots.
    pub(crate) fleet: Arc<Fleet>,
    /// The paths that they trace.
    pub(crate) traces: Arc<Traces>,
    /// The one that is watched; all, if `None`.
    pub(crate) robot: Option<Arc<Robot>>,
    /// Whether messages on the line are wanted.
    pub(crate) messages: bool,
    /// Whether this client may drive.
    pub(crate) may_drive: bool,
    /// What it is called unless it says.
    pub(crate) client: String,
}

/// What clients send; openapi.json describes it.
#[derive(Debug, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum Asked {
    Lease {
        robot: Option<String>,
        client: Option<String>,
        #[serde(default)]
        force: bool,
    },
    Release {
        robot: Option<String>,
    },
}

/// The leases of a connection, given back when it ends.
struct Leases(Vec<(Arc<Robot>, String)>);

impl Drop for Leases {
    fn drop(&mut self) {
        for (robot, word) in &self.0 {
            robot.release(word);
        }
    }
}

impl Watch {
    /// Goes on until the client is gone.
    pub(crate) async fn run(self, mut socket: WebSocket) {
        let mut leases = Leases(Vec::new());
        let of_all = u64::from(self.robot.is_none());
        self.fleet.watchers.fetch_add(of_all, Ordering::Relaxed);
        // Whatever it was, the client is gone.
        let reason = self.follow(&mut socket, &mut leases).await.err().flatten();
        self.fleet.watchers.fetch_sub(of_all, Ordering::Relaxed);
        drop(leases);
        if let Some(reason) = reason {
            let frame = CloseFrame { code: close_code::POLICY, reason: reason.into() };
            let _ = timeout(PING, socket.send(Message::Close(Some(frame)))).await;
        }
    }

    /// Returns only an error: why the connection ends, if the client shall know.
    async fn follow(&self, socket: &mut WebSocket, leases: &mut Leases) -> Result<(), Option<&'static str>> {
        let (mut events, mut messages) = match &self.robot {
            Some(robot) => (robot.events.subscribe(), self.messages.then(|| robot.messages.subscribe())),
            None => (self.fleet.all.events.subscribe(), self.messages.then(|| self.fleet.all.messages.subscribe())),
        };
        // What is known; of the events that are older nothing is shown.
        let mut shown = BTreeMap::new();
        for robot in self.robots() {
            let state = robot.snapshot();
            shown.insert(Arc::clone(robot.name()), state.seq);
            let run = self.traces.run(robot).map(|run| What::Path { time: stamp(), run });
            for what in [What::State(state)].into_iter().chain(run) {
                send(socket, Event::new(Arc::clone(robot.name()), what).json(), leases).await?;
            }
        }
        let mut is_over = self.fleet.is_over.subscribe();
        let mut pings = interval(PING);
        let mut heard = Instant::now();
        loop {
            tokio::select! {
                event = events.recv() => {
                    let is_old = |event: &Event| event.seq().is_some_and(|seq| Some(&seq) <= shown.get(&event.robot));
                    if !event.as_ref().is_ok_and(|event| is_old(event)) {
                        self.pass(event, socket, leases).await?;
                    }
                }
                message = next_of(&mut messages) => self.pass(message, socket, leases).await?,
                received = socket.recv() => {
                    heard = Instant::now();
                    match received {
                        Some(Ok(Message::Text(text))) => {
                            let answer = self.answer(&text, leases);
                            send(socket, answer.to_string().into(), leases).await?;
                        }
                        Some(Ok(Message::Ping(_) | Message::Pong(_))) => (),
                        Some(Ok(Message::Binary(_))) => return Err(Some("messages are text")),
                        Some(Ok(Message::Close(_)) | Err(_)) | None => return Err(None),
                    }
                }
                () = async { drop(is_over.wait_for(|is_over| *is_over).await) } => {
                    while let Ok(event) = events.try_recv() {
                        self.pass(Ok(event), socket, leases).await?;
                    }
                    return Err(Some("the program ends"));
                }
                _ = pings.tick() => {
                    if heard.elapsed() > patience(leases) {
                        return Err(Some("nothing was heard for too long"));
                    }
                    within(patience(leases), socket.send(Message::Ping(Vec::new().into()))).await?;
                }
            }
        }
    }

    /// An event, or how many were lost.
    async fn pass(
        &self,
        event: Result<Arc<Event>, RecvError>,
        socket: &mut WebSocket,
        leases: &Leases,
    ) -> Result<(), Option<&'static str>> {
        match event {
            Ok(event) => send(socket, event.json(), leases).await,
            Err(RecvError::Lagged(count)) => {
                self.fleet.dropped.fetch_add(count, Ordering::Relaxed);
                send(socket, json!({ "type": "dropped", "count": count }).to_string().into(), leases).await
            }
            Err(RecvError::Closed) => Err(Some("the program ends")),
        }
    }

    fn robots(&self) -> Vec<&Arc<Robot>> {
        self.robot.as_ref().map_or_else(|| self.fleet.robots.values().collect(), |robot| vec![robot])
    }

    fn answer(&self, text: &str, leases: &mut Leases) -> Value {
        let asked = serde_json::from_str(text)
            .map_err(|error| Problem::new(Kind::Malformed, format!("no such message: {error}")));
        let name = match &asked {
            Ok(Asked::Lease { robot, .. } | Asked::Release { robot }) => robot.clone(),
            Err(_) => None,
        };
        asked.and_then(|asked| self.lease(&asked, leases)).unwrap_or_else(|problem| {
            let robot = name.or_else(|| self.robot.as_ref().map(|robot| robot.name().to_string()));
            json!({ "type": "refused", "robot": robot, "problem": problem.body() })
        })
    }

    fn lease(&self, asked: &Asked, leases: &mut Leases) -> Result<Value, Problem> {
        let (Asked::Lease { robot, .. } | Asked::Release { robot }) = asked;
        let robot = match (robot, &self.robot) {
            (Some(name), None) => self.fleet.robot(name)?,
            (Some(name), Some(robot)) if **name == **robot.name() => robot,
            (None, Some(robot)) => robot,
            (Some(_), Some(_)) => return Err(Problem::new(Kind::Malformed, "these are the events of another robot")),
            (None, None) => return Err(Problem::new(Kind::Malformed, "say which robot")),
        };
        let index = leases.0.iter().position(|(held, _)| Arc::ptr_eq(held, robot));
        match asked {
            Asked::Lease { client, force, .. } => {
                if !self.may_drive {
                    return Err(Problem::new(Kind::Forbidden, "this token is for watching and cancelling alone"));
                }
                if index.is_none() && leases.0.len() >= LEASES_MAX {
                    return Err(Problem::new(Kind::Overload, "too many leases for one connection"));
                }
                let held = index.and_then(|index| leases.0.get(index)).map(|(_, word)| word.as_str());
                let client = client.as_deref().unwrap_or(&self.client);
                crate::api::check_client(client)?;
                let lease = robot.acquire(&Wish { client, force: *force, word: held, lasts: None })?;
                let answer = json!({ "type": "lease", "robot": robot.name(), "lease": lease.word, "client": lease.driver.client });
                if let Some(index) = index {
                    leases.0.remove(index);
                }
                leases.0.push((Arc::clone(robot), lease.word));
                Ok(answer)
            }
            Asked::Release { .. } => {
                let held = index.map(|index| leases.0.remove(index));
                match held {
                    Some((robot, word)) if robot.release(&word) => {
                        Ok(json!({ "type": "released", "robot": robot.name() }))
                    }
                    _ => Err(Problem::new(Kind::NoLease, "this connection does not drive it")),
                }
            }
        }
    }
}

async fn next_of(events: &mut Option<Receiver<Arc<Event>>>) -> Result<Arc<Event>, RecvError> {
    match events {
        Some(events) => events.recv().await,
        None => std::future::pending().await,
    }
}

const fn patience(leases: &Leases) -> Duration {
    if leases.0.is_empty() { WATCHER_TIME } else { DRIVER_TIME }
}

async fn send(socket: &mut WebSocket, text: Utf8Bytes, leases: &Leases) -> Result<(), Option<&'static str>> {
    within(patience(leases), socket.send(Message::Text(text))).await
}

/// A client that takes nothing for so long is gone.
async fn within(
    time: Duration,
    sending: impl Future<Output = Result<(), axum::Error>>,
) -> Result<(), Option<&'static str>> {
    match timeout(time, sending).await {
        Ok(Ok(())) => Ok(()),
        Ok(Err(_)) | Err(_) => Err(None),
    }
}
