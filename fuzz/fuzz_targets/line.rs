//! Lines of the Ozeki line protocol: any bytes, in any pieces, are received, read and built again as the contract says.
#![no_main]

use std::ffi::{c_char, c_int, c_long, c_uint};
use std::ptr::null;

use deltarobot::line_protocol::encoder::*;
use deltarobot::line_protocol::message::*;
use deltarobot::line_protocol::*;
use deltarobot::sizes::OLP_LINE_MAX;
use deltarobot_fuzz::input::Input;
use deltarobot_fuzz::line_contract::{Parsed, decoded, fletcher16, lines, number, parse};
use deltarobot_fuzz::object::{Object, Plain};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: &[u8]| {
    let mut input = Input(input);
    match input.byte() % 4 {
        0 => receive(&mut input),
        1 => build(&mut input),
        2 => scribbled(&mut input),
        _ => read(input.0),
    }
});

/// A stream in pieces, each an allocation of its own.
fn receive(input: &mut Input) {
    let receiver = Object::<Receiver>::default();
    let mut pieces = Vec::new();
    while !input.is_empty() {
        let length = usize::from(input.byte());
        pieces.push(Box::<[u8]>::from(input.slice(length)));
    }
    let mut received = Vec::new();
    for piece in &pieces {
        let mut rest = &piece[..];
        while !rest.is_empty() {
            let mut line = LineText { kind: -1, text: null(), length: -1 };
            let taken =
                unsafe { olp_receive(receiver.ptr(), rest.as_ptr().cast(), rest.len() as c_int, &raw mut line) };
            assert!(0 < taken && taken as usize <= rest.len());
            match line.kind {
                0 => assert_eq!(taken as usize, rest.len()),
                1 => {
                    let text = unsafe { bytes(line.text, line.length) };
                    assert_eq!(unsafe { *line.text.add(text.len()) }, 0);
                    read(text);
                    received.push(Some(text.to_vec()));
                }
                2 => received.push(None),
                kind => panic!("{kind}"),
            }
            rest = &rest[taken as usize..];
        }
    }
    assert_eq!(received, lines(&pieces.concat()));
}

/// A line and everything that it says.
fn read(line: &[u8]) {
    let line = Box::<[u8]>::from(line);
    let mut message = LineMessage::zero();
    let code = unsafe { olp_parse(line.as_ptr().cast(), line.len() as c_int, &raw mut message) };
    let expected = match parse(&line) {
        Ok(expected) => expected,
        Err(expected) => {
            assert_eq!(code, expected);
            assert!(message.line.is_null() && message.length == 0 && message.count == 0);
            return;
        }
    };
    assert_eq!(code, 0);
    assert_eq!(message.count as usize, expected.params.len());
    assert_eq!((message.checksum, message.sum), (expected.checksum, expected.sum));
    for (index, (name, value)) in expected.params.iter().enumerate() {
        let mut param = LineParam::zero();
        assert_eq!(unsafe { olp_param_at(&raw const message, index as c_int, &raw mut param) }, 0);
        assert_eq!(unsafe { bytes(param.name, param.name_length) }, *name);
        assert_eq!(unsafe { bytes(param.value, param.value_length) }, *value);
        read_value(&param, value);
        if !name.contains(&0) {
            let name_c = c_string(name);
            let occurrence = expected.params[..index].iter().filter(|(other, _)| other == name).count();
            let mut found = LineParam::zero();
            let code =
                unsafe { olp_find(&raw const message, name_c.as_ptr().cast(), occurrence as c_int, &raw mut found) };
            assert_eq!((code, found.value, found.name), (0, param.value, param.name));
        }
    }
    let mut param = LineParam::zero();
    assert_eq!(unsafe { olp_param_at(&raw const message, message.count, &raw mut param) }, OLP_RC_NOT_FOUND);
    build_again(&expected);
}

