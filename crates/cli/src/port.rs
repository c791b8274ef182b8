//! The serial port as the program's arguments name it.

use std::ffi::{CString, c_long};
use std::mem::MaybeUninit;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use deltarobot::port::{Failed, Port, Settings};

use crate::status::Failure;

/// How long a write may wait for room, in milliseconds. At 115200 baud the system's buffer is empty after half of that.
const WRITE_MS: c_long = 1000;

/// How a device is set.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct Speed {
    /// Speed of the line in baud
    #[arg(long, value_name = "BAUD", default_value_t = 115_200)]
    baud: u32,
}

/// An open port.
pub(crate) struct Device {
    port: Port,
    room: [MaybeUninit<u8>; 4096],
}

impl Device {
    pub(crate) fn open(path: &Path, speed: Speed) -> Result<Self, Failure> {
        let name = CString::new(path.as_os_str().as_bytes())
            .map_err(|_| Failure::Usage("a device's name can't contain a zero byte".into()))?;
        let mut port = Port::new();
        port.open(&name, &Settings::at(speed.baud.into())).map_err(|Failed| failure(&port))?;
        Ok(Self { port, room: [MaybeUninit::uninit(); 4096] })
    }

    /// What has come, waited for at most so many milliseconds. Nothing when none came or a signal did.
    pub(crate) fn read(&mut self, timeout_ms: u32) -> Result<&[u8], Failure> {
        match self.port.read(&mut self.room, timeout_ms.into()) {
            Ok(bytes) => Ok(bytes),
            Err(Failed) => Err(failure(&self.port)),
        }
    }

    pub(crate) fn write(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        self.port.send(bytes, WRITE_MS).map_err(|Failed| failure(&self.port))
    }

    /// Waits until all was sent.
    pub(crate) fn drain(&mut self) -> Result<(), Failure> {
        self.port.drain().map_err(|Failed| failure(&self.port))
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        self.port.close();
    }
}

fn failure(port: &Port) -> Failure {
    Failure::Device(port.error().to_string_lossy().into_owned())
}
