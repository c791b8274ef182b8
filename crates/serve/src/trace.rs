//! Paths that robots trace: one target after the other, for who drives.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use deltarobot_cli::path::{Errors, Runner, Step};
use serde::Serialize;
use tokio::sync::Notify;

use crate::event::{Event, What};
use crate::locked;
use crate::problem::{Kind, Problem};
use crate::robot::{Command, Goal, Place, Robot};
use crate::state::{End, stamp};

/// How often a pause looks whether its driver is there.
const LOOK: Duration = Duration::from_millis(500);

/// What a run does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Doing {
    Running,
    Paused,
    Finished,
    Cancelled,
    Failed,
}

/// How far a run is; openapi.json describes it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Run {
    state: Doing,
    done: usize,
    total: usize,
    /// Seconds.
    left: Option<f64>,
    error: Option<Errors>,
    message: String,
}

/// The paths that are being traced, by the robots' names.
#[derive(Debug, Default)]
pub(crate) struct Traces(Mutex<BTreeMap<Arc<str>, Arc<Trace>>>);

/// A path that is being traced.
#[derive(Debug)]
struct Trace {
    word: String,
    robot: Arc<Robot>,
    runner: Mutex<Runner>,
    resumed: Notify,
    /// What was published last.
    said: Mutex<Option<Run>>,
}

impl Traces {
    /// Begins with a path.
    pub(crate) fn begin(self: &Arc<Self>, robot: &Arc<Robot>, word: &str, runner: Runner) -> Result<Run, Problem> {
        let cancels = robot.cancels();
        robot.leases.holder(word)?;
        let trace = Arc::new(Trace {
            word: word.to_owned(),
            robot: Arc::clone(robot),
            runner: runner.into(),
            resumed: Notify::new(),
            said: Mutex::default(),
        });
        let name = Arc::clone(robot.name());
        {
            let mut traces = locked(&self.0);
            if traces.contains_key(&name) {
                return Err(Problem::new(Kind::Busy, "it traces a path already"));
            }
            traces.insert(Arc::clone(&name), Arc::clone(&trace));
        }
        let (traces, run) = (Arc::clone(self), trace.publish(Doing::Running, None, String::new()));
        tokio::spawn(async move {
            let began = Instant::now();
            let (doing, message) = trace.follow(cancels, began).await;
            locked(&traces.0).remove(&name);
            trace.publish(doing, None, message);
        });
        Ok(run)
    }

    /// How far the robot's path is, for whoever begins to watch.
    pub(crate) fn run(&self, robot: &Robot) -> Option<Run> {
        let trace = locked(&self.0).get(robot.name()).cloned()?;
        locked(&trace.said).clone()
    }

    /// Makes no more moves after this one, or goes on.
    pub(crate) fn pause(&self, robot: &Robot, word: &str, pauses: bool) -> Result<(), Problem> {
        robot.leases.holder(word)?;
        let trace = locked(&self.0).get(robot.name()).cloned();
        let trace = trace.ok_or_else(|| Problem::new(Kind::Impossible, "it traces no path"))?;
        {
            let mut runner = locked(&trace.runner);
            if pauses { runner.pause() } else { runner.resume() }
        }
        trace.resumed.notify_one();
        Ok(())
    }
}

impl Trace {
    /// Returns how it ended, and why.
    async fn follow(&self, cancels: u64, mut since: Instant) -> (Doing, String) {
        loop {
            since += self.wait_while_paused(cancels, since).await;
            let was_cancelled = || self.robot.cancels() != cancels;
            if was_cancelled() {
                return (Doing::Cancelled, String::new());
            }
            let step = locked(&self.runner).step();
            let target = match step {
                Step::Move(target) => target,
                Step::Finished => return (Doing::Finished, String::new()),
                Step::Paused => match self.robot.leases.holder(&self.word) {
                    Ok(_) => continue,
                    Err(problem) => return (Doing::Failed, problem.detail),
                },
            };
            let goal = Goal { place: Place::Displacements(target.displacements), is_relative: false };
            let motion = match self.robot.begin(Command::Move(goal), &self.word, None).await {
                Ok(motion) => motion,
                Err(_) if was_cancelled() => return (Doing::Cancelled, String::new()),
                Err(problem) => return (Doing::Failed, problem.detail),
            };
            // It came between the look at the count and the move.
            if was_cancelled() {
                let _ = self.robot.cancel().await;
            }
            let Ok(operation) = motion.ended.await else { return (Doing::Failed, "the program ends".into()) };
            match operation.outcome {
                Some(End::Finished) => (),
                Some(End::Cancelled) => return (Doing::Cancelled, String::new()),
                _ => {
                    let why = operation.reason.unwrap_or_else(|| "the move did not finish".into());
                    return (Doing::Failed, format!("line {}: {why}", target.line));
                }
            }
            let Some(at) = self.robot.snapshot().displacements else {
                return (Doing::Failed, "the robot no longer knows where it is".into());
            };
            let left = {
                let mut runner = locked(&self.runner);
                runner.reached(at);
                runner.progress().time_left(since.elapsed())
            };
            self.publish(Doing::Running, left, String::new());
        }
    }

    /// Returns how long that was. Ends when it was cancelled, or its driver is gone, too.
    async fn wait_while_paused(&self, cancels: u64, since: Instant) -> Duration {
        let paused = Instant::now();
        let mut was_told = false;
        while locked(&self.runner).step() == Step::Paused
            && self.robot.cancels() == cancels
            && self.robot.leases.holder(&self.word).is_ok()
        {
            if !was_told {
                let left = locked(&self.runner).progress().time_left(since.elapsed());
                self.publish(Doing::Paused, left, String::new());
                was_told = true;
            }
            let _ = tokio::time::timeout(LOOK, self.resumed.notified()).await;
        }
        if was_told {
            self.publish(Doing::Running, None, String::new());
        }
        paused.elapsed()
    }

    fn publish(&self, state: Doing, left: Option<Duration>, message: String) -> Run {
        let left = left.map(|left| left.as_secs_f64());
        let run = {
            let runner = locked(&self.runner);
            let progress = runner.progress();
            Run { state, done: progress.done, total: progress.all, left, error: runner.errors(), message }
        };
        *locked(&self.said) = Some(run.clone());
        let what = What::Path { time: stamp(), run: run.clone() };
        self.robot.publish(Event::new(Arc::clone(self.robot.name()), what));
        run
    }
}
