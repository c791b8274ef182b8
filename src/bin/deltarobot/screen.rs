//! Standard output and standard error, either of which may be a terminal or closed.

use std::io::{self, IsTerminal, StdoutLock, Write};

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

/// A line on standard error. If that is closed, nobody wants to know.
pub(crate) fn complain(text: &str) {
    let _ = writeln!(io::stderr(), "deltarobot: {text}");
}
