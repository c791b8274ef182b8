//! Lines of the Ozeki line protocol.

use std::collections::BTreeMap;
use std::time::Duration;

use deltarobot_protocols::line::{COMMAND_MAX, Checksum, Malformed, Message};
use serde_json::{Value, json};

use super::{Decoder, Kind, Lanes, Piece, Terms};
use crate::hex::hex;
use crate::recording::Side;
use crate::screen::printable;

/// A line whose end has not come for so long is given up. The protocol has no such limit: somebody may be typing.
const PAUSE: Duration = Duration::from_secs(2);
/// What has no end of a line is reported in pieces of this many bytes.
const LONGEST: usize = 1024;
/// Devices whose names are remembered.
const DEVICES_MAX: usize = 256;

pub(crate) const TERMS: Terms = Terms {
    messages: "lines",
    by_kind: "lines_by_command",
    damaged: "wrong checksums",
    damaged_member: "checksum_failures",
};

/// Finds lines, and remembers what the devices are called.
#[derive(Default)]
pub(crate) struct Lines {
    lanes: Lanes<Vec<u8>>,
    devices: Devices,
}

impl Decoder for Lines {
    fn feed(&mut self, from: Option<Side>, bytes: &[u8]) -> Vec<Piece> {
        let mut found = Vec::new();
        let lane = self.lanes.of(from);
        for byte in bytes {
            lane.push(*byte);
            if *byte == b'\n' {
                found.extend(self.devices.line(from, lane));
            } else if lane.len() >= LONGEST {
                found.push(garbage(from, lane, "without an end"));
            } else {
                continue;
            }
            lane.clear();
        }
        found
    }

    fn idle(&mut self, from: Option<Side>, silence: Duration, gap: Duration) -> Vec<Piece> {
        let lane = self.lanes.of(from);
        if silence < PAUSE.max(gap) || lane.is_empty() {
            return Vec::new();
        }
        vec![garbage(from, &std::mem::take(lane), "without an end")]
    }
}

/// The names of devices, by their ids, as they said themselves.
#[derive(Debug, Default)]
struct Devices(BTreeMap<Vec<u8>, String>);

impl Devices {
    /// What a line with its end says; nothing if it is empty.
    fn line(&mut self, from: Option<Side>, bytes: &[u8]) -> Option<Piece> {
        let line = bytes.strip_suffix(b"\n").unwrap_or(bytes);
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        if line.is_empty() {
            return None;
        }
        Some(match Message::parse(line) {
            Ok(message) => {
                self.remember(&message);
                self.piece(from, &message, bytes.len())
            }
            Err(Malformed::Command) => garbage(from, bytes, "c is not the first parameter"),
            Err(Malformed::Escape) => garbage(from, bytes, "a damaged escape"),
            Err(Malformed::LineFeed) => garbage(from, bytes, "a line feed inside"),
        })
    }

    fn remember(&mut self, message: &Message) {
        let is_intact = message.checksum != Checksum::Wrong;
        if !is_intact || !message.command().is(b"welcome") || self.0.len() >= DEVICES_MAX {
            return;
        }
        let name = message.get(b"name").or_else(|| message.get(b"type"));
        if let (Some(id), Some(name)) = (message.get(b"id"), name) {
            self.0.insert(id.bytes().collect(), text(name.bytes()));
        }
    }

    fn piece(&self, from: Option<Side>, message: &Message, bytes: usize) -> Piece {
        let from = from.or_else(|| sender(message));
        let command = text(message.command().bytes());
        let id = message.get(b"id");
        let device = id.and_then(|id| self.0.get(&id.bytes().collect::<Vec<_>>()));
        let is_too_long = from == Some(Side::Host) && bytes > COMMAND_MAX;
        let is_wrong = message.checksum == Checksum::Wrong;

        let mut words = vec![command.clone()];
        let mut params = Vec::new();
        for (place, param) in message.params().enumerate().skip(1) {
            let (name, value) = (text(param.name.iter().copied()), text(param.value.bytes()));
            words.push(format!("  {name}={value}"));
            // A welcome says it itself.
            if let Some(device) = device.filter(|_| name == "id" && command != "welcome") {
                words.push(format!(" ({device})"));
            }
            if is_wrong && place + 1 == message.count {
                words.push(format!(" (checksum {value} instead of {:04x})", message.sum));
            }
            params.push(json!({ "name": name, "value": value }));
        }
        if is_too_long {
            words.push(format!(" ({bytes} bytes: longer than {COMMAND_MAX})"));
        }

        let json = json!({
            "command": command,
            "params": params,
            "id": id.map(|id| text(id.bytes())),
            "device": device,
            "t": message.get(b"t").and_then(deltarobot_protocols::line::Value::byte),
            "checksum": match message.checksum {
                Checksum::None => Value::Null,
                Checksum::Right => "right".into(),
                Checksum::Wrong => "wrong".into(),
            },
            "sum": format!("{:04x}", message.sum),
            "too_long": is_too_long,
            "line": String::from_utf8_lossy(message.line),
        });
        let kind = if is_wrong { Kind::Garbage { bytes, damaged: 1 } } else { Kind::Message(command.into()) };
        Piece::new(from, kind, words.concat(), json)
    }
}

