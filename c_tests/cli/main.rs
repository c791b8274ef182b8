//! The program `deltarobot`, as it is used: its ends of a line, what it prints and how it exits.

#![allow(
    clippy::arithmetic_side_effects,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that can't go on fails"
)]

mod answers;
mod arrival;
mod device;
mod generated;
mod gx;
mod line;
mod network;
mod output;
mod path;
mod python;
mod recordings;
mod run;
mod screens;
mod send;
mod sessions;
mod signals;
#[allow(dead_code, reason = "other tests use the rest")]
#[path = "../common/steps.rs"]
mod steps;
#[allow(dead_code, reason = "the tests of the library use the rest")]
#[path = "../common/support.rs"]
mod support;
mod talk;

use std::ffi::OsStr;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::steps::{TIMEOUT, until, utf8};
use crate::support::{DEFAULT, Library, Mode, Program, build, command, has_tool, is_missing, out_dir, root, run, text};

const FINISHED: i32 = 0;
const NOT_DONE: i32 = 1;
const USAGE: i32 = 2;
const DEVICE: i32 = 3;
const TIMED_OUT: i32 = 4;
const CANCELLED: i32 = 5;

/// The program under test; DP_CLI names another, such as an older one, on which tests of faults should fail.
fn program() -> PathBuf {
    std::env::var_os("DP_CLI").map_or_else(|| env!("CARGO_BIN_EXE_deltarobot").into(), PathBuf::from)
}

fn deltarobot(arguments: &[&str]) -> Command {
    let mut command = Command::new(program());
    command.args(arguments).env_remove("DELTAROBOT_PORT");
    command
}

/// Runs it to its end: the exit status and what it printed.
fn outcome(arguments: &[&str]) -> (i32, Output) {
    let output = run(&mut deltarobot(arguments));
    (output.status.code().expect("not killed"), output)
}

