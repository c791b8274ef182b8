use super::{Machine, Reason};

/// The file that users start from.
pub(in super::super) const EXAMPLE: &str = include_str!("../../../../../examples/geometry.toml");

pub(in super::super) fn example() -> Machine {
    Machine::read(EXAMPLE).unwrap()
}

#[test]
fn poses_of_the_documentation() {
    let machine = example();
    for (pose, lengths) in [
        ([0.25, 0.4, 0.25], [0.427_229_4, 0.379_126_6, 0.427_229_4]),
        ([0.2, 0.3, 0.2], [0.296_586_5, 0.301_835_4, 0.349_293_9]),
    ] {
        let displacements = machine.displacements(pose).unwrap();
        for (displacement, length) in displacements.into_iter().zip(lengths) {
            assert!((f64::from(displacement) - (length - 0.2) / 0.001).abs() < 1e-3, "{displacements:?}");
        }
        let back = machine.pose(displacements).unwrap();
        assert!(back.iter().zip(pose).all(|(is, wanted)| (f64::from(*is) - wanted).abs() < 1e-6), "{back:?}");
    }
    assert_eq!(machine.pose([0.0, 1e9, 0.0]), None);
}

#[test]
fn why_a_pose_can_not_be() {
    let machine = example();
    let reason = |pose| machine.displacements(pose).unwrap_err();
    assert_eq!(reason([0.12, 0.0, 0.3]), Reason::NoPose);
    assert_eq!(reason([f64::NAN, 0.4, 0.25]), Reason::NoPose);
    assert_eq!(reason([0.25, -0.4, 0.25]), Reason::Ambiguous);
    let Reason::Arm { arm: 'A', displacement, limit: 600.0 } = reason([0.25, 0.9, 0.25]) else { panic!() };
    assert!(displacement > 600.0);
    let said = reason([0.25, 0.9, 0.25]).to_string();
    assert!(said.starts_with("DA would have to be 7") && said.ends_with(", at most 600 is possible"), "{said}");
    let Reason::Arm { displacement, limit: 0.0, .. } = reason([0.25, 0.16, 0.25]) else { panic!() };
    assert!(displacement < 0.0);
    let near = Reason::Arm { arm: 'B', displacement: -0.001, limit: 0.0 };
    assert_eq!(near.to_string(), "DB would have to be -0.001000, at least 0 is possible");
}

#[test]
fn files_that_make_no_machine() {
    for (from, to, said) in [
        ("edge", "d_B1B3", "line 7: unknown field `d_B1B3`"),
        ("[0.12, 0.0, 0.10]", "[0.12, 0.0]", "line 3: "),
        ("[0.12, 0.0, 0.10]", "[0.12, inf, 0.10]", "line 2: a joint must have coordinates below a million"),
        ("[0.12, 0.0, 0.10]", "[0.12, 0.0, 0.40]", "line 2: the joints A1, A2 and A3 lie in line"),
        ("edge = 0.15", "edge = -0.15", "line 7: a length must be from 0 to a million"),
        ("edge = 0.15", "edge = 0,15", "line 7: "),
        ("scale = 0.001", "scale = 0", "arm A's scale must not be 0"),
        ("max = 600", "max = -1", "arm A's min must be less than its max"),
        ("max = 600", "maximum = 600", "unknown field `maximum`"),
        ("max = 600", "max = nan", "arm A's min must be less than its max"),
        ("[[arms]]", "[[arm]]", "unknown field `arm`"),
    ] {
        // The first place that is no comment's.
        let text = text_without_comments();
        assert!(text.contains(from), "{from}");
        let error = Machine::read(&text.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.contains(said), "{to}: {error}");
        assert!(error.starts_with("line "), "{to}: {error}");
    }
}

/// The example with a blank first line, the joints in line 2.
fn text_without_comments() -> String {
    let lines: Vec<_> = EXAMPLE.lines().map(|line| line.split('#').next().unwrap_or_default().trim_end()).collect();
    let lines: Vec<_> = lines.into_iter().filter(|line| !line.is_empty()).collect();
    format!("\n{}\n", lines.join("\n"))
}

#[test]
fn limits_may_be_none() {
    let text = EXAMPLE.replace("max = 600", "max = inf").replace("min = 0 ", "min = -inf ");
    let machine = Machine::read(&text).unwrap();
    let [a, b, c] = machine.displacements([0.25, 0.9, 0.25]).unwrap();
    assert!(a > 700.0 && b > 600.0 && c > 700.0, "{a} {b} {c}");
    let json = serde_json::to_string(&machine).unwrap();
    assert!(!json.contains("null") && !json.contains("max"), "{json}");
    // Unlike what was left out, which may have been forgotten.
    assert!(machine.has_limits() && !serde_json::from_str::<Machine>(&json).unwrap().has_limits());
}

#[test]
fn it_is_written_as_it_is_read() {
    let machine = example();
    let json = serde_json::to_string(&machine).unwrap();
    assert!(json.contains("\"edge\":0.15"), "{json}");
    assert_eq!(serde_json::from_str::<Machine>(&json).unwrap(), machine);
    let plain = serde_json::from_str::<Machine>(r#"{"joints":[[0,0,0],[0,1,0],[1,0,0]],"edge":1,"offset":0}"#).unwrap();
    let lengths = plain.displacements([0.0, 0.0, 5.0]).unwrap();
    assert!(plain.pose(lengths).is_some() && !plain.has_limits(), "{lengths:?}");
}
