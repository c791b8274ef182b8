//! The contract of lines in the simplest words that say it exactly.

use std::ffi::{c_int, c_uint};

use deltarobot::line_protocol::{OLP_RC_MALFORMED, OLP_RC_NO_COMMAND};
use deltarobot::sizes::OLP_LINE_MAX;

/// What a line says.
#[derive(Debug)]
pub struct Parsed<'a> {
    pub params: Vec<(&'a [u8], &'a [u8])>,
    pub checksum: c_int,
    pub sum: c_uint,
    pub length: usize,
}

impl Parsed<'_> {
    /// The parameters, the command decoded: as they are in a line that was built of them.
    pub fn params_with<'b>(&'b self, built: &'b [u8]) -> Vec<(&'b [u8], &'b [u8])> {
        let mut params = self.params.clone();
        let end = built.iter().position(|byte| *byte == b'&').unwrap();
        params[0] = (&built[..1], &built[2..end]);
        params
    }
}

/// Folded after each addition.
pub fn fletcher16(bytes: &[u8]) -> c_uint {
    let (mut first, mut second) = (0xFF, 0xFF);
    for byte in bytes {
        first += c_uint::from(*byte);
        first = (first & 0xFF) + (first >> 8);
        second += first;
        second = (second & 0xFF) + (second >> 8);
    }
    second << 8 | first
}

/// `olp_parse`: what the line says, or the return code.
pub fn parse(line: &[u8]) -> Result<Parsed<'_>, c_int> {
    let line = match line.strip_suffix(b"\n") {
        Some(line) => line.strip_suffix(b"\r").unwrap_or(line),
        None => line,
    };
    let params: Vec<_> = line
        .split(|byte| *byte == b'&')
        .filter(|piece| !piece.is_empty())
        .map(|piece| match piece.iter().position(|byte| *byte == b'=') {
            Some(at) => (&piece[..at], &piece[at + 1..]),
            None => (piece, &piece[piece.len()..]),
        })
        .collect();
    if line.first() != Some(&b'c') || params[0].0 != b"c" {
        return Err(OLP_RC_NO_COMMAND);
    }
    let escapes = line.split(|byte| *byte == b'%').skip(1);
    let is_escape = |text: &[u8]| text.len() >= 2 && text[..2].iter().all(u8::is_ascii_hexdigit);
    if line.contains(&b'\n') || !escapes.map(is_escape).all(|right| right) {
        return Err(OLP_RC_MALFORMED);
    }
    let length = line.len();
    // The first parameter s, which must be the last one.
    let given = (1..length).find(|at| line[*at..].starts_with(b"&s=") || line[*at..] == *b"&s");
    let (checksum, sum) = match given {
        Some(at) => {
            let sum = fletcher16(&line[..at]);
            let right = line[at..].to_ascii_lowercase() == format!("&s={sum:04x}").into_bytes();
            (if right { 1 } else { 2 }, sum)
        }
        None => (0, fletcher16(line)),
    };
    Ok(Parsed { params, checksum, sum, length })
}

/// A value's text.
pub fn decoded(mut raw: &[u8]) -> Vec<u8> {
    let mut text = Vec::new();
    while let Some((first, rest)) = raw.split_first() {
        raw = rest;
        text.push(match first {
            b'+' => b' ',
            b'%' => {
                let (digits, rest) = rest.split_at(2);
                raw = rest;
                u8::from_str_radix(std::str::from_utf8(digits).unwrap(), 16).unwrap()
            }
            byte => *byte,
        });
    }
    text
}

/// A value's text without what may surround a number, if it is one: an optional sign, digits with or without a point,
/// an optional exponent.
pub fn number(text: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(text).ok()?.trim_matches(' ');
    let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
    let (significand, exponent) = digits.split_once(['e', 'E']).unwrap_or((digits, "0"));
    let exponent_digits = exponent.strip_prefix(['-', '+', ' ']).unwrap_or(exponent);
    let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let (whole, fraction) = significand.split_once('.').unwrap_or((significand, ""));
    let right = is_digits(whole)
        && is_digits(fraction)
        && whole.len() + fraction.len() > 0
        && is_digits(exponent_digits)
        && !exponent_digits.is_empty();
    right.then(|| text.replace("e ", "e").replace("E ", "E"))
}

/// What a receiver finds in a stream: lines, or `None` where one was too long.
pub fn lines(stream: &[u8]) -> Vec<Option<Vec<u8>>> {
    let mut lines = Vec::new();
    let mut pieces: Vec<_> = stream.split(|byte| *byte == b'\n').collect();
    pieces.pop();
    for piece in pieces {
        let line = piece.strip_suffix(b"\r").unwrap_or(piece);
        if line.len() > OLP_LINE_MAX {
            lines.push(None);
        } else if !line.is_empty() {
            lines.push(Some(line.to_vec()));
        }
    }
    lines
}
