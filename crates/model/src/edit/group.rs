//! Grouping: moves states into a new hierarchy, and adds an outcome or a port for each connection that crosses its border.

use super::children::removable;
use super::error::EditError;
use super::plan::nesting;
use super::step::{Set, Step};
use crate::ids::smallest_free;
use crate::rules::{Part, Rule, errors_of};
use crate::{
    BuiltinTypes, Container, DataFlow, Kind, Origin, Outcome, OutcomeId, Port, PortId, PortKind,
    Ports, State, StateId, StatePath, Target, Transition, TransitionId,
};
use smol_str::{SmolStr, format_smolstr};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The steps that put `states` and `variables` into `group`.
pub(super) fn plan(
    path: &StatePath,
    here: (&State, &Container),
    states: &[StateId],
    variables: &[PortId],
    group: State,
) -> Result<Vec<Step>, EditError> {
    if here.1.states.contains_key(&group.id) {
        return Err(EditError::taken(&path.child(group.id), Part::State));
    }
    let mut grouping = Grouping::new(path, here.0, here.1, group);
    states.iter().try_for_each(|id| grouping.take_state(id))?;
    variables.iter().try_for_each(|id| grouping.take_variable(*id))?;
    if grouping.members.is_empty() {
        return Err(EditError::state(path, Rule::NoSuchState, "there is no state to group"));
    }
    grouping.transitions()?;
    grouping.flows()?;
    grouping.finish()
}

type GroupEnd = (StateId, PortId);

struct Grouping<'m> {
    path: &'m StatePath,
    state: &'m State,
    container: &'m Container,
    members: BTreeSet<StateId>,
    variables: BTreeSet<PortId>,
    group: State,
    inner: Container,
    /// The child at which transitions enter the group, and the id of the first transition.
    entry: Option<(StateId, TransitionId)>,
    /// The target of each outcome of the group.
    exits: Vec<(Target, OutcomeId)>,
    inputs: BTreeMap<GroupEnd, PortId>,
    outputs: BTreeMap<GroupEnd, PortId>,
    /// The selection that leaves the container.
    leaving: Vec<Step>,
    /// The new connections around the group.
    outer: Vec<Step>,
}

impl<'m> Grouping<'m> {
    fn new(path: &'m StatePath, state: &'m State, container: &'m Container, group: State) -> Self {
        Self {
            path,
            state,
            container,
            members: BTreeSet::new(),
            variables: BTreeSet::new(),
            group,
            inner: Container::default(),
            entry: None,
            exits: Vec::new(),
            inputs: BTreeMap::new(),
            outputs: BTreeMap::new(),
            leaving: Vec::new(),
            outer: Vec::new(),
        }
    }

    fn take_state(&mut self, id: &StateId) -> Result<(), EditError> {
        let child = removable(self.path, self.container, id)?;
        if self.members.insert(id.clone()) {
            self.inner.states.insert(id.clone(), Arc::clone(child));
            self.leaving.push(Step::new(self.path, Set::Child(id.clone(), None)));
        }
        Ok(())
    }

    fn take_variable(&mut self, id: PortId) -> Result<(), EditError> {
        let part = Part::Port(PortKind::ScopedVariable, id);
        let variable = self.container.scoped_variables.get(id);
        let variable = variable.ok_or_else(|| EditError::no_such_element(self.path, part))?;
        if self.variables.insert(id) {
            self.inner.scoped_variables.insert(variable.clone());
            let set = Set::Port(PortKind::ScopedVariable, id, None);
            self.leaving.push(Step::new(self.path, set));
        }
        Ok(())
    }

    fn transitions(&mut self) -> Result<(), EditError> {
        let all = &self.container.transitions;
        let touching =
            self.members.iter().flat_map(|id| all.into_state(id).chain(all.out_of_state(id)));
        let touching: BTreeMap<_, _> = touching.map(|t| (t.id, t)).collect();
        touching.into_values().try_for_each(|transition| self.transition(transition))
    }

