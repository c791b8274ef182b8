//! Who is let in.

use std::io::{Read, Write};

use serde_json::json;

use super::robot::{HOME, Robot};
use super::{Server, file, program};

const DRIVE: &str = "drive-0123456789abcdef";
const WATCH: &str = "watch-0123456789abcdef";

#[test]
fn pages_and_names_of_others_are_refused() {
    let robot = Robot::new(50.0);
    let server = Server::start(&[&robot.named("lab"), "--host", "robots.example"]);
    let own = format!("http://{}", server.address);
    let ask = |headers: &[(&str, &str)]| server.ask_with("POST", "/api/robots/lab/home", headers, b"").0;
    assert_eq!(ask(&[("Origin", "http://evil.example")]), 403);
    assert_eq!(ask(&[("Origin", "null")]), 403);
    assert_eq!(ask(&[("Host", "evil.example")]), 403);
    assert_eq!(ask(&[("Host", "evil.example"), ("Origin", "http://evil.example")]), 403);
    assert_eq!(server.ask_with("GET", "/api/events", &[("Origin", "http://evil.example")], b"").0, 403);
    assert_eq!(robot.count(HOME), 0);
    assert_eq!(ask(&[("Origin", &own)]), 200);
    assert_eq!(ask(&[("Host", "robots.example:7373"), ("Origin", "http://robots.example:7373")]), 200);
}

#[test]
fn tokens() {
    let (drive, watch) = (file("drive", DRIVE), file("watch", &format!("{WATCH}\n")));
    let robot = Robot::new(50.0);
    let server = Server::start(&[&robot.named("lab"), "--token-file", &drive, "--watch-token-file", &watch]);
    let ask = |method: &str, path: &str, token: &str| {
        let bearer = format!("Bearer {token}");
        server.ask_with(method, path, &[("Authorization", &bearer)], b"").0
    };
    assert_eq!(server.ask_with("GET", "/api/robots", &[], b"").0, 401);
    assert_eq!((ask("GET", "/api/robots", "wrong"), ask("GET", "/api/robots", &DRIVE[..5])), (401, 401));
    assert_eq!((ask("GET", "/api/robots", WATCH), ask("POST", "/api/robots/lab/home", WATCH)), (200, 403));
    assert_eq!((ask("POST", "/api/robots/lab/lease", WATCH), robot.count(HOME)), (403, 0));
    assert_eq!((ask("POST", "/api/robots/lab/home", DRIVE), ask("POST", "/api/robots/lab/cancel", WATCH)), (200, 200));
}

#[test]
fn other_machines_need_a_token() {
    for (arguments, said) in [
        (&["--sim", "1", "--listen", "0.0.0.0:0"][..], "--token-file"),
        (&["--sim", "1", "--listen", "0.0.0.0:0", "--token-file", "/dev/null"], "16 to 256"),
        (&["--sim", "1", "--token-file", "/no/such/file"], "No such file"),
    ] {
        let output = program(arguments).output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && text.contains(said), "{arguments:?}: {text}");
    }
    let server = Server::start(&["--sim", "1", "--listen", "0.0.0.0:0", "--token-file", &file("token", DRIVE)]);
    drop(server);
}

#[test]
fn whatever_is_sent_others_are_served() {
    let server = Server::start(&["--sim", "1"]);
    let long = [b"GET /".as_slice(), &vec![b'x'; 100_000], b" HTTP/1.1\r\n\r\n"].concat();
    let deep = [
        b"POST /api/robots/sim1/move HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n\
        Content-Length: 60000\r\n\r\n"
            .as_slice(),
        &vec![b'['; 60_000],
    ]
    .concat();
    for bytes in [
        &b"\xFF\x00\r\n\r\n"[..],
        b"GET / HTTP/1.1\r\n\r\n",
        b"POST /api/robots/sim1/home HTTP/1.1\r\nHost: ",
        &long,
        &deep,
    ] {
        let mut stream = server.connect();
        // It may have been closed in between.
        let _ = stream.write_all(bytes);
        let _ = stream.shutdown(std::net::Shutdown::Write);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        assert!(!answer.starts_with(b"HTTP/1.1 2"), "{}", String::from_utf8_lossy(&answer));
    }
    let mut watcher = server.watch("/api/events");
    for message in
        ["", "{", "[]", r#"{"type":"lease"}"#, r#"{"type":"lease","robot":"none"}"#, r#"{"type":"x","robot":1}"#]
    {
        watcher.0.send(tungstenite::Message::text(message)).unwrap();
        watcher.event_when("refused", |_| true);
    }
    watcher.0.send(tungstenite::Message::text("x".repeat(10_000))).unwrap();
    while watcher.0.read().is_ok() {}
    assert_eq!(server.get("/api/robots")["robots"][0]["name"], json!("sim1"));
}
