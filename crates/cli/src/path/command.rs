//! `deltarobot path`: checks a path, and has the robot trace it.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use deltarobot_protocols::deltarobot::Position;
use deltarobot_protocols::deltarobot::host::Outcome;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

use super::{FILE_MAX, Format, Machine, Placement, Plane, Prepared, Runner, Step, plot, prepare};
use crate::operation::Common;
use crate::operation::driver::{Driver, End, Request};
use crate::operation::report::Reporter;
use crate::screen::complain;
use crate::signals::Signals;
use crate::status::{Failure, Status};

#[derive(Debug, clap::Args)]
#[command(
    allow_negative_numbers = true,
    after_help = "The file's x goes to the right and its y up; lengths are in metres, as in the geometry. What the \
    robot can't reach is listed with the lines of the file, and then nothing is moved. The robot has to be homed; \
    Ctrl-C cancels the motion."
)]
pub(crate) struct Arguments {
    /// The file with the path: CSV, SVG or G-code; - for standard input
    file: PathBuf,
    #[command(flatten)]
    common: Common,
    /// The machine's geometry, a file like examples/geometry.toml
    #[arg(long, value_name = "FILE")]
    geometry: PathBuf,
    /// Only checks the path, which needs no port; exit status 1 if parts of it are unreachable
    #[arg(long)]
    check: bool,
    /// What the file is; by default what its name says
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// How far the robot may be off the path
    #[arg(long, value_name = "METRES", default_value_t = 0.0005)]
    tolerance: f64,
    /// Where the file's origin is; of a drawing, its lower left corner
    #[arg(long, num_args = 3, value_names = ["X", "Y", "Z"], default_values_t = [0.0, 0.0, 0.0])]
    origin: Vec<f64>,
    /// Where the file's x goes
    #[arg(long, num_args = 3, value_names = ["X", "Y", "Z"], default_values_t = [1.0, 0.0, 0.0])]
    right: Vec<f64>,
    /// Where the file's y goes
    #[arg(long, num_args = 3, value_names = ["X", "Y", "Z"], default_values_t = [0.0, 1.0, 0.0])]
    up: Vec<f64>,
    /// The length of the file's unit: 1 for CSV, 0.001 for G-code's millimetres and those of drawings
    #[arg(long, value_name = "METRES")]
    scale: Option<f64>,
    /// How far above the plane to travel between strokes: by default 0.01 for drawings, 0 for CSV
    #[arg(long, value_name = "METRES")]
    lift: Option<f64>,
    /// Draws what is wanted and what was reached, as SVG
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let name =
        if is_standard_input(&arguments.file) { "standard input".into() } else { arguments.file.display().to_string() };
    let mut reporter = Reporter::new(arguments.common.json);
    let result = Task::read(arguments, &name).and_then(|task| task.carry_out(arguments, &mut reporter));
    result.inspect_err(|failure| reporter.failed("path", failure))
}

/// The geometry in a file, as `--geometry` names it.
pub(crate) fn read_machine(path: &Path) -> Result<Machine, Failure> {
    let text = fs::read_to_string(path).map_err(|error| Failure::of_file(path.display(), &error))?;
    Machine::read(&text).map_err(|error| Failure::Usage(format!("{}: {error}", path.display())))
}

fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// A path that is to be checked or run.
struct Task {
    machine: Machine,
    placement: Placement,
    prepared: Prepared,
    began: Instant,
}

impl Task {
    fn read(arguments: &Arguments, name: &str) -> Result<Self, Failure> {
        let machine = read_machine(&arguments.geometry)?;
        let format = arguments.format.or_else(|| Format::of_name(&arguments.file));
        let format = format.ok_or_else(|| Failure::Usage(format!("{name}: what is it? --format says so")))?;
        let placement = placement(arguments, format).map_err(Failure::Usage)?;
        // One byte more than is possible says that it is too long.
        let limit = u64::try_from(FILE_MAX).unwrap_or(u64::MAX) + 1;
        let mut bytes = Vec::new();
        let read = if is_standard_input(&arguments.file) {
            io::stdin().take(limit).read_to_end(&mut bytes)
        } else {
            File::open(&arguments.file).and_then(|file| file.take(limit).read_to_end(&mut bytes))
        };
        read.map_err(|error| Failure::of_file(name, &error))?;
        let prepared = prepare(&bytes, format, &placement, &machine);
        let prepared = prepared.map_err(|error| Failure::Usage(format!("{name}: {error}")))?;
        Ok(Self { machine, placement, prepared, began: Instant::now() })
    }

    fn carry_out(&self, arguments: &Arguments, reporter: &mut Reporter) -> Result<Status, Failure> {
        let plan = &self.prepared.plan;
        let runner = Runner::new(plan, &self.machine);
        let Some(mut runner) = runner.filter(|_| !arguments.check) else {
            let status = if plan.unreachable.is_empty() { Status::Finished } else { Status::NotDone };
            self.save_plot(arguments, &[])?;
            self.report(arguments, reporter, if status == Status::Finished { "checked" } else { "unreachable" }, None);
            if !arguments.check {
                complain("parts of the path are unreachable: nothing was moved");
            }
            return Ok(status);
        };
        let result = trace(arguments, &mut runner);
        // What was reached until then is worth knowing, however it ended.
        let plotted = self.save_plot(arguments, runner.reached_points());
        let outcome = match &result {
            Ok(Status::Finished) => "finished",
            Ok(Status::Cancelled) => "cancelled",
            Ok(Status::TimedOut) => "timed_out",
            Ok(_) => "failed",
            // With --json, that is the one object.
            Err(_) if arguments.common.json => return result,
            Err(_) => "ended",
        };
        self.report(arguments, reporter, outcome, Some(&runner));
        let status = result?;
        plotted?;
        Ok(status)
    }

