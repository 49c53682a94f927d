//! How long it takes to build a machine of 10,000 states through edits with full checks, to look for its problems, and to
//! find one change in it.

use criterion::{Criterion, criterion_group, criterion_main};
use rafcon_model::edit::{ChildrenEdit, DataFlowEdit, Edit, StateEdit, TransitionEdit, apply};
use rafcon_model::{
    BuiltinTypes, Container, DataFlowId, DataType, Fresh, Header, Kind, Machine, Origin, Outcome,
    OutcomeId, Port, PortId, Script, State, StateId, StatePath, Target, TransitionId, Value, diff,
    problems,
};
use rafcon_testkit::notation;
use std::collections::VecDeque;
use std::hint::black_box;
use std::sync::Arc;

const STATES: usize = 10_000;
const SCRIPT: &str = "def execute(self, inputs, outputs, gvm):\n    outputs['y'] = inputs['x'] + 1\n    return 'success'\n";

fn state(id: StateId, is_container: bool) -> State {
    let kind = if is_container {
        Kind::Hierarchy(Container::default())
    } else {
        Kind::Execution(Script { text: Some(SCRIPT.into()) })
    };
    let mut state = State::new(id, "Count", kind);
    state.outcomes.insert(Outcome::new(OutcomeId(0), "success"));
    state.inputs.insert(Port::new(PortId(0), "x", DataType::Int, Value::Int(4)));
    state.outputs.insert(Port::new(PortId(1), "y", DataType::Int, Value::None));
    state
}

/// Adds children to one container, each connected with the one before; gives their paths.
fn fill(
    machine: &mut Machine,
    parent: &StatePath,
    count: usize,
    fresh: &mut Fresh,
    nest: bool,
) -> Vec<StatePath> {
    let mut made = Vec::with_capacity(count);
    let mut last: Option<StateId> = None;
    for number in (1..).take(count) {
        let id = fresh.id(|_| false);
        let child = Arc::new(state(id.clone(), nest));
        change(machine, Edit::Children(parent.clone(), ChildrenEdit::Add(child)));
        if let Some(last) = last {
            let (from, to) =
                (Origin::Outcome(last.clone(), OutcomeId(0)), Target::State(id.clone()));
            let transition = TransitionEdit::Add { from, to };
            change(machine, Edit::Transition(parent.clone(), TransitionId(number), transition));
            let flow = DataFlowEdit::Add { from: (last, PortId(1)), to: (id.clone(), PortId(0)) };
            change(machine, Edit::DataFlow(parent.clone(), DataFlowId(number), flow));
        }
        made.push(parent.child(id.clone()));
        last = Some(id);
    }
    made
}

fn change(machine: &mut Machine, edit: Edit) {
    let back = apply(machine, edit, &BuiltinTypes);
    assert!(back.is_ok(), "{back:?}");
}

fn root() -> Machine {
    Machine { header: Header::default(), root: Arc::new(state(StateId::new("ROOT"), true)) }
}

fn flat() -> Machine {
    let mut machine = root();
    fill(&mut machine, &StatePath::parse("ROOT"), STATES - 1, &mut Fresh::new(1), false);
    machine
}

fn nested() -> Machine {
    let (mut machine, mut fresh) = (root(), Fresh::new(1));
    let mut open = VecDeque::from([StatePath::parse("ROOT")]);
    let mut count = 1;
    while let Some(parent) = open.pop_front().filter(|_| count < STATES) {
        let children = fill(&mut machine, &parent, 9, &mut fresh, true);
        count += children.len();
        open.extend(children);
    }
    machine
}

fn machine(c: &mut Criterion) {
    let mut group = c.benchmark_group("10,000 states");
    group.sample_size(20);
    group.bench_function("build flat", |b| b.iter(|| black_box(flat())));
    group.bench_function("build nested", |b| b.iter(|| black_box(nested())));
    let machine = nested();
    group.bench_function("problems", |b| b.iter(|| problems(black_box(&machine), &BuiltinTypes)));
    group.bench_function("print and parse", |b| {
        b.iter(|| notation::parse(&notation::print(black_box(&machine))));
    });
    let mut other = machine.clone();
    let name = StateEdit::SetName("Other".into());
    change(&mut other, Edit::State(StatePath::parse("ROOT"), name));
    group.bench_function("diff", |b| b.iter(|| diff(black_box(&machine), black_box(&other))));
    group.finish();
}

criterion_group!(benches, machine);
criterion_main!(benches);
