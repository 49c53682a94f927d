//! How a run can end, and what the program's exit code says about it.

use rafcon_protocol::Outcome;
use rafcon_supervisor::RunnerDeath;

/// Why there is nothing more to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum End {
    /// The machine came to its end.
    Finished {
        /// The root's outcome.
        outcome: Outcome,
        /// Whether `--timeout` made it stop.
        timed_out: bool,
    },
    /// The machine could only wait, and was stopped because nobody watched.
    OnlyWaited {
        /// For what it waited.
        awaited: String,
    },
    /// The machine could not be loaded, or the run lets no one in.
    LoadFailed {
        /// What, where, and the way out.
        reason: String,
    },
    /// The interpreter ended before it was a runner.
    NotStarted {
        /// How it ended, or what is wrong with it.
        reason: String,
        /// Its last lines on the error output.
        said: Vec<String>,
    },
    /// We killed it: the user asked twice, or it continued after its time was over.
    Killed {
        /// Whether `--timeout` was the reason.
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
    /// The states that were active when the run was cut off.
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

    /// The program's exit code, as `rafcon run --help` lists them.
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
