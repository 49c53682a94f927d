//! The engine alone, with scripts that answer at once: starting, transitions, parallel branches, depth.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use rafcon_engine::{
    Effect, Engine, Event, Input, Job, ModelLiterals, NoGlobals, Outbox, Program, Returned,
    ScriptResult, Start,
};
use rafcon_model::{Value, notation};
use std::sync::Arc;

/// States run in one measurement of transitions.
const STATES: i64 = 10_000;

fn compiled(text: &str) -> Arc<Program<Value>> {
    let machine = notation::parse(text).unwrap_or_else(|error| panic!("{error}"));
    Arc::new(Program::compile(&machine, &mut ModelLiterals))
}

/// A ring of states that count up in a scoped variable.
fn ring(states: usize) -> String {
    let mut text = "hierarchy ROOT\n  outcome done\n  var n: int = 0\n  start -> S0\n".to_owned();
    for state in 0..states {
        let next = (state + 1) % states;
        text += &[
            format!("  S{state}.next -> S{next} ; S{state}.done -> .done\n"),
            format!("  flow .n -> S{state}.before ; S{state}.after -> .n\n"),
            format!("  execution S{state}\n    outcome next\n    outcome done\n"),
            "    in before: int = 0\n    out after: int = 0\n".to_owned(),
        ]
        .concat();
    }
    text
}

/// A barrier (or race) of states that end at once.
fn branches(kind: &str, count: usize) -> String {
    let mut text = format!("{kind} ROOT\n  outcome done\n");
    for branch in 0..count {
        text += &format!("  execution S{branch}\n    outcome done\n");
    }
    if kind == "barrier" {
        return text
            + "  unique_decider_state_id.done -> .done\n"
            + "  decider unique_decider_state_id\n    outcome done\n";
    }
    text + "  S0.done -> .done\n"
}

/// Hierarchies inside hierarchies.
fn tower(levels: usize) -> String {
    let mut text = String::new();
    for level in 0..levels {
        let indent = " ".repeat(level);
        text += &format!("{indent}hierarchy S{level}\n{indent} outcome done\n");
        let below = level + 1;
        text += &format!("{indent} start -> S{below} ; S{below}.done -> .done\n");
    }
    let indent = " ".repeat(levels);
    text + &format!("{indent}execution S{levels}\n{indent} outcome done\n")
}

/// Runs a machine whose scripts count to [`STATES`]; gives back everything that happened.
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
