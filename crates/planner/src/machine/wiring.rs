//! Containers under construction: children, transitions, data flows and layout.

use super::layout::{self, Size};
use rafcon_model::{
    Container, DataFlow, DataFlowId, Fresh, Kind, Origin, Outcome, OutcomeId, PortId, Script,
    State, StateId, Target, Transition, TransitionId,
};
use std::sync::Arc;

/// The outcome *success* of all states created here.
pub(super) const SUCCESS: OutcomeId = OutcomeId(0);

/// A source of unique state ids.
#[derive(Debug)]
pub(super) struct Ids {
    fresh: Fresh,
    used: std::collections::BTreeSet<StateId>,
}

impl Ids {
    pub(super) fn new(seed: u64) -> Self {
        Self { fresh: Fresh::new(seed), used: std::collections::BTreeSet::new() }
    }

    pub(super) fn next(&mut self) -> StateId {
        let id = self.fresh.id(|id| self.used.contains(id));
        self.used.insert(id.clone());
        id
    }
}

/// A state with its size on the screen.
#[derive(Debug)]
pub(super) struct Sized {
    pub(super) state: State,
    pub(super) size: Size,
}

impl Sized {
    pub(super) fn leaf(state: State) -> Self {
        Self { state, size: layout::LEAF }
    }
}

/// A container under construction.
#[derive(Debug)]
pub(super) struct Draft {
    pub(super) id: StateId,
    children: Vec<Sized>,
    lines: Vec<(Origin, Target)>,
    flows: Vec<((StateId, PortId), (StateId, PortId))>,
}

impl Draft {
    pub(super) fn new(id: StateId) -> Self {
        Self { id, children: Vec::new(), lines: Vec::new(), flows: Vec::new() }
    }

    /// Adds a child and returns its id.
    pub(super) fn add(&mut self, child: Sized) -> StateId {
        let id = child.state.id.clone();
        self.children.push(child);
        id
    }

    /// Makes this child the start of the container.
    pub(super) fn start(&mut self, child: &StateId) {
        self.lines.push((Origin::Income, Target::State(child.clone())));
    }

    /// Adds a transition from an outcome of a child.
    pub(super) fn line(&mut self, from: (&StateId, OutcomeId), to: Target) {
        self.lines.push((Origin::Outcome(from.0.clone(), from.1), to));
    }

    /// Connects all outcomes of a child except `done` and *preempted* to `to`.
    pub(super) fn failures(&mut self, state: &StateId, done: OutcomeId, to: &Target) {
        let Some(child) = self.children.iter().find(|child| child.state.id == *state) else {
            return;
        };
        let ids: Vec<_> = child.state.outcomes.iter().map(|outcome| outcome.id).collect();
        for id in ids.into_iter().filter(|id| *id != done && *id != OutcomeId::PREEMPTED) {
            self.line((state, id), to.clone());
        }
    }

    pub(super) fn flow(&mut self, from: (&StateId, PortId), to: (&StateId, PortId)) {
        self.flows.push(((from.0.clone(), from.1), (to.0.clone(), to.1)));
    }

    /// Builds the container and lays out its children.
    pub(super) fn finish(
        self,
        name: &str,
        kind: fn(Container) -> Kind,
        outcomes: &[&str],
    ) -> Sized {
        let mut container = Container::default();
        let sizes: Vec<Size> = self.children.iter().map(|child| child.size).collect();
        let (places, size) = layout::arrange(&sizes);
        for (child, place) in self.children.into_iter().zip(places) {
            let mut state = child.state;
            state.layout = layout::entry(place, child.size, state.container().is_some());
            container.states.insert(state.id.clone(), Arc::new(state));
        }
        for (id, (origin, target)) in (1..).zip(self.lines) {
            container.transitions.insert(Transition::new(
                TransitionId(id),
                origin,
                target,
                &self.id,
            ));
        }
        for (id, (from, to)) in (1..).zip(self.flows) {
            container.data_flows.insert(DataFlow::new(DataFlowId(id), from, to));
        }
        let state = with_outcomes(State::new(self.id, name, kind(container)), outcomes);
        Sized { state, size }
    }
}

/// Adds outcomes to a state, with ids from 0.
pub(super) fn with_outcomes(mut state: State, names: &[&str]) -> State {
    let own = (0..).zip(names).map(|(id, name)| Outcome::new(OutcomeId(id), name));
    state.outcomes = state.outcomes.iter().cloned().chain(own).collect();
    state
}

/// Creates an execution state with a script.
pub(super) fn script(id: StateId, name: &str, text: &str, outcomes: &[&str]) -> State {
    with_outcomes(
        State::new(id, name, Kind::Execution(Script { text: Some(text.into()) })),
        outcomes,
    )
}
