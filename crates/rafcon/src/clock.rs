//! The one place of this program that reads a clock; everybody else gets the time as an argument.

use std::time::{Duration, Instant};

/// Time since the program began.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Clock(Instant);

impl Clock {
    /// A clock at zero.
    pub(crate) fn start() -> Self {
        #[expect(clippy::disallowed_methods, reason = "this is the program's one clock")]
        Self(Instant::now())
    }

    /// How long it has been running.
    pub(crate) fn now(self) -> Duration {
        self.0.elapsed()
    }
}
