//! `--protocol line`.

use std::fs;
use std::io::Write;
use std::process::Stdio;

use serde_json::{Value, json};

use super::talk::Talk;
use super::{DEVICE, FINISHED, NOT_DONE, deltarobot, fresh, json, printed, utf8};

/// The sample communication of the page "Ozeki Line Protocol".
const SAMPLE: &str = include_str!("sample.txt");

/// Its lines, with who sends them.
fn sample() -> Vec<(char, &'static str)> {
    SAMPLE.lines().map(|line| (if line.starts_with("->") { '>' } else { '<' }, &line[4..])).collect()
}

/// A recording of lines, a second apart.
fn recording(name: &str, lines: &[(char, &str)]) -> String {
    let entries = lines.iter().enumerate().map(|(place, (arrow, line))| {
        let bytes: Vec<_> = line.bytes().chain([b'\n']).map(|byte| format!("{byte:02X}")).collect();
        format!("{place}.5 {arrow} {}", bytes.join(" "))
    });
    let text: Vec<_> = ["# deltarobot recording 1".to_owned()].into_iter().chain(entries).collect();
    let path = fresh(name);
    fs::write(&path, text.join("\n") + "\n").unwrap();
    utf8(&path).to_owned()
}

mod monitor {
    use super::*;

    #[test]
    fn the_sample_in_words() {
        let path = recording("line-words.txt", &sample());
        let said = printed(&["monitor", "--protocol", "line", &path], FINISHED);
        let lines: Vec<_> = said.lines().collect();
        assert_eq!(lines.len(), 32);
        for (place, line) in [
            (0, "     0.500 < welcome  id=0uAAly  type=OzekiIDManager  pos=1  version=1.0.0"),
            (7, "     7.500 < motorsnumber  count=4  id=6O1KiA (OzekiStepperMotorMultiController)  t=0"),
            (12, "    12.500 < welcome  type=Ozeki3DPrinterDisc  id=OZPDSC  version=1.0.0"),
            (13, "    13.500 > setpushinfo  interval=2000  state=1  t=0  id=M1F910 (HeaterExt1)"),
            (14, "    14.500 < setpushinfo_resp  state=1  interval=2000  id=M1F910 (HeaterExt1)  t=1"),
            (15, "    15.500 < heaterinfo  temp=110.44  desiredtemp=-1000.00  state=0  id=M1F910 (HeaterExt1)  t=2"),
            (24, "    24.500 > setswitch  state=1  t=11  id=9o5qzg (FanExt1)"),
            (25, "    25.500 < setswitch_resp  state=1  pwm=254  id=9o5qzg (FanExt1)  t=12"),
            (
                31,
                "2151 bytes in 30.500 s: 31 lines (12 heaterinfo, 4 motordetails, 1 motorsnumber, 1 setpushinfo, \
                 1 setpushinfo_resp, 2 setswitch, 2 setswitch_resp, 8 welcome), 0 bytes of garbage, 0 wrong checksums",
            ),
        ] {
            assert_eq!(lines[place], line);
        }
    }

    #[test]
    fn the_sample_as_json() {
        let path = recording("line-json.txt", &sample());
        let said = printed(&["monitor", "--protocol", "line", "--json", &path], FINISHED);
        let values: Vec<Value> = said.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        for (value, (arrow, line)) in values.iter().zip(sample()) {
            assert_eq!(value["line"], line);
            assert_eq!(value["from"], if arrow == '>' { "host" } else { "controller" });
            // The parameters in their order, from which the line can be built again.
            let param =
                |param: &Value| format!("{}={}", param["name"].as_str().unwrap(), param["value"].as_str().unwrap());
            let params: Vec<_> = value["params"].as_array().unwrap().iter().map(param).collect();
            let built = format!("c={}&{}", value["command"].as_str().unwrap(), params.join("&"));
            assert_eq!(built, line);
        }
        let heater = &values[15];
        assert_eq!(
            (&heater["id"], &heater["device"], &heater["t"], &heater["checksum"]),
            (&"M1F910".into(), &"HeaterExt1".into(), &2.into(), &Value::Null)
        );
        let statistics = &values.last().unwrap()["statistics"];
        assert_eq!((&statistics["lines"], &statistics["bytes"]), (&31.into(), &2151.into()));
        assert_eq!(statistics["lines_by_command"]["welcome"], 8);
    }

