//! Bytes as hexadecimal digits.

/// Bytes as text, such as `24 53 00 B1 3A`.
pub(crate) fn hex(bytes: &[u8]) -> String {
    let words: Vec<_> = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
    words.join(" ")
}

/// Bytes from text: hexadecimal digits, two a byte; spaces, commas, colons, hyphens and `0x` in between don't matter.
pub(crate) fn from_hex(text: &str) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    for word in text.split(|separator: char| separator.is_whitespace() || ",:;-".contains(separator)) {
        let digits = word.strip_prefix("0x").or_else(|| word.strip_prefix("0X")).unwrap_or(word);
        if digits.len() % 2 != 0 && digits.is_ascii() {
            return Err(format!("`{word}` has an odd number of hexadecimal digits"));
        }
        for pair in digits.as_bytes().chunks(2) {
            let byte =
                std::str::from_utf8(pair).ok().filter(|pair| pair.bytes().all(|digit| digit.is_ascii_hexdigit()));
            match byte.and_then(|pair| u8::from_str_radix(pair, 16).ok()) {
                Some(byte) => bytes.push(byte),
                None => return Err(format!("`{word}` is not hexadecimal")),
            }
        }
    }
    Ok(bytes)
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
