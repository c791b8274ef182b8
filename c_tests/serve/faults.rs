//! What goes wrong in the field, many times in a row: `make faults` has DP_ROUNDS of each.

use std::net::TcpStream;

use serde_json::json;

use super::driving::{far, slow};
use super::robot::{CANCEL, Robot};
use super::{Server, found};

fn rounds() -> usize {
    std::env::var("DP_ROUNDS").map_or(2, |rounds| rounds.parse().expect("a number"))
}

#[test]
fn port_gone_and_back() {
    let (mut robot, server) = slow();
    for round in 1..=rounds() {
        let mut driver = server.watch("/api/robots/lab/events");
        let word = driver.lease();
        assert_eq!(server.drive("/api/robots/lab/move", &word, &far()).0, 202);
        driver.event_when("state", |event| event["state"] == "moving");
        let controller = robot.unplug();
        driver.event_when("state", |event| event["link"] == "lost" && event["state"] == "unknown");
        robot.plug(controller);
        driver.event_when("state", |event| event["link"] == "up" && event["state"] == "idle");
        assert!(robot.count(CANCEL) >= round);
    }
}

#[test]
fn driver_killed_in_mid_move() {
    let (robot, server) = slow();
    for round in 1..=rounds() {
        let mut driver = server.watch("/api/robots/lab/events");
        let word = driver.lease();
        assert_eq!(server.drive("/api/robots/lab/move", &word, &far()).0, 202);
        driver.event_when("state", |event| event["state"] == "moving");
        // As the system does for a program that is killed: the connection is gone without a word.
        drop(driver);
        server.state_when("lab", |state| state["state"] == "idle" && state["operation"]["outcome"] == "cancelled");
        assert!(robot.count(CANCEL) >= round);
    }
}

#[test]
fn program_killed_and_started_again() {
    let robot = Robot::new(50.0);
    let moves = || robot.count(b"$M\x0C");
    for round in 1..=rounds() {
        let server = Server::start(&[&robot.named("lab")]);
        let state = server.state_when("lab", |state| state["link"] == "up" && state["stale"] == false);
        // What the robot does was begun by nobody that is known here; nothing of the last time is done again.
        assert!(state["operation"].is_null() && state["driver"].is_null() && moves() == round - 1, "{state}");
        assert_eq!(server.post("/api/robots/lab/cancel", &json!({})).0, 200);
        server.home("lab");
        let mut driver = server.watch("/api/robots/lab/events");
        let word = driver.lease();
        assert_eq!(server.drive("/api/robots/lab/move", &word, &far()).0, 202);
        driver.event_when("state", |event| event["state"] == "moving");
        server.signal(rustix::process::Signal::KILL);
    }
}

#[test]
fn a_thousand_connections_opened_and_dropped() {
    let (robot, server) = slow();
    let mut driver = server.watch("/api/robots/lab/events");
    let word = driver.lease();
    assert_eq!(server.drive("/api/robots/lab/move", &word, &far()).0, 202);
    for _ in 0..rounds() {
        // Some of them say half of what they want.
        let halves = (0..1000).map(|number| match number % 10 {
            0 => server.send("POST", "/api/robots/lab/home", &[], b""),
            1 => server.send("POST", "/api/robots/lab/lease", &[("Content-Length", "9")], b"{"),
            _ => TcpStream::connect(server.address).unwrap(),
        });
        for half in halves.collect::<Vec<_>>() {
            drop(half);
        }
        // Who drives reads what comes, else the server takes the connection for a dead one.
        assert_eq!(driver.lease(), word);
        assert_eq!(server.get("/api/robots/lab")["driver"]["client"], "test");
    }
    assert_eq!(robot.count(CANCEL), 0, "the move goes on, or has ended by itself");
    // Of all of them nothing is left but who drives.
    let files = || std::fs::read_dir(format!("/proc/{}/fd", server.child.id())).map_or(0, Iterator::count);
    found("files closed", || (files() < 100).then_some(()));
}
