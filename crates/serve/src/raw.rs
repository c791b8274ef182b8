//! The bytes of a robot's line over TCP, for programs that know nothing of this one: one drives, the others listen.

use std::net::SocketAddr;
use std::sync::Arc;

use deltarobot_cli::decoder::deltarobot::Frames;
use deltarobot_cli::decoder::{Decoder, Kind};
use deltarobot_cli::recording::{Entry, Side};
use deltarobot_protocols::deltarobot::Opcode;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::tcp::{OwnedReadHalf, OwnedWriteHalf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;
use tokio::sync::broadcast::Receiver;
use tokio::sync::broadcast::error::RecvError;

use crate::lease::Wish;
use crate::robot::Robot;

/// Connections to one robot at a time.
const CONNECTIONS_MAX: usize = 16;
/// Bytes that are passed on at a time.
const PIECE: usize = 512;

/// Lets programs in, for ever.
pub(crate) async fn serve(listener: TcpListener, robot: Arc<Robot>) {
    let room = Arc::new(Semaphore::new(CONNECTIONS_MAX));
    while let Ok(place) = Arc::clone(&room).acquire_owned().await {
        match listener.accept().await {
            Ok((stream, peer)) => {
                let robot = Arc::clone(&robot);
                tokio::spawn(async move {
                    connect(stream, peer, robot).await;
                    drop(place);
                });
            }
            Err(_) => tokio::time::sleep(std::time::Duration::from_millis(50)).await,
        }
    }
}

async fn connect(stream: TcpStream, peer: SocketAddr, robot: Arc<Robot>) {
    let _ = stream.set_nodelay(true);
    let bytes = robot.bytes.subscribe();
    let (read, write) = stream.into_split();
    let mut client = Client { robot, name: format!("raw {peer}"), lease: None, listened: Frames::default() };
    tokio::select! {
        () = listen(bytes, write) => (),
        () = client.drive(read) => (),
    }
}

/// Passes on what the robot sends. Who is too slow loses some of it, as on any line.
async fn listen(mut bytes: Receiver<Arc<Entry>>, mut stream: OwnedWriteHalf) {
    loop {
        match bytes.recv().await {
            Ok(passed) if passed.from == Side::Host => (),
            Ok(passed) => {
                if stream.write_all(&passed.bytes).await.is_err() {
                    return;
                }
            }
            Err(RecvError::Lagged(_)) => (),
            Err(RecvError::Closed) => return,
        }
    }
}

/// Somebody who may drive; gives the lease back when it is dropped.
struct Client {
    robot: Arc<Robot>,
    name: String,
    lease: Option<String>,
    /// What was sent without driving.
    listened: Frames,
}

impl Drop for Client {
    fn drop(&mut self) {
        if let Some(word) = &self.lease {
            self.robot.release(word);
        }
    }
}

impl Client {
    async fn drive(&mut self, mut stream: OwnedReadHalf) {
        // The first drives.
        self.acquire();
        let mut room = [0; PIECE];
        loop {
            let Ok(count @ 1..) = stream.read(&mut room).await else { return };
            let bytes = room.get(..count).unwrap_or_default();
            self.acquire();
            let is_sent = match &self.lease {
                Some(word) => self.robot.send_raw(bytes.to_vec(), word).await.is_ok(),
                None => false,
            };
            if !is_sent {
                self.look_for_cancel(bytes).await;
            }
        }
    }

    /// Drives, if nobody else does.
    fn acquire(&mut self) {
        let is_held = self.lease.as_ref().is_some_and(|word| self.robot.leases.holder(word).is_ok());
        if !is_held {
            let wish = Wish { client: &self.name, force: false, word: None, lasts: None };
            self.lease = self.robot.acquire(&wish).ok().map(|lease| lease.word);
        }
    }

    /// Cancelling is open to everybody.
    async fn look_for_cancel(&mut self, bytes: &[u8]) {
        let pieces = self.listened.feed(Some(Side::Host), bytes);
        if pieces.iter().any(|piece| matches!(&piece.kind, Kind::Message(name) if name == Opcode::CANCEL.name())) {
            // The port may be closed.
            let _ = self.robot.cancel().await;
        }
    }
}
