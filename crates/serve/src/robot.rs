//! A robot: what others may ask of it, and what they learn from it. Its thread, which owns the port, is in `worker`.

mod order;
mod session;
mod tap;
mod view;
mod worker;

use std::collections::VecDeque;
use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use deltarobot_cli::path::Machine;
use deltarobot_cli::port::PortOptions;
use deltarobot_cli::recording::Entry;
use deltarobot_cli::system::Wake;
use deltarobot_protocols::deltarobot::Layout;
use tokio::sync::{broadcast, oneshot, watch};

use crate::event::Event;
use crate::lease::{Lease, Leases, Wish};
use crate::locked;
use crate::problem::{Kind, Problem};
use crate::record::Progress;
use crate::state::{End, Operation, State};
pub(crate) use order::{Command, Goal, Place};
use order::{Order, Raw};
pub(crate) use worker::start;

/// Events that are kept for a slow watcher of one robot, and of all.
const KEPT: usize = 256;
/// See above.
pub(crate) const KEPT_OF_ALL: usize = 4096;
/// Orders that wait for the thread, which takes them at once unless it is connecting.
const ORDERS_MAX: usize = 64;

/// How a robot is reached and treated.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    /// Its name.
    pub(crate) name: Arc<str>,
    /// The port.
    pub(crate) path: PathBuf,
    /// How that is opened.
    pub(crate) port: PortOptions,
    /// How status reports are laid out.
    pub(crate) layout: Layout,
    /// How long a motion may take.
    pub(crate) timeout: Option<Duration>,
    /// How long an answer may take.
    pub(crate) answer_time: Option<Duration>,
    /// Whether a motion is cancelled when nobody drives any more.
    pub(crate) cancels_abandoned: bool,
    /// Its measures.
    pub(crate) geometry: Option<Machine>,
}

/// What its thread shares with all others.
#[derive(Debug)]
pub(crate) struct Robot {
    /// How it is reached and treated.
    pub(crate) settings: Settings,
    /// Who drives.
    pub(crate) leases: Leases,
    /// Its measures now.
    pub(crate) geometry: Mutex<Option<Arc<Machine>>>,
    /// What is known now.
    pub(crate) state: watch::Sender<Arc<State>>,
    /// What happens, but for messages.
    pub(crate) events: broadcast::Sender<Arc<Event>>,
    /// Messages on the line.
    pub(crate) messages: broadcast::Sender<Arc<Event>>,
    /// Bytes on the line, and when that was since it `began`.
    pub(crate) bytes: broadcast::Sender<Arc<Entry>>,
    began: Instant,
    all: All,
    inbox: Mutex<Inbox>,
    waker: Wake,
    cancels: AtomicU64,
    is_ending: AtomicBool,
}

/// Where the events of all robots go.
#[derive(Clone, Debug)]
pub(crate) struct All {
    /// What happens, but for messages.
    pub(crate) events: broadcast::Sender<Arc<Event>>,
    /// Messages on the lines.
    pub(crate) messages: broadcast::Sender<Arc<Event>>,
    /// How recording goes.
    pub(crate) records: Arc<Progress>,
}

/// What the thread has to do.
#[derive(Debug, Default)]
struct Inbox {
    cancels: Vec<oneshot::Sender<Result<End, Problem>>>,
    orders: VecDeque<Order>,
    raw: VecDeque<Raw>,
}

/// A motion that was begun.
#[derive(Debug)]
pub(crate) struct Begun {
    /// Which.
    pub(crate) operation: Operation,
    /// How it ends.
    pub(crate) ended: oneshot::Receiver<Operation>,
}

impl Robot {
    fn new(settings: Settings, all: All, waker: Wake) -> Self {
        let state = State::new(Arc::clone(&settings.name), settings.path.to_string_lossy().into());
        Self {
            leases: Leases::default(),
            geometry: Mutex::new(settings.geometry.clone().map(Arc::new)),
            state: watch::Sender::new(Arc::new(state)),
            events: broadcast::Sender::new(KEPT),
            messages: broadcast::Sender::new(KEPT),
            bytes: broadcast::Sender::new(KEPT),
            began: Instant::now(),
            all,
            inbox: Mutex::default(),
            waker,
            cancels: AtomicU64::new(0),
            is_ending: AtomicBool::new(false),
            settings,
        }
    }

