//! A recording in MCAP: `deltarobot-convert` makes it of the text that is written to it.

use std::fs::File;
use std::path::Path;
use std::process::{Child, Stdio};

use super::FileOptions;
use crate::source::mcap::converter;
use crate::status::Failure;
use crate::system::Handle;

/// One that runs.
pub(super) struct Converter(Child);

impl Converter {
    /// Starts one, and gives what to write to.
    pub(super) fn start(options: &FileOptions) -> Result<(Self, File), Failure> {
        let mut command = converter()?;
        command.args(["--from", "text", "--to", "mcap", "--force", "--protocol", options.spoken.protocol.name()]);
        if let Some(size) = options.rotate {
            command.args(["--rotate", &size.to_string()]);
        }
        if let Some(time) = options.rotate_after {
            command.args(["--rotate-after", &time.to_string()]);
        }
        // It ends with what it is given, and not by a Ctrl-C at the terminal.
        command.args(["--to-end", "--", "-"]).arg(&options.file).stdin(Stdio::piped());
        let spawned = command.spawn();
        let mut child = spawned.map_err(|error| Failure::of_file("deltarobot-convert", &error))?;
        let pipe = child.stdin.take().map(|pipe| File::from(Handle::from(pipe)));
        pipe.map(|pipe| (Self(child), pipe)).ok_or_else(|| Failure::of("deltarobot-convert", "has no input"))
    }

    /// Waits until all is written.
    pub(super) fn end(mut self, name: &Path) -> Result<(), Failure> {
        match self.0.wait() {
            Ok(status) if status.success() => Ok(()),
            // It has said why.
            Ok(_) => Err(Failure::of(name.display(), "not recorded to its end")),
            Err(error) => Err(Failure::of_file("deltarobot-convert", &error)),
        }
    }
}
