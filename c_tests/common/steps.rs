//! What tests of programs have in common: waiting for what they do, and paths as their arguments.

use std::path::Path;
use std::time::{Duration, Instant};

/// What has not come by then won't come, however slow the machine.
pub(crate) const TIMEOUT: Duration = Duration::from_secs(300);

/// Waits until that is so.
#[track_caller]
pub(crate) fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    found(what, || is_so().then_some(()));
}

/// Waits until there is something.
#[track_caller]
pub(crate) fn found<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let began = Instant::now();
    while began.elapsed() < TIMEOUT {
        if let Some(found) = look() {
            return found;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("in vain: {what}");
}

/// A path as an argument.
pub(crate) fn utf8(path: &Path) -> &str {
    path.to_str().unwrap()
}
