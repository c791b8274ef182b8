//! Faults, each as often as DP_ROUNDS says.

use super::broker::{Broker, Listener, asked};
use super::records::{files, settings, table};
use super::*;
use crate::support::run;
use chrono::{SecondsFormat, TimeDelta, Utc};

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
        until("it says so", || server.said().contains("records: File too large"));
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

/// How a program is started whose clock is what a file says, if there is Debian's faketime: the clock that only goes on
/// is left alone, as the system does.
fn with_clock(file: &Path) -> Option<Command> {
    if !support::has_tool("faketime", "--version") {
        return None;
    }
    let library = run(Command::new("faketime").args(["-m", "now", "printenv", "LD_PRELOAD"]));
    let mut command = Command::new(env!("CARGO_BIN_EXE_deltarobot-serve"));
    command
        .env("LD_PRELOAD", String::from_utf8(library.stdout).unwrap().trim())
        .env("FAKETIME_TIMESTAMP_FILE", file)
        .envs([("FAKETIME_NO_CACHE", "1"), ("FAKETIME_DONT_FAKE_MONOTONIC", "1"), ("DONT_FAKE_MONOTONIC", "1")]);
    Some(command)
}

/// The times that are shown are others, and nothing else.
#[test]
fn clock_set_back() {
    for _ in 0..rounds() {
        // One that holds no states of the round before.
        let Some(broker) = Broker::start() else { return };
        let (directory, clock) = (empty("clock"), empty("time").join("clock"));
        let set = |offset: &str| {
            let new = clock.with_extension("new");
            fs::write(&new, offset).unwrap();
            fs::rename(new, &clock).unwrap();
        };
        set("+0");
        let Some(command) = with_clock(&clock) else { return };
        let server =
            Server::start_by(command, &format!("{}{}", broker.settings("commands = true"), settings(&directory, "")));
        let listener = Listener::new(broker.port, &["deltarobot/#", "answers"]);
        listener.hear_on("deltarobot/sim1/state", |json| json["link"] == "up" && json["state"] == "idle");
        assert_eq!(listener.ask("home", "", Some(60))["outcome"], "finished");
        let far = "{\"displacements\":[12000,12000,12000]}";
        listener.say("deltarobot/sim1/command/move", far, false, asked("far", Some(60)));
        let before = listener.hear_on("deltarobot/sim1/state", |json| json["state"] == "moving");
        set("-7200");
        // Dates are compared as text, which RFC 3339 is made for.
        let after = listener.hear_on("deltarobot/sim1/state", |json| json["time"].as_str() < before["time"].as_str());
        assert!(after["seq"].as_u64() > before["seq"].as_u64() && after["state"] == "moving", "{before} {after}");
        assert_eq!(after["operation"], before["operation"]);
        listener.say("deltarobot/sim1/command/cancel", "", false, asked("stop", None));
        assert_eq!(listener.answer("far")["outcome"], "cancelled");
        // It has expired an hour ago, whatever the clock shows now.
        for (hours, is_late) in [(-1, true), (1, false)] {
            let expires = (Utc::now() + TimeDelta::hours(hours)).to_rfc3339();
            let place = format!("{{\"displacements\":[1,2,3],\"expires\":\"{expires}\"}}");
            let answer = listener.ask("move", &place, None);
            let problem = answer["problem"]["detail"].as_str().unwrap_or_default();
            assert_eq!(problem.contains("it has expired"), is_late, "{answer}");
            assert_eq!(answer["outcome"] == "finished", !is_late, "{answer}");
        }
        assert_eq!(server.end(), Some(0));
        let files = files(&directory);
        let (table, complaint) = table(&files[0]);
        // What was recorded before and after lies on both sides of an hour ago.
        let middle = (Utc::now() - TimeDelta::hours(1)).to_rfc3339_opts(SecondsFormat::Micros, true);
        let dates = || table.lines().filter(|line| line.contains(",sim1,")).filter_map(|line| line.split(',').nth(1));
        let is_whole = dates().any(|date| date > middle.as_str()) && dates().any(|date| date < middle.as_str());
        assert!(files.len() == 1 && complaint.is_empty() && is_whole, "{complaint}{table}");
        fs::remove_dir_all(directory).unwrap();
    }
}
