//! The life of a run: its start and end, and the commands that are legal in each status.

use super::check;
use expect_test::expect;

const LEAF: &str = "execution ROOT\n  outcome ok";

#[test]
fn a_command_out_of_place_is_refused_and_changes_nothing() {
    check(
        LEAF,
        "pause; resume; stop; ROOT ok",
        &expect![[r"
        > pause
        refused: cannot pause: the run has not started; start it first
        > resume
        refused: cannot resume: the run has not started; start it first
        > stop
        refused: cannot stop: the run has not started; start it first
        > ROOT ok
        refused: frame 77.0 runs no script; a result is given once, with the frame of its job
    "]],
    );
    check(
        LEAF,
        "start; start; resume; pause; pause; start",
        &expect![[r"
            > start
            enter ROOT
              run ROOT
            > start
            refused: cannot start: the script of 'ROOT' runs; hold the run and wait for its end, or preempt it
            > resume
            refused: cannot resume: the run is running; it can be paused, stepped from its next states on, or stopped
            > pause
            paused
              paused true
            > pause
            refused: cannot pause: the run is paused; it can be resumed, stepped or stopped
            > start
            refused: cannot start: the script of 'ROOT' runs; hold the run and wait for its end, or preempt it
        "]],
    );
}

#[test]
fn a_run_that_stops_or_has_ended_takes_no_command_but_stop() {
    check(
        LEAF,
        "start; stop; pause; resume; start",
        &expect![[r"
            > start
            enter ROOT
              run ROOT
            > stop
            stopping
              preempt ROOT
            > pause
            refused: cannot pause: the run is stopping; it ends when its scripts do; stop again to run no more handlers
            > resume
            refused: cannot resume: the run is stopping; it ends when its scripts do; stop again to run no more handlers
            > start
            refused: cannot start: the run is stopping; it ends when its scripts do; stop again to run no more handlers
        "]],
    );
    check(
        LEAF,
        "start; ROOT ok; start; stop; pause; resume; ROOT ok",
        &expect![[r"
        > start
        enter ROOT
          run ROOT
        > ROOT ok
        leave ROOT ok
        finished
          end of run: ok (0), 1 states
        > start
        refused: cannot start: the run has finished; begin a new run
        > stop
        refused: cannot stop: the run has finished; begin a new run
        > pause
        refused: cannot pause: the run has finished; begin a new run
        > resume
        refused: cannot resume: the run has finished; begin a new run
        > ROOT ok
        refused: frame 77.0 runs no script; a result is given once, with the frame of its job
    "]],
    );
}

#[test]
fn a_stop_may_be_repeated() {
    check(
        LEAF,
        "start; stop; stop; ROOT ok",
        &expect![[r"
        > start
        enter ROOT
          run ROOT
        > stop
        stopping
          preempt ROOT
        > stop
        stopping
        > ROOT ok
        leave ROOT preempted
        finished
          end of run: preempted (-2), 1 states
    "]],
    );
}

#[test]
fn a_root_may_be_any_state() {
    check(
        LEAF,
        "start; ROOT ok",
        &expect![[r"
        > start
        enter ROOT
          run ROOT
        > ROOT ok
        leave ROOT ok
        finished
          end of run: ok (0), 1 states
    "]],
    );
    check(
        "library ROOT from \"x\"\n  missing \"gone\"",
        "start",
        &expect![[r#"
            > start
            enter ROOT
            error ROOT: missing library: gone
            leave ROOT aborted error="gone"
            finished
              end of run: aborted (-1) error="gone", 0 states
        "#]],
    );
}

const NESTED: &str = "
hierarchy ROOT
  outcome done
  start -> A ; A.ok -> H ; H.ok -> Z ; Z.ok -> H
  flow A.y -> H.x
  execution A
    outcome ok
    out y: int
  execution Z
    outcome ok
  hierarchy H
    outcome ok
    in x: int = 4
    start -> B ; B.ok -> L ; L.ok -> .ok
    flow .x -> L.x
    execution B
      outcome ok
    library L from \"x\"
      content
        hierarchy R
          outcome ok
          in x: int
          start -> C ; C.ok -> D ; D.ok -> .ok
          flow .x -> D.x
          execution C
            outcome ok
          execution D
            outcome ok
            in x: int
";

#[test]
fn a_run_may_start_inside() {
    check(
        NESTED,
        "start at ROOT/H/L/R/D; D ok; Z ok",
        &expect![[r"
        > start at ROOT/H/L/R/D
        enter ROOT
        enter ROOT/H x=4
        enter ROOT/H/L x=4
        enter ROOT/H/L/R x=4
        enter ROOT/H/L/R/D x=4
          run ROOT/H/L/R/D
        > D ok
        leave ROOT/H/L/R/D ok
        leave ROOT/H/L/R ok
        leave ROOT/H/L ok
        leave ROOT/H ok
        enter ROOT/Z
          run ROOT/Z
        > Z ok
        leave ROOT/Z ok
        enter ROOT/H x=4
        enter ROOT/H/B
          run ROOT/H/B
    "]],
    );
}

#[test]
fn a_run_may_start_at_a_container_or_at_the_root() {
    check(
        NESTED,
        "start at ROOT/H",
        &expect![[r"
        > start at ROOT/H
        enter ROOT
        enter ROOT/H x=4
        enter ROOT/H/B
          run ROOT/H/B
    "]],
    );
    check(
        NESTED,
        "start at ROOT",
        &expect![[r"
        > start at ROOT
        enter ROOT
        enter ROOT/A
          run ROOT/A
    "]],
    );
}

#[test]
fn a_start_at_an_unknown_state_is_refused() {
    check(
        NESTED,
        "start at ROOT/H/X/D; start at OTHER/H; start at ROOT/A/B; start",
        &expect![[r"
            > start at ROOT/H/X/D
            refused: there is no state at 'ROOT/H/X/D': 'X' is not inside 'ROOT/H'; paths are state ids from the root down, joined by '/'
            > start at OTHER/H
            refused: there is no state at 'OTHER/H': the root is not 'OTHER'; paths are state ids from the root down, joined by '/'
            > start at ROOT/A/B
            refused: there is no state at 'ROOT/A/B': 'B' is not inside 'ROOT/A'; paths are state ids from the root down, joined by '/'
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
        "]],
    );
}

#[test]
fn a_pause_at_the_start_keeps_the_place_to_start_at() {
    check(
        NESTED,
        "start at ROOT/H/B; pause; B ok; resume",
        &expect![[r"
            > start at ROOT/H/B
            enter ROOT
            enter ROOT/H x=4
            enter ROOT/H/B
              run ROOT/H/B
            > pause
            paused
              paused true
            > B ok
            leave ROOT/H/B ok
            hold ROOT/H before ROOT/H/L (Pause)
            > resume
            goes on
            enter ROOT/H/L x=4
            enter ROOT/H/L/R x=4
            enter ROOT/H/L/R/C
              paused false
              run ROOT/H/L/R/C
        "]],
    );
}

#[test]
fn a_start_inside_a_concurrency_state_starts_all_its_branches() {
    check(
        "
barrier ROOT
  outcome done
  unique_decider_state_id.ok -> .done
  hierarchy H
    outcome ok
    start -> A ; A.ok -> B ; B.ok -> .ok
    execution A
      outcome ok
    execution B
      outcome ok
  hierarchy I
    outcome ok
    start -> A ; A.ok -> B ; B.ok -> .ok
    execution A
      outcome ok
    execution B
      outcome ok
  decider unique_decider_state_id
    outcome ok
",
        "start at ROOT/H/B",
        &expect![[r"
            > start at ROOT/H/B
            enter ROOT
            enter ROOT/H
            enter ROOT/H/B
            enter ROOT/I
            enter ROOT/I/A
              fork 1
              run ROOT/H/B on 1
              fork 2
              run ROOT/I/A on 2
        "]],
    );
}

#[test]
fn the_end_tells_outcome_outputs_variables_and_count() {
    check(
        "
hierarchy ROOT
  outcome done
  out z: int = 1
  var v: int = 2
  start -> A
  A.aborted -> .done
  execution A
",
        "start; A raises \"boom\"",
        &expect![[r#"
            > start
            enter ROOT
            set ROOT.v = 2
            enter ROOT/A
              run ROOT/A
            > A raises "boom"
            leave ROOT/A aborted error="boom"
            leave ROOT done z=1 error="boom"
            finished
              end of run: done (0) z=1 error="boom" variables: v=2, 2 states
        "#]],
    );
}

#[test]
fn a_result_is_taken_once() {
    check(
        LEAF,
        "start; NOBODY ok; ROOT ok",
        &expect![[r"
        > start
        enter ROOT
          run ROOT
        > NOBODY ok
        refused: frame 77.0 runs no script; a result is given once, with the frame of its job
        > ROOT ok
        leave ROOT ok
        finished
          end of run: ok (0), 1 states
    "]],
    );
}
