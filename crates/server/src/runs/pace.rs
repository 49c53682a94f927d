//! Schedules the updates of a run's followers, so that their number does not slow down a run on this computer.
//!
//! Knows only times.

use rafcon_locks::Mutex;
use std::time::Duration;
use tokio::time::Instant;

/// Minimum interval between updates of one follower.
const INTERVAL: Duration = Duration::from_millis(20);
/// Minimum interval between any two updates: with many followers, each is updated less often, and never all at once.
const SPACING: Duration = Duration::from_micros(2_500);

/// Schedule of updates for the followers of one run.
#[derive(Debug)]
pub(crate) struct Pace {
    latest: Mutex<Instant>,
}

impl Pace {
    pub(super) fn new() -> Self {
        Self { latest: Mutex::new(Instant::now()) }
    }

    /// Time of the next update for a follower that was just updated.
    pub(crate) fn next_time(&self) -> Instant {
        let mut latest = self.latest.lock();
        *latest = (*latest + SPACING).max(Instant::now() + INTERVAL);
        *latest
    }
}

#[cfg(test)]
mod tests {
    use super::Pace;
    use expect_test::expect;
    use std::fmt::Write as _;
    use tokio::time::{Instant, sleep_until};

    /// Update times of each follower, in µs. All start at once and are updated as soon as they are due.
    async fn told(followers: usize, times: usize) -> String {
        let (pace, begin) = (Pace::new(), Instant::now());
        let mut due = vec![begin; followers];
        let mut text = String::new();
        for _ in 0..times {
            for due in &mut due {
                sleep_until(*due).await;
                *due = pace.next_time();
                let separator =
                    if text.ends_with(|it: char| it.is_ascii_digit()) { " " } else { "" };
                write!(text, "{separator}{}", due.duration_since(begin).as_micros()).unwrap();
            }
            text.push('\n');
        }
        text
    }

    #[tokio::test(start_paused = true)]
    async fn a_few_are_told_every_20_ms() {
        expect![[r"
            20000 22500
            40000 43000
            60000 63000
        "]]
        .assert_eq(&told(2, 3).await);
    }

    #[tokio::test(start_paused = true)]
    async fn many_are_told_one_after_the_other() {
        expect![[r"
            20000 22500 25000 27500 30000 32500 35000 37500 40000 42500 45000 47500
            50000 52500 55000 57500 60000 62500 65000 67500 70000 72500 75000 77500
            80000 82500 85000 87500 90000 92500 95000 97500 100000 102500 105000 107500
        "]]
        .assert_eq(&told(12, 3).await);
    }
}
