//! The crate's one clock.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Time since the runner began, and the time of day where a command's expiry asks for it.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    start: Instant,
}

impl Clock {
    /// A clock that begins now.
    #[expect(clippy::disallowed_methods, reason = "this is the crate's one clock module")]
    pub fn start() -> Self {
        Self { start: Instant::now() }
    }

    /// Time since the start, in ns.
    pub fn now_ns(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    /// Time since the start, in ms.
    pub fn now_ms(&self) -> u64 {
        self.now_ns() / 1_000_000
    }

    /// Time of day, in ms since 1970 UTC.
    #[expect(clippy::disallowed_methods, reason = "this is the crate's one clock module")]
    pub fn epoch_ms() -> u64 {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
    }

    /// The moment `after` from now.
    #[expect(clippy::disallowed_methods, reason = "this is the crate's one clock module")]
    pub fn moment(after: Duration) -> Option<Instant> {
        Instant::now().checked_add(after)
    }
}
