//! Forced outcomes, and preemption of single states.

use super::check;
use expect_test::expect;

const MACHINE: &str = r#"
hierarchy ROOT
  outcome done
  start -> A ; A.ok -> L ; L.ok -> C ; C.ok -> H ; H.ok -> Z ; H.bad -> .done ; Z.ok -> .done
  out r: int = 1
  var v: int = 2
  flow A.y -> .v ; H.y -> .v ; L.y -> .v ; .v -> .r
  execution A
    outcome ok
    out y: int = 3
  library L from "some/library"
    content
      execution R
        outcome ok
        out y: int = 4
  barrier C
    outcome ok
    unique_decider_state_id.ok -> .ok
    execution S
      outcome ok
    execution T
      outcome ok
    decider unique_decider_state_id
      outcome ok
  hierarchy H
    outcome ok
    outcome bad
    out y: int = 5
    start -> B
    execution B
      outcome lost
  execution Z
    outcome ok
"#;

#[test]
fn a_state_is_skipped_with_an_outcome() {
    check(
        MACHINE,
        "start hold; force ROOT/A 0; active; force ROOT/A 0; force ROOT/L -1",
        &expect![[r"
        > start hold
        enter ROOT
        set ROOT.v = 2
        hold ROOT before ROOT/A (Start)
        > force ROOT/A 0
        force ROOT/A ok
        hold ROOT before ROOT/L (Step)
        > active
        ROOT Held (Step before ROOT/L)
        Stepping, 1 states run
        > force ROOT/A 0
        refused: cannot force an outcome of 'ROOT/A': it is not active, and nothing is held before it
        > force ROOT/L -1
        force ROOT/L aborted
        leave ROOT aborted r=2
        finished
          end of run: aborted (-1) r=2 variables: v=2, 1 states
    "]],
    );
}

#[test]
fn a_state_that_waits_ends_with_an_outcome() {
    check(
        MACHINE,
        "start at ROOT/H; B lost; force ROOT/H 9; force ROOT/H 1",
        &expect![[r"
        > start at ROOT/H
        enter ROOT
        set ROOT.v = 2
        enter ROOT/H
        enter ROOT/H/B
          run ROOT/H/B
        > B lost
        leave ROOT/H/B lost
        wait ROOT/H: no transition from ROOT/H/B lost
        > force ROOT/H 9
        refused: 'ROOT/H' has no outcome 9; choose one of its outcomes
        > force ROOT/H 1
        force ROOT/H bad
        leave ROOT/H bad y=5
        set ROOT.v = 5
        leave ROOT done r=5
        finished
          end of run: done (0) r=5 variables: v=5, 3 states
    "]],
    );
}

#[test]
fn a_container_that_is_held_ends_with_an_outcome() {
    check(
        MACHINE,
        "start hold at ROOT/H/B; force ROOT/H 0; Z ok",
        &expect![[r"
        > start hold at ROOT/H/B
        enter ROOT
        set ROOT.v = 2
        enter ROOT/H
        hold ROOT/H before ROOT/H/B (Start)
        > force ROOT/H 0
        force ROOT/H ok
        leave ROOT/H ok y=5
        set ROOT.v = 5
        hold ROOT before ROOT/Z (Step)
        > Z ok
        refused: frame 77.0 runs no script; a result is given once, with the frame of its job
    "]],
    );
}

#[test]
fn the_root_ends_with_an_outcome() {
    check(
        MACHINE,
        "start hold; force ROOT 0",
        &expect![[r"
        > start hold
        enter ROOT
        set ROOT.v = 2
        hold ROOT before ROOT/A (Start)
        > force ROOT 0
        force ROOT done
        leave ROOT done r=2
        finished
          end of run: done (0) r=2 variables: v=2, 1 states
    "]],
    );
}

#[test]
fn a_run_that_has_not_begun_ends_with_an_outcome() {
    check(
        MACHINE,
        "break 1 before ROOT; start; force ROOT 0",
        &expect![[r"
        > break 1 before ROOT
        > start
        hit 1 at ROOT for the 1. time
        hold ROOT before ROOT (Breakpoint(1))
        > force ROOT 0
        force ROOT done
        finished
          end of run: done (0) r=1, 0 states
    "]],
    );
}

#[test]
fn the_root_of_a_library_is_skipped() {
    check(
        MACHINE,
        "break 1 before ROOT/L/R; break 2 before ROOT/C; start at ROOT/L; force ROOT/L/R 0; resume",
        &expect![[r"
        > break 1 before ROOT/L/R
        > break 2 before ROOT/C
        > start at ROOT/L
        enter ROOT
        set ROOT.v = 2
        enter ROOT/L
        hit 1 at ROOT/L/R for the 1. time
        hold ROOT/L before ROOT/L/R (Breakpoint(1))
        > force ROOT/L/R 0
        force ROOT/L/R ok
        leave ROOT/L ok y=4
        set ROOT.v = 4
        hit 2 at ROOT/C for the 1. time
        hold ROOT before ROOT/C (Breakpoint(2))
        > resume
        enter ROOT/C
        enter ROOT/C/S
        enter ROOT/C/T
          fork 1
          run ROOT/C/S on 1
          fork 2
          run ROOT/C/T on 2
    "]],
    );
}

#[test]
fn a_library_that_is_held_ends_with_an_outcome() {
    check(
        MACHINE,
        "break 1 after ROOT/L/R; start at ROOT/L; R ok y=9; force ROOT/L 0; S ok",
        &expect![[r"
        > break 1 after ROOT/L/R
        > start at ROOT/L
        enter ROOT
        set ROOT.v = 2
        enter ROOT/L
        enter ROOT/L/R
          run ROOT/L/R
        > R ok y=9
        leave ROOT/L/R ok y=9
        hit 1 at ROOT/L/R for the 1. time
        hold ROOT/L (Breakpoint(1))
        > force ROOT/L 0
        force ROOT/L ok
        leave ROOT/L ok y=4
        set ROOT.v = 4
        hold ROOT before ROOT/C (Step)
        > S ok
        refused: frame 77.0 runs no script; a result is given once, with the frame of its job
    "]],
    );
}

#[test]
fn branches_and_the_decider_are_skipped() {
    check(
        MACHINE,
        "break 1 before ROOT/C/S; break 2 before ROOT/C/unique_decider_state_id; start at ROOT/C; force ROOT/C/S -1; force ROOT/C 0; T ok; force ROOT/C/unique_decider_state_id 0; B lost",
        &expect![[r"
        > break 1 before ROOT/C/S
        > break 2 before ROOT/C/unique_decider_state_id
        > start at ROOT/C
        enter ROOT
        set ROOT.v = 2
        enter ROOT/C
        hit 1 at ROOT/C/S for the 1. time
        hold ROOT/C before ROOT/C/S (Breakpoint(1))
        enter ROOT/C/T
          fork 1
          fork 2
          run ROOT/C/T on 2
        > force ROOT/C/S -1
        force ROOT/C/S aborted
          end 1
        > force ROOT/C 0
        refused: cannot force an outcome of 'ROOT/C': states in it are active; choose one of those, or preempt it
        > T ok
        leave ROOT/C/T ok
        hit 2 at ROOT/C/unique_decider_state_id for the 1. time
        hold ROOT/C before ROOT/C/unique_decider_state_id (Breakpoint(2))
          end 2
        > force ROOT/C/unique_decider_state_id 0
        force ROOT/C/unique_decider_state_id ok
        leave ROOT/C ok
        hold ROOT before ROOT/H (Step)
        > B lost
        refused: frame 77.0 runs no script; a result is given once, with the frame of its job
    "]],
    );
}

#[test]
fn a_concurrency_state_in_which_nothing_runs_ends_with_an_outcome() {
    check(
        MACHINE,
        "break 1 before ROOT/C/S; break 2 after ROOT/C/T; start at ROOT/C; T ok; force ROOT/C 0; B lost",
        &expect![[r"
        > break 1 before ROOT/C/S
        > break 2 after ROOT/C/T
        > start at ROOT/C
        enter ROOT
        set ROOT.v = 2
        enter ROOT/C
        hit 1 at ROOT/C/S for the 1. time
        hold ROOT/C before ROOT/C/S (Breakpoint(1))
        enter ROOT/C/T
          fork 1
          fork 2
          run ROOT/C/T on 2
        > T ok
        leave ROOT/C/T ok
        hit 2 at ROOT/C/T for the 1. time
        hold ROOT/C (Breakpoint(2))
        > force ROOT/C 0
        force ROOT/C ok
        leave ROOT/C ok
        enter ROOT/H
        enter ROOT/H/B
          end 1
          end 2
          run ROOT/H/B
        > B lost
        leave ROOT/H/B lost
        wait ROOT/H: no transition from ROOT/H/B lost
    "]],
    );
}

#[test]
fn what_goes_on_by_itself_is_not_forced() {
    check(
        MACHINE,
        "break 1 before ROOT/L if c; start; force ROOT/A 0; force ROOT 0; force ROOT/Z 0; force ROOT/NO 0; A ok; force ROOT 0; force ROOT/L 0; check false; force ROOT/L 0; stop; force ROOT/L 0",
        &expect![[r"
        > break 1 before ROOT/L if c
        > start
        enter ROOT
        set ROOT.v = 2
        enter ROOT/A
          run ROOT/A
        > force ROOT/A 0
        refused: cannot force an outcome of 'ROOT/A': its script runs; preempt it instead
        > force ROOT 0
        refused: cannot force an outcome of 'ROOT': states in it are active; choose one of those, or preempt it
        > force ROOT/Z 0
        refused: cannot force an outcome of 'ROOT/Z': it is not active, and nothing is held before it
        > force ROOT/NO 0
        refused: there is no state at 'ROOT/NO': 'NO' is not inside 'ROOT'; paths are state ids from the root down, joined by '/'
        > A ok
        leave ROOT/A ok y=3
        set ROOT.v = 3
          check 1 at ROOT/L: c v=3
        > force ROOT 0
        refused: cannot force an outcome of 'ROOT': the condition of a breakpoint is being evaluated; wait for it
        > force ROOT/L 0
        refused: cannot force an outcome of 'ROOT/L': it is not active, and nothing is held before it
        > check false
        enter ROOT/L
        enter ROOT/L/R
          run ROOT/L/R
        > force ROOT/L 0
        refused: cannot force an outcome of 'ROOT/L': states in it are active; choose one of those, or preempt it
        > stop
        stopping
          preempt ROOT
          preempt ROOT/L
          preempt ROOT/L/R
        > force ROOT/L 0
        refused: cannot force an outcome: the run is stopping; it ends when its scripts do; stop again to run no more handlers
    "]],
    );
}

#[test]
fn a_step_back_takes_back_the_forced_outcome_of_a_library_state() {
    check(
        MACHINE,
        "break 1 after ROOT/L/R; break 2 before ROOT/C; start at ROOT/L; R ok y=9; force ROOT/L 0; step back; R ok; resume; R ok y=7",
        &expect![[r"
            > break 1 after ROOT/L/R
            > break 2 before ROOT/C
            > start at ROOT/L
            enter ROOT
            set ROOT.v = 2
            enter ROOT/L
            enter ROOT/L/R
              run ROOT/L/R
            > R ok y=9
            leave ROOT/L/R ok y=9
            hit 1 at ROOT/L/R for the 1. time
            hold ROOT/L (Breakpoint(1))
            > force ROOT/L 0
            force ROOT/L ok
            leave ROOT/L ok y=4
            set ROOT.v = 4
            hit 2 at ROOT/C for the 1. time
            hold ROOT before ROOT/C (Breakpoint(2))
            > step back
            enter back 2 ROOT/L
            enter back 3 ROOT/L/R
              undo ROOT/L/R
            > R ok
            leave back 3 ROOT/L/R ok y=None
            leave back 2 ROOT/L ok y=None
            set ROOT.v = 2
            hold ROOT before ROOT/L (Start)
            > resume
            enter ROOT/L
            enter ROOT/L/R
              run ROOT/L/R
            > R ok y=7
            leave ROOT/L/R ok y=7
            hit 1 at ROOT/L/R for the 2. time
            hold ROOT/L (Breakpoint(1))
        "]],
    );
}

#[test]
fn one_state_is_preempted() {
    check(
        MACHINE,
        "start at ROOT/C; preempt ROOT/C/S; preempt ROOT/C/S; preempt ROOT/A; preempt ROOT/NO; S ok; T ok; unique_decider_state_id ok; preempt ROOT/H; B lost",
        &expect![[r"
        > start at ROOT/C
        enter ROOT
        set ROOT.v = 2
        enter ROOT/C
        enter ROOT/C/S
        enter ROOT/C/T
          fork 1
          run ROOT/C/S on 1
          fork 2
          run ROOT/C/T on 2
        > preempt ROOT/C/S
          preempt ROOT/C/S
        > preempt ROOT/C/S
        > preempt ROOT/A
        refused: 'ROOT/A' is not active; the snapshot lists what is
        > preempt ROOT/NO
        refused: there is no state at 'ROOT/NO': 'NO' is not inside 'ROOT'; paths are state ids from the root down, joined by '/'
        > S ok
        leave ROOT/C/S preempted
          end 1
        > T ok
        leave ROOT/C/T ok
        enter ROOT/C/unique_decider_state_id
          end 2
          run ROOT/C/unique_decider_state_id [S preempted] [T ok]
        > unique_decider_state_id ok
        leave ROOT/C/unique_decider_state_id ok
        leave ROOT/C ok
        enter ROOT/H
        enter ROOT/H/B
          run ROOT/H/B
        > preempt ROOT/H
          preempt ROOT/H
          preempt ROOT/H/B
        > B lost
        leave ROOT/H/B preempted
        leave ROOT/H preempted y=5
        set ROOT.v = 5
        leave ROOT preempted r=5
        finished
          end of run: preempted (-2) r=5 variables: v=5, 7 states
    "]],
    );
}
