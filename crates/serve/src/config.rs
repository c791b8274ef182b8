//! What is served, and to whom: by the command line and a file.

use std::collections::BTreeMap;
use std::fs;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use clap::ValueEnum;
use deltarobot_cli::path::Machine;
use deltarobot_cli::port::{AtClose, Level, PortOptions};
use deltarobot_cli::status::Failure;
use deltarobot_cli::system::everybody_reads;
use deltarobot_protocols::deltarobot::Layout;
use serde::{Deserialize, Deserializer};

use crate::complain;
use crate::robot::Settings;
use crate::security::Guard;
use crate::{mqtt, record};

/// Robots of one program.
const ROBOTS_MAX: usize = 1000;
/// Characters of a token, of those that any header takes.
const TOKEN_LENGTH: std::ops::RangeInclusive<usize> = 16..=256;
/// Where it listens unless it is said.
const LISTEN: SocketAddr = SocketAddr::new(std::net::IpAddr::V4(std::net::Ipv4Addr::LOCALHOST), 7373);

/// The file.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct File {
    /// The address to listen at.
    pub(crate) listen: Option<SocketAddr>,
    /// Names by which this program is reached.
    pub(crate) hosts: Vec<String>,
    /// Pages of others that may ask.
    pub(crate) origins: Vec<String>,
    /// Simulated robots.
    pub(crate) simulated: usize,
    /// Files of tokens.
    pub(crate) tokens: Tokens,
    /// The robots.
    pub(crate) robots: BTreeMap<Name, Robot>,
    /// A broker.
    pub(crate) mqtt: Option<mqtt::Settings>,
    /// Records.
    pub(crate) record: Option<record::Settings>,
}

/// Files of tokens.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Tokens {
    /// For driving and watching.
    pub(crate) drive: Option<PathBuf>,
    /// For watching and cancelling.
    pub(crate) watch: Option<PathBuf>,
}

/// A robot's name, which fits into a path and a topic.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(try_from = "String")]
pub(crate) struct Name(pub(crate) Arc<str>);

impl TryFrom<String> for Name {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        let is_fine = |byte: u8| byte.is_ascii_alphanumeric() || b"-_".contains(&byte);
        if (1..=64).contains(&name.len()) && name.bytes().all(is_fine) {
            Ok(Self(name.into()))
        } else {
            Err(format!("`{name}` is no name: it takes 1 to 64 letters, digits, hyphens and underscores"))
        }
    }
}

/// A robot in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Robot {
    port: PathBuf,
    #[serde(default, deserialize_with = "positive")]
    baud: Option<u32>,
    #[serde(default, deserialize_with = "word")]
    dtr: Option<Level>,
    #[serde(default, deserialize_with = "word")]
    rts: Option<Level>,
    #[serde(default, deserialize_with = "word")]
    at_close: Option<AtClose>,
    #[serde(default, deserialize_with = "positive")]
    gap_ms: Option<u32>,
    #[serde(default, deserialize_with = "positive")]
    answer_ms: Option<u32>,
    #[serde(default, deserialize_with = "positive")]
    timeout_ms: Option<u32>,
    #[serde(default, deserialize_with = "layout")]
    layout: Layout,
    #[serde(default)]
    keep_moving: bool,
    /// Where programs get the bytes of its line.
    raw: Option<SocketAddr>,
    geometry: Option<Machine>,
}

fn positive<'de, D: Deserializer<'de>>(value: D) -> Result<Option<u32>, D::Error> {
    // A day in milliseconds is more than any of these needs, and all serial ports are slower.
    match u32::deserialize(value)? {
        number @ 1..=86_400_000 => Ok(Some(number)),
        number => Err(serde::de::Error::custom(format!("{number} is not from 1 to 86400000"))),
    }
}

fn word<'de, D: Deserializer<'de>, T: ValueEnum>(value: D) -> Result<Option<T>, D::Error> {
    let word = String::deserialize(value)?;
    T::from_str(&word, false).map(Some).map_err(|_| {
        let names: Vec<_> = T::value_variants().iter().filter_map(ValueEnum::to_possible_value).collect();
        let names: Vec<_> = names.iter().map(clap::builder::PossibleValue::get_name).collect();
        serde::de::Error::custom(format!("`{word}` is none of {}", names.join(", ")))
    })
}

fn layout<'de, D: Deserializer<'de>>(value: D) -> Result<Layout, D::Error> {
    match String::deserialize(value)?.as_str() {
        "auto" => Ok(Layout::Auto),
        "spec" => Ok(Layout::Spec),
        "firmware" => Ok(Layout::Firmware),
        word => Err(serde::de::Error::custom(format!("`{word}` is none of auto, spec, firmware"))),
    }
}

/// Reads a file's text.
pub(crate) fn parse(text: &str) -> Result<File, String> {
    toml::from_str(text).map_err(|error| {
        let message = error.message().replace('\n', ", ");
        match error.span().and_then(|span| text.get(..span.start)) {
            Some(before) => format!("line {}: {message}", before.matches('\n').count() + 1),
            None => message,
        }
    })
}

