//! `deltarobot decode`: frames in bytes given as hexadecimal digits.

use serde_json::json;

use crate::decoder::{Decoder, Piece};
use crate::monitor::{piece_json, piece_text};
use crate::screen::Screen;
use crate::status::{Failure, Status};
use crate::wire::from_hex;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Bytes as hexadecimal digits, such as `24 53 00 B1 3A`
    #[arg(required = true, value_name = "HEX")]
    bytes: Vec<String>,
    /// One JSON object a line
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let bytes = from_hex(&arguments.bytes.join(" ")).map_err(Failure::Usage)?;
    let mut decoder = Decoder::new();
    let mut pieces = decoder.feed(&bytes);
    pieces.extend(decoder.idle());
    let mut screen = Screen::new();
    for piece in &pieces {
        screen.line(&if arguments.json { piece_json(piece, json!({})).to_string() } else { piece_text(piece) })?;
    }
    let all_frames = !pieces.is_empty() && pieces.iter().all(|piece| matches!(piece, Piece::Frame { .. }));
    Ok(if all_frames { Status::Finished } else { Status::NotDone })
}
