//! Decides whether a run whose runner died is resumed, and how, over its successive runners. Pure; shared by command line and server.

use crate::KeptRun;
use rafcon_protocol::{Crash, Launch, OnCrash, Resume};
use std::collections::VecDeque;
use std::time::Duration;

/// After more deaths than this in [`WINDOW`], the run is no longer resumed.
const DEATHS_MAX: usize = 5;
/// The time in which deaths are counted.
const WINDOW: Duration = Duration::from_mins(1);

/// Facts about a runner that died in the middle of a run.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RunnerDeath {
    /// Signal or exit status.
    pub reason: String,
    /// Paths of the states that were active, if known.
    pub active: Vec<String>,
    /// Last lines of its error output.
    pub said: Vec<String>,
    /// True if the runner ended itself because a script did not end in its grace period.
    pub is_cut_off: bool,
    /// True if the end was intended: a user killed the runner, or it did not react to a stop.
    pub is_wanted: bool,
}

/// The recent deaths of a run's runners.
#[derive(Debug, Default)]
pub struct RestartPolicy {
    deaths: VecDeque<Duration>,
}

/// The decision after a death.
#[derive(Debug, PartialEq)]
pub enum Next {
    /// Start another runner with this launch.
    Again(Box<Launch>),
    /// Leave the decision to the user, for this reason.
    Ask(&'static str),
}

impl RestartPolicy {
    /// Decides after the death at `now` of a runner that was started with `launch`. `kept` has the stored facts about the run. A run that
    /// has not begun is started again.
    pub fn next(
        &mut self,
        now: Duration,
        death: &RunnerDeath,
        kept: KeptRun,
        launch: Launch,
    ) -> Next {
        if death.is_wanted {
            return Next::Ask("a user ended it");
        }
        self.deaths.push_back(now);
        while self.deaths.front().is_some_and(|first| *first + WINDOW < now) {
            self.deaths.pop_front();
        }
        if self.deaths.len() > DEATHS_MAX {
            return Next::Ask("the runner died too often in the last minute");
        }
        // A script that ignored its grace period is aborted, because that is the purpose of the period.
        let policy = if death.is_cut_off { OnCrash::Abort } else { kept.policy };
        if policy == OnCrash::Ask {
            return Next::Ask("the run waits until you decide");
        }
        if !kept.has_begun {
            return Next::Again(Box::new(launch));
        }
        let crash = Crash { reason: death.reason.clone(), active: death.active.clone() };
        let resume = Resume { policy, from: None };
        Next::Again(Box::new(Launch { resume: Some(resume), crash: Some(crash), ..launch }))
    }
}

#[cfg(test)]
mod tests {
    use super::{Next, RestartPolicy, RunnerDeath};
    use crate::KeptRun;
    use expect_test::{Expect, expect};
    use rafcon_protocol::{Launch, OnCrash};
    use std::time::Duration;

    fn death() -> RunnerDeath {
        RunnerDeath {
            reason: "killed by signal 9 (SIGKILL)".to_owned(),
            active: vec!["R/A".to_owned()],
            ..RunnerDeath::default()
        }
    }

    fn check(policy: OnCrash, death: &RunnerDeath, seconds: &[u64], expect: &Expect) {
        check_kept(KeptRun { policy, has_begun: true }, death, seconds, expect);
    }

    fn check_kept(kept: KeptRun, death: &RunnerDeath, seconds: &[u64], expect: &Expect) {
        let mut lives = RestartPolicy::default();
        let told = seconds.iter().map(|second| {
            match lives.next(Duration::from_secs(*second), death, kept, Launch::default()) {
                Next::Again(launch) => {
                    let Launch { resume, crash, .. } = *launch;
                    let (policy, active) = (resume.map(|it| it.policy), crash.map(|it| it.active));
                    format!("{second} s: {policy:?} {active:?}\n")
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
            &death(),
            &[1],
            &expect![[r"
            1 s: the run waits until you decide
        "]],
        );
        check(
            OnCrash::Restart,
            &death(),
            &[1],
            &expect![[r#"
            1 s: Some(Restart) Some(["R/A"])
        "#]],
        );
        check(
            OnCrash::Ask,
            &RunnerDeath { is_cut_off: true, ..death() },
            &[1],
            &expect![[r#"
            1 s: Some(Abort) Some(["R/A"])
        "#]],
        );
    }

    #[test]
    fn a_run_that_has_not_begun_is_begun_again() {
        check_kept(
            KeptRun { policy: OnCrash::Abort, has_begun: false },
            &death(),
            &[1],
            &expect![[r"
            1 s: None None
        "]],
        );
    }

    #[test]
    fn a_run_that_was_to_end_is_left_alone() {
        check(
            OnCrash::Restart,
            &RunnerDeath { is_wanted: true, ..death() },
            &[1],
            &expect![[r"
            1 s: a user ended it
        "]],
        );
    }

    #[test]
    fn a_run_that_dies_again_and_again_is_left_alone() {
        check(
            OnCrash::Abort,
            &death(),
            &[0, 1, 2, 3, 4, 5, 70],
            &expect![[r#"
            0 s: Some(Abort) Some(["R/A"])
            1 s: Some(Abort) Some(["R/A"])
            2 s: Some(Abort) Some(["R/A"])
            3 s: Some(Abort) Some(["R/A"])
            4 s: Some(Abort) Some(["R/A"])
            5 s: the runner died too often in the last minute
            70 s: Some(Abort) Some(["R/A"])
        "#]],
        );
    }
}
