//! Ctrl-C and its kin.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::status::Failure;

/// Whether the program was asked to end. Waiting, which a signal cuts short, has to look here.
pub(crate) struct Signals(Arc<AtomicBool>);

impl Signals {
    /// From now on signals are noted instead of ending the program.
    pub(crate) fn catch() -> Result<Self, Failure> {
        let flag = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM, SIGHUP] {
            signal_hook::flag::register(signal, Arc::clone(&flag))
                .map_err(|error: io::Error| Failure::of("signals", error))?;
        }
        Ok(Self(flag))
    }

    /// Whether there was a signal since the last call.
    pub(crate) fn came(&self) -> bool {
        self.0.swap(false, Ordering::Relaxed)
    }
}
