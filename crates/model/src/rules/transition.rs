//! Rules about transitions.

use super::{Fault, Rule};
use crate::{Container, Kind, Origin, OutcomeId, State, StateId, Target, Transition, TransitionId};

pub(super) fn faults(state: &State, id: TransitionId) -> Vec<Fault> {
    let Some(container) = state.container() else { return Vec::new() };
    let Some(transition) = container.transitions.get(id) else { return Vec::new() };
    [
        origin_fault(state, container, transition),
        twin_fault(state, container, transition),
        target_fault(state, container, transition),
        kind_fault(state, transition),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn origin_fault(state: &State, container: &Container, transition: &Transition) -> Option<Fault> {
    let (from, outcome) = match transition.origin() {
        Some(Origin::Outcome(from, outcome)) => (from, outcome),
        Some(Origin::Income) => return start_fault(state),
        None => {
            let what = match &transition.from_state {
                Some(from) => format!("it begins at the state {from} but at none of its outcomes"),
                None => "it begins at an outcome but at no state".to_owned(),
            };
            return Some(Fault::new(Rule::OriginIncomplete, what));
        }
    };
    if from == state.id {
        return Some(Fault::new(Rule::OriginContainer, "it begins at the container itself"));
    }
    let Some(child) = container.states.get(&from) else {
        let what = format!("it begins at {from}, which does not exist");
        return Some(Fault::new(Rule::OriginState, what));
    };
    let what = || format!("it begins at the outcome {outcome} of {from}, which does not exist");
    let missing = child.outcomes.get(outcome).is_none();
    missing.then(|| Fault::new(Rule::OriginOutcome, what()))
}

/// Another transition with this origin.
fn twin_fault(state: &State, container: &Container, transition: &Transition) -> Option<Fault> {
    let origin = transition.origin()?;
    let other = container.transitions.from(&origin).find(|other| other.id != transition.id)?;
    let (rule, place) = match &origin {
        Origin::Income => (Rule::StartTwice, "the income".to_owned()),
        Origin::Outcome(from, id) => {
            let owner = container.states.get(from).map_or(state, |child| child);
            let name = owner.outcomes.get(*id).map(|outcome| &outcome.name);
            let name = name.map_or_else(|| id.to_string(), |name| format!("`{name}`"));
            (Rule::OriginTwice, format!("the outcome {name} of {from}"))
        }
    };
    let what = format!("the transition {} begins at {place}, too", other.id);
    Some(Fault::new(rule, what))
}

fn start_fault(state: &State) -> Option<Fault> {
    let what = || format!("it begins at the income of a {} state", state.kind.name());
    let concurrent = matches!(state.kind, Kind::Barrier(_) | Kind::Preemptive(_));
    concurrent.then(|| Fault::new(Rule::StartInConcurrency, what()))
}

fn target_fault(state: &State, container: &Container, transition: &Transition) -> Option<Fault> {
    let Some(to) = &transition.to_state else {
        return Some(Fault::new(Rule::TargetMissing, "it leads nowhere"));
    };
    match transition.to_outcome {
        Some(outcome) if *to == state.id => own_outcome_fault(state, outcome),
        None if *to == state.id => {
            let what = "it leads to the container but to none of its outcomes";
            Some(Fault::new(Rule::TargetIncomplete, what))
        }
        _ if !container.states.contains_key(to) => {
            Some(Fault::new(Rule::TargetState, format!("it leads to {to}, which does not exist")))
        }
        Some(outcome) => {
            let what = format!("it leads to the outcome {outcome} of the child {to}");
            Some(Fault::new(Rule::TargetOutcomeOfChild, what))
        }
        None => None,
    }
}

fn own_outcome_fault(state: &State, outcome: OutcomeId) -> Option<Fault> {
    let what =
        || format!("it leads to the outcome {outcome} of the container, which does not exist");
    state.outcomes.get(outcome).is_none().then(|| Fault::new(Rule::TargetOutcome, what()))
}

/// The rules of concurrency states.
fn kind_fault(state: &State, transition: &Transition) -> Option<Fault> {
    let from = transition.from_state.as_ref()?;
    let target = transition.target(&state.id)?;
    match &state.kind {
        Kind::Preemptive(_) => {
            let what = "it leads to a child of a preemptive concurrency state";
            is_child(&target).then(|| Fault::new(Rule::PreemptiveTarget, what))
        }
        Kind::Barrier(_) if from.is_decider() => {
            let what = "it leads from the decider to a child";
            is_child(&target).then(|| Fault::new(Rule::DeciderTarget, what))
        }
        Kind::Barrier(_) => barrier_fault(from, transition.from_outcome, &target),
        Kind::Hierarchy(_) | Kind::Execution(_) | Kind::Decider(_) | Kind::Library(_) => None,
    }
}

fn is_child(target: &Target) -> bool {
    matches!(target, Target::State(_))
}

fn barrier_fault(from: &StateId, outcome: Option<OutcomeId>, target: &Target) -> Option<Fault> {
    let allowed = match target {
        Target::State(to) => to.is_decider(),
        Target::Outcome(to) => to.is_mandatory() && outcome.is_some_and(OutcomeId::is_mandatory),
    };
    let what = || format!("it leads from the child {from} of a barrier past the decider");
    (!allowed).then(|| Fault::new(Rule::BarrierTarget, what()))
}
