//! The state of a plan's step: its library state with values, inside a state that recovers from failures.

use super::values;
use super::wiring::{Draft, Ids, SUCCESS, Sized, script};
use super::{Build, BuildError};
use crate::plan::spelling;
use crate::skill::{Recovery, Skill, Then, done};
use rafcon_model::{
    DataType, Kind, Library, LibraryContent, OutcomeId, Port, PortId, RuntimeValues, State,
    StateId, Target, Value,
};
use smol_str::SmolStr;
use std::sync::Arc;

const COUNT_TRIES: &str = include_str!("scripts/count_tries.py");
const ASK: &str = include_str!("scripts/ask.py");

/// The display name of a step.
pub(super) fn title(build: &Build<'_>, skill: &Skill, step: usize) -> String {
    let objects = build.plan.steps[step].objects.iter();
    let objects: Vec<_> = objects.map(|name| spelling(name, &build.task.problem.objects)).collect();
    let text = format!("{} {}", skill.title, objects.join(" ")).replace('/', "-");
    text.trim().to_owned()
}

/// Creates a library state for this library.
pub(super) fn library(
    id: StateId,
    name: &str,
    library: &SmolStr,
    root: &Arc<State>,
    inputs: RuntimeValues,
) -> State {
    let (path, library_name) = library.rsplit_once('/').unwrap_or(("", library));
    let outputs = root.outputs.iter().map(|port| {
        (port.id, rafcon_model::RuntimeValue { value: port.default.clone(), used: false })
    });
    let kind = Kind::Library(Library {
        path: path.into(),
        name: library_name.into(),
        version: None,
        inputs,
        outputs: outputs.collect(),
        content: LibraryContent::Found(root.clone()),
    });
    let mut state = State::new(id, name, kind);
    state.inputs = root.inputs.clone();
    state.outputs = root.outputs.clone();
    state.outcomes = root.outcomes.clone();
    state
}

/// The state of a step, and the outcome that means success.
pub(super) fn state(
    build: &Build<'_>,
    ids: &mut Ids,
    index: usize,
) -> Result<(Sized, OutcomeId), BuildError> {
    let step = &build.plan.steps[index];
    let skill =
        build.pool.skill(&step.action).ok_or_else(|| BuildError::NoSkill(step.action.clone()))?;
    let recovery = skill.recovery.unwrap_or(build.recovery);
    let name = title(build, skill, index);
    let inputs = values::of(skill, &skill.library, &skill.root, step, build)?;
    let own = Sized::leaf(library(ids.next(), &name, &skill.library, &skill.root, inputs));
    let own_done = skill.done().map_or(SUCCESS, |outcome| outcome.id);
    let check = match &skill.check {
        Some(check) => {
            let root = (build.library)(check)
                .map_err(|reason| BuildError::NoLibrary { library: check.clone(), reason })?;
            let inputs = values::of(skill, check, &root, step, build)?;
            Some((
                library(ids.next(), &format!("Check before {name}"), check, &root, inputs),
                done(&root).map_or(SUCCESS, |outcome| outcome.id),
            ))
        }
        None => None,
    };
    if check.is_none() && recovery.retries == 0 && recovery.then != Then::Ask {
        return Ok((own, own_done));
    }
    let own = NamedStep { name: &name, body: own, done: own_done };
    Ok((recovered(ids, own, check, recovery), SUCCESS))
}

/// The state of a step, without its recovery.
struct NamedStep<'n> {
    name: &'n str,
    body: Sized,
    /// The outcome that means success.
    done: OutcomeId,
}

/// A hierarchy around a step that checks first, retries and asks.
fn recovered(
    ids: &mut Ids,
    step: NamedStep<'_>,
    check: Option<(State, OutcomeId)>,
    recovery: Recovery,
) -> Sized {
    let NamedStep { name, body, done: own_done } = step;
    let mut draft = Draft::new(ids.next());
    let check = check.map(|(state, holds)| (draft.add(Sized::leaf(state)), holds));
    let own = draft.add(body);
    let first = check.as_ref().map_or(&own, |(check, _)| check).clone();
    draft.start(&first);
    draft.line((&own, own_done), Target::Outcome(SUCCESS));
    let mut last = Target::Outcome(OutcomeId::ABORTED);
    if recovery.then == Then::Ask {
        let mut state = script(ids.next(), "Ask", ASK, &["again", "done", "give up"]);
        state.inputs.insert(Port::new(PortId(0), "step", DataType::Str, Value::str(name)));
        let ask = draft.add(Sized::leaf(state));
        draft.line((&ask, OutcomeId(0)), Target::State(first.clone()));
        draft.line((&ask, OutcomeId(1)), Target::Outcome(SUCCESS));
        draft.line((&ask, OutcomeId(2)), Target::Outcome(OutcomeId::ABORTED));
        draft.line((&ask, OutcomeId::ABORTED), Target::Outcome(OutcomeId::ABORTED));
        last = Target::State(ask);
    }
    if let Some((check, holds)) = &check {
        draft.line((check, *holds), Target::State(own.clone()));
        draft.failures(check, *holds, &last);
    }
    let counts = recovery.retries > 0;
    if counts {
        let again = draft.add(Sized::leaf(counter(ids, recovery.retries)));
        draft.failures(&own, own_done, &Target::State(again.clone()));
        draft.line((&again, OutcomeId(0)), Target::State(first));
        draft.line((&again, OutcomeId(1)), last);
        draft.line((&again, OutcomeId::ABORTED), Target::Outcome(OutcomeId::ABORTED));
        let tries = draft.id.clone();
        draft.flow((&tries, PortId(0)), (&again, PortId(0)));
        draft.flow((&again, PortId(2)), (&tries, PortId(0)));
    } else {
        draft.failures(&own, own_done, &last);
    }
    let mut finished = draft.finish(name, Kind::Hierarchy, &["success"]);
    if let Some(container) = finished.state.container_mut().filter(|_| counts) {
        container.scoped_variables.insert(Port::new(
            PortId(0),
            "tries",
            DataType::Int,
            Value::Int(0),
        ));
    }
    finished
}

fn counter(ids: &mut Ids, retries: u32) -> State {
    let mut state = script(ids.next(), "Try again", COUNT_TRIES, &["again", "over"]);
    state.inputs.insert(Port::new(PortId(0), "tries", DataType::Int, Value::Int(0)));
    state.inputs.insert(Port::new(PortId(1), "retries", DataType::Int, Value::Int(retries.into())));
    state.outputs.insert(Port::new(PortId(2), "tries", DataType::Int, Value::Int(0)));
    state
}
