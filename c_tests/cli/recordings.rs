//! Recordings as they are found: cut off, edited elsewhere, long, in a pipe.

use std::io::Read;
use std::thread::sleep;

use super::device::Device;
use super::*;

const HEADER: &str = "# deltarobot recording 1\n";
const ENTRY: &str = "0.5 > 24 53 00 B1 3A\n";

fn written(name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = fresh(name);
    fs::write(&path, bytes).unwrap();
    path
}

/// What monitor says about a file, and what it complains about.
fn shown(path: &Path) -> (String, String) {
    let (code, output) = outcome(&["monitor", utf8(path)]);
    assert_eq!(code, FINISHED, "{}", text(&output));
    (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn what_is_good_of_a_damaged_one_is_shown_and_replayed() {
    for (place, end) in ["1.0 > 24 5", "1.0 > ", "1", "\0\0\0\0\0\0", "1.0 > 2\0\0"].into_iter().enumerate() {
        let path = written(&format!("cli-cut-{place}.txt"), format!("{HEADER}{ENTRY}{end}"));
        let (said, warned) = shown(&path);
        assert!(said.starts_with("     0.500 > STATUS?\n") && said.contains(" 0 bytes of garbage"), "{end:?}: {said}");
        assert!(warned.contains("line 3 is damaged and was left out"), "{end:?}: {warned}");
        let (code, output) = outcome(&["replay", "--fast", utf8(&path), "-"]);
        assert_eq!((code, output.stdout.as_slice()), (FINISHED, b"$S\0\xB1:".as_slice()), "{end:?}");
    }
}

#[test]
fn editors_and_other_systems_do_no_harm() {
    let whole = format!("{HEADER}{ENTRY}");
    for (name, text) in [
        ("bom", format!("\u{feff}{whole}")),
        ("crlf", whole.replace('\n', "\r\n")),
        ("both", format!("\u{feff}{whole}").replace('\n', "\r\n")),
        ("unended", whole.trim_end().to_owned()),
    ] {
        let (said, warned) = shown(&written(&format!("cli-edited-{name}.txt"), text));
        assert!(said.starts_with("     0.500 > STATUS?\n") && warned.is_empty(), "{name}: {said}{warned}");
    }
}

#[test]
fn a_recording_in_a_pipe_is_shown_as_it_comes() {
    let mut child = deltarobot(&["monitor", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    // The header too may come in pieces.
    for piece in [&HEADER[..7], &HEADER[7..], &ENTRY[..9], &ENTRY[9..]] {
        input.write_all(piece.as_bytes()).unwrap();
        sleep(Duration::from_millis(100));
    }
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
    assert_eq!(lines.next().unwrap(), "     0.500 > STATUS?");
    drop(input);
    assert!(lines.next().unwrap().contains(" 1 frames"));
    child.wait().unwrap();
}

/// `record PORT - | monitor -`.
#[test]
fn what_is_recorded_is_watched() {
    let mut device = Device::new();
    let mut record = deltarobot(&["record", &device.path, "-"]).stdout(Stdio::piped()).spawn().unwrap();
    let recorded = record.stdout.take().unwrap();
    let mut monitor = deltarobot(&["monitor", "-"]).stdin(recorded).stdout(Stdio::piped()).spawn().unwrap();
    sleep(Duration::from_millis(500));
    device.say(b"$h\0\xC6:");
    let mut line = String::new();
    let mut reader = BufReader::new(monitor.stdout.take().unwrap());
    reader.read_line(&mut line).unwrap();
    assert!(line.ends_with(" < HOMING_REPLY\n"), "{line}");
    interrupt(&record);
    record.wait().unwrap();
    monitor.wait().unwrap();
}

/// Peak memory of a run, and how long it took.
fn cost(arguments: &[&str]) -> (u64, Duration) {
    let began = Instant::now();
    let mut child = deltarobot(arguments).stdout(Stdio::null()).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok());
        peak = peak.max(kib.unwrap_or_default());
        sleep(Duration::from_millis(5));
    }
    assert!(child.wait().unwrap().success(), "{arguments:?}");
    (peak, began.elapsed())
}

#[test]
fn length_costs_no_memory() {
    let line = format!("1.5 > 24 53 00 B1 3A{}\n", " FF".repeat(4000));
    let recording = written("cli-long.txt", format!("{HEADER}{}", line.repeat(1500)));
    let raw = written("cli-long.raw", vec![0xFF; 18_000_000]);
    for arguments in [
        &["monitor", utf8(&recording)] as &[&str],
        &["monitor", utf8(&raw)],
        &["replay", "--fast", utf8(&recording), "-"],
    ] {
        let (peak, _) = cost(arguments);
        // (The files have 18 MB.)
        assert!((1..12_000).contains(&peak), "{arguments:?}: {peak} KiB");
    }
    for file in [recording, raw] {
        fs::remove_file(file).unwrap();
    }
}

#[test]
fn dates_are_recorded_and_shown() {
    let path = written(
        "cli-dated.txt",
        format!(
            "{HEADER}# started 2026-11-28T23:59:59.750000Z\n{ENTRY}# continued 2026-11-30T12:00:00Z at 100.5\n101 < FF\n"
        ),
    );
    let said = printed(&["monitor", "--time", "utc", utf8(&path)], FINISHED);
    assert!(said.starts_with("2026-11-29T00:00:00.250Z > STATUS?\n2026-11-30T12:00:00.500Z < garbage: FF\n"), "{said}");
    let local = run(deltarobot(&["monitor", "--time", "local", "--json", utf8(&path)]).env("TZ", "UTC-2"));
    let first: Value = serde_json::from_slice(local.stdout.split(|byte| *byte == b'\n').next().unwrap()).unwrap();
    assert_eq!((&first["date"], &first["time"]), (&"2026-11-29T02:00:00.250+02:00".into(), &0.5.into()));

    let undated = written("cli-undated.txt", format!("{HEADER}{ENTRY}"));
    complains(&["monitor", "--time", "utc", utf8(&undated)], USAGE, "does not say when it was recorded");
}

/// Records a few reports with these options.
fn record(file: &Path, options: &[&str], count: usize) {
    let mut device = Device::new();
    let arguments = [&["record", &device.path, utf8(file)], options].concat();
    let lines = || fs::read_to_string(file).unwrap_or_default().lines().count();
    let before = if options.contains(&"--append") { lines() } else { 0 };
    let mut child = deltarobot(&arguments).spawn().unwrap();
    until("it begins", || lines() > before && !fs::read_to_string(file).unwrap().ends_with("# "));
    sleep(Duration::from_millis(200));
    for _ in 0..count {
        device.say(b"$h\0\xC6:");
        sleep(Duration::from_millis(60));
    }
    interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(FINISHED));
}

#[test]
fn a_recording_is_continued_and_never_overwritten_by_mistake() {
    let file = fresh("cli-append.txt");
    record(&file, &[], 2);
    let first = fs::read_to_string(&file).unwrap();
    assert!(first.starts_with(&format!("{HEADER}# started 20")), "{first}");
    // A crash.
    fs::write(&file, format!("{first}9 < 24 6")).unwrap();
    record(&file, &["--append"], 3);
    let text = fs::read_to_string(&file).unwrap();
    assert!(text.starts_with(&first) && text.contains("\n# continued 20"), "{text}");
    let (said, warned) = shown(&file);
    assert!(said.contains(" 5 frames (5 HOMING_REPLY), 0 bytes of garbage"), "{said}");
    assert!(warned.contains("is damaged"), "{warned}");
    let times: Vec<f64> = said.lines().filter_map(|line| line.trim().split(' ').next()?.parse().ok()).collect();
    assert!(times.is_sorted() && times.len() >= 5, "{said}");

    let sim = Running::sim(&[]);
    complains(&["record", &sim.device, utf8(&file)], DEVICE, "File exists");
    assert_eq!(fs::read_to_string(&file).unwrap(), text);
    record(&file, &["--force"], 1);
    assert!(shown(&file).0.contains(" 1 frames"));
}

#[test]
fn files_are_rotated() {
    let file = fresh("cli-rotate.txt");
    let numbered = |number: u32| file.with_file_name(format!("cli-rotate.txt.{number}"));
    for number in 1..9 {
        let _ = fs::remove_file(numbered(number));
    }
    let mut device = Device::new();
    let mut child = deltarobot(&["record", &device.path, utf8(&file), "--rotate", "1k"]).spawn().unwrap();
    until("it begins", || file.exists());
    sleep(Duration::from_millis(200));
    until("two are full", || {
        device.say(&[0xFF; 100]);
        sleep(Duration::from_millis(10));
        numbered(2).exists()
    });
    interrupt(&child);
    child.wait().unwrap();
    for path in [numbered(1), numbered(2), file.clone()] {
        let (said, warned) = shown(&path);
        assert!(warned.is_empty() && said.contains(" 0 frames"), "{said}{warned}");
    }
    let mut second = String::new();
    fs::File::open(numbered(2)).unwrap().read_to_string(&mut second).unwrap();
    assert!(second.len() >= 1024 && second.contains("# continued 20"), "{second}");
}
