//! Random edits of a machine, most of them legal.

use super::machine::{INPUT, OUTCOMES, OUTPUT};
use super::places::{paths, state_at_mut};
use crate::random::Random;
use rafcon_model::edit::{ChildrenEdit, DataFlowEdit, Edit, OutcomeEdit, PortEdit, StateEdit};
use rafcon_model::edit::{TransitionEdit, apply};
use rafcon_model::{
    BuiltinTypes, Container, DataFlowId, DataType, Kind, KindName, Library, LibraryContent,
    Machine, Origin, Outcome, OutcomeId, Port, PortId, PortKind, Script, State, StateId, StatePath,
    Target, TransitionId, Value,
};
use std::sync::Arc;

/// The machine after one or a few random edits; `None` if none of them was legal.
pub(crate) fn edited(machine: &Machine, random: &mut Random, fresh: &mut u32) -> Option<Machine> {
    let mut edited = machine.clone();
    let mut changed = false;
    for _ in 0..=random.below(3) {
        if let Some(edit) = edit(&edited, random, fresh) {
            changed |= apply(&mut edited, edit, &BuiltinTypes).is_ok();
        }
    }
    changed.then_some(edited)
}

/// The machine after a library was reloaded in another version, lost, or replaced.
pub(crate) fn reloaded(machine: &Machine, random: &mut Random, fresh: &mut u32) -> Option<Machine> {
    let mut libraries = paths(machine);
    libraries.retain(|path| library_at(machine, path).is_some());
    let (path, other) = (random.pick(&libraries)?, random.pick(&libraries)?);
    let found = |path| match &library_at(machine, path)?.content {
        LibraryContent::Found(root) => Some(root.clone()),
        LibraryContent::Missing { .. } => None,
    };
    let content = match random.below(6) {
        0 => LibraryContent::Missing { reason: "it is gone".into() },
        1 | 2 if !path.0.starts_with(&other.0) && !other.0.starts_with(&path.0) => {
            LibraryContent::Found(found(&other)?)
        }
        _ => {
            let own = Machine { root: found(&path)?, ..machine.clone() };
            LibraryContent::Found(edited(&own, random, fresh)?.root)
        }
    };
    let mut reloaded = machine.clone();
    if let Kind::Library(library) = &mut state_at_mut(&mut reloaded, &path)?.kind {
        library.content = content;
    }
    Some(reloaded)
}

fn library_at<'m>(machine: &'m Machine, path: &StatePath) -> Option<&'m Library> {
    match &machine.state(path)?.kind {
        Kind::Library(library) => Some(library),
        _ => None,
    }
}

fn edit(machine: &Machine, random: &mut Random, fresh: &mut u32) -> Option<Edit> {
    let editable = paths(machine).into_iter().filter(|path| machine.state(path).is_some());
    let path = random.pick(&editable.collect::<Vec<_>>())?;
    let state = machine.state(&path)?;
    Some(match random.below(12) {
        0 => Edit::State(path, state_edit(random, fresh)),
        1 => Edit::Outcome(path, OutcomeId(random.small(4)), outcome_edit(random)),
        2 | 3 => {
            let kind = random.pick(&PortKind::ALL)?;
            Edit::Port(path, kind, PortId(random.small(5)), port_edit(random)?)
        }
        4..=6 => {
            Edit::Transition(path, TransitionId(random.small(9)), transition_edit(state, random))
        }
        7 => Edit::DataFlow(path, DataFlowId(random.small(9)), flow_edit(state, random)?),
        _ => Edit::Children(path, children_edit(state, random, fresh)?),
    })
}

fn name(fresh: &mut u32) -> StateId {
    *fresh += 1;
    StateId::new(format!("N{fresh}"))
}

fn state_edit(random: &mut Random, fresh: &mut u32) -> StateEdit {
    let kinds = [KindName::Execution, KindName::Hierarchy, KindName::Barrier, KindName::Preemptive];
    match random.below(4) {
        0 => StateEdit::SetName("Other".into()),
        1 => StateEdit::SetScript(Some("pass".into())),
        2 => StateEdit::SetId(name(fresh)),
        _ => StateEdit::SetKind(random.pick(&kinds).unwrap_or(KindName::Execution)),
    }
}

