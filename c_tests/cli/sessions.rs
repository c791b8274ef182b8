//! What passes on a line, watched, recorded and sent again.

use super::*;

/// The first line of a recording.
const HEADER: &str = "# deltarobot recording 1\n";

/// Frames that passed, in words and with their direction, by a recording.
fn frames(recording: &Path, from: &str) -> Vec<String> {
    let said = printed(&["monitor", "--json", utf8(recording)], FINISHED);
    let values = said.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    values.filter(|value| value["from"] == from).map(|value| value["bytes"].as_str().unwrap().to_owned()).collect()
}

/// Records what `talk` does at a device between it and a simulator.
fn record(name: &str, sim: &Running, talk: impl FnOnce(&str)) -> PathBuf {
    let file = fresh(name);
    let mut tap = Running::start(&["record", &sim.device, utf8(&file), "--tap"]);
    talk(&tap.device);
    assert_eq!(tap.interrupt(), Some(FINISHED));
    file
}

/// A recording of that, below its first line.
fn recording(name: &str, entries: &str) -> PathBuf {
    let file = fresh(name);
    fs::write(&file, format!("{HEADER}{entries}")).unwrap();
    file
}

#[test]
fn a_recorded_session_is_replayed() {
    let speed = ["--speed", "200"];
    let first = record("cli-session-1.txt", &Running::sim(&speed), |port| {
        printed(&["status", port], FINISHED);
        printed(&["home", port], FINISHED);
        printed(&["move", "10", "20", "30", port], FINISHED);
    });
    assert!(frames(&first, "host").contains(&"24 48 00 A6 3A".to_owned()));
    let text = fs::read_to_string(&first).unwrap();
    let entries = text.strip_prefix(HEADER).unwrap();
    assert!(entries.contains(" > 24 53 00 B1 3A\n"), "{text}");

    // A replay waits for no answers. While the robot homes it refuses to move, and now that may take longer than it did
    // when it was recorded: so the move is a part of its own.
    let order_to_move = entries.find(" > 24 4D").unwrap();
    let (homing, moving) = entries.split_at(entries[..order_to_move].rfind('\n').unwrap() + 1);
    let sim = Running::sim(&speed);
    for (entries, arrived) in [(homing, "IDLE  DA=0  DB=0  DC=0"), (moving, "IDLE  DA=10  DB=20  DC=30")] {
        let part = recording("cli-session-part.txt", entries);
        let second = record("cli-session-2.txt", &sim, |port| {
            printed(&["replay", utf8(&part), port], FINISHED);
            until("the robot has arrived", || outcome(&["status", port]).1.stdout.starts_with(arrived.as_bytes()));
        });
        let requests = frames(&part, "host");
        assert_eq!(frames(&second, "host")[..requests.len()], requests);
    }

    // The controller's side as bytes, which another monitor reads.
    let replayed = run(&mut deltarobot(&["replay", utf8(&first), "-", "--side", "controller", "--fast"]));
    assert_eq!(replayed.status.code(), Some(FINISHED), "{}", super::text(&replayed));
    let raw = fresh("cli-session.raw");
    fs::write(&raw, &replayed.stdout).unwrap();
    let said = printed(&["monitor", utf8(&raw)], FINISHED);
    let statistics = said.lines().last().unwrap();
    let count = frames(&first, "controller").len();
    assert!(statistics.contains(&format!(" {count} frames (")), "{statistics}");
    assert!(statistics.ends_with(" 0 bytes of garbage, 0 wrong checksums"), "{statistics}");
}

/// A simulator that reports without being asked: its arms move, for longer than any test takes.
fn reporting() -> Running {
    let sim = homed();
    printed(&["move", FAR, FAR, FAR, &sim.device, "--no-wait"], FINISHED);
    sim
}

#[test]
fn a_monitor_tells_what_it_saw_when_it_is_interrupted() {
    let sim = reporting();
    let mut monitor = deltarobot(&["monitor", &sim.device, "--json"]).stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(monitor.stdout.take().unwrap()).lines().map(Result::unwrap);
    let reports: Vec<_> = lines.by_ref().take(3).collect();
    interrupt(&monitor);
    let last = lines.last().unwrap();
    assert_eq!(monitor.wait().unwrap().code(), Some(FINISHED));
    for report in reports {
        let report: Value = serde_json::from_str(&report).unwrap();
        assert_eq!((&report["opcode"], &report["from"]), (&"STATUS_REPLY".into(), &"controller".into()));
        assert_eq!(report["state"], "MOVING");
    }
    let statistics: Value = serde_json::from_str(&last).unwrap();
    assert!(statistics["statistics"]["frames_by_opcode"]["STATUS_REPLY"].as_u64().unwrap() >= 3, "{last}");
}

#[test]
fn a_device_alone_is_recorded() {
    let sim = reporting();
    let file = fresh("cli-device.txt");
    let mut record = deltarobot(&["record", &sim.device, utf8(&file)]).spawn().unwrap();
    until("something was recorded", || fs::read_to_string(&file).is_ok_and(|text| text.lines().count() > 6));
    interrupt(&record);
    assert_eq!(record.wait().unwrap().code(), Some(FINISHED));
    assert!(frames(&file, "controller").len() >= 3);
    assert!(frames(&file, "host").is_empty());
}

