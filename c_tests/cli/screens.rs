//! Those who read what is printed, and the terminals of those who do.

use std::io::Read;
use std::thread::sleep;

use super::device::Device;
use super::*;

/// A reader that has seen enough, such as `head -1`, while nothing more comes.
#[test]
fn a_quiet_port_is_not_kept_open_for_nobody() {
    for arguments in [&["monitor"] as &[&str], &["record", "-"]] {
        let mut device = Device::new();
        let path = device.path.clone();
        let mut arguments = arguments.to_vec();
        arguments.insert(1, &path);
        let mut child = deltarobot(&arguments).stdout(Stdio::piped()).spawn().unwrap();
        sleep(Duration::from_millis(400));
        device.say(b"$h\0\xC6:");
        let mut out = BufReader::new(child.stdout.take().unwrap());
        out.read_line(&mut String::new()).unwrap();
        drop(out);
        let began = Instant::now();
        while child.try_wait().unwrap().is_none() {
            assert!(began.elapsed() < Duration::from_secs(5), "{arguments:?} keeps the port");
            sleep(Duration::from_millis(10));
        }
        assert_eq!(child.wait().unwrap().code(), Some(FINISHED));
    }
    let mut child = deltarobot(&["monitor", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let input = child.stdin.take();
    let began = Instant::now();
    while child.try_wait().unwrap().is_none() {
        assert!(began.elapsed() < Duration::from_secs(5), "it waits for input");
        sleep(Duration::from_millis(10));
    }
    drop(input);
}

#[test]
fn what_is_decoded_may_come_from_standard_input() {
    let mut child = deltarobot(&["decode", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(b"24 53 00\nB1 3A\n").unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(FINISHED), b"STATUS?\n".as_slice()));
}

#[test]
fn the_link_of_a_living_simulator_is_not_taken_over() {
    let link = fresh("cli-living");
    let first = Running::sim(&["--link", utf8(&link)]);
    complains(&["sim", "--link", utf8(&link)], DEVICE, "in use by another program");
    printed(&["status", utf8(&link)], FINISHED);
    drop(first);
}

/// `script` makes the terminal; its name is given as the device.
#[test]
fn ones_own_terminal_is_no_device() {
    if !has_tool("script", "--version") {
        return;
    }
    for name in ["$(tty)", "/dev/tty"] {
        let shell = format!("{} monitor {name}; echo status $?", program().display());
        let output = run(Command::new("timeout").args(["10", "script", "-qec", &shell, "/dev/null"]));
        let said = text(&output);
        assert!(
            said.contains("the terminal that this program runs in") && said.contains("status 3"),
            "{name}: {said:?}"
        );
    }
}

/// Text from the wire must not turn the direction of what follows, nor hide anything.
#[test]
fn nothing_from_the_wire_formats_the_terminal() {
    let line = "c=welcome&name=a\u{202e}b\u{2066}c\u{200f}d\u{feff}e\u{e0041}f\u{2028}g&id=x";
    let is_harmless =
        |said: &str| !said.chars().any(|letter| "\u{202e}\u{2066}\u{200f}\u{feff}\u{e0041}\u{2028}".contains(letter));
    for options in [&[] as &[&str], &["--json"]] {
        let said = printed(&[&["decode", "--protocol", "line"], options, &[line]].concat(), FINISHED);
        assert!(is_harmless(&said) && said.contains("202e"), "{said}");
    }
    let value = json(&["decode", "--protocol", "line", "--json", line], FINISHED);
    assert_eq!(value["line"], line);
    // Nor do names of files, or what is wrong with a recording.
    let (_, output) = outcome(&["monitor", "/nonexistent/a\u{202e}b\x1b[2J"]);
    assert!(is_harmless(&text(&output)) && !text(&output).contains('\x1b'), "{}", text(&output));
}

#[test]
fn garbage_has_all_its_bytes() {
    for (protocol, bytes) in
        [("gx", "78 31 71 20 35 20 09 79 36"), ("gx", "2A 20 09 80"), ("deltarobot", "24 20 09 0A 53")]
    {
        let said = printed(&["decode", "--protocol", protocol, bytes], NOT_DONE);
        assert!(said.starts_with(&format!("garbage: {bytes}")), "{said}");
    }
}

/// In a terminal's live line too.
#[test]
fn progress_of_a_long_recording_is_shown_on_a_terminal() {
    if !has_tool("script", "--version") {
        return;
    }
    let raw = fresh("cli-progress.raw");
    fs::write(&raw, vec![0xFF; 20_000_000]).unwrap();
    let shell = format!("{} monitor {} >/dev/null", program().display(), raw.display());
    let mut child = Command::new("script").args(["-qec", &shell, "/dev/null"]).stdout(Stdio::piped()).spawn().unwrap();
    let mut said = String::new();
    child.stdout.take().unwrap().read_to_string(&mut said).unwrap();
    child.wait().unwrap();
    assert!(said.contains(" % of 19"), "{said:?}");
    fs::remove_file(raw).unwrap();
}
