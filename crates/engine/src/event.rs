//! What happened in a run.

use crate::{NodeId, PathId};
use rafcon_model::{DataType, Loss, OutcomeId, PortId};
use smol_str::SmolStr;
use std::num::NonZeroU64;
use std::sync::Arc;

/// One thing that happened. The list of all events is the history of the run, so an event is small: what is rare stands
/// in a box.
#[derive(Debug, Clone)]
pub enum Event<D> {
    /// A state began.
    Entered {
        /// Where it stands.
        path: PathId,
        /// Which state it is.
        node: NodeId,
        /// One value for each input port, in the node's order.
        inputs: Arc<[D]>,
        /// It is entered backwards: the entry that is undone, counted from 1 over all entries of the run.
        undoes: Option<NonZeroU64>,
    },
    /// A state ended. A state that is left backwards has the outcome that is undone, *preempted* if it had none yet, and
    /// gives nothing.
    Left {
        /// Where it stands.
        path: PathId,
        /// Which state it is.
        node: NodeId,
        /// How it ended.
        outcome: OutcomeId,
        /// One value for each output port, in the node's order.
        outputs: Arc<[D]>,
        /// Indices of the output ports that its script left out; `None` stands there in `outputs`, and flows nowhere.
        absent: Option<Box<[u32]>>,
        /// Its error, if it left one.
        error: Option<Box<D>>,
        /// It is left backwards: the entry that is undone.
        undoes: Option<NonZeroU64>,
    },
    /// A scoped variable got a value.
    Scoped {
        /// The container.
        path: PathId,
        /// The variable.
        port: PortId,
        /// Its new value.
        value: D,
    },
    /// A state cannot continue until the machine is changed or stopped.
    Waiting {
        /// The container that waits.
        path: PathId,
        /// For what.
        reason: WaitReason,
    },
    /// A branch is held until a command lets it continue.
    Held {
        /// The container that is held: a concurrency state, where one of its branches is; the root, where that has not
        /// begun or has ended.
        path: PathId,
        /// The state before which it is held, if there is one.
        next: Option<PathId>,
        /// By what.
        by: HeldBy,
    },
    /// A breakpoint was passed while its condition was true.
    Hit {
        /// The breakpoint.
        breakpoint: u64,
        /// Its state.
        path: PathId,
        /// How often by now.
        hits: u32,
        /// Whether it held anything.
        held: bool,
    },
    /// Someone chose the outcome of a state that waited or was held, or was skipped.
    Forced {
        /// The state.
        path: PathId,
        /// The outcome.
        outcome: OutcomeId,
    },
    /// A state is preempted because nobody on the ground was heard for too long.
    LossRecovery {
        /// The state.
        path: PathId,
        /// By which measure.
        loss: Loss,
    },
    /// A state was active when the run was begun again; it has no outcome. Parents come before children.
    Dropped {
        /// The state.
        path: PathId,
    },
    /// The run goes by the program of the last [`crate::Input::Change`] from now on. It may stand among other events: those
    /// before it are about the program of before, with its ports.
    Changed,
    /// A change waits until this state is left.
    ChangeWaits {
        /// The state.
        path: PathId,
    },
    /// Something the user should know.
    Note {
        /// The state it is about.
        path: PathId,
        /// How bad it is.
        level: Level,
        /// What it is.
        note: Box<Note>,
    },
    /// The run was paused (true) or resumed (false).
    Paused(bool),
    /// The run was asked to stop.
    Stopping,
    /// The run is over; the details are in [`crate::Finish`].
    Finished {
        /// The root's outcome.
        outcome: OutcomeId,
    },
}

/// Why a container waits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum WaitReason {
    /// An outcome of a child leads nowhere.
    NoTransition {
        /// The child.
        child: PathId,
        /// Its outcome.
        outcome: OutcomeId,
    },
    /// There is no start state.
    NoStart,
    /// A preemptive concurrency state has no children.
    NoChildren,
    /// A crash interrupted the script; a command must decide what becomes of it.
    Interrupted,
}

/// What holds a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum HeldBy {
    /// A pause.
    Pause,
    /// A step has come to its end.
    Step,
    /// The state that it was to run to.
    RunTo,
    /// A breakpoint.
    Breakpoint(u64),
    /// It is where the run, or its branch, begins.
    Start,
    /// Nobody on the ground was heard for too long.
    Loss(Loss),
}

/// How bad a [`Note`] is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Could be meant.
    Warning,
    /// Is not meant.
    Error,
}

/// Something the user should know about a state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Note {
    /// A value does not fit the port or scoped variable that it was put into; it was put there all the same.
    TypeMismatch {
        /// The port's name.
        port: SmolStr,
        /// What the port declares.
        expected: DataType,
        /// The name of the value's type.
        found: SmolStr,
    },
    /// A script returned something that is no outcome of its state; the state aborted.
    NoSuchOutcome {
        /// What it returned, as shown to people.
        returned: SmolStr,
    },
    /// A default names a global variable that does not exist; `None` is used.
    NoSuchGlobal {
        /// The name, without `$`.
        name: SmolStr,
    },
    /// A default could not be converted to its port's type.
    BadDefault {
        /// The port's name.
        port: SmolStr,
        /// Why.
        reason: SmolStr,
    },
    /// The library of a library state is missing; the state aborted.
    MissingLibrary {
        /// Why.
        reason: SmolStr,
    },
    /// The state's own file is damaged; the state aborted.
    DamagedState {
        /// The damage and its remedy.
        reason: SmolStr,
    },
    /// A start value names an input port that the root does not have; it is ignored.
    NoSuchInput {
        /// The name.
        name: SmolStr,
    },
    /// The condition of a breakpoint cannot be evaluated; it counts as true.
    BadCondition {
        /// The breakpoint.
        breakpoint: u64,
        /// Why.
        reason: SmolStr,
    },
}
