//! `deltarobot record` into MCAP.

use super::*;

/// Bytes without end on a pseudo-terminal: a simulator that is asked again and again.
struct Traffic {
    sim: Running,
    port: String,
}

impl Traffic {
    fn new() -> Self {
        let (sim, port) = Running::sim();
        Self { sim, port }
    }

    /// Asks through a tap until that is so.
    fn until(&self, tap: &Path, what: &str, mut is_so: impl FnMut() -> bool) {
        assert!(!self.port.is_empty() && self.sim.0.id() > 0);
        until("the tap", || tap.exists());
        until(what, || {
            ended(&["status", utf8(tap)], FINISHED);
            is_so()
        });
    }
}

#[test]
fn what_passes_is_recorded() {
    let (directory, traffic) = (empty("records-recorded"), Traffic::new());
    let (tap, file) = (directory.join("tap"), directory.join("x.mcap"));
    let mut record = Running::start(&["record", &traffic.port, utf8(&file), "--tap", "--link", utf8(&tap)]);
    let mut asked = 0;
    traffic.until(&tap, "two requests", || {
        asked += 1;
        asked == 2
    });
    record.signal("INT");
    assert_eq!(record.wait(), Some(FINISHED));
    let shown = printed(&["monitor", utf8(&file)]);
    assert!(shown.matches("> STATUS?").count() >= 2 && shown.contains(" 0 bytes of garbage"), "{shown}");
    complains(&["record", &traffic.port, utf8(&file)], DEVICE, "File exists");
}

#[test]
fn what_waits_is_in_the_file_after_a_second() {
    let (directory, traffic) = (empty("records-flushed"), Traffic::new());
    let (tap, file) = (directory.join("tap"), directory.join("x.mcap"));
    let _record = Running::start(&["record", &traffic.port, utf8(&file), "--tap", "--link", utf8(&tap)]);
    let mut asked = false;
    traffic.until(&tap, "a request", || std::mem::replace(&mut asked, true));
    // It goes on, and nothing more passes.
    until("what was recorded can be read", || {
        let output = run(&mut deltarobot(&["convert", utf8(&file), "-", "--to", "text"]));
        String::from_utf8_lossy(&output.stdout).contains("> 24 53 00 B1 3A")
    });
}

#[test]
fn files_are_rotated_by_size_and_by_time() {
    for options in [["--rotate", "8k"], ["--rotate-after", "0.3"]] {
        let (directory, traffic) = (empty(&format!("records-rotated{}", options[0])), Traffic::new());
        let (tap, file) = (directory.join("tap"), directory.join("x.mcap"));
        let arguments = ["record", &traffic.port, utf8(&file), "--tap", "--link", utf8(&tap), options[0], options[1]];
        let mut record = Running::start(&arguments);
        traffic.until(&tap, "two are full", || directory.join("x.2.mcap").exists());
        record.signal("INT");
        assert_eq!(record.wait(), Some(FINISHED));
        for name in ["x.1.mcap", "x.2.mcap", "x.mcap"] {
            let output = ended(&["convert", utf8(&directory.join(name)), "-", "--to", "text"], FINISHED);
            assert!(output.stderr.is_empty() && output.stdout.starts_with(b"# deltarobot recording 1\n# started 20"));
        }
    }
}

#[test]
fn a_full_disk_is_told() {
    let (directory, traffic) = (empty("records-full"), Traffic::new());
    let (tap, file) = (directory.join("tap"), directory.join("x.mcap"));
    // A limit of the shell's stands for it: writing fails at 16 KiB.
    let program = program("deltarobot", "deltarobot-cli");
    let mut record = Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 32; exec \"$@\"", "sh", utf8(&program), "record", &traffic.port])
        .args([utf8(&file), "--tap", "--link", utf8(&tap)])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    until("the tap", || tap.exists());
    let length = || fs::metadata(&file).map_or(0, |metadata| metadata.len());
    until("it begins", || length() > 0);
    let first = length();
    ended(&["status", utf8(&tap)], FINISHED);
    until("a chunk is there", || length() > first);
    until("it is full", || {
        let _ = run(&mut deltarobot(&["status", utf8(&tap)]));
        record.try_wait().unwrap().is_some()
    });
    let output = record.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(DEVICE), "{said}");
    assert!(said.contains("x.mcap: File too large") && said.contains("x.mcap: not recorded to its end"), "{said}");
    let read = ended(&["convert", utf8(&file), "-", "--to", "text"], FINISHED);
    assert!(String::from_utf8_lossy(&read.stdout).contains("> 24 53 00 B1 3A"));
}
