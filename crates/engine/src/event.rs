//! Events: the history of a run.

use crate::{NodeId, PathId};
use rafcon_model::{DataType, Loss, OutcomeId, PortId};
use smol_str::SmolStr;
use std::num::NonZeroU64;
use std::sync::Arc;

/// One event of a run. The list of all events is the history of the run, so an event is small: rare data is boxed.
#[derive(Debug, Clone)]
pub enum Event<D> {
    /// A state was entered.
    Entered {
        /// Place of the state.
        path: PathId,
        /// The node of the state.
        node: NodeId,
        /// One value for each input port, in the node's order.
        inputs: Arc<[D]>,
        /// The number of the undone entry among all entries of the run, counted from 1. Set if the state is entered
        /// backwards.
        undoes: Option<NonZeroU64>,
    },
    /// A state was left. A state that is left backwards has the undone outcome, or *preempted* if it had none yet, and
    /// no outputs.
    Left {
        /// Place of the state.
        path: PathId,
        /// The node of the state.
        node: NodeId,
        /// Outcome by which it ended.
        outcome: OutcomeId,
        /// One value for each output port, in the node's order.
        outputs: Arc<[D]>,
        /// Indices of the output ports that the script left out. `outputs` contains `None` for them, which flows
        /// nowhere.
        absent: Option<Box<[u32]>>,
        /// Error with which the state ended, if any.
        error: Option<Box<D>>,
        /// The number of the undone entry, if the state is left backwards.
        undoes: Option<NonZeroU64>,
    },
    /// A scoped variable received a value.
    Scoped {
        /// Place of the container.
        path: PathId,
        /// Port of the variable.
        port: PortId,
        /// Value after the assignment.
        value: D,
    },
    /// A state cannot continue until the machine is changed or stopped.
    Waiting {
        /// The container that waits.
        path: PathId,
        /// The reason for the wait.
        reason: WaitReason,
    },
    /// A branch is held until a command releases it.
    Held {
        /// The held container. For a branch, its concurrency state; for a root that has not begun or has ended, the
        /// root.
        path: PathId,
        /// The state before which the branch is held, if it is known.
        next: Option<PathId>,
        /// The cause of the hold.
        by: HeldBy,
    },
    /// A breakpoint was hit: it was passed while its condition was true.
    Hit {
        /// Id of the breakpoint.
        breakpoint: u64,
        /// Place of the breakpoint's state.
        path: PathId,
        /// Number of hits, including this one.
        hits: u32,
        /// True if the breakpoint holds its branch or the run.
        held: bool,
    },
    /// A command chose the outcome of a waiting or held state, or of a skipped one.
    Forced {
        /// Place of the state.
        path: PathId,
        /// The outcome that was chosen.
        outcome: OutcomeId,
    },
    /// A state is preempted because the ground was silent for too long.
    LossRecovery {
        /// Place of the state.
        path: PathId,
        /// The measure of silence.
        loss: Loss,
    },
    /// A state was active when the run was started again. It has no outcome. Parents come before children.
    Dropped {
        /// Place of the state.
        path: PathId,
    },
    /// The program of the last [`crate::Input::Change`] applies from now on. Events before this one, also in the
    /// current call, refer to the earlier program and its ports.
    Changed,
    /// A change waits until the end of this state.
    ChangeWaits {
        /// Place of the state.
        path: PathId,
    },
    /// A note about a state, for the user.
    Note {
        /// Place of the state.
        path: PathId,
        /// Severity of the note.
        level: Level,
        /// Content of the note.
        note: Box<Note>,
    },
    /// The run was paused (true) or resumed (false).
    Paused(bool),
    /// The run was asked to stop.
    Stopping,
    /// The run is over; the details are in [`crate::Finish`].
    Finished {
        /// Outcome of the root.
        outcome: OutcomeId,
    },
}

/// The reason why a state waits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum WaitReason {
    /// An outcome of a child leads nowhere.
    NoTransition {
        /// Place of the child.
        child: PathId,
        /// Outcome of the child.
        outcome: OutcomeId,
    },
    /// The hierarchy has no start state.
    NoStart,
    /// A preemptive concurrency state has no children.
    NoChildren,
    /// A crash interrupted the script, and a command must choose its recovery.
    Interrupted,
}

/// The cause of a hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum HeldBy {
    /// A pause of the run.
    Pause,
    /// The end of a step.
    Step,
    /// The state that the run continued to.
    RunTo,
    /// The breakpoint with this id.
    Breakpoint(u64),
    /// The beginning of the run or of a branch.
    Start,
    /// A lost-link policy of a state.
    Loss(Loss),
}

/// The severity of a [`Note`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// The cause may be intended.
    Warning,
    /// The cause is not intended.
    Error,
}

/// A message for the user about a state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Note {
    /// A value does not fit the type of its port or scoped variable. It was stored nevertheless.
    TypeMismatch {
        /// Name of the port.
        port: SmolStr,
        /// Type that the port declares.
        expected: DataType,
        /// The name of the value's type.
        found: SmolStr,
    },
    /// A script returned a value that is no outcome of its state. The state aborted.
    NoSuchOutcome {
        /// The returned value, as text.
        returned: SmolStr,
    },
    /// A default names a global variable that does not exist. `None` is used.
    NoSuchGlobal {
        /// The name, without `$`.
        name: SmolStr,
    },
    /// A default could not be converted to its port's type.
    BadDefault {
        /// Name of the port.
        port: SmolStr,
        /// Reason of the failed conversion.
        reason: SmolStr,
    },
    /// The library of a library state is missing. The state aborted.
    MissingLibrary {
        /// The cause and its remedy.
        reason: SmolStr,
    },
    /// The state's own file is damaged. The state aborted.
    DamagedState {
        /// The damage and its remedy.
        reason: SmolStr,
    },
    /// A start value names an input port that the root does not have. The value is ignored.
    NoSuchInput {
        /// Name in the start value.
        name: SmolStr,
    },
    /// The condition of a breakpoint cannot be evaluated. It counts as true.
    BadCondition {
        /// Id of the breakpoint.
        breakpoint: u64,
        /// Reason of the failed evaluation.
        reason: SmolStr,
    },
}
