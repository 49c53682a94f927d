//! The engine alone: states that add one to a number, one after the other in a ring, with every event kept in memory.

use crate::{clock, median, print};
use anyhow::{Result, ensure};
use rafcon_engine::{
    Effect, Engine, Event, Input, Job, ModelLiterals, NoGlobals, Outbox, Program, Returned,
    ScriptResult, Start,
};
use rafcon_model::Value;
use rafcon_testkit::notation;
use std::sync::Arc;

/// States run in one measurement.
const STATES: u32 = 1_000_000;

/// Two states; then a hundred and ten thousand of them, to see that neighbours cost nothing.
pub(crate) fn measure() -> Result<()> {
    let speed = |siblings| {
        let program = program(siblings)?;
        median(|| Ok::<_, anyhow::Error>(measured(&program)?.states_per_s))
    };
    let two = program(2)?;
    print("native_flat_states_per_s", speed(2)?, "states/s");
    print(
        "native_flat_over_copies",
        median(|| Ok::<_, anyhow::Error>(measured(&two)?.over_copies))?,
        "ratio",
    );
    let hundred = speed(100)?;
    print("native_flat_10000_over_100", speed(10_000)? / hundred, "ratio");
    Ok(())
}

fn program(siblings: usize) -> Result<Arc<Program<Value>>> {
    let machine = notation::parse(&ring(siblings))?;
    Ok(Arc::new(Program::compile(&machine, &mut ModelLiterals)))
}

/// A ring of states that pass a number on through a scoped variable.
fn ring(siblings: usize) -> String {
    let head =
        "hierarchy ROOT\n  outcome done\n  out count: int\n  var now: int = 0\n  start -> S0\n";
    let link = |this: usize| {
        let next = (this + 1) % siblings;
        format!(
            "  S{this}.next -> S{next}\n  S{this}.done -> .done\n  flow .now -> S{this}.before\n  flow S{this}.after -> .now\n"
        )
    };
    let state = |this: usize| {
        format!(
            "  execution S{this}\n    outcome next\n    outcome done\n    in before: int = 0\n    out after: int = 0\n"
        )
    };
    let links = (0..siblings).map(link).collect::<String>();
    let states = (0..siblings).map(state).collect::<String>();
    format!("{head}  flow .now -> .count\n{links}{states}")
}

/// Speed of the engine.
struct Measured {
    states_per_s: f64,
    /// Time to copy the events of the run, against the time of the run. No engine that keeps its events is faster than 1.
    over_copies: f64,
}

/// Runs the ring until the number is [`STATES`].
fn measured(program: &Arc<Program<Value>>) -> Result<Measured> {
    let mut engine = Engine::new(Arc::clone(program));
    let mut history = Vec::with_capacity(4 * STATES as usize);
    let (seconds, ran) = clock::seconds(|| run(&mut engine, &mut history));
    ran?;
    ensure!(engine.states_run() > u64::from(STATES), "the ring ends too early");
    let mut copies = Vec::with_capacity(4 * STATES as usize);
    let (copying, ()) = clock::seconds(|| copies.extend(history.iter().cloned()));
    Ok(Measured { states_per_s: f64::from(STATES) / seconds, over_copies: copying / seconds })
}

fn run(engine: &mut Engine<Value>, history: &mut Vec<Event<Value>>) -> Result<()> {
    let mut out = Outbox::default();
    let mut input = Some(Input::Start(Start::default()));
    while let Some(cause) = input.take() {
        engine.handle(cause, &NoGlobals, &mut out)?;
        history.append(&mut out.events);
        ensure!(history.len() <= 4 * STATES as usize, "the ring does not count");
        input = out.effects.drain(..).find_map(answer);
    }
    Ok(())
}

/// What a native state does: one more than before.
fn answer(effect: Effect<Value>) -> Option<Input<Value>> {
    let Effect::Run(Job { frame, inputs, .. }) = effect else { return None };
    let count = match inputs.first() {
        Some(Value::Int(before)) => before + 1,
        _ => 1,
    };
    let returned = Returned::Id(i64::from(count >= i64::from(STATES)));
    let outputs = vec![Some(Value::Int(count))];
    Some(Input::Finished { frame, result: ScriptResult { returned, outputs, error: None } })
}
