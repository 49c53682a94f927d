//! The smallest changes of a machine, each with an exact inverse. Knows nothing of rules.

use super::EditError;
use crate::port::{Element, Elements, Extra};
use crate::rules::{Part, Rule};
use crate::{
    Container, DataFlow, DataFlowId, Header, Json, Kind, Layout, Machine, Outcome, OutcomeId, Port,
    PortId, PortKind, RuntimeValue, RuntimeValues, State, StateId, StatePath, Transition,
    TransitionId,
};
use smol_str::SmolStr;
use std::mem::replace;
use std::sync::Arc;

/// Sets one part of one state.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Path of the state. Irrelevant for [`Set::Header`].
    pub at: StatePath,
    /// The part to set, and its new value.
    pub set: Set,
}

/// The new value of a step; `None` removes it.
#[derive(Debug, Clone, PartialEq)]
pub enum Set {
    /// A child of a container.
    Child(StateId, Option<Arc<State>>),
    /// The id of the state, which its connections follow.
    Id(StateId),
    /// A part that a state has at most once, such as its name.
    Field(Field),
    /// The kind of the state, with everything that only this kind has.
    Kind(Box<Kind>),
    /// An outcome of the state.
    Outcome(OutcomeId, Option<Outcome>),
    /// A port or scoped variable.
    Port(PortKind, PortId, Option<Port>),
    /// A transition in the container.
    Transition(TransitionId, Option<Transition>),
    /// A data flow in the container.
    DataFlow(DataFlowId, Option<DataFlow>),
    /// A runtime value of a library state.
    RuntimeValue(PortKind, PortId, Option<RuntimeValue>),
    /// The header of the machine, whatever the state.
    Header(Box<Header>),
}

/// A simple part of a state.
#[derive(Debug, Clone, PartialEq)]
pub enum Field {
    /// The name, for people.
    Name(SmolStr),
    /// The description in Markdown; `None` removes it.
    Description(Option<Arc<str>>),
    /// Nested notes of the user; `None` removes them.
    SemanticData(Option<Arc<Json>>),
    /// The text of the script.
    Script(Option<Arc<str>>),
    /// Positions of its parts on the screen.
    Layout(Layout),
    /// Unknown keys of its file.
    Extra(Extra),
}

impl Step {
    pub(super) fn new(at: &StatePath, set: Set) -> Self {
        Self { at: at.clone(), set }
    }

    /// True for a change of the state's `core_data.json`.
    pub(super) fn replaces_core(&self) -> bool {
        !matches!(
            self.set,
            Set::Header(_)
                | Set::Child(..)
                | Set::Field(Field::Script(_) | Field::Layout(_) | Field::SemanticData(_))
        )
    }

    /// Changes the machine and returns the inverse step. Refused, without a change, if the state does not exist or cannot have
    /// such a part.
    pub(super) fn run(self, machine: &mut Machine) -> Result<Self, EditError> {
        let Self { at, set } = self;
        match set {
            Set::Header(header) => {
                let earlier = replace(&mut machine.header, *header);
                Ok(Self { at, set: Set::Header(Box::new(earlier)) })
            }
            Set::Id(id) => set_id(machine, &at, &id),
            set => {
                let state = machine.state_mut(&at).ok_or_else(|| EditError::no_such_state(&at))?;
                let wrong = || EditError::state(&at, Rule::WrongKind, "it has no place for this");
                let set = set.swap(state).ok_or_else(wrong)?;
                Ok(Self { at, set })
            }
        }
    }
}

impl Set {
    /// Sets the value and returns the old one. `None`, without a change, if the state cannot have such a part.
    fn swap(self, state: &mut State) -> Option<Self> {
        Some(match self {
            Self::Child(id, child) => {
                let states = &mut state.container_mut()?.states;
                let earlier = match child {
                    Some(child) => states.insert(id.clone(), child),
                    None => states.remove(&id),
                };
                Self::Child(id, earlier)
            }
            Self::Field(field) => Self::Field(field.swap(state)?),
            Self::Kind(kind) => Self::Kind(Box::new(replace(&mut state.kind, *kind))),
            Self::Outcome(id, outcome) => Self::Outcome(id, put(&mut state.outcomes, id, outcome)),
            Self::Port(kind, id, port) => Self::Port(kind, id, put(kind.of_mut(state)?, id, port)),
            Self::Transition(id, transition) => {
                let transitions = &mut state.container_mut()?.transitions;
                let earlier = match transition {
                    Some(transition) => transitions.insert(transition),
                    None => transitions.remove(id),
                };
                Self::Transition(id, earlier)
            }
            Self::DataFlow(id, flow) => {
                let flows = &mut state.container_mut()?.data_flows;
                let earlier = match flow {
                    Some(flow) => flows.insert(flow),
                    None => flows.remove(id),
                };
                Self::DataFlow(id, earlier)
            }
            Self::RuntimeValue(kind, id, value) => {
                let values = runtime_values_mut(state, kind)?;
                let earlier = match value {
                    Some(value) => values.insert(id, value),
                    None => values.remove(&id),
                };
                Self::RuntimeValue(kind, id, earlier)
            }
            Self::Id(_) | Self::Header(_) => return None,
        })
    }
}

