//! The parts of a machine that a step can break: those that it changes and those that are connected with them.

use super::step::{Field, Set, Step};
use crate::port::{Element, Elements};
use crate::rules::{Part, parts};
use crate::{
    Container, DataFlowId, Machine, Origin, OutcomeId, PortId, PortKind, State, StateId, StatePath,
    Transition, TransitionId,
};

/// A part of a state somewhere in the machine.
pub(super) type Place = (StatePath, Part);

/// The parts to check before the step, including those that break a rule only together with a changed one.
pub(super) fn scope_before<'m>(step: &'m Step, walk: &mut Walk<'m>) -> Vec<Place> {
    let Some(mut scope) = Scope::of(step, walk) else { return Vec::new() };
    match &step.set {
        Set::Transition(id, _) => scope.transition_twins(*id),
        Set::DataFlow(id, _) => scope.data_flow_twins(*id),
        Set::Outcome(id, _) => scope.outcome_twins(*id),
        Set::Port(kind, id, _) => scope.port_twins(*kind, *id),
        Set::Child(id, _) => scope.connections(id),
        Set::Id(_) | Set::Field(_) | Set::Kind(_) | Set::RuntimeValue(..) | Set::Header(_) => {}
    }
    let mut places = scope_after(step, walk);
    places.append(&mut scope.places);
    places
}

/// The parts to check after the step, given its inverse.
pub(super) fn scope_after<'m>(step: &'m Step, walk: &mut Walk<'m>) -> Vec<Place> {
    let Some(mut scope) = Scope::of(step, walk) else { return Vec::new() };
    match &step.set {
        Set::Child(id, _) => scope.child(id),
        Set::Id(_) => {
            scope.here(Part::State);
            scope.outside_of_state();
        }
        Set::Field(Field::Layout(_) | Field::Extra(_)) | Set::Header(_) => {}
        Set::Field(_) => scope.here(Part::State),
        Set::Kind(_) => scope.kind(),
        Set::Outcome(id, _) => scope.outcome(*id),
        Set::Port(kind, id, _) => scope.port(*kind, *id),
        Set::Transition(id, _) => scope.here(Part::Transition(*id)),
        Set::DataFlow(id, _) => scope.here(Part::DataFlow(*id)),
        Set::RuntimeValue(kind, id, _) => scope.here(Part::RuntimeValue(*kind, *id)),
    }
    scope.places
}

struct Scope<'m> {
    at: &'m StatePath,
    parent: Option<&'m State>,
    state: &'m State,
    places: Vec<Place>,
}

impl<'m> Scope<'m> {
    fn of(step: &'m Step, walk: &mut Walk<'m>) -> Option<Self> {
        let (parent, state) = walk.find(&step.at.0)?;
        Some(Self { at: &step.at, parent, state, places: Vec::new() })
    }

    fn here(&mut self, part: Part) {
        self.places.push((self.at.clone(), part));
    }

    /// Transitions that begin where this one begins.
    fn transition_twins(&mut self, id: TransitionId) {
        let Some(container) = self.state.container() else { return };
        let origin = container.transitions.get(id).and_then(Transition::origin);
        let twins = origin.into_iter().flat_map(|origin| container.transitions.from(&origin));
        let twins = twins.filter(|twin| twin.id != id);
        self.places.extend(twins.map(|twin| (self.at.clone(), Part::Transition(twin.id))));
    }

    /// Other data flows between the ports of this one.
    fn data_flow_twins(&mut self, id: DataFlowId) {
        let Some(container) = self.state.container() else { return };
        let Some(flow) = container.data_flows.get(id) else { return };
        let from = (flow.from_state.clone(), flow.from_port);
        let twins = container.data_flows.between(from, (flow.to_state.clone(), flow.to_port));
        let twins = twins.filter(|twin| twin.id != id);
        self.places.extend(twins.map(|twin| (self.at.clone(), Part::DataFlow(twin.id))));
    }

    fn child(&mut self, id: &StateId) {
        self.here(Part::State);
        self.places.push((self.at.child(id.clone()), Part::State));
    }

    /// The connections of a child. Adding or removing the child does not change them.
    fn connections(&mut self, id: &StateId) {
        let Some(container) = self.state.container() else { return };
        let connections = connections_of(container, id);
        self.places.extend(connections.map(|part| (self.at.clone(), part)));
    }

    /// The path and inside of the parent.
    fn parent(&self) -> Option<(StatePath, &'m Container)> {
        let container = self.parent?.container()?;
        let path = self.at.parent()?;
        Some((path, container))
    }

    fn outside_of_state(&mut self) {
        let Some((path, container)) = self.parent() else { return };
        let connections = connections_of(container, &self.state.id);
        self.places.extend(connections.map(|part| (path.clone(), part)));
    }

    fn kind(&mut self) {
        let own = parts(self.state).map(|part| (self.at.clone(), part));
        self.places.extend(own);
        let children = self.state.container().into_iter().flat_map(|c| c.states.keys());
        let children = children.map(|id| (self.at.child(id.clone()), Part::State));
        self.places.extend(children);
        self.outside_of_state();
    }

    /// Other outcomes with the name of this one.
    fn outcome_twins(&mut self, id: OutcomeId) {
        let outcomes = &self.state.outcomes;
        let twins = outcomes.get(id).into_iter().flat_map(|outcome| named(outcomes, outcome));
        self.places.extend(twins.map(|twin| (self.at.clone(), Part::Outcome(twin.id))));
    }

