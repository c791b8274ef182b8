//! The ports that the program's arguments name.

mod network;
mod telnet;

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rustix::event::PollFlags;
use rustix::fd::{AsFd, BorrowedFd};
use rustix::io::Errno;

use crate::screen::complain;
use crate::status::{Failure, system_text};
use crate::system::{Line, is_direct, is_gone};
use crate::wait::{wait, wait_for};
use network::Network;
pub use network::is_url;

/// How long a write may wait for room. At 115200 baud the system's buffer is empty after half of that.
const WRITE_TIME: Duration = Duration::from_secs(1);

/// How often it is tried to open a port that is not there.
const RETRY: Duration = Duration::from_millis(200);

/// The gap within a message of a sender whose bytes come as they are sent.
pub(crate) const GAP_DIRECT: Duration = Duration::from_millis(50);
/// That of one whose bytes come through a USB converter or another program.
pub const GAP_USB: Duration = Duration::from_millis(250);
/// That of one in a network, where a lost packet comes again after 200 ms at the soonest, or of a pipe, which may come
/// from one.
pub(crate) const GAP_NETWORK: Duration = Duration::from_secs(1);

/// How a port is opened.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Options of the port")]
pub struct PortOptions {
    /// Speed of the line in baud: any that the hardware has
    #[arg(long, value_name = "BAUD", default_value_t = 115_200, value_parser = clap::value_parser!(u32).range(1..))]
    pub baud: u32,
    /// Sets the line DTR once the port is open. Opening raises it, which resets many boards
    #[arg(long, value_enum, value_name = "LEVEL")]
    pub dtr: Option<Level>,
    /// Sets the line RTS once the port is open
    #[arg(long, value_enum, value_name = "LEVEL")]
    pub rts: Option<Level>,
    /// What becomes of DTR and RTS when the port is closed. Kept, they do not rise at the next opening, which then
    /// resets nothing
    #[arg(long, value_enum, value_name = "WHAT")]
    pub at_close: Option<AtClose>,
    /// Silence after which an incomplete message is given up; by default 50 for a UART of this machine, 250 for a USB
    /// converter, another program or a recording, and 1000 for a network or a pipe
    #[arg(long, value_name = "MILLISECONDS", value_parser = clap::value_parser!(u32).range(1..=60_000))]
    pub gap: Option<u32>,
    /// Waits so long for a port that is not there, or in use
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    wait_for_port: Option<f64>,
}

/// As without options on the command line.
impl Default for PortOptions {
    fn default() -> Self {
        Self { baud: 115_200, dtr: None, rts: None, at_close: None, gap: None, wait_for_port: None }
    }
}

impl PortOptions {
    /// The silence that ends a message.
    pub(crate) fn gap(&self) -> Option<Duration> {
        self.gap.map(|gap| Duration::from_millis(gap.into()))
    }
}

/// A time of up to a day.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (0.0..=86_400.0).contains(&seconds) => Ok(seconds),
        _ => Err("not a number of seconds from 0 to 86400".into()),
    }
}

/// The level of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Level {
    /// Raised.
    On,
    /// Lowered.
    Off,
}

impl Level {
    pub(crate) fn is_on(self) -> bool {
        self == Self::On
    }
}

/// What becomes of the lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum AtClose {
    /// They stay as they are.
    Keep,
    /// They are lowered.
    Drop,
}

/// The same, but at least a hundredth of a second.
pub fn positive_seconds(text: &str) -> Result<f64, String> {
    match seconds(text) {
        Ok(seconds) if seconds >= 0.01 => Ok(seconds),
        _ => Err("not a number of seconds from 0.01 to 86400".into()),
    }
}

