//! `deltarobot completions` and `man`: what shells and manuals know of the program.

use std::fs;
use std::path::PathBuf;

use clap::CommandFactory;
use clap_complete::Shell;

use crate::Cli;
use crate::screen::Screen;
use crate::status::{Failure, Status};

#[derive(Debug, clap::Args)]
pub(crate) struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

#[derive(Debug, clap::Args)]
pub(crate) struct Man {
    /// The directory to write them to
    directory: PathBuf,
}

pub(crate) fn completions(arguments: &Completions) -> Result<Status, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "deltarobot", &mut script);
    Screen::new().raw(&script)?;
    Ok(Status::Finished)
}

pub(crate) fn man(arguments: &Man) -> Result<Status, Failure> {
    let written = fs::create_dir_all(&arguments.directory)
        .and_then(|()| clap_mangen::generate_to(Cli::command(), &arguments.directory));
    written.map_err(|error| Failure::of_file(arguments.directory.display(), &error))?;
    Ok(Status::Finished)
}
