//! The rules of `docs/semantics.md`. Each test runs a machine with a script of inputs and compares the engine's output.

mod back_branches;
mod backward;
mod barrier;
mod breakpoints;
mod change;
mod commands;
mod data;
mod deep;
mod errors;
mod force;
mod hierarchy;
mod library;
mod life;
mod lost_link;
mod outcomes;
mod preemption;
mod restore;
mod scoped;
mod silence;
mod starting;
mod stepping;
mod world;

use expect_test::Expect;
use world::World;

/// Runs the inputs of `script`, one per line or separated by `;`, and compares everything that the engine did.
///
/// Inputs: `start`, `start x=1`, `start hold at ROOT/A then stop ROOT/A.x=1`, `pause`, `resume`, `stop`, and the others
/// in `commands.rs`. For a running script, named by the end of its path: `A done` (an outcome's name), `A 3` (an id),
/// `A other "text"`, `A raises "boom"`. Outputs may follow: `A done y=2 -z error="boom"` (`-z` omits an output).
/// `global x=5` sets a global variable.
///
/// `cut again` (or `wait`, `abort`, also `cut again held`) resumes the run in another engine; with `elsewhere`, using
/// the machine of [`check_change`]. `keep` keeps a moment, and `return` restarts the run there, held. `recover again`
/// and `recover abort at ROOT/A` recover interrupted scripts.
fn check(machine: &str, script: &str, expect: &Expect) {
    expect.assert_eq(&World::new(machine).play(script));
}

/// As [`check`], with a second machine `next`, which `change` and `change or wait` switch to.
fn check_change(machine: &str, next: &str, script: &str, expect: &Expect) {
    expect.assert_eq(&World::new(machine).with_next(next).play(script));
}