/// Why a port can't be used.
pub(crate) enum Cause {
    System(io::Error),
    InUse,
    NoSerialPort,
    /// The system's reason.
    NotUsable(String),
    NotTaken(u32),
    NoLine(&'static str),
    /// What becomes of the lines is not ours to say.
    ClosedByServer,
    NoRfc2217,
    Disconnected,
    TimedOut,
}

impl From<io::Error> for Cause {
    /// What an error of a device that was open means.
    fn from(error: io::Error) -> Self {
        if is_gone(&error) { Self::Disconnected } else { Self::System(error) }
    }
}

impl From<Errno> for Cause {
    fn from(error: Errno) -> Self {
        io::Error::from(error).into()
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::System(error) => f.write_str(&system_text(error)),
            Self::InUse => f.write_str("in use by another program"),
            Self::NoSerialPort => f.write_str("not a serial port"),
            Self::NotUsable(reason) => f.write_str(reason),
            Self::NotTaken(baud) => write!(f, "can't be set to {baud} baud 8N1"),
            Self::NoLine(name) => write!(f, "has no line {name}"),
            Self::ClosedByServer => f.write_str("--at-close: the server at the port decides that"),
            Self::NoRfc2217 => f.write_str("no serial port by RFC 2217"),
            Self::Disconnected => f.write_str("disconnected"),
            Self::TimedOut => f.write_str("no bytes were taken in time"),
        }
    }
}

/// Opens a port, as soon as that is possible.
pub(crate) struct Opening<'a> {
    path: &'a Path,
    options: &'a PortOptions,
    /// How long it is waited for; `None` for ever.
    wait_limit: Option<Duration>,
}

impl<'a> Opening<'a> {
    pub(crate) fn new(path: &'a Path, options: &'a PortOptions, reconnects: bool) -> Self {
        let wait_limit = Duration::from_secs_f64(options.wait_for_port.unwrap_or_default());
        Self { path, options, wait_limit: (!reconnects).then_some(wait_limit) }
    }

    /// `None` when it `is_given_up` before.
    pub(crate) fn open(&self, mut is_given_up: impl FnMut() -> bool) -> Result<Option<Device>, Failure> {
        let (began, mut complaint) = (Instant::now(), None);
        loop {
            let failure = match Device::open(self.path, self.options) {
                Ok(device) => return Ok(Some(device)),
                Err(failure) => failure,
            };
            if self.wait_limit.is_some_and(|wait_limit| began.elapsed() >= wait_limit) {
                return Err(failure);
            }
            let text = failure.to_string();
            if complaint.as_ref() != Some(&text) {
                complain(&format!("{text}; waiting"));
                complaint = Some(text);
            }
            for _ in 0..RETRY.as_millis() / 20 {
                if is_given_up() {
                    return Ok(None);
                }
                std::thread::sleep(Duration::from_millis(20));
            }
        }
    }
}

/// The ways to a port.
enum Port {
    Serial(Line),
    Network(Network),
}

impl Port {
    /// What can be polled and read.
    fn as_fd(&self) -> BorrowedFd<'_> {
        match self {
            Self::Serial(port) => port.as_fd(),
            Self::Network(network) => network.stream.as_fd(),
        }
    }
}

/// An open port.
pub struct Device {
    path: PathBuf,
    port: Port,
    baud: u32,
    gap: Duration,
    room: Box<[u8; 4096]>,
    /// How many bytes were read last.
    count: usize,
}

impl Device {
    /// Opens one, which is then used by nobody else.
    pub fn open(path: &Path, options: &PortOptions) -> Result<Self, Failure> {
        let opened = if is_url(path) {
            Network::open(path, options).map(|network| (Port::Network(network), GAP_NETWORK))
        } else {
            let gap = if is_direct(path) { GAP_DIRECT } else { GAP_USB };
            Line::open(path, options).map(|line| (Port::Serial(line), gap))
        };
        let (port, gap) = opened.map_err(|cause| Failure::of(path.display(), cause))?;
        // At low speeds, the time of some bytes.
        let gap = gap.max(Duration::from_secs(200) / options.baud);
        let baud = if path.to_string_lossy().starts_with("tcp://") { 0 } else { options.baud };
        let gap = options.gap().unwrap_or(gap);
        Ok(Self { path: path.to_owned(), port, baud, gap, room: Box::new([0; 4096]), count: 0 })
    }

