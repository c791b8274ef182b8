//! All robots.

use std::collections::BTreeMap;
use std::io;
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, mpsc};
use std::time::Duration;

use tokio::sync::{broadcast, watch};

use crate::problem::{Kind, Problem};
use crate::robot::{All, KEPT_OF_ALL, Robot, Settings, start};

/// How long the end of the program waits for the threads, which take less unless one is connecting.
const END_TIME: Duration = Duration::from_secs(5);

/// The robots by their names.
#[derive(Debug)]
pub(crate) struct Fleet {
    /// By their names.
    pub(crate) robots: BTreeMap<Arc<str>, Arc<Robot>>,
    /// Events of all of them.
    pub(crate) all: All,
    /// Connections that watch all of them.
    pub(crate) watchers: AtomicU64,
    /// Events that slow watchers have lost.
    pub(crate) dropped: AtomicU64,
    /// Whether the program is over: who watches gets what has happened until then, and lets go of it.
    pub(crate) is_over: watch::Sender<bool>,
    /// Disconnected when all threads have ended.
    ended: std::sync::Mutex<mpsc::Receiver<()>>,
}

impl Fleet {
    /// Begins with all of them.
    pub(crate) fn start(robots: Vec<Settings>) -> io::Result<Self> {
        let all = All {
            events: broadcast::Sender::new(KEPT_OF_ALL),
            messages: broadcast::Sender::new(KEPT_OF_ALL),
            records: Arc::default(),
        };
        let (ending, ended) = mpsc::channel();
        let robots = robots
            .into_iter()
            .map(|settings| {
                let robot = start(settings, all.clone(), ending.clone())?;
                Ok((Arc::clone(robot.name()), robot))
            })
            .collect::<io::Result<_>>()?;
        let (watchers, dropped) = (AtomicU64::new(0), AtomicU64::new(0));
        let is_over = watch::Sender::new(false);
        Ok(Self { robots, all, watchers, dropped, is_over, ended: ended.into() })
    }

    /// A robot.
    pub(crate) fn robot(&self, name: &str) -> Result<&Arc<Robot>, Problem> {
        self.robots.get(name).ok_or_else(|| Problem::new(Kind::NotFound, format!("there is no robot named {name}")))
    }

    /// Has all robots stand, and gives up their ports.
    pub(crate) fn end(&self) {
        self.robots.values().for_each(|robot| robot.end());
        // Disconnected, or too late.
        let _ = crate::locked(&self.ended).recv_timeout(END_TIME);
        self.is_over.send_replace(true);
    }
}
