//! The only place in this crate that reads a clock. It is public for the programs that use the crate.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// The time in ms since 1970, UTC.
pub fn since_1970_ms() -> u64 {
    u64::try_from(since_1970().as_millis()).unwrap_or(u64::MAX)
}

/// The current time of a monotonic clock.
#[expect(clippy::disallowed_methods, reason = "this is the crate's one clock")]
pub fn now() -> Instant {
    Instant::now()
}

/// Smaller steps are regular corrections of the clock.
const STEP_MIN_MS: i64 = 1000;

/// Detects when the computer's clock is set, because ages are differences of its times.
#[derive(Debug)]
pub struct CalendarSteps {
    at: Duration,
    at_ms: u64,
}

impl CalendarSteps {
    /// Starts at this time since boot, with this time of the clock.
    pub fn from(at: Duration, at_ms: u64) -> Self {
        Self { at, at_ms }
    }

    /// Step of the clock since the last call, in ms; 0 for steps below a second. The arguments are the current time of both clocks.
    pub fn step_ms(&mut self, now: Duration, now_ms: u64) -> i64 {
        let passed = now.saturating_sub(self.at).as_millis();
        let expected = self.at_ms.saturating_add(u64::try_from(passed).unwrap_or(u64::MAX));
        (self.at, self.at_ms) = (now, now_ms);
        let step = now_ms.checked_signed_diff(expected).unwrap_or(i64::MAX);
        if step.abs() < STEP_MIN_MS { 0 } else { step }
    }
}

/// Time since the computer's boot, including suspension.
pub fn since_boot() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::Boottime);
    Duration::try_from(time).unwrap_or_default()
}

/// A number that probably differs between two programs that start within one second.
pub fn salt(attempt: u16) -> u16 {
    let nanos = since_1970().subsec_nanos();
    let mixed = (nanos / 1000).wrapping_add(std::process::id()).wrapping_mul(0x9e37_79b1) >> 16;
    u16::try_from(mixed).unwrap_or_default().wrapping_add(attempt)
}

fn since_1970() -> Duration {
    #[expect(clippy::disallowed_methods, reason = "this is the crate's one clock")]
    let now = SystemTime::now();
    now.duration_since(UNIX_EPOCH).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::CalendarSteps;
    use std::time::Duration;

    #[test]
    fn a_calendar_that_is_set_is_noticed_once_and_one_that_is_corrected_is_not() {
        let mut steps = CalendarSteps::from(Duration::from_secs(7), 1_000_000);
        let mut step =
            |at_s: u64, calendar_ms| steps.step_ms(Duration::from_secs(7 + at_s), calendar_ms);
        assert_eq!(step(10, 1_010_000), 0);
        assert_eq!(step(20, 1_020_900), 0);
        assert_eq!(step(21, 2_021_900), 1_000_000);
        assert_eq!(step(22, 2_022_900), 0);
        assert_eq!(step(23, 23_900), -2_000_000);
        assert_eq!(step(24, 24_900), 0);
    }
}
