//! Commands and notices in words, and as JSON.

use deltarobot_protocols::gx::{AXES, Control, Fault, Format, Item, MASK_AXES, Message, Vector};
use serde_json::{Value, json};

use crate::decoder::{Kind, Piece};
use crate::hex::hex;
use crate::recording::Side;

/// What the axes are called.
const NAMES: [&str; AXES] = ["x", "y", "z", "a", "b", "c"];

/// What a command or notice says.
pub(super) fn piece(from: Side, item: &Item, bytes: &[u8]) -> Piece {
    let message = &item.message;
    let (name, said) = match message {
        Message::Move(vector) if vector.mask & MASK_AXES == 0 => ("velocity", axes(vector, false)),
        Message::Move(vector) => ("move", axes(vector, false)),
        Message::Step(vector) => ("step", axes(vector, true)),
        Message::Reporting(0) => ("reporting", "  off".into()),
        Message::Reporting(period) => ("reporting", format!("  each {period} ms")),
        Message::Completed => ("completed", String::new()),
        Message::Refused(code) => ("refused", format!("  {}", reason(*code))),
        Message::Position(vector) => ("position", axes(vector, false)),
        Message::Malformed(code) => ("malformed", format!("  {}", reason(*code))),
        Message::Confirmed { number, check } => ("confirmed", format!("  ..{number}  check {check}")),
        Message::Control(bits) => (Control::of(*bits).map_or("unknown control", control_name), String::new()),
        Message::Status(status) => {
            ("status", format!("  {} free{}", status.free, if status.is_held { "  holds" } else { "" }))
        }
    };
    let number = item.number.map_or(String::new(), |number| format!("#{} ", number.value));
    let remark = if item.format == Format::Ascii { " (ASCII)" } else { "" };

    let mut json = json!({
        "kind": name,
        "format": format_name(item.format),
        "number": item.number.map(|number| number.value),
        "number_format": item.number.map(|number| format_name(number.format)),
        "bytes": hex(bytes),
    });
    let more = match message {
        Message::Move(vector) => json!({ "target": position_json(vector), "velocity": vector.velocity() }),
        Message::Step(vector) => json!({ "delta": position_json(vector), "velocity": vector.velocity() }),
        Message::Position(vector) => json!({ "position": position_json(vector), "velocity": vector.velocity() }),
        Message::Reporting(period) => json!({ "period_ms": period }),
        Message::Refused(code) | Message::Malformed(code) => json!({ "code": code, "reason": reason(*code) }),
        Message::Confirmed { number, check } => json!({ "number_end": number, "check": check }),
        Message::Status(status) => json!({ "free": status.free, "held": status.is_held }),
        Message::Completed | Message::Control(_) => json!({}),
    };
    if let (Some(json), Value::Object(more)) = (json.as_object_mut(), more) {
        json.extend(more);
    }
    Piece::new(Some(from), Kind::Message(name.into()), format!("{number}{name}{said}{remark}"), json)
}

/// What is asked for past the queue.
pub(crate) const fn control_name(control: Control) -> &'static str {
    match control {
        Control::Query => "query",
        Control::Hold => "hold",
        Control::Resume => "resume",
        Control::Stop => "stop",
    }
}

/// A position, such as `x=400  y=300  V=1000`.
pub(crate) fn position(vector: &Vector) -> String {
    axes(vector, false).trim_start().to_owned()
}

/// Axes and velocity, such as `  x=400  y=300  V=1000`.
fn axes(vector: &Vector, signed: bool) -> String {
    let values = NAMES.iter().enumerate().filter_map(|(axis, name)| Some((name, vector.axis(axis)?)));
    let values =
        values.map(|(name, value)| if signed { format!("  {name}={value:+}") } else { format!("  {name}={value}") });
    values.chain(vector.velocity().map(|velocity| format!("  V={velocity}"))).collect()
}

pub(crate) fn position_json(vector: &Vector) -> Value {
    let values =
        NAMES.iter().enumerate().filter_map(|(axis, name)| Some(((*name).to_owned(), vector.axis(axis)?.into())));
    Value::Object(values.collect())
}

const fn format_name(format: Format) -> &'static str {
    match format {
        Format::Binary => "binary",
        Format::Ascii => "ascii",
    }
}

/// What an error notice's code means.
pub(crate) fn reason(code: u8) -> String {
    const REASONS: [(Fault, &str); 15] = [
        (Fault::Unknown, "no command begins like that"),
        (Fault::Number, "no number"),
        (Fault::Interrupted, "interrupted"),
        (Fault::Syntax, "out of place"),
        (Fault::Empty, "nothing in it"),
        (Fault::Repeated, "an axis or the velocity twice"),
        (Fault::Range, "out of range"),
        (Fault::Limit, "leads too far, or from an unknown position"),
        (Fault::Busy, "no room"),
        (Fault::Order, "not the next number"),
        (Fault::Closed, "no session"),
        (Fault::Numberless, "without a number"),
        (Fault::Axis, "no such axis"),
        (Fault::Stopped, "stopped"),
        (Fault::Silent, "the host was silent"),
    ];
    match REASONS.iter().find(|(fault, _)| *fault as u8 == code) {
        Some((_, words)) => format!("{words} (error {code})"),
        None => format!("error {code}"),
    }
}
