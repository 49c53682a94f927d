//! Substitution: replaces a state by another, and keeps the connections and values that fit.

use super::children::{complete, removable, to_decider, whole};
use super::error::EditError;
use super::plan::disconnect;
use super::step::{Set, Step};
use crate::rules::Part;
use crate::{
    Container, DataFlow, Kind, Library, Origin, OutcomeId, PortId, PortKind, Ports, RuntimeValue,
    RuntimeValues, State, StateId, StatePath, Transition, Types, Value,
};
use std::sync::Arc;

/// The steps that replace the child `id` by `by`.
pub(super) fn plan(
    path: &StatePath,
    here: (&State, &Container),
    id: &StateId,
    by: Arc<State>,
    types: &dyn Types,
) -> Result<Vec<Step>, EditError> {
    let (state, container) = here;
    let old = removable(path, container, id)?;
    if by.id != *id && container.states.contains_key(&by.id) {
        return Err(EditError::taken(&path.child(by.id.clone()), Part::State));
    }
    let new = with_values_of(old, complete(by));
    whole(path, state, &new, types)?;
    let substitution = Substitution { path, container, old, new: &new };
    let mut steps = disconnect(path, container, id);
    steps.push(Step::new(path, Set::Child(id.clone(), None)));
    steps.push(Step::new(path, Set::Child(new.id.clone(), Some(Arc::clone(&new)))));
    steps.extend(substitution.transitions());
    steps.extend(substitution.flows());
    let ids = container.transitions.free_ids();
    steps.extend(to_decider(path, state, &new.id, &substitution.new_outcomes(), ids));
    Ok(steps)
}

struct Substitution<'m> {
    path: &'m StatePath,
    container: &'m Container,
    old: &'m State,
    new: &'m State,
}

impl Substitution<'_> {
    /// The outcome with this name of the new state.
    fn outcome(&self, id: OutcomeId) -> Option<OutcomeId> {
        let name = &self.old.outcomes.get(id)?.name;
        self.new.outcomes.by_name(name).map(|outcome| outcome.id)
    }

    /// Outcomes of the new state that take over no transition of the old one.
    fn new_outcomes(&self) -> Vec<OutcomeId> {
        let connected: Vec<_> = self
            .container
            .transitions
            .out_of_state(&self.old.id)
            .filter_map(|t| self.outcome(t.from_outcome?))
            .collect();
        let outcomes = self.new.outcomes.iter().map(|outcome| outcome.id);
        outcomes.filter(|id| !connected.contains(id)).collect()
    }

    fn transitions(&self) -> Vec<Step> {
        let all = &self.container.transitions;
        let out = all.out_of_state(&self.old.id).filter_map(|transition| {
            let outcome = self.outcome(transition.from_outcome?)?;
            let from = Origin::Outcome(self.new.id.clone(), outcome);
            Some(self.with_target(transition.clone().with_origin(from)))
        });
        let is_loop = |t: &&Transition| t.from_state.as_ref() == Some(&self.old.id);
        let incoming = all.into_state(&self.old.id).filter(|t| !is_loop(t));
        let incoming = incoming.map(|transition| self.with_target(transition.clone()));
        out.chain(incoming).map(|t| Step::new(self.path, Set::Transition(t.id, Some(t)))).collect()
    }

    fn with_target(&self, mut transition: Transition) -> Transition {
        if transition.to_state.as_ref() == Some(&self.old.id) {
            transition.to_state = Some(self.new.id.clone());
        }
        transition
    }

    fn flows(&self) -> Vec<Step> {
        let all = &self.container.data_flows;
        let touching = all.into_state(&self.old.id).chain(all.out_of_state(&self.old.id));
        let flows = touching.filter_map(|flow| {
            let (from_state, from_port) = self.end(&flow.from_state, flow.from_port)?;
            let (to_state, to_port) = self.end(&flow.to_state, flow.to_port)?;
            Some(DataFlow { from_state, from_port, to_state, to_port, ..flow.clone() })
        });
        flows.map(|flow| Step::new(self.path, Set::DataFlow(flow.id, Some(flow)))).collect()
    }

    fn end(&self, state: &StateId, port: PortId) -> Option<(StateId, PortId)> {
        if *state != self.old.id {
            return Some((state.clone(), port));
        }
        let inputs = twin(&self.old.inputs, port, &self.new.inputs);
        let port = inputs.or_else(|| twin(&self.old.outputs, port, &self.new.outputs))?;
        Some((self.new.id.clone(), port))
    }
}

/// The port of another list with an equal name and type.
fn twin(old: &Ports, id: PortId, new: &Ports) -> Option<PortId> {
    let port = old.get(id)?;
    new.by_name(&port.name).filter(|other| other.data_type == port.data_type).map(|other| other.id)
}

/// The new state with the defaults and runtime values of the old one, where ports fit.
fn with_values_of(old: &State, mut new: Arc<State>) -> Arc<State> {
    for kind in [PortKind::Input, PortKind::Output] {
        let (Some(from), Some(to)) = (kind.of(old), kind.of(&new)) else { continue };
        let pairs: Vec<_> =
            from.iter().filter_map(|port| Some((port.id, twin(from, port.id, to)?))).collect();
        for (from, to) in pairs {
            if let Some(value) = value_of(old, kind, from) {
                set_value(Arc::make_mut(&mut new), kind, to, value);
            }
        }
    }
    new
}

/// The value of a state for a port: the runtime value of a library, or else the default.
fn value_of(state: &State, kind: PortKind, id: PortId) -> Option<RuntimeValue> {
    if let Kind::Library(library) = &state.kind {
        return values(library, kind).get(&id).cloned();
    }
    let default = kind.of(state)?.get(id)?.default.clone();
    Some(RuntimeValue { value: default, used: true }).filter(|value| value.value != Value::None)
}

fn values(library: &Library, kind: PortKind) -> &RuntimeValues {
    if kind == PortKind::Input { &library.inputs } else { &library.outputs }
}

fn set_value(state: &mut State, kind: PortKind, id: PortId, value: RuntimeValue) {
    if let Kind::Library(library) = &mut state.kind {
        let inputs = kind == PortKind::Input;
        let values = if inputs { &mut library.inputs } else { &mut library.outputs };
        values.insert(id, value);
    } else if value.used
        && let Some(ports) = kind.of_mut(state)
        && let Some(port) = ports.get(id).cloned()
    {
        ports.insert(crate::Port { default: value.value, ..port });
    }
}
