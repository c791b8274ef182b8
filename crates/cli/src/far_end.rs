//! The far end of a device, which this program plays for others: a pseudo-terminal, or a port of TCP.

use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::time::Duration;

use rustix::fd::{AsFd, BorrowedFd};
use rustix::io::Errno;

use crate::status::Failure;
use crate::system::pseudo_terminal;
use crate::wait::wait;

/// What came from the other program.
pub enum Input {
    /// So many bytes, 0 when none came in time or a signal did.
    Bytes(usize),
    /// No program has the device open.
    Nobody,
}

/// The far end of a device which one other program at a time opens by its path.
pub trait FarEnd: Send {
    /// What the other program opens.
    fn path(&self) -> &Path;

    /// Reads what has come, waiting for it, or for somebody, for at most so long.
    fn read(&mut self, out: &mut [u8], time: Duration) -> Result<Input, Failure>;

    /// Whether a program has the device open.
    fn is_open(&self) -> Result<bool, Failure>;

    /// Writes what there is room for. A line does not wait for who reads too slowly, or not at all.
    fn write(&mut self, bytes: &[u8]) -> Result<(), Failure>;

    /// What becomes readable when something comes, as long as a program has the device open.
    fn as_fd(&self) -> BorrowedFd<'_>;
}

/// Where it is.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Place {
    /// A symbolic link to make to the device, a pseudo-terminal
    #[arg(long, value_name = "PATH", conflicts_with = "listen")]
    link: Option<PathBuf>,
    /// Listens for a program at this address instead of making a pseudo-terminal, and prints `tcp://HOST:PORT`; port 0
    /// takes a free one. Without pseudo-terminals, as on Windows, 127.0.0.1:0 is the default
    #[arg(long, value_name = "HOST:PORT")]
    listen: Option<String>,
}

impl Place {
    /// A pseudo-terminal with a link.
    pub fn linked(link: &Path) -> Self {
        Self { link: Some(link.to_owned()), listen: None }
    }

    /// Whether the command line says it.
    pub(crate) const fn is_given(&self) -> bool {
        self.link.is_some() || self.listen.is_some()
    }

    /// Makes it; if it is a tap, the one of a device.
    pub fn make(&self, tapped: Option<&Path>) -> Result<Box<dyn FarEnd>, Failure> {
        let link = self.link.as_deref();
        if self.listen.is_none()
            && let Some(made) = pseudo_terminal(link, tapped)?
        {
            return Ok(made);
        }
        if link.is_some() {
            return Err(Failure::Usage("--link: there are no pseudo-terminals on this system".into()));
        }
        Ok(Box::new(Port::listen(self.listen.as_deref().unwrap_or("127.0.0.1:0"))?))
    }
}

/// A port of TCP. Whoever connects while another is connected waits for that to leave.
struct Port {
    listener: TcpListener,
    path: PathBuf,
    peer: Option<TcpStream>,
}

impl Port {
    fn listen(address: &str) -> Result<Self, Failure> {
        let bound = TcpListener::bind(address).and_then(|listener| {
            listener.set_nonblocking(true)?;
            Ok((listener.local_addr()?, listener))
        });
        let (address, listener) = bound.map_err(|error| Failure::of_file(address, &error))?;
        Ok(Self { listener, path: format!("tcp://{address}").into(), peer: None })
    }

    /// Takes the next one who connects. If nothing comes of that, he has gone already.
    fn accept(&mut self) -> Input {
        let accepted = self.listener.accept().and_then(|(peer, _)| {
            peer.set_nonblocking(true)?;
            peer.set_nodelay(true)?;
            Ok(peer)
        });
        self.peer = accepted.ok();
        if self.peer.is_some() { Input::Bytes(0) } else { Input::Nobody }
    }

    fn failure(&self, error: Errno) -> Failure {
        Failure::of_file(self.path.display(), &error.into())
    }
}

impl FarEnd for Port {
    fn path(&self) -> &Path {
        &self.path
    }

    fn read(&mut self, out: &mut [u8], time: Duration) -> Result<Input, Failure> {
        let has_come = !wait(FarEnd::as_fd(self), time).map_err(|error| self.failure(error))?.is_empty();
        match &self.peer {
            None => Ok(if has_come { self.accept() } else { Input::Nobody }),
            Some(_) if !has_come => Ok(Input::Bytes(0)),
            Some(peer) => match rustix::io::read(peer, out) {
                Ok(count @ 1..) => Ok(Input::Bytes(count)),
                Err(Errno::AGAIN | Errno::INTR) => Ok(Input::Bytes(0)),
                Ok(0) | Err(_) => {
                    self.peer = None;
                    Ok(Input::Nobody)
                }
            },
        }
    }

    fn is_open(&self) -> Result<bool, Failure> {
        Ok(self.peer.is_some())
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        // Whether that has gone shows when it is read.
        let _ = self.peer.as_ref().map(|peer| rustix::io::write(peer, bytes));
        Ok(())
    }

    fn as_fd(&self) -> BorrowedFd<'_> {
        self.peer.as_ref().map_or(self.listener.as_fd(), AsFd::as_fd)
    }
}
