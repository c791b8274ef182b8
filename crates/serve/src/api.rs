//! What can be asked over HTTP: openapi.json describes it.

pub(crate) mod compute;
pub(crate) mod motion;
pub(crate) mod path;

use std::collections::BTreeMap;
use std::sync::Arc;

use axum::body::{Body, Bytes, to_bytes};
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::{Path, Query, Request, State};
use axum::http::{HeaderMap, header};
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use axum::routing::{any, get, post, put};
use axum::{Extension, Json, Router};
use deltarobot_cli::path::Machine;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::fleet::Fleet;
use crate::http::Peer;
use crate::outside::Outside;
use crate::problem::{Kind, Problem};
use crate::robot::Robot;
use crate::security::Guard;
use crate::station;
use crate::trace::Traces;
use crate::watch::{MESSAGE_MAX, Watch};

/// The description of all this.
pub(crate) const OPENAPI: &str = include_str!("../openapi.json");

/// Bytes of a request's body, but for those that carry more.
const BODY_MAX: usize = 64 << 10;
/// Bytes of who drives.
const CLIENT_MAX: usize = 64;

/// What all handlers need.
#[derive(Clone)]
pub(crate) struct App {
    /// The robots.
    pub(crate) fleet: Arc<Fleet>,
    /// Who may do what.
    pub(crate) guard: Arc<Guard>,
    /// Paths that are traced.
    pub(crate) traces: Arc<Traces>,
    /// The broker and the records.
    pub(crate) outside: Arc<Outside>,
}

/// Everything that can be asked.
pub(crate) fn router(app: App) -> Router {
    let guard = Arc::clone(&app.guard);
    Router::new()
        .route("/api/openapi.json", get(|| async { ([(header::CONTENT_TYPE, "application/json")], OPENAPI) }))
        .route("/api/robots", get(robots))
        .route("/metrics", get(metrics))
        .route("/api/robots/{name}", get(robot))
        .route("/api/robots/{name}/home", post(motion::home))
        .route("/api/robots/{name}/move", post(motion::move_to))
        .route("/api/robots/{name}/cancel", post(motion::cancel))
        .route("/api/robots/{name}/lease", post(motion::lease).delete(motion::release))
        .route("/api/robots/{name}/geometry", put(set_geometry).delete(remove_geometry))
        .route("/api/robots/{name}/path", post(path::check))
        .route("/api/robots/{name}/path/run", post(path::run))
        .route("/api/robots/{name}/path/pause", post(path::pause))
        .route("/api/robots/{name}/path/resume", post(path::resume))
        .route("/api/robots/{name}/events", get(watch_one))
        .route("/api/events", get(watch_all))
        .route("/api/kinematics/forward", post(compute::forward))
        .route("/api/kinematics/inverse", post(compute::inverse))
        .route("/api/recordings", post(compute::recording))
        .route("/api/{*rest}", any(|| async { Problem::new(Kind::NotFound, "nothing; see /api/openapi.json") }))
        .method_not_allowed_fallback(|| async { Problem::new(Kind::Method, "see /api/openapi.json") })
        .with_state(app)
        .merge(station::router())
        .layer(from_fn_with_state(guard, Guard::check))
}

