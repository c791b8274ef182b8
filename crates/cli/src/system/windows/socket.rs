//! Sockets that stand for what Windows can't poll.

use std::io::{self, ErrorKind, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::thread::{Builder, JoinHandle};

/// Two that are connected to each other, and to nobody else.
pub(super) fn pair() -> io::Result<(TcpStream, TcpStream)> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
    let near = TcpStream::connect(listener.local_addr()?)?;
    loop {
        let (far, peer) = listener.accept()?;
        // Any program of this machine could have come first.
        if peer == near.local_addr()? {
            near.set_nodelay(true)?;
            far.set_nodelay(true)?;
            return Ok((near, far));
        }
    }
}

/// Has a thread write what it reads to a socket, until there is no more, an error, or nobody at its other end. `None`
/// is for nothing yet.
pub(super) fn pass_on(
    name: &str,
    mut far: TcpStream,
    mut read: impl FnMut(&mut [u8]) -> io::Result<Option<usize>> + Send + 'static,
) -> io::Result<JoinHandle<()>> {
    Builder::new().name(name.into()).spawn(move || {
        let mut room = vec![0; 4096];
        loop {
            match read(&mut room) {
                Ok(None) => (),
                Err(error) if error.kind() == ErrorKind::Interrupted => (),
                Ok(Some(count @ 1..)) if far.write_all(room.get(..count).unwrap_or_default()).is_ok() => (),
                _ => break,
            }
        }
    })
}
