//! Who drives: one at a time, and what happens to a motion when nobody does any more.

use serde_json::{Value, json};

use super::robot::{CANCEL, Robot};
use super::{Server, found};

/// Far away: at a unit a second, nobody has to hurry.
pub(super) fn far() -> Value {
    json!({ "displacements": [900, 900, 900] })
}

/// A robot that takes its time, but knows where it is.
pub(super) fn slow() -> (Robot, Server) {
    let robot = Robot::new(50.0);
    let server = Server::start(&[&robot.named("lab")]);
    server.home("lab");
    (robot, server)
}

#[test]
fn one_drives_at_a_time_and_force_takes_over() {
    let (robot, server) = slow();
    let (mut anna, mut bert) = (server.watch("/api/robots/lab/events"), server.watch("/api/events"));
    let word = anna.lease();
    assert_eq!(server.drive("/api/robots/lab/move", &word, &far()).0, 202);
    bert.say(&json!({ "type": "lease", "robot": "lab", "client": "bert" }));
    let refused = bert.event_when("refused", |_| true);
    assert!(refused["problem"]["detail"].as_str().unwrap().contains("test drives"), "{refused}");
    assert_eq!(server.post("/api/robots/lab/home", &json!({})).0, 409);
    bert.say(&json!({ "type": "lease", "robot": "lab", "client": "bert", "force": true }));
    let taken = bert.event_when("lease", |_| true)["lease"].as_str().unwrap().to_owned();
    assert_eq!(anna.event_when("driver", |event| event["driver"]["client"] == "bert")["driver"]["until"], Value::Null);
    // Who drove does not any more, and does no harm by going.
    assert_eq!(server.drive("/api/robots/lab/move", &word, &far()).0, 409);
    drop(anna);
    assert_eq!(server.drive("/api/robots/lab/move", &taken, &far()).0, 409);
    server.state_when("lab", |state| state["state"] == "moving");
    assert_eq!(robot.count(CANCEL), 0);
    // Cancelling is open to everybody.
    assert_eq!(server.post("/api/robots/lab/cancel", &json!({})).0, 200);
    server.state_when("lab", |state| state["state"] == "idle" && state["operation"]["outcome"] == "cancelled");
    bert.say(&json!({ "type": "release", "robot": "lab" }));
    assert_eq!(bert.event_when("released", |_| true)["robot"], "lab");
    server.state_when("lab", |state| state["driver"].is_null());
}

#[test]
fn a_motion_ends_with_its_driver() {
    let (robot, server) = slow();
    let mut driver = server.watch("/api/robots/lab/events");
    let word = driver.lease();
    assert_eq!(server.drive("/api/robots/lab/move", &word, &far()).0, 202);
    server.state_when("lab", |state| state["state"] == "moving");
    drop(driver);
    let state = server.state_when("lab", |state| state["operation"]["outcome"] == "cancelled");
    assert!(robot.count(CANCEL) >= 1 && state["driver"].is_null(), "{state}");

    // Who waits for the end and hangs up; and who does not renew a lease.
    let waiting = server.send(
        "POST",
        "/api/robots/lab/move",
        &[("Content-Type", "application/json")],
        far().to_string().as_bytes(),
    );
    server.state_when("lab", |state| state["state"] == "moving");
    drop(waiting);
    server.state_when("lab", |state| state["operation"]["id"] == 3 && state["operation"]["outcome"] == "cancelled");
    let lease = server.post("/api/robots/lab/lease", &json!({ "seconds": 1 })).1;
    assert_eq!(server.drive("/api/robots/lab/move", lease["lease"].as_str().unwrap(), &far()).0, 202);
    server.state_when("lab", |state| state["operation"]["id"] == 4 && state["operation"]["outcome"] == "cancelled");
    assert!(robot.count(CANCEL) >= 3);
}

#[test]
fn a_motion_goes_on_without_its_driver_where_that_is_wanted() {
    let robot = Robot::new(50.0);
    let server = Server::start(&["--keep-moving", &robot.named("lab")]);
    server.home("lab");
    let mut driver = server.watch("/api/robots/lab/events");
    let word = driver.lease();
    let near = json!({ "displacements": [25, 25, 25] });
    assert_eq!(server.drive("/api/robots/lab/move", &word, &near).0, 202);
    drop(driver);
    let state = server.state_when("lab", |state| !state["operation"]["outcome"].is_null());
    assert_eq!((&state["operation"]["outcome"], robot.count(CANCEL)), (&json!("finished"), 0));
}

#[test]
fn a_lease_is_renewed_and_given_back() {
    let (_robot, server) = slow();
    let lease = server.post("/api/robots/lab/lease", &json!({ "client": "anna", "seconds": 60 })).1;
    let word = lease["lease"].as_str().unwrap();
    let (status, renewed) = server.drive("/api/robots/lab/lease", word, &json!({ "client": "anna", "seconds": 30 }));
    assert_eq!((status, &renewed["lease"]), (200, &lease["lease"]));
    assert_ne!(renewed["until"], lease["until"]);
    assert_eq!(server.post("/api/robots/lab/lease", &json!({})).0, 409);
    let other = [("Deltarobot-Lease", "0123")];
    assert_eq!(server.ask_with("DELETE", "/api/robots/lab/lease", &other, b"").0, 409);
    assert_eq!(server.ask_with("DELETE", "/api/robots/lab/lease", &[("Deltarobot-Lease", word)], b"").0, 204);
    found("nobody drives", || server.get("/api/robots/lab")["driver"].is_null().then_some(()));
}
