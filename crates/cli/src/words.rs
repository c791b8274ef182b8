//! Messages in words, and as JSON.

use deltarobot_protocols::deltarobot::{Layout, Message, Opcode, PAYLOAD_MAX, Position, Report, describe};
use serde_json::{Value, json};

/// An opcode's name.
pub fn name(opcode: Opcode) -> &'static str {
    opcode.name()
}

/// A message on one line, worded as the original's host program does.
pub fn text(opcode: Opcode, payload: &[u8]) -> String {
    let mut text = String::new();
    describe(opcode, payload, &mut |byte| text.push(char::from(byte)));
    if Message::read(opcode, payload, Layout::Auto).is_none() {
        text.push_str(" (a payload of wrong length)");
    }
    text
}

/// State, position and end stops, such as `IDLE  DA=0  DB=0  DC=0 STP_A`.
pub fn report(report: &Report) -> String {
    let message = Message::StatusReport(*report);
    let mut payload = [0; PAYLOAD_MAX];
    let length = message.write(Layout::Firmware, &mut payload);
    let text = text(message.opcode(), payload.get(..length).unwrap_or_default());
    let (_, report) = text.split_once(": ").unwrap_or_default();
    report.to_owned()
}

/// State, position and end stops.
pub fn report_json(report: &Report) -> Value {
    let stops: Vec<_> = [(4, "A"), (8, "B"), (16, "C")]
        .into_iter()
        .filter_map(|(bit, arm)| (report.stat() & bit != 0).then_some(arm))
        .collect();
    let state = report.state().name();
    json!({ "state": state, "position": position_json(report.position), "stops": stops })
}

/// Three numbers, or null where none is known.
pub fn position_json(position: Position) -> Value {
    if position.is_finite() { Value::from(position.0.map(number).to_vec()) } else { Value::Null }
}

/// As short as it is without ambiguity: 0.1 rather than what is nearest to it in a float.
fn number(bits: u32) -> Value {
    f32::from_bits(bits).to_string().parse::<f64>().map_or(Value::Null, Value::from)
}

/// What a message says.
pub fn json(opcode: Opcode, payload: &[u8]) -> Value {
    let mut value = match Message::read(opcode, payload, Layout::Auto) {
        Some(Message::Ack(answered) | Message::Nack(answered)) => json!({ "answers": name(answered) }),
        Some(Message::Move(target)) => json!({ "target": position_json(target) }),
        Some(Message::StatusReport(report)) => report_json(&report),
        Some(_) => json!({}),
        None => json!({ "malformed": true }),
    };
    if let Some(object) = value.as_object_mut() {
        object.insert("opcode".into(), name(opcode).into());
    }
    value
}
