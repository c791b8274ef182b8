//! `deltarobot run`: many requests in one opening.

use super::*;

fn program_file(name: &str, lines: &str) -> String {
    let path = fresh(name);
    fs::write(&path, lines).unwrap();
    utf8(&path).to_owned()
}

#[test]
fn requests_follow_each_other() {
    let sim = Running::sim(&["--speed", "200"]);
    let file = program_file("cli-run.txt", "home # first\nmove 1 2 3\nwait 0.1\n\nstatus\n");
    let said = printed(&["run", &sim.device, &file], FINISHED);
    let lines: Vec<_> = said.lines().collect();
    assert_eq!(lines.len(), 3, "{said}");
    assert!(lines[0].starts_with("1 of 4: home finished after "), "{said}");
    assert!(lines[1].contains("2 of 4, ") && lines[1].contains("move finished after "), "{said}");
    assert!(lines[2].ends_with("IDLE  DA=1  DB=2  DC=3"), "{said}");

    let said = printed(&["run", "--json", &sim.device, &file], FINISHED);
    let values: Vec<Value> = said.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((&values[1]["request"], &values[1]["outcome"]), (&"move".into(), &"finished".into()));
    assert_eq!(values[2]["step"], serde_json::json!({ "number": 4, "line": 5 }));
}

#[test]
fn it_stops_at_the_first_that_fails_unless_told_otherwise() {
    let sim = Running::sim(&["--speed", "200"]);
    let file = program_file("cli-run-fails.txt", "move 1 2 3\nhome\n");
    let (code, output) = outcome(&["run", &sim.device, &file]);
    assert_eq!((code, output.stdout.split(|byte| *byte == b'\n').count()), (NOT_DONE, 2), "{}", text(&output));
    assert!(text(&output).contains("stopped at line 1"), "{}", text(&output));
    let said = printed(&["run", "--keep-going", &sim.device, &file], NOT_DONE);
    assert!(said.contains("home finished"), "{said}");
}

#[test]
fn all_lines_are_read_before_anything_moves() {
    let file = program_file("cli-run-wrong.txt", "home\njump\n");
    complains(&["run", "/nonexistent/tty", &file], USAGE, "line 2: `jump` is none of");
}

#[test]
fn loops_from_standard_input() {
    let sim = Running::sim(&["--speed", "200"]);
    let mut child = deltarobot(&["run", &sim.device, "--wait", "ready"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(b"status\nhome\nloop 2\n").unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(FINISHED));
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(said.matches("home finished").count(), 3, "{said}");
}

#[test]
fn ctrl_c_cancels_the_motion() {
    let sim = homed();
    let file = program_file("cli-run-endless.txt", &format!("move 0 0 0\nmove {FAR} {FAR} {FAR}\nloop\n"));
    let mut child = deltarobot(&["run", &sim.device, &file]).stdout(Stdio::piped()).spawn().unwrap();
    let mut said = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut said).unwrap();
    std::thread::sleep(Duration::from_millis(300));
    interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(CANCELLED), "{said}");
    assert!(printed(&["status", &sim.device], FINISHED).starts_with("IDLE  "));
}

/// Within a pause too, of which JSON says how it ended.
#[test]
fn a_pause_ends_with_its_user_and_its_port() {
    let file = program_file("cli-run-pause.txt", "status\nwait 80000\n");
    for (end, status, outcome) in [("INT", CANCELLED, "interrupted"), ("KILL", DEVICE, "error")] {
        let sim = Running::sim(&[]);
        let mut child = deltarobot(&["run", "--json", &sim.device, &file]).stdout(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
        lines.next().unwrap();
        signal(if end == "INT" { &child } else { &sim.child }, end);
        let value: Value = serde_json::from_str(&lines.next().unwrap()).unwrap();
        assert_eq!((&value["request"], &value["outcome"]), (&"wait".into(), &outcome.into()));
        assert_eq!(value["step"]["line"], 2, "{value}");
        assert_eq!(child.wait().unwrap().code(), Some(status), "{value}");
    }
}
