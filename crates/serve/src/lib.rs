//! `deltarobot serve`: owns the ports of robots, and lets many programs watch and drive them.
//!
//! Each robot has a thread (`robot`), which owns its port and all that is known of it; everybody else leaves orders in
//! its inbox, and gets what it publishes. Whoever asks comes by HTTP (`api`), WebSockets (`watch`) or TCP (`raw`).

#![forbid(unsafe_code)]
#![allow(
    clippy::arithmetic_side_effects,
    reason = "numbers here are times and sizes of what fits in memory, and a program may stop where a library must not"
)]
#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a test that can't go on fails"))]

mod api;
mod config;
mod event;
mod fleet;
#[cfg(test)]
mod hostile;
mod http;
mod lease;
mod metrics;
mod mqtt;
mod outside;
mod problem;
mod raw;
mod record;
mod robot;
mod security;
mod simulated;
mod state;
mod station;
mod trace;
mod ui;
mod watch;

use std::io::{self, Write};
use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use clap::Parser;
use deltarobot_cli::bear_size_limits;
use deltarobot_cli::screen::complain;
use deltarobot_cli::status::{Failure, Status};
use deltarobot_cli::system::more_files;
use tokio::runtime::Runtime;

use api::App;
use config::{Config, File, Name};
use fleet::Fleet;
use outside::Outside;
pub use ui::main as ui;

/// How long the end of the program waits for those who watch.
const WATCHERS_TIME: Duration = Duration::from_secs(1);

/// Lets many programs watch robots, and one at a time drive each.
///
/// Listens for HTTP and WebSockets: /api/openapi.json describes them. Anybody who can connect may watch, and cancel.
#[derive(Debug, Parser)]
#[command(name = "deltarobot serve", bin_name = "deltarobot serve", version, max_term_width = 100)]
struct Arguments {
    /// Robots: a name for each, and the device that it is at (or `tcp://HOST:PORT`, `rfc2217://HOST:PORT`)
    #[arg(value_name = "NAME=PORT", value_parser = named)]
    robots: Vec<(Name, PathBuf)>,
    /// A file of settings
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// The address to listen at; 127.0.0.1:7373 by default
    #[arg(long, value_name = "ADDRESS:PORT")]
    listen: Option<SocketAddr>,
    /// Adds so many simulated robots, named sim1 and so on
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u16).range(0..=1000))]
    sim: Option<u16>,
    /// A file with the token that who drives or watches has to know; needed unless only this machine is listened to
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,
    /// A file with another token, which allows to watch and to cancel alone
    #[arg(long, value_name = "FILE")]
    watch_token_file: Option<PathBuf>,
    /// A name by which this program is reached, besides addresses and localhost
    #[arg(long, value_name = "NAME")]
    host: Vec<String>,
    /// Lets a motion go on when whoever began it is gone, instead of cancelling it
    #[arg(long)]
    keep_moving: bool,
}

fn named(text: &str) -> Result<(Name, PathBuf), String> {
    match text.split_once('=') {
        Some((name, port)) if !port.is_empty() => Ok((Name::try_from(name.to_owned())?, port.into())),
        _ => Err("not of the form NAME=PORT".into()),
    }
}

/// Does what the command line says.
#[must_use]
pub fn main() -> ExitCode {
    let result = Arguments::try_parse().map_or_else(|error| deltarobot_cli::explain(&error), run);
    result.unwrap_or_else(|failure| failure.end()).into()
}

impl Arguments {
    fn config(self) -> Result<Config, Failure> {
        let mut file = self.config.as_deref().map(File::read).transpose()?.unwrap_or_default();
        for (name, port) in self.robots {
            let text = format!("{} is named twice", name.0);
            if file.robots.insert(name, config::Robot::at(port)).is_some() {
                return Err(Failure::Usage(text));
            }
        }
        file.listen = self.listen.or(file.listen);
        file.simulated = self.sim.map_or(file.simulated, usize::from);
        file.tokens.drive = self.token_file.or(file.tokens.drive);
        file.tokens.watch = self.watch_token_file.or(file.tokens.watch);
        file.hosts.extend(self.host);
        file.check(self.keep_moving)
    }
}