fn read_value(param: &LineParam, raw: &[u8]) {
    let text = decoded(raw);
    for cap in [0, text.len(), text.len() + 1] {
        let mut room = vec![0x55_u8; cap].into_boxed_slice();
        let length = unsafe { olp_value_string(param, room.as_mut_ptr().cast(), cap as c_int) };
        if cap > text.len() {
            assert_eq!(length as usize, text.len());
            assert_eq!(room[..text.len()], text);
            assert_eq!(room[text.len()], 0);
        } else {
            assert_eq!(length, -OLP_RC_TOO_LONG);
            assert!(room.iter().enumerate().all(|(at, byte)| *byte == if at == 0 { 0 } else { 0x55 }));
        }
    }
    if !text.contains(&0) {
        assert_eq!(unsafe { olp_value_is(param, c_string(&text).as_ptr().cast()) }, 1);
    }

    let mut int: c_long = 0;
    let code = unsafe { olp_value_int(param, &raw mut int) };
    let plain = number(&text).filter(|text| !text.contains(['.', 'e', 'E']));
    match plain.map(|text| text.parse::<c_long>()) {
        Some(Ok(expected)) => assert_eq!((code, int), (0, expected)),
        Some(Err(_)) => assert_eq!(code, OLP_RC_RANGE),
        None => assert_eq!(code, OLP_RC_MALFORMED),
    }
    let mut float = 0.0_f32;
    let code = unsafe { olp_value_float(param, &raw mut float) };
    match number(&text).map(|text| text.parse::<f32>().unwrap()) {
        Some(expected) if expected.is_finite() => assert_eq!((code, float.to_bits()), (0, expected.to_bits())),
        Some(_) => assert_eq!(code, OLP_RC_RANGE),
        None => assert_eq!(code, OLP_RC_MALFORMED),
    }
}

/// What was read, built again parameter by parameter, is read as the same, if it may be sent at all.
fn build_again(expected: &Parsed) {
    let command = decoded(expected.params[0].1);
    // No string of C's has a zero byte in it.
    if command.contains(&0) || expected.params.iter().any(|(name, _)| name.contains(&0)) {
        return;
    }
    let mut room = vec![0x55_u8; 2 * expected.length + 16].into_boxed_slice();
    let mut encoder = LineEncoder::zero();
    let is_name =
        |name: &[u8]| !name.is_empty() && name.iter().all(|byte| byte.is_ascii_alphanumeric() || *byte == b'_');
    let mut strict = is_name(&command);
    let mut built = [b"c=", &command[..]].concat();
    unsafe {
        olp_begin(&raw mut encoder, room.as_mut_ptr().cast(), room.len() as c_int, c_string(&command).as_ptr().cast());
    }
    for (name, value) in &expected.params[1..] {
        strict &= is_name(name) && *name != b"s";
        strict &= !value.contains(&b'\r');
        built.extend([b"&", *name, b"=", value].concat());
        unsafe {
            olp_add_raw(&raw mut encoder, c_string(name).as_ptr().cast(), value.as_ptr().cast(), value.len() as c_int);
        }
    }
    let length = unsafe { olp_finish(&raw mut encoder, 1) };
    if strict {
        built.extend(format!("&s={:04x}\n", fletcher16(&built)).bytes());
        assert_eq!(room[..length as usize], built);
        let again = parse(&built).unwrap();
        assert_eq!(again.checksum, 1);
        assert_eq!(again.params[..again.params.len() - 1], expected.params_with(&built));
    } else {
        assert!(length < 0);
        assert_eq!(room[0], 0);
    }
}

