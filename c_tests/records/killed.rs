//! Programs that are killed while they record. `make faults` does each 20 times.

use super::*;

fn rounds() -> u32 {
    std::env::var("DP_ROUNDS").map_or(1, |rounds| rounds.parse().unwrap())
}

/// Kills one of the two, and gives the file when both are gone.
fn killed(name: &str, kills_converter: bool) -> PathBuf {
    let directory = empty(name);
    let (tap, file) = (directory.join("tap"), directory.join("x.mcap"));
    let (_sim, port) = Running::sim();
    let mut record = Running::start(&["record", &port, utf8(&file), "--tap", "--link", utf8(&tap)]);
    until("the tap", || tap.exists());
    let begun = || fs::metadata(&file).map_or(0, |metadata| metadata.len());
    until("it begins", || begun() > 0);
    let first = begun();
    until("a chunk is there", || {
        ended(&["status", utf8(&tap)], FINISHED);
        begun() > first + 1000
    });
    let id = record.0.id();
    let children = fs::read_to_string(format!("/proc/{id}/task/{id}/children")).unwrap();
    let converter: u32 = children.split_whitespace().next().unwrap().parse().unwrap();
    signal(if kills_converter { converter } else { id }, "KILL");
    if kills_converter {
        until("it ends", || {
            let _ = run(&mut deltarobot(&["status", utf8(&tap)]));
            record.0.try_wait().unwrap().is_some()
        });
        assert_eq!(record.wait(), Some(DEVICE));
    } else {
        record.wait();
        until("the other ends too", || !Path::new(&format!("/proc/{converter}")).exists());
    }
    file
}

#[test]
fn a_record_is_whole_when_the_recorder_is_killed() {
    for _ in 0..rounds() {
        let file = killed("records-killed-recorder", false);
        let output = ended(&["monitor", utf8(&file)], FINISHED);
        let shown = String::from_utf8_lossy(&output.stdout);
        assert!(output.stderr.is_empty() && shown.contains("> STATUS?"), "{}", text(&output));
    }
}

#[test]
fn a_record_is_readable_up_to_its_last_chunk_when_its_writer_is_killed() {
    for _ in 0..rounds() {
        let file = killed("records-killed-writer", true);
        let output = ended(&["monitor", utf8(&file)], FINISHED);
        let (shown, said) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(said.contains("was not ended") && shown.contains("> STATUS?"), "{}", text(&output));
        // Made whole again.
        let whole = file.with_file_name("whole.mcap");
        assert!(
            String::from_utf8_lossy(&ended(&["convert", utf8(&file), utf8(&whole)], FINISHED).stderr).contains("not")
        );
        assert_eq!(printed(&["monitor", utf8(&whole)]).into_bytes(), output.stdout);
    }
}
