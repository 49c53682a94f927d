//! The parts of a state, one by one.

use super::{Fault, interface, library, state, transition, wire};
use crate::{DataFlowId, OutcomeId, PortId, Ports, State, TransitionId, Types};
use std::fmt;

/// The list that contains a port.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PortKind {
    /// Inputs of a state.
    Input,
    /// Outputs of a state.
    Output,
    /// Scoped variables, which the children of a container share.
    ScopedVariable,
}

/// The part of a state in a problem or refusal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Part {
    /// The state itself: name, id, kind, script.
    State,
    /// An outcome of the state.
    Outcome(OutcomeId),
    /// A port or scoped variable.
    Port(PortKind, PortId),
    /// A transition between its children.
    Transition(TransitionId),
    /// A data flow between its children.
    DataFlow(DataFlowId),
    /// A runtime value of a library state.
    RuntimeValue(PortKind, PortId),
}

impl fmt::Display for PortKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Input => "input",
            Self::Output => "output",
            Self::ScopedVariable => "scoped variable",
        })
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::State => f.write_str("state"),
            Self::Outcome(id) => write!(f, "outcome {id}"),
            Self::Port(kind, id) => write!(f, "{kind} {id}"),
            Self::Transition(id) => write!(f, "transition {id}"),
            Self::DataFlow(id) => write!(f, "data flow {id}"),
            Self::RuntimeValue(kind, id) => write!(f, "runtime value of {kind} {id}"),
        }
    }
}

impl PortKind {
    /// All kinds, inputs first.
    pub const ALL: [Self; 3] = [Self::Input, Self::Output, Self::ScopedVariable];

    /// The ports of this kind; `None` for the scoped variables of a state that is no container.
    pub fn of(self, state: &State) -> Option<&Ports> {
        match self {
            Self::Input => Some(&state.inputs),
            Self::Output => Some(&state.outputs),
            Self::ScopedVariable => state.container().map(|c| &c.scoped_variables),
        }
    }

    /// The ports of this kind, mutable.
    pub fn of_mut(self, state: &mut State) -> Option<&mut Ports> {
        match self {
            Self::Input => Some(&mut state.inputs),
            Self::Output => Some(&mut state.outputs),
            Self::ScopedVariable => state.container_mut().map(|c| &mut c.scoped_variables),
        }
    }
}

/// All parts of a state, without those of its children.
pub(crate) fn parts(state: &State) -> impl Iterator<Item = Part> {
    let outcomes = state.outcomes.iter().map(|outcome| Part::Outcome(outcome.id));
    let ports = PortKind::ALL.into_iter().flat_map(|kind| {
        let ports = kind.of(state).into_iter().flatten();
        ports.map(move |port| Part::Port(kind, port.id))
    });
    let container = state.container();
    let transitions = container.into_iter().flat_map(|c| c.transitions.iter());
    let flows = container.into_iter().flat_map(|c| c.data_flows.iter());
    std::iter::once(Part::State)
        .chain(outcomes)
        .chain(ports)
        .chain(transitions.map(|transition| Part::Transition(transition.id)))
        .chain(flows.map(|flow| Part::DataFlow(flow.id)))
        .chain(library::runtime_values(state).map(|(kind, id)| Part::RuntimeValue(kind, id)))
}

/// The rules that one part of `state` breaks; empty for a part that does not exist.
pub(crate) fn faults_of(
    parent: Option<&State>,
    state: &State,
    part: Part,
    types: &dyn Types,
) -> Vec<Fault> {
    match part {
        Part::State => state::faults(parent, state),
        Part::Outcome(id) => interface::outcome_faults(parent, state, id),
        Part::Port(kind, id) => interface::port_faults(state, kind, id),
        Part::Transition(id) => transition::faults(state, id),
        Part::DataFlow(id) => wire::faults(state, id, types),
        Part::RuntimeValue(kind, id) => library::runtime_value_faults(state, kind, id),
    }
}

/// The rules that it breaks, without the notes that require the parent.
pub(crate) fn errors_of(
    parent: Option<&State>,
    state: &State,
    part: Part,
    types: &dyn Types,
) -> Vec<Fault> {
    match part {
        Part::Outcome(id) => interface::outcome_faults(None, state, id),
        _ => faults_of(parent, state, part, types),
    }
}
