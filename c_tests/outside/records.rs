//! Records that `serve` writes.

use super::*;
use crate::programs_built::program;
use crate::support::run;

/// The files in a directory, in their order.
pub(super) fn files(directory: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

pub(super) fn settings(directory: &Path, more: &str) -> String {
    format!("[record]\ndirectory = \"{}\"\n{more}\n", utf8(directory))
}

/// What `deltarobot convert` makes of a file: a table, and what it complains about.
pub(super) fn table(file: &Path) -> (String, String) {
    let convert = program("deltarobot-convert", "deltarobot-records");
    let output = run(Command::new(convert).args([utf8(file), "-", "--to", "csv"]));
    assert_eq!(output.status.code(), Some(0), "{}", support::text(&output));
    (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn are_closed_when_the_program_is_terminated() {
    let directory = empty("closed");
    let server = Server::start(&settings(&directory, ""));
    // One it sends by itself, when it starts.
    until("the robot answers", || server.metric("deltarobot_frames_total{robot=\"sim1\"}") > 1);
    assert_eq!(server.end(), Some(0));
    let files = files(&directory);
    let (table, complaint) = table(&files[0]);
    assert_eq!((files.len(), complaint.as_str()), (1, ""));
    assert!(table.contains(",sim1,host,24 53 00 B1 3A,STATUS?,") && table.contains(",IDLE,"), "{table}");
    assert!(table.contains("\"\"event\"\":\"\"link\"\"") && table.contains("\"\"link\"\":\"\"up\"\""), "{table}");
}

#[test]
fn are_rotated() {
    let directory = empty("rotated");
    let server = Server::start(&settings(&directory, "rotate_after_s = 1"));
    let convert = program("deltarobot-convert", "deltarobot-records");
    let is_whole = |file: &PathBuf| {
        let output = run(Command::new(&convert).args([utf8(file), "-", "--to", "csv"]));
        output.stderr.is_empty() && String::from_utf8_lossy(&output.stdout).contains(",sim1,host,")
    };
    // The last is still written, and one that was short may have no bytes.
    found("two are whole", || {
        (files(&directory).iter().rev().skip(1).filter(|file| is_whole(file)).count() >= 2).then_some(())
    });
    assert_eq!(server.end(), Some(0));
}

#[test]
fn that_can_not_be_written_are_refused_at_once() {
    let file = empty("refused").join("serve.toml");
    fs::write(&file, format!("simulated = 1\nlisten = \"127.0.0.1:0\"\n{}", settings(Path::new("/dev/null/x"), "")))
        .unwrap();
    let output = run(Command::new(env!("CARGO_BIN_EXE_deltarobot-serve")).arg("--config").arg(&file));
    assert_eq!(output.status.code(), Some(3), "{}", support::text(&output));
    assert!(String::from_utf8_lossy(&output.stderr).contains("/dev/null/x: "));
}