impl Field {
    fn swap(self, state: &mut State) -> Option<Self> {
        Some(match self {
            Self::Name(name) => Self::Name(replace(&mut state.name, name)),
            Self::Description(text) => Self::Description(replace(&mut state.description, text)),
            Self::SemanticData(data) => Self::SemanticData(replace(&mut state.semantic_data, data)),
            Self::Layout(layout) => Self::Layout(replace(&mut state.layout, layout)),
            Self::Extra(extra) => Self::Extra(replace(&mut state.extra, extra)),
            Self::Script(text) => match &mut state.kind {
                Kind::Execution(script) | Kind::Decider(script) => {
                    Self::Script(replace(&mut script.text, text))
                }
                Kind::Hierarchy(_) | Kind::Barrier(_) | Kind::Preemptive(_) | Kind::Library(_) => {
                    return None;
                }
            },
        })
    }
}

fn put<T: Element>(list: &mut Elements<T>, id: T::Id, element: Option<T>) -> Option<T> {
    match element {
        Some(element) => list.insert(element),
        None => list.remove(id),
    }
}

fn runtime_values_mut(state: &mut State, kind: PortKind) -> Option<&mut RuntimeValues> {
    match (&mut state.kind, kind) {
        (Kind::Library(library), PortKind::Input) => Some(&mut library.inputs),
        (Kind::Library(library), PortKind::Output) => Some(&mut library.outputs),
        _ => None,
    }
}

/// Changes the id of a state, in its own connections and in those of its parent.
fn set_id(machine: &mut Machine, at: &StatePath, id: &StateId) -> Result<Step, EditError> {
    let missing = || EditError::no_such_state(at);
    let old = at.last().ok_or_else(missing)?.clone();
    let parent = at.parent();
    let state = machine.state_mut(at).ok_or_else(missing)?;
    if mentions(state, id) {
        return Err(EditError::taken(at, Part::State));
    }
    if let Some(parent) = &parent {
        let parent = machine.state_mut(parent).ok_or_else(missing)?;
        if parent.id == *id || mentions(parent, id) {
            return Err(EditError::taken(at, Part::State));
        }
        let container = parent.container_mut().ok_or_else(missing)?;
        let child = container.states.remove(&old).ok_or_else(missing)?;
        rename_ends(container, &old, id);
        container.states.insert(id.clone(), with_id(child, id));
    } else {
        machine.root = with_id(Arc::clone(&machine.root), id);
    }
    let at = parent.map_or_else(|| StatePath::root(id.clone()), |parent| parent.child(id.clone()));
    Ok(Step { at, set: Set::Id(old) })
}

/// True if a child or a connection inside `state` has this id.
fn mentions(state: &State, id: &StateId) -> bool {
    state.container().is_some_and(|container| {
        container.states.contains_key(id)
            || container.transitions.into_state(id).next().is_some()
            || container.transitions.out_of_state(id).next().is_some()
            || container.data_flows.into_state(id).next().is_some()
            || container.data_flows.out_of_state(id).next().is_some()
    })
}

/// The state with another id, which its own connections follow. For a state that is not added yet.
pub fn with_id(mut state: Arc<State>, id: &StateId) -> Arc<State> {
    let changed = Arc::make_mut(&mut state);
    let old = replace(&mut changed.id, id.clone());
    if let Some(container) = changed.container_mut() {
        rename_ends(container, &old, id);
    }
    state
}

fn rename_ends(container: &mut Container, old: &StateId, new: &StateId) {
    let ends = |id: &Option<StateId>| {
        if id.as_ref() == Some(old) { Some(new.clone()) } else { id.clone() }
    };
    let transitions = &container.transitions;
    let touched = transitions.into_state(old).chain(transitions.out_of_state(old));
    let touched: Vec<_> = touched.cloned().collect();
    for transition in touched {
        container.transitions.insert(Transition {
            from_state: ends(&transition.from_state),
            to_state: ends(&transition.to_state),
            ..transition
        });
    }
    let end = |id: &StateId| if id == old { new.clone() } else { id.clone() };
    let flows = &container.data_flows;
    let touched: Vec<_> = flows.into_state(old).chain(flows.out_of_state(old)).cloned().collect();
    for flow in touched {
        container.data_flows.insert(DataFlow {
            from_state: end(&flow.from_state),
            to_state: end(&flow.to_state),
            ..flow
        });
    }
}
