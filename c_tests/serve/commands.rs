//! Homing, moving, cancelling, and what can be wrong about it.

use serde_json::{Value, json};

use super::Server;
use super::robot::{CANCEL, HOME, Robot};

const GEOMETRY: &str = r#"{ "joints": [[-100, 0, 0], [0, 150, 0], [100, 0, 0]], "edge": 80, "offset": 30,
    "arms": [{ "offset": 200 }, { "offset": 200, "scale": 1 }, { "offset": 200, "scale": 1.0 }] }"#;

#[test]
fn a_robot_homes_moves_and_is_cancelled() {
    let robot = Robot::new(50.0);
    let server = Server::start(&[&robot.named("lab")]);
    let state = server.state_when("lab", |state| state["state"] == "idle");
    assert_eq!((&state["position_known"], &state["displacements"]), (&json!(false), &Value::Null));
    server.home("lab");
    assert_eq!(robot.count(HOME), 1);
    let (status, operation) = server.post("/api/robots/lab/move", &json!({ "displacements": [10, 7.5, 12.5] }));
    assert_eq!((status, &operation["outcome"]), (200, &json!("finished")));
    assert_eq!(server.get("/api/robots/lab")["displacements"], json!([10.0, 7.5, 12.5]));
    let nudge = json!({ "displacements": [0, -2.5, 0], "relative": true });
    assert_eq!(server.post("/api/robots/lab/move", &nudge).1["target"], json!([10.0, 5.0, 12.5]));
    assert_eq!(server.post("/api/robots/lab/cancel", &json!({})).1, json!({ "outcome": "finished" }));
    assert_eq!(robot.count(CANCEL), 1);
    assert_eq!(server.get("/api/robots")["robots"].as_array().unwrap().len(), 1);
}