    #[test]
    fn what_is_damaged_is_named() {
        let damaged = [
            ('>', "c=setswitch&state=0&t=11&id=9o5qzg&s=a3d6"),
            ('>', "c=setswitch&state=1&t=11&id=9o5qzg&s=a3d6"),
            ('<', "c=heaterinfo&temp=1%4"),
            ('<', "onerror"),
            ('>', "c=go&x=10&y=10&z=10&a=50&b=50&c=50&spd=100&eas=1&t=0&id=IqlZci&s=0000"),
        ];
        let path = recording("line-damaged.txt", &damaged);
        let said = printed(&["monitor", "--protocol", "line", &path], FINISHED);
        assert_eq!(
            said,
            "     0.500 > setswitch  state=0  t=11  id=9o5qzg  s=a3d6 (checksum a3d6 instead of 93d5)\n     \
             1.500 > setswitch  state=1  t=11  id=9o5qzg  s=a3d6\n     \
             2.500 < garbage: c=heaterinfo&temp=1%4 (a damaged escape)\n     \
             3.500 < garbage: onerror (c is not the first parameter)\n     \
             4.500 > go  x=10  y=10  z=10  a=50  b=50  c=50  spd=100  eas=1  t=0  id=IqlZci  s=0000 \
             (checksum 0000 instead of 3347) (70 bytes: longer than 64)\n\
             184 bytes in 4.500 s: 1 lines (1 setswitch), 142 bytes of garbage, 2 wrong checksums\n"
        );
        let said = printed(&["monitor", "--protocol", "line", "--json", &path], FINISHED);
        let values: Vec<Value> = said.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!((&values[0]["checksum"], &values[0]["sum"]), (&"wrong".into(), &"93d5".into()));
        assert_eq!((&values[1]["checksum"], &values[1]["sum"]), (&"right".into(), &"a3d6".into()));
        assert_eq!(values[2]["reason"], "a damaged escape");
        assert_eq!(values[4]["too_long"], true);
        assert_eq!(values[5]["statistics"]["checksum_failures"], 2);
    }

    #[test]
    fn text_from_the_wire_does_not_control_the_terminal() {
        // ESC, DEL and CSI as it is in UTF-8, which some terminals obey: written with escapes, and as they are.
        let lines = ["c=welcome&name=%1B[2J%7F%C2%9B2J&id=a\x1Bc\x7F\u{9b}2J", "c=\x1B\x7F\u{9b}%&x", "c=\u{9b}2J"];
        let path = recording("line-control.txt", &lines.map(|line| ('<', line)));
        let can_control = |said: &str| said.contains(|letter: char| letter.is_control() && letter != '\n');
        let as_json = |source: &[&str], status| {
            let said = printed(&[source, &["--protocol", "line", "--json"]].concat(), status);
            assert!(!can_control(&said), "{said:?}");
            said.lines().map(|line| serde_json::from_str(line).unwrap()).collect::<Vec<Value>>()
        };
        let watched = as_json(&["monitor", &path], FINISHED);
        assert_eq!(watched.last().unwrap()["statistics"]["lines_by_command"]["\\u{9b}2J"], 1);
        for values in [watched, as_json(&[&["decode"] as &[&str], &lines].concat(), NOT_DONE)] {
            assert_eq!((&values[0]["line"], &values[2]["line"]), (&lines[0].into(), &lines[2].into()));
        }
        let said = printed(&["monitor", "--protocol", "line", &path], FINISHED);
        assert!(!can_control(&said) && said.contains("name=\\u{1b}[2J\\u{7f}\\u{9b}2J  id=a\\u{1b}c"), "{said:?}");
    }

