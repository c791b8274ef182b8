//! How the program begins and ends.

use rustix::process::Signal;

use super::driving::{far, slow};
use super::robot::{CANCEL, Robot};
use super::{Server, file, program};

#[test]
fn a_signal_has_the_robots_stand_before_the_end() {
    for signal in [Signal::TERM, Signal::INT] {
        let (robot, mut server) = slow();
        let mut driver = server.watch("/api/robots/lab/events");
        let word = driver.lease();
        assert_eq!(server.drive("/api/robots/lab/move", &word, &far()).0, 202);
        driver.event_when("state", |event| event["state"] == "moving");
        server.signal(signal);
        assert_eq!(driver.event_when("ended", |_| true)["operation"]["outcome"], "cancelled");
        assert!(server.wait().code() == Some(0) && robot.count(CANCEL) >= 1);
    }
}

#[test]
fn what_is_wrong_with_the_arguments_or_the_configuration_is_said() {
    for (text, said) in [
        ("listen = 5\n", "line 1: invalid type"),
        ("\nlisten = \"127.0.0.1\"\n", "line 2: invalid socket address"),
        ("[robots.lab]\nport = \"/dev/x\"\nspeed = 5\n", "line 3: unknown field `speed`"),
        ("[robots.lab]\nbaud = 9600\n", "line 1: missing field `port`"),
        ("[robots.\"a b\"]\nport = \"/dev/x\"\n", "is no name"),
        ("[robots.lab]\nport = \"/dev/x\"\nbaud = 0\n", "line 3: 0 is not from 1"),
        ("[robots.lab]\nport = \"/dev/x\"\nlayout = \"other\"\n", "line 3: `other` is none of auto"),
        ("[robots.lab]\nport = \"/dev/x\"\ndtr = \"up\"\n", "line 3: `up` is none of on, off"),
        ("[robots.lab]\nport = \"/dev/x\"\nraw = \"0.0.0.0:7001\"\n", "only loopback"),
        (
            "[robots.lab]\nport = \"/dev/x\"\ngeometry = { joints = [[0,0,0],[0,0,0],[0,0,0]], edge = 1, offset = 1 }\n",
            "A1",
        ),
        ("[robots\n", "line 1: "),
        ("", "no robot is named"),
    ] {
        let path = file("config", text);
        let output = program(&["--config", &path]).output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && error.contains(said) && error.lines().count() == 1, "{text}{error}");
    }
    for (arguments, status, said) in [
        (&["lab"][..], 2, "NAME=PORT"),
        (&["lab=/dev/x", "lab=/dev/y"], 2, "named twice"),
        (&["--config", "/no/such/file"], 3, "No such file"),
        (&["--what"], 2, "--what"),
    ] {
        let output = program(arguments).output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(status) && error.contains(said), "{arguments:?}: {error}");
    }
    assert!(program(&["--help"]).output().unwrap().status.success());
}

#[test]
fn an_address_or_a_port_that_is_in_use_is_said() {
    let robot = Robot::new(50.0);
    let server = Server::start(&[&robot.named("lab")]);
    server.state_when("lab", |state| state["link"] == "up");
    let output = program(&["--sim", "1", "--listen", &server.address.to_string()]).output().unwrap();
    assert!(output.status.code() == Some(3) && String::from_utf8_lossy(&output.stderr).contains("in use"));
    let other = Server::start(&[&robot.named("lab")]);
    let state = other.state_when("lab", |state| !state["link_error"].is_null());
    assert!(state["link_error"].as_str().unwrap().contains("in use by another program"), "{state}");
    drop(server);
    other.state_when("lab", |state| state["state"] == "idle");
}

#[test]
fn simulated_robots_work_as_others_do() {
    let server = Server::start(&["--sim", "3"]);
    for name in ["sim1", "sim2", "sim3"] {
        server.home(name);
    }
}
