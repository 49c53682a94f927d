//! Ungrouping: replaces a container by its children.

use super::children::removable;
use super::error::EditError;
use super::group::free_name;
use super::plan::disconnect;
use super::step::{Set, Step, with_id};
use crate::ids::smallest_free;
use crate::rules::Rule;
use crate::{
    Container, DataFlow, DataFlowId, Origin, OutcomeId, Port, PortId, PortKind, State, StateId,
    StatePath, Target, Transition, TransitionId,
};
use smol_str::format_smolstr;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The steps that dissolve the child `id`.
pub(super) fn plan(
    path: &StatePath,
    here: (&State, &Container),
    id: &StateId,
    fresh: Vec<StateId>,
) -> Result<Vec<Step>, EditError> {
    let group = removable(path, here.1, id)?;
    let Some(inner) = group.container() else {
        let what = format!("a state of the kind {} has no children", group.kind.name());
        return Err(EditError::state(&path.child(id.clone()), Rule::WrongKind, what));
    };
    let mut ungrouping = Ungrouping {
        path,
        state: here.0,
        container: here.1,
        group,
        inner,
        ids: BTreeMap::new(),
        variables: BTreeMap::new(),
        links: BTreeSet::new(),
        transition_ids: Box::new(here.1.transitions.free_ids()),
        flow_ids: Box::new(here.1.data_flows.free_ids()),
        steps: disconnect(path, here.1, id),
    };
    ungrouping.steps.push(Step::new(path, Set::Child(id.clone(), None)));
    ungrouping.children(fresh)?;
    ungrouping.scoped_variables();
    ungrouping.transitions();
    ungrouping.flows();
    Ok(ungrouping.steps)
}

type UngroupEnd = (StateId, PortId);

struct Ungrouping<'m> {
    path: &'m StatePath,
    state: &'m State,
    container: &'m Container,
    group: &'m State,
    inner: &'m Container,
    /// The ids of the children, inside and outside; without the decider of a barrier.
    ids: BTreeMap<StateId, StateId>,
    /// The same for scoped variables.
    variables: BTreeMap<PortId, PortId>,
    /// The data flows that were already created.
    links: BTreeSet<(UngroupEnd, UngroupEnd)>,
    transition_ids: Box<dyn Iterator<Item = TransitionId> + 'm>,
    flow_ids: Box<dyn Iterator<Item = DataFlowId> + 'm>,
    steps: Vec<Step>,
}

