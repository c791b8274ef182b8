//! The thread of a robot: opens its port, again and again if need be.

use std::io::{self, Read};
use std::sync::Arc;
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use deltarobot_cli::port::Device;
use deltarobot_cli::system::{Wake, wakes};
use deltarobot_cli::wait::wait;
use rustix::fd::AsFd;

use super::session::Session;
use super::view::View;
use super::{All, Robot, Settings};
use crate::locked;
use crate::problem::{Kind, Problem};

/// How long it is waited before a port is tried again, at first and at last.
const RETRY: [Duration; 2] = [Duration::from_millis(200), Duration::from_secs(2)];

/// Begins with a robot. When its thread has ended, `ended` is disconnected.
pub(crate) fn start(settings: Settings, all: All, ended: mpsc::Sender<()>) -> io::Result<Arc<Robot>> {
    let (waker, woken) = wakes()?;
    let robot = Arc::new(Robot::new(settings, all, waker));
    let worker = Worker { view: View::new(Arc::clone(&robot)), robot: Arc::clone(&robot), woken };
    thread::Builder::new().name(robot.name().to_string()).stack_size(256 << 10).spawn(move || {
        worker.run();
        drop(ended);
    })?;
    Ok(robot)
}

struct Worker {
    robot: Arc<Robot>,
    view: View,
    woken: Wake,
}

impl Worker {
    fn run(mut self) {
        let [shortest, longest] = RETRY;
        let mut pause = shortest;
        // Whether the robot has to stand as soon as it can be reached again: it moved when the port went away, and what
        // it did since nobody has seen; or somebody wanted it to.
        let mut cancels = false;
        while !self.robot.is_ending() {
            match Device::open(&self.robot.settings.path, &self.robot.settings.port) {
                Ok(device) => {
                    // What was asked for before the port was open would come late.
                    cancels |= self.refuse();
                    self.view.is_open();
                    let mut session = Session::new(device, &mut self.view, &self.woken);
                    if std::mem::take(&mut cancels) {
                        session.cancel();
                    }
                    let Err(failure) = session.run() else { break };
                    cancels = session.is_in_motion();
                    let health = session.health();
                    self.view.is_lost(&failure.to_string(), &health);
                    pause = shortest;
                }
                Err(failure) => self.view.is_closed(failure.to_string()),
            }
            cancels |= self.pause(pause);
            pause = (2 * pause).min(longest);
        }
        self.refuse();
    }

    /// Lets time pass. Returns whether the robot shall be cancelled.
    fn pause(&mut self, time: Duration) -> bool {
        let (began, mut cancels) = (Instant::now(), false);
        while !self.robot.is_ending() && began.elapsed() < time {
            // An error of poll(2) is no reason not to try the port again.
            let _ = wait(self.woken.as_fd(), time.saturating_sub(began.elapsed()));
            drain(&self.woken);
            cancels |= self.refuse();
            self.view.look_around();
        }
        cancels
    }

    /// Refuses what can't be done while the port is not open. Returns whether that was to cancel.
    fn refuse(&mut self) -> bool {
        let inbox = std::mem::take(&mut *locked(&self.robot.inbox));
        let error = match self.view.state.link_error.as_deref() {
            Some(error) => error,
            None if self.robot.is_ending() => "the program is ending",
            None => "its port is not open yet",
        };
        let down = || Problem::new(Kind::Down, error);
        let cancels = !inbox.cancels.is_empty();
        // Who asked may not wait for the answer.
        for reply in inbox.cancels {
            let _ = reply.send(Err(Problem::new(
                Kind::Down,
                format!("{error}; the robot will be cancelled when it can be reached again"),
            )));
        }
        for order in inbox.orders {
            let _ = order.reply.send(Err(down()));
        }
        for raw in inbox.raw {
            let _ = raw.reply.send(Err(down()));
        }
        cancels
    }
}

/// Takes what woke the thread up.
pub(super) fn drain(mut woken: &Wake) {
    let mut room = [0; 64];
    while matches!(woken.read(&mut room), Ok(1..)) {}
}