    fn transition(&mut self, transition: &Transition) -> Result<(), EditError> {
        let ends = (transition.origin(), transition.target(&self.state.id));
        let (Some(origin), Some(target)) = ends else { return Err(self.faulty(transition)) };
        let to_member = match &target {
            Target::State(to) if self.members.contains(to) => Some(to),
            Target::State(_) | Target::Outcome(_) => None,
        };
        match (&origin, to_member) {
            (Origin::Outcome(from, _), Some(_)) if self.members.contains(from) => {
                self.inner.transitions.insert(transition.clone());
                self.outer(Set::Transition(transition.id, None));
            }
            (_, Some(to)) => self.enter(transition, to)?,
            (Origin::Outcome(from, outcome), None) => {
                let name = self.outcome_name(from, *outcome);
                let name = name.ok_or_else(|| self.faulty(transition))?;
                self.leave(transition, &target, &name, &origin);
            }
            (Origin::Income, None) => {}
        }
        Ok(())
    }

    /// The error for a contradictory transition.
    fn faulty(&self, transition: &Transition) -> EditError {
        let part = Part::Transition(transition.id);
        let fault = errors_of(None, self.state, part, &BuiltinTypes).into_iter().next();
        match fault {
            Some(fault) => EditError::fault(self.path, part, fault),
            None => EditError::no_such_element(self.path, part),
        }
    }

    fn outcome_name(&self, child: &StateId, id: OutcomeId) -> Option<SmolStr> {
        Some(self.inner.states.get(child)?.outcomes.get(id)?.name.clone())
    }

    fn outer(&mut self, set: Set) {
        self.outer.push(Step::new(self.path, set));
    }

    /// Redirects a transition from outside to the group.
    fn enter(&mut self, transition: &Transition, to: &StateId) -> Result<(), EditError> {
        match &self.entry {
            Some((entry, _)) if entry != to => {
                let what = format!("transitions lead to both {entry} and {to} in the group");
                let part = Part::Transition(transition.id);
                return Err(EditError::new(self.path, part, Rule::GroupEntries, what));
            }
            Some(_) => {}
            None => self.entry = Some((to.clone(), transition.id)),
        }
        let group = Target::State(self.group.id.clone());
        let transition = transition.clone().with_target(group, &self.state.id);
        self.outer(Set::Transition(transition.id, Some(transition)));
        Ok(())
    }

    /// Leads a transition to the outside through an outcome of the group, one for each target outside.
    fn leave(&mut self, transition: &Transition, target: &Target, name: &SmolStr, from: &Origin) {
        let known = self.exits.iter().find(|(place, _)| place == target).map(|(_, id)| *id);
        let id = known.unwrap_or_else(|| self.new_exit(target, name));
        let inner = Transition {
            extra: transition.extra.clone(),
            ..Transition::new(transition.id, from.clone(), Target::Outcome(id), &self.group.id)
        };
        self.inner.transitions.insert(inner);
        let from = Origin::Outcome(self.group.id.clone(), id);
        let outer = Transition::new(transition.id, from, target.clone(), &self.state.id);
        self.outer(Set::Transition(transition.id, known.is_none().then_some(outer)));
    }

    fn new_exit(&mut self, target: &Target, name: &SmolStr) -> OutcomeId {
        let used = |id: OutcomeId, exits: &[(Target, OutcomeId)]| {
            exits.iter().any(|(_, exit)| *exit == id)
        };
        let same_name = self.group.outcomes.by_name(name).map(|outcome| outcome.id);
        let free = same_name.filter(|id| !used(*id, &self.exits));
        let id = free.unwrap_or_else(|| {
            let outcomes = &mut self.group.outcomes;
            let name = free_name(name, |name| outcomes.by_name(name).is_some());
            let id = OutcomeId(smallest_free(|id| outcomes.get(OutcomeId(id)).is_some()));
            outcomes.insert(Outcome::new(id, name));
            id
        });
        self.exits.push((target.clone(), id));
        id
    }

    fn flows(&mut self) -> Result<(), EditError> {
        let all = &self.container.data_flows;
        let at_states =
            self.members.iter().flat_map(|id| all.into_state(id).chain(all.out_of_state(id)));
        let own = &self.state.id;
        let at_variables = self
            .variables
            .iter()
            .flat_map(|id| all.into_port(own, *id).chain(all.out_of_port(own, *id)));
        let touching: BTreeMap<_, _> = at_states.chain(at_variables).map(|f| (f.id, f)).collect();
        touching.into_values().try_for_each(|flow| self.flow(flow))
    }

    fn is_inside(&self, (state, port): &GroupEnd) -> bool {
        self.members.contains(state) || (*state == self.state.id && self.variables.contains(port))
    }

    /// The same end, seen from inside the group.
    fn inner_end(&self, (state, port): &GroupEnd) -> GroupEnd {
        let own = *state == self.state.id;
        (if own { self.group.id.clone() } else { state.clone() }, *port)
    }

