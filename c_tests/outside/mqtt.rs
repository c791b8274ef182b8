//! What is published.

use super::broker::{Broker, Listener};
use super::*;
use crate::support::{has_tool, run, text};

#[test]
fn states_are_retained() {
    let Some(broker) = Broker::start() else { return };
    let server = Server::start(&broker.settings("commands = true"));
    found("it is connected", || (server.metric("deltarobot_mqtt_up") > 0).then_some(()));
    let first = Listener::new(broker.port, &["deltarobot/#"]);
    first.hear_on("deltarobot/sim1/state", |json| json["link"] == "up" && json["state"] == "idle");
    assert_eq!(first.hear_on("deltarobot/sim1/health", |_| true)["garbage_bytes"], 0);
    // Whoever comes later has it too.
    let later = Listener::new(broker.port, &["deltarobot/+/state", "deltarobot/status"]);
    let (json, publish) =
        later.hear("a retained state", |topic, _, publish| topic.ends_with("/state") && publish.retain);
    assert_eq!((&json["name"], publish.retain), (&"sim1".into(), true));
    later.hear_on("deltarobot/status", |json| json["status"] == "online");
    assert!(server.metric("deltarobot_mqtt_published_total") >= 3);
    // An orderly end is said.
    assert_eq!(server.end(), Some(0));
    later.hear_on("deltarobot/status", |json| json["status"] == "offline");
}

#[test]
fn the_last_will_says_that_the_program_was_killed() {
    let Some(broker) = Broker::start() else { return };
    let server = Server::start(&broker.settings("prefix = \"plant/hall 1\""));
    let listener = Listener::new(broker.port, &["plant/#"]);
    listener.hear_on("plant/hall 1/status", |json| json["status"] == "online");
    server.signal("KILL");
    listener.hear_on("plant/hall 1/status", |json| json["status"] == "offline");
}

#[test]
fn a_wrong_password_is_said_clearly() {
    let directory = empty("password");
    let (users, password) = (directory.join("users"), directory.join("password"));
    if !has_tool("mosquitto_passwd", "-h") {
        return;
    }
    let output = run(Command::new("mosquitto_passwd").args(["-b", "-c", utf8(&users), "robot", "right"]));
    assert!(output.status.success(), "{}", text(&output));
    let Some(broker) = Broker::with(&format!("allow_anonymous false\npassword_file {}\n", utf8(&users))) else {
        return;
    };
    fs::write(&password, "wrong\n").unwrap();
    let more = format!("user = \"robot\"\npassword_file = \"{}\"", utf8(&password));
    let server = Server::start(&broker.settings(&more));
    found("it is said", || server.said().contains("mqtt: the broker refuses this user or password").then_some(()));
    assert!(!server.said().contains("wrong"), "{}", server.said());
    assert_eq!(server.metric("deltarobot_mqtt_up"), 0);
    // The robots are there all the same.
    assert!(server.get("/api/robots").contains("\"sim1\""));
    assert_eq!(server.end(), Some(0));
}

#[test]
fn settings_that_can_not_be_are_refused() {
    for (settings, about) in [
        ("url = \"http://x\"", "url has to be"),
        ("url = \"mqtt://x:99999\"", "no port"),
        ("url = \"mqtt://x\"\nprefix = \"a/#\"", "prefix is no topic"),
        ("url = \"mqtt://x\"\nca_file = \"x\"", "are for mqtts://"),
        ("url = \"mqtt://x\"\npassword_file = \"x\"", "password_file is for a user"),
        ("url = \"mqtts://x\"\nca_file = \"/nonexistent\"", "/nonexistent: No such file"),
        ("url = \"mqtts://x\"\nca_file = \"/dev/null\"", "there are no certificates in it"),
        ("url = \"mqtt://x\"\ntypo = 1", "typo"),
    ] {
        let file = empty("refused").join("serve.toml");
        fs::write(&file, format!("simulated = 1\nlisten = \"127.0.0.1:0\"\n[mqtt]\n{settings}\n")).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_deltarobot-serve"));
        let output = run(command.arg("--config").arg(&file));
        let said = String::from_utf8(output.stderr).unwrap();
        assert!([Some(2), Some(3)].contains(&output.status.code()), "{settings}: {said}");
        assert!(said.lines().count() == 1 && said.contains(about), "{settings}: {said}");
    }
}
