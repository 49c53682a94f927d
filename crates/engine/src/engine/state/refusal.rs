//! Why an input was not taken.

use crate::FrameId;
use crate::program::UnknownPath;
use rafcon_model::{OutcomeId, StatePath};
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
    /// The same, on one branch at least, and each command to step lets them do one.
    Stepping,
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
    /// [`crate::Input::StepMode`]
    StepMode,
    /// [`crate::Input::Step`]
    Step,
    /// [`crate::Input::RunTo`]
    RunTo,
    /// [`crate::Input::Force`]
    Force,
    /// [`crate::Input::Preempt`]
    Preempt,
    /// [`crate::Input::Break`]
    Break,
    /// [`crate::Input::Unbreak`]
    Unbreak,
    /// [`crate::Input::Attended`]
    Attended,
    /// [`crate::Input::Silence`]
    Silence,
    /// [`crate::Input::Restore`]
    Restore,
    /// [`crate::Input::Recover`]
    Recover,
    /// [`crate::Input::Change`]
    Change,
}

/// An input that changed nothing.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Refusal {
    /// The engine failed at an earlier input.
    #[error(
        "the engine of this run failed inside RAFCON itself, and the run ends; please report it"
    )]
    Broken,
    /// The command means nothing in this status.
    #[error("cannot {command}: the run {status}; {}", way_out(*status))]
    NotNow {
        /// What was asked for.
        command: Command,
        /// Where the run stands.
        status: Status,
    },
    /// The run keeps nothing to step back.
    #[error("this run keeps no history to step back in; start a run that keeps one")]
    NoHistory,
    /// There is nothing before.
    #[error("'{path}' is held at its beginning, and nothing comes before; step forwards")]
    AtStart {
        /// What is held.
        path: StatePath,
    },
    /// The data of the steps before was dropped.
    #[error(
        "cannot step back in '{path}': its data is lost, because it is too long ago, its states have changed since, or the run was resumed after it; start again at a moment of the history"
    )]
    TooFarBack {
        /// Where.
        path: StatePath,
    },
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
        "cannot restore the run there: '{path}' {problem}; choose another moment, or undo the change of the machine"
    )]
    CannotRestore {
        /// The state that does not fit.
        path: StatePath,
        /// Why.
        problem: SmolStr,
    },
    /// A change of the machine would remove or alter an active state.
    #[error(
        "cannot change the machine now: '{path}' {touch}; let the change wait until the state has ended, or stop the run"
    )]
    Touches {
        /// The state.
        path: StatePath,
        /// What would become of it.
        touch: ChangeEffect,
    },
    /// No interrupted script waits there.
    #[error("no script that a crash interrupted waits {}", there(path.as_ref()))]
    NotInterrupted {
        /// Where; anywhere if there is none.
        path: Option<StatePath>,
    },
    /// A condition is being evaluated, and the answer would come too late.
    #[error("cannot {command}: condition {check} is being evaluated; wait for its answer")]
    StillChecks {
        /// What was asked for.
        command: Command,
        /// The number of the check.
        check: u64,
    },
    /// There is no such state.
    #[error(transparent)]
    UnknownPath(#[from] UnknownPath),
    /// A value was given for a port that the start does not reach.
    #[error(
        "cannot start with a value for '{name}' of '{path}': values are for input ports and scoped variables of the state that is begun at, and of those around it"
    )]
    NoPlaceFor {
        /// The state.
        path: StatePath,
        /// The name of the port or scoped variable.
        name: SmolStr,
    },
    /// Nothing is held that a step could let continue.
    #[error("nothing is held {}; wait until a branch comes to its next state", on(branch.as_ref()))]
    NothingHeld {
        /// The branch; all of them if there is none.
        branch: Option<StatePath>,
    },
    /// A path does not name an active branch.
    #[error(
        "'{path}' is not an active branch; a branch is named by an active child of a concurrency state"
    )]
    NoSuchBranch {
        /// What was named.
        path: StatePath,
    },
    /// A state has no such outcome.
    #[error("'{path}' has no outcome {}; choose one of its outcomes", outcome.0)]
    NoSuchOutcome {
        /// The state.
        path: StatePath,
        /// What was chosen.
        outcome: OutcomeId,
    },
    /// A state continues by itself.
    #[error("cannot force an outcome of '{path}': {reason}")]
    CannotForce {
        /// The state.
        path: StatePath,
        /// What it does, and the way out.
        reason: &'static str,
    },
    /// A state is not active.
    #[error("'{path}' is not active; the snapshot lists what is")]
    NotActive {
        /// The state.
        path: StatePath,
    },
    /// There is no breakpoint with this id.
    #[error("there is no breakpoint {id}; the snapshot lists all breakpoints")]
    NoSuchBreakpoint {
        /// The id.
        id: u64,
    },
    /// An answer to a condition that is not being evaluated.
    #[error(
        "condition {check} is not being evaluated; its answer is given once, with the number of its check"
    )]
    NoSuchCheck {
        /// The number.
        check: u64,
    },
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

/// What a change would do to an active state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChangeEffect {
    /// It would be removed.
    Removed,
    /// It would be of another kind.
    Kind,
    /// It would have other ports.
    Ports,
    /// It would have other outcomes.
    Outcomes,
    /// It would have other branches.
    Branches,
    /// It has just ended, and the outcome by which it did would be gone.
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
