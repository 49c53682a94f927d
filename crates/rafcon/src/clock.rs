//! The only clock of this program; all other code receives the time as an argument.

use rafcon_protocol::calendar::Date;
use rafcon_supervisor::clock::since_1970_ms;
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

    /// Time since its start.
    pub(crate) fn now(self) -> Duration {
        self.0.elapsed()
    }
}

/// Date and time in UTC, in the format of machines: `2026-01-31 12:00:00`.
pub(crate) fn utc() -> String {
    Date::since_1970(since_1970_ms() / 1000).to_string()
}