    fn flow(&mut self, flow: &DataFlow) -> Result<(), EditError> {
        let from = (flow.from_state.clone(), flow.from_port);
        let to = (flow.to_state.clone(), flow.to_port);
        match (self.is_inside(&from), self.is_inside(&to)) {
            (true, true) => {
                let ends = DataFlow::new(flow.id, self.inner_end(&from), self.inner_end(&to));
                self.inner.data_flows.insert(DataFlow { extra: flow.extra.clone(), ..ends });
                self.outer(Set::DataFlow(flow.id, None));
            }
            (false, true) => {
                let port = self.border_port(flow, &to, PortKind::Input)?;
                let to_state = self.group.id.clone();
                let outer = DataFlow { to_state, to_port: port, ..flow.clone() };
                self.outer(Set::DataFlow(flow.id, Some(outer)));
            }
            (true, false) => {
                let port = self.border_port(flow, &from, PortKind::Output)?;
                let from_state = self.group.id.clone();
                let outer = DataFlow { from_state, from_port: port, ..flow.clone() };
                self.outer(Set::DataFlow(flow.id, Some(outer)));
            }
            (false, false) => {}
        }
        Ok(())
    }

    /// The port of the group for an end inside; created and connected at its first use.
    fn border_port(
        &mut self,
        flow: &DataFlow,
        end: &GroupEnd,
        kind: PortKind,
    ) -> Result<PortId, EditError> {
        let known = if kind == PortKind::Input { &self.inputs } else { &self.outputs };
        if let Some(id) = known.get(end) {
            return Ok(*id);
        }
        let Some(model) = self.port_at(end, kind).cloned() else {
            let part = Part::DataFlow(flow.id);
            let what = format!("there is no such port at {}", end.0);
            return Err(EditError::new(self.path, part, Rule::FlowPort, what));
        };
        let id = self.free_port();
        let (list, known) = match kind {
            PortKind::Input => (&mut self.group.inputs, &mut self.inputs),
            PortKind::Output | PortKind::ScopedVariable => {
                (&mut self.group.outputs, &mut self.outputs)
            }
        };
        let name = free_name(&model.name, |name| list.by_name(name).is_some());
        list.insert(Port { id, name, extra: None, ..model });
        known.insert(end.clone(), id);
        let (border, inside) = ((self.group.id.clone(), id), self.inner_end(end));
        let (from, to) = if kind == PortKind::Input { (border, inside) } else { (inside, border) };
        self.inner.data_flows.insert(DataFlow::new(flow.id, from, to));
        Ok(id)
    }

    fn port_at(&self, (state, port): &GroupEnd, kind: PortKind) -> Option<&Port> {
        if *state == self.state.id {
            return self.inner.scoped_variables.get(*port);
        }
        kind.of(self.inner.states.get(state)?)?.get(*port)
    }

    fn free_port(&self) -> PortId {
        let has = |ports: &Ports, id| ports.get(id).is_some();
        let taken = |id: PortId| {
            has(&self.group.inputs, id)
                || has(&self.group.outputs, id)
                || has(&self.inner.scoped_variables, id)
        };
        PortId(smallest_free(|id| taken(PortId(id))))
    }

    fn finish(mut self) -> Result<Vec<Step>, EditError> {
        let only = self.members.first().filter(|_| self.members.len() == 1);
        let next = self.inner.transitions.next_id();
        let entry = self.entry.take().or_else(|| only.map(|id| (id.clone(), next)));
        if let Some((state, id)) = entry {
            let start = Transition::new(id, Origin::Income, Target::State(state), &self.group.id);
            self.inner.transitions.insert(start);
        }
        self.group.kind = Kind::Hierarchy(self.inner);
        nesting(self.path, &self.group)?;
        let child = Set::Child(self.group.id.clone(), Some(Arc::new(self.group)));
        let mut steps = self.leaving;
        steps.push(Step::new(self.path, child));
        steps.extend(self.outer);
        Ok(steps)
    }
}

/// The name, or the first of `name_0`, `name_1`, … that is free.
pub(super) fn free_name(name: &SmolStr, taken: impl Fn(&str) -> bool) -> SmolStr {
    let numbered = (0u64..).map(|number| format_smolstr!("{name}_{number}"));
    let mut names = std::iter::once(name.clone()).chain(numbered);
    names.find(|name| !taken(name)).unwrap_or_default()
}
