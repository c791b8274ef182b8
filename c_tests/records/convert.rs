//! `deltarobot convert`.

use std::io::Write;

use super::*;

fn sample(name: &str) -> (PathBuf, PathBuf) {
    let directory = empty(name);
    let path = directory.join("sample.txt");
    fs::write(&path, SAMPLE).unwrap();
    (directory, path)
}

#[test]
fn nothing_is_lost_on_the_way_there_and_back() {
    let (directory, source) = sample("records-ways");
    for way in [&["a.mcap"] as &[&str], &["b.csv"], &["c.mcap", "c.csv", "d.mcap", "e.mcap"]] {
        let mut last = source.clone();
        for name in way {
            let next = directory.join(name);
            printed(&["convert", utf8(&last), utf8(&next)]);
            last = next;
        }
        let back = printed(&["convert", utf8(&last), "-", "--to", "text"]);
        // A table has no place for the gap.
        let has_gap = way.iter().all(|name| !name.ends_with("csv"));
        let expected = if has_gap { SAMPLE.to_owned() } else { SAMPLE.replace("# gap 0.05\n", "") };
        assert_eq!(back, expected, "{way:?}");
    }
}

#[test]
fn a_table_has_what_people_look_for() {
    let (_, source) = sample("records-table");
    let table = printed(&["convert", utf8(&source), "-", "--to", "csv"]);
    let rows: Vec<_> = table.lines().collect();
    assert_eq!(rows[0], "time,date,robot,from,bytes,messages,state,a,b,c,stops,event");
    assert_eq!(rows[1], "0.012345,2026-11-28T20:41:15.135801Z,robot,host,24 53 00 B1 3A,STATUS?,,,,,,");
    assert!(rows[2].contains("controller,24 73 0D") && rows[2].ends_with("HOMING,1.0,2.0,-3.5,,"), "{}", rows[2]);
    assert_eq!(rows.len(), 6);
}