impl Ungrouping<'_> {
    fn step(&mut self, set: Set) {
        self.steps.push(Step::new(self.path, set));
    }

    fn children(&mut self, fresh: Vec<StateId>) -> Result<(), EditError> {
        let mut fresh = fresh.into_iter();
        let mut taken: BTreeSet<StateId> = BTreeSet::from([self.state.id.clone()]);
        for (id, child) in self.inner.states.iter().filter(|(id, _)| !id.is_decider()) {
            let is_free = |id: &StateId| {
                let sibling = self.container.states.contains_key(id) && *id != self.group.id;
                !taken.contains(id) && !sibling
            };
            let mut candidates = std::iter::once(id.clone()).chain(fresh.by_ref());
            let Some(new) = candidates.find(is_free) else {
                let what = format!("the id {id} is taken outside, and no fresh id was given");
                let place = self.path.child(self.group.id.clone()).child(id.clone());
                return Err(EditError::state(&place, Rule::IdTaken, what));
            };
            taken.insert(new.clone());
            let child = Arc::clone(child);
            let child = if new == *id { child } else { with_id(child, &new) };
            self.ids.insert(id.clone(), new.clone());
            self.step(Set::Child(new, Some(child)));
        }
        Ok(())
    }

    fn scoped_variables(&mut self) {
        let mut variables = self.container.scoped_variables.clone();
        for variable in &self.inner.scoped_variables {
            let exists = variables.by_name(&variable.name).is_some();
            let long = || format_smolstr!("{}_{}", self.group.id, variable.name);
            let name = if exists { long() } else { variable.name.clone() };
            let name = free_name(&name, |name| variables.by_name(name).is_some());
            let taken = |id: PortId| {
                self.state.inputs.get(id).is_some()
                    || self.state.outputs.get(id).is_some()
                    || variables.get(id).is_some()
            };
            let id = PortId(smallest_free(|id| taken(PortId(id))));
            let port = Port { id, name, ..variable.clone() };
            variables.insert(port.clone());
            self.variables.insert(variable.id, id);
            self.step(Set::Port(PortKind::ScopedVariable, id, Some(port)));
        }
    }

    fn transitions(&mut self) {
        let start = self.inner.start(&self.group.id);
        if let Some(Target::State(id)) = start {
            self.entries(&id);
        }
        for transition in self.inner.transitions.iter() {
            let Some(Origin::Outcome(from, outcome)) = transition.origin() else { continue };
            let Some(from) = self.ids.get(&from).cloned() else { continue };
            let target = match transition.target(&self.group.id) {
                Some(Target::State(to)) => self.ids.get(&to).cloned().map(Target::State),
                Some(Target::Outcome(outcome)) => self.behind(outcome),
                None => None,
            };
            if let Some(target) = target {
                self.transition(Origin::Outcome(from, outcome), target);
            }
        }
    }

    /// Redirects transitions to the group to its start; those that loop from the group begin inside.
    fn entries(&mut self, start: &StateId) {
        let Some(start) = self.ids.get(start).cloned() else { return };
        let from_group = |t: &&Transition| t.from_state.as_ref() == Some(&self.group.id);
        let entries = self.container.transitions.into_state(&self.group.id);
        let entries: Vec<_> = entries.filter(|t| !from_group(t)).cloned().collect();
        for entry in entries {
            let entry = entry.with_target(Target::State(start.clone()), &self.state.id);
            self.step(Set::Transition(entry.id, Some(entry)));
        }
    }

    /// The target of an outcome of the group.
    fn behind(&self, outcome: OutcomeId) -> Option<Target> {
        let origin = Origin::Outcome(self.group.id.clone(), outcome);
        let target = self.container.transitions.from(&origin).next()?.target(&self.state.id)?;
        match target {
            Target::State(id) if id == self.group.id => match self.inner.start(&self.group.id)? {
                Target::State(start) => self.ids.get(&start).cloned().map(Target::State),
                Target::Outcome(_) => None,
            },
            target => Some(target),
        }
    }

    fn transition(&mut self, from: Origin, to: Target) {
        let Some(id) = self.transition_ids.next() else { return };
        let transition = Transition::new(id, from, to, &self.state.id);
        self.step(Set::Transition(id, Some(transition)));
    }

    fn flows(&mut self) {
        for flow in self.inner.data_flows.iter() {
            let from = (flow.from_state.clone(), flow.from_port);
            let to = (flow.to_state.clone(), flow.to_port);
            let is_border =
                |end: &UngroupEnd| end.0 == self.group.id && !self.variables.contains_key(&end.1);
            if is_border(&from) && is_border(&to) {
                continue;
            }
            let (sources, targets) = (self.sources(&from), self.targets(&to));
            for source in &sources {
                for target in &targets {
                    self.flow(source, target);
                }
            }
        }
    }

    fn outside(&self, end: &UngroupEnd) -> Option<UngroupEnd> {
        if end.0 == self.group.id {
            return self.variables.get(&end.1).map(|id| (self.state.id.clone(), *id));
        }
        self.ids.get(&end.0).map(|id| (id.clone(), end.1))
    }

    /// The source of a value inside, seen from outside.
    fn sources(&self, end: &UngroupEnd) -> Vec<UngroupEnd> {
        if end.0 != self.group.id || self.variables.contains_key(&end.1) {
            return self.outside(end).into_iter().collect();
        }
        let flows = self.container.data_flows.into_port(&end.0, end.1);
        flows.flat_map(|flow| self.before((flow.from_state.clone(), flow.from_port))).collect()
    }

    /// An end outside; for an output of the group that leads back to the group, where its values come from inside.
    fn before(&self, end: UngroupEnd) -> Vec<UngroupEnd> {
        if end.0 != self.group.id {
            return vec![end];
        }
        let inside = self.inner.data_flows.into_port(&end.0, end.1);
        inside.filter_map(|flow| self.outside(&(flow.from_state.clone(), flow.from_port))).collect()
    }

    /// The target of a value inside, seen from outside.
    fn targets(&self, end: &UngroupEnd) -> Vec<UngroupEnd> {
        if end.0 != self.group.id || self.variables.contains_key(&end.1) {
            return self.outside(end).into_iter().collect();
        }
        let flows = self.container.data_flows.out_of_port(&end.0, end.1);
        let outside = flows.filter(|flow| flow.to_state != self.group.id);
        outside.map(|flow| (flow.to_state.clone(), flow.to_port)).collect()
    }

    fn is_variable(&self, (state, port): &UngroupEnd) -> bool {
        let new = self.variables.values().any(|id| id == port);
        *state == self.state.id && (new || self.container.scoped_variables.get(*port).is_some())
    }

    fn flow(&mut self, from: &UngroupEnd, to: &UngroupEnd) {
        let both_variables = self.is_variable(from) && self.is_variable(to);
        if both_variables || !self.links.insert((from.clone(), to.clone())) {
            return;
        }
        let Some(id) = self.flow_ids.next() else { return };
        self.step(Set::DataFlow(id, Some(DataFlow::new(id, from.clone(), to.clone()))));
    }
}
