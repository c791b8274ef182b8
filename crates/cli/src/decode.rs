//! `deltarobot decode`: the messages in bytes given on the command line.

use std::io;

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
    /// `c=setswitch&state=1`; `-` reads them from standard input
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
    /// Who sends, where the message does not say
    #[arg(long, value_enum, value_name = "SIDE")]
    from: Option<Side>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let protocol = arguments.spoken.protocol;
    if arguments.text && protocol == Protocol::Deltarobot {
        return Err(Failure::Usage("--text: frames of --protocol deltarobot are no text".into()));
    }
    let texts = match arguments.bytes.as_slice() {
        [input] if input == "-" => {
            let text = io::read_to_string(io::stdin());
            text.map_err(|error| Failure::of_file("standard input", &error))?.lines().map(str::to_owned).collect()
        }
        texts => texts.to_vec(),
    };
    let bytes = if arguments.text || protocol == Protocol::Line {
        texts.iter().flat_map(|line| [line.trim_end_matches('\n'), "\n"]).collect::<String>().into_bytes()
    } else {
        from_hex(&texts.join(" ")).map_err(Failure::Usage)?
    };
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(Failure::Usage("there are no bytes to decode".into()));
    }
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
