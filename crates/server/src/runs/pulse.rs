//! Detects runners that hang. An idle runner sends no messages by itself, so the server pings it while the run has onlookers.
//!
//! Knows pings, replies and the number of onlookers. Does not know other messages, nor the clients.

use super::link::Link;
use super::run::Run;
use rafcon_supervisor::clock;
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::sleep;

/// Interval of pings to a runner.
const ASK_EVERY: Duration = Duration::from_secs(1);
/// Number of unanswered pings after which a runner counts as silent. A count, not a time: a server that was suspended itself has
/// sent only one.
const UNANSWERED_MAX: u32 = 3;
/// Number of pings before the onlookers are checked again, so that a page that reloads finds a current state.
const ROUND: u32 = 10;

/// Replies of a runner.
#[derive(Debug)]
pub(super) struct RunnerPulse {
    /// Pings since its last message.
    unanswered: AtomicU32,
    /// Time of its last message, in ms since boot: steps of the calendar do not change it.
    heard_since_boot_ms: AtomicU64,
}

/// Action at the next ping.
#[derive(Debug, PartialEq, Eq)]
enum PulseAction {
    /// Send the next ping.
    Ask,
    /// Report that the runner has become silent.
    Tell,
    /// Do nothing: the silence is already reported.
    Nothing,
}

/// Effect of a message on the liveness of a runner.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Liveness {
    /// The runner was not silent.
    Still,
    /// The runner was silent before.
    Again,
}

impl RunnerPulse {
    /// The pulse of a runner that has just sent a message.
    pub(super) fn new() -> Self {
        let heard_since_boot_ms = AtomicU64::new(millis(clock::since_boot()));
        Self { unanswered: AtomicU32::new(0), heard_since_boot_ms }
    }

    /// Notes a message of the runner.
    pub(super) fn note_heard(&self) -> Liveness {
        self.heard_since_boot_ms.store(millis(clock::since_boot()), Ordering::Relaxed);
        let unanswered = self.unanswered.swap(0, Ordering::Relaxed);
        if unanswered > UNANSWERED_MAX { Liveness::Again } else { Liveness::Still }
    }

    /// Time of its last message by the present calendar: ms since 1970, UTC.
    pub(super) fn heard_ms(&self) -> u64 {
        self.heard_by(clock::since_boot(), clock::since_1970_ms())
    }

    /// Time of its last message. The arguments are the present time of both clocks.
    fn heard_by(&self, since_boot: Duration, now_ms: u64) -> u64 {
        let heard_ms = self.heard_since_boot_ms.load(Ordering::Relaxed);
        now_ms.saturating_sub(millis(since_boot).saturating_sub(heard_ms))
    }

    /// Action for the next ping.
    fn beat(&self) -> PulseAction {
        match self.unanswered.load(Ordering::Relaxed) {
            UNANSWERED_MAX => {
                self.unanswered.store(UNANSWERED_MAX + 1, Ordering::Relaxed);
                PulseAction::Tell
            }
            unanswered if unanswered > UNANSWERED_MAX => PulseAction::Nothing,
            unanswered => {
                self.unanswered.store(unanswered + 1, Ordering::Relaxed);
                PulseAction::Ask
            }
        }
    }
}

fn millis(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

/// Pings a runner while the run has onlookers, and marks the run as silent if the replies stop.
#[expect(clippy::infinite_loop, reason = "it is given up with the link")]
pub(super) async fn keep_asking(run: &Run, link: &Link, pulse: &RunnerPulse) -> Infallible {
    loop {
        run.audience().wait_for_onlooker().await;
        for _ in 0..ROUND {
            // First: times from the pulse are those of the present calendar.
            run.look_at_calendar();
            match pulse.beat() {
                PulseAction::Ask => link.ask(),
                PulseAction::Tell => run.mark_silent(pulse.heard_ms()),
                PulseAction::Nothing => {}
            }
            sleep(ASK_EVERY).await;
        }
    }
}

/// Viewers of the state of a run.
#[derive(Debug)]
pub(crate) struct Onlookers(Arc<watch::Sender<usize>>);

/// An onlooker of a run, counted until dropped.
#[derive(Debug)]
pub(crate) struct Onlooker(Arc<watch::Sender<usize>>);

impl Default for Onlookers {
    fn default() -> Self {
        Self(Arc::new(watch::Sender::new(0)))
    }
}

impl Onlookers {
    /// Adds an onlooker to the run.
    pub(crate) fn join(&self) -> Onlooker {
        self.0.send_modify(|count| *count += 1);
        Onlooker(Arc::clone(&self.0))
    }

    /// Waits for an onlooker.
    pub(super) async fn wait_for_onlooker(&self) {
        let mut count = self.0.subscribe();
        // The sender lives as long as this function.
        drop(count.wait_for(|count| *count > 0).await);
    }
}

impl Drop for Onlooker {
    fn drop(&mut self) {
        self.0.send_modify(|count| *count -= 1);
    }
}

#[cfg(test)]
mod tests {
    use super::{RunnerPulse, clock};
    use std::time::Duration;

    #[test]
    fn the_time_of_the_last_message_follows_a_calendar_that_is_set() {
        let heard_before = clock::since_boot();
        let pulse = RunnerPulse::new();
        let heard_after = clock::since_boot();
        let minute = Duration::from_mins(1);
        for today_ms in [1_000_000, 1_000_000 + 3_600_000, 500_000] {
            assert!(pulse.heard_by(heard_before + minute, today_ms) >= today_ms - 60_000);
            assert!(pulse.heard_by(heard_after + minute, today_ms) <= today_ms - 60_000);
        }
    }

    /// Checks the resulting actions: `?` is the time of a ping, `!` a message of the runner.
    fn check(happens: &str, expected: &[&str]) {
        let pulse = RunnerPulse::new();
        let comes = happens.chars().map(|it| match it {
            '?' => format!("{:?}", pulse.beat()),
            _ => format!("{:?}", pulse.note_heard()),
        });
        assert_eq!(comes.collect::<Vec<_>>(), expected);
    }

    #[test]
    fn a_runner_that_answers_is_asked_and_nobody_is_told() {
        check("?!?!?!", &["Ask", "Still", "Ask", "Still", "Ask", "Still"]);
    }

    #[test]
    fn one_that_has_not_answered_three_questions_is_silent_and_that_is_told_once() {
        check("????", &["Ask", "Ask", "Ask", "Tell"]);
        check("???!?", &["Ask", "Ask", "Ask", "Still", "Ask"]);
        check("??????", &["Ask", "Ask", "Ask", "Tell", "Nothing", "Nothing"]);
    }

    #[test]
    fn whatever_it_says_ends_its_silence_once() {
        check("????!!?", &["Ask", "Ask", "Ask", "Tell", "Again", "Still", "Ask"]);
        check("????!????", &["Ask", "Ask", "Ask", "Tell", "Again", "Ask", "Ask", "Ask", "Tell"]);
    }
}
