//! Standard output and standard error, either of which may be a terminal or closed.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::{self, BufWriter, IsTerminal, StdoutLock, Write};

use serde_json::Value;

use crate::system::{has_escapes, is_abandoned};

/// Standard output: lines, and on a terminal a live line below them.
pub(crate) struct Screen {
    out: BufWriter<StdoutLock<'static>>,
    is_terminal: bool,
    /// The live line is on the screen.
    is_live: bool,
}

impl Screen {
    pub(crate) fn new() -> Self {
        let out = io::stdout().lock();
        Self { is_terminal: out.is_terminal() && has_escapes(), out: BufWriter::new(out), is_live: false }
    }

    /// Whether there are live lines.
    pub(crate) fn is_terminal(&self) -> bool {
        self.is_terminal
    }

    /// Whether nobody will read what is printed.
    pub(crate) fn is_abandoned(&self) -> bool {
        is_abandoned(self.out.get_ref())
    }

    pub(crate) fn line(&mut self, text: &str) -> io::Result<()> {
        self.put(text)?;
        self.flush()
    }

    /// A line that is shown with the next ones, or by [`flush`](Self::flush).
    pub(crate) fn put(&mut self, text: &str) -> io::Result<()> {
        if self.is_live {
            self.is_live = false;
            write!(self.out, "\r\x1b[K")?;
        }
        writeln!(self.out, "{}", printable(text))
    }

    /// JSON on a line. What a terminal could obey is escaped, which JSON asks for only in part.
    pub(crate) fn put_json(&mut self, value: &Value) -> io::Result<()> {
        writeln!(
            self.out,
            "{}",
            escaped(&value.to_string(), |letter, text| {
                for unit in letter.encode_utf16(&mut [0; 2]) {
                    let _ = write!(text, "\\u{unit:04x}");
                }
            })
        )
    }

    pub(crate) fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }

    /// Replaces the live line, if there can be one.
    pub(crate) fn live(&mut self, text: &str) -> io::Result<()> {
        if self.is_terminal {
            write!(self.out, "\r{}\x1b[K", printable(text))?;
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
}

/// Whether a terminal may obey a letter, or show others in another place than where they are: control characters, line
/// and paragraph separators, and what formats text, such as U+202E, which turns its direction.
fn is_unprintable(letter: char) -> bool {
    letter.is_control()
        || matches!(
            letter,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}'
        )
}

fn escaped(text: &str, escape: impl Fn(char, &mut String)) -> Cow<'_, str> {
    if !text.contains(is_unprintable) {
        return text.into();
    }
    let mut out = String::new();
    for letter in text.chars() {
        if is_unprintable(letter) { escape(letter, &mut out) } else { out.push(letter) }
    }
    out.into()
}

/// Text from another's hands: one line that controls nothing, whatever is in it.
pub(crate) fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, |letter, out| {
        if letter.is_control() { out.extend(letter.escape_default()) } else { out.extend(letter.escape_unicode()) }
    })
}

/// A line on standard error. If that is closed, nobody wants to know.
pub fn complain(text: &str) {
    let _ = writeln!(io::stderr(), "deltarobot: {}", printable(text));
}

#[cfg(test)]
mod tests {
    use super::printable;

    #[test]
    fn what_terminals_obey_is_escaped() {
        assert_eq!(
            printable("a\u{1b}[2J\n\u{7f}\u{9b}\u{202e}b\u{2066}\u{e0041}é"),
            "a\\u{1b}[2J\\n\\u{7f}\\u{9b}\\u{202e}b\\u{2066}\\u{e0041}é"
        );
    }
}
