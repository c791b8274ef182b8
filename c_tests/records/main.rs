//! Recordings in MCAP and CSV: what `deltarobot record` and `deltarobot convert` write, and who can read it.

#![allow(
    clippy::arithmetic_side_effects,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that can't go on fails"
)]

mod convert;
mod killed;
#[path = "../common/programs_built.rs"]
mod programs_built;
mod python;
mod record;
#[allow(dead_code, reason = "other tests use the rest")]
#[path = "../common/steps.rs"]
mod steps;
#[allow(dead_code, reason = "the tests of the library use the rest")]
#[path = "../common/support.rs"]
mod support;

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use crate::programs_built::program;
use crate::steps::{until, utf8};
use crate::support::{out_dir, run, text};

const FINISHED: i32 = 0;
const USAGE: i32 = 2;
const DEVICE: i32 = 3;

/// A recording of all that can be in one.
const SAMPLE: &str = "# deltarobot recording 1\n# started 2026-11-28T20:41:15.123456Z\n# gap 0.05\n\
    0.012345 > 24 53 00 B1 3A\n\
    0.013702 < 24 73 0D 01 00 00 80 3F 00 00 00 40 00 00 60 C0 FE 3A\n\
    0.500000 > 24 4D\n\
    0.900000 < 46 47 48\n\
    3600.000001 < 24 68 00 C6 3A\n";

/// The program `deltarobot`, which finds `deltarobot-convert` beside it.
fn deltarobot(arguments: &[&str]) -> Command {
    let mut command = Command::new(program("deltarobot", "deltarobot-cli"));
    command.args(arguments).env_remove("DELTAROBOT_PORT");
    command
}

/// Asserts the exit status; what it printed.
fn ended(arguments: &[&str], status: i32) -> Output {
    let output = run(&mut deltarobot(arguments));
    assert_eq!(output.status.code(), Some(status), "{arguments:?}:\n{}", text(&output));
    output
}

fn printed(arguments: &[&str]) -> String {
    String::from_utf8(ended(arguments, FINISHED).stdout).unwrap()
}

/// Asserts that it complains on one line, which has this in it.
fn complains(arguments: &[&str], status: i32, about: &str) {
    let said = String::from_utf8(ended(arguments, status).stderr).unwrap();
    assert!(said.lines().count() == 1 && said.starts_with("deltarobot: "), "{arguments:?}: {said}");
    assert!(said.contains(about), "{arguments:?}: {said}");
}

/// A directory that is empty.
fn empty(name: &str) -> PathBuf {
    let path = out_dir().join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

/// A program that runs beside the others.
struct Running(Child);

impl Running {
    fn start(arguments: &[&str]) -> Self {
        Self(deltarobot(arguments).stdout(Stdio::null()).spawn().unwrap())
    }

    /// A simulator, and its port.
    fn sim() -> (Self, String) {
        let mut child = deltarobot(&["sim", "--speed", "5"]).stdout(Stdio::piped()).spawn().unwrap();
        let mut port = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut port).unwrap();
        (Self(child), port.trim().to_owned())
    }

    fn signal(&self, name: &str) {
        signal(self.0.id(), name);
    }

    fn wait(&mut self) -> Option<i32> {
        self.0.wait().unwrap().code()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn signal(id: u32, name: &str) {
    let status = Command::new("kill").args([&format!("-{name}"), &id.to_string()]).status().unwrap();
    assert!(status.success());
}
