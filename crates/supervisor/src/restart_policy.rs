//! Whether a run whose runner died goes on by itself, and how. Pure.

use rafcon_protocol::{Crash, OnCrash, Resume};
use std::collections::VecDeque;
use std::time::Duration;

/// So many deaths in [`WINDOW`], and the run is left alone.
const DEATHS_MAX: usize = 5;
/// The time in which deaths are counted.
const WINDOW: Duration = Duration::from_mins(1);

/// What is known about a runner that ended in the middle of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunnerDeath {
    /// Signal or exit status.
    pub reason: String,
    /// Paths of the states that were active, as far as it told.
    pub active: Vec<String>,
    /// Its last lines on the error output.
    pub said: Vec<String>,
    /// The runner ended itself, because a script did not end in its grace period.
    pub is_cut_off: bool,
}

/// The deaths of a run's runners.
#[derive(Debug, Default)]
pub struct RestartPolicy {
    deaths: VecDeque<Duration>,
}

/// What follows a death.
#[derive(Debug, PartialEq, Eq)]
pub enum Next {
    /// Another runner takes the run up.
    Again(Resume, Crash),
    /// The user decides; why.
    Ask(&'static str),
}

impl RestartPolicy {
    /// A runner died at `now`; `policy` is what the run keeps about crashes.
    pub fn next(&mut self, now: Duration, death: &RunnerDeath, policy: OnCrash) -> Next {
        self.deaths.push_back(now);
        while self.deaths.front().is_some_and(|first| *first + WINDOW < now) {
            self.deaths.pop_front();
        }
        if self.deaths.len() > DEATHS_MAX {
            return Next::Ask("it died too often in the last minute");
        }
        // A script that was cut off because it ignored its grace period is aborted: that is what the period is for.
        let policy = if death.is_cut_off { OnCrash::Abort } else { policy };
        if policy == OnCrash::Ask {
            return Next::Ask("nothing moves until you decide");
        }
        let crash = Crash { reason: death.reason.clone(), active: death.active.clone() };
        Next::Again(Resume { policy, from: None }, crash)
    }
}

#[cfg(test)]
mod tests {
    use super::{Next, RestartPolicy, RunnerDeath};
    use expect_test::{Expect, expect};
    use rafcon_protocol::OnCrash;
    use std::time::Duration;

    fn check(policy: OnCrash, is_cut_off: bool, seconds: &[u64], expect: &Expect) {
        let reason = "killed by signal 9 (SIGKILL)".to_owned();
        let death =
            RunnerDeath { reason, active: vec!["R/A".to_owned()], said: Vec::new(), is_cut_off };
        let mut lives = RestartPolicy::default();
        let told = seconds.iter().map(|second| {
            match lives.next(Duration::from_secs(*second), &death, policy) {
                Next::Again(resume, crash) => {
                    format!("{second} s: {:?} {:?}\n", resume.policy, crash.active)
                }
                Next::Ask(why) => format!("{second} s: {why}\n"),
            }
        });
        expect.assert_eq(&told.collect::<String>());
    }

    #[test]
    fn the_policy_decides() {
        check(
            OnCrash::Ask,
            false,
            &[1],
            &expect![[r"
            1 s: nothing moves until you decide
        "]],
        );
        check(
            OnCrash::Restart,
            false,
            &[1],
            &expect![[r#"
            1 s: Restart ["R/A"]
        "#]],
        );
        check(
            OnCrash::Ask,
            true,
            &[1],
            &expect![[r#"
            1 s: Abort ["R/A"]
        "#]],
        );
    }

    #[test]
    fn a_run_that_dies_again_and_again_is_left_alone() {
        check(
            OnCrash::Abort,
            false,
            &[0, 1, 2, 3, 4, 5, 70],
            &expect![[r#"
            0 s: Abort ["R/A"]
            1 s: Abort ["R/A"]
            2 s: Abort ["R/A"]
            3 s: Abort ["R/A"]
            4 s: Abort ["R/A"]
            5 s: it died too often in the last minute
            70 s: Abort ["R/A"]
        "#]],
        );
    }
}
