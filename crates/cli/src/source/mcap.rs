//! MCAP, which `deltarobot-convert` makes text of: what reads it takes longer to compile than all of this program.

use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::external::find;
use crate::screen::complain;
use crate::status::Failure;
use crate::system::Handle;

/// What such a file begins with.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// Whether a file begins as such files do. It is read from its beginning afterwards.
pub(super) fn is_mcap(file: &mut File) -> io::Result<bool> {
    let mut first = Vec::new();
    if !file.metadata()?.is_file() {
        return Ok(false);
    }
    file.take(8).read_to_end(&mut first)?;
    file.rewind()?;
    Ok(first == MAGIC)
}

/// The program that converts recordings.
pub(crate) fn converter() -> Result<Command, Failure> {
    let program = find("deltarobot-convert").ok_or_else(|| {
        Failure::Usage("for MCAP the program deltarobot-convert is needed, beside this one or in the PATH".into())
    })?;
    Ok(Command::new(program))
}

/// One that runs.
pub(super) struct Converter {
    child: Child,
    is_silent: bool,
}

impl Converter {
    /// Starts one, and gives the text that it makes.
    pub(super) fn start(path: &Path) -> Result<(Self, File), Failure> {
        let mut command = converter()?;
        command.args(["--from", "mcap", "--to", "text", "--"]).arg(path).arg("-");
        let spawned = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let mut child = spawned.map_err(|error| Failure::of_file("deltarobot-convert", &error))?;
        let text = child.stdout.take().map(|pipe| File::from(Handle::from(pipe)));
        let text = text.ok_or_else(|| Failure::of("deltarobot-convert", "has no output"))?;
        Ok((Self { child, is_silent: false }, text))
    }

    /// What it complains about is known.
    pub(super) const fn silence(&mut self) {
        self.is_silent = true;
    }

    /// All of the text was read: says what could not be converted.
    pub(super) fn end(mut self) -> Result<(), Failure> {
        let mut said = String::new();
        let failure = |error: io::Error| Failure::of_file("deltarobot-convert", &error);
        if let Some(mut pipe) = self.child.stderr.take() {
            pipe.read_to_string(&mut said).map_err(failure)?;
        }
        let said = said.trim_end().trim_start_matches("deltarobot: ");
        if !self.child.wait().map_err(failure)?.success() {
            return Err(Failure::Device(said.to_owned()));
        }
        if !said.is_empty() && !self.is_silent {
            complain(said);
        }
        Ok(())
    }
}

impl Drop for Converter {
    /// Where it was not read to its end.
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
