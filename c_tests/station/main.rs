//! The station in a real browser: builds nothing itself, and runs the tests of this directory against the program.

#![allow(
    clippy::arithmetic_side_effects,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that can't go on fails"
)]

#[allow(dead_code, reason = "the tests of the library use the rest")]
#[path = "../common/support.rs"]
mod support;

use std::path::Path;
use std::process::Command;

use crate::support::{c_tests, has_tool, is_missing};

/// Node.js with the packages of the lock file (`npm ci` in this directory), and a Chromium.
fn has_browser() -> bool {
    let packages = c_tests().join("station/node_modules");
    has_tool("node", "--version")
        && has_tool("chromium", "--version")
        && (packages.is_dir() || is_missing("what `npm ci` installs in c_tests/station"))
}

fn node(arguments: &[&str]) {
    let output = Command::new("node")
        .args(arguments)
        .current_dir(c_tests().join("station"))
        .env("DELTAROBOT_SERVE", env!("CARGO_BIN_EXE_deltarobot-serve"))
        .env("DELTAROBOT_UI", env!("CARGO_BIN_EXE_deltarobot-ui"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{arguments:?}:\n{}", support::text(&output));
}

#[test]
fn the_types_are_right() {
    if has_browser() {
        node(&["node_modules/typescript/bin/tsc", "-p", "."]);
    }
}

#[test]
fn the_page_does_what_it_should() {
    if has_browser() {
        // One file after the other: each starts a browser that draws without a graphics card.
        node(&["--test", "--test-concurrency=1", "--test-reporter=spec"]);
    }
}

#[test]
fn copied_libraries_are_those_of_the_lock_file_and_small() {
    if !has_browser() {
        return;
    }
    let made = Path::new(env!("CARGO_TARGET_TMPDIR")).join("vendor");
    std::fs::create_dir_all(&made).unwrap();
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("station/vendor");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("station/vendor.sh");
    let output = Command::new(script).arg(&made).output().unwrap();
    assert!(output.status.success(), "{}", support::text(&output));
    for entry in made.read_dir().unwrap() {
        let name = entry.unwrap().file_name();
        let [new, old] = [&made, &kept].map(|directory| std::fs::read(directory.join(&name)).unwrap());
        assert!(new == old, "{name:?} differs: run crates/serve/station/vendor.sh");
    }
}
