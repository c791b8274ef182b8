//! `deltarobot send`: commands of the other protocols and their outcomes.

use std::io::Read;

use super::device::Device;
use super::*;

fn line<'a>(port: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["send", "--protocol", "line", port], more].concat()
}

fn gx<'a>(port: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["send", "--protocol", "gx", port], more].concat()
}

fn sim(protocol: &str, more: &[&str]) -> Running {
    Running::sim(&[&["--protocol", protocol], more].concat())
}

#[test]
fn commands_of_the_line_protocol() {
    let sim = sim("line", &["--press", "1000"]);
    let port = &sim.device;
    let said = printed(&line(port, &["c=setswitch&state=1", "--id", "9o5qzg", "--wait", "ready"]), FINISHED);
    assert!(said.starts_with("c=setswitch&state=1 answered after "), "{said}");
    assert!(said.contains(": c=setswitch_resp&state=1&pwm=254&id=9o5qzg&t="), "{said}");

    let several = ["setswitch&state=1", "setswitch&state=0", "--id", "9o5qzg", "--json", "--ack", "--checksum"];
    let said = printed(&line(port, &[&several as &[&str], &["--wait", "0.5"]].concat()), FINISHED);
    let values: Vec<Value> = said.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(values.len(), 3, "{said}");
    assert_eq!((&values[0]["command"], &values[2]["command"]), (&"linksetup".into(), &"c=setswitch&state=0".into()));
    assert!(values.iter().all(|value| value["outcome"] == "answered"), "{said}");

    let refused = line(port, &["setswitch&state=7", "setswitch&state=1", "--id", "9o5qzg", "--wait", "ready"]);
    let said = printed(&refused, NOT_DONE);
    assert!(said.contains(" refused after ") && said.lines().count() == 1, "{said}");
}

#[test]
fn commands_of_the_line_protocol_on_a_bad_line() {
    let sim = sim("line", &["--press", "1000", "--lose", "0.003", "--seed", "5"]);
    let many: Vec<_> = (0..10).map(|number| format!("setswitch&state={}", number % 2)).collect();
    let many: Vec<_> = many.iter().map(String::as_str).collect();
    let options =
        ["--id", "9o5qzg", "--wait", "ready", "--ack", "--checksum", "--recognises-repeats", "--attempts", "9"];
    let said = printed(&line(&sim.device, &[many.as_slice(), &options].concat()), FINISHED);
    assert_eq!(said.matches(" answered after ").count(), 11, "{said}");
}

#[test]
fn moves_of_gx() {
    let sim = sim("gx", &["--travel", "500"]);
    for options in [&[] as &[&str], &["--ascii"]] {
        let moves = ["V2000x400y300", "x0y0", "x100"];
        let said = printed(&gx(&sim.device, &[&moves as &[&str], options].concat()), FINISHED);
        assert_eq!(said.matches(" finished after ").count(), 3, "{said}");
    }
    let said = printed(&gx(&sim.device, &["x400", "x900", "x0", "--json"]), NOT_DONE);
    let values: Vec<Value> = said.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let outcomes: Vec<_> = values.iter().map(|value| value["outcome"].as_str().unwrap()).collect();
    assert_eq!(outcomes, ["finished", "failed", "dropped"], "{said}");
    assert_eq!(values[1]["reason"], "stopped (error 20)");
}

#[test]
fn a_machine_is_stopped() {
    let sim = sim("gx", &["--velocity", "100"]);
    let port = &sim.device;
    let said = printed(&gx(port, &["stop"]), FINISHED);
    assert!(said.starts_with("stop finished after ") && said.contains(": x=0  y=0"), "{said}");
    let hold = json(&gx(port, &["hold", "--json"]), FINISHED);
    assert_eq!((&hold["command"], &hold["outcome"], &hold["held"]), (&"hold".into(), &"finished".into(), &true.into()));
    assert_eq!(json(&gx(port, &["query", "--ascii", "--json"]), FINISHED)["held"], true);
    assert_eq!(json(&gx(port, &["resume", "--json"]), FINISHED)["held"], false);

    // On its way for hours, then interrupted.
    let mut child = deltarobot(&gx(port, &["x100", "y50000000", "y0"])).stdout(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(child.stdout.take().unwrap());
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    assert!(line.starts_with("x100 finished after "), "{line}");
    interrupt(&child);
    line.clear();
    said.read_to_string(&mut line).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(CANCELLED), "{line}");
    for said in ["y50000000 failed after ", "y0 dropped after ", "stop finished after ", ": x=100  y="] {
        assert!(line.contains(said), "{said}: {line}");
    }
}

#[test]
fn no_answer_is_no_outcome() {
    let device = Device::new();
    for (arguments, text) in [
        (line(&device.path, &["setswitch&state=1", "--id", "x", "--answer-time", "0.1"]), "timed out"),
        (gx(&device.path, &["x1", "--answer-time", "0.1", "--attempts", "2"]), "timed out"),
        (gx(&device.path, &["stop", "--answer-time", "0.1", "--attempts", "2"]), "not answered"),
    ] {
        let began = Instant::now();
        let said = printed(&arguments, TIMED_OUT);
        assert!(said.contains(text) && began.elapsed() < Duration::from_secs(20), "{said}");
    }
    let mut device = Device::new();
    let mut child = deltarobot(&gx(&device.path, &["x1", "--attempts", "200"])).spawn().unwrap();
    device.hear(1);
    interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(CANCELLED));
}

#[test]
fn what_can_not_be_sent_is_named() {
    let sim = sim("gx", &[]);
    let port = sim.device.as_str();
    complains(&["send", port, "x1"], USAGE, "it takes --protocol line or gx");
    complains(&line(port, &["setswitch"]), USAGE, "--id is needed");
    complains(&line(port, &["state=1&t=3", "--id", "x"]), USAGE, "no command");
    complains(&line(port, &[&format!("go&x={}", "1".repeat(60)), "--id", "x"]), USAGE, "longer than 64 bytes");
    complains(&gx(port, &["x1", "--id", "x"]), USAGE, "--id is for --protocol line only");
    complains(&gx(port, &["x1x2"]), USAGE, "twice");
    complains(&gx(port, &["#1x2"]), USAGE, "without a number");
    complains(&gx(port, &["R20"]), USAGE, "no move");
    complains(&gx(port, &["x1", "stop"]), USAGE, "stop: it has to stand alone");
}
