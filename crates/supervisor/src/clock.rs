//! The one place of this crate that reads a clock. It is public for the programs around it, which have no other calendar.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// The time in ms since 1970, UTC.
pub fn since_1970_ms() -> u64 {
    u64::try_from(since_1970().as_millis()).unwrap_or(u64::MAX)
}

/// Now, on a clock that never goes back.
#[expect(clippy::disallowed_methods, reason = "this is the crate's one clock")]
pub fn now() -> Instant {
    Instant::now()
}

/// A number that is not likely to be the same for two programs that begin in the same second.
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
