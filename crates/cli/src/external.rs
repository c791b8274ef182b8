//! Subcommands that are programs of their own: an executable `deltarobot-NAME` beside this one, or in the PATH.

use std::env;
use std::ffi::OsString;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::status::Failure;

/// Becomes that program. Returns why it could not.
pub(crate) fn run(words: &[OsString]) -> Failure {
    let Some((name, arguments)) = words.split_first() else { return Failure::Usage("a subcommand is needed".into()) };
    let name = name.to_string_lossy();
    match find(&format!("deltarobot-{name}")) {
        Some(program) => {
            let error = Command::new(&program).args(arguments).exec();
            Failure::of_file(program.display(), &error)
        }
        None => Failure::Usage(format!("unrecognized subcommand '{name}'; try --help")),
    }
}

/// Where the program of that name is.
pub(crate) fn find(name: &str) -> Option<PathBuf> {
    if name.contains('/') {
        return None;
    }
    let beside = env::current_exe().ok().and_then(|program| program.parent().map(Path::to_owned));
    let path = env::var_os("PATH").unwrap_or_default();
    let is_program = |path: &PathBuf| {
        path.metadata().is_ok_and(|metadata| metadata.is_file() && metadata.permissions().mode() & 0o111 != 0)
    };
    beside.into_iter().chain(env::split_paths(&path)).map(|directory| directory.join(name)).find(is_program)
}