/// A line with values of all types: read as what it was built of, or refused.
fn build(input: &mut Input) {
    let cap = usize::from(input.byte()) + 64 * usize::from(input.byte() % 8);
    let mut room = vec![0x55_u8; cap].into_boxed_slice();
    let mut encoder = LineEncoder::zero();
    let is_command = input.byte() % 2 == 1;
    let begin = if is_command { olp_begin_command } else { olp_begin };
    unsafe { begin(&raw mut encoder, room.as_mut_ptr().cast(), cap as c_int, c"x".as_ptr()) };
    let mut values = Vec::new();
    let mut refused = false;
    while !input.is_empty() {
        let kind = input.byte();
        let mut raw = [0; 8];
        raw.fill_with(|| input.byte());
        let name = c"v".as_ptr();
        let text = unsafe {
            match kind % 4 {
                0 => {
                    let value = c_long::from_le_bytes(raw) >> (kind >> 2);
                    olp_add_int(&raw mut encoder, name, value);
                    value.to_string().into_bytes()
                }
                1 => {
                    let value = f32::from_le_bytes([raw[0], raw[1], raw[2], raw[3]]);
                    let decimals = c_int::from(raw[4] % 12) - 1;
                    olp_add_float(&raw mut encoder, name, value, decimals);
                    refused |= !value.is_finite() || !(0..=9).contains(&decimals);
                    format!("{value:.*}", usize::try_from(decimals).unwrap_or(0)).into_bytes()
                }
                2 => {
                    let value = c_uint::from_le_bytes([raw[0], raw[1], raw[2], raw[3]]);
                    olp_add_hex(&raw mut encoder, name, value);
                    format!("{:04x}", value & 0xFFFF).into_bytes()
                }
                _ => {
                    let text = Box::<[u8]>::from(input.slice(usize::from(raw[0])));
                    olp_add_bytes(&raw mut encoder, name, text.as_ptr().cast(), text.len() as c_int);
                    text.into_vec()
                }
            }
        };
        values.push(text);
    }
    let checksum = input.byte() % 2;
    let length = unsafe { olp_finish(&raw mut encoder, checksum.into()) };
    if length < 0 {
        assert!(length == -OLP_RC_TOO_LONG || refused && length == -OLP_RC_RANGE);
        assert!(room.first().is_none_or(|first| *first == 0));
        return;
    }
    assert!(!refused && length as usize <= if is_command { cap.min(64) } else { cap });
    let parsed = parse(&room[..length as usize]).unwrap();
    assert_eq!(parsed.checksum, checksum.into());
    let read: Vec<_> = parsed.params.iter().filter(|(name, _)| name == b"v").map(|(_, value)| decoded(value)).collect();
    assert_eq!(read, values);
}

/// Structs whose contents are anything do no harm.
fn scribbled(input: &mut Input) {
    let mut receiver = Object::<Receiver>::default();
    receiver.scribble(input, 0..0);
    let bytes = Box::<[u8]>::from(input.slice(40));
    let mut line = LineText { kind: -1, text: null(), length: -1 };
    let taken = unsafe { olp_receive(receiver.ptr(), bytes.as_ptr().cast(), bytes.len() as c_int, &raw mut line) };
    assert!(0 <= taken && taken as usize <= bytes.len() && (0..=2).contains(&line.kind));
    if line.kind == 1 {
        assert!(0 < line.length && line.length as usize <= OLP_LINE_MAX);
    }

    let mut room = [0x55_u8; 64];
    let mut encoder = Object::<LineEncoder>::default();
    unsafe {
        olp_begin(encoder.ptr(), room.as_mut_ptr().cast(), room.len() as c_int, c"x".as_ptr());
        // All but where the room is, and how much of it there is.
        encoder.scribble(input, 0..size_of::<*mut c_char>() + size_of::<c_int>());
        olp_add_int(encoder.ptr(), c"v".as_ptr(), 1);
        assert!(olp_finish(encoder.ptr(), 1) <= 64);
    }
}

/// # Safety
///
/// They are there as long as the slice.
unsafe fn bytes<'a>(text: *const c_char, length: c_int) -> &'a [u8] {
    unsafe { std::slice::from_raw_parts(text.cast(), usize::try_from(length).unwrap()) }
}

fn c_string(text: &[u8]) -> Box<[u8]> {
    [text, b"\0"].concat().into_boxed_slice()
}
