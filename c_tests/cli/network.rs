//! Ports of other kinds: networks, odd speeds, and those that come and go.

use std::io::Read;
use std::net::{TcpListener, TcpStream};
use std::os::unix::fs::PermissionsExt;
use std::thread::{JoinHandle, sleep, spawn};

use rustix::fs::{OFlags, open};
use rustix::termios::{ControlModes, tcgetattr};

use super::*;

const STATUS: &[u8] = b"$S\0\xB1:";
/// A status report whose position has bytes that telnet doubles.
const REPORT: &[u8] = b"$s\x10\xFF\xFF\0\0\0\0\0\0\0\0\0\0\x1C\0\0\0\xFB:";

/// A server for one connection: its port, and what becomes of it.
fn serve(serve: impl FnOnce(TcpStream) + Send + 'static) -> (u16, JoinHandle<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    (port, spawn(move || serve(listener.accept().unwrap().0)))
}

fn hear(stream: &mut TcpStream, count: usize) -> Vec<u8> {
    let mut heard = vec![0; count];
    stream.read_exact(&mut heard).unwrap();
    heard
}

#[test]
fn bytes_over_tcp() {
    let (port, server) = serve(|mut stream| {
        assert_eq!(hear(&mut stream, 5), STATUS);
        // A lost packet costs as much, within a frame too.
        stream.write_all(&REPORT[..7]).unwrap();
        sleep(Duration::from_millis(450));
        stream.write_all(&REPORT[7..]).unwrap();
    });
    let value = json(&["status", "--json", &format!("tcp://127.0.0.1:{port}")], FINISHED);
    assert_eq!((&value["link"]["garbage_bytes"], &value["link"]["repeats"]), (&0.into(), &0.into()), "{value}");
    server.join().unwrap();
    // Now nobody listens.
    complains(&["status", &format!("tcp://127.0.0.1:{port}")], DEVICE, "Connection refused");
    complains(&["status", "--dtr", "off", "tcp://127.0.0.1:1"], DEVICE, "has no line DTR");
}

#[test]
fn a_monitor_of_a_network_port_ends_with_it() {
    let (port, server) = serve(|mut stream| stream.write_all(b"$h\0\xC6:").unwrap());
    let (code, output) = outcome(&["monitor", &format!("tcp://localhost:{port}")]);
    let said = text(&output);
    assert!(code == DEVICE && said.contains("HOMING_REPLY") && said.contains("disconnected"), "{said}");
    server.join().unwrap();
}

/// As other hosts run it, too.
#[test]
fn a_session_with_a_simulator_at_a_port() {
    let output = run(Command::new(root().join("c_tests/cli/session.sh")).arg(program()));
    assert!(output.status.success(), "{}", text(&output));
    complains(&["sim", "--listen", "127.0.0.1:0", "--link", "x"], USAGE, "cannot be used with");
    complains(&["sim", "--listen", "nowhere"], DEVICE, "nowhere: ");
    complains(
        &["record", "/dev/null", "-", "--listen", "127.0.0.1:0"],
        USAGE,
        "--link and --listen are for --tap only",
    );
}

/// Whether bytes stand somewhere.
pub(super) fn has(heard: &[u8], wanted: &[u8]) -> bool {
    heard.windows(wanted.len()).any(|window| window == wanted)
}

#[test]
fn a_serial_port_by_rfc_2217() {
    const IAC: u8 = 255;
    let (port, server) = serve(|mut stream| {
        let mut heard = Vec::new();
        // SET-BAUDRATE 250000.
        let baud = [IAC, 250, 44, 1, 0, 3, 0xD0, 0x90, IAC, 240];
        while !has(&heard, &baud) {
            heard.extend(hear(&mut stream, 1));
        }
        assert!(has(&heard, &[IAC, 251, 44]), "WILL COM-PORT-OPTION: {heard:?}");
        for (command, value) in [(2, 8), (3, 1), (4, 1), (5, 1), (5, 9), (5, 11), (12, 1)] {
            assert!(has(&heard, &[IAC, 250, 44, command, value, IAC, 240]), "{command} {value}: {heard:?}");
        }
        stream.write_all(&[IAC, 253, 44, IAC, 250, 44, 101, 0, 3, 0xD0, 0x90, IAC, 240]).unwrap();
        assert_eq!(hear(&mut stream, 5), STATUS);
        let doubled: Vec<u8> = REPORT.iter().flat_map(|byte| vec![*byte; 1 + usize::from(*byte == IAC)]).collect();
        stream.write_all(&doubled).unwrap();
    });
    let port = format!("rfc2217://127.0.0.1:{port}");
    let options = ["--json", "--baud", "250000", "--dtr", "off", "--rts", "on"];
    let value = json(&[&["status", &port] as &[&str], &options].concat(), FINISHED);
    assert_eq!(value["link"]["garbage_bytes"], 0, "{value}");
    server.join().unwrap();

    let (port, server) = serve(|mut stream| {
        hear(&mut stream, 12);
        stream.write_all(&[IAC, 254, 44]).unwrap();
        sleep(Duration::from_millis(300));
    });
    complains(&["status", &format!("rfc2217://127.0.0.1:{port}")], DEVICE, "no serial port by RFC 2217");
    server.join().unwrap();
    complains(&["status", "--at-close", "keep", "rfc2217://127.0.0.1:1"], DEVICE, "the server at the port decides");
}

