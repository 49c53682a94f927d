//! Edits that add, remove and start children.

use super::error::EditError;
use super::plan::{container_at, disconnect, nesting};
use super::step::{Set, Step};
use super::{ChildrenEdit, group, kind, selection, substitute, ungroup};
use crate::problems::refusal;
use crate::rules::{Part, Rule};
use crate::{
    Container, DECIDER_ID, Kind, Machine, Origin, OutcomeId, State, StateId, StatePath, Target,
    Transition, TransitionId, Types,
};
use std::sync::Arc;

pub(super) fn plan(
    machine: &Machine,
    path: &StatePath,
    edit: ChildrenEdit,
    types: &dyn Types,
) -> Result<Vec<Step>, EditError> {
    let here = container_at(machine, path)?;
    match edit {
        ChildrenEdit::Add(state) => add(path, here.0, state, types),
        ChildrenEdit::Remove(id) => remove(path, here.1, &id),
        ChildrenEdit::SetStart(target) => Ok(set_start(path, here.0, here.1, target)),
        ChildrenEdit::Group { states, scoped_variables, id, name } => group::plan(
            path,
            here,
            &states,
            &scoped_variables,
            State::new(id, name, Kind::Hierarchy(Container::default())),
        ),
        ChildrenEdit::Ungroup { state, fresh } => ungroup::plan(path, here, &state, fresh),
        ChildrenEdit::Substitute { state, by } => substitute::plan(path, here, &state, by, types),
        ChildrenEdit::Move { states, to, ids } => {
            selection::plan_move(machine, path, &states, &to, ids)
        }
        ChildrenEdit::Paste { selection, ids } => {
            selection::plan_paste(path, here.0, selection, ids, Some(types))
        }
    }
}

fn add(
    path: &StatePath,
    parent: &State,
    state: Arc<State>,
    types: &dyn Types,
) -> Result<Vec<Step>, EditError> {
    let place = path.child(state.id.clone());
    if parent.container().is_some_and(|c| c.states.contains_key(&state.id)) {
        return Err(EditError::taken(&place, Part::State));
    }
    let state = complete(state);
    whole(path, parent, &state, types)?;
    let outcomes: Vec<_> = state.outcomes.iter().map(|outcome| outcome.id).collect();
    let ids = parent.container().into_iter().flat_map(|c| c.transitions.free_ids());
    let arrows = to_decider(path, parent, &state.id, &outcomes, ids);
    let child = Step::new(path, Set::Child(state.id.clone(), Some(state)));
    Ok(std::iter::once(child).chain(arrows).collect())
}

/// A new barrier gets a decider.
pub(super) fn complete(mut state: Arc<State>) -> Arc<State> {
    let decider = StateId::new(DECIDER_ID);
    if let Kind::Barrier(container) = &state.kind
        && !container.states.contains_key(&decider)
    {
        let container = kind::with_decider(container.clone());
        Arc::make_mut(&mut state).kind = Kind::Barrier(container);
    }
    state
}

/// Refuses a new state that contains faults or is too deep.
pub(super) fn whole(
    path: &StatePath,
    parent: &State,
    state: &State,
    types: &dyn Types,
) -> Result<(), EditError> {
    nesting(path, state)?;
    match refusal(parent, &path.child(state.id.clone()), state, types) {
        Some(problem) => Err(problem.into()),
        None => Ok(()),
    }
}

/// In a barrier, the automatic transitions from the outcomes of a child.
pub(super) fn to_decider(
    path: &StatePath,
    parent: &State,
    child: &StateId,
    outcomes: &[OutcomeId],
    ids: impl Iterator<Item = TransitionId>,
) -> Vec<Step> {
    let decider = StateId::new(DECIDER_ID);
    let Kind::Barrier(container) = &parent.kind else { return Vec::new() };
    if *child == decider || !container.states.contains_key(&decider) {
        return Vec::new();
    }
    let outcomes = outcomes.iter().filter(|outcome| outcome.0 >= 0);
    let transition = |(outcome, id): (&OutcomeId, TransitionId)| {
        let from = Origin::Outcome(child.clone(), *outcome);
        let to = Target::State(decider.clone());
        Step::new(path, Set::Transition(id, Some(Transition::new(id, from, to, &parent.id))))
    };
    outcomes.zip(ids).map(transition).collect()
}

fn remove(path: &StatePath, container: &Container, id: &StateId) -> Result<Vec<Step>, EditError> {
    removable(path, container, id)?;
    let mut steps = disconnect(path, container, id);
    steps.push(Step::new(path, Set::Child(id.clone(), None)));
    Ok(steps)
}

/// The child, if it exists and may leave its container.
pub(super) fn removable<'c>(
    path: &StatePath,
    container: &'c Container,
    id: &StateId,
) -> Result<&'c Arc<State>, EditError> {
    let place = || path.child(id.clone());
    let child = container.states.get(id);
    let child = child.ok_or_else(|| EditError::no_such_state(&place()))?;
    if matches!(child.kind, Kind::Decider(_)) {
        let what = "it is the decider of a barrier";
        return Err(EditError::state(&place(), Rule::DeciderFixed, what));
    }
    Ok(child)
}

fn set_start(
    path: &StatePath,
    state: &State,
    container: &Container,
    target: Option<Target>,
) -> Vec<Step> {
    let mut earlier = container.transitions.from(&Origin::Income);
    let set = |id, transition| Step::new(path, Set::Transition(id, transition));
    let mut steps = Vec::new();
    if let Some(target) = target {
        let transition = earlier.next().cloned().unwrap_or_else(|| {
            let id = container.transitions.next_id();
            Transition::new(id, Origin::Income, target.clone(), &state.id)
        });
        let transition = transition.with_target(target, &state.id);
        steps.push(set(transition.id, Some(transition)));
    }
    steps.extend(earlier.map(|start| set(start.id, None)));
    steps
}
