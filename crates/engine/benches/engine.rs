//! Benchmarks of the engine alone: start, transitions, parallel branches and depth. Scripts return at once.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use rafcon_engine::{
    Effect, Engine, Event, Input, Job, ModelLiterals, NoGlobals, Outbox, Program, Returned,
    ScriptResult, Start,
};
use rafcon_model::Value;
use rafcon_testkit::notation;
use std::sync::Arc;

/// States run in one measurement of transitions.
const STATES: i64 = 10_000;

fn compiled(text: &str) -> Arc<Program<Value>> {
    let machine = notation::parse(text).unwrap_or_else(|error| panic!("{error}"));
    Arc::new(Program::compile(&machine, &mut ModelLiterals))
}

/// A ring of states that increment a scoped variable.
fn ring(states: usize) -> String {
    let state = |state: usize| {
        let next = (state + 1) % states;
        format!(
            "  S{state}.next -> S{next} ; S{state}.done -> .done
  flow .n -> S{state}.before ; S{state}.after -> .n
  execution S{state}
    outcome next
    outcome done
    in before: int = 0
    out after: int = 0
"
        )
    };
    let head = "hierarchy ROOT\n  outcome done\n  var n: int = 0\n  start -> S0\n";
    head.to_owned() + &(0..states).map(state).collect::<Vec<_>>().concat()
}

/// A barrier or race whose states end at once.
fn branches(kind: &str, count: usize) -> String {
    let branch = |branch: usize| format!("  execution S{branch}\n    outcome done\n");
    let end = match kind {
        "barrier" => {
            "  unique_decider_state_id.done -> .done
  decider unique_decider_state_id
    outcome done
"
        }
        _ => "  S0.done -> .done\n",
    };
    let children = (0..count).map(branch).collect::<Vec<_>>().concat();
    format!("{kind} ROOT\n  outcome done\n{children}{end}")
}

/// Hierarchies nested `levels` deep.
fn tower(levels: usize) -> String {
    let level = |level: usize| {
        let (indent, below) = (" ".repeat(level), level + 1);
        format!(
            "{indent}hierarchy S{level}
{indent} outcome done
{indent} start -> S{below} ; S{below}.done -> .done
"
        )
    };
    let indent = " ".repeat(levels);
    let floors = (0..levels).map(level).collect::<Vec<_>>().concat();
    format!("{floors}{indent}execution S{levels}\n{indent} outcome done\n")
}

/// Runs a machine whose scripts count to [`STATES`] and returns all events.
fn run(program: &Arc<Program<Value>>) -> Vec<Event<Value>> {
    let mut engine = Engine::new(Arc::clone(program));
    let mut out = Outbox::default();
    let mut history = Vec::new();
    let mut inputs = vec![Input::Start(Start::default())];
    while let Some(input) = inputs.pop() {
        if let Err(refusal) = engine.handle(input, &NoGlobals, &mut out) {
            panic!("{refusal}");
        }
        history.append(&mut out.events);
        inputs.extend(out.effects.drain(..).filter_map(answer));
    }
    history
}

fn answer(effect: Effect<Value>) -> Option<Input<Value>> {
    let Effect::Run(Job { frame, inputs, .. }) = effect else { return None };
    let (returned, outputs) = match inputs.first() {
        Some(Value::Int(before)) => {
            let count = before + 1;
            (i64::from(count >= STATES), vec![Some(Value::Int(count))])
        }
        _ => (0, Vec::new()),
    };
    let result = ScriptResult { returned: Returned::Id(returned), outputs, error: None };
    Some(Input::Finished { frame, result })
}

fn transitions(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("transitions");
    group.throughput(Throughput::Elements(u64::try_from(STATES).unwrap_or_default()));
    for siblings in [2, 100, 1_000, 10_000] {
        let program = compiled(&ring(siblings));
        let name = format!("ring_of_{siblings}");
        group.bench_function(name, |bencher| {
            bencher.iter_with_large_drop(|| run(&program));
        });
    }
    group.finish();
}

fn parallel(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("parallel");
    for kind in ["barrier", "preemptive"] {
        let program = compiled(&branches(kind, 1_000));
        group.bench_function(format!("{kind}_of_1000"), |bencher| {
            bencher.iter_with_large_drop(|| run(&program));
        });
    }
    group.finish();
}

fn depth(criterion: &mut Criterion) {
    let program = compiled(&tower(500));
    criterion.bench_function("tower_of_500", |bencher| {
        bencher.iter_with_large_drop(|| run(&program));
    });
}

fn start(criterion: &mut Criterion) {
    let text = ring(10_000);
    let machine = notation::parse(&text).unwrap_or_else(|error| panic!("{error}"));
    criterion.bench_function("compile_10000_states", |bencher| {
        bencher.iter_with_large_drop(|| Program::<Value>::compile(&machine, &mut ModelLiterals));
    });
    let program = compiled(&text);
    criterion.bench_function("start_10000_states", |bencher| {
        bencher.iter_batched(
            || Engine::new(Arc::clone(&program)),
            |mut engine| {
                let mut out = Outbox::default();
                let started = engine.handle(Input::Start(Start::default()), &NoGlobals, &mut out);
                (started, engine, out)
            },
            BatchSize::LargeInput,
        );
    });
}

criterion_group!(benches, transitions, parallel, depth, start);
criterion_main!(benches);