fn outcome_edit(random: &mut Random) -> OutcomeEdit {
    match random.below(3) {
        0 => OutcomeEdit::Add("c".into()),
        1 => OutcomeEdit::Rename("d".into()),
        _ => OutcomeEdit::Remove,
    }
}

fn port_edit(random: &mut Random) -> Option<PortEdit> {
    let default = random.pick(&[Value::None, Value::Int(1), Value::Int(5)])?;
    Some(match random.below(5) {
        0 => PortEdit::Rename("z".into()),
        1 => PortEdit::SetDefault(default),
        2 => PortEdit::Remove,
        _ => PortEdit::Add { name: "w".into(), data_type: DataType::Int, default },
    })
}

fn children(state: &State) -> Vec<StateId> {
    state.container().map(|c| c.states.keys().cloned().collect()).unwrap_or_default()
}

fn target(state: &State, random: &mut Random) -> Target {
    match random.pick(&children(state)).filter(|_| random.percent(70)) {
        Some(id) => Target::State(id),
        None => Target::Outcome(OutcomeId(random.small(2))),
    }
}

fn transition_edit(state: &State, random: &mut Random) -> TransitionEdit {
    let to = target(state, random);
    let from = random.pick(&children(state));
    match (random.below(4), from) {
        (0, _) => TransitionEdit::SetTarget(to),
        (1, _) => TransitionEdit::Remove,
        (_, Some(from)) => {
            let outcome = OutcomeId(random.small(4) - 2);
            TransitionEdit::Add { from: Origin::Outcome(from, outcome), to }
        }
        (_, None) => TransitionEdit::Add { from: Origin::Income, to },
    }
}

fn flow_edit(state: &State, random: &mut Random) -> Option<DataFlowEdit> {
    let mut ends = children(state);
    ends.push(state.id.clone());
    let mut end = |ports: usize| Some((random.pick(&ends)?, PortId(random.small(ports))));
    let (from, to) = (end(3)?, end(3)?);
    Some(if random.percent(70) { DataFlowEdit::Add { from, to } } else { DataFlowEdit::Remove })
}

fn children_edit(state: &State, random: &mut Random, fresh: &mut u32) -> Option<ChildrenEdit> {
    let ids = children(state);
    let one = random.pick(&ids).unwrap_or_else(|| StateId::new("NONE"));
    Some(match random.below(9) {
        0..=2 => ChildrenEdit::Remove(one),
        3 => ChildrenEdit::SetStart(Some(target(state, random))),
        4 => {
            let states = ids.into_iter().filter(|_| random.percent(50)).collect();
            let id = name(fresh);
            ChildrenEdit::Group { states, scoped_variables: vec![], id, name: "Group".into() }
        }
        5 => ChildrenEdit::Ungroup { state: one, fresh: (0..3).map(|_| name(fresh)).collect() },
        6 => ChildrenEdit::Substitute { state: one, by: state_like(name(fresh), random)? },
        _ => ChildrenEdit::Add(state_like(name(fresh), random)?),
    })
}

/// A state with the common outcomes and ports of all states.
fn state_like(id: StateId, random: &mut Random) -> Option<Arc<State>> {
    let kinds = [
        Kind::Execution(Script::default()),
        Kind::Execution(Script::default()),
        Kind::Hierarchy(Container::default()),
        Kind::Preemptive(Container::default()),
    ];
    let mut state = State::new(id, "New", random.pick(&kinds)?);
    for (id, name) in (0..).zip(OUTCOMES) {
        state.outcomes.insert(Outcome::new(OutcomeId(id), name));
    }
    let port = |id, name| Port::new(PortId(id), name, DataType::Int, Value::Int(4));
    state.inputs.insert(port(0, INPUT));
    state.outputs.insert(port(1, OUTPUT));
    Some(Arc::new(state))
}
