//! What the mcap package of Python reads.

use super::*;
use crate::support::{is_missing, root};

const SCRIPT: &str = "
import json, sys
from mcap.reader import make_reader, NonSeekingReader
with open(sys.argv[1], 'rb') as file:
    reader = make_reader(file) if sys.argv[2] == 'whole' else NonSeekingReader(file)
    if sys.argv[2] == 'whole':
        summary = reader.get_summary()
        assert summary.statistics.message_count > 0, summary
        for channel in summary.channels.values():
            schema = summary.schemas[channel.schema_id]
            assert channel.message_encoding == 'json' and schema.encoding == 'jsonschema'
            json.loads(schema.data)
    try:
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            print(channel.topic, message.log_time, message.data.decode())
    except Exception as error:
        if sys.argv[2] == 'whole':
            raise
";

/// What it reads of a file, a line for each message; `None` where it is not installed.
fn read(file: &Path, how: &str) -> Option<Vec<String>> {
    let python = has_python_module("mcap")?;
    let output = run(Command::new(python).args(["-c", SCRIPT, utf8(file), how]).current_dir(root()));
    assert!(output.status.success(), "{}", text(&output));
    Some(String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect())
}

#[test]
fn a_file_and_a_part_of_one() {
    let directory = empty("records-python");
    let (source, file, part) = (directory.join("x.txt"), directory.join("x.mcap"), directory.join("part.mcap"));
    fs::write(&source, SAMPLE).unwrap();
    printed(&["convert", utf8(&source), utf8(&file), "--robot", "lab"]);
    let Some(lines) = read(&file, "whole") else { return };
    let of = |topic: &str| lines.iter().filter(|line| line.starts_with(topic)).cloned().collect::<Vec<_>>();
    assert_eq!(of("/lab/bytes ").len(), 5, "{lines:#?}");
    assert!(of("/lab/messages ").iter().any(|line| line.contains("\"opcode\":\"STATUS?\"")), "{lines:#?}");
    let state = "1795898475137158000 {\"position\":[1.0,2.0,-3.5],\"state\":\"HOMING\",\"stops\":[]}";
    assert_eq!(of("/lab/state "), [format!("/lab/state {state}")]);
    // The end is missing, as after kill -9: all messages are there.
    let whole = fs::read(&file).unwrap();
    let index = whole.windows(5).rposition(|window| window == b"/lab/").unwrap();
    fs::write(&part, &whole[..index]).unwrap();
    assert_eq!(read(&part, "part").unwrap(), lines);
}

/// The Python that has this module, of an environment below target/ or the system's: `None` after saying so.
fn has_python_module(module: &str) -> Option<PathBuf> {
    let of_ci = root().join("target/python/bin/python3");
    let mut pythons = [of_ci, "python3".into()].into_iter();
    let has = |python: &PathBuf| {
        let mut command = Command::new(python);
        command.args(["-c", &format!("import {module}")]).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    };
    let found = pythons.find(has);
    if found.is_none() {
        is_missing(&format!("Python's module {module}"));
    }
    found
}
