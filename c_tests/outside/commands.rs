//! Commands by a broker.

use super::broker::{Broker, Listener, asked};
use super::*;

fn started(more: &str) -> Option<(Broker, Server, Listener)> {
    let broker = Broker::start()?;
    let server = Server::start(&broker.settings(more));
    let listener = Listener::new(broker.port, &["deltarobot/#", "answers"]);
    listener.hear_on("deltarobot/sim1/state", |json| json["link"] == "up" && json["state"] == "idle");
    Some((broker, server, listener))
}

#[test]
fn are_carried_out_and_answered() {
    let Some((_broker, server, listener)) = started("commands = true") else { return };
    let unknown = listener.ask("move", "{\"displacements\":[1,2,3]}", Some(60));
    assert_eq!(unknown["outcome"], "refused", "{unknown}");
    let homed = listener.ask("home", "", Some(60));
    assert_eq!((&homed["outcome"], &homed["command"]), (&"finished".into(), &"sim1/command/home".into()), "{homed}");
    let moved = listener.ask("move", "{\"displacements\":[1,2,3]}", Some(60));
    assert_eq!(moved["outcome"], "finished", "{moved}");
    assert_eq!(moved["operation"]["by"], "mqtt");
    listener.say(
        "deltarobot/sim1/command/move",
        "{\"displacements\":[12000,12000,12000]}",
        false,
        asked("far", Some(60)),
    );
    listener.hear_on("deltarobot/sim1/state", |json| json["state"] == "moving");
    assert_eq!(listener.ask("cancel", "", None)["outcome"], "finished");
    assert_eq!(listener.answer("far")["outcome"], "cancelled");
    assert!(server.metric("deltarobot_mqtt_commands_total") >= 5);
}

#[test]
fn what_is_late_retained_or_again_is_refused() {
    let Some((broker, server, listener)) = started("commands = true") else { return };
    assert_eq!(listener.ask("home", "", Some(60))["outcome"], "finished");
    let place = "\"displacements\":[1,2,3]";
    let detail = |answer: &serde_json::Value| answer["problem"]["detail"].as_str().unwrap_or_default().to_owned();
    for (payload, seconds, about) in [
        (format!("{{{place}}}"), None, "needs a message expiry interval"),
        (format!("{{{place},\"expires\":\"2020-01-01T00:00:00Z\"}}"), Some(60), "it has expired"),
        (format!("{{{place},\"expires\":\"soon\"}}"), Some(60), "the payload"),
        (format!("{{{place},\"typo\":1}}"), Some(60), "the payload"),
        ("{\"displacements\":[1,2]}".into(), Some(60), "the payload"),
        ("{\"displacements\":[1,2,1e99]}".into(), Some(60), ""),
        ("{}".into(), Some(60), "either `displacements` or `position`"),
        ("\u{0}".into(), Some(60), "the payload"),
    ] {
        let answer = listener.ask("move", &payload, seconds);
        assert!(answer["problem"].is_object() && detail(&answer).contains(about), "{payload}: {answer}");
    }
    assert!(detail(&listener.ask("dance", "", Some(60))).contains("commands are home, move and cancel"));
    // The same again, as a sender that heard no answer repeats it.
    let say = || listener.say("deltarobot/sim1/command/move", &format!("{{{place}}}"), false, asked("twice", Some(60)));
    say();
    assert_eq!(listener.answer("twice")["outcome"], "finished");
    say();
    assert!(detail(&listener.answer("twice")).contains("has come before"));
    // A retained one, which the broker gives to whoever subscribes.
    listener.say("deltarobot/sim1/command/move", &format!("{{{place}}}"), true, asked("kept", Some(600)));
    let first = listener.answer("kept");
    assert_eq!(first["outcome"], "finished", "it is new for those who are there: {first}");
    drop(server);
    let again = Server::start(&broker.settings("commands = true"));
    assert!(detail(&listener.answer("kept")).contains("was retained"));
    assert_eq!(again.metric("deltarobot_mqtt_commands_total"), 0);
}

#[test]
fn what_waited_while_the_program_was_held_up_is_refused() {
    let Some((_broker, server, listener)) = started("commands = true") else { return };
    assert_eq!(listener.ask("home", "", Some(60))["outcome"], "finished");
    server.signal("STOP");
    listener.say("deltarobot/sim1/command/move", "{\"displacements\":[1,2,3]}", false, asked("held", Some(1)));
    std::thread::sleep(Duration::from_secs(3));
    server.signal("CONT");
    let answer = listener.answer("held");
    assert!(answer["problem"]["detail"].as_str().unwrap().contains("expired"), "{answer}");
}

#[test]
fn without_leave_only_cancelling_is_possible() {
    let Some((_broker, _server, listener)) = started("") else { return };
    let answer = listener.ask("home", "", Some(60));
    assert!(answer["problem"]["detail"].as_str().unwrap().contains("commands = true"), "{answer}");
    assert_eq!(listener.ask("cancel", "", None)["outcome"], "finished");
}

#[test]
fn answers_are_no_commands() {
    let Some((_broker, server, listener)) = started("commands = true") else { return };
    let mut properties = asked("loop", Some(60));
    properties.response_topic = Some("deltarobot/sim1/command/cancel".into());
    listener.say("deltarobot/sim1/command/cancel", "", false, properties);
    assert_eq!(listener.ask("cancel", "", None)["outcome"], "finished");
    assert_eq!(server.metric("deltarobot_mqtt_commands_total"), 2);
}
