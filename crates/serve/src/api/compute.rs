//! What needs no robot: kinematics, and recordings.

use std::collections::BTreeMap;
use std::time::Duration;

use axum::Json;
use axum::extract::Request;
use axum::response::{IntoResponse, Response};
use deltarobot_cli::decoder::deltarobot::Frames;
use deltarobot_cli::decoder::{Decoder, Piece};
use deltarobot_cli::path::Machine;
use deltarobot_cli::port::GAP_USB;
use deltarobot_cli::recording::{Parser, Side};
use deltarobot_cli::words::position_json;
use deltarobot_protocols::deltarobot::{FRAME_HEAD, Frame, Layout, Message, Opcode, SeenLayout};
use serde::Deserialize;
use serde_json::{Value, json};

use super::{bytes, parse};
use crate::problem::{Kind, Problem};
use crate::state::{Doing, end_stops};

/// Bytes of a batch, and of a recording.
const BATCH_MAX: usize = 1 << 20;
/// See above.
const RECORDING_MAX: usize = 4 << 20;
/// Places in a batch.
const PLACES_MAX: usize = 10_000;

/// `forward`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ForwardRequest {
    geometry: Machine,
    displacements: Vec<[f32; 3]>,
}

/// `inverse`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct InverseRequest {
    geometry: Machine,
    poses: Vec<[f32; 3]>,
}

impl ForwardRequest {
    /// Where the platform is at these.
    pub(crate) fn poses(&self) -> Result<Vec<Option<Place>>, Problem> {
        batch(&self.displacements, |at| self.geometry.pose(at))
    }
}

pub(super) async fn forward(request: Request) -> Result<Response, Problem> {
    let asked: ForwardRequest = parse(&bytes(request.into_body(), BATCH_MAX).await?)?;
    Ok(Json(BTreeMap::from([("poses", asked.poses()?)])).into_response())
}

pub(super) async fn inverse(request: Request) -> Result<Response, Problem> {
    let asked: InverseRequest = parse(&bytes(request.into_body(), BATCH_MAX).await?)?;
    let displacements = batch(&asked.poses, |at| asked.geometry.displacements(at.map(f64::from)).ok())?;
    Ok(Json(BTreeMap::from([("displacements", displacements)])).into_response())
}

type Place = [f32; 3];

fn batch(places: &[Place], compute: impl Fn(Place) -> Option<Place>) -> Result<Vec<Option<Place>>, Problem> {
    if places.len() > PLACES_MAX {
        return Err(Problem::new(Kind::TooLong, format!("at most {PLACES_MAX} places are taken")));
    }
    Ok(places.iter().copied().map(compute).collect())
}

pub(super) async fn recording(request: Request) -> Result<Response, Problem> {
    let text = bytes(request.into_body(), RECORDING_MAX).await?;
    // It takes as long as some hundred other requests.
    let decoded = tokio::task::spawn_blocking(move || decode(&text)).await;
    let decoded = decoded.map_err(|_| Problem::new(Kind::Overload, "decoding was given up"))??;
    Ok(Json(decoded).into_response())
}

/// What happened in a recording.
pub(crate) fn decode(mut text: &[u8]) -> Result<Value, Problem> {
    let impossible = |error: String| Problem::new(Kind::Impossible, error);
    let (mut parser, mut story) = (Parser::new(), Story::default());
    while let Some(entry) = parser.next(&mut text).map_err(impossible)? {
        story.passed(entry.time, entry.from, &entry.bytes);
    }
    if let Some(entry) = parser.end().map_err(impossible)? {
        story.passed(entry.time, entry.from, &entry.bytes);
    }
    let gap = parser.gap().unwrap_or(GAP_USB);
    story.idle(Duration::MAX, gap);
    Ok(json!({
        "started": parser.start().map(|start| start.utc.to_rfc3339()),
        "seconds": parser.last().as_secs_f64(),
        "damage": parser.damage(),
        "events": story.events,
    }))
}

#[derive(Default)]
struct Story {
    events: Vec<Value>,
    decoder: Frames,
    layout: SeenLayout,
    heard: [Duration; 2],
}

impl Story {
    fn passed(&mut self, time: Duration, from: Side, bytes: &[u8]) {
        self.idle(time, GAP_USB);
        for (heard, side) in self.heard.iter_mut().zip([Side::Host, Side::Controller]) {
            if side == from {
                *heard = time;
            }
        }
        let pieces = self.decoder.feed(Some(from), bytes);
        self.emit(time, pieces);
    }

    fn idle(&mut self, now: Duration, gap: Duration) {
        for (from, heard) in [Side::Host, Side::Controller].into_iter().zip(self.heard) {
            let pieces = self.decoder.idle(Some(from), now.saturating_sub(heard), gap);
            self.emit(heard, pieces);
        }
    }

    fn emit(&mut self, time: Duration, pieces: Vec<Piece>) {
        let at = time.as_secs_f64();
        for piece in pieces {
            let message = crate::event::Message::new(String::new(), piece);
            let state = self.state(at, &message.bytes);
            self.events.push(json!({
                "type": "message", "at": at, "from": message.from, "text": message.text, "bytes": message.bytes,
                "json": message.json,
            }));
            self.events.extend(state);
        }
    }

    /// The state that a message reports.
    fn state(&mut self, at: f64, bytes: &str) -> Option<Value> {
        let bytes = deltarobot_cli::hex::from_hex(bytes).ok()?;
        let (&[_, opcode, length, ..], rest) = (bytes.first_chunk::<FRAME_HEAD>()?, bytes.get(FRAME_HEAD..)?);
        let frame = Frame { opcode: Opcode(opcode), payload: rest.get(..length.into())? };
        match Message::read_after(frame.opcode, frame.payload, Layout::Auto, &mut self.layout)? {
            Message::StatusReport(report) => Some(json!({
                "type": "state", "at": at, "state": Doing::of(report.state()),
                "position_known": report.position.is_known(), "displacements": position_json(report.position),
                "end_stops": end_stops(&report),
            })),
            _ => None,
        }
    }
}
