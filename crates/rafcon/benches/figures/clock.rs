//! The only clock of the bench.

use std::time::Instant;

/// Seconds that `work` takes, and what it gives.
#[expect(clippy::disallowed_methods, reason = "a bench measures time; this is where it does")]
pub(crate) fn seconds<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = work();
    (start.elapsed().as_secs_f64(), result)
}