    /// Speed of the line in baud; 0 where that is not known.
    pub const fn baud(&self) -> u32 {
        self.baud
    }

    /// The silence that ends a message.
    pub const fn gap(&self) -> Duration {
        self.gap
    }

    /// How long an answer may take, unless the user says how long.
    pub const fn answer_time(&self) -> Duration {
        match self.port {
            Port::Serial(_) => Duration::from_millis(250),
            Port::Network(_) => Duration::from_secs(1),
        }
    }

    /// Reads what has come, waiting for at most so long: [`bytes`](Self::bytes). `None` when nothing has, or a signal
    /// did.
    pub fn receive(&mut self, time: Duration) -> Result<Option<()>, Failure> {
        self.count = self.try_to_read(time).map_err(|cause| self.failure(cause))?;
        Ok((self.count > 0).then_some(()))
    }

    fn try_to_read(&mut self, time: Duration) -> Result<usize, Cause> {
        let happened = wait(self.port.as_fd(), time)?;
        if happened.is_empty() {
            return Ok(0);
        }
        // Even if the device is gone: there may be something left to read.
        if !happened.intersects(PollFlags::IN) {
            return Err(Cause::Disconnected);
        }
        if let Port::Network(network) = &mut self.port {
            return network.read(self.room.as_mut_slice());
        }
        match rustix::io::read(self.port.as_fd(), self.room.as_mut_slice()) {
            // There was something to read, so nothing is the end.
            Ok(0) => Err(Cause::Disconnected),
            Ok(count) => Ok(count),
            Err(Errno::AGAIN | Errno::INTR) => Ok(0),
            Err(error) => Err(error.into()),
        }
    }

    /// What was read last.
    pub fn bytes(&self) -> &[u8] {
        self.room.get(..self.count).unwrap_or_default()
    }

    /// Sends bytes, waiting for room where there is none.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        self.try_to_write(bytes).map_err(|cause| self.failure(cause))
    }

    fn try_to_write(&self, bytes: &[u8]) -> Result<(), Cause> {
        let wrapped = match &self.port {
            Port::Serial(_) => Vec::new(),
            Port::Network(network) => network.wrapped(bytes),
        };
        let mut bytes = if wrapped.is_empty() { bytes } else { &wrapped };
        let began = Instant::now();
        while !bytes.is_empty() {
            let written = match &self.port {
                Port::Serial(line) => line.write(bytes),
                Port::Network(network) => rustix::io::write(&network.stream, bytes).map_err(io::Error::from),
            };
            match written {
                Ok(written @ 1..) => bytes = bytes.get(written..).unwrap_or_default(),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => (),
                Err(error) if error.kind() != io::ErrorKind::WouldBlock => return Err(error.into()),
                _ => {
                    let left = WRITE_TIME.saturating_sub(began.elapsed());
                    if left.is_zero() {
                        return Err(Cause::TimedOut);
                    }
                    let happened = wait_for(self.port.as_fd(), PollFlags::OUT, left)?;
                    if !happened.is_empty() && !happened.intersects(PollFlags::OUT) {
                        return Err(Cause::Disconnected);
                    }
                }
            }
        }
        Ok(())
    }

    /// Waits until all was sent.
    pub fn drain(&mut self) -> Result<(), Failure> {
        let Port::Serial(line) = &self.port else { return Ok(()) };
        line.drain().map_err(|error| self.failure(error.into()))
    }

    /// What becomes readable when something comes.
    pub fn as_fd(&self) -> BorrowedFd<'_> {
        self.port.as_fd()
    }

    fn failure(&self, cause: Cause) -> Failure {
        Failure::of(self.path.display(), cause)
    }
}
