//! The clock of a process in the simulated world.

use rafcon_link::SessionTime;
use std::time::Duration;

const MILLION: u128 = 1_000_000;

/// A clock that starts with its process, and runs slightly faster or slower than the world's.
#[derive(Debug, Clone, Copy)]
pub(super) struct LocalClock {
    started: Duration,
    /// Its progress in a million ns of the world.
    per_million: u128,
}

impl LocalClock {
    /// A clock that gains `fast` ns in a million.
    pub(super) fn new(started: Duration, fast: i64) -> Self {
        let per_million = MILLION.saturating_add_signed(i128::from(fast));
        Self { started, per_million }
    }

    pub(super) fn local(self, now: Duration) -> SessionTime {
        let passed = now.saturating_sub(self.started).as_nanos();
        SessionTime::after(nanos(passed * self.per_million / MILLION))
    }

    /// The first time of the world at which the clock shows this time.
    pub(super) fn real(self, local: SessionTime) -> Duration {
        let local = local.since(SessionTime::BEGIN);
        let passed = (local.as_nanos() * MILLION).div_ceil(self.per_million);
        self.started + nanos(passed)
    }
}

fn nanos(nanos: u128) -> Duration {
    Duration::from_nanos(u64::try_from(nanos).unwrap_or(u64::MAX))
}