#[test]
fn a_recording_is_shown_with_its_times_and_directions() {
    let entries = "0.0 < FF 24 68 00 C6 3A\n0.1 < 24 53 00 B2 3A\n0.2 > 24 41 01 48 E8 3A\n";
    let recording = recording("cli-monitored.txt", entries);
    assert_eq!(
        printed(&["monitor", utf8(&recording)], FINISHED),
        "     0.000 < garbage: FF\n     0.000 < HOMING_REPLY\n     \
         0.100 < garbage: 24 53 00 B2 3A (checksum B2 instead of B1)\n     0.200 > ACK: (HOMING!)\n\
         17 bytes in 0.200 s: 2 frames (1 ACK, 1 HOMING_REPLY), 6 bytes of garbage, 1 wrong checksums\n"
    );
    let (_, replayed) = outcome(&["replay", utf8(&recording), "-", "--fast"]);
    assert_eq!(replayed.stdout, b"$A\x01H\xE8:");
}

#[test]
fn a_monitor_reads_standard_input() {
    let mut child =
        deltarobot(&["monitor", "-", "--json"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(b"$A\x01H\xE8:junk$M\x0C$S\0\xB1:").unwrap();
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    let values: Vec<Value> = said.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((&values[0]["opcode"], &values[0]["from"]), (&"ACK".into(), &Value::Null));
    assert_eq!(values[1]["garbage"], "6A 75 6E 6B 24 4D 0C");
    assert_eq!((&values[2]["opcode"], &values[2]["from"]), (&"STATUS?".into(), &"host".into()));
    assert_eq!(values[3]["statistics"]["garbage_bytes"], 7);
}

#[test]
fn a_recording_inside_of_a_stream_is_garbage() {
    let file = fresh("cli-inside.raw");
    // It begins where a piece does in which the monitor reads.
    let (frame, before) = (b"$S\0\xB1:".as_slice(), b"$S\0\xB1:".repeat(819));
    fs::write(&file, [&before, b"-".as_slice(), HEADER.as_bytes(), frame].concat()).unwrap();
    let output = deltarobot(&["monitor", "-"]).stdin(fs::File::open(&file).unwrap()).output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.ends_with(": 820 frames (820 STATUS?), 26 bytes of garbage, 0 wrong checksums\n"), "{said}");
}

#[test]
fn a_monitor_ends_with_its_reader() {
    let mut child = deltarobot(&["monitor", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let mut input = child.stdin.take().unwrap();
    until("the monitor ends", || {
        let _ = input.write_all(b"$S\0\xB1:");
        child.try_wait().unwrap().is_some()
    });
    assert_eq!(child.wait().unwrap().code(), Some(FINISHED));
}

#[test]
fn a_large_file_is_no_longer_shown_after_an_interrupt() {
    let raw = fresh("cli-large.raw");
    fs::write(&raw, b"$S\0\xB1:".repeat(100_000)).unwrap();
    let recording = recording("cli-large.txt", &"0.0 > 24 53 00 B1 3A\n".repeat(100_000));
    for file in [raw, recording] {
        let mut monitor = deltarobot(&["monitor", utf8(&file), "--json"]).stdout(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(monitor.stdout.take().unwrap()).lines().map(Result::unwrap);
        lines.next().unwrap();
        // By now it waits, or soon will, for room in the pipe.
        interrupt(&monitor);
        let last: Value = serde_json::from_str(&lines.last().unwrap()).unwrap();
        assert_eq!(monitor.wait().unwrap().code(), Some(FINISHED));
        let frames = last["statistics"]["frames"].as_u64().unwrap();
        assert!((1..50_000).contains(&frames), "{file:?}: {frames}");
    }
}

#[test]
fn a_broken_recording_is_an_error_and_nothing_else() {
    let broken = recording("cli-broken.txt", "0.0 > 24 53 00 B1 3A\n0.1 ? 24\n");
    let about = "line 3: `?` is neither > nor <";
    for arguments in [&["monitor", utf8(&broken)] as &[&str], &["monitor", "--json", utf8(&broken)]] {
        complains(arguments, DEVICE, about);
        assert_eq!(printed(arguments, DEVICE), "");
    }
    let output = deltarobot(&["monitor", "-"]).stdin(fs::File::open(&broken).unwrap()).output().unwrap();
    assert_eq!(output.status.code(), Some(DEVICE));
    // Of a stream, what has come is shown.
    assert!(output.stdout.starts_with(b"     0.000 > STATUS?\n5 bytes in "), "{}", super::text(&output));
    assert!(super::text(&output).contains(about), "{}", super::text(&output));
    complains(&["replay", utf8(&broken), "-"], DEVICE, about);
}

#[test]
fn a_side_that_never_sent_anything_is_not_replayed() {
    let silent = recording("cli-silent.txt", "0.0 > 24 53 00 B1 3A\n");
    let about = "cli-silent.txt: nothing in it was sent by the controller; try --side";
    complains(&["replay", utf8(&silent), "-", "--side", "controller"], USAGE, about);
}

#[test]
fn a_recording_stays_when_another_can_not_begin() {
    let kept = recording("cli-kept.txt", "0.0 > 24 53 00 B1 3A\n");
    let before = fs::read(&kept).unwrap();
    let sim = Running::sim(&[]);
    let taken = fresh("cli-taken");
    fs::write(&taken, "mine").unwrap();
    complains(&["record", &sim.device, utf8(&kept)], DEVICE, "File exists; --append continues it");
    let to_tap = ["record", "--force", &sim.device, utf8(&kept), "--tap", "--link", utf8(&taken)];
    complains(&to_tap, DEVICE, "cli-taken: File exists");
    for option in [&["--tap"] as &[&str], &[]] {
        complains(
            &[&["record", "--force", "/dev/null", utf8(&kept)], option].concat(),
            DEVICE,
            "/dev/null: not a serial port",
        );
    }
    assert_eq!(fs::read(&kept).unwrap(), before);
}
