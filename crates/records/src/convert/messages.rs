//! The messages in the bytes of robots.

use std::collections::BTreeMap;
use std::time::Duration;

use deltarobot_cli::Protocol;
use deltarobot_cli::decoder::{Decoder, Lanes, Piece, SENDERS};
use deltarobot_cli::port::GAP_USB;

use super::formats::{Content, Record};

/// Takes apart what robots send and receive.
pub(super) struct Messages {
    protocol: Protocol,
    lines: BTreeMap<String, Line>,
}

/// The line of a robot.
struct Line {
    decoder: Box<dyn Decoder>,
    gap: Duration,
    /// When anything came last from each side: a record with that time.
    heard: Lanes<Option<Record>>,
}

impl Messages {
    pub(super) const fn new(protocol: Protocol) -> Self {
        Self { protocol, lines: BTreeMap::new() }
    }

    /// Takes a record, and gives to `found` the messages that are certain by then, each with the record of its last byte.
    pub(super) fn take(&mut self, record: &Record, mut found: impl FnMut(&Record, &Piece)) {
        let Content::Bytes(from, bytes) = &record.content else { return };
        let protocol = self.protocol;
        let line = self.lines.entry(record.robot.clone()).or_insert_with(|| Line {
            decoder: protocol.decoder(),
            gap: GAP_USB,
            heard: Lanes::default(),
        });
        line.gap = record.gap.unwrap_or(line.gap);
        for side in SENDERS {
            if let Some(last) = line.heard.of(side) {
                let silence = record.time.saturating_sub(last.time);
                line.decoder.idle(side, silence, line.gap).iter().for_each(|piece| found(last, piece));
            }
        }
        line.decoder.feed(Some(*from), bytes).iter().for_each(|piece| found(record, piece));
        // Its bytes are not needed any more.
        *line.heard.of(Some(*from)) = Some(Record { content: Content::Bytes(*from, Vec::new()), ..record.clone() });
    }

    /// Nothing follows.
    pub(super) fn end(&mut self, mut found: impl FnMut(&Record, &Piece)) {
        for line in self.lines.values_mut() {
            for side in SENDERS {
                if let Some(last) = line.heard.of(side) {
                    line.decoder.end(side).iter().for_each(|piece| found(last, piece));
                }
            }
        }
    }
}
