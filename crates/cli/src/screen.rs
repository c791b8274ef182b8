//! Standard output and standard error, either of which may be a terminal or closed.

use std::io::{self, IsTerminal, StdoutLock, Write};

use serde_json::Value;

/// Standard output: lines, and on a terminal a live line below them.
pub(crate) struct Screen {
    out: StdoutLock<'static>,
    is_terminal: bool,
    /// The live line is on the screen.
    is_live: bool,
}

impl Screen {
    pub(crate) fn new() -> Self {
        let out = io::stdout().lock();
        Self { is_terminal: out.is_terminal(), out, is_live: false }
    }

    /// Whether there are live lines.
    pub(crate) fn is_terminal(&self) -> bool {
        self.is_terminal
    }

    pub(crate) fn line(&mut self, text: &str) -> io::Result<()> {
        self.clear()?;
        writeln!(self.out, "{text}")?;
        self.out.flush()
    }

    /// JSON on a line. What a terminal could obey is escaped, which JSON asks for only in part.
    pub(crate) fn json(&mut self, value: &Value) -> io::Result<()> {
        self.line(&without_controls(&value.to_string()))
    }

    /// Replaces the live line, if there can be one.
    pub(crate) fn live(&mut self, text: &str) -> io::Result<()> {
        if self.is_terminal {
            write!(self.out, "\r{text}\x1b[K")?;
            self.is_live = true;
            self.out.flush()?;
        }
        Ok(())
    }

    /// Bytes as they are.
    pub(crate) fn raw(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)?;
        self.out.flush()
    }

    fn clear(&mut self) -> io::Result<()> {
        if self.is_live {
            self.is_live = false;
            write!(self.out, "\r\x1b[K")?;
        }
        Ok(())
    }
}

/// The same JSON, in which only strings can have control characters.
fn without_controls(json: &str) -> String {
    let escaped = |letter: char| {
        if letter.is_control() { format!("\\u{:04x}", u32::from(letter)) } else { letter.to_string() }
    };
    json.chars().map(escaped).collect()
}

/// A line on standard error. If that is closed, nobody wants to know.
pub(crate) fn complain(text: &str) {
    let _ = writeln!(io::stderr(), "deltarobot: {text}");
}

#[cfg(test)]
mod tests {
    use super::without_controls;

    #[test]
    fn what_terminals_obey_is_escaped() {
        let value = serde_json::json!({ "a\u{9b}": "\u{1b}[31m\u{9b}31m\u{7f}\\\u{85}\u{e9}" });
        let text = without_controls(&value.to_string());
        assert_eq!(text, r#"{"a\u009b":"\u001b[31m\u009b31m\u007f\\\u0085é"}"#);
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
    }
}