    #[test]
    fn standard_input_in_portions() {
        let mut child = deltarobot(&["monitor", "-", "--protocol", "line", "--from", "controller"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut input = child.stdin.take().unwrap();
        for portion in ["c=heater", "info&temp=20%2e5&id=a", "\r\n\r\nc=ack&t=", "1"] {
            input.write_all(portion.as_bytes()).unwrap();
            std::thread::sleep(std::time::Duration::from_millis(120));
        }
        drop(input);
        let said = String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap();
        let said: Vec<_> = said.lines().map(|line| line.get(11..).unwrap_or_default()).collect();
        assert_eq!(said[..2], ["< heaterinfo  temp=20.5  id=a", "< garbage: c=ack&t=1 (without an end)"]);
    }

    #[test]
    fn a_device_is_watched() {
        let mut talk = Talk::with_sim(&["--protocol", "line"]);
        talk.close();
        let file = fresh("line-device.txt");
        let mut record = deltarobot(&["record", &talk.sim.device, utf8(&file)]).spawn().unwrap();
        super::super::until("it was welcomed", || {
            fs::read_to_string(&file).is_ok_and(|text| text.contains("63 3D 77 65 6C 63 6F 6D 65"))
        });
        super::super::interrupt(&record);
        assert_eq!(record.wait().unwrap().code(), Some(FINISHED));
        let statistics = json(&["monitor", "--protocol", "line", "--json", utf8(&file)], FINISHED);
        assert_eq!(statistics["statistics"]["lines_by_command"], json!({ "welcome": 4 }));
    }
}

#[test]
fn lines_are_decoded() {
    let decode = |line: &str, status| printed(&["decode", "--protocol", "line", line], status);
    assert_eq!(
        decode("c=setswitch&state=1&t=11&id=9o5qzg&s=a3d6", FINISHED),
        "setswitch  state=1  t=11  id=9o5qzg  s=a3d6\n"
    );
    assert!(
        decode("c=setswitch&state=1&t=11&id=9o5qzg&s=a3d7", NOT_DONE).ends_with("(checksum a3d7 instead of a3d6)\n")
    );
    assert_eq!(decode("c=x&name=St%C3%A9p+1", FINISHED), "x  name=St\u{e9}p 1\n");
    let several = ["decode", "--protocol", "line", "--json", "c=a", "c=ack&checksum=null&t=255&id=M1F910"];
    assert_eq!(json(&several, FINISHED)["t"], 255);
}

mod sim {
    use super::*;

    const WELCOMES: [&str; 4] = [
        "c=welcome&id=0uAAly&type=OzekiIDManager&pos=1&version=1.0.0",
        "c=welcome&id=M1F910&type=OzekiTemperatureController&pos=2&name=HeaterExt1&version=1.0.0",
        "c=welcome&id=9o5qzg&type=OzekiSwitchController&pos=3&name=FanExt1&version=1.0.0",
        "c=welcome&id=3Mx14T&type=OzekiButtonController&pos=4&name=StopYmin&version=1.0.0",
    ];

    fn welcomed(arguments: &[&str]) -> Talk {
        let mut talk = Talk::with_sim(&[&["--protocol", "line", "--press", "1000"], arguments].concat());
        assert_eq!(talk.hear_lines(4), WELCOMES);
        talk
    }

    /// What is answered to a line, in so many lines.
    fn answers(talk: &mut Talk, line: &str, count: usize) -> Vec<String> {
        talk.say(format!("{line}\n"));
        talk.hear_lines(count)
    }

    #[test]
    fn commands_are_answered() {
        let mut talk = welcomed(&[]);
        assert_eq!(
            answers(&mut talk, "c=setswitch&state=1&t=11&id=9o5qzg", 1),
            ["c=setswitch_resp&state=1&pwm=254&id=9o5qzg&t=12"]
        );
        // The same line with the same t is a repeat: it has the same answer.
        assert_eq!(
            answers(&mut talk, "c=setswitch&state=1&t=11&id=9o5qzg", 1),
            ["c=setswitch_resp&state=1&pwm=254&id=9o5qzg&t=12"]
        );
        for (line, answer) in [
            ("c=setswitch&state=5&t=13&id=9o5qzg", "c=onerror&code=refused&t=13&id=9o5qzg"),
            ("c=setswitch&state=1&t=14&id=M1F910", "c=onerror&code=unknowncommand&t=14&id=M1F910"),
            ("c=go&x=1&t=15&id=M1F910", "c=onerror&code=unknowncommand&t=15&id=M1F910"),
            ("c=setswitch&state=1&t=16&id=nobody", "c=onerror&code=unknownid&t=16&id=nobody"),
            ("x=1", "c=onerror&code=malformed&t=17&id=0uAAly"),
            (
                "c=setswitch&state=1&t=18&id=9o5qzg&comment=this.is.longer.than.the.79.bytes.of.a.device.with.its.line.feed",
                "c=onerror&code=overflow&t=18&id=0uAAly",
            ),
        ] {
            assert_eq!(answers(&mut talk, line, 1), [answer], "{line}");
        }
        assert_eq!(talk.hear_for(50), b"");
    }

    #[test]
    fn linksetup_puts_acks_and_checksums_in_force() {
        let mut talk = welcomed(&[]);
        // The example of the page, but for the id.
        let setup = "c=linksetup&ack=on&checksum=fletcher16&t=2&id=0uAAly";
        assert_eq!(
            answers(&mut talk, setup, 2),
            ["c=ack&checksum=c2af&t=2&id=0uAAly", "c=linksetup_resp&ack=on&checksum=fletcher16&id=0uAAly&t=3"]
        );
        assert_eq!(
            answers(&mut talk, "c=setswitch&state=1&t=11&id=9o5qzg&s=A3D6", 2),
            ["c=ack&checksum=a3d6&t=11&id=9o5qzg", "c=setswitch_resp&state=1&pwm=254&id=9o5qzg&t=12"]
        );
        for line in ["c=setswitch&state=0&t=13&id=9o5qzg&s=a3d6", "c=setswitch&state=0&t=13&id=9o5qzg"] {
            let answer = answers(&mut talk, line, 1);
            assert!(answer[0].starts_with("c=onerror&code=checksum&"), "{answer:?}");
        }
        assert_eq!(talk.hear_for(50), b"");
        // Opened again, which it has to notice, it begins anew: without acks.
        talk.close();
        std::thread::sleep(std::time::Duration::from_millis(300));
        talk.open();
        assert_eq!(talk.hear_lines(4), WELCOMES);
        assert_eq!(
            answers(&mut talk, "c=setswitch&state=0&t=0&id=9o5qzg", 1),
            ["c=setswitch_resp&state=0&pwm=254&id=9o5qzg&t=1"]
        );
    }

    #[test]
    fn the_device_may_set_the_link_up_itself() {
        let mut talk = welcomed(&["--ack", "--window", "4"]);
        assert_eq!(talk.hear_lines(1), ["c=linksetup&windowsize=4&ack=on&checksum=none&t=0&id=0uAAly"]);
        talk.say("c=setswitch&state=1&t=1&id=9o5qzg\nc=setswitch&state=0&t=2&id=9o5qzg\n");
        assert_eq!(
            talk.hear_lines(4),
            [
                "c=ack&checksum=null&t=1&id=9o5qzg",
                "c=setswitch_resp&state=1&pwm=254&id=9o5qzg&t=2",
                "c=ack&checksum=null&t=2&id=9o5qzg",
                "c=setswitch_resp&state=0&pwm=254&id=9o5qzg&t=3"
            ]
        );
    }

    #[test]
    fn heater_and_button_tell() {
        let mut talk = welcomed(&[]);
        assert_eq!(
            answers(&mut talk, "c=setpushinfo&interval=40&state=1&t=0&id=M1F910", 1),
            ["c=setpushinfo_resp&state=1&interval=40&id=M1F910&t=1"]
        );
        let reports = talk.hear_lines(3);
        for (report, t) in reports.iter().zip(2..) {
            assert_eq!(*report, format!("c=heaterinfo&temp=20.00&desiredtemp=-1000.00&state=0&id=M1F910&t={t}"));
        }
        talk.say("c=settemp&temp=200&id=M1F910\n");
        let lines = talk.hear_lines(20);
        assert!(lines.iter().any(|line| line.starts_with("c=settemp_resp&temp=200.00&")), "{lines:?}");
        let last = lines.last().unwrap();
        assert!(last.contains("&desiredtemp=200.00&state=1&") && !last.contains("temp=20.00"), "{last}");

        let mut talk = Talk::with_sim(&["--protocol", "line", "--press", "0.1"]);
        let lines = talk.hear_lines(8);
        assert_eq!(lines[4..6], ["c=button&pressed=1&id=3Mx14T&t=0", "c=button&pressed=0&id=3Mx14T&t=1"]);
    }

    #[test]
    fn faults_are_made() {
        let mut talk = Talk::with_sim(&["--protocol", "line", "--lose", "1"]);
        talk.say("c=setswitch&state=1&t=11&id=9o5qzg\n");
        assert_eq!(talk.hear_for(300), b"");

        let spoilt = || {
            let mut talk = Talk::with_sim(&["--protocol", "line", "--flip", "0.05", "--seed", "3"]);
            talk.hear(300)
        };
        let first = spoilt();
        assert_ne!(first, format!("{}\n", WELCOMES.join("\n")).into_bytes()[..300]);
        assert_eq!(spoilt(), first);

        let mut talk = welcomed(&["--disconnect-after", "0.1"]);
        talk.say("\n");
        assert_eq!(talk.sim.child.wait().unwrap().code(), Some(FINISHED));
        super::super::complains(&["monitor", "--protocol", "line", &talk.sim.device], DEVICE, "No such file");
    }
}
