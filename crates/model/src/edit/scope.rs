//! Which parts of a machine a step can break: those that it changes and those that are connected with them.

use super::step::{Field, Set, Step};
use crate::rules::{Part, parts};
use crate::{Container, Machine, Origin, OutcomeId, PortId, PortKind, State, StateId, StatePath};

/// A part of a state somewhere in the machine.
pub(super) type Place = (StatePath, Part);

/// The parts to look at, as the machine is now: called before and after the step.
pub(super) fn scope(step: &Step, machine: &Machine) -> Vec<Place> {
    let Some(state) = machine.state(&step.at) else { return Vec::new() };
    let mut scope = Scope { machine, at: &step.at, state, places: Vec::new() };
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
    machine: &'m Machine,
    at: &'m StatePath,
    state: &'m State,
    places: Vec<Place>,
}

impl<'m> Scope<'m> {
    fn here(&mut self, part: Part) {
        self.places.push((self.at.clone(), part));
    }

    fn child(&mut self, id: &StateId) {
        self.here(Part::State);
        self.places.push((self.at.child(id.clone()), Part::State));
        let Some(container) = self.state.container() else { return };
        let connections = connections_of(container, id);
        self.places.extend(connections.map(|part| (self.at.clone(), part)));
    }

    /// The path and inside of the parent.
    fn parent(&self) -> Option<(StatePath, &'m Container)> {
        let path = self.at.parent()?;
        let container = self.machine.state(&path)?.container()?;
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
