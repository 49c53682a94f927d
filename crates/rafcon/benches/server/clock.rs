//! The time of day, which all processes of the computer share, and the only place where time is let pass.

use std::time::{Duration, SystemTime};

/// What Python's `time.time_ns()` says, in ms.
#[expect(clippy::disallowed_methods, reason = "a bench measures time; this is where it does")]
pub(crate) fn now_ms() -> f64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    since.as_secs_f64() * 1e3
}

/// What a script noted down by `time.time_ns()`, in ms.
#[expect(clippy::cast_precision_loss, reason = "a µs or less")]
pub(crate) fn noted_ms(ns: i64) -> f64 {
    ns as f64 / 1e6
}

/// Lets time pass in which something else is measured.
#[expect(clippy::disallowed_methods, reason = "what happens in this time is what is measured")]
pub(crate) fn pass(time: Duration) {
    std::thread::sleep(time);
}