/// All that is needed to begin.
#[derive(Debug)]
pub(crate) struct Config {
    /// The address to listen at.
    pub(crate) listen: SocketAddr,
    /// Who may do what.
    pub(crate) guard: Guard,
    /// How many robots are simulated.
    pub(crate) simulated: usize,
    /// The others.
    pub(crate) robots: Vec<Settings>,
    /// Where programs get the bytes of their lines.
    pub(crate) raw: Vec<(Arc<str>, SocketAddr)>,
    /// A broker.
    pub(crate) mqtt: Option<mqtt::Settings>,
    /// Records.
    pub(crate) record: Option<record::Settings>,
}

/// A robot of which no more is said than its port.
pub(crate) fn plain(name: Arc<str>, path: PathBuf) -> Settings {
    Settings {
        name,
        path,
        port: PortOptions::default(),
        layout: Layout::Auto,
        timeout: None,
        answer_time: None,
        cancels_abandoned: true,
        geometry: None,
    }
}

impl File {
    /// Reads one.
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let text = fs::read_to_string(path).map_err(|error| Failure::of_file(path.display(), &error))?;
        parse(&text).map_err(|error| Failure::Usage(format!("{}: {error}", path.display())))
    }

    /// Checks what no single line says.
    pub(crate) fn check(self, keep_moving: bool) -> Result<Config, Failure> {
        let wrong = |text: String| Err(Failure::Usage(text));
        let listen = self.listen.unwrap_or(LISTEN);
        let guard = Guard {
            drive: self.tokens.drive.as_deref().map(read_token).transpose()?,
            watch: self.tokens.watch.as_deref().map(read_token).transpose()?,
            hosts: self.hosts,
            origins: self.origins,
        };
        if !listen.ip().is_loopback() && guard.drive.is_none() && guard.watch.is_none() {
            return wrong(format!("everybody in the network could drive by {listen}: that needs a --token-file"));
        }
        if self.simulated.saturating_add(self.robots.len()) > ROBOTS_MAX {
            return wrong(format!("there are more than {ROBOTS_MAX} robots"));
        }
        if self.simulated == 0 && self.robots.is_empty() {
            return wrong("no robot is named: NAME=PORT, --config or --sim does; try --help".into());
        }
        let (mut robots, mut raw) = (Vec::new(), Vec::new());
        for (Name(name), robot) in self.robots {
            if let Some(address) = robot.raw {
                if !address.ip().is_loopback() {
                    return wrong(format!("robots.{name}.raw: {address} has no tokens, so only loopback is allowed"));
                }
                raw.push((Arc::clone(&name), address));
            }
            let settings = robot.settings(name);
            robots.push(Settings { cancels_abandoned: settings.cancels_abandoned && !keep_moving, ..settings });
        }
        Ok(Config { listen, guard, simulated: self.simulated, robots, raw, mqtt: self.mqtt, record: self.record })
    }
}

impl Robot {
    fn settings(self, name: Arc<str>) -> Settings {
        let time = |ms: Option<u32>| ms.map(|ms| Duration::from_millis(ms.into()));
        let plain = plain(name, self.port);
        let mut port = PortOptions::default();
        port.baud = self.baud.unwrap_or(port.baud);
        (port.dtr, port.rts, port.at_close, port.gap) = (self.dtr, self.rts, self.at_close, self.gap_ms);
        Settings {
            port,
            layout: self.layout,
            timeout: time(self.timeout_ms),
            answer_time: time(self.answer_ms),
            cancels_abandoned: !self.keep_moving,
            geometry: self.geometry,
            ..plain
        }
    }

    /// The same with measures.
    pub(crate) fn with_geometry(self, geometry: Option<Machine>) -> Self {
        Self { geometry, ..self }
    }

    /// One of which no more is said.
    pub(crate) fn at(port: PathBuf) -> Self {
        Self {
            port,
            baud: None,
            dtr: None,
            rts: None,
            at_close: None,
            gap_ms: None,
            answer_ms: None,
            timeout_ms: None,
            layout: Layout::Auto,
            keep_moving: false,
            raw: None,
            geometry: None,
        }
    }
}

fn read_token(path: &Path) -> Result<String, Failure> {
    let failure = |error| Failure::of_file(path.display(), &error);
    let token = fs::read_to_string(path).map_err(failure)?.trim().to_owned();
    let is_fine = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~".contains(&byte);
    if !TOKEN_LENGTH.contains(&token.len()) || !token.bytes().all(is_fine) {
        let text = "a token has 16 to 256 letters, digits or characters of -._~ (`openssl rand -hex 32` makes one)";
        return Err(Failure::of(path.display(), text));
    }
    if everybody_reads(&fs::metadata(path).map_err(failure)?) {
        complain(&format!("{}: everybody on this machine can read this token", path.display()));
    }
    Ok(token)
}
