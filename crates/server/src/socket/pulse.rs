//! Whether somebody is at the other end of a connection. Knows when the client was heard, or took something, last.

use super::outbox::Outbox;
use parking_lot::Mutex;
use std::time::Duration;
use tokio::time::{Instant, sleep_until};

/// After so much silence the client is asked.
const ASKED_AFTER: Duration = Duration::from_secs(20);
/// After so much silence nobody is there.
const GONE_AFTER: Duration = Duration::from_mins(1);

/// Signs of life of a client.
#[derive(Debug)]
pub(super) struct Pulse {
    last: Mutex<Instant>,
}

impl Pulse {
    pub(super) fn new() -> Self {
        Self { last: Mutex::new(Instant::now()) }
    }

    /// The client was heard, or took what was sent.
    pub(super) fn beat(&self) {
        *self.last.lock() = Instant::now();
    }

    fn last(&self) -> Instant {
        *self.last.lock()
    }

    /// Waits until nobody is there: a client that says nothing is asked, and has its time to answer.
    pub(super) async fn end(&self, outbox: &Outbox) {
        let mut asked = None;
        loop {
            let last = self.last();
            let is_asked = asked == Some(last);
            sleep_until(last + if is_asked { GONE_AFTER } else { ASKED_AFTER }).await;
            if self.last() != last {
                continue;
            }
            if is_asked {
                return;
            }
            outbox.ping();
            asked = Some(last);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Outbox, Pulse};
    use expect_test::{Expect, expect};
    use std::fmt::Write as _;
    use std::time::Duration;
    use tokio::time::{Instant, sleep_until};

    /// When a client is asked, and when it is gone, that was heard at these seconds.
    async fn check(heard: &[u64], expect: &Expect) {
        let (outbox, pulse, begin) = (Outbox::new(), Pulse::new(), Instant::now());
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
    async fn who_is_silent_is_asked_once_and_then_gone() {
        check(
            &[],
            &expect![["
            20 asked
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
            25 asked
            65 asked
            86 gone
        "]],
        )
        .await;
    }
}
