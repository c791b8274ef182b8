//! `deltarobot run`: requests from a file, in one opening of the port.

use std::fs;
use std::io;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use deltarobot_protocols::deltarobot::Position;
use serde_json::json;

use crate::operation::SessionOptions;
use crate::operation::driver::{Driver, End, Request};
use crate::operation::report::Reporter;
use crate::port::seconds;
use crate::screen::complain;
use crate::signals::Signals;
use crate::status::{Failure, Status};

#[derive(Debug, clap::Args)]
#[command(
    after_help = "A line has one of\n  home\n  move A B C\n  status\n  cancel\n  wait SECONDS\n  loop [TIMES]  begins \
    again at the first line: so often, or until Ctrl-C\nand what follows a # is a comment. All lines are read before \
    the first is carried out. Stops at the first that fails, with its exit status; Ctrl-C cancels the motion."
)]
pub(crate) struct Arguments {
    /// The device that the controller is at
    port: PathBuf,
    /// The file with the requests; standard input by default
    #[arg(default_value = "-")]
    file: PathBuf,
    /// Goes on after a request that was refused, has failed or was not answered
    #[arg(long)]
    keep_going: bool,
    /// One JSON object for each request
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    session: SessionOptions,
}

/// A line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    Request(Request),
    Wait(Duration),
    /// So many times more, or for ever.
    Loop(Option<u32>),
}

/// Reads the lines: the steps, with the numbers of their lines.
fn parse(text: &str) -> Result<Vec<(usize, Step)>, String> {
    let mut steps = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let words: Vec<_> = line.split('#').next().unwrap_or_default().split_whitespace().collect();
        let step = match words.as_slice() {
            [] => continue,
            ["home"] => Ok(Step::Request(Request::Home)),
            ["status"] => Ok(Step::Request(Request::Status)),
            ["cancel"] => Ok(Step::Request(Request::Cancel)),
            ["move", a, b, c] => target([a, b, c]).map(|target| Step::Request(Request::Move(target))),
            ["wait", time] => seconds(time).map(|time| Step::Wait(Duration::from_secs_f64(time))),
            ["loop"] => Ok(Step::Loop(None)),
            ["loop", times] => times.parse().map(|times| Step::Loop(Some(times))).map_err(|error| error.to_string()),
            [word, ..] => Err(match *word {
                "home" | "status" | "cancel" => format!("`{word}` stands alone"),
                "move" => "`move` has three displacements".into(),
                "wait" => "`wait` has a number of seconds".into(),
                "loop" => "`loop` has a number of times, or none".into(),
                _ => format!("`{word}` is none of home, move, status, cancel, wait and loop"),
            }),
        };
        steps.push((number, step.map_err(|error| format!("line {number}: {error}"))?));
    }
    let ends = |(_, step): &(usize, Step)| matches!(step, Step::Loop(_));
    if let Some((number, _)) = steps.iter().rev().skip(1).find(|step| ends(step)) {
        return Err(format!("line {number}: `loop` is only possible at the end"));
    }
    if steps.first().is_none_or(ends) {
        return Err("there are no requests".into());
    }
    Ok(steps)
}

fn target(words: [&str; 3]) -> Result<Position, String> {
    let number = |word: &str| word.parse::<f32>().ok().filter(|number| number.is_finite());
    let [Some(a), Some(b), Some(c)] = words.map(number) else {
        return Err("a displacement must be a finite number".into());
    };
    Ok(Position([a, b, c].map(f32::to_bits)))
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let mut reporter = Reporter::new(arguments.json);
    let name =
        if arguments.file.as_os_str() == "-" { "standard input".into() } else { arguments.file.display().to_string() };
    // (Before signals are caught: Ctrl-C ends the reading of standard input.)
    let steps = read(arguments, &name).inspect_err(|failure| reporter.failed("run", failure))?;
    let signals = Signals::catch()?;
    let driver = get_ready(arguments, &signals).inspect_err(|failure| reporter.failed("run", failure))?;
    let Some(mut driver) = driver else { return Ok(reporter.interrupted("run")) };
    carry_out(arguments, &name, &steps, &mut driver, &mut reporter)
}

