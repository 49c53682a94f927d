//! Effects: the work that the engine requests.

use crate::{BranchId, Event, FrameId, NodeId, PathId};
use rafcon_model::{OutcomeId, StateId};
use smol_str::SmolStr;
use std::sync::Arc;

/// Work for the driver of the engine, to be done in order.
#[derive(Debug, Clone)]
pub enum Effect<D> {
    /// A branch begins; its first job follows. Branch 0 exists from the start and ends with [`Effect::Finish`].
    Fork {
        /// The new branch. Its number may be that of a branch that ended in an earlier call.
        branch: BranchId,
    },
    /// Run a script on its branch and reply with [`crate::Input::Finished`].
    Run(Job<D>),
    /// Evaluate a condition on its branch and reply with [`crate::Input::Checked`].
    Check(Check<D>),
    /// Ask the active state at this place, and the script that it runs, to end. Each active state is named once,
    /// parents before children. States that begin later are not affected.
    Preempt(PathId),
    /// Set the `paused` flag that all states see.
    Paused(bool),
    /// A branch has no more work.
    EndBranch {
        /// The branch that ends.
        branch: BranchId,
    },
    /// The run is over.
    Finish(Finish<D>),
}

/// One script to run.
#[derive(Debug, Clone)]
pub struct Job<D> {
    /// Frame of the script, to be returned in [`crate::Input::Finished`].
    pub frame: FrameId,
    /// The branch that runs the script.
    pub branch: BranchId,
    /// Place of the state.
    pub path: PathId,
    /// The state whose script runs.
    pub node: NodeId,
    /// One value for each input port of the node, in its order.
    pub inputs: Arc<[D]>,
    /// The default of each output port of the node, in its order.
    pub outputs: Arc<[D]>,
    /// The error of the previous state, for the entry `error` of the inputs.
    pub error: Option<D>,
    /// True if the state was asked to end before its script began.
    pub preempted: bool,
    /// The ends of the barrier's branches, if the state is a decider.
    pub verdicts: Option<Arc<Verdicts<D>>>,
    /// True to run `backward_execute` instead of `execute`; its outcome and outputs are ignored. A script without one
    /// finishes at once.
    pub backward: bool,
}

/// A condition to evaluate.
#[derive(Debug, Clone)]
pub struct Check<D> {
    /// Number of the check, to be returned in [`crate::Input::Checked`].
    pub check: u64,
    /// The branch that reached the breakpoint.
    pub branch: BranchId,
    /// Place of the breakpoint's state.
    pub path: PathId,
    /// The state that has the breakpoint.
    pub node: NodeId,
    /// Source text of the condition.
    pub condition: SmolStr,
    /// One value for each input port of the node: the inputs that the state would get, or got.
    pub inputs: Arc<[D]>,
    /// After the exit: one value for each output port, and the outcome.
    pub left: Option<(Arc<[D]>, OutcomeId)>,
    /// The scoped variables of the container around the state, by name.
    pub scoped_variables: Vec<(SmolStr, D)>,
}

/// The ends of a barrier's branches, in the order of the children.
#[derive(Debug, Clone)]
pub struct Verdicts<D> {
    /// One entry for each child that ended.
    pub children: Vec<Verdict<D>>,
}

/// The end of one branch of a barrier.
#[derive(Debug, Clone)]
pub struct Verdict<D> {
    /// Id of the child.
    pub state: StateId,
    /// Name of the child.
    pub name: SmolStr,
    /// Id of the child's outcome.
    pub outcome: OutcomeId,
    /// Name of the child's outcome.
    pub outcome_name: SmolStr,
    /// Error with which the child ended, if any.
    pub error: Option<D>,
}

/// The result of a run.
#[derive(Debug, Clone)]
pub struct Finish<D> {
    /// Id of the root's outcome.
    pub outcome: OutcomeId,
    /// Name of the root's outcome.
    pub outcome_name: SmolStr,
    /// The root's outputs by name, with `error` if the root ended with one.
    pub outputs: Vec<(SmolStr, D)>,
    /// The root's scoped variables at the end, by name.
    pub scoped_variables: Vec<(SmolStr, D)>,
    /// Number of states that ran. Library states are not counted; the roots of their content are.
    pub states_run: u64,
}

/// Receives the results of [`crate::Engine::handle`]. Reused between calls, so that steady work allocates nothing.
#[derive(Debug, Clone)]
pub struct Outbox<D> {
    /// Effects for the driver, in order.
    pub effects: Vec<Effect<D>>,
    /// Events of the run, in order.
    pub events: Vec<Event<D>>,
}

impl<D> Default for Outbox<D> {
    fn default() -> Self {
        Self { effects: Vec::new(), events: Vec::new() }
    }
}