    /// Ports of its kind with an equal name, and ports of other kinds with an equal id.
    fn port_twins(&mut self, kind: PortKind, id: PortId) {
        for other in PortKind::ALL {
            let Some(ports) = other.of(self.state) else { continue };
            let here = ports.get(id);
            let twins =
                here.filter(|_| other == kind).into_iter().flat_map(|port| named(ports, port));
            let twins = twins.chain(here.filter(|_| other != kind));
            self.places.extend(twins.map(|port| (self.at.clone(), Part::Port(other, port.id))));
        }
    }

    fn outcome(&mut self, id: OutcomeId) {
        self.here(Part::State);
        self.here(Part::Outcome(id));
        if let Some(container) = self.state.container() {
            let inner = container.transitions.into_outcome(&self.state.id, id);
            self.places.extend(inner.map(|t| (self.at.clone(), Part::Transition(t.id))));
        }
        if let Some((path, container)) = self.parent() {
            let outer = container.transitions.from(&Origin::Outcome(self.state.id.clone(), id));
            self.places.extend(outer.map(|t| (path.clone(), Part::Transition(t.id))));
        }
    }

    fn port(&mut self, kind: PortKind, id: PortId) {
        self.here(Part::State);
        self.here(Part::Port(kind, id));
        self.here(Part::RuntimeValue(kind, id));
        if let Some(container) = self.state.container() {
            let inner = flows_at(container, &self.state.id, id);
            self.places.extend(inner.map(|part| (self.at.clone(), part)));
        }
        if let Some((path, container)) = self.parent() {
            let outer = flows_at(container, &self.state.id, id);
            self.places.extend(outer.map(|part| (path.clone(), part)));
        }
    }
}

/// Other elements with the name of this one.
fn named<'s, T: Element<Id: PartialEq> + 's>(
    list: &'s Elements<T>,
    one: &'s T,
) -> impl Iterator<Item = &'s T> {
    list.iter().filter(|other| other.name() == one.name() && other.id() != one.id())
}

/// The transitions and data flows that begin or end at a state.
fn connections_of(container: &Container, id: &StateId) -> impl Iterator<Item = Part> {
    let Container { transitions, data_flows, .. } = container;
    let transitions = transitions.into_state(id).chain(transitions.out_of_state(id));
    let flows = data_flows.into_state(id).chain(data_flows.out_of_state(id));
    transitions.map(|t| Part::Transition(t.id)).chain(flows.map(|f| Part::DataFlow(f.id)))
}

/// The data flows that begin or end at a port.
fn flows_at(container: &Container, id: &StateId, port: PortId) -> impl Iterator<Item = Part> {
    let flows = &container.data_flows;
    let flows = flows.into_port(id, port).chain(flows.out_of_port(id, port));
    flows.map(|flow| Part::DataFlow(flow.id))
}

/// Finds many states of one machine in sequence: keeps the path to the last one, and walks only the difference.
pub(super) struct Walk<'m> {
    machine: &'m Machine,
    way: Vec<&'m State>,
}

impl<'m> Walk<'m> {
    pub(super) fn new(machine: &'m Machine) -> Self {
        Self { machine, way: Vec::new() }
    }

    /// The state at the path `ids` and its parent. Does not search libraries.
    pub(super) fn find(&mut self, ids: &[StateId]) -> Option<(Option<&'m State>, &'m State)> {
        let known = self.way.iter().zip(ids).take_while(|(state, id)| state.id == **id).count();
        self.way.truncate(known);
        for id in ids.get(known..)? {
            let next: &State = match self.way.last() {
                Some(state) => state.container()?.states.get(id)?,
                None => Some(&*self.machine.root).filter(|root| root.id == *id)?,
            };
            self.way.push(next);
        }
        let (state, above) = self.way.split_last()?;
        Some((above.last().copied(), state))
    }
}

#[cfg(test)]
mod tests {
    use super::Walk;
    use crate::{Container, Header, Kind, Machine, State, StateId, StatePath};
    use std::sync::Arc;

    fn state(id: &str, children: Vec<State>) -> State {
        let states = children.into_iter().map(|child| (child.id.clone(), Arc::new(child)));
        let inside = Container { states: states.collect(), ..Container::default() };
        State::new(StateId::new(id), id, Kind::Hierarchy(inside))
    }

    #[test]
    fn it_finds_what_is_there_in_any_order() {
        let inner = state("B", vec![state("C", vec![])]);
        let root = Arc::new(state("A", vec![inner, state("D", vec![])]));
        let machine = Machine { header: Header::default(), root };
        let mut walk = Walk::new(&machine);
        for path in ["A/B/C", "A/B", "A/D", "A/X", "A/B/C", "X", "A", "A/D/X", "", "A/B/C"] {
            let ids = StatePath::parse(path);
            let found = walk.find(&ids.0).map(|(_, state)| &state.id);
            assert_eq!(found, machine.state(&ids).map(|state| &state.id), "{path}");
            let parent = walk.find(&ids.0).and_then(|(parent, _)| parent);
            let above = ids.parent().and_then(|path| machine.state(&path));
            assert_eq!(parent.map(|p| &p.id), above.filter(|_| found.is_some()).map(|s| &s.id));
        }
    }
}
