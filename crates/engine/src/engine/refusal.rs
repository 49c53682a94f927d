//! Why an input was not taken.

use crate::FrameId;
use crate::program::UnknownPath;
use rafcon_model::StatePath;
use smol_str::SmolStr;
use std::fmt;
use thiserror::Error;

/// Where a run stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Not started.
    Idle,
    /// Running.
    Running,
    /// Hierarchies are held before their next child.
    Paused,
    /// Asked to stop; what is active unwinds.
    Stopping,
    /// Over.
    Finished,
}

/// A command without what it carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// [`crate::Input::Start`]
    Start,
    /// [`crate::Input::Pause`]
    Pause,
    /// [`crate::Input::Resume`]
    Resume,
    /// [`crate::Input::Stop`]
    Stop,
    /// [`crate::Input::Restore`]
    Restore,
    /// [`crate::Input::Change`]
    Change,
}

/// An input that changed nothing.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Refusal {
    /// The command means nothing in this status.
    #[error("cannot {command}: the run {status}; {}", way_out(*status))]
    NotNow {
        /// What was asked for.
        command: Command,
        /// Where the run stands.
        status: Status,
    },
    /// This engine cannot do that yet.
    #[error("this engine does not know the command yet; it knows start, pause, resume and stop")]
    NotYet,
    /// A script runs, and the command would end it without a result.
    #[error(
        "cannot {command}: the script of '{path}' runs; hold the run and wait for its end, or preempt it"
    )]
    StillRuns {
        /// What was asked for.
        command: Command,
        /// Where the script runs.
        path: StatePath,
    },
    /// What is to be restored does not fit the machine.
    #[error(
        "cannot take the run up there: '{path}' {problem}; choose another moment, or take the change of the machine back"
    )]
    CannotRestore {
        /// The state that does not fit.
        path: StatePath,
        /// Why.
        problem: SmolStr,
    },
    /// No interrupted script waits there.
    #[error("no script that a crash interrupted waits {}", there(path.as_ref()))]
    NotInterrupted {
        /// Where; anywhere if there is none.
        path: Option<StatePath>,
    },
    /// The state to start from does not exist.
    #[error(transparent)]
    StartFrom(#[from] UnknownPath),
    /// The result of a script belongs to no script that runs.
    #[error("frame {}.{} runs no script; a result is given once, with the frame of its job", frame.slot, frame.generation)]
    NoSuchFrame {
        /// The frame that was named.
        frame: FrameId,
    },
}

fn there(path: Option<&StatePath>) -> String {
    path.map_or_else(
        || "in this run".into(),
        |path| format!("at '{path}'; the snapshot names those that do"),
    )
}

fn way_out(status: Status) -> &'static str {
    match status {
        Status::Idle => "start it first",
        Status::Running => "it can be paused or stopped",
        Status::Paused => "it can be resumed or stopped",
        Status::Stopping => "it ends when its scripts do; stop again to run no more handlers",
        Status::Finished => "begin a new run",
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Idle => "has not started",
            Self::Running => "is running",
            Self::Paused => "is paused",
            Self::Stopping => "is stopping",
            Self::Finished => "has finished",
        })
    }
}

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::Pause => "pause",
            Self::Resume => "resume",
            Self::Stop => "stop",
            Self::Restore => "take the run up elsewhere",
            Self::Change => "change the machine",
        })
    }
}
