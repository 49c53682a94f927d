//! Whether a runner is there: while nothing changes it says nothing by itself, and one that hangs looks the same. So it is asked,
//! for as long as someone looks on.
//!
//! Knows questions and answers, and how many look on. Does not know what else a runner says, nor whom it matters to.

use super::link::Link;
use super::run::Run;
use rafcon_supervisor::clock;
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::sleep;

/// So often a runner is asked.
const ASK_EVERY: Duration = Duration::from_secs(1);
/// So many questions without an answer in between are silence. Counted, and not timed: a server that was stopped itself has asked
/// one only.
const UNANSWERED_MAX: u32 = 3;
/// So many questions are asked before it is looked whether someone looks on still: a page that is loaded again finds an answer.
const ROUND: u32 = 10;

/// What a runner has answered.
#[derive(Debug)]
pub(super) struct RunnerPulse {
    /// Questions since it was heard last.
    unanswered: AtomicU32,
    /// When that was.
    heard_ms: AtomicU64,
}

/// What is to be done about a runner.
#[derive(Debug, PartialEq, Eq)]
enum PulseAction {
    /// It is to be asked.
    Ask,
    /// It has fallen silent.
    Tell,
    /// It is silent, and has questions enough to answer.
    Nothing,
}

/// What a word of a runner means.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Liveness {
    /// It was there before.
    Still,
    /// It had fallen silent.
    Again,
}

impl RunnerPulse {
    /// Of a runner that was heard just now.
    pub(super) fn new() -> Self {
        let heard_ms = AtomicU64::new(clock::since_1970_ms());
        Self { unanswered: AtomicU32::new(0), heard_ms }
    }

    /// The runner says something.
    pub(super) fn note_heard(&self) -> Liveness {
        self.heard_ms.store(clock::since_1970_ms(), Ordering::Relaxed);
        let unanswered = self.unanswered.swap(0, Ordering::Relaxed);
        if unanswered > UNANSWERED_MAX { Liveness::Again } else { Liveness::Still }
    }

    /// When it was heard last: ms since 1970, UTC.
    pub(super) fn heard_ms(&self) -> u64 {
        self.heard_ms.load(Ordering::Relaxed)
    }

    /// It is time for the next question.
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

/// Asks a runner whether it is there while someone looks on, and tells the run when it does not answer.
#[expect(clippy::infinite_loop, reason = "it is given up with the link")]
pub(super) async fn keep_asking(run: &Run, link: &Link, pulse: &RunnerPulse) -> Infallible {
    loop {
        run.audience().wait_for_onlooker().await;
        for _ in 0..ROUND {
            match pulse.beat() {
                PulseAction::Ask => link.ask(),
                PulseAction::Tell => run.mark_silent(pulse.heard_ms()),
                PulseAction::Nothing => {}
            }
            run.look_at_calendar();
            sleep(ASK_EVERY).await;
        }
    }
}

/// Those who look at how a run stands.
#[derive(Debug)]
pub(crate) struct Onlookers(Arc<watch::Sender<usize>>);

/// One of them, until it is dropped.
#[derive(Debug)]
pub(crate) struct Onlooker(Arc<watch::Sender<usize>>);

impl Default for Onlookers {
    fn default() -> Self {
        Self(Arc::new(watch::Sender::new(0)))
    }
}

impl Onlookers {
    /// Someone looks on.
    pub(crate) fn join(&self) -> Onlooker {
        self.0.send_modify(|count| *count += 1);
        Onlooker(Arc::clone(&self.0))
    }

    /// Waits until someone looks on.
    pub(super) async fn wait_for_onlooker(&self) {
        let mut count = self.0.subscribe();
        // The sender lives as long as we do.
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
    use super::RunnerPulse;

    /// What comes of it: `?` is the time for a question, `!` a word of the runner.
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
