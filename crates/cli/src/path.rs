//! Paths that the robot is to trace: read from a file, simplified, checked against what the arms can do, and run point by
//! point.
//!
//! [`prepare`] does all but the running: a file's [`Waypoint`]s, their places in space by a [`Placement`], and the
//! [`Plan`], whose targets a [`Runner`] hands out one after the other. Nothing here does input or output, so that the
//! program and its server share it. Files are taken for hostile: sizes are bounded, and errors name the line.
//!
//! Of the tolerance that is asked for, the flattening of curves takes a quarter, simplifying takes half, and the motion
//! between two targets, which is straight for the arms and not in space, takes the last quarter.

pub(crate) mod command;
mod csv;
mod format;
mod gcode;
mod machine;
mod pen;
mod plan;
mod plane;
mod plot;
mod runner;
mod simplify;
mod svg;
mod vector;

use std::fmt::{self, Display, Formatter};

use serde::Serialize;

pub use format::Format;
pub use machine::{Machine, Reason};
pub use pen::Pen;
pub use plan::{Plan, Target, Unreachable, plan};
pub use plane::{Placement, Plane};
pub use plot::plot;
pub use runner::{Errors, Progress, Runner, Step};
pub use simplify::simplify;

/// The largest file that is read, in bytes.
pub const FILE_MAX: usize = 32 << 20;
/// The most points that a path may have.
pub const POINTS_MAX: usize = 1_000_000;

/// A point of a path, and how to get there from the one before.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Waypoint {
    /// Where it is, in the unit of the machine's geometry.
    pub at: [f64; 3],
    /// Whether the way to it is part of the drawing, or only travel.
    pub is_drawing: bool,
    /// The line of the file that it comes from, counted from 1.
    pub line: usize,
}

/// What is wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Error {
    /// The line, counted from 1, if it is one line.
    pub line: Option<usize>,
    /// What is the matter there.
    pub message: String,
}

impl Error {
    fn new(message: impl Into<String>) -> Self {
        Self { line: None, message: message.into() }
    }

    fn at(line: usize, message: impl Into<String>) -> Self {
        Self { line: Some(line), message: message.into() }
    }
}

impl Display for Error {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.line.map_or(Ok(()), |line| write!(f, "line {line}: "))?;
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}

/// A path that was read and checked.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The points that the file has, once its curves are flattened.
    pub points: Vec<Waypoint>,
    /// Those of them that are left when it is simplified.
    pub simplified: Vec<Waypoint>,
    /// What the robot is to do.
    pub plan: Plan,
}

/// Reads a file, and plans how the machine traces it to within the placement's tolerance.
///
/// # Errors
///
/// The file can't be read, or has more to do than can be checked.
pub fn prepare(file: &[u8], format: Format, placement: &Placement, machine: &Machine) -> Result<Prepared, Error> {
    prepare_points(format.read(file, &placement.with_part(0.25))?, placement.tolerance(), machine)
}

/// The same for points that are there already, such as those that a [`Pen`] has put down.
///
/// # Errors
///
/// There is more to do than can be checked.
pub fn prepare_points(points: Vec<Waypoint>, tolerance: f64, machine: &Machine) -> Result<Prepared, Error> {
    let simplified = simplify(&points, tolerance / 2.0);
    let plan = plan(&simplified, machine, tolerance / 4.0)?;
    Ok(Prepared { points, simplified, plan })
}