#[test]
fn what_can_t_be_done_is_said() {
    let robot = Robot::new(1.0);
    let server = Server::start(&[&robot.named("lab"), "nothing=/dev/no-such-device"]);
    server.state_when("lab", |state| state["state"] == "idle");
    let json = [("Content-Type", "application/json")];
    for (method, path, body, status, said) in [
        ("POST", "/api/robots/lab/move", r#"{"displacements":[1,2]}"#, 400, "length 3"),
        ("POST", "/api/robots/lab/move", r#"{"displacements":[1,2,3],"position":[1,2,3]}"#, 400, "either"),
        ("POST", "/api/robots/lab/move", r#"{"displacement":[1,2,3]}"#, 400, "unknown field"),
        ("POST", "/api/robots/lab/move", r#"{"displacements":[1,2,1e300]}"#, 422, "finite"),
        ("POST", "/api/robots/lab/move", r#"{"displacements":[1,2,3],"relative":true}"#, 422, "not known"),
        ("POST", "/api/robots/lab/move", r#"{"position":[1,2,3]}"#, 422, "geometry"),
        ("POST", "/api/robots/lab/move", "{", 400, "EOF"),
        ("POST", "/api/robots/lab/home", r#"{"wait":false}"#, 409, "lease"),
        ("POST", "/api/robots/other/home", "", 404, "other"),
        ("POST", "/api/robots/%FF/home", "", 400, "UTF-8"),
        ("POST", "/api/robots/nothing/home", "", 503, "No such file"),
        ("POST", "/api/robots/nothing/cancel", "", 503, "No such file"),
        ("POST", "/api/robots/lab/lease", r#"{"seconds":0}"#, 400, "1 to 60"),
        ("POST", "/api/robots/lab/lease", r#"{"client":"a\nb"}"#, 400, "one line"),
        ("DELETE", "/api/robots/lab/lease", "", 409, "Deltarobot-Lease"),
        ("PUT", "/api/robots/lab/geometry", r#"{"joints":[[0,0,0],[0,0,0],[0,0,0]],"edge":1,"offset":1}"#, 400, "A1"),
        ("DELETE", "/api/robots/lab", "", 405, "openapi"),
        ("GET", "/api/robot", "", 404, "openapi"),
        ("GET", "/api/events", "", 400, "WebSocket"),
    ] {
        let (answered, problem) = server.ask_with(method, path, &json, body.as_bytes());
        let detail = problem["detail"].as_str().unwrap_or_default();
        assert!(answered == status && detail.contains(said), "{method} {path} {body}: {answered} {problem}");
    }
    let long = vec![b' '; 70_000];
    assert_eq!(server.ask_with("POST", "/api/robots/lab/home", &json, &long).0, 413);
    // What a form of a web page could send.
    assert_eq!(server.ask_with("POST", "/api/robots/lab/home", &[("Content-Type", "text/plain")], b"{}").0, 400);
    assert_eq!(robot.count(HOME), 0);
}

#[test]
fn a_robot_that_moves_is_busy_and_one_that_is_refused_says_why() {
    let robot = Robot::new(1.0);
    let server = Server::start(&[&robot.named("lab")]);
    server.state_when("lab", |state| state["state"] == "idle");
    let (status, lease) = server.post("/api/robots/lab/lease", &json!({ "client": "anna", "seconds": 60 }));
    assert_eq!((status, &lease["client"]), (200, &json!("anna")));
    let word = lease["lease"].as_str().unwrap();
    let (status, operation) =
        server.drive("/api/robots/lab/move", word, &json!({ "displacements": [1, 2, 3], "wait": true }));
    assert_eq!((status, &operation["outcome"]), (200, &json!("refused")));
    assert!(operation["reason"].as_str().unwrap().contains("home first"), "{operation}");
    let (status, operation) = server.drive("/api/robots/lab/home", word, &json!({}));
    assert_eq!((status, &operation["by"], &operation["outcome"]), (202, &json!("anna"), &Value::Null));
    assert_eq!(server.drive("/api/robots/lab/home", word, &json!({})).0, 409);
    assert_eq!(server.post("/api/robots/lab/cancel", &json!({})).0, 200);
    let state = server.state_when("lab", |state| !state["operation"]["outcome"].is_null());
    assert_eq!(state["operation"]["outcome"], "cancelled");
}

#[test]
fn poses_by_the_geometry() {
    let robot = Robot::new(500.0);
    let server = Server::start(&[&robot.named("lab")]);
    server.home("lab");
    let geometry: Value = serde_json::from_str(GEOMETRY).unwrap();
    let json = [("Content-Type", "application/json")];
    let (status, state) = server.ask_with("PUT", "/api/robots/lab/geometry", &json, GEOMETRY.as_bytes());
    assert!(status == 200 && state["pose"].is_array(), "{state}");
    let pose = server.state_when("lab", |state| state["pose"].is_array())["pose"].clone();
    let above = json!([pose[0], pose[1], pose[2].as_f64().unwrap() + 10.0]);
    let (status, operation) = server.post("/api/robots/lab/move", &json!({ "position": above }));
    assert_eq!((status, &operation["outcome"]), (200, &json!("finished")), "{operation}");
    let at = server.get("/api/robots/lab")["displacements"].clone();
    let forward =
        server.post("/api/kinematics/forward", &json!({ "geometry": geometry, "displacements": [at, [-1e3, 0, 0]] }));
    let z = |pose: &Value| pose[2].as_f64().unwrap();
    assert!((z(&forward.1["poses"][0]) - z(&above)).abs() < 0.01, "{forward:?}");
    assert_eq!(forward.1["poses"][1], Value::Null);
    let inverse = server.post("/api/kinematics/inverse", &json!({ "geometry": geometry, "poses": [above, pose] }));
    assert!(inverse.1["displacements"][1][0].as_f64().unwrap().abs() < 0.01, "{inverse:?}");
    let (status, state) = server.ask_with("DELETE", "/api/robots/lab/geometry", &[], b"");
    assert_eq!((status, &state["geometry"], &state["pose"]), (200, &Value::Null, &Value::Null));
}

#[test]
fn a_recording_is_decoded() {
    let server = Server::start(&["--sim", "1"]);
    let text = "# deltarobot recording 1\n# started 2026-11-28T20:41:15Z\n0.1 > 24 53 00 B1 3A\n\
        0.2 < 24 73 0D 00 00 00 20 41 00 00 20 41 00 00 20 41 BB 3A\n0.3 < FF FF\n";
    let (status, recording) =
        server.ask_with("POST", "/api/recordings", &[("Content-Type", "text/plain")], text.as_bytes());
    assert_eq!((status, &recording["seconds"]), (200, &json!(0.3)), "{recording}");
    let events = recording["events"].as_array().unwrap();
    let kinds: Vec<_> = events.iter().map(|event| event["type"].as_str().unwrap()).collect();
    assert_eq!(events[0]["bytes"], "24 53 00 B1 3A", "{recording}");
    assert!(kinds.contains(&"message") && events.last().unwrap()["text"].as_str().unwrap().contains("garbage"));
    let (status, problem) = server.ask_with("POST", "/api/recordings", &[], b"1 2 3");
    assert!(status == 422 && problem["detail"].as_str().unwrap().contains("not a recording"), "{problem}");
}
