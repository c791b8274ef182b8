//! Subcommands that are programs of their own: an executable `deltarobot-NAME` beside this one, or in the PATH.

use std::env::{self, consts::EXE_SUFFIX};
use std::ffi::OsString;
use std::path::{Path, PathBuf, is_separator};
use std::process::Command;

use crate::status::Failure;
use crate::system::{become_program, is_program};

/// Runs that program in place of this one. Returns why it could not.
pub(crate) fn run(words: &[OsString]) -> Failure {
    let Some((name, arguments)) = words.split_first() else { return Failure::Usage("a subcommand is needed".into()) };
    let name = name.to_string_lossy();
    match find(&format!("deltarobot-{name}")) {
        Some(program) => {
            let error = become_program(Command::new(&program).args(arguments));
            Failure::of_file(program.display(), &error)
        }
        None => Failure::Usage(format!("unrecognized subcommand '{name}'; try --help")),
    }
}

/// Where the program of that name is.
pub(crate) fn find(name: &str) -> Option<PathBuf> {
    if name.contains(is_separator) {
        return None;
    }
    let beside = env::current_exe().ok().and_then(|program| program.parent().map(Path::to_owned));
    let path = env::var_os("PATH").unwrap_or_default();
    let is_program = |path: &PathBuf| path.metadata().is_ok_and(|metadata| metadata.is_file() && is_program(&metadata));
    beside
        .into_iter()
        .chain(env::split_paths(&path))
        .map(|directory| directory.join(format!("{name}{EXE_SUFFIX}")))
        .find(is_program)
}
