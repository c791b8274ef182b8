//! The line to a robot: gone and back, silent, and its bytes over TCP.

use std::io::{Read, Write};
use std::net::TcpStream;

use deltarobot_protocols::deltarobot::{Opcode, encode};
use serde_json::json;

use super::driving::{far, slow};
use super::robot::{CANCEL, HOME, Robot};
use super::{Server, TIMEOUT, file, found};

#[test]
fn a_robot_that_says_nothing_is_not_shown_as_if_it_did() {
    let robot = Robot::new(50.0);
    let server = Server::start(&[&robot.named("lab")]);
    server.home("lab");
    robot.mute(true);
    let state = server.state_when("lab", |state| state["stale"] == true);
    assert_eq!(
        (&state["state"], &state["link"], &state["displacements"]),
        (&json!("unknown"), &json!("up"), &json!([0.0, 0.0, 0.0]))
    );
    robot.mute(false);
    server.state_when("lab", |state| state["state"] == "idle" && state["stale"] == false);
}

#[test]
fn bytes_over_tcp_one_drives_and_others_listen() {
    let robot = Robot::new(50.0);
    let config = format!("[robots.lab]\nport = {:?}\nraw = \"127.0.0.1:0\"\n", robot.link);
    let server = Server::start(&["--config", &file("config", &config)]);
    server.home("lab");
    let address = server.said[0].strip_prefix("lab: raw bytes on ").unwrap();
    let connect = || {
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(TIMEOUT)).unwrap();
        stream
    };
    let mut driver = connect();
    server
        .state_when("lab", |state| state["driver"]["client"].as_str().is_some_and(|client| client.starts_with("raw")));
    let mut listener = connect();
    assert_eq!(server.post("/api/robots/lab/home", &json!({})).0, 409);
    // What who listens sends goes nowhere.
    listener.write_all(HOME).unwrap();
    let target: Vec<_> = [900.0_f32; 3].iter().flat_map(|arm| arm.to_le_bytes()).collect();
    let mut frame = [0; 17];
    encode(Opcode::MOVE, &target, &mut frame).unwrap();
    driver.write_all(&frame).unwrap();
    for stream in [&mut driver, &mut listener] {
        let mut heard = Vec::new();
        while !heard.windows(4).any(|window| window == b"$A\x01M") {
            let mut byte = [0];
            stream.read_exact(&mut byte).unwrap();
            heard.push(byte[0]);
        }
    }
    server.state_when("lab", |state| state["state"] == "moving");
    assert_eq!(robot.count(HOME), 1);
    // But everybody may cancel; and when who drives is gone, the robot stands.
    listener.write_all(CANCEL).unwrap();
    server.state_when("lab", |state| state["state"] == "idle");
    driver.write_all(&frame).unwrap();
    server.state_when("lab", |state| state["state"] == "moving");
    drop(driver);
    server.state_when("lab", |state| state["state"] == "idle");
    assert!(robot.count(CANCEL) >= 2);
    // Now the other drives, as soon as it wants to.
    listener.write_all(HOME).unwrap();
    found("homing", || (robot.count(HOME) > 1).then_some(()));
}

#[test]
fn a_port_that_comes_back_is_opened_and_a_robot_that_moved_is_cancelled() {
    let (mut robot, server) = slow();
    let mut watcher = server.watch("/api/robots/lab/events");
    let word = watcher.lease();
    assert_eq!(server.drive("/api/robots/lab/move", &word, &far()).0, 202);
    watcher.event_when("state", |event| event["state"] == "moving");
    let controller = robot.unplug();
    let ended = watcher.event_when("ended", |_| true);
    assert_eq!(ended["operation"]["outcome"], "lost");
    let lost = watcher.event_when("state", |event| event["link"] == "lost");
    assert_eq!((&lost["state"], &lost["stale"]), (&json!("unknown"), &json!(true)));
    assert_eq!(server.post("/api/robots/lab/cancel", &json!({})).0, 503);
    robot.plug(controller);
    watcher.event_when("state", |event| event["state"] == "idle");
    assert!(robot.count(CANCEL) >= 1);
    assert_eq!(server.get("/api/robots/lab")["health"]["reconnects"], 1);
    assert_eq!(server.drive("/api/robots/lab/home", &word, &json!({ "wait": true })).1["outcome"], "finished");
}
