//! Signals, as shells and terminals send them and as those who start programs ignore them.

use std::io::Read;
use std::thread::sleep;

use super::*;

/// Starts it with signals ignored, as `nohup` and shells do.
fn ignoring(signals: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("trap '' {signals}; exec \"$0\" \"$@\"")]).arg(program()).args(arguments);
    command.env_remove("DELTAROBOT_PORT");
    command
}

fn is_alive(child: &mut Child) -> bool {
    sleep(Duration::from_millis(300));
    child.try_wait().unwrap().is_none()
}

#[test]
fn what_was_ignored_stays_ignored() {
    let sim = Running::sim(&[]);
    let file = fresh("cli-nohup.txt");
    let mut child = ignoring("HUP INT", &["record", &sim.device, utf8(&file)]).spawn().unwrap();
    until("it records", || file.exists());
    for name in ["HUP", "INT"] {
        signal(&child, name);
        assert!(is_alive(&mut child), "{name}");
    }
    signal(&child, "TERM");
    assert_eq!(child.wait().unwrap().code(), Some(FINISHED));
}

/// A script with a recorder in the background, and a move in the foreground: Ctrl-C goes to both.
#[test]
fn ctrl_c_in_a_script_cancels_a_move_through_a_tap() {
    let sim = homed();
    let (file, link) = (fresh("cli-script.txt"), fresh("cli-script-tap"));
    let mut tap = ignoring("INT QUIT", &["record", &sim.device, utf8(&file), "--tap", "--link", utf8(&link)])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    until("the tap is there", || link.exists());
    let mut moving = deltarobot(&["move", FAR, FAR, FAR, utf8(&link)]).stdout(Stdio::piped()).spawn().unwrap();
    let mut said = String::new();
    BufReader::new(moving.stdout.take().unwrap()).read_line(&mut said).unwrap();
    interrupt(&tap);
    interrupt(&moving);
    assert_eq!(moving.wait().unwrap().code(), Some(CANCELLED));
    signal(&tap, "TERM");
    assert_eq!(tap.wait().unwrap().code(), Some(FINISHED));
    assert!(printed(&["status", &sim.device], FINISHED).starts_with("IDLE  "));
}

/// The same in the foreground, where the tap is asked to end too: first it passes on the cancel request.
#[test]
fn a_tap_that_ends_lets_its_user_cancel() {
    let sim = homed();
    let file = fresh("cli-both.txt");
    let mut tap = Running::start(&["record", &sim.device, utf8(&file), "--tap"]);
    let mut moving = deltarobot(&["move", FAR, FAR, FAR, &tap.device]).stdout(Stdio::piped()).spawn().unwrap();
    let mut said = String::new();
    BufReader::new(moving.stdout.take().unwrap()).read_line(&mut said).unwrap();
    interrupt(&tap.child);
    sleep(Duration::from_millis(100));
    interrupt(&moving);
    assert_eq!(moving.wait().unwrap().code(), Some(CANCELLED));
    assert_eq!(tap.child.wait().unwrap().code(), Some(FINISHED));
    assert!(printed(&["status", &sim.device], FINISHED).starts_with("IDLE  "));
}

/// Even one that is killed.
#[test]
fn a_move_whose_tap_is_gone_is_cancelled_at_the_device() {
    for name in ["KILL", "TERM"] {
        let sim = homed();
        let (file, link) = (fresh(&format!("cli-gone-{name}.txt")), fresh(&format!("cli-gone-{name}")));
        let tap = Running::start(&["record", &sim.device, utf8(&file), "--tap", "--link", utf8(&link)]);
        let mut moving = deltarobot(&["move", FAR, FAR, FAR, "--json", utf8(&link)])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        until("it moves", || fs::read_to_string(&file).is_ok_and(|text| text.matches(" < 24 73").count() > 3));
        signal(&tap.child, name);
        assert_eq!(moving.wait().unwrap().code(), Some(DEVICE));
        let mut said = String::new();
        moving.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        assert!(said.contains("disconnected; the motion was cancelled at "), "{said}");
        let value: Value = serde_json::from_reader(moving.stdout.take().unwrap()).unwrap();
        assert_eq!(value["outcome"], "error");
        assert!(printed(&["status", &sim.device], FINISHED).starts_with("IDLE  "));
    }
}

#[test]
fn links_are_removed_whatever_ends_it() {
    for name in ["INT", "TERM", "HUP", "QUIT", "USR1", "USR2", "ALRM", "XCPU", "VTALRM", "PROF"] {
        let link = fresh(&format!("cli-ended-{name}"));
        let mut sim = Running::sim(&["--link", utf8(&link)]);
        signal(&sim.child, name);
        sim.child.wait().unwrap();
        assert!(fs::symlink_metadata(&link).is_err(), "{name}");
    }
}

/// As a shell's `ulimit -f` sets it.
#[test]
fn a_limit_on_the_size_of_files_is_a_full_disk() {
    let sim = homed();
    printed(&["move", FAR, FAR, FAR, &sim.device, "--no-wait"], FINISHED);
    let (file, link) = (fresh("cli-limit.txt"), fresh("cli-limit-tap"));
    let output = Command::new("sh")
        .args(["-c", "ulimit -f 2; exec \"$0\" \"$@\""])
        .arg(program())
        .args(["record", &sim.device, utf8(&file), "--tap", "--link", utf8(&link)])
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(DEVICE), "{said}");
    assert!(said.contains("cli-limit.txt: File too large"), "{said}");
    assert!(fs::symlink_metadata(&link).is_err());
    let shown = printed(&["monitor", utf8(&file)], FINISHED);
    assert!(shown.contains("STATUS_REPLY") && shown.contains(" 0 bytes of garbage"), "{shown}");
}
