//! Events.

use deltarobot_cli::far_end::Place;
use deltarobot_protocols::deltarobot::{Layout, Message, PAYLOAD_MAX, Position, Report, encode};
use serde_json::json;

use super::robot::Robot;
use super::{Server, found};

#[test]
fn who_watches_sees_all_in_its_order() {
    let robot = Robot::new(50.0);
    let server = Server::start(&[&robot.named("lab"), "--sim", "1"]);
    server.state_when("lab", |state| state["state"] == "idle");
    let (mut all, mut one) = (server.watch("/api/events"), server.watch("/api/robots/lab/events?messages=true"));
    assert_eq!((all.event()["robot"].clone(), all.event()["robot"].clone()), (json!("lab"), json!("sim1")));
    server.home("lab");
    let (mut last, mut is_heard) = (0, false);
    loop {
        let event = one.event();
        match event["type"].as_str().unwrap() {
            "state" => {
                assert_eq!(
                    event["seq"].as_u64().unwrap(),
                    if last == 0 { event["seq"].as_u64().unwrap() } else { last + 1 }
                );
                last = event["seq"].as_u64().unwrap();
            }
            "message" if event["json"]["opcode"] == "HOMING!" => {
                assert_eq!((&event["from"], &event["bytes"]), (&json!("host"), &json!("24 48 00 A6 3A")));
                is_heard = true;
            }
            "ended" => break assert_eq!(event["operation"]["outcome"], "finished"),
            _ => (),
        }
    }
    assert!(is_heard);
    one.event_when("message", |event| event["from"] == "controller" && event["json"]["opcode"] == "STATUS_REPLY");
    assert_eq!(all.event_when("ended", |event| event["robot"] == "lab")["operation"]["kind"], "home");
}

#[test]
fn a_slow_watcher_loses_the_oldest_and_is_told_how_many() {
    // A robot that reports as fast as it can.
    let mut line = Place::default().make(None).unwrap();
    let server = Server::start(&[&format!("lab={}", line.path().display())]);
    server.state_when("lab", |state| state["link"] == "up");
    let (mut payload, mut frame) = ([0; PAYLOAD_MAX], [0; 64]);
    let report = Message::StatusReport(Report::new(Position([0; 3]), 0));
    let length = report.write(Layout::Firmware, &mut payload);
    let length = encode(report.opcode(), &payload[..length], &mut frame).unwrap();
    let seq = || server.get("/api/robots/lab")["seq"].as_u64().unwrap();

    let mut slow = server.watch("/api/robots/lab/events");
    let first = slow.event()["seq"].as_u64().unwrap();
    // More states than the system and the program keep for one that does not read.
    found("enough states", || {
        (0..100).for_each(|_| line.write(&frame[..length]).unwrap());
        (seq() > first + 10_000).then_some(())
    });
    let (mut seen, mut dropped) = (0, 0);
    loop {
        let event = slow.event();
        if event["type"] == "dropped" {
            dropped += event["count"].as_u64().unwrap();
            continue;
        }
        seen += 1;
        // What is not seen was told of, and after that the newest are seen.
        assert_eq!(event["seq"].as_u64().unwrap(), first + seen + dropped);
        if dropped > 0 && seen + dropped > 10_000 {
            break;
        }
    }
}
