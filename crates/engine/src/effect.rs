//! What the engine wants done.

use crate::{BranchId, Event, FrameId, NodeId, PathId};
use rafcon_model::{OutcomeId, StateId};
use smol_str::SmolStr;
use std::sync::Arc;

/// Work for the driver of the engine, to be done in order.
#[derive(Debug, Clone)]
pub enum Effect<D> {
    /// A branch begins; its first job follows. Branch 0 is there from the start and ends with [`Effect::Finish`].
    Fork {
        /// The new branch. Its number may be that of a branch that ended in an earlier answer.
        branch: BranchId,
    },
    /// Run a script on its branch and answer with [`crate::Input::Finished`].
    Run(Job<D>),
    /// Evaluate a condition on its branch and answer with [`crate::Input::Checked`].
    Check(Check<D>),
    /// The active state at this place (and the script that it runs) is asked to end. Each active state is named once,
    /// parents before children; states that begin later are not meant.
    Preempt(PathId),
    /// All states see `paused` (true) or unpaused (false).
    Paused(bool),
    /// A branch has nothing more to do.
    EndBranch {
        /// The branch.
        branch: BranchId,
    },
    /// The run is over.
    Finish(Finish<D>),
}

/// One script to run.
#[derive(Debug, Clone)]
pub struct Job<D> {
    /// To be named in the answer.
    pub frame: FrameId,
    /// The line of execution that runs it.
    pub branch: BranchId,
    /// Where the state stands.
    pub path: PathId,
    /// Which state it is.
    pub node: NodeId,
    /// One value for each input port of the node, in its order.
    pub inputs: Arc<[D]>,
    /// The default of each output port of the node, in its order.
    pub outputs: Arc<[D]>,
    /// The error of the state before, for the entry `error` of the inputs.
    pub error: Option<D>,
    /// Whether the state was asked to end before its script began.
    pub preempted: bool,
    /// For a decider: how the branches of its barrier ended.
    pub verdicts: Option<Arc<Verdicts<D>>>,
    /// Whether `backward_execute` is to run instead of `execute`; its outcome and outputs do not count. A script without
    /// one is finished at once.
    pub backward: bool,
}

/// A condition to evaluate.
#[derive(Debug, Clone)]
pub struct Check<D> {
    /// To be named in the answer.
    pub check: u64,
    /// The line of execution that came to it.
    pub branch: BranchId,
    /// The state of the breakpoint.
    pub path: PathId,
    /// Which state it is.
    pub node: NodeId,
    /// The text.
    pub condition: SmolStr,
    /// One value for each input port of the node: those that it would get, or got.
    pub inputs: Arc<[D]>,
    /// After exit: one value for each output port, and the outcome.
    pub left: Option<(Arc<[D]>, OutcomeId)>,
    /// The scoped variables of the container around the state, by name.
    pub scoped_variables: Vec<(SmolStr, D)>,
}

/// How the branches of a barrier ended, in the order of the children.
#[derive(Debug, Clone)]
pub struct Verdicts<D> {
    /// One for each child that ended.
    pub children: Vec<Verdict<D>>,
}

/// How one branch of a barrier ended.
#[derive(Debug, Clone)]
pub struct Verdict<D> {
    /// The child.
    pub state: StateId,
    /// Its name.
    pub name: SmolStr,
    /// Its outcome.
    pub outcome: OutcomeId,
    /// The name of its outcome.
    pub outcome_name: SmolStr,
    /// Its error, if it left one.
    pub error: Option<D>,
}

/// How a run ended.
#[derive(Debug, Clone)]
pub struct Finish<D> {
    /// Id of the root's outcome.
    pub outcome: OutcomeId,
    /// Name of the root's outcome.
    pub outcome_name: SmolStr,
    /// The root's outputs by name, with `error` if there is one.
    pub outputs: Vec<(SmolStr, D)>,
    /// The root's scoped variables at the end, by name.
    pub scoped_variables: Vec<(SmolStr, D)>,
    /// How many states were run; library states themselves are not counted, the roots of their content are.
    pub states_run: u64,
}

/// Where the engine puts its answers. Kept between calls, so that steady work allocates nothing.
#[derive(Debug, Clone)]
pub struct Outbox<D> {
    /// What to do, in order.
    pub effects: Vec<Effect<D>>,
    /// What happened, in order.
    pub events: Vec<Event<D>>,
}

impl<D> Default for Outbox<D> {
    fn default() -> Self {
        Self { effects: Vec::new(), events: Vec::new() }
    }
}