#[test]
fn standard_input_and_output() {
    let mut child = deltarobot(&["convert", "-", "-", "--from", "text", "--to", "mcap"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(SAMPLE.as_bytes()).unwrap();
    let mcap = child.wait_with_output().unwrap();
    assert!(mcap.status.success() && mcap.stdout.starts_with(b"\x89MCAP0\r\n"));
    let mut child = deltarobot(&["convert", "-", "-", "--from", "mcap", "--to", "text"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(&mcap.stdout).unwrap();
    let back = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8(back.stdout).unwrap(), SAMPLE);
}

#[test]
fn a_recording_without_dates_has_none_afterwards() {
    let directory = empty("records-undated");
    let (undated, mcap) = (directory.join("x.txt"), directory.join("x.mcap"));
    let lines = "# deltarobot recording 1\n2.500000 > 24 53 00 B1 3A\n3.500000 < FF\n";
    fs::write(&undated, lines).unwrap();
    printed(&["convert", utf8(&undated), utf8(&mcap)]);
    assert_eq!(printed(&["convert", utf8(&mcap), "-", "--to", "text"]), lines);
}

#[test]
fn robots_are_picked() {
    let directory = empty("records-robots");
    let (table, mcap) = (directory.join("x.csv"), directory.join("x.mcap"));
    fs::write(
        &table,
        "robot,time,from,bytes,event\nlab,1,host,24 53 00 B1 3A,\n\"a/b, \"\"c\"\"\",2,controller,FF,\n\
         lab,3,,,\"{\"\"event\"\":\"\"gone\"\"}\"\n",
    )
    .unwrap();
    printed(&["convert", utf8(&table), utf8(&mcap)]);
    complains(&["convert", utf8(&mcap), "-", "--to", "text"], USAGE, "text takes one robot");
    complains(&["convert", utf8(&mcap), "-", "--to", "text", "--robot", "x"], DEVICE, "it has lab, a/b, \"c\"");
    let header = "# deltarobot recording 1\n";
    for (robot, line) in [("lab", "1.000000 > 24 53 00 B1 3A\n"), ("a/b, \"c\"", "2.000000 < FF\n")] {
        let picked = printed(&["convert", utf8(&mcap), "-", "--to", "text", "--robot", robot]);
        assert_eq!(picked, format!("{header}{line}"));
    }
    let table = printed(&["convert", utf8(&mcap), "-", "--to", "csv"]);
    assert!(table.ends_with("3.000000,,lab,,,,,,,,,\"{\"\"event\"\":\"\"gone\"\"}\"\n"), "{table}");
}

#[test]
fn what_is_damaged_is_named_and_the_rest_converted() {
    let (directory, source) = sample("records-damaged");
    let mcap = directory.join("x.mcap");
    fs::write(&source, format!("{SAMPLE}9 < 24 6")).unwrap();
    let said = ended(&["convert", utf8(&source), utf8(&mcap)], FINISHED);
    assert!(String::from_utf8_lossy(&said.stderr).contains("line 9 is damaged and was left out"));
    assert_eq!(printed(&["convert", utf8(&mcap), "-", "--to", "text"]), SAMPLE);

    let whole = fs::read(&mcap).unwrap();
    let cut = directory.join("cut.mcap");
    for length in (0..whole.len()).step_by(97) {
        fs::write(&cut, &whole[..length]).unwrap();
        let output = run(&mut deltarobot(&["convert", utf8(&cut), "-", "--to", "text"]));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!([Some(FINISHED), Some(DEVICE)].contains(&output.status.code()), "{length}: {said}");
        assert!(said.starts_with("deltarobot: "), "{length}: {said}");
        if output.status.success() {
            assert!(said.contains("was not ended") && output.stdout == SAMPLE.as_bytes(), "{length}: {said}");
        }
    }
}

#[test]
fn what_can_not_be_is_refused_in_words() {
    let (directory, source) = sample("records-refused");
    let (there, nowhere) = (directory.join("there.csv"), directory.join("none/x.csv"));
    fs::write(&there, "mine").unwrap();
    complains(&["convert", utf8(&source), utf8(&there)], DEVICE, "File exists; --force overwrites it");
    assert_eq!(fs::read(&there).unwrap(), b"mine");
    complains(&["convert", utf8(&source), utf8(&source), "--force"], DEVICE, "is what is read");
    complains(&["convert", utf8(&source), utf8(&nowhere)], DEVICE, "No such file or directory");
    complains(&["convert", utf8(&source), "-"], USAGE, "--to says what it is");
    complains(&["convert", utf8(&source), "x.csv", "--rotate", "1M"], USAGE, "are for MCAP only");
    complains(&["convert", utf8(&there), "-", "--to", "text"], DEVICE, "`time`, `from` and `bytes`");
    complains(&["convert", utf8(&source), "-", "--to", "text", "--from", "mcap"], DEVICE, "sample.txt: ");
    fs::write(&there, "time,from,bytes\n1,robot,24\n").unwrap();
    complains(&["convert", utf8(&there), "-", "--to", "text"], DEVICE, "line 2: `robot` is neither");
    complains(&["record", "/dev/null", "x.mcap", "--append"], USAGE, "an MCAP file can't be continued");
    printed(&["convert", utf8(&source), utf8(&there), "--force"]);
}

#[test]
fn mcap_is_monitored_and_replayed_like_text() {
    let (directory, source) = sample("records-monitored");
    let mcap = directory.join("x.mcap");
    printed(&["convert", utf8(&source), utf8(&mcap)]);
    for arguments in [&["monitor", "--json", "--time", "utc"] as &[&str], &["monitor"]] {
        let [of_text, of_mcap] = [&source, &mcap].map(|file| printed(&[arguments, &[utf8(file)]].concat()));
        assert_eq!(of_text, of_mcap);
    }
    for side in ["host", "controller"] {
        let bytes = |file| ended(&["replay", "--fast", "--side", side, utf8(file), "-"], FINISHED).stdout;
        assert_eq!(bytes(&source), bytes(&mcap));
    }
    // What was not ended is shown, and said once.
    let whole = fs::read(&mcap).unwrap();
    fs::write(&mcap, &whole[..whole.len() - 9]).unwrap();
    let shown = ended(&["monitor", utf8(&mcap)], FINISHED);
    assert_eq!(shown.stdout, printed(&["monitor", utf8(&source)]).into_bytes());
    let said = String::from_utf8(shown.stderr).unwrap();
    assert!(said.lines().count() == 1 && said.contains("was not ended"), "{said}");
    fs::write(&mcap, &whole[..12]).unwrap();
    complains(&["replay", utf8(&mcap), "-"], DEVICE, "x.mcap: ");
}
