//! The clock that all processes of the computer share, and the only place where time is let pass.

use rustix::time::{ClockId, clock_gettime};
use std::time::Duration;

/// What Python's `time.perf_counter_ns()` says, in ms.
pub(crate) fn now_ms() -> f64 {
    let now = clock_gettime(ClockId::Monotonic);
    ms(now.tv_sec) * 1e3 + ms(now.tv_nsec) / 1e6
}

/// What a script noted down by `time.perf_counter_ns()`, in ms.
pub(crate) fn noted_ms(ns: i64) -> f64 {
    ms(ns) / 1e6
}

#[expect(clippy::cast_precision_loss, reason = "a computer is not on for years")]
fn ms(number: i64) -> f64 {
    number as f64
}

/// Lets time pass in which something else is measured.
#[expect(clippy::disallowed_methods, reason = "what happens in this time is what is measured")]
pub(crate) fn pass(time: Duration) {
    std::thread::sleep(time);
}
