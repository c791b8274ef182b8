//! `deltarobot path`: files of each format, checked and traced.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::io::Read;

use super::*;

/// Where drawings of a hundred millimetres lie within reach: upright before the robot, to the right along x.
const PLANE: [&str; 12] = ["--origin", "0.2", "0.45", "0.2", "--right", "1", "0", "0", "--up", "0", "0", "1"];

fn geometry() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/geometry.toml").to_str().unwrap().to_owned()
}

fn file(name: &str, text: &str) -> String {
    let path = fresh(name);
    fs::write(&path, text).unwrap();
    utf8(&path).to_owned()
}

/// Circles of 30 mm about 50, 50: in each format the same.
fn circles() -> [String; 3] {
    let mut csv = String::from("x,y,z\n");
    for step in 0..=360 {
        let angle = f64::from(step) / 360.0 * TAU;
        writeln!(csv, "{:.6},{:.6},0", 50.0 + 30.0 * angle.cos(), 50.0 + 30.0 * angle.sin()).unwrap();
    }
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100'>\n\
        <circle cx='50' cy='50' r='30'/>\n</svg>\n";
    let gcode = "G21 G90 (a circle)\nN1 G0 X80 Y50\nN2 G3 I-30 F1000 ; all around\n";
    [file("cli-path.csv", &csv), file("cli-path.svg", svg), file("cli-path.gcode", gcode)]
}

/// The subcommand with a file, the example's geometry and the plane.
fn path<'a>(file: &'a str, geometry: &'a str, options: &[&'a str]) -> Vec<&'a str> {
    [&["path", file, "--geometry", geometry], PLANE.as_slice(), options].concat()
}

/// A robot that is homed, and takes no time for a few hundred moves.
fn fast() -> Running {
    let sim = Running::sim(&["--speed", "20000"]);
    printed(&["home", &sim.device], FINISHED);
    sim
}

/// Asserts that a drawing is one, and returns its outlines of a class.
fn outlines(plot: &Path, class: &str) -> Vec<String> {
    let text = fs::read_to_string(plot).unwrap();
    let document = roxmltree::Document::parse(&text).unwrap();
    assert_eq!(document.root_element().tag_name().name(), "svg");
    let of_class = document.descendants().filter(|node| node.attribute("class") == Some(class));
    of_class.filter_map(|node| node.attribute("d")).map(str::to_owned).collect()
}

#[test]
fn a_circle_in_each_format_is_traced() {
    let sim = fast();
    let geometry = geometry();
    for (file, scale) in circles().iter().zip([Some("0.001"), None, None]) {
        let plot = fresh("cli-path-plot.svg");
        let mut options = vec![sim.device.as_str(), "--json", "--plot", utf8(&plot)];
        options.extend(scale.iter().flat_map(|scale| ["--scale", scale]));
        let traced = json(&path(file, &geometry, &options), FINISHED);
        assert_eq!(traced["outcome"], "finished", "{traced}");
        assert_eq!(
            (&traced["unreachable"], &traced["reached"]),
            (&serde_json::json!([]), &traced["moves"]),
            "{traced}"
        );
        let drawn = traced["drawn"].as_f64().unwrap();
        assert!((drawn - 0.06 * TAU / 2.0).abs() < 0.002, "{traced}");
        // The robot stops where it shall, to within what floats round.
        let errors = &traced["errors"];
        let (mean, max) = (errors["mean"].as_f64().unwrap(), errors["max"].as_f64().unwrap());
        assert!(0.0 < mean && mean <= max && max < 1e-5, "{traced}");
        assert_eq!(
            outlines(&plot, "reached")[0].matches('L').count() + 1,
            usize::try_from(traced["reached"].as_u64().unwrap()).unwrap()
        );
        assert_eq!(outlines(&plot, "unreachable").len(), 1, "in the legend only");
    }
    let (_, output) = outcome(&path(&circles()[1], &geometry, &[&sim.device]));
    let said = text(&output);
    assert!(said.contains("path finished after ") && said.contains(" m on average, "), "{said}");
    // Above the circle's right end, where the drawing's pen is lifted by 10 mm towards the base.
    let pose = json(&["status", &sim.device, "--geometry", &geometry, "--json"], FINISHED)["pose"].clone();
    for (is, wanted) in [0, 1, 2].map(|axis| pose[axis].as_f64().unwrap()).into_iter().zip([0.28, 0.44, 0.25]) {
        assert!((is - wanted).abs() < 1e-5, "{pose}");
    }
    let said = printed(&["status", &sim.device, "--geometry", &geometry], FINISHED);
    assert!(said.ends_with("  x=0.28 y=0.44 z=0.25\n"), "{said}");
}

