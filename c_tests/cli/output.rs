//! Standard output: a terminal or none, closed, or full.

use std::fs::File;

use super::*;

#[test]
fn plain_lines_where_there_is_no_terminal() {
    let sim = Running::sim(&["--speed", "200"]);
    let said = printed(&["home", &sim.device], FINISHED);
    assert!(!said.contains(['\r', '\x1b']), "{said:?}");
    assert!(said.starts_with("HOMING  ") && said.contains("\nhome finished after "), "{said}");
}

/// On a terminal, which `script` gives it, the position is shown while the robot moves.
#[test]
fn a_live_line_on_a_terminal() {
    if !has_tool("script", "--version") {
        return;
    }
    let sim = Running::sim(&["--speed", "50"]);
    let shell = format!("{} home {}", env!("CARGO_BIN_EXE_deltarobot"), sim.device);
    let output = run(Command::new("script").args(["-qec", &shell, "/dev/null"]));
    let said = text(&output);
    assert!(output.status.success() && said.contains("\rHOMING  ") && said.contains("\x1b[K"), "{said:?}");
    assert!(said.contains("home finished after "), "{said:?}");
}

#[test]
fn closed_standard_output_changes_nothing() {
    let sim = Running::sim(&["--speed", "200"]);
    let mut homing = deltarobot(&["home", &sim.device]).stdout(Stdio::piped()).spawn().unwrap();
    drop(homing.stdout.take());
    assert_eq!(homing.wait().unwrap().code(), Some(FINISHED));
    let status = json(&["status", &sim.device, "--json"], FINISHED);
    assert_eq!(status["status"]["position"], serde_json::json!([0.0, 0.0, 0.0]));
}

#[test]
fn who_reads_no_more_has_seen_enough() {
    let many = "24 53 00 B1 3A ".repeat(5000);
    let mut child = deltarobot(&["decode", &many]).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(FINISHED));
}

/// Runs it where standard output has no room: the exit status, and what it complained about.
fn filled(arguments: &[&str]) -> Option<(i32, String)> {
    let full = File::options().write(true).open("/dev/full").ok()?;
    let output = deltarobot(arguments).stdin(Stdio::null()).stdout(full).stderr(Stdio::piped()).output().unwrap();
    Some((output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap()))
}

#[test]
fn a_full_one_is_an_error() {
    let recording = fresh("cli-full.txt");
    fs::write(&recording, "# deltarobot recording 1\n0.0 > 24 53 00 B1 3A\n").unwrap();
    let (recording, sim) = (utf8(&recording), Running::sim(&[]));
    for arguments in [
        &["decode", "24 53 00 B1 3A"] as &[&str],
        &["decode", "--json", "24 53 00 B1 3A"],
        &["monitor", recording],
        &["monitor", "-"],
        &["record", &sim.device, "-"],
        &["replay", recording, "-"],
        &["sim"],
        &["--help"],
        &["--version"],
    ] {
        let Some((code, said)) = filled(arguments) else { return };
        let expected = (DEVICE, "deltarobot: standard output: No space left on device\n");
        assert_eq!((code, said.as_str()), expected, "{arguments:?}");
    }
}

/// The exit status of a request says how the request ended.
#[test]
fn a_full_one_is_complained_about_by_requests() {
    let sim = Running::sim(&["--speed", "200"]);
    for (request, status) in [(&["status"] as &[&str], FINISHED), (&["move", "1", "2", "3"], NOT_DONE)] {
        for option in [&[] as &[&str], &["--json"]] {
            let arguments = [request, &[&sim.device], option].concat();
            let Some((code, said)) = filled(&arguments) else { return };
            let expected = "deltarobot: standard output: No space left on device\n";
            assert!(code == status && said.starts_with(expected), "{arguments:?}: {code} {said}");
        }
    }
}