fn read(arguments: &Arguments, name: &str) -> Result<Vec<(usize, Step)>, Failure> {
    let text = match arguments.file.as_path() {
        path if path.as_os_str() == "-" => io::read_to_string(io::stdin()),
        path => fs::read_to_string(path),
    };
    let text = text.map_err(|error| Failure::of_file(name, &error))?;
    parse(&text).map_err(|error| Failure::Usage(format!("{name}: {error}")))
}

/// `None` when it was interrupted.
fn get_ready<'a>(arguments: &'a Arguments, signals: &'a Signals) -> Result<Option<Driver<'a>>, Failure> {
    let Some(mut driver) = Driver::open(&arguments.port, &arguments.session, signals)? else { return Ok(None) };
    let end = driver.get_ready()?;
    Ok((end != End::Interrupted).then_some(driver))
}

fn carry_out(
    arguments: &Arguments,
    name: &str,
    steps: &[(usize, Step)],
    driver: &mut Driver,
    reporter: &mut Reporter,
) -> Result<Status, Failure> {
    let rounds = match steps.last() {
        Some((_, Step::Loop(None))) => None,
        Some((_, Step::Loop(Some(times)))) => Some(usize::try_from(*times).unwrap_or(usize::MAX).saturating_add(1)),
        _ => Some(1),
    };
    let in_round = steps.iter().filter(|(_, step)| !matches!(step, Step::Loop(_))).count();
    let all = rounds.map(|rounds| in_round.saturating_mul(rounds));
    let mut progress = Progress { began: Instant::now(), done: 0, all };
    let mut status = Status::Finished;
    for _ in 0..rounds.unwrap_or(usize::MAX) {
        for (line, step) in steps {
            reporter.begin(progress.text(), json!({ "number": progress.done + 1, "line": line }));
            let (step, ended) = match *step {
                Step::Loop(_) => continue,
                Step::Wait(time) => {
                    let waited = driver.pause(time);
                    let ended = |waited| if waited { Status::Finished } else { reporter.interrupted("wait") };
                    ("wait", waited.map(ended))
                }
                Step::Request(request) => {
                    let end = driver.perform(request, false, reporter);
                    (request.name(), end.map(|end| reporter.ended(request, end, driver)))
                }
            };
            progress.done += 1;
            match ended.inspect_err(|failure| reporter.failed(step, failure))? {
                Status::Finished => (),
                // That is the user's doing.
                Status::Cancelled => return Ok(Status::Cancelled),
                ended => {
                    status = if status == Status::Finished { ended } else { status };
                    if !arguments.keep_going {
                        complain(&format!("{name}: stopped at line {line}"));
                        return Ok(status);
                    }
                }
            }
        }
    }
    Ok(status)
}

/// How far it is.
struct Progress {
    began: Instant,
    done: usize,
    all: Option<usize>,
}

impl Progress {
    /// Such as `12 of 40, 3 min left`.
    fn text(&self) -> String {
        let number = self.done + 1;
        let Some(all) = self.all else { return number.to_string() };
        let part = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        let left = match part(self.done) {
            0 => return format!("{number} of {all}"),
            done => (self.began.elapsed() / done).saturating_mul(part(all - self.done)).as_secs(),
        };
        match left {
            0..90 => format!("{number} of {all}, {left} s left"),
            90..5400 => format!("{number} of {all}, {} min left", (left + 30) / 60),
            _ => format!("{number} of {all}, {} h left", (left + 1800) / 3600),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Duration, Request, Step, parse};

    #[test]
    fn lines() {
        let steps = parse("home\n\n  wait 0.5 # settles\n#loop\nstatus\nloop 3\n").unwrap();
        assert_eq!(
            steps,
            [
                (1, Step::Request(Request::Home)),
                (3, Step::Wait(Duration::from_millis(500))),
                (5, Step::Request(Request::Status)),
                (6, Step::Loop(Some(3)))
            ]
        );
        for (text, error) in [
            ("home\njump\n", "line 2: `jump` is none of home, move, status, cancel, wait and loop"),
            ("move 1 2", "line 1: `move` has three displacements"),
            ("move 1 2 nan", "line 1: a displacement must be a finite number"),
            ("loop\nhome", "line 1: `loop` is only possible at the end"),
            ("# nothing\nloop", "there are no requests"),
            ("wait -1", "line 1: not a number of seconds from 0 to 86400"),
        ] {
            assert_eq!(parse(text).unwrap_err(), error);
        }
    }
}
