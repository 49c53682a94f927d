//! One state of a program.

use super::tables::{Checks, Exits, FlowRange};
use crate::NodeId;
use rafcon_model::{Loss, LossPolicy, Outcome, OutcomeId, Port, State, StateId};
use smol_str::SmolStr;
use std::sync::Arc;

/// Index of the outcome `preempted` in [`Node::outcomes`].
pub(crate) const PREEMPTED: u32 = 0;
/// Index of the outcome `aborted` in [`Node::outcomes`].
pub(crate) const ABORTED: u32 = 1;

/// A state of the program in its compiled form.
#[derive(Debug)]
pub struct Node<D> {
    pub(super) state: Arc<State>,
    pub(super) parent: Option<NodeId>,
    pub(crate) child_index: u32,
    /// True if the state existed in an earlier program of the run, but does not exist in this one.
    pub(super) gone: bool,
    pub(super) outcomes: Box<[Outcome]>,
    /// The parent's exit for each outcome.
    pub(crate) exits: Exits,
    /// True if each outcome's id is its index minus two, as in nearly every state.
    pub(super) plain_outcomes: bool,
    pub(crate) body: Body<D>,
    /// The value of each input port without a data flow.
    pub(crate) inputs: Box<[Initial<D>]>,
    /// The input values as one list, if they are equal for every run of the state.
    pub(crate) constant_inputs: Option<Arc<[D]>>,
    /// The default of each output port.
    pub(crate) outputs: Arc<[D]>,
    /// Output ports whose default could not be created, with the reason.
    pub(crate) bad_outputs: Box<[(u32, SmolStr)]>,
    /// The slots of the parent that flow into each input port.
    pub(crate) gather: FlowRange,
    /// The slots of the parent into which each output port flows.
    pub(crate) scatter: FlowRange,
    pub(crate) input_checks: Checks,
    pub(crate) output_checks: Checks,
    /// The input port with the name `error`.
    pub(crate) error_input: Option<u32>,
    /// The state's own policies for a silent ground.
    pub(super) loss: Option<Box<LossPolicies>>,
}

/// The state's own lost-link policies. A missing one is inherited from the state around it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct LossPolicies {
    pub(super) link: Option<LossPolicy>,
    pub(super) command: Option<LossPolicy>,
}

/// The target of a transition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Exit {
    /// No transition, or one without an existing target.
    Nowhere,
    /// The child with this index.
    Child(u32),
    /// The outcome of the container with this index.
    Outcome(u32),
}

/// The content of a state, by its kind.
#[derive(Debug)]
pub(crate) enum Body<D> {
    Script,
    Hierarchy(Box<Inside<D>>),
    Concurrency(Concurrency, Box<Inside<D>>),
    Library(Box<Content<D>>),
}

/// The two kinds of concurrency states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Concurrency {
    /// Waits for all children, then runs its decider: the child with this index.
    Barrier(Option<u32>),
    /// Ends with the first child.
    Preemptive,
}

impl Concurrency {
    /// The child that decides, if the state has one.
    pub(crate) fn decider(self) -> Option<u32> {
        match self {
            Self::Barrier(decider) => decider,
            Self::Preemptive => None,
        }
    }
}

/// The inside of a container. Its slots contain values: first its inputs, then its scoped variables, then those outputs
/// of children that flow somewhere.
#[derive(Debug)]
pub(crate) struct Inside<D> {
    pub(crate) children: Box<[NodeId]>,
    pub(crate) start: Exit,
    /// Sum of the numbers of the children's outcomes.
    pub(crate) exits: u32,
    pub(crate) slots: u32,
    /// The child and its output port for each of the last slots.
    pub(crate) sources: Box<[(u32, u32)]>,
    pub(crate) scoped: Box<[Scoped<D>]>,
    /// Flows from the inputs to the scoped variables.
    pub(crate) scatter: FlowRange,
    /// Flows from the slots to the outputs.
    pub(crate) gather: FlowRange,
    /// Reason why the container cannot run.
    pub(crate) fault: Option<Fault<D>>,
}

impl<D> Inside<D> {
    pub(crate) fn child(&self, index: u32) -> NodeId {
        self.children[index as usize]
    }

    pub(crate) fn count(&self) -> u32 {
        super::compile::index(self.children.len())
    }
}

/// A scoped variable of a container.
#[derive(Debug)]
pub(crate) struct Scoped<D> {
    pub(crate) port: Port,
    /// True if values are checked against a type.
    pub(crate) typed: bool,
    pub(crate) initial: D,
}

/// A reason why a container aborts before anything in it runs.
#[derive(Debug)]
pub(crate) struct Fault<D> {
    /// The scoped variable that cannot be created, if that is the reason.
    pub(crate) port: Option<SmolStr>,
    pub(crate) reason: SmolStr,
    /// The reason as a value, for the entry `error`.
    pub(crate) error: Option<D>,
}

