use super::{Decoder, Items, Side};
use std::time::Duration;

fn feed(items: &mut Items, from: Option<Side>, bytes: &[u8]) -> Vec<String> {
    let pieces = items.feed(from, bytes).into_iter();
    pieces.map(|piece| format!("{} {}", piece.from.map_or(' ', Side::arrow), piece.text)).collect()
}

/// All that was sent, and that it does not matter in which portions it comes.
fn all(from: Option<Side>, bytes: &[u8]) -> Vec<String> {
    let [mut whole, mut single] = [Items::default(), Items::default()];
    let mut texts = feed(&mut whole, from, bytes);
    let mut one_by_one: Vec<_> = bytes.iter().flat_map(|byte| feed(&mut single, from, &[*byte])).collect();
    for (texts, items) in [(&mut texts, &mut whole), (&mut one_by_one, &mut single)] {
        texts.extend(
            items.end(from).into_iter().map(|piece| format!("{} {}", piece.from.map_or(' ', Side::arrow), piece.text)),
        );
    }
    assert_eq!(texts, one_by_one);
    texts
}

const COMMANDS: &[u8] = b"!\x83\xE8\x87\x80\x80\x98\xF8\xFF\xFF*\x83\x81\xFF#12 V1000x400y300\n#\x81\x80!\xC0\xE8\x87\
        R250\r\n~\x80\x80";
const NOTICES: &[u8] = b"#12\n#\x81\x80#\x82\x80?\x87?4\n=\x21\x83\xE8\x87\x80\x80\x98\xF8\xFF\xFF=x400y-3\n#\x80\x81";

#[test]
fn commands_and_notices() {
    let commands = [
        "> move  x=1000  y=-1000",
        "> step  x=+1  y=-1",
        "> #12 move  x=400  y=300  V=1000 (ASCII)",
        "> #1 velocity  V=1000",
        "> reporting  each 250 ms (ASCII)",
        "> reporting  off",
    ];
    let notices = [
        "< #12 completed (ASCII)",
        "< #1 completed",
        "< #2 refused  out of range (error 7)",
        "< refused  out of place (error 4) (ASCII)",
        "< position  x=1000  y=-1000",
        "< position  x=400  y=-3 (ASCII)",
        "< #128 completed",
    ];
    assert_eq!(all(Some(Side::Host), COMMANDS), commands);
    assert_eq!(all(Some(Side::Controller), NOTICES), notices);
    assert_eq!(all(None, COMMANDS), commands);
    assert_eq!(all(None, NOTICES), notices);
    let both = [COMMANDS, NOTICES, b"\n", COMMANDS].concat();
    assert_eq!(all(None, &both), [commands.as_slice(), notices.as_slice(), commands.as_slice()].concat());
}

#[test]
fn what_is_malformed() {
    assert_eq!(
        all(Some(Side::Host), b"!\x83\xE8*\x81\x81x1q5y6\nx7\n\x80\x81"),
        [
            "> garbage: 21 83 E8 (interrupted (error 3))",
            "> step  x=+1",
            "> garbage: 78 31 71 35 79 36 (out of place (error 4))",
            "> move  x=7 (ASCII)",
            "> garbage: 80 81 (no command begins like that (error 1))",
        ]
    );
    assert_eq!(all(None, b"=x1q5y6\nx7\n")[1], "> move  x=7 (ASCII)");
    assert_eq!(all(None, b"!\x83\x1Bx7\n"), ["  clear", "> move  x=7 (ASCII)"]);
    assert_eq!(all(None, b"#123456789012345678901234567890x5\n").len(), 1);
    let noise: Vec<_> = (0..2000_u32).map(|place| (place.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    assert!(!all(None, &noise).is_empty());
}

#[test]
fn silence() {
    const GAP: Duration = Duration::from_millis(50);
    let mut items = Items::default();
    assert!(feed(&mut items, None, b"#\x81\x80").is_empty());
    assert_eq!(items.idle(None, Duration::from_millis(49), GAP), []);
    assert_eq!(items.idle(None, Duration::from_millis(50), GAP)[0].text, "#1 completed");
    assert!(feed(&mut items, None, b"x12").is_empty());
    assert_eq!(items.idle(None, Duration::from_millis(999), GAP), []);
    assert_eq!(items.idle(None, Duration::from_secs(1), GAP)[0].text, "garbage: 78 31 32 (interrupted (error 3))");
    assert_eq!(items.end(None), []);
}
