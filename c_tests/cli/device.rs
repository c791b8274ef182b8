//! A device that the test plays: what a program that opens it reads and writes.

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::time::{Duration, Instant};

use rustix::fs::{Mode, OFlags, fcntl_setfl, open};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use super::TIMEOUT;

pub(super) struct Device {
    master: File,
    /// Kept open, so that reading waits for programs.
    _slave: File,
    pub(super) path: String,
}

impl Device {
    pub(super) fn new() -> Self {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        fcntl_setfl(&master, OFlags::RDWR | OFlags::NONBLOCK).unwrap();
        let mut settings = tcgetattr(&master).unwrap();
        settings.make_raw();
        tcsetattr(&master, OptionalActions::Now, &settings).unwrap();
        let path = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
        let slave = open(path.as_str(), OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty()).unwrap();
        Self { master: master.into(), _slave: slave.into(), path }
    }

    pub(super) fn say(&mut self, bytes: &[u8]) {
        self.master.write_all(bytes).unwrap();
    }

    /// Waits for so many bytes from the program.
    pub(super) fn hear(&mut self, count: usize) -> Vec<u8> {
        let mut heard = Vec::new();
        let began = Instant::now();
        while heard.len() < count && began.elapsed() < TIMEOUT {
            heard.extend(self.hear_now());
            std::thread::sleep(Duration::from_millis(1));
        }
        heard
    }

    pub(super) fn hear_now(&mut self) -> Vec<u8> {
        let mut room = [0; 4096];
        match self.master.read(&mut room) {
            Ok(count) => room[..count].to_vec(),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Vec::new(),
            Err(error) => panic!("{error}"),
        }
    }
}
