//! Asking the program: each answer is checked against its description.

use std::io::{Read, Write};
use std::net::TcpStream;

use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket, client};

use super::{Server, TIMEOUT, found, schema};

/// A connection for events.
pub(super) struct Watcher(pub(super) WebSocket<TcpStream>);

impl Server {
    pub(super) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(TIMEOUT)).unwrap();
        stream
    }

    /// Sends a request; the connection that the answer will come by.
    pub(super) fn send(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> TcpStream {
        let mut stream = self.connect();
        let mut head = format!("{method} {path} HTTP/1.1\r\nConnection: close\r\nContent-Length: {}\r\n", body.len());
        for (name, value) in headers {
            head.extend([name, ": ", value, "\r\n"]);
        }
        if !headers.iter().any(|(name, _)| *name == "Host") {
            head.extend(["Host: ", &self.address.to_string(), "\r\n"]);
        }
        stream.write_all(&[head.as_bytes(), b"\r\n", body].concat()).unwrap();
        stream
    }

    /// A request with these headers, and its answer: the status and what is in the body.
    pub(super) fn ask_with(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> (u16, Value) {
        let mut answer = Vec::new();
        self.send(method, path, headers, body).read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|window| window == b"\r\n\r\n").expect("a head");
        let (head, body) = (String::from_utf8_lossy(&answer[..end]).into_owned(), &answer[end + 4..]);
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        let kind = head.lines().find_map(|line| line.strip_prefix("content-type: ")).unwrap_or_default();
        schema::check_answer(method, path, status, kind, body);
        (status, serde_json::from_slice(body).unwrap_or_default())
    }

    pub(super) fn get(&self, path: &str) -> Value {
        let (status, answer) = self.ask_with("GET", path, &[], b"");
        assert_eq!(status, 200, "{answer}");
        answer
    }

    pub(super) fn post(&self, path: &str, body: &Value) -> (u16, Value) {
        self.ask_with("POST", path, &[("Content-Type", "application/json")], body.to_string().as_bytes())
    }

    /// The same of who drives.
    pub(super) fn drive(&self, path: &str, lease: &str, body: &Value) -> (u16, Value) {
        let headers = [("Content-Type", "application/json"), ("Deltarobot-Lease", lease)];
        self.ask_with("POST", path, &headers, body.to_string().as_bytes())
    }

    /// A robot's state, as soon as it is such.
    pub(super) fn state_when(&self, name: &str, is_such: impl Fn(&Value) -> bool) -> Value {
        found("a state", || Some(self.get(&format!("/api/robots/{name}"))).filter(&is_such))
    }

    /// Homes a robot.
    pub(super) fn home(&self, name: &str) {
        self.state_when(name, |state| state["state"] == "idle");
        let (status, operation) = self.post(&format!("/api/robots/{name}/home"), &json!({}));
        assert_eq!((status, &operation["outcome"]), (200, &json!("finished")), "{operation}");
    }

    pub(super) fn watch(&self, path: &str) -> Watcher {
        let request = format!("ws://{}{path}", self.address).into_client_request().unwrap();
        Watcher(client(request, self.connect()).unwrap().0)
    }
}

impl Watcher {
    /// The next event.
    pub(super) fn event(&mut self) -> Value {
        loop {
            if let Message::Text(text) = self.0.read().unwrap() {
                let event = serde_json::from_str(&text).unwrap();
                schema::check("Event", &event);
                return event;
            }
        }
    }

    /// The next of this type that is such.
    pub(super) fn event_when(&mut self, kind: &str, is_such: impl Fn(&Value) -> bool) -> Value {
        loop {
            let event = self.event();
            if event["type"] == kind && is_such(&event) {
                return event;
            }
        }
    }

    pub(super) fn say(&mut self, message: &Value) {
        self.0.send(Message::text(message.to_string())).unwrap();
    }

    /// Drives; the word of the lease.
    pub(super) fn lease(&mut self) -> String {
        self.say(&json!({ "type": "lease", "client": "test" }));
        self.event_when("lease", |_| true)["lease"].as_str().unwrap().to_owned()
    }
}
