//! Requests that are not answered as they should be: what is said about it, and how long it takes.

use super::device::Device;
use super::network::has;
use super::*;

/// Makes a status request, to which the device answers each frame with these bytes. The exit status, JSON, complaints.
fn asked(options: &[&str], answer: impl Fn(&[u8]) -> Vec<u8>) -> (i32, Value, String) {
    let mut device = Device::new();
    let arguments = [&["status", "--json", &device.path], options].concat();
    let mut child = deltarobot(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while child.try_wait().unwrap().is_none() {
        let heard = device.hear_now();
        if !heard.is_empty() {
            device.say(&answer(&heard));
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let output = child.wait_with_output().unwrap();
    let value = serde_json::from_slice(&output.stdout).expect("an object");
    (output.status.code().unwrap(), value, String::from_utf8(output.stderr).unwrap())
}

#[test]
fn what_was_seen_is_said() {
    let nothing = |_: &[u8]| Vec::new();
    let (code, value, said) = asked(&[], nothing);
    assert_eq!((code, &value["link"]["seen"]), (TIMED_OUT, &"nothing".into()));
    assert!(said.contains("nothing was received"), "{said}");

    let (code, value, said) = asked(&[], |_| vec![0x80, 0xF0, 0x00, 0xFE]);
    assert_eq!((code, &value["link"]["seen"]), (TIMED_OUT, &"garbage".into()));
    assert!(said.contains("16 bytes were received, but no message: is the speed right (--baud)?"), "{said}");

    let (code, value, said) = asked(&[], <[u8]>::to_vec);
    assert_eq!((code, &value["link"]["seen"]), (TIMED_OUT, &"echo".into()));
    assert!(said.contains("only what was sent came back"), "{said}");

    let (code, value, said) = asked(&[], |_| b"$e\0\xC3:".to_vec());
    assert_eq!((code, &value["link"]["seen"]), (TIMED_OUT, &"frames".into()));
    assert!(said.contains("no answer to this request"), "{said}");
}

#[test]
fn a_nack_is_named() {
    let sim = Running::sim(&[]);
    complains(&["move", "1", "2", "3", &sim.device], NOT_DONE, "sent NACK: it does not know its position");
}

/// How long a request took that nothing answers, and how often it was sent.
fn unanswered(options: &[&str]) -> (Duration, u64) {
    let began = Instant::now();
    let (code, value, _) = asked(options, |_| Vec::new());
    assert_eq!(code, TIMED_OUT, "{value}");
    (began.elapsed(), value["link"]["repeats"].as_u64().unwrap() + 1)
}

#[test]
fn times_and_attempts_are_the_users() {
    let (time, attempts) = unanswered(&["--timeout", "3"]);
    assert!((2.9..6.0).contains(&time.as_secs_f64()) && attempts == 12, "{time:?} {attempts}");
    let (time, attempts) = unanswered(&["--answer-time", "0.05", "--attempts", "2"]);
    assert!((0.1..0.9).contains(&time.as_secs_f64()) && attempts == 2, "{time:?} {attempts}");
    let (time, attempts) = unanswered(&["--answer-time", "0.6", "--attempts", "3"]);
    assert!((1.8..5.0).contains(&time.as_secs_f64()) && attempts == 3, "{time:?} {attempts}");
    // An answer that takes longer than the default allows.
    let mut device = Device::new();
    let child = deltarobot(&["status", "--answer-time", "2", &device.path]).stdout(Stdio::piped()).spawn().unwrap();
    device.hear(5);
    std::thread::sleep(Duration::from_millis(1200));
    device.say(b"$s\x10\0\0\0\0\0\0\0\0\0\0\0\0\x1C\0\0\0\xFD:");
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(FINISHED));
    assert_eq!(device.hear_now(), b"");
}

#[test]
fn an_error_is_an_object_too() {
    let (code, output) = outcome(&["status", "--json", "/nonexistent/tty"]);
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((code, &value["request"], &value["outcome"]), (DEVICE, &"status".into(), &"error".into()));
    assert_eq!(value["error"], "/nonexistent/tty: No such file or directory");

    let file = fresh("cli-error.txt");
    fs::write(&file, "home\n").unwrap();
    let wrong = fresh("cli-error-wrong.txt");
    fs::write(&wrong, "jump\n").unwrap();
    for (arguments, status) in [
        (&["run", "--json", "/nonexistent/tty", utf8(&file)] as &[&str], DEVICE),
        (&["run", "--json", "/nonexistent/tty", "/nonexistent/file"], DEVICE),
        (&["run", "--json", "/nonexistent/tty", utf8(&wrong)], USAGE),
        (&["send", "--json", "--protocol", "gx", "/nonexistent/tty", "x1"], DEVICE),
        (&["move", "--json", "1", "2", "inf", "/nonexistent/tty"], USAGE),
        (&["move", "--json", "1", "2", "3", "/nonexistent/tty", "--geometry", "/nonexistent/file"], DEVICE),
        (&["status", "--json", "/nonexistent/tty", "--geometry", "/nonexistent/file"], DEVICE),
        (&["path", "--json", "/nonexistent/file", "/nonexistent/tty", "--geometry", "/nonexistent/file"], DEVICE),
    ] {
        assert_eq!(json(arguments, status)["outcome"], "error", "{arguments:?}");
    }

    let sim = Running::sim(&["--disconnect-after", "0.1"]);
    let (code, output) = outcome(&["home", "--json", &sim.device]);
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((code, &value["outcome"]), (DEVICE, &"error".into()), "{value}");

    // A controller that accepts the move, and answers nothing after that.
    let mut device = Device::new();
    let mut child =
        deltarobot(&["move", "1", "2", "3", "--json", &device.path]).stdout(Stdio::piped()).spawn().unwrap();
    assert!(device.hear(17).starts_with(b"$M"));
    device.say(b"$A\x01M\xED:");
    let mut heard = Vec::new();
    let mut wait_for = |request: &[u8]| {
        until("it asks", || {
            heard.extend(device.hear_now());
            has(&heard, request)
        });
    };
    wait_for(b"$S\0\xB1:");
    interrupt(&child);
    wait_for(b"$C\0\xA1:");
    interrupt(&child);
    let value: Value = serde_json::from_reader(child.stdout.take().unwrap()).unwrap();
    assert_eq!((child.wait().unwrap().code(), &value["outcome"]), (Some(CANCELLED), &"interrupted".into()));
}
