//! Ctrl-C and its kin.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::status::Failure;
use crate::system;

/// Whether the program was asked to end. Waiting, which a signal cuts short on Unix, has to look here.
pub struct Signals(Arc<AtomicBool>);

impl Signals {
    /// From now on signals are noted instead of ending the program.
    pub fn catch() -> Result<Self, Failure> {
        let flag = Arc::default();
        system::catch_signals(&flag).map_err(|error| failure(&error))?;
        Ok(Self(flag))
    }

    /// Whether there was a signal.
    pub(crate) fn is_raised(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Whether there was a signal since the last call.
    pub(crate) fn came(&self) -> bool {
        self.0.swap(false, Ordering::Relaxed)
    }
}

/// A limit on the size of files is a full disk: writing fails, which says so.
pub fn bear_size_limits() -> Result<(), Failure> {
    system::bear_size_limits().map_err(|error| failure(&error))
}

fn failure(error: &io::Error) -> Failure {
    Failure::of_file("signals", error)
}
