//! The order of states in a container for readers: as they run.

use rafcon_model::{Container, DECIDER_ID, OutcomeId, State, StateId, Target};
use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;

/// The children in execution order from the start, then unreachable ones, a decider last.
pub(super) fn children<'c>(inside: &'c Container, id: &StateId) -> Vec<&'c Arc<State>> {
    let mut seen = BTreeSet::new();
    let mut ordered = Vec::new();
    let mut open: VecDeque<StateId> = VecDeque::new();
    open.extend(start(inside, id));
    while let Some(next) = open.pop_front() {
        let Some(state) = inside.states.get(&next).filter(|_| seen.insert(next.clone())) else {
            continue;
        };
        ordered.push(state);
        let targets = exits(inside, id, state).into_iter().filter_map(|(_, target)| target);
        open.extend(targets.filter_map(|target| match target {
            Target::State(state) => Some(state),
            Target::Outcome(_) => None,
        }));
    }
    let rest = inside.states.values().filter(|state| !seen.contains(&state.id));
    ordered.extend(rest);
    ordered.sort_by_key(|state| state.id.as_str() == DECIDER_ID);
    ordered
}

/// The child at which a container begins; `None` if it begins elsewhere.
pub(super) fn start(inside: &Container, id: &StateId) -> Option<StateId> {
    match inside.start(id)? {
        Target::State(state) => Some(state),
        Target::Outcome(_) => None,
    }
}

/// Targets of the outcomes of a child; the user's outcomes first, by id.
pub(super) fn exits(
    inside: &Container,
    id: &StateId,
    state: &State,
) -> Vec<(OutcomeId, Option<Target>)> {
    let mut outcomes: Vec<OutcomeId> = state.outcomes.iter().map(|outcome| outcome.id).collect();
    outcomes.sort_by_key(|outcome| (outcome.is_mandatory(), *outcome));
    let target = |outcome: OutcomeId| {
        let origin = rafcon_model::Origin::Outcome(state.id.clone(), outcome);
        inside.transitions.from(&origin).next().and_then(|transition| transition.target(id))
    };
    outcomes.into_iter().map(|outcome| (outcome, target(outcome))).collect()
}
