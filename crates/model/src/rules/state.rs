//! Rules about a state as a whole.

use super::{Fault, Rule, library, lost_link};
use crate::{DECIDER_ID, Json, Kind, Origin, OutcomeId, State, StateId};

/// The maximum nesting of states, including the root.
pub const MAX_NESTING: usize = 1024;

pub(super) fn faults(parent: Option<&State>, state: &State) -> Vec<Fault> {
    let mut faults = Vec::new();
    faults.extend(name_fault(&state.name));
    faults.extend(id_fault(parent, &state.id));
    for (id, name) in [(OutcomeId::ABORTED, "aborted"), (OutcomeId::PREEMPTED, "preempted")] {
        if state.outcomes.get(id).is_none() {
            let what = format!("the outcome {name} ({id}) is missing");
            faults.push(Fault::new(Rule::OutcomeMissing, what));
        }
    }
    if state.semantic_data.as_deref().is_some_and(|data| !matches!(data, Json::Object(_))) {
        faults.push(Fault::new(Rule::SemanticData, "the semantic data is not a dictionary"));
    }
    faults.extend(lost_link::faults(parent, state));
    faults.extend(decider_fault(parent, state));
    if state.damage.is_none() {
        kind_faults(state, &mut faults);
    }
    faults
}

fn name_fault(name: &str) -> Option<Fault> {
    if name.is_empty() {
        return Some(Fault::new(Rule::StateName, "the name is empty"));
    }
    let what = || format!("the name `{name}` contains a `/`");
    name.contains('/').then(|| Fault::new(Rule::StateNameSlash, what()))
}

fn id_fault(parent: Option<&State>, id: &StateId) -> Option<Fault> {
    let is_forbidden = |letter: char| letter == '/' || letter.is_control();
    if id.as_str().is_empty() || id.as_str().contains(is_forbidden) {
        let shown = id.as_str().escape_debug();
        let what = format!("the id `{shown}` is empty or contains a `/` or a control character");
        return Some(Fault::new(Rule::StateId, what));
    }
    let what = || format!("its parent has the id {id}, too");
    let parent = parent.filter(|parent| parent.id == *id && parent.container().is_some());
    parent.map(|_| Fault::new(Rule::StateIdOfParent, what()))
}

fn decider_fault(parent: Option<&State>, state: &State) -> Option<Fault> {
    let is_decider = matches!(state.kind, Kind::Decider(_));
    let in_barrier = parent.is_some_and(|parent| matches!(parent.kind, Kind::Barrier(_)));
    let what = match (is_decider, state.id.is_decider(), in_barrier) {
        (false, false, _) | (true, true, true) => return None,
        (true, _, false) => "a decider is outside of a barrier".to_owned(),
        (true, false, true) => format!("a decider has the id {DECIDER_ID}"),
        (false, true, _) => format!("the id {DECIDER_ID} is that of a decider"),
    };
    Some(Fault::new(Rule::DeciderMisplaced, what))
}

fn kind_faults(state: &State, faults: &mut Vec<Fault>) {
    match &state.kind {
        Kind::Execution(script) | Kind::Decider(script) => {
            if script.text.is_none() {
                faults.push(Fault::new(Rule::ScriptMissing, "there is no script"));
            }
        }
        Kind::Hierarchy(container) => {
            let has_start = container.transitions.from(&Origin::Income).next().is_some();
            if container.states.is_empty() && !has_start {
                faults.push(Fault::new(Rule::ChildrenMissing, "no state is in it"));
            } else if !has_start {
                faults.push(Fault::new(Rule::StartMissing, "no child is where it starts"));
            }
        }
        Kind::Barrier(container) => {
            if !container.states.contains_key(&StateId::new(DECIDER_ID)) {
                faults.push(Fault::new(Rule::DeciderMissing, "the barrier has no decider"));
            }
        }
        Kind::Preemptive(container) => {
            if container.states.is_empty() {
                faults.push(Fault::new(Rule::ChildrenMissing, "no state is in it"));
            }
        }
        Kind::Library(library) => library::faults(state, library, faults),
    }
}
