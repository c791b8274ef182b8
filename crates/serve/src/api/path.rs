//! Paths: checking what is drawn or in a file, and having the robot trace it.

use std::sync::Arc;

use axum::Json;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use deltarobot_cli::path::{
    Format, Machine, Placement, Plane, Prepared, Runner, Unreachable, Waypoint, prepare, prepare_points,
};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::motion::word;
use super::{App, Name, bytes, parse};
use crate::problem::{Kind, Problem};

/// Bytes of a request with a file in it.
const REQUEST_MAX: usize = 8 << 20;
/// The most points that are sent back.
const POINTS_MAX: usize = 100_000;

/// `path` and `path/run`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PathRequest {
    /// What was drawn, in the machine's frame.
    points: Option<Vec<[f64; 3]>>,
    /// Or a file's text, and what it is.
    file: Option<String>,
    format: Option<String>,
    /// Where the file's coordinates lie.
    plane: Option<PlaneRequest>,
    /// By how much what is in the file is enlarged.
    scale: Option<f64>,
    tolerance: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlaneRequest {
    origin: [f64; 3],
    x: [f64; 3],
    y: [f64; 3],
}

pub(super) async fn check(State(app): State<App>, name: Name, request: Request) -> Result<Response, Problem> {
    let (prepared, _) = prepared(&app, &name, request).await?;
    Ok(Json(checked(&prepared)).into_response())
}

pub(super) async fn run(
    State(app): State<App>,
    name: Name,
    headers: HeaderMap,
    request: Request,
) -> Result<Response, Problem> {
    let lease = needed(word(&headers)?)?;
    let (prepared, machine) = prepared(&app, &name, request).await?;
    let runner = Runner::new(&prepared.plan, &machine)
        .ok_or_else(|| Problem::new(Kind::Impossible, "parts of the path are out of reach, or it is empty"))?;
    let run = app.traces.begin(app.robot(&name)?, lease, runner)?;
    Ok((StatusCode::ACCEPTED, Json(run)).into_response())
}

pub(super) async fn pause(State(app): State<App>, name: Name, headers: HeaderMap) -> Result<StatusCode, Problem> {
    app.traces.pause(app.robot(&name)?, needed(word(&headers)?)?, true)?;
    Ok(StatusCode::NO_CONTENT)
}

pub(super) async fn resume(State(app): State<App>, name: Name, headers: HeaderMap) -> Result<StatusCode, Problem> {
    app.traces.pause(app.robot(&name)?, needed(word(&headers)?)?, false)?;
    Ok(StatusCode::NO_CONTENT)
}

fn needed(word: Option<&str>) -> Result<&str, Problem> {
    word.ok_or_else(|| Problem::new(Kind::NoLease, "only who drives may trace a path"))
}

async fn prepared(app: &App, name: &Name, request: Request) -> Result<(Prepared, Arc<Machine>), Problem> {
    let robot = app.robot(name)?;
    let asked: PathRequest = parse(&bytes(request.into_body(), REQUEST_MAX).await?)?;
    let machine = robot.snapshot().geometry.clone();
    let machine = machine.ok_or_else(|| Problem::new(Kind::Impossible, "the robot has no geometry"))?;
    // It takes as long as some thousand other requests.
    tokio::task::spawn_blocking(move || asked.prepare(&machine).map(|prepared| (prepared, machine)))
        .await
        .map_err(|_| Problem::new(Kind::Overload, "checking was given up"))?
}

impl PathRequest {
    /// Reads, simplifies and checks it.
    pub(crate) fn prepare(&self, machine: &Machine) -> Result<Prepared, Problem> {
        let malformed = |text: &str| Problem::new(Kind::Malformed, text);
        let impossible = |text: String| Problem::new(Kind::Impossible, text);
        let prepared = match (&self.points, &self.file, &self.format, &self.plane) {
            (Some(points), None, None, None) => {
                if !(self.tolerance.is_finite() && self.tolerance > 0.0) {
                    return Err(impossible("the tolerance must be above zero".into()));
                }
                let waypoint =
                    |(index, at): (usize, &[f64; 3])| Waypoint { at: *at, is_drawing: index > 0, line: index + 1 };
                prepare_points(points.iter().enumerate().map(waypoint).collect(), self.tolerance, machine)
            }
            (None, Some(file), Some(format), Some(plane)) => {
                let format = match format.as_str() {
                    "csv" => Format::Csv,
                    "svg" => Format::Svg,
                    "gcode" => Format::Gcode,
                    _ => return Err(malformed("`format` is none of csv, svg, gcode")),
                };
                let scale = format.default_scale() * self.scale.unwrap_or(1.0);
                let plane = Plane::new(plane.origin, plane.x, plane.y, scale).map_err(impossible)?;
                let placement = Placement::new(plane, self.tolerance, format.default_lift()).map_err(impossible)?;
                prepare(file.as_bytes(), format, &placement, machine)
            }
            _ => return Err(malformed("either `points`, or `file`, `format` and `plane` are needed")),
        };
        prepared.map_err(|error| impossible(error.to_string()))
    }
}

/// What is shown of a path: polylines by what they are, and why parts are out of reach.
fn checked(prepared: &Prepared) -> Value {
    let plan = &prepared.plan;
    let mut strokes = Vec::new();
    for point in prepared.simplified.iter().take(POINTS_MAX) {
        extend(&mut strokes, if point.is_drawing { "wanted" } else { "travel" }, point.at);
    }
    strokes.extend(plan.unreachable.iter().map(|part| Stroke { kind: "unreachable", points: part.points.clone() }));
    let told = |part: &Unreachable| json!({ "lines": part.lines, "reason": part.reason.to_string() });
    let unreachable: Vec<_> = plan.unreachable.iter().map(told).collect();
    json!({ "targets": plan.targets.len(), "length": plan.drawn, "strokes": strokes, "unreachable": unreachable })
}

/// A polyline.
#[derive(Debug, Serialize)]
struct Stroke {
    kind: &'static str,
    points: Vec<[f64; 3]>,
}

/// Goes on with the last one, or with another where it ends.
fn extend(strokes: &mut Vec<Stroke>, kind: &'static str, at: [f64; 3]) {
    match strokes.last_mut() {
        Some(last) if last.kind == kind => last.points.push(at),
        last => {
            let end = last.and_then(|last| last.points.last().copied());
            strokes.push(Stroke { kind, points: end.into_iter().chain([at]).collect() });
        }
    }
}