#[test]
fn any_speed_and_no_lines_that_are_not_there() {
    let sim = Running::sim(&[]);
    for baud in ["250000", "74880", "31250", "115200"] {
        printed(&["status", "--baud", baud, &sim.device], FINISHED);
    }
    // A pseudo-terminal remembers what would become of the lines that it has not.
    for (choice, are_dropped) in [("keep", false), ("drop", true)] {
        printed(&["status", "--at-close", choice, "--wait", "0.1", &sim.device], FINISHED);
        let port = open(sim.device.as_str(), OFlags::NOCTTY | OFlags::CLOEXEC, rustix::fs::Mode::empty()).unwrap();
        let settings = tcgetattr(port).unwrap();
        assert_eq!(settings.control_modes.contains(ControlModes::HUPCL), are_dropped, "{choice}");
    }
    complains(&["status", "--dtr", "off", &sim.device], DEVICE, "has no line DTR");
    complains(&["status", "--rts", "on", &sim.device], DEVICE, "has no line RTS");
}

/// Only root can be somebody else.
#[test]
fn who_may_not_use_a_port_is_told_which_group_may() {
    if !rustix::process::geteuid().is_root() || !has_tool("setpriv", "--version") {
        return;
    }
    let device = super::device::Device::new();
    fs::set_permissions(&device.path, fs::Permissions::from_mode(0o660)).unwrap();
    let directory = std::env::temp_dir().join(format!("deltarobot-test-{}", std::process::id()));
    fs::create_dir(&directory).unwrap();
    fs::set_permissions(&directory, fs::Permissions::from_mode(0o755)).unwrap();
    let copy = directory.join("deltarobot");
    fs::copy(program(), &copy).unwrap();
    let mut command = Command::new("setpriv");
    command.args(["--reuid", "65534", "--regid", "65534", "--clear-groups"]).arg(&copy);
    let output = run(command.args(["status", &device.path]));
    fs::remove_dir_all(&directory).unwrap();
    let said = text(&output);
    assert!(
        output.status.code() == Some(DEVICE) && said.contains("Permission denied; members of the group "),
        "{said}"
    );
}

#[test]
fn a_port_is_waited_for() {
    let link = fresh("cli-late");
    let asking = deltarobot(&["status", "--wait-for-port", "60", utf8(&link)]).stdout(Stdio::piped()).spawn().unwrap();
    sleep(Duration::from_millis(300));
    let sim = Running::sim(&["--link", utf8(&link)]);
    assert_eq!(asking.wait_with_output().unwrap().status.code(), Some(FINISHED));
    drop(sim);
}

#[test]
fn a_port_that_comes_back_is_watched_and_recorded_again() {
    let link = fresh("cli-back");
    let file = fresh("cli-back.txt");
    let report = |sim: &Running| printed(&["status", &sim.device], FINISHED);
    let watch = |arguments: &[&str]| {
        let mut sim = Running::sim(&["--link", utf8(&link)]);
        let mut child = deltarobot(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        sleep(Duration::from_millis(400));
        sim.interrupt();
        sleep(Duration::from_millis(400));
        let sim = Running::sim(&["--link", utf8(&link), "--speed", "200"]);
        sleep(Duration::from_millis(700));
        let is_alive = child.try_wait().unwrap().is_none();
        interrupt(&child);
        let output = child.wait_with_output().unwrap();
        assert!(is_alive && output.status.code() == Some(FINISHED), "{}", text(&output));
        assert!(text(&output).contains("waiting"), "{}", text(&output));
        report(&sim);
    };
    watch(&["monitor", "--reconnect", utf8(&link)]);
    watch(&["record", "--reconnect", utf8(&link), utf8(&file)]);
}

#[test]
fn the_ports_of_this_machine_are_listed() {
    for line in printed(&["ports", "--json"], FINISHED).lines() {
        let port: Value = serde_json::from_str(line).unwrap();
        assert!(port["port"].as_str().unwrap().starts_with("/dev/"), "{port}");
    }
    printed(&["ports"], FINISHED);
}

/// As the system describes them, in directories that only root can put in their places.
#[test]
fn usb_ports_are_listed_with_names_and_numbers() {
    if !rustix::process::geteuid().is_root() || !has_tool("unshare", "--version") {
        return;
    }
    let unshared = |script: &str| {
        let mut command = Command::new("unshare");
        command.args(["-m", "sh", "-c", script]).arg(program());
        command
    };
    if !run(&mut unshared("mount -t tmpfs none /dev")).status.success() {
        return;
    }
    let system = out_dir().join("cli-system");
    let _ = fs::remove_dir_all(&system);
    let (device, class) = (system.join("1-1"), system.join("class"));
    let interface = device.join("1-1:1.0");
    let port = interface.join("tty/ttyACM0");
    for directory in [&port, &class, &system.join("usb")] {
        fs::create_dir_all(directory).unwrap();
    }
    for (file, text) in [
        ("idVendor", "2341"),
        ("idProduct", "0042"),
        ("manufacturer", "Arduino"),
        ("product", "Mega\u{202e}"),
        ("serial", "85735313"),
    ] {
        fs::write(device.join(file), format!("{text}\n")).unwrap();
    }
    for (target, link) in [
        (system.join("usb"), interface.join("subsystem")),
        (interface, port.join("device")),
        (port, class.join("ttyACM0")),
    ] {
        std::os::unix::fs::symlink(target, link).unwrap();
    }
    let mounted = "mount --bind \"$1\" /sys/class/tty && mount -t tmpfs none /dev && touch /dev/ttyACM0";
    let listed = |option: &str| {
        let output = run(unshared(&format!("{mounted} && exec \"$0\" ports {option}")).arg(&class));
        assert!(output.status.success(), "{}", text(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    assert_eq!(listed(""), "/dev/ttyACM0  Arduino  Mega\\u{202e}  2341:0042  serial number 85735313\n");
    let value: Value = serde_json::from_str(&listed("--json")).unwrap();
    assert_eq!((&value["vendor_id"], &value["serial_number"]), (&0x2341.into(), &"85735313".into()), "{value}");
}
