//! Ctrl-C and its kin.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::status::Failure;
use crate::system::catch_signals;

/// Whether the program was asked to end. Waiting, which a signal cuts short on Unix, has to look here.
pub struct Signals(Arc<AtomicBool>);

impl Signals {
    /// From now on signals are noted instead of ending the program.
    pub fn catch() -> Result<Self, Failure> {
        let flag = Arc::default();
        catch_signals(&flag).map_err(|error| Failure::of_file("signals", &error))?;
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
