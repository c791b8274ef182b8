//! The protocols that the program speaks.

use crate::decoder::{Decoder, Terms, deltarobot, gx, line};
use crate::status::Failure;

/// A protocol.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Protocol {
    /// Frames between a host and the controller of a delta robot
    #[default]
    Deltarobot,
    /// Ozeki line protocol: lines of text between a PC and devices
    Line,
    /// GX: vector moves, binary and ASCII, and notices about them
    Gx,
}

impl Protocol {
    /// As the option has it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Deltarobot => "deltarobot",
            Self::Line => "line",
            Self::Gx => "gx",
        }
    }

    /// Refuses options of other protocols: for each protocol, the first of its options that was given.
    pub(crate) fn refuse_others(self, given: &[(Self, Option<&str>)]) -> Result<(), Failure> {
        match given.iter().find(|(protocol, option)| *protocol != self && option.is_some()) {
            Some((protocol, Some(option))) => {
                let name = protocol.name();
                Err(Failure::Usage(format!("{option} is for --protocol {name} only; try --help")))
            }
            _ => Ok(()),
        }
    }

    /// What takes its messages apart.
    pub fn decoder(self) -> Box<dyn Decoder> {
        match self {
            Self::Deltarobot => Box::<deltarobot::Frames>::default(),
            Self::Line => Box::<line::Lines>::default(),
            Self::Gx => Box::<gx::Items>::default(),
        }
    }

    /// What its messages are called.
    pub(crate) const fn terms(self) -> Terms {
        match self {
            Self::Deltarobot => deltarobot::TERMS,
            Self::Line => line::TERMS,
            Self::Gx => gx::TERMS,
        }
    }
}

/// The option of the commands that work with each of them.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct Spoken {
    /// The protocol that is spoken
    #[arg(id = "spoken", long = "protocol", value_enum, value_name = "PROTOCOL", default_value_t)]
    pub protocol: Protocol,
}