#[test]
fn a_move_by_the_platforms_position() {
    let (sim, geometry) = (fast(), geometry());
    let by = |numbers: [&'static str; 3]| {
        [&["move", "--position"], &numbers[..], &["--geometry", &geometry, &sim.device]].concat()
    };
    let said = printed(&by(["0.25", "0.4", "0.25"]), FINISHED);
    assert!(said.contains("DA=227.229 ") && said.ends_with("  x=0.25 y=0.4 z=0.25\n"), "{said}");
    complains(&by(["0.25", "0.9", "0.25"]), USAGE, "unreachable: DA would have to be ");
    complains(&["move", "--position", "0.25", "0.4", "0.25", &sim.device], USAGE, "--geometry <FILE>");
}

#[test]
fn checking_needs_no_port() {
    let geometry = geometry();
    for (file, scale) in circles().iter().zip(["0.001"; 3]) {
        let said = printed(&path(file, &geometry, &["--check", "--scale", scale]), FINISHED);
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(said.contains(" moves, 0.188") && said.contains(" m drawn, "), "{said}");
    }
}

#[test]
fn what_is_unreachable_is_listed_and_not_begun() {
    let geometry = geometry();
    let points =
        file("cli-path-far.csv", "# into the distance\n0.25,0.4,0.25\n0.25,0.9,0.25\n0.25,0.5,0.25\n0.25,0.5,0.3\n");
    let plot = fresh("cli-path-far.svg");
    let check = ["path", &points, "--geometry", &geometry, "--check"];
    let said = printed(&[&check[..], &["--plot", utf8(&plot)]].concat(), NOT_DONE);
    assert!(said.contains("\nlines 2 to 4: unreachable from 0.2500 0.7"), "{said}");
    assert!(said.contains("DA would have to be ") && said.contains(", at most 600 is possible"), "{said}");
    assert_eq!(outlines(&plot, "unreachable").len(), 2);
    let value = json(&[&check[..], &["--json"]].concat(), NOT_DONE);
    let part = &value["unreachable"][0];
    assert_eq!((&value["outcome"], &part["lines"]), (&"unreachable".into(), &serde_json::json!([2, 4])), "{value}");

    let sim = fast();
    complains_besides(&["path", &points, "--geometry", &geometry, &sim.device], NOT_DONE, "nothing was moved");
    assert!(printed(&["status", &sim.device], FINISHED).starts_with("IDLE  DA=0  DB=0  DC=0"));
}

