//! Ends of a run, and the exit code of the program for each.

use rafcon_protocol::Outcome;
use rafcon_supervisor::RunnerDeath;

/// Reason for the end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum End {
    /// The machine ended by itself, or after a stop.
    Finished {
        outcome: Outcome,
        /// True if `--timeout` stopped it.
        timed_out: bool,
    },
    /// The machine could only wait, and was stopped because nobody watched.
    OnlyWaited {
        /// The event that it waited for.
        awaited: String,
    },
    /// The machine could not be loaded, or the run refused the viewer.
    LoadFailed {
        /// Problem, location and remedy.
        reason: String,
    },
    /// The interpreter ended before it became a runner.
    NotStarted {
        /// Exit status, or a problem with the interpreter.
        reason: String,
        /// Its last lines on the error output.
        said: Vec<String>,
    },
    /// This program killed it: the user requested it twice, or it continued after its time limit.
    Killed {
        /// True if `--timeout` was the reason.
        timed_out: bool,
        /// True if a state may have run. No recovery ran then.
        has_begun: bool,
        /// Paths of the states that were active.
        active: Vec<String>,
    },
    /// The runner ended in the middle of the run.
    Died(RunnerDeath),
    /// We left; the run continues.
    Left,
}

impl End {
    /// The active states at the time when the run was cut off.
    pub(crate) fn active(&self) -> Option<&[String]> {
        match self {
            Self::Killed { active, .. } | Self::Died(RunnerDeath { active, .. }) => Some(active),
            Self::Finished { .. }
            | Self::OnlyWaited { .. }
            | Self::LoadFailed { .. }
            | Self::NotStarted { .. }
            | Self::Left => None,
        }
    }

    /// Exit code of the program, as in `rafcon run --help`.
    pub(crate) fn code(&self) -> u8 {
        match self {
            Self::Killed { has_begun: true, .. } => 8,
            Self::Finished { timed_out: true, .. } | Self::Killed { timed_out: true, .. } => 6,
            Self::Finished { outcome, timed_out: false } => match outcome.id {
                0 => 0,
                -1 => 4,
                -2 => 5,
                _ => 3,
            },
            Self::OnlyWaited { .. } | Self::LoadFailed { .. } | Self::NotStarted { .. } => 1,
            Self::Killed { timed_out: false, .. } => 5,
            Self::Died(_) => 7,
            Self::Left => 0,
        }
    }
}
