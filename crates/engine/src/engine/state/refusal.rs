//! Reasons why an input is refused.

use crate::FrameId;
use crate::program::UnknownPath;
use rafcon_model::{OutcomeId, StatePath};
use smol_str::SmolStr;
use std::fmt;
use thiserror::Error;

/// The status of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The run has not started.
    Idle,
    /// The run continues by itself.
    Running,
    /// Hierarchies are held before their next child.
    Paused,
    /// At least one branch goes step by step: it is held before each child until a command releases it.
    Stepping,
    /// The run was asked to stop, and its active states unwind.
    Stopping,
    /// The run is over.
    Finished,
}

/// A command without its arguments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Starts the run: [`crate::Input::Start`].
    Start,
    /// Pauses the run: [`crate::Input::Pause`].
    Pause,
    /// Resumes held branches: [`crate::Input::Resume`].
    Resume,
    /// Stops the run: [`crate::Input::Stop`].
    Stop,
    /// Begins step mode: [`crate::Input::StepMode`].
    StepMode,
    /// Makes one step: [`crate::Input::Step`].
    Step,
    /// Runs to a state: [`crate::Input::RunTo`].
    RunTo,
    /// Forces an outcome: [`crate::Input::Force`].
    Force,
    /// Preempts a state: [`crate::Input::Preempt`].
    Preempt,
    /// Sets a breakpoint: [`crate::Input::Break`].
    Break,
    /// Removes a breakpoint: [`crate::Input::Unbreak`].
    Unbreak,
    /// Reports connected viewers: [`crate::Input::Attended`].
    Attended,
    /// Reports the ground's silence: [`crate::Input::Silence`].
    Silence,
    /// Restores a moment: [`crate::Input::Restore`].
    Restore,
    /// Recovers interrupted scripts: [`crate::Input::Recover`].
    Recover,
    /// Changes the program: [`crate::Input::Change`].
    Change,
}

/// The reason why an input was refused. A refused input changes nothing.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Refusal {
    /// The engine failed at an earlier input.
    #[error(
        "the engine of this run failed inside RAFCON itself, and the run ends; please report it"
    )]
    Broken,
    /// The command is not legal in this status.
    #[error("cannot {command}: the run {status}; {}", way_out(*status))]
    NotNow {
        /// The command that was refused.
        command: Command,
        /// The current status of the run.
        status: Status,
    },
    /// The run keeps no undo log.
    #[error("this run keeps no history to step back in; start a run that keeps one")]
    NoHistory,
    /// The run is at its beginning, with no earlier step.
    #[error("'{path}' is held at its beginning, and nothing comes before; step forwards")]
    AtStart {
        /// The state that is held at its beginning.
        path: StatePath,
    },
    /// The data of the earlier steps was dropped.
    #[error(
        "cannot step back in '{path}': its data is lost, because it is too long ago, its states have changed since, or the run was resumed after it; start again at a moment of the history"
    )]
    TooFarBack {
        /// The state whose earlier steps were dropped.
        path: StatePath,
    },
    /// A script runs, and the command would end it without a result.
    #[error(
        "cannot {command}: the script of '{path}' runs; hold the run and wait for its end, or preempt it"
    )]
    StillRuns {
        /// The command that was refused.
        command: Command,
        /// The state whose script runs.
        path: StatePath,
    },
    /// The configuration to be restored does not fit the machine.
    #[error(
        "cannot restore the run there: '{path}' {problem}; choose another moment, or undo the change of the machine"
    )]
    CannotRestore {
        /// The state that does not fit.
        path: StatePath,
        /// A description of the misfit.
        problem: SmolStr,
    },
    /// A change of the machine would remove or alter an active state.
    #[error(
        "cannot change the machine now: '{path}' {touch}; let the change wait until the state has ended, or stop the run"
    )]
    Touches {
        /// The active state that the change affects.
        path: StatePath,
        /// The effect on that state.
        touch: ChangeEffect,
    },
    /// No interrupted script waits at the given place.
    #[error("no script that a crash interrupted waits {}", there(path.as_ref()))]
    NotInterrupted {
        /// The place in the command; `None` for the whole run.
        path: Option<StatePath>,
    },
    /// A condition is being evaluated, and its result would come too late.
    #[error("cannot {command}: condition {check} is being evaluated; wait for its answer")]
    StillChecks {
        /// The command that was refused.
        command: Command,
        /// The number of the check.
        check: u64,
    },
    /// No state has this path.
    #[error(transparent)]
    UnknownPath(#[from] UnknownPath),
    /// A value was given for a port that the start does not reach.
    #[error(
        "cannot start with a value for '{name}' of '{path}': values are for input ports and scoped variables of the state that is begun at, and of those around it"
    )]
    NoPlaceFor {
        /// The state in the start value's path.
        path: StatePath,
        /// The name of the port or scoped variable.
        name: SmolStr,
    },
    /// No branch is held that a step could release.
    #[error("nothing is held {}; wait until a branch comes to its next state", on(branch.as_ref()))]
    NothingHeld {
        /// The branch in the command; `None` for all branches.
        branch: Option<StatePath>,
    },
    /// A path does not name an active branch.
    #[error(
        "'{path}' is not an active branch; a branch is named by an active child of a concurrency state"
    )]
    NoSuchBranch {
        /// The path in the command.
        path: StatePath,
    },
    /// A state has no such outcome.
    #[error("'{path}' has no outcome {}; choose one of its outcomes", outcome.0)]
    NoSuchOutcome {
        /// The state in the command.
        path: StatePath,
        /// The outcome in the command.
        outcome: OutcomeId,
    },
    /// The state continues by itself, so its outcome cannot be forced.
    #[error("cannot force an outcome of '{path}': {reason}")]
    CannotForce {
        /// The state in the command.
        path: StatePath,
        /// The state's current activity, and the remedy.
        reason: &'static str,
    },
    /// The state is not active.
    #[error("'{path}' is not active; the snapshot lists what is")]
    NotActive {
        /// The state in the command.
        path: StatePath,
    },
    /// No breakpoint has this id.
    #[error("there is no breakpoint {id}; the snapshot lists all breakpoints")]
    NoSuchBreakpoint {
        /// The id in the command.
        id: u64,
    },
    /// The result belongs to a condition that is not being evaluated.
    #[error(
        "condition {check} is not being evaluated; its answer is given once, with the number of its check"
    )]
    NoSuchCheck {
        /// The check in the result.
        check: u64,
    },
    /// The result of a script belongs to no script that runs.
    #[error("frame {}.{} runs no script; a result is given once, with the frame of its job", frame.slot, frame.generation)]
    NoSuchFrame {
        /// The frame in the result.
        frame: FrameId,
    },
}