fn run(arguments: Arguments) -> Result<Status, Failure> {
    let keep_moving = arguments.keep_moving;
    serve(arguments.config()?, keep_moving, |_| ())
}

/// Goes on until a signal. `listening` gets the address of the page.
fn serve(mut config: Config, keep_moving: bool, listening: impl FnOnce(&str)) -> Result<Status, Failure> {
    // A thousand connections.
    more_files();
    bear_size_limits()?;
    let listener = listen(config.listen)?;
    let raw: Vec<_> =
        config.raw.iter().map(|(name, address)| Ok((name, listen(*address)?))).collect::<Result<_, Failure>>()?;
    for (number, path) in (1..).zip(simulated::start(config.simulated)?) {
        let settings = config::plain(format!("sim{number}").into(), path);
        if config.robots.iter().any(|robot| robot.name == settings.name) {
            return Err(Failure::Usage(format!("{} is named twice", settings.name)));
        }
        config.robots.push(robot::Settings { cancels_abandoned: !keep_moving, ..settings });
    }
    let failed = |error| Failure::of_file("threads", &error);
    let fleet = Arc::new(Fleet::start(config.robots).map_err(failed)?);
    let runtime = Runtime::new().map_err(failed)?;
    let outside = runtime.block_on(async { Outside::start(config.mqtt.as_ref(), config.record.as_ref(), &fleet) })?;
    let (guard, traces) = (Arc::new(config.guard), Arc::default());
    let app = App { fleet: Arc::clone(&fleet), guard, traces, outside: Arc::clone(&outside) };
    let result = runtime.block_on(async {
        let asked_to_end = asked_to_end().map_err(failed)?;
        for (name, listener) in raw {
            let Ok(robot) = fleet.robot(name) else { continue };
            say(&format!("{name}: raw bytes on {}", listener.local_addr().map_err(failed)?))?;
            tokio::spawn(raw::serve(tokio::net::TcpListener::from_std(listener).map_err(failed)?, Arc::clone(robot)));
        }
        let url = format!("http://{}", listener.local_addr().map_err(failed)?);
        say(&url)?;
        listening(&url);
        tokio::spawn(http::serve(tokio::net::TcpListener::from_std(listener).map_err(failed)?, api::router(app)));
        asked_to_end.await;
        Ok(Status::Finished)
    });
    // Whoever watches sees how that goes.
    fleet.end();
    runtime.block_on(outside.end());
    // A watcher that reads nothing is not waited for.
    let _ = runtime.block_on(async { tokio::time::timeout(WATCHERS_TIME, fleet.is_over.closed()).await });
    runtime.shutdown_timeout(Duration::from_millis(100));
    result
}

/// What is over when a signal has come, from the call on.
#[cfg(unix)]
fn asked_to_end() -> io::Result<impl Future<Output = ()>> {
    use tokio::signal::unix::{SignalKind, signal};
    let (mut terminated, mut interrupted) = (signal(SignalKind::terminate())?, signal(SignalKind::interrupt())?);
    Ok(async move {
        tokio::select! {
            _ = terminated.recv() => (),
            _ = interrupted.recv() => (),
        }
    })
}

/// The same for Ctrl-C, Ctrl-Break and the window that is closed.
#[cfg(windows)]
fn asked_to_end() -> io::Result<impl Future<Output = ()>> {
    use tokio::signal::windows::{ctrl_break, ctrl_c, ctrl_close};
    let (mut interrupted, mut broken, mut closed) = (ctrl_c()?, ctrl_break()?, ctrl_close()?);
    Ok(async move {
        tokio::select! {
            _ = interrupted.recv() => (),
            _ = broken.recv() => (),
            _ = closed.recv() => (),
        }
    })
}

/// A line of standard output, which nobody has to read.
fn say(line: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match writeln!(out, "{line}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

fn listen(address: SocketAddr) -> Result<TcpListener, Failure> {
    let failed = |error| Failure::of_file(address, &error);
    let listener = TcpListener::bind(address).map_err(failed)?;
    listener.set_nonblocking(true).map_err(failed)?;
    Ok(listener)
}

/// A panic of another thread has left nothing half done: each lock is held for one assignment.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