/// The content of a library state.
#[derive(Debug)]
pub(crate) enum Content<D> {
    /// The library's root, and for each of its outcomes the outcome of the library state.
    Found { root: NodeId, ports: Option<Box<PortMap>>, outcomes: Box<[u32]> },
    /// The library is missing, or the state's own file is damaged. The reason is given as text and as a value.
    Missing { reason: SmolStr, error: Option<D>, is_library: bool },
}

impl<D> Content<D> {
    pub(crate) fn root(&self) -> Option<NodeId> {
        match self {
            Self::Found { root, .. } => Some(*root),
            Self::Missing { .. } => None,
        }
    }
}

/// Maps ports by id, if the port lists of a library state and its root differ.
#[derive(Debug)]
pub(crate) struct PortMap {
    /// For each input of the root, the input of the library state.
    pub(crate) inputs: Box<[Option<u32>]>,
    /// For each output of the root, the output of the library state.
    pub(crate) defaults: Box<[Option<u32>]>,
    /// For each output of the library state, the output of the root.
    pub(crate) outputs: Box<[Option<u32>]>,
}

/// The value of a port without a data flow.
#[derive(Debug)]
pub(crate) enum Initial<D> {
    /// The value of the default.
    Is(D),
    /// The global variable with this name.
    Global(SmolStr),
    /// `None`, because the default could not be created. Contains the reason.
    Bad(SmolStr),
}

impl<D> Node<D> {
    /// The state of the model.
    pub fn state(&self) -> &Arc<State> {
        &self.state
    }

    /// Id of the state.
    pub fn id(&self) -> &StateId {
        &self.state.id
    }

    /// Name of the state.
    pub fn name(&self) -> &SmolStr {
        &self.state.name
    }

    /// The state around it; `None` for the root of the machine and the roots of libraries.
    pub fn parent(&self) -> Option<NodeId> {
        self.parent
    }

    /// Index among the children of its parent; 0 for roots.
    pub fn child_index(&self) -> usize {
        self.child_index as usize
    }

    /// True if the state exists only in an earlier program of the run. It is never entered, but its history remains
    /// readable.
    pub fn is_gone(&self) -> bool {
        self.gone
    }

    /// The node of the child with this index. The only child of a library state is the root of its content.
    pub fn child(&self, index: usize) -> Option<NodeId> {
        match &self.body {
            Body::Hierarchy(inside) | Body::Concurrency(_, inside) => {
                inside.children.get(index).copied()
            }
            Body::Library(content) => content.root().filter(|_| index == 0),
            Body::Script => None,
        }
    }

    /// Number of children; 1 for a library state whose library was found.
    pub fn children(&self) -> usize {
        self.child_count() as usize
    }

    pub(crate) fn child_count(&self) -> u32 {
        match &self.body {
            Body::Hierarchy(inside) | Body::Concurrency(_, inside) => inside.count(),
            Body::Library(content) => u32::from(content.root().is_some()),
            Body::Script => 0,
        }
    }

    /// True for an execution state or decider, which run a script.
    pub fn is_script(&self) -> bool {
        matches!(self.body, Body::Script)
    }

    /// The state's own policy for this loss; `None` if the state around it decides.
    pub fn loss_policy(&self, loss: Loss) -> Option<LossPolicy> {
        let policies = self.loss.as_deref()?;
        match loss {
            Loss::Link => policies.link,
            Loss::Command => policies.command,
        }
    }

    /// The input ports. Lists of inputs have one entry for each, in this order.
    pub fn inputs(&self) -> &[Port] {
        self.state.inputs.as_slice()
    }

    /// The output ports. Lists of outputs have one entry for each, in this order.
    pub fn outputs(&self) -> &[Port] {
        self.state.outputs.as_slice()
    }

    /// The outcomes: preempted, aborted, then the user's by rising id.
    pub fn outcomes(&self) -> &[Outcome] {
        &self.outcomes
    }

    /// The outcome with this id.
    pub fn outcome(&self, id: OutcomeId) -> Option<&Outcome> {
        self.outcome_index(id.0).map(|index| &self.outcomes[index as usize])
    }

    pub(crate) fn outcome_index(&self, id: i64) -> Option<u32> {
        if self.plain_outcomes {
            let index = u32::try_from(id.checked_add(2)?).ok()?;
            return (index as usize).lt(&self.outcomes.len()).then_some(index);
        }
        let found = self.outcomes.iter().position(|outcome| outcome.id.0 == id)?;
        u32::try_from(found).ok()
    }

    pub(crate) fn outcome_id(&self, index: u32) -> OutcomeId {
        if self.plain_outcomes {
            return OutcomeId(i64::from(index) - 2);
        }
        self.outcome_at(index).id
    }

    pub(crate) fn outcome_named(&self, name: &str) -> Option<u32> {
        let found = self.outcomes.iter().position(|outcome| outcome.name == name)?;
        u32::try_from(found).ok()
    }

    pub(crate) fn outcome_at(&self, index: u32) -> &Outcome {
        &self.outcomes[index as usize]
    }
}
