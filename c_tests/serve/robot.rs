//! A robot at a pseudo-terminal, which a test can take away.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use deltarobot_cli::far_end::{Input, Place};
use deltarobot_cli::sim::deltarobot::{Controller, ControllerOptions};
use deltarobot_cli::sim::random::Random;
use deltarobot_cli::sim::{Machine, TICK};

/// Requests as they look on the line.
pub(super) const CANCEL: &[u8] = b"$C\0\xA1:";
pub(super) const HOME: &[u8] = b"$H\0\xA6:";

/// A simulated robot.
pub(super) struct Robot {
    pub(super) link: PathBuf,
    heard: Arc<Mutex<Vec<u8>>>,
    is_mute: Arc<AtomicBool>,
    line: Option<(Arc<AtomicBool>, JoinHandle<Controller>)>,
}

impl Robot {
    /// Its fastest arm makes so many units in a second.
    pub(super) fn new(speed: f64) -> Self {
        let mut options = ControllerOptions::default();
        options.speed = Some(speed);
        let (link, heard, is_mute) = (super::place("robot"), Arc::default(), Arc::default());
        let mut robot = Self { link, heard, is_mute, line: None };
        robot.plug(Controller::new(&options, Random::new(Some(1))));
        robot
    }

    /// As arguments have it.
    pub(super) fn named(&self, name: &str) -> String {
        format!("{name}={}", self.link.display())
    }

    /// Puts it at the line.
    pub(super) fn plug(&mut self, mut controller: Controller) {
        let mut line = Place::linked(&self.link).make(None).unwrap();
        let (heard, is_mute, is_over) = (Arc::clone(&self.heard), Arc::clone(&self.is_mute), Arc::default());
        let over = Arc::clone(&is_over);
        let began = Instant::now();
        let thread = std::thread::spawn(move || {
            let mut room = [0; 256];
            while !AtomicBool::load(&over, Ordering::Relaxed) {
                std::thread::sleep(TICK);
                let (now, mut out) = (began.elapsed(), Vec::new());
                if let Input::Bytes(count @ 1..) = line.read(&mut room, Duration::ZERO).unwrap() {
                    heard.lock().unwrap().extend_from_slice(&room[..count]);
                    controller.receive(&room[..count], now, &mut out);
                }
                controller.turn(now, &mut out);
                if !is_mute.load(Ordering::Relaxed) {
                    line.write(&out).unwrap();
                }
            }
            controller
        });
        self.line = Some((is_over, thread));
    }

    /// Takes it off the line.
    pub(super) fn unplug(&mut self) -> Controller {
        let (is_over, thread) = self.line.take().unwrap();
        is_over.store(true, Ordering::Relaxed);
        thread.join().unwrap()
    }

    /// Whether what it sends gets lost.
    pub(super) fn mute(&self, is_mute: bool) {
        self.is_mute.store(is_mute, Ordering::Relaxed);
    }

    /// How often it has received that.
    pub(super) fn count(&self, bytes: &[u8]) -> usize {
        self.heard.lock().unwrap().windows(bytes.len()).filter(|window| *window == bytes).count()
    }
}

impl Drop for Robot {
    fn drop(&mut self) {
        if self.line.is_some() {
            self.unplug();
        }
    }
}
