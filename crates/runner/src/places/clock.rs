//! The only clock of this crate.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// The time since the run began, and the time of day for the expiry of commands.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    start: Instant,
    /// Elapsed time of the run when this runner began, in ns.
    before_ns: u64,
}

impl Clock {
    /// Starts the clock of a new run.
    #[expect(clippy::disallowed_methods, reason = "this is the crate's one clock module")]
    pub fn start() -> Self {
        Self { start: Instant::now(), before_ns: 0 }
    }

    /// The clock of a run with this elapsed time.
    pub(crate) fn after(self, before_ns: u64) -> Self {
        Self { before_ns, ..self }
    }

    /// Time since the start, in ns.
    pub fn now_ns(&self) -> u64 {
        let elapsed = u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX);
        elapsed.saturating_add(self.before_ns)
    }

    /// Time since the start, in ms.
    pub fn now_ms(&self) -> u64 {
        self.now_ns() / 1_000_000
    }

    /// The instant at this time of the run.
    pub(crate) fn instant(&self, at_ns: u64) -> Option<Instant> {
        let after = Duration::from_nanos(at_ns.saturating_sub(self.before_ns));
        self.start.checked_add(after)
    }

    /// Time of day, in ms since 1970 UTC.
    #[expect(clippy::disallowed_methods, reason = "this is the crate's one clock module")]
    pub fn epoch_ms() -> u64 {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
    }

    /// The instant `after` from now.
    #[expect(clippy::disallowed_methods, reason = "this is the crate's one clock module")]
    pub fn moment(after: Duration) -> Option<Instant> {
        Instant::now().checked_add(after)
    }
}
