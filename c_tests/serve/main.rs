//! `deltarobot serve` as it is used: the program runs, robots are at pseudo-terminals, and what it answers over HTTP and
//! WebSockets is what its OpenAPI description says.

#![allow(
    clippy::arithmetic_side_effects,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that can't go on fails"
)]

mod commands;
mod driving;
mod faults;
mod http;
mod line;
mod program;
mod robot;
mod schema;
mod security;
#[allow(dead_code, reason = "other tests use the rest")]
#[path = "../common/steps.rs"]
mod steps;
mod watching;

use std::io::{BufRead, BufReader, Read};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::{Child, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::steps::{TIMEOUT, found};

/// The program, which is killed when the test ends.
struct Server {
    child: Child,
    out: BufReader<ChildStdout>,
    address: SocketAddr,
    /// What it said before its address.
    said: Vec<String>,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn program(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_deltarobot-serve"));
    command.args(arguments).stdin(Stdio::null());
    command
}

impl Server {
    fn start(arguments: &[&str]) -> Self {
        let mut command = program(arguments);
        if !arguments.contains(&"--listen") {
            command.args(["--listen", "127.0.0.1:0"]);
        }
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let (mut out, mut said) = (BufReader::new(child.stdout.take().unwrap()), Vec::new());
        let address = loop {
            let mut line = String::new();
            assert_ne!(out.read_line(&mut line).unwrap(), 0, "it has ended");
            match line.trim().strip_prefix("http://") {
                Some(address) => break address.parse().unwrap(),
                None => said.push(line.trim().to_owned()),
            }
        };
        Self { child, out, address, said }
    }

    fn signal(&self, signal: rustix::process::Signal) {
        let id = rustix::process::Pid::from_raw(self.child.id().try_into().unwrap()).unwrap();
        rustix::process::kill_process(id, signal).unwrap();
    }

    /// Waits for its end.
    fn wait(&mut self) -> ExitStatus {
        let _ = self.out.read_to_string(&mut String::new());
        self.child.wait().unwrap()
    }
}

/// A path for a file of this test alone.
fn place(name: &str) -> PathBuf {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}-{number}", std::process::id()))
}

/// A file of this test alone.
fn file(name: &str, text: &str) -> String {
    let path = place(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}
