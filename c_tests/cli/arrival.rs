//! Time is the time of arrival: what was held up, by whatever, is no silence on the line.

use std::io::Read;
use std::thread::sleep;

use super::device::Device;
use super::*;

/// The status request.
const STATUS: &[u8] = b"$S\0\xB1:";
/// A status report of shipped firmware: homed, at 0, 0, 0.
const REPORT: &[u8] = b"$s\x10\0\0\0\0\0\0\0\0\0\0\0\0\x1C\0\0\0\xFD:";

fn last_line(said: &str) -> &str {
    said.lines().last().unwrap_or_default()
}

#[test]
fn a_slow_reader_of_a_monitor_costs_no_frame() {
    let mut child = deltarobot(&["monitor", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || input.write_all(&STATUS.repeat(4000)));
    // By then the pipes of both sides are full, and the monitor waits in the middle of a frame.
    sleep(Duration::from_millis(1300));
    let mut said = String::new();
    child.stdout.take().unwrap().read_to_string(&mut said).unwrap();
    writer.join().unwrap().unwrap();
    child.wait().unwrap();
    assert!(
        said.ends_with(" 4000 frames (4000 STATUS?), 0 bytes of garbage, 0 wrong checksums\n"),
        "{}",
        last_line(&said)
    );
}

/// Runs a program while half a frame waits before it is stopped, and the other half comes meanwhile.
fn stopped_within_a_frame(arguments: &[&str], child: impl FnOnce(&[&str]) -> Child, device: &mut Device) -> Child {
    let child = child(arguments);
    sleep(Duration::from_millis(500));
    for place in [1, 2, 3, 4] {
        let (first, second) = STATUS.split_at(place);
        device.say(first);
        sleep(Duration::from_millis(10));
        signal(&child, "STOP");
        sleep(Duration::from_millis(20));
        device.say(second);
        sleep(Duration::from_millis(1200));
        signal(&child, "CONT");
        sleep(Duration::from_millis(50));
    }
    child
}

#[test]
fn a_monitor_that_was_stopped_loses_no_frame() {
    let mut device = Device::new();
    let path = device.path.clone();
    let start = |arguments: &[&str]| deltarobot(arguments).stdout(Stdio::piped()).spawn().unwrap();
    let child = stopped_within_a_frame(&["monitor", &path], start, &mut device);
    interrupt(&child);
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(last_line(&said).contains(" 4 frames (4 STATUS?), 0 bytes of garbage"), "{said}");
}

/// Its times show no pause within a frame either.
#[test]
fn a_recorder_that_was_stopped_loses_no_frame() {
    let mut device = Device::new();
    let (path, file) = (device.path.clone(), fresh("cli-stopped.txt"));
    let start = |arguments: &[&str]| deltarobot(arguments).spawn().unwrap();
    let mut child = stopped_within_a_frame(&["record", &path, utf8(&file)], start, &mut device);
    interrupt(&child);
    child.wait().unwrap();
    let said = printed(&["monitor", utf8(&file)], FINISHED);
    assert!(last_line(&said).contains(" 4 frames (4 STATUS?), 0 bytes of garbage"), "{said}");
}

/// The answer comes in time; that the program looks late is not the controller's fault.
#[test]
fn a_request_that_was_stopped_sees_the_answer() {
    let mut device = Device::new();
    let child = deltarobot(&["status", "--json", &device.path]).stdout(Stdio::piped()).spawn().unwrap();
    assert_eq!(device.hear(5), STATUS);
    device.say(&REPORT[..9]);
    sleep(Duration::from_millis(10));
    signal(&child, "STOP");
    device.say(&REPORT[9..]);
    sleep(Duration::from_millis(600));
    signal(&child, "CONT");
    let output = child.wait_with_output().unwrap();
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&value["outcome"], &value["link"]["timeouts"]), (&"finished".into(), &0.into()), "{value}");
    assert_eq!(device.hear_now(), b"");
}

/// A simulated controller too.
#[test]
fn a_simulator_that_was_stopped_answers_once() {
    let mut talk = super::talk::Talk::with_sim(&[]);
    talk.say(b"$S\0");
    sleep(Duration::from_millis(10));
    signal(&talk.sim.child, "STOP");
    talk.say(b"\xB1:");
    sleep(Duration::from_millis(600));
    signal(&talk.sim.child, "CONT");
    assert_eq!(talk.hear(21).first(), Some(&b'$'));
}

/// USB converters collect bytes for 16 ms and more, and networks deliver in jerks.
#[test]
fn a_pause_within_a_report_loses_nothing() {
    let mut device = Device::new();
    let child = deltarobot(&["monitor", &device.path]).stdout(Stdio::piped()).spawn().unwrap();
    sleep(Duration::from_millis(500));
    for place in [1, 5, 20] {
        let (first, second) = REPORT.split_at(place);
        device.say(first);
        sleep(Duration::from_millis(90));
        device.say(second);
    }
    sleep(Duration::from_millis(300));
    interrupt(&child);
    let said = String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap();
    assert!(last_line(&said).contains(" 3 frames (3 STATUS_REPLY), 0 bytes of garbage"), "{said}");

    let child = deltarobot(&["status", "--json", &device.path]).stdout(Stdio::piped()).spawn().unwrap();
    assert_eq!(device.hear(5), STATUS);
    let (first, second) = REPORT.split_at(9);
    device.say(first);
    sleep(Duration::from_millis(90));
    device.say(second);
    let output = child.wait_with_output().unwrap();
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&value["outcome"], &value["link"]["garbage_bytes"]), (&"finished".into(), &0.into()), "{value}");
}

#[test]
fn the_gap_may_be_given() {
    let mut device = Device::new();
    let child = deltarobot(&["monitor", "--gap", "40", &device.path]).stdout(Stdio::piped()).spawn().unwrap();
    sleep(Duration::from_millis(500));
    device.say(&REPORT[..9]);
    sleep(Duration::from_millis(300));
    device.say(&REPORT[9..]);
    sleep(Duration::from_millis(300));
    interrupt(&child);
    let said = String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap();
    assert!(last_line(&said).contains(" 0 frames, 21 bytes of garbage"), "{said}");
}
