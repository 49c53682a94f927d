//! Building a machine by edits, each with all checks: a state, a transition that leads to it, a data flow in and one out.

use crate::{clock, median, print};
use anyhow::Result;
use rafcon_model::edit::{ChildrenEdit, DataFlowEdit, Edit, TransitionEdit, apply};
use rafcon_model::{
    BuiltinTypes, Container, DataFlowId, DataType, Header, Kind, Machine, Origin, Outcome,
    OutcomeId, Port, PortId, Script, State, StateId, StatePath, Target, TransitionId, Value,
};
use std::sync::Arc;

const STATES: usize = 10_000;
/// Children of each container of the nested machine.
const BRANCHING: usize = 10;
/// The scoped variable of each container, and the ports of each state.
const VARIABLE: PortId = PortId(2);
const BEFORE: PortId = PortId(0);
const AFTER: PortId = PortId(1);
const NEXT: OutcomeId = OutcomeId(0);

/// All states beside each other, then a tree of them; the worse counts.
pub(crate) fn measure() -> Result<()> {
    let milliseconds = |build: fn() -> Result<Machine>| {
        median(|| {
            let (seconds, machine) = clock::seconds(build);
            assert!(machine?.count() >= STATES, "all states are there");
            anyhow::Ok(seconds * 1e3)
        })
    };
    print("build_10000_ms", milliseconds(flat)?.max(milliseconds(nested)?), "ms");
    Ok(())
}

fn flat() -> Result<Machine> {
    let mut machine = empty();
    let root = StatePath::root(machine.root.id.clone());
    fill(&mut machine, &root, STATES, &Kind::Execution(Script::default()))?;
    Ok(machine)
}

/// Containers level by level until there are enough states; the last level runs scripts.
fn nested() -> Result<Machine> {
    let mut machine = empty();
    let mut level = vec![StatePath::root(machine.root.id.clone())];
    let mut states = 1;
    while states < STATES {
        let wanted = BRANCHING.min((STATES - states).div_ceil(level.len()));
        let last = states + level.len() * wanted >= STATES;
        let kind = if last { Kind::Execution(Script::default()) } else { container() };
        let mut next = Vec::new();
        for path in &level {
            next.extend(fill(&mut machine, path, wanted, &kind)?);
        }
        states += next.len();
        level = next;
    }
    Ok(machine)
}

fn empty() -> Machine {
    let root = state(StateId::new("ROOTED"), container());
    Machine { header: Header::default(), root: Arc::new(root) }
}

/// Puts a chain of states into the container at `path`; gives their paths.
fn fill(
    machine: &mut Machine,
    path: &StatePath,
    states: usize,
    kind: &Kind,
) -> Result<Vec<StatePath>> {
    let container = path.last().cloned().unwrap_or_else(|| StateId::new(""));
    let mut from = Origin::Income;
    let mut paths = Vec::with_capacity(states);
    for (index, number) in (0..states).zip(1..) {
        let id = StateId::new(format!("L{}S{index:05}", path.0.len()));
        let child = Arc::new(state(id.clone(), kind.clone()));
        let flow = |number, from, to| {
            Edit::DataFlow(path.clone(), DataFlowId(number), DataFlowEdit::Add { from, to })
        };
        let leads = TransitionEdit::Add { from, to: Target::State(id.clone()) };
        let variable = (container.clone(), VARIABLE);
        for edit in [
            Edit::Children(path.clone(), ChildrenEdit::Add(child)),
            Edit::Transition(path.clone(), TransitionId(number), leads),
            flow(2 * number, variable.clone(), (id.clone(), BEFORE)),
            flow(2 * number + 1, (id.clone(), AFTER), variable),
        ] {
            apply(machine, edit, &BuiltinTypes)?;
        }
        paths.push(path.child(id.clone()));
        from = Origin::Outcome(id, NEXT);
    }
    Ok(paths)
}

/// A hierarchy with a scoped variable.
fn container() -> Kind {
    let variable = Port::new(VARIABLE, "now", DataType::Int, Value::Int(0));
    let scoped_variables = [variable].into_iter().collect();
    Kind::Hierarchy(Container { scoped_variables, ..Container::default() })
}

/// A state with an outcome, an input and an output.
fn state(id: StateId, kind: Kind) -> State {
    let mut state = State::new(id, "Counts", kind);
    state.outcomes.insert(Outcome::new(NEXT, "next"));
    state.inputs.insert(Port::new(BEFORE, "before", DataType::Int, Value::Int(0)));
    state.outputs.insert(Port::new(AFTER, "after", DataType::Int, Value::Int(0)));
    state
}
