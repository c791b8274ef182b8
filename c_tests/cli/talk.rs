//! A host that knows nothing but the bytes to send and to hear.

use std::ffi::CString;
use std::mem::MaybeUninit;
use std::time::{Duration, Instant};

use deltarobot::port::{Port, Settings};

use super::{PATIENCE, Running};

/// A simulator, and its device opened.
pub(super) struct Talk {
    port: Port,
    /// What was heard and not asked for yet.
    heard: Vec<u8>,
    pub(super) sim: Running,
}

impl Talk {
    pub(super) fn with_sim(arguments: &[&str]) -> Self {
        let sim = Running::sim(arguments);
        let mut talk = Self { port: Port::new(), heard: Vec::new(), sim };
        talk.open();
        talk
    }

    pub(super) fn open(&mut self) {
        let device = CString::new(self.sim.device.as_str()).unwrap();
        assert!(self.port.open(&device, &Settings::at(115_200)).is_ok(), "{:?}", self.port.error());
    }

    pub(super) fn close(&mut self) {
        self.port.close();
        self.heard.clear();
    }

    pub(super) fn say(&mut self, bytes: impl AsRef<[u8]>) {
        assert!(self.port.send(bytes.as_ref(), 1000).is_ok(), "{:?}", self.port.error());
    }

    /// Whatever comes within that time, and what came before.
    pub(super) fn hear_for(&mut self, milliseconds: u64) -> Vec<u8> {
        self.hear_until(Duration::from_millis(milliseconds), |_| false);
        std::mem::take(&mut self.heard)
    }

    /// So many bytes, or fewer when they don't come.
    pub(super) fn hear(&mut self, count: usize) -> Vec<u8> {
        self.hear_until(PATIENCE, |heard| heard.len() >= count);
        self.heard.drain(..count.min(self.heard.len())).collect()
    }

    /// So many lines without their ends.
    pub(super) fn hear_lines(&mut self, count: usize) -> Vec<String> {
        self.hear_until(PATIENCE, |heard| heard.split(|byte| *byte == b'\n').count() > count);
        let text = String::from_utf8(std::mem::take(&mut self.heard)).unwrap();
        let mut said = text.split_inclusive('\n');
        let first = said.by_ref().take(count).map(|line| line.trim_end_matches('\n').to_owned()).collect();
        self.heard = said.collect::<String>().into_bytes();
        first
    }

    fn hear_until(&mut self, time: Duration, is_enough: impl Fn(&[u8]) -> bool) {
        let began = Instant::now();
        let mut room = [MaybeUninit::uninit(); 256];
        while began.elapsed() < time && !is_enough(&self.heard) {
            let read = self.port.read(&mut room, 10).map(|bytes| self.heard.extend_from_slice(bytes));
            assert!(read.is_ok(), "{:?}", self.port.error());
        }
    }
}

impl Drop for Talk {
    fn drop(&mut self) {
        self.port.close();
    }
}