/// Who must have sent it: what answers or greets comes from a device, and only what a PC sends has a checksum.
fn sender(message: &Message) -> Option<Side> {
    let command: Vec<_> = message.command().bytes().collect();
    if command.ends_with(b"_resp") || matches!(command.as_slice(), b"welcome" | b"ack" | b"onerror") {
        return Some(Side::Controller);
    }
    (message.checksum == Checksum::Right).then_some(Side::Host)
}

fn garbage(from: Option<Side>, bytes: &[u8], reason: &str) -> Piece {
    let kind = Kind::Garbage { bytes: bytes.len(), damaged: 0 };
    let line = bytes.trim_ascii_end();
    let json = json!({ "garbage": hex(bytes), "line": String::from_utf8_lossy(line), "reason": reason });
    Piece::new(from, kind, format!("garbage: {} ({reason})", line.escape_ascii()), json)
}

/// Text from another's hands, of any encoding.
fn text(bytes: impl Iterator<Item = u8>) -> String {
    let bytes: Vec<_> = bytes.collect();
    printable(&String::from_utf8_lossy(&bytes)).into_owned()
}

#[cfg(test)]
mod tests {
    use super::{Decoder, LONGEST, Lines, Side};
    use std::time::Duration;

    fn texts(lines: &mut Lines, bytes: &[u8]) -> Vec<String> {
        lines.feed(None, bytes).into_iter().map(|piece| piece.text).collect()
    }

    #[test]
    fn devices_get_their_names() {
        let mut lines = Lines::default();
        assert_eq!(
            texts(&mut lines, b"c=heaterinfo&id=a\nc=welcome&id=a&type=T\r\nc=welcome&id=b&type=T&name=Left%20lamp\n"),
            ["heaterinfo  id=a", "welcome  id=a  type=T", "welcome  id=b  type=T  name=Left lamp"]
        );
        assert_eq!(texts(&mut lines, b"c=a&id=a\n"), ["a  id=a (T)"]);
        assert_eq!(texts(&mut lines, b"\n\nc=go&c=2&x&=&id="), [] as [&str; 0]);
        assert_eq!(texts(&mut lines, b"b\n"), ["go  c=2  x=  =  id=b (Left lamp)"]);
        assert_eq!(texts(&mut lines, b"c=x&v=%0a%1B%C3%A9%ff\n"), ["x  v=\\n\\u{1b}\u{e9}\u{fffd}"]);
    }

    #[test]
    fn what_is_no_line() {
        let mut lines = Lines::default();
        assert_eq!(
            texts(&mut lines, b"x=1\nc=%4\nc=go\xFF&s=zz\n\x00\n"),
            [
                "garbage: x=1 (c is not the first parameter)",
                "garbage: c=%4 (a damaged escape)",
                "go\u{fffd}  s=zz (checksum zz instead of ffff)",
                "garbage: \\x00 (c is not the first parameter)"
            ]
            .map(|text| text.replace("ffff)", &format!("{:04x})", deltarobot_protocols::line::fletcher16(b"c=go\xFF"))))
        );
        let endless = texts(&mut lines, &[b'x'; LONGEST]);
        assert!(matches!(endless.as_slice(), [text] if text.ends_with("x (without an end)")), "{endless:?}");
        lines.feed(Some(Side::Host), b"c=go");
        assert!(lines.idle(Some(Side::Host), Duration::from_secs(1), Duration::ZERO).is_empty());
        assert!(lines.end(None).is_empty());
        let given_up = lines.end(Some(Side::Host));
        assert_eq!((given_up.len(), given_up[0].from), (1, Some(Side::Host)));
        assert_eq!(given_up[0].text, "garbage: c=go (without an end)");
        assert!(lines.end(Some(Side::Host)).is_empty());
    }
}