/// Asserts the exit status; what it printed.
fn printed(arguments: &[&str], status: i32) -> String {
    let (code, output) = outcome(arguments);
    assert_eq!(code, status, "{arguments:?}:\n{}", text(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// Asserts the exit status; the last line it printed, which is JSON.
fn json(arguments: &[&str], status: i32) -> Value {
    let printed = printed(arguments, status);
    serde_json::from_str(printed.lines().last().unwrap()).unwrap()
}

/// Asserts that it complains on one line, which has this in it.
fn complains(arguments: &[&str], status: i32, about: &str) {
    let (code, output) = outcome(arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!((code, said.lines().count()), (status, 1), "{arguments:?}: {said}");
    assert!(said.starts_with("deltarobot: ") && said.contains(about), "{arguments:?}: {said}");
}

/// A program that runs beside the others, and is ended with its last user.
struct Running {
    child: Child,
    /// The device that it made.
    device: String,
}

impl Running {
    /// Starts what prints its device first.
    fn start(arguments: &[&str]) -> Self {
        let mut child = deltarobot(arguments).stdout(Stdio::piped()).spawn().unwrap();
        let mut device = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut device).unwrap();
        assert!(!device.is_empty(), "{arguments:?} made no device");
        Self { child, device: device.trim().to_owned() }
    }

    fn sim(arguments: &[&str]) -> Self {
        Self::start(&[&["sim"], arguments].concat())
    }

    /// Ends it as Ctrl-C does; its exit status.
    fn interrupt(&mut self) -> Option<i32> {
        interrupt(&self.child);
        self.child.wait().unwrap().code()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn interrupt(child: &Child) {
    signal(child, "INT");
}

fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").args([&format!("-{name}"), &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}

/// Where arms arrive after ten minutes at the speed of a simulator that is [`homed`].
const FAR: &str = "120000";

/// A simulator whose robot knows where it is.
fn homed() -> Running {
    let sim = Running::sim(&["--speed", "200"]);
    printed(&["home", &sim.device], FINISHED);
    sim
}

/// A path that nothing is at.
fn fresh(name: &str) -> PathBuf {
    let path = out_dir().join(name);
    let _ = fs::remove_file(&path);
    path
}

mod requests {
    use super::*;

    fn follow_a_session(layout: &str) {
        let sim = Running::sim(&["--layout", layout, "--speed", "200"]);
        let port = sim.device.as_str();

        let status = json(&["status", port, "--json"], FINISHED);
        assert_eq!((&status["outcome"], &status["status"]["position"]), (&"finished".into(), &Value::Null));
        assert_eq!(json(&["move", "1", "2", "3", port, "--json"], NOT_DONE)["outcome"], "refused");
        let homed = json(&["home", port, "--json"], FINISHED);
        assert_eq!(
            homed["status"],
            serde_json::json!({ "state": "IDLE", "position": [0.0, 0.0, 0.0], "stops": ["A", "B", "C"] })
        );
        let moved = json(&["move", "20.1", "10", "5.5", "--port", port, "--json", "--layout", layout], FINISHED);
        assert_eq!(moved["status"], serde_json::json!({ "state": "IDLE", "position": [20.1, 10.0, 5.5], "stops": [] }));
        assert_eq!(moved["link"]["garbage_bytes"], 0);
        let plain = printed(&["status", port], FINISHED);
        assert_eq!(plain, "IDLE  DA=20.1  DB=10  DC=5.5\n");
        let failed = json(&["move", "-5", "10", "5", port, "--json"], NOT_DONE);
        if layout == "spec" {
            assert_eq!((&failed["outcome"], &failed["status"]["state"]), (&"failed".into(), &"ERROR".into()));
            assert_eq!(json(&["home", port, "--json"], NOT_DONE)["outcome"], "refused");
        } else {
            let status = &failed["status"];
            assert_eq!((&failed["outcome"], &status["state"]), (&"failed".into(), &"IDLE".into()));
            assert_eq!(status["stops"], serde_json::json!(["A"]));
            assert_eq!(json(&["home", port, "--json"], FINISHED)["outcome"], "finished");
        }
    }

    #[test]
    fn to_a_controller_like_shipped_firmware() {
        follow_a_session("firmware");
    }

    #[test]
    fn to_a_controller_like_the_specification() {
        follow_a_session("spec");
    }

    #[test]
    fn an_operation_goes_on_without_us_and_is_cancelled() {
        let sim = homed();
        let port = sim.device.as_str();
        assert_eq!(printed(&["move", FAR, FAR, FAR, port, "--no-wait"], FINISHED), "move: accepted\n");
        assert!(printed(&["status", port], FINISHED).starts_with("MOVING  "));
        let cancelled = json(&["cancel", port, "--json"], FINISHED);
        assert_eq!(cancelled["status"]["state"], "IDLE");
        assert!(printed(&["status", port], FINISHED).starts_with("IDLE  "));
    }

    #[test]
    fn an_interrupted_move_is_cancelled() {
        let sim = homed();
        let mut moving = deltarobot(&["move", FAR, FAR, FAR, &sim.device]).stdout(Stdio::piped()).spawn().unwrap();
        let mut said = String::new();
        BufReader::new(moving.stdout.take().unwrap()).read_line(&mut said).unwrap();
        assert!(said.starts_with("MOVING  "), "{said}");
        interrupt(&moving);
        assert_eq!(moving.wait().unwrap().code(), Some(CANCELLED));
        assert!(printed(&["status", &sim.device], FINISHED).starts_with("IDLE  "));
    }

    #[test]
    fn the_port_may_come_from_the_environment() {
        let sim = Running::sim(&[]);
        let output = run(deltarobot(&["status"]).env("DELTAROBOT_PORT", &sim.device));
        assert_eq!(output.status.code(), Some(FINISHED), "{}", text(&output));
    }

    #[test]
    fn a_port_on_the_command_line_comes_before_that() {
        let sim = Running::sim(&[]);
        let elsewhere = |arguments: &[&str]| run(deltarobot(arguments).env("DELTAROBOT_PORT", "/nonexistent/tty"));
        assert_eq!(elsewhere(&["status"]).status.code(), Some(DEVICE));
        for arguments in [&["status", &sim.device] as &[&str], &["status", "-p", &sim.device]] {
            let output = elsewhere(arguments);
            assert_eq!(output.status.code(), Some(FINISHED), "{arguments:?}: {}", text(&output));
        }
        let output = run(deltarobot(&["status"]).env("DELTAROBOT_PORT", ""));
        assert_eq!(output.status.code(), Some(USAGE), "{}", text(&output));
    }
}

mod faults {
    use super::*;

    #[test]
    fn lost_and_damaged_bytes_are_made_up_for() {
        let sim = Running::sim(&["--lose", "0.01", "--flip", "0.005", "--seed", "7", "--speed", "200"]);
        let homed = json(&["home", &sim.device, "--json"], FINISHED);
        assert_eq!(homed["status"]["position"], serde_json::json!([0.0, 0.0, 0.0]));
        let moved = json(&["move", "30", "40", "50", &sim.device, "--json"], FINISHED);
        assert_eq!(moved["status"]["position"], serde_json::json!([30.0, 40.0, 50.0]));
    }

    #[test]
    fn without_acks_the_reports_tell() {
        let sim = Running::sim(&["--no-ack"]);
        let homed = json(&["home", &sim.device, "--json"], FINISHED);
        assert!(homed["link"]["timeouts"].as_u64().unwrap() > 0, "{homed}");
    }

    #[test]
    fn a_dead_line_times_out() {
        let sim = Running::sim(&["--lose", "1"]);
        for request in ["home", "status", "cancel"] {
            assert_eq!(json(&[request, &sim.device, "--json"], TIMED_OUT)["outcome"], "timed_out");
        }
    }

    #[test]
    fn a_device_that_disappears_is_named() {
        let mut sim = Running::sim(&["--disconnect-after", "0.1"]);
        let about = format!("{}: disconnected", sim.device);
        complains(&["home", &sim.device], DEVICE, &about);
        assert_eq!(sim.child.wait().unwrap().code(), Some(FINISHED));
    }
}

mod devices {
    use super::*;

    #[test]
    fn a_link_is_made_and_removed_again() {
        let link = fresh("cli-link");
        let mut sim = Running::sim(&["--link", utf8(&link)]);
        assert_eq!(sim.device, utf8(&link));
        printed(&["status", utf8(&link)], FINISHED);
        assert_eq!(sim.interrupt(), Some(FINISHED));
        assert!(fs::symlink_metadata(&link).is_err());

        let mut killed = Running::sim(&["--link", utf8(&link)]);
        killed.child.kill().unwrap();
        killed.child.wait().unwrap();
        drop(Running::sim(&["--link", utf8(&link)]));

        let _ = fs::remove_file(&link);
        fs::write(&link, "mine").unwrap();
        complains(&["sim", "--link", utf8(&link)], DEVICE, "cli-link: File exists");
        assert_eq!(fs::read(&link).unwrap(), b"mine");
    }

    #[test]
    fn a_device_is_not_shared() {
        let sim = homed();
        let mut moving = deltarobot(&["move", FAR, FAR, FAR, &sim.device]).stdout(Stdio::piped()).spawn().unwrap();
        let mut said = String::new();
        BufReader::new(moving.stdout.take().unwrap()).read_line(&mut said).unwrap();
        complains(&["status", &sim.device], DEVICE, "in use by another program");
        moving.kill().unwrap();
        moving.wait().unwrap();
    }

    #[test]
    fn what_is_missing_or_none_is_named() {
        for command in [&["status"] as &[&str], &["home"], &["move", "1", "2", "3"], &["cancel"], &["monitor"]] {
            complains(
                &[command, &["/nonexistent/tty"]].concat(),
                DEVICE,
                "/nonexistent/tty: No such file or directory",
            );
            complains(&[command, &["/dev/null"]].concat(), DEVICE, "/dev/null: not a serial port");
        }
        complains(&["record", "/dev/null", "-"], DEVICE, "/dev/null: not a serial port");
        complains(&["replay", "/nonexistent/file", "-"], DEVICE, "/nonexistent/file: No such file");
        complains(&["replay", "/dev/null", "-"], DEVICE, "not a recording");
        complains(&["monitor", "/"], DEVICE, "a directory");
    }

    #[test]
    fn wrong_usage_is_told_on_one_line() {
        let cases: [(&[&str], &str); 18] = [
            (&[], "a subcommand is needed"),
            (&["jump"], "unrecognized subcommand 'jump'"),
            (&["home"], "<PORT>"),
            (&["move", "1", "2", "/dev/ttyS0"], "'<C>'"),
            (&["move", "1", "nan", "3", "/dev/ttyS0"], "finite"),
            (&["status", "/dev/ttyS0", "--port", "/dev/ttyS1"], "cannot be used with"),
            (&["status", "/dev/ttyS0", "--baud", "fast"], "'fast'"),
            (&["sim", "--lose", "2"], "not a probability"),
            (&["decode"], "<BYTES>"),
            (&["decode", ""], "no bytes to decode"),
            (&["decode", "--protocol", "line", " "], "no bytes to decode"),
            (&["decode", "24 5"], "odd number"),
            (&["decode", "--text", "24"], "--text: frames of --protocol deltarobot are no text"),
            (&["monitor", "-", "--protocol", "modbus"], "'modbus'"),
            (&["sim", "--protocol", "line", "--layout", "spec"], "--layout is for --protocol deltarobot only"),
            (&["sim", "--protocol", "gx", "--no-ack"], "--no-ack is for --protocol deltarobot only"),
            (&["sim", "--checksum"], "--checksum is for --protocol line only"),
            (&["sim", "--protocol", "line", "--travel", "9"], "--travel is for --protocol gx only"),
        ];
        for (arguments, about) in cases {
            complains(arguments, USAGE, about);
        }
        assert!(printed(&["--help"], FINISHED).contains("Exit status:"));
        assert_eq!(printed(&["--version"], FINISHED), concat!("deltarobot ", env!("CARGO_PKG_VERSION"), "\n"));
    }
}

mod decode {
    use super::*;

    #[test]
    fn frames_in_words() {
        for (hex, words) in [
            ("24 48 00 A6 3A", "HOMING!"),
            ("24 53 00 B1 3A", "STATUS?"),
            ("24 43 00 A1 3A", "CANCEL!"),
            ("24 68 00 C6 3A", "HOMING_REPLY"),
            ("24 6D 00 CB 3A", "MOVE_REPLY"),
            ("24 65 00 C3 3A", "GENERAL_ERROR"),
            ("24 41 01 48 E8 3A", "ACK: (HOMING!)"),
            ("24 4E 01 4D FA 3A", "NACK"),
            ("24 4D 0C 00 00 80 3F 00 00 00 40 00 00 60 C0 D6 3A", "MOVE!:  DA=1  DB=2  DC=-3.5"),
        ] {
            assert_eq!(printed(&["decode", hex], FINISHED), format!("{words}\n"));
            let words: Vec<_> = hex.split(' ').collect();
            let value = json(&[&["decode", "--json"], words.as_slice()].concat(), FINISHED);
            assert_eq!(value["bytes"], hex);
        }
        let value = json(&["decode", "--json", "244d0c0000803f00000040000060c0d63a"], FINISHED);
        assert_eq!((&value["opcode"], &value["target"]), (&"MOVE!".into(), &serde_json::json!([1.0, 2.0, -3.5])));
        assert_eq!(json(&["decode", "--json", "24 41 01 48 E8 3A"], FINISHED)["answers"], "HOMING!");
    }

    #[test]
    fn garbage_is_shown() {
        let said = printed(&["decode", "FF 24 53 00 B1 3A 24 53 00 B2 3A 24 4D"], NOT_DONE);
        assert_eq!(said, "garbage: FF\nSTATUS?\ngarbage: 24 53 00 B2 3A 24 4D (checksum B2 instead of B1)\n");
    }
}

/// The demonstration: the simulator and a host program in C have to be content with each other, whichever controller is
/// simulated.
#[test]
fn the_demonstration() {
    const DEMO: Program = Program::of("demo", &["../examples/demo.c"]);
    const HOST: Program = Program::of("demo_host", &["../examples/deltarobot/host.c"]);
    let library = Library::of(DEFAULT);
    let [demo, host] = [DEMO, HOST].map(|program| build(&program, &library, Mode::Sanitized).expect("always built"));
    for layout in ["firmware", "spec"] {
        let sim = [program().as_os_str(), "sim".as_ref(), "--layout".as_ref(), layout.as_ref()].map(OsStr::to_owned);
        let output = run(command(&demo, &library, Mode::Sanitized).arg(&host).args(sim));
        assert!(output.status.success(), "{layout}: {}", text(&output));
    }
}
