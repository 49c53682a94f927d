//! Edits of outcomes and ports, including their connections.

use super::error::EditError;
use super::plan::{own_interface, state_at};
use super::step::{Set, Step};
use super::{OutcomeEdit, PortEdit};
use crate::rules::{Part, Rule};
use crate::{
    Container, Machine, Origin, Outcome, OutcomeId, Port, PortId, PortKind, State, StatePath,
};

pub(super) fn outcome(
    machine: &Machine,
    path: &StatePath,
    id: OutcomeId,
    edit: OutcomeEdit,
) -> Result<Vec<Step>, EditError> {
    let state = state_at(machine, path)?;
    own_interface(path, state)?;
    let set = |outcome| Step::new(path, Set::Outcome(id, outcome));
    let earlier = state.outcomes.get(id);
    let found = || earlier.ok_or_else(|| EditError::no_such_element(path, Part::Outcome(id)));
    match edit {
        OutcomeEdit::Add(_) if earlier.is_some() => Err(EditError::taken(path, Part::Outcome(id))),
        OutcomeEdit::Add(name) => Ok(vec![set(Some(Outcome::new(id, name)))]),
        OutcomeEdit::Rename(name) => Ok(vec![set(Some(Outcome { name, ..found()?.clone() }))]),
        OutcomeEdit::Remove if id.is_mandatory() => Err(EditError::mandatory(path, id)),
        OutcomeEdit::Remove => {
            found()?;
            let mut steps = transitions_at(machine, path, state, id);
            steps.push(set(None));
            Ok(steps)
        }
    }
}

fn transitions_at(machine: &Machine, path: &StatePath, state: &State, id: OutcomeId) -> Vec<Step> {
    let mut steps = Vec::new();
    if let Some(container) = state.container() {
        let inner = container.transitions.into_outcome(&state.id, id);
        steps.extend(inner.map(|t| Step::new(path, Set::Transition(t.id, None))));
    }
    if let Some((parent, container)) = parent_container(machine, path) {
        let outer = container.transitions.from(&Origin::Outcome(state.id.clone(), id));
        steps.extend(outer.map(|t| Step::new(&parent, Set::Transition(t.id, None))));
    }
    steps
}

fn parent_container<'m>(
    machine: &'m Machine,
    path: &StatePath,
) -> Option<(StatePath, &'m Container)> {
    let parent = path.parent()?;
    let container = machine.state(&parent)?.container()?;
    Some((parent, container))
}

pub(super) fn port(
    machine: &Machine,
    path: &StatePath,
    kind: PortKind,
    id: PortId,
    edit: PortEdit,
) -> Result<Vec<Step>, EditError> {
    let state = state_at(machine, path)?;
    own_interface(path, state)?;
    let part = Part::Port(kind, id);
    let what = || format!("a state of the kind {} has no scoped variables", state.kind.name());
    let ports =
        kind.of(state).ok_or_else(|| EditError::new(path, part, Rule::WrongKind, what()))?;
    let set = |port| Step::new(path, Set::Port(kind, id, port));
    let found = || ports.get(id).cloned().ok_or_else(|| EditError::no_such_element(path, part));
    let port = match edit {
        PortEdit::Add { .. } if is_taken(state, id) => return Err(EditError::taken(path, part)),
        PortEdit::Add { name, data_type, default } => Port::new(id, name, data_type, default),
        PortEdit::Rename(name) => Port { name, ..found()? },
        PortEdit::SetType(data_type) => Port { data_type, ..found()? },
        PortEdit::SetDefault(default) => Port { default, ..found()? },
        PortEdit::Remove => {
            found()?;
            let mut steps = flows_at(machine, path, state, kind, id);
            steps.push(set(None));
            return Ok(steps);
        }
    };
    Ok(vec![set(Some(port))])
}

fn is_taken(state: &State, id: PortId) -> bool {
    let has = |kind: PortKind| kind.of(state).is_some_and(|ports| ports.get(id).is_some());
    PortKind::ALL.into_iter().any(has)
}

/// Steps that remove the data flows at a port, inside and outside of its state.
fn flows_at(
    machine: &Machine,
    path: &StatePath,
    state: &State,
    kind: PortKind,
    id: PortId,
) -> Vec<Step> {
    let remove = |at: &StatePath, container: &Container| -> Vec<Step> {
        let flows = &container.data_flows;
        let flows = flows.into_port(&state.id, id).chain(flows.out_of_port(&state.id, id));
        flows.map(|flow| Step::new(at, Set::DataFlow(flow.id, None))).collect()
    };
    let mut steps = state.container().map_or_else(Vec::new, |inside| remove(path, inside));
    let outside = parent_container(machine, path).filter(|_| kind != PortKind::ScopedVariable);
    if let Some((parent, container)) = outside {
        steps.extend(remove(&parent, container));
    }
    steps
}
