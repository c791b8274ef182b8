//! `deltarobot serve` with what others run already: a real broker, scrapers, and readers of its records.

#![allow(
    clippy::arithmetic_side_effects,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that can't go on fails"
)]

mod broker;
mod commands;
mod faults;
mod metrics;
mod mqtt;
#[path = "../common/programs_built.rs"]
mod programs_built;
mod records;
#[allow(dead_code, reason = "other tests use the rest")]
#[path = "../common/steps.rs"]
mod steps;
#[allow(dead_code, reason = "the tests of the library use the rest")]
#[path = "../common/support.rs"]
mod support;
mod tls;
mod unit;

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::steps::{TIMEOUT, found, until, utf8};
use crate::support::out_dir;

/// The program, with a robot that is simulated.
struct Server {
    child: Child,
    address: String,
    /// What it complains about.
    said: Arc<Mutex<String>>,
}

impl Server {
    /// Starts it with these settings.
    fn start(settings: &str) -> Self {
        Self::start_by(Command::new(env!("CARGO_BIN_EXE_deltarobot-serve")), settings)
    }

    fn start_by(mut command: Command, settings: &str) -> Self {
        let file = empty("settings").join("serve.toml");
        fs::write(&file, format!("simulated = 1\nlisten = \"127.0.0.1:0\"\n{settings}")).unwrap();
        command.arg("--config").arg(&file).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let said = Arc::<Mutex<String>>::default();
        let (mut errors, copy) = (BufReader::new(child.stderr.take().unwrap()), Arc::clone(&said));
        std::thread::spawn(move || {
            let mut line = String::new();
            while errors.read_line(&mut line).is_ok_and(|count| count > 0) {
                copy.lock().unwrap().push_str(&line);
                line.clear();
            }
        });
        let address = line.trim().strip_prefix("http://").map(str::to_owned);
        let address = address.unwrap_or_else(|| panic!("it has ended: {}", said.lock().unwrap()));
        Self { child, address, said }
    }

    fn said(&self) -> String {
        self.said.lock().unwrap().clone()
    }

    /// The body that is at a path.
    fn get(&self, path: &str) -> String {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", self.address).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
        answer.split_once("\r\n\r\n").unwrap().1.to_owned()
    }

    /// A number on the page of metrics.
    fn metric(&self, name: &str) -> u64 {
        let page = self.get("/metrics");
        let line = page.lines().find(|line| line.rsplit_once(' ').is_some_and(|(metric, _)| metric == name));
        line.unwrap_or_else(|| panic!("no {name}:\n{page}")).rsplit_once(' ').unwrap().1.parse().unwrap()
    }

    fn signal(&self, name: &str) {
        let status = Command::new("kill").args([&format!("-{name}"), &self.child.id().to_string()]).status().unwrap();
        assert!(status.success());
    }

    /// Ends it; its exit status.
    fn end(mut self) -> Option<i32> {
        self.signal("TERM");
        self.child.wait().unwrap().code()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A directory that is empty, and of this call alone.
fn empty(name: &str) -> PathBuf {
    static COUNT: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
    let number = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let path = out_dir().join(format!("outside-{name}-{}-{number}", std::process::id()));
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

/// How often faults are repeated: `make faults` says more.
fn rounds() -> u32 {
    std::env::var("DP_ROUNDS").map_or(1, |rounds| rounds.parse().unwrap())
}
