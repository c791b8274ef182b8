//! `deltarobot decode`: the messages in bytes given on the command line.

use serde_json::json;

use crate::decoder::Piece;
use crate::hex::from_hex;
use crate::protocol::{Protocol, Spoken};
use crate::recording::Side;
use crate::screen::Screen;
use crate::status::{Failure, Status};

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Bytes as hexadecimal digits, such as `24 53 00 B1 3A`; with --protocol line, lines of text, such as
    /// `c=setswitch&state=1`
    #[arg(required = true, value_name = "BYTES")]
    bytes: Vec<String>,
    /// One JSON object a line
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    spoken: Spoken,
    /// The bytes are lines of text, such as `V1000x400y300`: always so with --protocol line, else for --protocol gx
    #[arg(long)]
    text: bool,
    /// Who sends, where the message does not tell
    #[arg(long, value_enum, value_name = "SIDE")]
    from: Option<Side>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let protocol = arguments.spoken.protocol;
    if arguments.text && protocol == Protocol::Deltarobot {
        return Err(Failure::Usage("--text: frames of --protocol deltarobot are no text".into()));
    }
    let bytes = if arguments.text || protocol == Protocol::Line {
        arguments.bytes.iter().flat_map(|line| [line.trim_end_matches('\n'), "\n"]).collect::<String>().into_bytes()
    } else {
        from_hex(&arguments.bytes.join(" ")).map_err(Failure::Usage)?
    };
    let mut decoder = protocol.decoder();
    let mut pieces = decoder.feed(arguments.from, &bytes);
    pieces.extend(decoder.end(arguments.from));
    let mut screen = Screen::new();
    for piece in &pieces {
        if arguments.json { screen.put_json(&piece.add_to(json!({}))) } else { screen.put(&piece.text) }?;
    }
    screen.flush()?;
    let all_messages = !pieces.is_empty() && pieces.iter().all(Piece::is_message);
    Ok(if all_messages { Status::Finished } else { Status::NotDone })
}