fn there(path: Option<&StatePath>) -> String {
    path.map_or_else(
        || "in this run".into(),
        |path| format!("at '{path}'; the snapshot names those that do"),
    )
}

fn on(branch: Option<&StatePath>) -> String {
    branch.map_or_else(|| "in this run".into(), |path| format!("on the branch '{path}'"))
}

fn way_out(status: Status) -> &'static str {
    match status {
        Status::Idle => "start it first",
        Status::Running => "it can be paused, stepped from its next states on, or stopped",
        Status::Paused => "it can be resumed, stepped or stopped",
        Status::Stepping => "it can be resumed, stepped, paused or stopped",
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
            Self::Stepping => "goes step by step",
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
            Self::StepMode => "begin to step",
            Self::Step => "step",
            Self::RunTo => "run to a state",
            Self::Force => "force an outcome",
            Self::Preempt => "preempt a state",
            Self::Break => "set a breakpoint",
            Self::Unbreak => "remove a breakpoint",
            Self::Attended => "note whether a viewer is connected",
            Self::Silence => "note how long the ground is silent",
            Self::Restore => "restore the run",
            Self::Recover => "recover",
            Self::Change => "change the machine",
        })
    }
}

/// Effect of a change on an active state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChangeEffect {
    /// The state would be removed.
    Removed,
    /// The state would be of another kind.
    Kind,
    /// The state would have other ports.
    Ports,
    /// The state would have other outcomes.
    Outcomes,
    /// The state would have other branches.
    Branches,
    /// The state has just ended, and it or the outcome by which it ended would be removed.
    Ended,
}

impl fmt::Display for ChangeEffect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Removed => "is active and would be gone",
            Self::Kind => "is active and would be of another kind",
            Self::Ports => "is active and would have other ports",
            Self::Outcomes => "is active and would have other outcomes",
            Self::Branches => "is active and would have other branches",
            Self::Ended => "has just ended and would be gone, or its outcome would",
        })
    }
}
