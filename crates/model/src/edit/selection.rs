//! Copying and moving states with the connections between them.

use super::children::{removable, whole};
use super::error::EditError;
use super::group::free_name;
use super::plan::{container_at, disconnect, nesting};
use super::step::{Set, Step, with_id};
use crate::ids::smallest_free;
use crate::rules::{Part, Rule};
use crate::{
    Container, DataFlow, Kind, Machine, Port, PortId, PortKind, State, StateId, StatePath,
    Transition, TransitionId, Types,
};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// States taken from a container, with the transitions and data flows between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// The id of the container.
    pub container: StateId,
    /// The copied states, with everything inside them.
    pub states: Vec<Arc<State>>,
    /// Scoped variables of the container.
    pub scoped_variables: Vec<Port>,
    /// Transitions from one of the states to one of them.
    pub transitions: Vec<Transition>,
    /// Data flows between the states and variables.
    pub data_flows: Vec<DataFlow>,
}

/// Copies children and scoped variables of a container; skips those that do not exist.
pub fn copy(container: &State, states: &[StateId], scoped_variables: &[PortId]) -> Selection {
    let mut selection = Selection {
        container: container.id.clone(),
        states: Vec::new(),
        scoped_variables: Vec::new(),
        transitions: Vec::new(),
        data_flows: Vec::new(),
    };
    let Some(inside) = container.container() else { return selection };
    let ids: BTreeSet<_> = states.iter().collect();
    let variables: BTreeSet<_> = scoped_variables.iter().collect();
    let found = states.iter().filter_map(|id| inside.states.get(id));
    selection.states = found.map(Arc::clone).collect();
    let found = scoped_variables.iter().filter_map(|id| inside.scoped_variables.get(*id));
    selection.scoped_variables = found.cloned().collect();
    let is_in = |id: &Option<StateId>| id.as_ref().is_some_and(|id| ids.contains(id));
    let between = inside.transitions.iter().filter(|t| is_in(&t.from_state) && is_in(&t.to_state));
    selection.transitions = between.cloned().collect();
    let end = |id: &StateId, port: &PortId| {
        ids.contains(id) || (*id == container.id && variables.contains(port))
    };
    let between = inside
        .data_flows
        .iter()
        .filter(|f| end(&f.from_state, &f.from_port) && end(&f.to_state, &f.to_port));
    selection.data_flows = between.cloned().collect();
    selection
}

/// The steps that move states to another container.
pub(super) fn plan_move(
    machine: &Machine,
    path: &StatePath,
    states: &[StateId],
    to: &StatePath,
    ids: Vec<StateId>,
) -> Result<Vec<Step>, EditError> {
    let (state, container) = container_at(machine, path)?;
    let mut steps = Vec::new();
    for id in states {
        removable(path, container, id)?;
        let place = path.child(id.clone());
        if to.0.starts_with(&place.0) {
            return Err(EditError::state(&place, Rule::MoveIntoItself, "it would contain itself"));
        }
        steps.extend(disconnect(path, container, id));
        steps.push(Step::new(path, Set::Child(id.clone(), None)));
    }
    let (target, _) = container_at(machine, to)?;
    if to == path {
        return Ok(Vec::new());
    }
    let selection = copy(state, states, &[]);
    steps.extend(plan_paste(to, target, selection, ids, None)?);
    Ok(steps)
}

/// The steps that add a selection to the container `state`. With `types`, checks the new states with everything inside.
pub(super) fn plan_paste(
    path: &StatePath,
    state: &State,
    selection: Selection,
    ids: Vec<StateId>,
    types: Option<&dyn Types>,
) -> Result<Vec<Step>, EditError> {
    let Some(container) = state.container() else { return Err(EditError::no_such_state(path)) };
    let mut pasting = Pasting {
        path,
        state,
        container,
        types,
        ids: BTreeMap::new(),
        variables: BTreeMap::new(),
        from: selection.container,
        transition_ids: Box::new(container.transitions.free_ids()),
        steps: Vec::new(),
    };
    pasting.states(selection.states, ids)?;
    pasting.scoped_variables(&selection.scoped_variables);
    pasting.transitions(selection.transitions);
    pasting.flows(selection.data_flows);
    Ok(pasting.steps)
}

