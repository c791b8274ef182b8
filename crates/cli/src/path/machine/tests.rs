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
        assert!(back.iter().zip(pose).all(|(is, wanted)| (is - wanted).abs() < 1e-6), "{back:?}");
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
        ("d_e", "d_f", "line 6: unknown field `d_f`"),
        ("A1 = [0.12, 0.0, 0.10]", "A1 = [0.12, 0.0]", "line 2: "),
        ("A1 = [0.12, 0.0, 0.10]", "A1 = [0.12, inf, 0.10]", "line 2: a point must have coordinates below a million"),
        ("A1 = [0.12, 0.0, 0.10]", "A1 = [0.12, 0.0, 0.40]", "A1, A2 and A3 lie in line"),
        ("d_B1B3 = 0.15", "d_B1B3 = -0.15", "line 5: a length must be from 0 to a million"),
        ("d_B1B3 = 0.15", "d_B1B3 = 0,15", "line 5: "),
        ("scale = 0.001", "scale = 0", "an arm's scale must not be 0"),
        ("max = 600", "max = -1", "an arm's min must be less than its max"),
        ("max = 600", "maximum = 600", "unknown field `maximum`"),
        ("max = 600", "", "missing field `max`"),
        ("[arms.B]", "[arms.D]", "unknown field `D`"),
    ] {
        // The first place that is no comment's.
        let text = text_without_comments();
        assert!(text.contains(from), "{from}");
        let error = Machine::read(&text.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.contains(said), "{to}: {error}");
        // What is wrong with all of it has no line of its own.
        assert!(error.starts_with("line ") || said.contains("lie in line"), "{to}: {error}");
    }
}

/// The example with a blank first line, A1 in line 2.
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
    let nan = EXAMPLE.replacen("max = 600", "max = nan", 1);
    assert!(Machine::read(&nan).unwrap_err().to_string().contains("an arm's min must be less than its max"));
}

#[test]
fn it_is_written_as_it_is_read() {
    let machine = example();
    let json = serde_json::to_string(&machine).unwrap();
    assert!(json.contains("\"d_B1B3\":"), "{json}");
    assert_eq!(serde_json::from_str::<Machine>(&json).unwrap(), machine);
}
