//! A host that knows nothing but the bytes to send and to hear.

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::time::{Duration, Instant};

use super::{Running, TIMEOUT};

/// A simulator, and its device opened.
pub(super) struct Talk {
    port: Option<File>,
    /// What was heard and not asked for yet.
    heard: Vec<u8>,
    pub(super) sim: Running,
}

impl Talk {
    pub(super) fn with_sim(arguments: &[&str]) -> Self {
        let sim = Running::sim(arguments);
        let mut talk = Self { port: None, heard: Vec::new(), sim };
        talk.open();
        talk
    }

    pub(super) fn open(&mut self) {
        let flags = libc::O_NONBLOCK | libc::O_NOCTTY;
        let port = File::options().read(true).write(true).custom_flags(flags).open(&self.sim.device);
        self.port = Some(port.unwrap());
    }

    pub(super) fn close(&mut self) {
        self.port = None;
        self.heard.clear();
    }

    pub(super) fn say(&mut self, bytes: impl AsRef<[u8]>) {
        self.port.as_ref().unwrap().write_all(bytes.as_ref()).unwrap();
    }

    /// Whatever comes within that time, and what came before.
    pub(super) fn hear_for(&mut self, milliseconds: u64) -> Vec<u8> {
        self.hear_until(Duration::from_millis(milliseconds), |_| false);
        std::mem::take(&mut self.heard)
    }

    /// So many bytes, or fewer when they don't come.
    pub(super) fn hear(&mut self, count: usize) -> Vec<u8> {
        self.hear_until(TIMEOUT, |heard| heard.len() >= count);
        self.heard.drain(..count.min(self.heard.len())).collect()
    }

    /// So many lines without their ends.
    pub(super) fn hear_lines(&mut self, count: usize) -> Vec<String> {
        self.hear_until(TIMEOUT, |heard| heard.split(|byte| *byte == b'\n').count() > count);
        let text = String::from_utf8(std::mem::take(&mut self.heard)).unwrap();
        let mut said = text.split_inclusive('\n');
        let first = said.by_ref().take(count).map(|line| line.trim_end_matches('\n').to_owned()).collect();
        self.heard = said.collect::<String>().into_bytes();
        first
    }

    fn hear_until(&mut self, time: Duration, is_enough: impl Fn(&[u8]) -> bool) {
        let began = Instant::now();
        let mut room = [0; 256];
        while began.elapsed() < time && !is_enough(&self.heard) {
            match self.port.as_ref().unwrap().read(&mut room) {
                Ok(count) => self.heard.extend_from_slice(&room[..count]),
                Err(error) if error.kind() == ErrorKind::WouldBlock => std::thread::sleep(Duration::from_millis(1)),
                Err(error) => panic!("{error}"),
            }
        }
    }
}