    fn save_plot(&self, arguments: &Arguments, reached: &[Option<[f64; 3]>]) -> Result<(), Failure> {
        let Some(path) = &arguments.plot else { return Ok(()) };
        let drawing = plot(&self.prepared.simplified, &self.prepared.plan, reached, self.placement.plane());
        fs::write(path, drawing).map_err(|error| Failure::of_file(path.display(), &error))
    }

    fn report(&self, arguments: &Arguments, reporter: &mut Reporter, outcome: &str, runner: Option<&Runner>) {
        let Prepared { points, plan, .. } = &self.prepared;
        if arguments.common.json {
            let mut value = json!({
                "request": "path",
                "outcome": outcome,
                "points": points.len(),
                "moves": plan.targets.len(),
                "drawn": plan.drawn,
                "travelled": plan.travelled,
                "unreachable": plan.unreachable,
            });
            if let (Some(runner), Some(value)) = (runner, value.as_object_mut()) {
                value.insert("reached".into(), runner.progress().done.into());
                value.insert("errors".into(), json!(runner.errors()));
                value.insert("seconds".into(), Value::from((self.began.elapsed().as_secs_f64() * 1e3).round() / 1e3));
            }
            reporter.conclude(&value.to_string());
            return;
        }
        reporter.conclude(&format!(
            "{} points, {} moves, {:.4} m drawn, {:.4} m travelled",
            points.len(),
            plan.targets.len(),
            plan.drawn,
            plan.travelled
        ));
        for part in &plan.unreachable {
            let lines = match part.lines {
                [first, last] if first == last => format!("line {first}"),
                [first, last] => format!("lines {first} to {last}"),
            };
            let place = part.points.first().map(|at| at.map(|number| format!("{number:.4}")).join(" "));
            reporter.conclude(&format!("{lines}: unreachable from {} on: {}", place.unwrap_or_default(), part.reason));
        }
        if let Some(runner) = runner {
            let progress = runner.progress();
            let errors = runner.errors().map_or(String::new(), |errors| {
                format!(", off by {:.6} m on average, {:.6} m at most", errors.mean, errors.max)
            });
            reporter.conclude(&format!(
                "path {} after {:.1} s: {} of {} moves{errors}",
                outcome.replace('_', " "),
                self.began.elapsed().as_secs_f64(),
                progress.done,
                progress.all
            ));
        }
    }
}

/// Moves from target to target.
fn trace(arguments: &Arguments, runner: &mut Runner) -> Result<Status, Failure> {
    let port = arguments.common.port()?;
    let signals = Signals::catch()?;
    let Some(mut driver) = Driver::open(&port, &arguments.common.session, &signals)? else {
        return Ok(Status::Cancelled);
    };
    let mut silent = Reporter::silent();
    let end = match driver.get_ready()? {
        End::Outcome(_) => driver.perform(Request::Status, false, &mut silent)?,
        end => end,
    };
    if end != End::Outcome(Outcome::Finished) {
        return Ok(ended_badly(end, &driver));
    }
    if !driver.last_report().is_some_and(|report| report.position.is_finite()) {
        complain("the robot does not know its position, and has to home first");
        return Ok(Status::NotDone);
    }
    let bar = ProgressBar::new(u64::try_from(runner.targets().len()).unwrap_or_default());
    let style = ProgressStyle::with_template("{wide_bar} {pos} of {len} moves{msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let began = Instant::now();
    while let Step::Move(target) = runner.step() {
        let position = Position(target.displacements.map(f32::to_bits));
        let end = driver.perform(Request::Move(position), false, &mut silent)?;
        if end != End::Outcome(Outcome::Finished) {
            bar.finish_and_clear();
            return Ok(ended_badly(end, &driver));
        }
        let reached = driver.last_report().map_or([f32::NAN; 3], |report| report.position.0.map(f32::from_bits));
        runner.reached(reached);
        bar.set_message(time_left(runner.progress().time_left(began.elapsed())));
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(Status::Finished)
}

fn placement(arguments: &Arguments, format: Format) -> Result<Placement, String> {
    let vector = |numbers: &Vec<f64>| <[f64; 3]>::try_from(numbers.as_slice()).unwrap_or_default();
    let scale = arguments.scale.unwrap_or_else(|| format.default_scale());
    let plane = Plane::new(vector(&arguments.origin), vector(&arguments.right), vector(&arguments.up), scale)?;
    Placement::new(plane, arguments.tolerance, arguments.lift.unwrap_or_else(|| format.default_lift()))
}

/// Says why, if that is known.
fn ended_badly(end: End, driver: &Driver) -> Status {
    let End::Outcome(outcome) = end else { return Status::Cancelled };
    if let Some(reason) = driver.seen().reason(outcome, driver.health(), driver.last_report()) {
        complain(&reason);
    }
    match outcome {
        Outcome::Cancelled => Status::Cancelled,
        Outcome::TimedOut => Status::TimedOut,
        _ => Status::NotDone,
    }
}

fn time_left(time: Option<Duration>) -> String {
    match time.map(|time| time.as_secs()) {
        None => String::new(),
        Some(seconds @ 0..90) => format!(", {seconds} s left"),
        Some(seconds) => format!(", {} min left", (seconds + 30) / 60),
    }
}