struct Pasting<'m> {
    path: &'m StatePath,
    state: &'m State,
    container: &'m Container,
    types: Option<&'m dyn Types>,
    /// The ids of the states, in the selection and here.
    ids: BTreeMap<StateId, StateId>,
    /// The same for scoped variables.
    variables: BTreeMap<PortId, PortId>,
    /// The id of the container that the selection comes from.
    from: StateId,
    transition_ids: Box<dyn Iterator<Item = TransitionId> + 'm>,
    steps: Vec<Step>,
}

impl Pasting<'_> {
    fn step(&mut self, set: Set) {
        self.steps.push(Step::new(self.path, set));
    }

    fn states(&mut self, states: Vec<Arc<State>>, ids: Vec<StateId>) -> Result<(), EditError> {
        let mut ids = ids.into_iter();
        let mut taken = BTreeSet::from([self.state.id.clone()]);
        for state in states {
            let old = state.id.clone();
            let id = ids.next().unwrap_or_else(|| old.clone());
            let place = self.path.child(id.clone());
            if matches!(state.kind, Kind::Decider(_)) {
                let what = "a barrier has its own decider";
                return Err(EditError::state(&place, Rule::DeciderFixed, what));
            }
            let inner = state.container().is_some_and(|inside| inside.states.contains_key(&id));
            if self.container.states.contains_key(&id) || !taken.insert(id.clone()) || inner {
                return Err(EditError::taken(&place, Part::State));
            }
            let state = if id == old { state } else { with_id(state, &id) };
            match self.types {
                Some(types) => whole(self.path, self.state, &state, types)?,
                None => nesting(self.path, &state)?,
            }
            self.ids.insert(old, id.clone());
            self.lead_to_decider(&state);
            self.step(Set::Child(id, Some(state)));
        }
        Ok(())
    }

    /// In a barrier, each outcome from 0 on leads to the decider.
    fn lead_to_decider(&mut self, child: &State) {
        let outcomes: Vec<_> = child.outcomes.iter().map(|outcome| outcome.id).collect();
        let ids = self.transition_ids.by_ref();
        let steps = super::children::to_decider(self.path, self.state, &child.id, &outcomes, ids);
        self.steps.extend(steps);
    }

    fn scoped_variables(&mut self, selected: &[Port]) {
        let mut variables = self.container.scoped_variables.clone();
        for variable in selected {
            let taken = |id: PortId| {
                self.state.inputs.get(id).is_some()
                    || self.state.outputs.get(id).is_some()
                    || variables.get(id).is_some()
            };
            let id = PortId(smallest_free(|id| taken(PortId(id))));
            let name = free_name(&variable.name, |name| variables.by_name(name).is_some());
            let port = Port { id, name, ..variable.clone() };
            variables.insert(port.clone());
            self.variables.insert(variable.id, id);
            self.step(Set::Port(PortKind::ScopedVariable, id, Some(port)));
        }
    }

    /// Concurrency states have no transitions between their children.
    fn transitions(&mut self, transitions: Vec<Transition>) {
        if !matches!(self.state.kind, Kind::Hierarchy(_)) {
            return;
        }
        for transition in transitions {
            let Some(id) = self.transition_ids.next() else { return };
            let end = |end: Option<StateId>| end.and_then(|end| self.ids.get(&end).cloned());
            let from_state = end(transition.from_state);
            let to_state = end(transition.to_state);
            let transition = Transition { id, from_state, to_state, ..transition };
            self.step(Set::Transition(id, Some(transition)));
        }
    }

    fn flows(&mut self, flows: Vec<DataFlow>) {
        for (id, flow) in self.container.data_flows.free_ids().zip(flows) {
            let from = self.end(&flow.from_state, flow.from_port);
            let to = self.end(&flow.to_state, flow.to_port);
            if let (Some(from), Some(to)) = (from, to) {
                let new = DataFlow { extra: flow.extra, ..DataFlow::new(id, from, to) };
                self.step(Set::DataFlow(id, Some(new)));
            }
        }
    }

    fn end(&self, state: &StateId, port: PortId) -> Option<(StateId, PortId)> {
        if *state == self.from {
            return Some((self.state.id.clone(), *self.variables.get(&port)?));
        }
        Some((self.ids.get(state)?.clone(), port))
    }
}
