//! Ctrl-C and its kin.

use std::mem::MaybeUninit;
use std::ptr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use libc::{SIGALRM, SIGHUP, SIGINT, SIGPROF, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2, SIGVTALRM, SIGXCPU, SIGXFSZ, c_int};

use crate::status::Failure;

/// What ends a program that does not care. Some devices and links have to be removed, whichever it is.
const ENDING: [c_int; 10] = [SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGALRM, SIGVTALRM, SIGPROF, SIGUSR1, SIGUSR2, SIGXCPU];

/// Whether the program was asked to end. Waiting, which a signal cuts short, has to look here.
pub struct Signals(Arc<AtomicBool>);

impl Signals {
    /// From now on signals are noted instead of ending the program, but for those that whoever started it had ignored:
    /// as `nohup` does with SIGHUP, and shells with SIGINT where a script runs something in the background.
    pub fn catch() -> Result<Self, Failure> {
        let flag = Arc::new(AtomicBool::new(false));
        let note = |signal, flag| {
            signal_hook::flag::register(signal, flag).map_err(|error| Failure::of_file("signals", &error))
        };
        for signal in ENDING.into_iter().filter(|signal| !is_ignored(*signal)) {
            note(signal, Arc::clone(&flag))?;
        }
        bear_size_limits()?;
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
    let noted = signal_hook::flag::register(SIGXFSZ, Arc::default());
    noted.map(drop).map_err(|error| Failure::of_file("signals", &error))
}

#[expect(unsafe_code, reason = "no library says it")]
fn is_ignored(signal: c_int) -> bool {
    let mut action = MaybeUninit::<libc::sigaction>::uninit();
    // SAFETY: without a new action sigaction(2) only writes the present one to the memory given, which is of its type.
    let result = unsafe { libc::sigaction(signal, ptr::null(), action.as_mut_ptr()) };
    // SAFETY: it was successful, so that the action was written.
    result == 0 && unsafe { action.assume_init() }.sa_sigaction == libc::SIG_IGN
}
