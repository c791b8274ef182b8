//! Faults, each as often as DP_ROUNDS says.

use super::broker::{Broker, Listener, asked};
use super::records::{files, settings, table};
use super::*;

/// A broker that was killed gets the states again, a motion that it could not cancel any more is cancelled, and no
/// command is carried out twice or late.
#[test]
fn broker_killed_and_back() {
    let Some(mut broker) = Broker::start() else { return };
    let server = Server::start(&broker.settings("commands = true"));
    let is_up = || server.metric("deltarobot_mqtt_up") > 0;
    for round in 0..rounds() {
        found("it is connected", || is_up().then_some(()));
        let listener = Listener::new(broker.port, &["deltarobot/#", "answers"]);
        listener.hear_on("deltarobot/sim1/state", |json| json["link"] == "up" && json["state"] == "idle");
        assert_eq!(listener.ask("home", "", Some(60))["outcome"], "finished");
        let far = "{\"displacements\":[12000,12000,12000]}";
        let word = format!("far-{round}");
        listener.say("deltarobot/sim1/command/move", far, false, asked(&word, Some(600)));
        let moving = listener.hear_on("deltarobot/sim1/state", |json| json["state"] == "moving");
        broker.kill();
        let operation = moving["operation"]["id"].as_u64().unwrap();
        let state = || -> serde_json::Value { serde_json::from_str(&server.get("/api/robots/sim1")).unwrap() };
        found("it is cancelled", || {
            let state = state();
            assert_eq!(state["operation"]["id"].as_u64(), Some(operation), "nothing else was begun: {state}");
            (state["operation"]["outcome"] == "cancelled" && state["state"] == "idle").then_some(())
        });
        // What a sender that does not know of this sends now never gets through: its broker is not there.
        broker.again();
        found("it is connected again", || is_up().then_some(()));
        let listener = Listener::new(broker.port, &["deltarobot/#"]);
        let state = listener.hear_on("deltarobot/sim1/state", |json| json["state"] == "idle");
        assert_eq!(state["operation"]["id"].as_u64(), Some(operation), "nothing was begun late: {state}");
        let status = Listener::new(broker.port, &["deltarobot/status"]);
        status.hear_on("deltarobot/status", |json| json["status"] == "online");
    }
    assert_eq!(server.end(), Some(0));
}

#[test]
fn killed_while_recording() {
    for _ in 0..rounds() {
        let directory = empty("killed");
        let server = Server::start(&settings(&directory, ""));
        found("a chunk is there", || (server.metric("deltarobot_record_bytes_total") > 1000).then_some(()));
        server.signal("KILL");
        drop(server);
        let (table, complaint) = table(&files(&directory)[0]);
        assert!(complaint.contains("was not ended") && table.contains(",sim1,"), "{complaint}{table}");
        fs::remove_dir_all(directory).unwrap();
    }
}

/// A limit on the size of files stands for a disk that is full, and one that is raised for room again.
#[test]
fn disk_full_and_room_again() {
    if !support::has_tool("prlimit", "--version") {
        return;
    }
    for _ in 0..rounds() {
        let directory = empty("full");
        let mut command = Command::new("sh");
        command.args(["-c", "ulimit -S -f 32; exec \"$@\"", "sh", env!("CARGO_BIN_EXE_deltarobot-serve")]);
        let server = Server::start_by(command, &settings(&directory, ""));
        found("it is full", || (server.metric("deltarobot_record_up") < 1).then_some(()));
        assert!(server.said().contains("records: File too large"), "{}", server.said());
        // Another file is begun from time to time, which is full as well.
        let says = |word: &str| server.get("/api/robots/sim1").contains(word);
        found("the state says it", || says("File too large").then_some(()));
        // Everything else goes on.
        let frames = || server.metric("deltarobot_frames_total{robot=\"sim1\"}");
        let before = frames();
        found("the robot is heard", || (frames() > before).then_some(()));
        let id = server.child.id().to_string();
        let status = Command::new("prlimit").args(["--pid", &id, "--fsize=unlimited:"]).status().unwrap();
        assert!(status.success());
        found("it goes on", || (server.metric("deltarobot_record_up") > 0).then_some(()));
        assert!(server.metric("deltarobot_record_lost_total") > 0);
        found("the state does not say it any more", || (!says("File too large")).then_some(()));
        assert_eq!(server.end(), Some(0));
        let files = files(&directory);
        assert!(files.len() >= 2, "{files:?}");
        for file in &files {
            assert!(table(file).0.contains(",sim1,"), "{}", file.display());
        }
        assert_eq!(table(files.last().unwrap()).1, "");
        fs::remove_dir_all(directory).unwrap();
    }
}
