//! Bytes as hexadecimal digits.

/// Bytes as text, such as `24 53 00 B1 3A`.
pub fn hex(bytes: &[u8]) -> String {
    let digit = |value: u8| char::from(b"0123456789ABCDEF".get(usize::from(value)).copied().unwrap_or(b'?'));
    let mut text = String::with_capacity(3 * bytes.len());
    for byte in bytes {
        if !text.is_empty() {
            text.push(' ');
        }
        text.extend([digit(byte >> 4), digit(byte & 15)]);
    }
    text
}

/// Bytes from text: hexadecimal digits, two a byte; spaces, commas, colons, hyphens and `0x` in between don't matter.
pub fn from_hex(text: &str) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    append_hex(text, &mut bytes).map(|()| bytes)
}

/// Appends such bytes.
pub fn append_hex(text: &str, bytes: &mut Vec<u8>) -> Result<(), String> {
    let value = |digit: u8| char::from(digit).to_digit(16).and_then(|value| u8::try_from(value).ok());
    for word in text.split(|separator: char| separator.is_ascii_whitespace() || ",:;-".contains(separator)) {
        let digits = word.strip_prefix("0x").or_else(|| word.strip_prefix("0X")).unwrap_or(word);
        for pair in digits.as_bytes().chunks(2) {
            match pair {
                [high, low] if let (Some(high), Some(low)) = (value(*high), value(*low)) => bytes.push(high << 4 | low),
                _ if digits.len() % 2 != 0 && digits.is_ascii() => {
                    return Err(format!("`{word}` has an odd number of hexadecimal digits"));
                }
                _ => return Err(format!("`{word}` is not hexadecimal")),
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{from_hex, hex};

    #[test]
    fn hexadecimal_digits() {
        for text in ["24 53 00 B1 3A", "245300b13a", "0x24,0x53 0x00B13a", "24:53:00:B1:3A", " 24-5300B1 3A\n"] {
            assert_eq!(hex(&from_hex(text).unwrap()), "24 53 00 B1 3A");
        }
        assert!(from_hex("").unwrap().is_empty());
        for text in ["2", "24 5", "2G", "é4", "+1", "0x"] {
            assert_eq!(from_hex(text).is_err(), text != "0x", "{text}");
        }
    }
}
