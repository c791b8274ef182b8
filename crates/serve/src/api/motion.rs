//! Driving a robot.

use std::time::Duration;

use axum::extract::{Request, State};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde::Deserialize;
use serde_json::json;

use super::{App, Name, body, check_client};
use crate::http::Peer;
use crate::lease::Wish;
use crate::problem::{Kind, Problem};
use crate::robot::{Command, Goal};

/// The header that has the word of a lease.
const LEASE: &str = "deltarobot-lease";
/// How long a lease lasts unless it is said, and how long it may.
const LEASE_SECONDS: f64 = 10.0;
/// See above.
const LEASE_RANGE: std::ops::RangeInclusive<f64> = 1.0..=60.0;

/// `home`
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct HomeRequest {
    wait: Option<bool>,
}

/// `move`
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct MoveRequest {
    displacements: Option<[f32; 3]>,
    position: Option<[f32; 3]>,
    relative: bool,
    wait: Option<bool>,
}

impl MoveRequest {
    /// Where to.
    pub(crate) fn goal(&self) -> Result<Goal, Problem> {
        Goal::new(self.displacements, self.position, self.relative)
    }
}

/// `lease`
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct LeaseRequest {
    client: Option<String>,
    force: bool,
    seconds: Option<f64>,
}

pub(super) async fn home(
    State(app): State<App>,
    Extension(peer): Extension<Peer>,
    name: Name,
    headers: HeaderMap,
    request: Request,
) -> Result<Response, Problem> {
    app.robot(&name)?;
    let asked: HomeRequest = body(request).await?;
    drive(&app, &name, peer, &headers, Command::Home, asked.wait).await
}

pub(super) async fn move_to(
    State(app): State<App>,
    Extension(peer): Extension<Peer>,
    name: Name,
    headers: HeaderMap,
    request: Request,
) -> Result<Response, Problem> {
    app.robot(&name)?;
    let asked: MoveRequest = body(request).await?;
    drive(&app, &name, peer, &headers, Command::Move(asked.goal()?), asked.wait).await
}

async fn drive(
    app: &App,
    name: &Name,
    peer: Peer,
    headers: &HeaderMap,
    command: Command,
    wait: Option<bool>,
) -> Result<Response, Problem> {
    let robot = app.robot(name)?;
    let operation = match (word(headers)?, wait) {
        (Some(word), Some(true)) => {
            let begun = robot.begin(command, word, None).await?;
            begun.ended.await.map_err(|_| Problem::new(Kind::Down, "the program is ending"))?
        }
        (Some(word), _) => {
            let begun = robot.begin(command, word, None).await?;
            return Ok((StatusCode::ACCEPTED, Json(begun.operation)).into_response());
        }
        (None, Some(false)) => {
            return Err(Problem::new(Kind::NoLease, "who does not wait for the end needs a lease, to attend to it"));
        }
        (None, _) => robot.perform(command, &peer.0.to_string(), None).await?,
    };
    Ok(Json(operation).into_response())
}

pub(super) async fn cancel(State(app): State<App>, name: Name) -> Result<Response, Problem> {
    let outcome = app.robot(&name)?.cancel().await?;
    Ok(Json(json!({ "outcome": outcome })).into_response())
}

pub(super) async fn lease(
    State(app): State<App>,
    Extension(peer): Extension<Peer>,
    name: Name,
    headers: HeaderMap,
    request: Request,
) -> Result<Response, Problem> {
    let robot = app.robot(&name)?;
    let asked: LeaseRequest = body(request).await?;
    let seconds = asked.seconds.unwrap_or(LEASE_SECONDS);
    if !LEASE_RANGE.contains(&seconds) {
        return Err(Problem::new(Kind::Malformed, "`seconds` has to be from 1 to 60"));
    }
    let client = asked.client.unwrap_or_else(|| peer.0.to_string());
    check_client(&client)?;
    let lasts = Some(Duration::from_secs_f64(seconds));
    let lease = robot.acquire(&Wish { client: &client, force: asked.force, word: word(&headers)?, lasts })?;
    let answer = json!({ "lease": lease.word, "client": lease.driver.client, "until": lease.driver.until });
    Ok(Json(answer).into_response())
}

pub(super) async fn release(State(app): State<App>, name: Name, headers: HeaderMap) -> Result<StatusCode, Problem> {
    let robot = app.robot(&name)?;
    let word = word(&headers)?.ok_or_else(|| Problem::new(Kind::NoLease, "the header Deltarobot-Lease is needed"))?;
    if robot.release(word) {
        Ok(StatusCode::NO_CONTENT)
    } else {
        robot.leases.holder(word).map(|_| StatusCode::NO_CONTENT)
    }
}

pub(super) fn word(headers: &HeaderMap) -> Result<Option<&str>, Problem> {
    let Some(word) = headers.get(LEASE) else { return Ok(None) };
    word.to_str().map(Some).map_err(|_| Problem::new(Kind::Malformed, "the header Deltarobot-Lease is no lease"))
}
