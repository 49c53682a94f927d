//! The rules of `docs/semantics.md`: a machine in, a script of inputs in, what the engine did out.

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

/// Runs `script`, one input a line or after `;`, against the machine, and compares everything that the engine did.
///
/// Inputs: `start`, `start x=1`, `start hold at ROOT/A then stop ROOT/A.x=1`, `pause`, `resume`, `stop`, and the others in
/// `commands.rs`; for a script that runs (named by the end of its path) `A done` (an outcome's name), `A 3` (an id),
/// `A other "text"`, `A raises "boom"`, with outputs behind it: `A done y=2 -z error="boom"` (`-z` leaves an output out);
/// `global x=5`.
///
/// `cut again` (`wait`, `abort`), also `cut again held`: the run is resumed by another engine (`elsewhere`: with the
/// machine of [`check_change`]); `keep`, `return`: a moment is kept, and the run goes back to it, held; `recover again`,
/// `recover abort at ROOT/A`.
fn check(machine: &str, script: &str, expect: &Expect) {
    expect.assert_eq(&World::new(machine).play(script));
}

/// The same with `next`, which the machine becomes: `change`, `change or wait`.
fn check_change(machine: &str, next: &str, script: &str, expect: &Expect) {
    expect.assert_eq(&World::new(machine).with_next(next).play(script));
}