async fn metrics(State(app): State<App>) -> Response {
    let page = crate::metrics::page(&app.fleet, &app.outside);
    ([(header::CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")], page).into_response()
}

async fn robots(State(app): State<App>) -> Response {
    let states: Vec<_> = app.fleet.robots.values().map(|robot| robot.snapshot()).collect();
    Json(BTreeMap::from([("robots", states)])).into_response()
}

async fn robot(State(app): State<App>, name: Name) -> Result<Response, Problem> {
    Ok(Json(app.robot(&name)?.snapshot()).into_response())
}

async fn set_geometry(State(app): State<App>, name: Name, request: Request) -> Result<Response, Problem> {
    let robot = app.robot(&name)?;
    let geometry: Machine = body(request).await?;
    Ok(Json(robot.set_geometry(Some(geometry))).into_response())
}

async fn remove_geometry(State(app): State<App>, name: Name) -> Result<Response, Problem> {
    Ok(Json(app.robot(&name)?.set_geometry(None)).into_response())
}

/// What events are wanted.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Wanted {
    messages: bool,
}

type Upgrade = Result<WebSocketUpgrade, WebSocketUpgradeRejection>;

async fn watch_all(
    State(app): State<App>,
    Extension(peer): Extension<Peer>,
    query: Result<Query<Wanted>, axum::extract::rejection::QueryRejection>,
    headers: HeaderMap,
    upgrade: Upgrade,
) -> Result<Response, Problem> {
    watch(&app, None, peer, &query.map_err(malformed)?.0, &headers, upgrade)
}

async fn watch_one(
    State(app): State<App>,
    Extension(peer): Extension<Peer>,
    name: Name,
    query: Result<Query<Wanted>, axum::extract::rejection::QueryRejection>,
    headers: HeaderMap,
    upgrade: Upgrade,
) -> Result<Response, Problem> {
    let robot = Arc::clone(app.robot(&name)?);
    watch(&app, Some(robot), peer, &query.map_err(malformed)?.0, &headers, upgrade)
}

fn watch(
    app: &App,
    robot: Option<Arc<Robot>>,
    peer: Peer,
    wanted: &Wanted,
    headers: &HeaderMap,
    upgrade: Upgrade,
) -> Result<Response, Problem> {
    let upgrade = upgrade.map_err(|rejection| Problem::new(Kind::Malformed, format!("a WebSocket: {rejection}")))?;
    let watch = Watch {
        fleet: Arc::clone(&app.fleet),
        traces: Arc::clone(&app.traces),
        robot,
        messages: wanted.messages,
        may_drive: app.guard.may_drive(headers),
        client: peer.0.to_string(),
    };
    // Buffers as small as what is sent: there may be a thousand of them.
    let response = upgrade
        .protocols(["deltarobot"])
        .read_buffer_size(MESSAGE_MAX)
        .write_buffer_size(0)
        .max_message_size(MESSAGE_MAX)
        .max_frame_size(MESSAGE_MAX)
        .on_upgrade(|socket| watch.run(socket));
    Ok(response)
}

/// The robot's name in a path.
type Name = Result<Path<String>, axum::extract::rejection::PathRejection>;

impl App {
    fn robot(&self, name: &Name) -> Result<&Arc<Robot>, Problem> {
        let name = name.as_ref().map_err(|rejection| Problem::new(Kind::Malformed, rejection.body_text()))?;
        self.fleet.robot(name)
    }
}

#[expect(clippy::needless_pass_by_value, reason = "as map_err passes it")]
fn malformed(rejection: impl ToString) -> Problem {
    Problem::new(Kind::Malformed, rejection.to_string())
}

/// The bytes of a request's body.
async fn bytes(body: Body, limit: usize) -> Result<Bytes, Problem> {
    to_bytes(body, limit)
        .await
        .map_err(|_| Problem::new(Kind::TooLong, format!("at most {limit} bytes are taken, and all that was promised")))
}

/// The JSON in a request's body. It has to say that it is JSON: forms of web pages can't.
async fn body<T: DeserializeOwned>(request: Request) -> Result<T, Problem> {
    let kind = request.headers().get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok()).unwrap_or_default();
    let is_json = kind.split(';').next().is_some_and(|kind| kind.trim().eq_ignore_ascii_case("application/json"));
    let bytes = bytes(request.into_body(), BODY_MAX).await?;
    if !is_json && !bytes.is_empty() {
        return Err(Problem::new(Kind::Malformed, "the body has to be of Content-Type application/json"));
    }
    parse(&bytes)
}

/// The same of bytes. None are an object without members.
pub(crate) fn parse<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, Problem> {
    let bytes = if bytes.is_empty() { b"{}" } else { bytes };
    serde_json::from_slice(bytes).map_err(malformed)
}

/// Refuses names that would not fit on a line.
pub(crate) fn check_client(client: &str) -> Result<(), Problem> {
    if client.is_empty() || client.len() > CLIENT_MAX || client.chars().any(char::is_control) {
        return Err(Problem::new(
            Kind::Malformed,
            format!("`client` has to have 1 to {CLIENT_MAX} bytes, on one line"),
        ));
    }
    Ok(())
}
