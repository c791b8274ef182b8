//! `--protocol gx`.

use std::fs;

use serde_json::{Value, json};

use super::talk::Talk;
use super::{FINISHED, NOT_DONE, fresh, json, printed, utf8};

fn decode(arguments: &[&str], status: i32) -> String {
    printed(&[&["decode", "--protocol", "gx"], arguments].concat(), status)
}

mod monitor {
    use super::*;

    /// The vectors of both forms and of ASCII, and what answers them.
    const RECORDING: &str = "# deltarobot recording 1
0.0 > 21 83 E8 87 80 80 98 F8 FF FF 2A 83 81 FF
0.1 > 23 31 32 20 56 31 30 30 30 78 34 30 30 79 33 30 30 0A
0.2 < 23 31 32 0A
0.3 > 23 81 80 2A C1 E8 87 BF
0.4 < 23 81 80
0.5 < 3F 87
0.6 > 7E E8 87
0.7 < 3D 21 83 E8 87 80 80 98 F8 FF FF 3D 78 34 30 30 79 33 30 30 0A
0.8 > 21 83 E8 1B
0.9 > 78 79 0A
";

    fn recording(name: &str) -> String {
        let path = fresh(name);
        fs::write(&path, RECORDING).unwrap();
        utf8(&path).to_owned()
    }

    #[test]
    fn both_directions_in_words() {
        assert_eq!(
            printed(&["monitor", "--protocol", "gx", "--gap", "50", &recording("gx-words.txt")], FINISHED),
            "     0.000 > move  x=1000  y=-1000
     0.000 > step  x=+1  y=-1
     0.100 > #12 move  x=400  y=300  V=1000 (ASCII)
     0.200 < #12 completed (ASCII)
     0.300 > #1 step  x=+63  V=1000
     0.400 < #1 completed
     0.500 < refused  out of range (error 7)
     0.600 > reporting  each 1000 ms
     0.700 < position  x=1000  y=-1000
     0.700 < position  x=400  y=300 (ASCII)
     0.800 > clear
     0.900 > garbage: 78 79 (out of place (error 4))
80 bytes in 0.900 s: 11 messages (1 clear, 2 completed, 2 move, 2 position, 1 refused, 1 reporting, 2 step), \
             2 bytes of garbage, 1 malformed\n"
        );
    }

    #[test]
    fn both_directions_as_json() {
        let said =
            printed(&["monitor", "--protocol", "gx", "--json", "--gap", "50", &recording("gx-json.txt")], FINISHED);
        let values: Vec<Value> = said.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!(
            values[0],
            json!({
                "time": 0.0, "from": "host", "kind": "move", "format": "binary", "number": null, "number_format": null,
                "target": { "x": 1000, "y": -1000 }, "velocity": null, "bytes": "21 83 E8 87 80 80 98 F8 FF FF",
            })
        );
        assert_eq!(values[1]["delta"], json!({ "x": 1, "y": -1 }));
        assert_eq!((&values[2]["number"], &values[2]["velocity"]), (&12.into(), &1000.into()));
        assert_eq!((&values[5]["number"], &values[5]["number_format"]), (&1.into(), &"binary".into()));
        assert_eq!((&values[6]["code"], &values[7]["period_ms"]), (&7.into(), &1000.into()));
        assert_eq!(values[9]["position"], json!({ "x": 400, "y": 300 }));
        assert_eq!((&values[11]["garbage"], &values[11]["from"]), (&"78 79".into(), &"host".into()));
        let statistics = &values[12]["statistics"];
        assert_eq!((&statistics["messages"], &statistics["malformed"]), (&11.into(), &1.into()));
        assert_eq!(statistics["messages_by_kind"]["step"], 2);
    }

    /// Bytes without a direction tell by themselves.
    #[test]
    fn raw_bytes() {
        let raw = fresh("gx.raw");
        fs::write(&raw, b"#12 V1000x400y300\n#12\n=x400y300\n!\x83\xE8\x87\x80\x80\x98\xF8\xFF\xFF#\x81\x80?\x87")
            .unwrap();
        let said = printed(&["monitor", "--protocol", "gx", utf8(&raw)], FINISHED);
        let said: Vec<_> = said.lines().map(|line| line.get(11..).unwrap_or_default()).collect();
        assert_eq!(
            said[..5],
            [
                "> #12 move  x=400  y=300  V=1000 (ASCII)",
                "< #12 completed (ASCII)",
                "< position  x=400  y=300 (ASCII)",
                "> move  x=1000  y=-1000",
                "< #1 refused  out of range (error 7)",
            ]
        );
    }
}

