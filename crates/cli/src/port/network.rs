//! Ports of a network: the bytes alone (`tcp://host:port`), or a serial port with its settings by RFC 2217
//! (`rfc2217://host:port`).

use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::path::Path;
use std::time::{Duration, Instant};

use rustix::event::PollFlags;
use rustix::fd::AsFd;
use rustix::io::Errno;

use super::telnet::Telnet;
use super::{Cause, PortOptions};
use crate::wait::wait;

/// How long a connection, and an answer to the settings, may take.
const CONNECT_TIME: Duration = Duration::from_secs(5);

/// Ways to a port over a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scheme {
    Tcp,
    Rfc2217,
}

fn address(path: &Path) -> Option<(Scheme, &str)> {
    let text = path.to_str()?;
    let tcp = text.strip_prefix("tcp://").map(|address| (Scheme::Tcp, address));
    tcp.or_else(|| text.strip_prefix("rfc2217://").map(|address| (Scheme::Rfc2217, address)))
}

/// Whether a port's name is that of one in a network.
pub fn is_url(path: &Path) -> bool {
    address(path).is_some()
}

/// A connection.
#[derive(Debug)]
pub(super) struct Network {
    pub(super) stream: TcpStream,
    telnet: Option<Telnet>,
}

impl Network {
    pub(super) fn open(path: &Path, options: &PortOptions) -> Result<Self, Cause> {
        let Some((scheme, address)) = address(path) else { return Err(Cause::NoSerialPort) };
        if scheme == Scheme::Tcp && (options.dtr.is_some() || options.rts.is_some() || options.at_close.is_some()) {
            return Err(Cause::NoLine("DTR nor RTS"));
        }
        if options.at_close.is_some() {
            return Err(Cause::ClosedByServer);
        }
        let stream = connect(address.trim_end_matches('/')).map_err(Cause::System)?;
        stream.set_nodelay(true).and_then(|()| stream.set_nonblocking(true)).map_err(Cause::System)?;
        let telnet = (scheme == Scheme::Rfc2217).then(|| Telnet::new(options.baud));
        let mut network = Self { stream, telnet };
        network.set(options)?;
        Ok(network)
    }

    /// Sets a port of RFC 2217, and waits until that has been confirmed.
    fn set(&mut self, options: &PortOptions) -> Result<(), Cause> {
        let Some(telnet) = &self.telnet else { return Ok(()) };
        let level = |level: Option<super::Level>| level.map(super::Level::is_on);
        let request = telnet.request(level(options.dtr), level(options.rts));
        self.write_raw(&request)?;
        let began = Instant::now();
        let mut room = [0; 1024];
        while let Some(telnet) = &self.telnet {
            match telnet.baud() {
                Some(baud) if baud == options.baud => break,
                Some(_) => return Err(Cause::NotTaken(options.baud)),
                None if telnet.is_refused() || began.elapsed() >= CONNECT_TIME => return Err(Cause::NoRfc2217),
                None => (),
            }
            if !wait(self.stream.as_fd(), Duration::from_millis(50))?.is_empty() {
                // What it sends before is thrown away, as what any port had received is.
                self.read(&mut room)?;
            }
        }
        Ok(())
    }

    /// Reads what is there; none if nothing is for us.
    pub(super) fn read(&mut self, room: &mut [u8]) -> Result<usize, Cause> {
        let count = match rustix::io::read(&self.stream, &mut *room) {
            Ok(0) => return Err(Cause::Disconnected),
            Ok(count) => count,
            Err(Errno::AGAIN | Errno::INTR) => return Ok(0),
            Err(error) => return Err(error.into()),
        };
        let Some(telnet) = &mut self.telnet else { return Ok(count) };
        let (count, answer) = telnet.take(room.get_mut(..count).unwrap_or_default());
        self.write_raw(&answer)?;
        Ok(count)
    }

    /// Bytes as they have to be sent.
    pub(super) fn wrapped(&self, bytes: &[u8]) -> Vec<u8> {
        if self.telnet.is_some() { Telnet::escaped(bytes) } else { bytes.to_vec() }
    }

    fn write_raw(&self, mut bytes: &[u8]) -> Result<(), Cause> {
        while !bytes.is_empty() {
            match rustix::io::write(&self.stream, bytes) {
                Ok(count) => bytes = bytes.get(count..).unwrap_or_default(),
                Err(Errno::INTR) => (),
                Err(Errno::AGAIN) => {
                    let happened = crate::wait::wait_for(self.stream.as_fd(), PollFlags::OUT, super::WRITE_TIME)?;
                    if !happened.intersects(PollFlags::OUT) {
                        return Err(Cause::TimedOut);
                    }
                }
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }
}

fn connect(address: &str) -> io::Result<TcpStream> {
    let mut failure = io::Error::new(io::ErrorKind::NotFound, "no such host");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT_TIME) {
            Ok(stream) => return Ok(stream),
            Err(error) => failure = error,
        }
    }
    Err(failure)
}
