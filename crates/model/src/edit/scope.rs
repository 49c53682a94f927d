//! Which parts of a machine a step can break: those that it changes and those that are connected with them.

use super::step::{Field, Set, Step};
use super::walk::Walk;
use crate::port::{Element, Elements};
use crate::rules::{Part, parts};
use crate::{
    Container, DataFlowId, Origin, OutcomeId, PortId, PortKind, State, StateId, StatePath,
    Transition, TransitionId,
};

/// A part of a state somewhere in the machine.
pub(super) type Place = (StatePath, Part);

/// The parts to look at before the step: also those that break a rule only together with a changed one.
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

/// The parts to look at after the step, given what takes it back.
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

    /// Data flows between the same ports.
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

    /// The connections of a child, which are the same before it comes and after.
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

    /// Outcomes with the same name.
    fn outcome_twins(&mut self, id: OutcomeId) {
        let outcomes = &self.state.outcomes;
        let twins = outcomes.get(id).into_iter().flat_map(|outcome| named(outcomes, outcome));
        self.places.extend(twins.map(|twin| (self.at.clone(), Part::Outcome(twin.id))));
    }

    /// Ports with the same name or id.
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

/// The other elements with the same name.
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
