//! `deltarobot ui`: the station for one robot, in a browser of this machine.

use std::env;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

use clap::Parser;
use deltarobot_cli::path::Machine;
use deltarobot_cli::screen::complain;
use deltarobot_cli::status::{Failure, Status};

use crate::config::{self, File};

/// Shows a robot in a browser: it can be watched, moved, and given paths to trace there.
///
/// The browser is the one that the environment variable BROWSER names, or the system's. Ends with Ctrl-C.
#[derive(Debug, Parser)]
#[command(name = "deltarobot ui", bin_name = "deltarobot ui", version, max_term_width = 100)]
struct Arguments {
    /// The device (or `tcp://HOST:PORT`, `rfc2217://HOST:PORT`)
    #[arg(env = "DELTAROBOT_PORT", required_unless_present = "sim")]
    port: Option<PathBuf>,
    /// Shows a simulated robot instead
    #[arg(long, conflicts_with = "port")]
    sim: bool,
    /// The robot's measures, as `deltarobot path` takes them
    #[arg(long, value_name = "FILE", requires = "port")]
    geometry: Option<PathBuf>,
    /// Prints the address alone, and starts no browser
    #[arg(long)]
    no_open: bool,
}

/// Does what the command line says.
#[must_use]
pub fn main() -> ExitCode {
    let result = Arguments::try_parse().map_or_else(|error| deltarobot_cli::explain(&error), run);
    result.unwrap_or_else(|failure| failure.end()).into()
}

fn run(arguments: Arguments) -> Result<Status, Failure> {
    let geometry = arguments.geometry.as_deref().map(read).transpose()?;
    let mut file = File { listen: Some(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0)), ..File::default() };
    match arguments.port {
        Some(port) => {
            file.robots.insert(name_of(&port)?, config::Robot::at(port).with_geometry(geometry));
        }
        None => file.simulated = 1,
    }
    let config = file.check(false)?;
    crate::serve(config, false, |url| {
        if !arguments.no_open {
            show(url);
        }
    })
}

fn read(path: &Path) -> Result<Machine, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| Failure::of_file(path.display(), &error))?;
    Machine::read(&text).map_err(|error| Failure::of(path.display(), error.to_string()))
}

/// The last part of a port's name, of the letters that names take.
fn name_of(port: &Path) -> Result<config::Name, Failure> {
    let last = port.file_name().unwrap_or_default().to_string_lossy();
    let fits = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '-' };
    let name: String = last.chars().map(fits).take(64).collect();
    config::Name::try_from(if name.is_empty() { "robot".to_owned() } else { name }).map_err(Failure::Usage)
}

/// Opens the page. The address was printed, so that a person can do it as well.
fn show(url: &str) {
    let mut browser = browser();
    if let Err(error) = browser.arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn() {
        complain(&format!("{}: {error}; open {url} in a browser", browser.get_program().display()));
    }
}

/// What opens an address that it is given: `$BROWSER`, or what the system has for that.
fn browser() -> Command {
    if let Some(named) = env::var_os("BROWSER").filter(|name| !name.is_empty()) {
        return Command::new(named);
    }
    if cfg!(windows) {
        // Unlike `start`, a command of the shell's, it takes any address as it is.
        let mut system = Command::new("rundll32");
        system.arg("url.dll,FileProtocolHandler");
        return system;
    }
    Command::new(if cfg!(target_os = "macos") { "open" } else { "xdg-open" })
}