    /// Its name.
    pub(crate) fn name(&self) -> &Arc<str> {
        &self.settings.name
    }

    /// What is known of it now.
    pub(crate) fn snapshot(&self) -> Arc<State> {
        Arc::clone(&self.state.borrow())
    }

    /// Has the thread look at what is new.
    pub(crate) fn wake(&self) {
        // If there is no room, it has not looked at the last yet.
        let _ = (&self.waker).write(&[0]);
    }

    /// Gives the right to drive.
    pub(crate) fn acquire(&self, wish: &Wish) -> Result<Lease, Problem> {
        let lease = self.leases.acquire(wish)?;
        self.wake();
        Ok(lease)
    }

    /// Takes it back. Returns whether that was the lease.
    pub(crate) fn release(&self, word: &str) -> bool {
        let was_held = self.leases.release(word);
        self.wake();
        was_held
    }

    /// Begins a motion for who holds the lease.
    pub(crate) async fn begin(&self, command: Command, word: &str, expires: Option<Instant>) -> Result<Begun, Problem> {
        let (reply, answer) = oneshot::channel();
        {
            let mut inbox = locked(&self.inbox);
            if inbox.orders.len() >= ORDERS_MAX {
                return Err(Problem::new(Kind::Overload, "too many requests are waiting for this robot"));
            }
            inbox.orders.push_back(Order { command, word: word.to_owned(), expires, reply });
        }
        self.wake();
        answer.await.map_err(|_| gone())?
    }

    /// Drives for one motion and waits for its end. When that is not waited for any more, nobody drives.
    pub(crate) async fn perform(
        &self,
        command: Command,
        client: &str,
        expires: Option<Instant>,
    ) -> Result<Operation, Problem> {
        let lease = self.acquire(&Wish { client, force: false, word: None, lasts: None })?;
        let held = Held { robot: self, word: lease.word };
        let begun = self.begin(command, &held.word, expires).await?;
        begun.ended.await.map_err(|_| gone())
    }

    /// Cancels what the robot does, ahead of all orders. Returns what the controller has said.
    pub(crate) async fn cancel(&self) -> Result<End, Problem> {
        let (reply, answer) = oneshot::channel();
        self.cancels.fetch_add(1, Ordering::SeqCst);
        locked(&self.inbox).cancels.push(reply);
        self.wake();
        answer.await.map_err(|_| gone())?
    }

    /// How often that was asked for: whoever has more than one motion in mind gives up when it changes.
    pub(crate) fn cancels(&self) -> u64 {
        self.cancels.load(Ordering::SeqCst)
    }

    /// Sends bytes of who holds the lease.
    pub(crate) async fn send_raw(&self, bytes: Vec<u8>, word: &str) -> Result<(), Problem> {
        let (reply, answer) = oneshot::channel();
        locked(&self.inbox).raw.push_back(Raw { bytes, word: word.to_owned(), reply });
        self.wake();
        answer.await.map_err(|_| gone())?
    }

    /// Sets its measures.
    pub(crate) fn set_geometry(&self, geometry: Option<Machine>) -> State {
        let geometry = geometry.map(Arc::new);
        locked(&self.geometry).clone_from(&geometry);
        self.wake();
        let mut state = State::clone(&self.snapshot());
        state.geometry = geometry;
        state.find_pose();
        state
    }

    /// Has the thread cancel what the robot does, and end.
    pub(crate) fn end(&self) {
        self.is_ending.store(true, Ordering::Relaxed);
        self.wake();
    }

    fn is_ending(&self) -> bool {
        self.is_ending.load(Ordering::Relaxed)
    }

    /// Shows it to whoever watches.
    pub(crate) fn publish(&self, event: Event) {
        let event = Arc::new(event);
        // Nobody has to watch.
        let _ = self.events.send(Arc::clone(&event));
        let _ = self.all.events.send(event);
    }
}

/// Drives until it is dropped.
struct Held<'a> {
    robot: &'a Robot,
    word: String,
}

impl Drop for Held<'_> {
    fn drop(&mut self) {
        self.robot.release(&self.word);
    }
}

fn gone() -> Problem {
    Problem::new(Kind::Down, "the port was lost in the meantime, or the program ends")
}
