//! The engine alone: states that add one to a number, one after the other in a ring, with every event kept in memory.

use crate::{clock, median, print};
use rafcon_engine::{
    Effect, Engine, Event, Input, Job, ModelLiterals, NoGlobals, Outbox, Program, Returned,
    ScriptResult, Start,
};
use rafcon_model::{Machine, Value, notation};
use std::convert::Infallible;
use std::sync::Arc;

/// States run in one measurement.
const STATES: i64 = 1_000_000;

/// Two states; then a hundred and ten thousand of them, to see that neighbours cost nothing.
pub(crate) fn measure() {
    let speed = |siblings| {
        let program = program(siblings);
        let Ok(speed) = median(|| Ok::<_, Infallible>(states_per_s(&program)));
        speed
    };
    print("native_flat_states_per_s", speed(2), "states/s");
    let hundred = speed(100);
    print("native_flat_10000_over_100", speed(10_000) / hundred, "ratio");
}
