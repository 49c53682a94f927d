//! Transitions and data flows: the lines between states. Knows the parts of a line, not whether it is legal.

use crate::port::Extra;
use crate::{DataFlowId, OutcomeId, PortId, StateId, TransitionId};

/// The successor of an outcome. The four fields are those of the file, so that a faulty transition is preserved;
/// [`Transition::origin`] and [`Transition::target`] interpret them.
#[derive(Debug, Clone, PartialEq)]
pub struct Transition {
    /// Unique in the container.
    pub id: TransitionId,
    /// `None`: from the income of the container (the start transition).
    pub from_state: Option<StateId>,
    /// `None` only for the start transition.
    pub from_outcome: Option<OutcomeId>,
    /// A child, or the container itself.
    pub to_state: Option<StateId>,
    /// An outcome of the container; `None` if the target is a child.
    pub to_outcome: Option<OutcomeId>,
    /// Unknown keys of the file.
    pub extra: Extra,
}

/// Origin of a transition.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Origin {
    /// The income of the container.
    Income,
    /// An outcome of a child.
    Outcome(StateId, OutcomeId),
}

/// Target of a transition.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Target {
    /// The income of a child.
    State(StateId),
    /// An outcome of the container.
    Outcome(OutcomeId),
}

impl Transition {
    /// A transition in the container with the id `container`.
    pub fn new(id: TransitionId, origin: Origin, target: Target, container: &StateId) -> Self {
        let (from_state, to_state) = (None, None);
        let (from_outcome, to_outcome) = (None, None);
        Self { id, from_state, from_outcome, to_state, to_outcome, extra: None }
            .with_origin(origin)
            .with_target(target, container)
    }

    /// The same transition, beginning elsewhere.
    #[must_use]
    pub fn with_origin(self, origin: Origin) -> Self {
        let (from_state, from_outcome) = match origin {
            Origin::Income => (None, None),
            Origin::Outcome(state, outcome) => (Some(state), Some(outcome)),
        };
        Self { from_state, from_outcome, ..self }
    }

    /// The same transition in the container with the id `container`, leading elsewhere.
    #[must_use]
    pub fn with_target(self, target: Target, container: &StateId) -> Self {
        let (to_state, to_outcome) = match target {
            Target::State(state) => (Some(state), None),
            Target::Outcome(outcome) => (Some(container.clone()), Some(outcome)),
        };
        Self { to_state, to_outcome, ..self }
    }

    /// Its origin; `None` if the fields contradict each other.
    pub fn origin(&self) -> Option<Origin> {
        match (&self.from_state, self.from_outcome) {
            (None, None) => Some(Origin::Income),
            (Some(state), Some(outcome)) => Some(Origin::Outcome(state.clone(), outcome)),
            _ => None,
        }
    }

    /// Its target in the container with the id `container`; `None` if the fields contradict each other.
    pub fn target(&self, container: &StateId) -> Option<Target> {
        match (&self.to_state, self.to_outcome) {
            (Some(state), Some(outcome)) if state == container => Some(Target::Outcome(outcome)),
            (Some(state), None) if state != container => Some(Target::State(state.clone())),
            _ => None,
        }
    }
}

/// A value's way from one port to another. In the container with id C, `from_state` is a child or C itself (an input port
/// or scoped variable), `to_state` a child or C itself (an output port or scoped variable).
#[derive(Debug, Clone, PartialEq)]
pub struct DataFlow {
    /// Unique in the container.
    pub id: DataFlowId,
    /// The state of the source port.
    pub from_state: StateId,
    /// An output of a child, or an input or scoped variable of the container.
    pub from_port: PortId,
    /// The state of the target port.
    pub to_state: StateId,
    /// An input of a child, or an output or scoped variable of the container.
    pub to_port: PortId,
    /// Unknown keys of the file.
    pub extra: Extra,
}

impl DataFlow {
    /// A data flow without unknown keys.
    pub fn new(id: DataFlowId, from: (StateId, PortId), to: (StateId, PortId)) -> Self {
        Self {
            id,
            from_state: from.0,
            from_port: from.1,
            to_state: to.0,
            to_port: to.1,
            extra: None,
        }
    }
}