/// Asserts that it complains so, whatever it prints.
fn complains_besides(arguments: &[&str], status: i32, about: &str) {
    let (code, output) = outcome(arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(code == status && said.contains(about), "{arguments:?}: {}", text(&output));
}

#[test]
fn what_is_wrong_with_a_file_is_told_with_its_line() {
    let geometry = geometry();
    for (name, content, about) in [
        ("bad.csv", "x,y,z\n1,2,3\n1,two,3\n", "bad.csv: line 3: `two` is not a number"),
        ("bad.svg", "<svg>\n<path d='M0 0 W'/>\n</svg>", "bad.svg: line 2: d: "),
        ("bad2.svg", "<svg>\n<text>hello</text>\n</svg>", "line 2: text is not supported"),
        ("bad.nc", "G0 X1\nM3 S100\n", "bad.nc: line 2: M3 is not supported"),
        ("bad.dat", "1,2,3\n", "what is it? --format says so"),
        ("long.csv", "0.2,0.4,0.2\n1e9,0,0\n", "line 2: the path is too long for a machine of this size"),
    ] {
        let name = file(&format!("cli-path-{name}"), content);
        complains(&["path", &name, "--geometry", &geometry, "--check"], USAGE, about);
    }
    let points = file("cli-path-good.csv", "0.25,0.4,0.25\n");
    let wrong = fs::read_to_string(&geometry).unwrap().replace("max = 600", "max = -600");
    let line = wrong.lines().position(|line| line == "[[arms]]").unwrap() + 1;
    let wrong = file("cli-path-geometry.toml", &wrong);
    complains(
        &["path", &points, "--geometry", &wrong, "--check"],
        USAGE,
        &format!("geometry.toml: line {line}: arm A's min"),
    );
    let unlimited = fs::read_to_string(&geometry).unwrap().replacen("max = 600", "", 1);
    let unlimited = file("cli-path-unlimited.toml", &unlimited);
    complains(&["path", &points, "--geometry", &unlimited, "--check"], USAGE, "each arm's min and max");
    complains(&["path", &points, "--geometry", "/nonexistent", "--check"], DEVICE, "/nonexistent: No such file");
    complains(
        &["path", "/nonexistent.csv", "--geometry", &geometry, "--check"],
        DEVICE,
        "/nonexistent.csv: No such file",
    );
    complains(&["path", &points, "--geometry", &geometry], USAGE, "a <PORT> is needed");
    complains(
        &["path", &points, "--geometry", &geometry, "--check", "--tolerance", "0"],
        USAGE,
        "must be at least 0.00001",
    );
    complains(
        &["path", &points, "--geometry", &geometry, "--check", "--up", "-2", "0", "0"],
        USAGE,
        "directions to the right and up",
    );
    let value = json(&["path", &points, "--geometry", &geometry, "--json", "/nonexistent/tty"], DEVICE);
    assert_eq!(value["outcome"], "error");
}

#[test]
fn a_path_from_standard_input() {
    let geometry = geometry();
    let mut child = deltarobot(&["path", "-", "--format", "csv", "--geometry", &geometry, "--check"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(b"0.25 0.4 0.25\n0.25 0.4 0.35").unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(FINISHED));
    assert!(String::from_utf8(output.stdout).unwrap().contains("2 points, "));
}

#[test]
fn a_robot_that_does_not_know_its_position_is_not_moved() {
    let sim = Running::sim(&[]);
    complains_besides(&path(&circles()[1], &geometry(), &[&sim.device]), NOT_DONE, "has to home first");
}

#[test]
fn a_controller_that_fails_ends_it() {
    // Its geometry says that the arms can go below their end stops.
    let text = fs::read_to_string(geometry())
        .unwrap()
        .replace("min = 0", "min = -600")
        .replace("offset = 0.2", "offset = 0.4");
    let wrong = file("cli-path-stops.toml", &text);
    let points = file("cli-path-stops.csv", "0.25,0.5,0.25\n0.25,0.3,0.25\n");
    let sim = fast();
    let value = json(&["path", &points, "--geometry", &wrong, &sim.device, "--json"], NOT_DONE);
    assert_eq!(value["outcome"], "failed", "{value}");
    let (reached, moves) = (value["reached"].as_u64().unwrap(), value["moves"].as_u64().unwrap());
    assert!(0 < reached && reached < moves, "{value}");
}

/// With arms so fine that the first move takes minutes.
#[test]
fn ctrl_c_cancels_the_motion() {
    let sim = homed();
    let text = fs::read_to_string(geometry())
        .unwrap()
        .replace("scale = 0.001", "scale = 0.000001")
        .replace("max = 600", "max = 600000");
    let fine = file("cli-path-fine.toml", &text);
    let recording = fresh("cli-path-recording.txt");
    let tap = Running::start(&["record", &sim.device, utf8(&recording), "--tap"]);
    let (svg, plot) = (circles()[1].clone(), fresh("cli-path-cancelled.svg"));
    let mut child = deltarobot(&path(&svg, &fine, &[&tap.device, "--json", "--plot", utf8(&plot)]))
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    until("it moves", || fs::read_to_string(&recording).is_ok_and(|text| text.matches(" < 24 73").count() > 5));
    interrupt(&child);
    let mut said = String::new();
    child.stdout.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(CANCELLED), "{said}");
    let value: Value = serde_json::from_str(&said).unwrap();
    assert_eq!((&value["outcome"], &value["reached"]), (&"cancelled".into(), &0.into()), "{value}");
    assert!(!outlines(&plot, "drawn").is_empty());
    drop(tap);
    assert!(printed(&["status", &sim.device], FINISHED).starts_with("IDLE  "));
}

#[test]
fn progress_is_shown_on_a_terminal() {
    if !has_tool("script", "--version") {
        return;
    }
    let sim = fast();
    let (svg, geometry) = (circles()[1].clone(), geometry());
    let shell = format!(
        "{} {}",
        program().display(),
        path(&svg, &geometry, &[&sim.device, "--tolerance", "0.00001"]).join(" ")
    );
    let mut child = Command::new("script").args(["-qec", &shell, "/dev/null"]).stdout(Stdio::piped()).spawn().unwrap();
    let mut said = String::new();
    child.stdout.take().unwrap().read_to_string(&mut said).unwrap();
    child.wait().unwrap();
    assert!(said.contains(" moves, ") && said.contains(" s left") && said.contains("path finished after"), "{said:?}");
}
