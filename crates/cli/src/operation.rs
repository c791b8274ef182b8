//! `deltarobot home`, `move`, `status` and `cancel`: one request, seen through to its end.

pub(crate) mod driver;
pub(crate) mod report;
mod seen;

use std::env;
use std::path::PathBuf;

use deltarobot_protocols::deltarobot::Position;

use crate::path::Machine;
use crate::path::command::read_machine;
use crate::port::PortOptions;
use crate::signals::Signals;
use crate::status::{Failure, Status};
use driver::{Driver, End, Request, Timing, Wait, wait};
use report::Reporter;

#[derive(Debug, clap::Args)]
pub(crate) struct Home {
    #[command(flatten)]
    operation: Operation,
    #[command(flatten)]
    common: Common,
}

/// A request that needs to know no more.
#[derive(Debug, clap::Args)]
pub(crate) struct Plain {
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, clap::Args)]
pub(crate) struct StatusQuery {
    #[command(flatten)]
    known: Known,
    #[command(flatten)]
    common: Common,
}

/// What is known of the machine.
#[derive(Debug, clap::Args)]
struct Known {
    /// Says where the platform is, too, by the machine's geometry: a file like examples/geometry.toml
    #[arg(long, value_name = "FILE")]
    geometry: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub(crate) struct Move {
    /// Displacement of arm A
    a: f32,
    /// Displacement of arm B
    b: f32,
    /// Displacement of arm C
    c: f32,
    /// A, B and C are instead where the platform shall be: x, y and z in metres, by --geometry
    #[arg(long, requires = "geometry")]
    position: bool,
    #[command(flatten)]
    known: Known,
    #[command(flatten)]
    operation: Operation,
    #[command(flatten)]
    common: Common,
}

/// What takes its time.
#[derive(Clone, Copy, Debug, clap::Args)]
struct Operation {
    /// Ends as soon as the controller has accepted, so that `cancel` can be used
    #[arg(long)]
    no_wait: bool,
}

/// What all requests to a controller have.
#[derive(Debug, clap::Args)]
pub(crate) struct Common {
    /// The device that the controller is at (or `tcp://HOST:PORT`, `rfc2217://HOST:PORT`); by default what the environment's variable DELTAROBOT_PORT says
    port: Option<PathBuf>,
    /// The same, by an option
    #[arg(id = "option", short = 'p', long = "port", value_name = "PORT", conflicts_with = "port")]
    option: Option<PathBuf>,
    /// One JSON object at the end instead of lines
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) session: SessionOptions,
}

/// How a controller is talked to.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct SessionOptions {
    #[command(flatten)]
    pub(crate) timing: Timing,
    /// Waits after opening: so many seconds, or until the controller is `ready` to answer
    #[arg(long, value_name = "SECONDS|ready", value_parser = wait)]
    pub(crate) wait: Option<Wait>,
    #[command(flatten)]
    pub(crate) port: PortOptions,
}

impl Known {
    fn machine(&self) -> Result<Option<Machine>, Failure> {
        self.geometry.as_deref().map(read_machine).transpose()
    }
}

impl Move {
    fn target(&self, machine: Option<&Machine>) -> Result<Position, Failure> {
        let mut numbers = [self.a, self.b, self.c];
        if !numbers.iter().all(|number| number.is_finite()) {
            return Err(Failure::Usage("a displacement must be a finite number".into()));
        }
        if let (true, Some(machine)) = (self.position, machine) {
            let displacements = machine.displacements(numbers.map(f64::from));
            numbers = displacements.map_err(|reason| Failure::Usage(format!("unreachable: {reason}")))?;
        }
        Ok(Position(numbers.map(f32::to_bits)))
    }
}

impl Common {
    /// (Not by clap, for which a variable is as good as an option, and would be at odds with the argument.)
    pub(crate) fn port(&self) -> Result<PathBuf, Failure> {
        let given = self.port.as_ref().or(self.option.as_ref()).cloned();
        let in_environment = || env::var_os("DELTAROBOT_PORT").filter(|port| !port.is_empty()).map(PathBuf::from);
        given.or_else(in_environment).ok_or_else(|| Failure::Usage("a <PORT> is needed; try --help".into()))
    }
}

pub(crate) fn home(arguments: &Home) -> Result<Status, Failure> {
    request(&arguments.common, arguments.operation.no_wait, "home", |_| Ok(Request::Home))
}

pub(crate) fn move_to(arguments: &Move) -> Result<Status, Failure> {
    request(&arguments.common, arguments.operation.no_wait, "move", |reporter| {
        let machine = arguments.known.machine()?;
        let target = arguments.target(machine.as_ref())?;
        reporter.know(machine);
        Ok(Request::Move(target))
    })
}

pub(crate) fn status(arguments: &StatusQuery) -> Result<Status, Failure> {
    request(&arguments.common, false, "status", |reporter| {
        reporter.know(arguments.known.machine()?);
        Ok(Request::Status)
    })
}

pub(crate) fn cancel(arguments: &Plain) -> Result<Status, Failure> {
    request(&arguments.common, false, "cancel", |_| Ok(Request::Cancel))
}

fn request(
    common: &Common,
    no_wait: bool,
    name: &str,
    prepare: impl FnOnce(&mut Reporter) -> Result<Request, Failure>,
) -> Result<Status, Failure> {
    let mut reporter = Reporter::new(common.json);
    let result = prepare(&mut reporter).and_then(|request| perform(common, no_wait, request, &mut reporter));
    result.inspect_err(|failure| reporter.failed(name, failure))
}

fn perform(common: &Common, no_wait: bool, request: Request, reporter: &mut Reporter) -> Result<Status, Failure> {
    let port = common.port()?;
    let signals = Signals::catch()?;
    let Some(mut driver) = Driver::open(&port, &common.session, &signals)? else {
        return Ok(reporter.interrupted(request.name()));
    };
    let end = match driver.get_ready()? {
        End::Outcome(_) => driver.perform(request, no_wait, reporter)?,
        end => end,
    };
    Ok(reporter.ended(request, end, &driver))
}
