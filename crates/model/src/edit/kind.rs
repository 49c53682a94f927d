//! Change of a state's kind.

use super::error::EditError;
use super::step::{Set, Step};
use crate::rules::Rule;
use crate::{
    Container, DECIDER_ID, Kind, KindName, Outcome, OutcomeId, Script, State, StateId, StatePath,
    Transitions,
};
use std::sync::Arc;

pub(super) fn plan(
    path: &StatePath,
    state: &State,
    name: KindName,
) -> Result<Vec<Step>, EditError> {
    let refuse = |rule, what: &str| Err(EditError::state(path, rule, what));
    match (state.kind.name(), name) {
        (from, to) if from == to => return Ok(Vec::new()),
        (KindName::Decider, _) => {
            return refuse(Rule::DeciderFixed, "it is the decider of a barrier");
        }
        (_, KindName::Decider) => {
            return refuse(Rule::DeciderMisplaced, "only the decider of a barrier is a decider");
        }
        (_, KindName::Library) => {
            return refuse(Rule::WrongKind, "a library state is put in the place of another state");
        }
        (KindName::Library, _) => {
            return refuse(Rule::LibraryFixed, "its content is in a library");
        }
        _ => {}
    }
    let kind = match name {
        KindName::Hierarchy => Kind::Hierarchy(inside(state)),
        KindName::Preemptive => Kind::Preemptive(inside(state)),
        KindName::Barrier => Kind::Barrier(with_decider(inside(state))),
        KindName::Execution | KindName::Decider | KindName::Library => {
            Kind::Execution(Script::default())
        }
    };
    Ok(vec![Step::new(path, Set::Kind(Box::new(kind)))])
}

/// The inside that remains: everything but transitions and a decider.
fn inside(state: &State) -> Container {
    let Some(container) = state.container() else { return Container::default() };
    let mut container = Container { transitions: Transitions::default(), ..container.clone() };
    if let Kind::Barrier(_) = state.kind {
        let decider = StateId::new(DECIDER_ID);
        container.states.remove(&decider);
        let flows = &container.data_flows;
        let flows = flows.into_state(&decider).chain(flows.out_of_state(&decider));
        let flows: Vec<_> = flows.map(|flow| flow.id).collect();
        for id in flows {
            container.data_flows.remove(id);
        }
    }
    container
}

/// The container with a new decider if it has none.
pub(super) fn with_decider(mut container: Container) -> Container {
    let id = StateId::new(DECIDER_ID);
    if !container.states.contains_key(&id) {
        let mut decider = State::new(id.clone(), "Decider", Kind::Decider(Script::default()));
        decider.outcomes.insert(Outcome::new(OutcomeId(0), "success"));
        container.states.insert(id, Arc::new(decider));
    }
    container
}
