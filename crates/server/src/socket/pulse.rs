//! Detects dead connections. Knows the time of a client's last sign of life.

use super::outbox::Outbox;
use rafcon_locks::Mutex;
use std::time::Duration;
use tokio::time::{Instant, sleep_until};

/// Interval of pings. A reply shows that an idle client is alive.
const ASKED_EVERY: Duration = Duration::from_secs(10);
/// Silence after which a client counts as disconnected.
const GONE_AFTER: Duration = Duration::from_mins(1);

/// The last sign of life of a client.
#[derive(Debug)]
pub(super) struct ClientPulse {
    last: Mutex<Instant>,
}

impl ClientPulse {
    pub(super) fn new() -> Self {
        Self { last: Mutex::new(Instant::now()) }
    }

    /// Notes a message of the client, or a frame that it took.
    pub(super) fn beat(&self) {
        *self.last.lock() = Instant::now();
    }

    fn last(&self) -> Instant {
        *self.last.lock()
    }

    /// Waits until the client counts as disconnected. Sends pings meanwhile.
    pub(super) async fn end(&self, outbox: &Outbox) {
        let mut ask_at = Instant::now() + ASKED_EVERY;
        loop {
            sleep_until(ask_at.min(self.last() + GONE_AFTER)).await;
            if Instant::now() >= self.last() + GONE_AFTER {
                return;
            }
            if Instant::now() >= ask_at {
                outbox.ping();
                ask_at = Instant::now() + ASKED_EVERY;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{ClientPulse, Outbox};
    use expect_test::{Expect, expect};
    use std::fmt::Write as _;
    use std::time::Duration;
    use tokio::time::{Instant, sleep_until};

    /// Prints the times of pings and of the disconnection for a client that is active at these seconds.
    async fn check(heard: &[u64], expect: &Expect) {
        let (outbox, pulse, begin) = (Outbox::new(), ClientPulse::new(), Instant::now());
        let mut text = String::new();
        let beat = async {
            for at in heard {
                sleep_until(begin + Duration::from_secs(*at)).await;
                pulse.beat();
            }
        };
        let watch = async {
            let mut end = std::pin::pin!(pulse.end(&outbox));
            loop {
                tokio::select! {
                    () = &mut end => break writeln!(text, "{} gone", begin.elapsed().as_secs()).unwrap(),
                    _ping = outbox.next() => writeln!(text, "{} asked", begin.elapsed().as_secs()).unwrap(),
                }
            }
        };
        tokio::join!(beat, watch);
        expect.assert_eq(&text);
    }

    #[tokio::test(start_paused = true)]
    async fn who_is_silent_is_asked_and_then_gone() {
        check(
            &[],
            &expect![["
                10 asked
                20 asked
                30 asked
                40 asked
                50 asked
                60 gone
            "]],
        )
        .await;
    }

    #[tokio::test(start_paused = true)]
    async fn who_answers_stays() {
        check(
            &[5, 26, 90, 91],
            &expect![["
                10 asked
                20 asked
                30 asked
                40 asked
                50 asked
                60 asked
                70 asked
                80 asked
                86 gone
            "]],
        )
        .await;
    }
}