#[test]
fn bytes_and_text_are_decoded() {
    assert_eq!(decode(&["21 83 E8 87 80 80 98 F8 FF FF"], FINISHED), "move  x=1000  y=-1000\n");
    assert_eq!(decode(&["2A", "83", "81", "FF"], FINISHED), "step  x=+1  y=-1\n");
    assert_eq!(
        decode(&["--text", "V1000x400y300", "#12"], FINISHED),
        "move  x=400  y=300  V=1000 (ASCII)\n#12 completed (ASCII)\n"
    );
    assert_eq!(decode(&["2A C0"], NOT_DONE), "garbage: 2A C0 (interrupted (error 3))\n");
    assert_eq!(decode(&["--text", "x134217728"], NOT_DONE).lines().count(), 1);
    assert_eq!(json(&["decode", "--protocol", "gx", "--json", "--text", "R250"], FINISHED)["period_ms"], 250);
    // A number alone is a command that was cut off, if the host sent it.
    assert_eq!(decode(&["23 81 80"], FINISHED), "#1 completed\n");
    assert!(decode(&["23 81 80", "--from", "host"], NOT_DONE).starts_with("garbage: 23 81 80 "));
}

mod sim {
    use super::*;
    use std::time::Instant;

    #[test]
    fn moves_take_their_time_and_are_told_when_completed() {
        let mut talk = Talk::with_sim(&["--protocol", "gx"]);
        talk.say("#1 R0\n");
        assert_eq!(talk.hear_lines(1), ["#1"]);
        let began = Instant::now();
        talk.say("#2 V1000 x300 y400\n");
        talk.say(b"#\x83\x80*\x81\xFF");
        assert_eq!(talk.hear(3), b"#2\n");
        assert!(began.elapsed().as_millis() >= 450, "{:?}", began.elapsed());
        assert_eq!(talk.hear(3), b"#\x83\x80");
        // As long binary, because it was asked for so: here at once, and only once as reports are then off.
        talk.say(b"~\xE8\x87");
        let report = [b"=!\xBF".as_slice(), b"\xAB\x82\x80\x80", b"\x90\x83\x80\x80", &[0x80; 16]].concat();
        assert_eq!(talk.hear(27), report);
    }

    #[test]
    fn errors_are_told() {
        let mut talk = Talk::with_sim(&["--protocol", "gx", "--travel", "100"]);
        for (command, answer) in [
            ("#7x1\n", "#7\n"),
            ("#1R0\n", "#1\n"),
            ("#5462R0\n", "#1\n#5462\n"),
            ("#1R0\n", "#1\n"),
            ("#3x1\n", "#3?16\n"),
            ("#2xyz\n", "#2?4\n"),
            // A session's ends carry a check of where they led: 14 bits, the lower half of them the number's.
            ("#2x5\n", "&12802\n"),
            ("#2x5\n", "&12802\n"),
            ("x1\n", "\n?18\n"),
            ("#3V9999x500\n", "#3?20\n"),
            ("#4x5\n", "#4?17\n"),
            ("\x1B\x1Bx1q\n", "\n?4\n"),
            ("#4x5\n", "#4\n"),
        ] {
            talk.say(command);
            assert_eq!(String::from_utf8(talk.hear(answer.len())).unwrap(), answer, "{command}");
        }
        assert_eq!(talk.hear_for(50), b"");
    }

    #[test]
    fn numbers_may_be_as_the_host_pleases() {
        let mut talk = Talk::with_sim(&["--protocol", "gx", "--velocity", "16000"]);
        talk.say("#7x100\n#7x200\n#3x0\nx300\n");
        assert_eq!(talk.hear_lines(3), ["#7", "#7", "#3"]);
        talk.say("R30\n");
        let reports = talk.hear_lines(4);
        assert_eq!(reports[3], "=x300y0z0a0b0c0");
        talk.say("R0\n");
        talk.hear_for(100);
        assert_eq!(talk.hear_for(100), b"");
    }

    #[test]
    fn it_holds_and_stops() {
        let mut talk = Talk::with_sim(&["--protocol", "gx", "--velocity", "1000"]);
        talk.say("#7x500\n");
        talk.say("%254\n%381\n%508\n");
        let lines = talk.hear_lines(4);
        assert_eq!(lines[..3], ["%271", "%15", "#7?20"]);
        assert!(lines[3].starts_with("=V0x"), "{lines:?}");
        talk.say("#8%127\n");
        assert_eq!(talk.hear_lines(2), ["#8", "%16"]);
    }

    #[test]
    fn or_only_in_order() {
        let mut talk = Talk::with_sim(&["--protocol", "gx", "--only-in-order"]);
        talk.say("#7x1\n");
        assert_eq!(talk.hear_lines(1), ["#7?17"]);
        talk.say("#6R0\n#7x1\n");
        assert_eq!(talk.hear_lines(2), ["#6", "&13191"]);
    }

    #[test]
    fn faults_are_made() {
        let mut talk = Talk::with_sim(&["--protocol", "gx", "--lose", "1"]);
        talk.say("#1R100\n");
        assert_eq!(talk.hear_for(300), b"");
        let mut talk = Talk::with_sim(&["--protocol", "gx", "--disconnect-after", "0.1"]);
        talk.say("\n");
        assert_eq!(talk.sim.child.wait().unwrap().code(), Some(FINISHED));
    }
}
