//! Steps back through hierarchies, libraries and branches, with restored data.
#![expect(clippy::too_many_lines, reason = "what a run does, forwards and back, is long to tell")]

use super::{check, check_change};
use expect_test::expect;

const NESTED: &str = "
hierarchy H
  outcome done
  start -> A ; A.ok -> I ; I.ok -> B ; B.ok -> .done
  execution A
    outcome ok
  hierarchy I
    outcome ok
    start -> X ; X.ok -> J ; J.ok -> Y ; Y.ok -> .ok
    execution X
      outcome ok
    hierarchy J
      outcome ok
      start -> P ; P.ok -> Q ; Q.ok -> .ok
      execution P
        outcome ok
      execution Q
        outcome ok
    execution Y
      outcome ok
  execution B
    outcome ok
";

#[test]
fn steps_back_undo_one_child_each() {
    check(
        NESTED,
        "start hold; step over; A ok; step over; X ok; P ok; Q ok; Y ok; step back; step back; Y ok; step back; step back; Q ok; step back; P ok; step back; X ok; step back; A ok; step back; step over; A ok",
        &expect![[r"
            > start hold
            enter H
            hold H before H/A (Start)
            > step over
            enter H/A
              run H/A
            > A ok
            leave H/A ok
            hold H before H/I (Step)
            > step over
            enter H/I
            enter H/I/X
              run H/I/X
            > X ok
            leave H/I/X ok
            enter H/I/J
            enter H/I/J/P
              run H/I/J/P
            > P ok
            leave H/I/J/P ok
            enter H/I/J/Q
              run H/I/J/Q
            > Q ok
            leave H/I/J/Q ok
            leave H/I/J ok
            enter H/I/Y
              run H/I/Y
            > Y ok
            leave H/I/Y ok
            leave H/I ok
            hold H before H/B (Step)
            > step back
            enter back 3 H/I
            hold H/I (Step)
            > step back
            enter back 8 H/I/Y
              undo H/I/Y
            > Y ok
            leave back 8 H/I/Y ok
            hold H/I before H/I/Y (Step)
            > step back
            enter back 5 H/I/J
            hold H/I/J (Step)
            > step back
            enter back 7 H/I/J/Q
              undo H/I/J/Q
            > Q ok
            leave back 7 H/I/J/Q ok
            hold H/I/J before H/I/J/Q (Step)
            > step back
            enter back 6 H/I/J/P
              undo H/I/J/P
            > P ok
            leave back 6 H/I/J/P ok
            leave back 5 H/I/J ok
            hold H/I before H/I/J (Step)
            > step back
            enter back 4 H/I/X
              undo H/I/X
            > X ok
            leave back 4 H/I/X ok
            leave back 3 H/I ok
            hold H before H/I (Step)
            > step back
            enter back 2 H/A
              undo H/A
            > A ok
            leave back 2 H/A ok
            hold H before H/A (Start)
            > step back
            refused: 'H' is held at its beginning, and nothing comes before; step forwards
            > step over
            enter H/A
              run H/A
            > A ok
            leave H/A ok
            hold H before H/I (Step)
        "]],
    );
}

#[test]
fn after_a_step_back_it_goes_on_forwards() {
    check(
        NESTED,
        "start hold; step over; A ok; step over; X ok; P ok; Q ok; Y ok; step back; step into; step back; step back; Y ok; step into; Y ok; step back; step back; Y ok; step back; step over; step over; Y ok; step over; B ok",
        &expect![[r"
            > start hold
            enter H
            hold H before H/A (Start)
            > step over
            enter H/A
              run H/A
            > A ok
            leave H/A ok
            hold H before H/I (Step)
            > step over
            enter H/I
            enter H/I/X
              run H/I/X
            > X ok
            leave H/I/X ok
            enter H/I/J
            enter H/I/J/P
              run H/I/J/P
            > P ok
            leave H/I/J/P ok
            enter H/I/J/Q
              run H/I/J/Q
            > Q ok
            leave H/I/J/Q ok
            leave H/I/J ok
            enter H/I/Y
              run H/I/Y
            > Y ok
            leave H/I/Y ok
            leave H/I ok
            hold H before H/B (Step)
            > step back
            enter back 3 H/I
            hold H/I (Step)
            > step into
            leave H/I ok
            hold H before H/B (Step)
            > step back
            enter back 3 H/I
            hold H/I (Step)
            > step back
            enter back 8 H/I/Y
              undo H/I/Y
            > Y ok
            leave back 8 H/I/Y ok
            hold H/I before H/I/Y (Step)
            > step into
            enter H/I/Y
              run H/I/Y
            > Y ok
            leave H/I/Y ok
            leave H/I ok
            hold H before H/B (Step)
            > step back
            enter back 3 H/I
            hold H/I (Step)
            > step back
            enter back 12 H/I/Y
              undo H/I/Y
            > Y ok
            leave back 12 H/I/Y ok
            hold H/I before H/I/Y (Step)
            > step back
            enter back 5 H/I/J
            hold H/I/J (Step)
            > step over
            leave H/I/J ok
            hold H/I before H/I/Y (Step)
            > step over
            enter H/I/Y
              run H/I/Y
            > Y ok
            leave H/I/Y ok
            leave H/I ok
            hold H before H/B (Step)
            > step over
            enter H/B
              run H/B
            > B ok
            leave H/B ok
            leave H done
            finished
              end of run: done (0), 11 states
        "]],
    );
}

#[test]
fn a_state_that_was_just_entered_is_left_by_one_step_back() {
    check(
        NESTED,
        "start hold; step over; A ok; step into; step back; step into; step into; X ok; step back; X ok; step back; A ok",
        &expect![[r"
            > start hold
            enter H
            hold H before H/A (Start)
            > step over
            enter H/A
              run H/A
            > A ok
            leave H/A ok
            hold H before H/I (Step)
            > step into
            enter H/I
            hold H/I before H/I/X (Step)
            > step back
            leave back 3 H/I preempted
            hold H before H/I (Step)
            > step into
            enter H/I
            hold H/I before H/I/X (Step)
            > step into
            enter H/I/X
              run H/I/X
            > X ok
            leave H/I/X ok
            hold H/I before H/I/J (Step)
            > step back
            enter back 5 H/I/X
              undo H/I/X
            > X ok
            leave back 5 H/I/X ok
            leave back 4 H/I preempted
            hold H before H/I (Step)
            > step back
            enter back 2 H/A
              undo H/A
            > A ok
            leave back 2 H/A ok
            hold H before H/A (Start)
        "]],
    );
}

const DATA: &str = "
hierarchy ROOT
  outcome done
  out r: int = 0
  var v: int = 1
  start -> A ; A.ok -> H ; A.aborted -> H ; H.ok -> B ; B.again -> A ; B.ok -> .done
  flow .v -> A.x ; A.y -> .v ; .v -> H.x ; H.y -> .v ; A.y -> B.a ; .v -> B.v ; .v -> .r
  execution A
    outcome ok
    in x: int = 0
    out y: int = 0
  hierarchy H
    outcome ok
    in x: int = 0
    out y: int = 0
    var w: int = 5
    start -> C ; C.ok -> .ok
    flow .x -> .w ; .w -> C.x ; C.y -> .w ; .w -> .y
    execution C
      outcome ok
      in x: int = 0
      out y: int = 0
  execution B
    outcome again
    outcome ok
    in a: int = 0
    in v: int = 0
";

#[test]
fn data_is_what_it_was_before() {
    check(
        DATA,
        "start hold; step over; A ok y=2; step over; C ok y=3; step over; B again; step over; A ok y=4; step back; A ok; step back; B ok; step back; step back; C ok; step back; A ok; step over; A ok y=7; step over; C ok y=8; step over; B ok",
        &expect![[r"
            > start hold
            enter ROOT
            set ROOT.v = 1
            hold ROOT before ROOT/A (Start)
            > step over
            enter ROOT/A x=1
              run ROOT/A
            > A ok y=2
            leave ROOT/A ok y=2
            set ROOT.v = 2
            hold ROOT before ROOT/H (Step)
            > step over
            enter ROOT/H x=2
            set ROOT/H.w = 5
            set ROOT/H.w = 2
            enter ROOT/H/C x=2
              run ROOT/H/C
            > C ok y=3
            leave ROOT/H/C ok y=3
            set ROOT/H.w = 3
            leave ROOT/H ok y=3
            set ROOT.v = 3
            hold ROOT before ROOT/B (Step)
            > step over
            enter ROOT/B a=2 v=3
              run ROOT/B
            > B again
            leave ROOT/B again
            hold ROOT before ROOT/A (Step)
            > step over
            enter ROOT/A x=3
              run ROOT/A
            > A ok y=4
            leave ROOT/A ok y=4
            set ROOT.v = 4
            hold ROOT before ROOT/H (Step)
            > step back
            enter back 6 ROOT/A x=4
              undo ROOT/A x=4
            > A ok
            leave back 6 ROOT/A ok y=None
            set ROOT.v = 3
            hold ROOT before ROOT/A (Step)
            > step back
            enter back 5 ROOT/B a=2 v=3
              undo ROOT/B a=2 v=3
            > B ok
            leave back 5 ROOT/B again
            hold ROOT before ROOT/B (Step)
            > step back
            enter back 3 ROOT/H x=2
            set ROOT/H.w = 3
            hold ROOT/H (Step)
            > step back
            enter back 4 ROOT/H/C x=3
              undo ROOT/H/C x=3
            > C ok
            leave back 4 ROOT/H/C ok y=None
            set ROOT/H.w = 2
            leave back 3 ROOT/H ok y=None
            set ROOT.v = 2
            hold ROOT before ROOT/H (Step)
            > step back
            enter back 2 ROOT/A x=2
              undo ROOT/A x=2
            > A ok
            leave back 2 ROOT/A ok y=None
            set ROOT.v = 1
            hold ROOT before ROOT/A (Start)
            > step over
            enter ROOT/A x=1
              run ROOT/A
            > A ok y=7
            leave ROOT/A ok y=7
            set ROOT.v = 7
            hold ROOT before ROOT/H (Step)
            > step over
            enter ROOT/H x=7
            set ROOT/H.w = 5
            set ROOT/H.w = 7
            enter ROOT/H/C x=7
              run ROOT/H/C
            > C ok y=8
            leave ROOT/H/C ok y=8
            set ROOT/H.w = 8
            leave ROOT/H ok y=8
            set ROOT.v = 8
            hold ROOT before ROOT/B (Step)
            > step over
            enter ROOT/B a=7 v=8
              run ROOT/B
            > B ok
            leave ROOT/B ok
            leave ROOT done r=8
            finished
              end of run: done (0) r=8 variables: v=8, 10 states
        "]],
    );
}

#[test]
fn an_error_is_what_it_was_before() {
    check(
        DATA,
        "start hold; step over; A raises \"boom\"; step back; A ok; step over; A raises \"boom\"; step over; C ok; step back; step back; C ok; step over; C ok",
        &expect![[r#"
            > start hold
            enter ROOT
            set ROOT.v = 1
            hold ROOT before ROOT/A (Start)
            > step over
            enter ROOT/A x=1
              run ROOT/A
            > A raises "boom"
            leave ROOT/A aborted y=0 error="boom"
            set ROOT.v = 0
            hold ROOT before ROOT/H (Step)
            > step back
            enter back 2 ROOT/A x=0
              undo ROOT/A x=0
            > A ok
            leave back 2 ROOT/A aborted y=None
            set ROOT.v = 1
            hold ROOT before ROOT/A (Start)
            > step over
            enter ROOT/A x=1
              run ROOT/A
            > A raises "boom"
            leave ROOT/A aborted y=0 error="boom"
            set ROOT.v = 0
            hold ROOT before ROOT/H (Step)
            > step over
            enter ROOT/H x=0
            set ROOT/H.w = 5
            set ROOT/H.w = 0
            enter ROOT/H/C x=0
              run ROOT/H/C
            > C ok
            leave ROOT/H/C ok y=0
            set ROOT/H.w = 0
            leave ROOT/H ok y=0
            set ROOT.v = 0
            hold ROOT before ROOT/B (Step)
            > step back
            enter back 5 ROOT/H x=0
            set ROOT/H.w = 0
            hold ROOT/H (Step)
            > step back
            enter back 6 ROOT/H/C x=0
              undo ROOT/H/C x=0
            > C ok
            leave back 6 ROOT/H/C ok y=None
            set ROOT/H.w = 0
            leave back 5 ROOT/H ok y=None
            set ROOT.v = 0
            hold ROOT before ROOT/H (Step)
            > step over
            enter ROOT/H x=0
            set ROOT/H.w = 5
            set ROOT/H.w = 0
            enter ROOT/H/C x=0
              run ROOT/H/C
            > C ok
            leave ROOT/H/C ok y=0
            set ROOT/H.w = 0
            leave ROOT/H ok y=0
            set ROOT.v = 0
            hold ROOT before ROOT/B (Step)
        "#]],
    );
}
const LIBRARY: &str = r#"
hierarchy ROOT
  outcome done
  start -> L ; L.ok -> M ; M.ok -> Z ; Z.ok -> .done
  library L from "some/library"
    content
      hierarchy R
        outcome ok
        start -> A ; A.ok -> B ; B.ok -> .ok
        execution A
          outcome ok
        execution B
          outcome ok
  library M from "some/script"
    content
      execution R
        outcome ok
  execution Z
    outcome ok
"#;

#[test]
fn a_library_is_one_step_back() {
    check(
        LIBRARY,
        "start hold; step over; A ok; B ok; step over; M/R ok; step back; M/R ok; step back; step back; B ok; step back; A ok; step over; A ok",
        &expect![[r"
            > start hold
            enter ROOT
            hold ROOT before ROOT/L (Start)
            > step over
            enter ROOT/L
            enter ROOT/L/R
            enter ROOT/L/R/A
              run ROOT/L/R/A
            > A ok
            leave ROOT/L/R/A ok
            enter ROOT/L/R/B
              run ROOT/L/R/B
            > B ok
            leave ROOT/L/R/B ok
            leave ROOT/L/R ok
            leave ROOT/L ok
            hold ROOT before ROOT/M (Step)
            > step over
            enter ROOT/M
            enter ROOT/M/R
              run ROOT/M/R
            > M/R ok
            leave ROOT/M/R ok
            leave ROOT/M ok
            hold ROOT before ROOT/Z (Step)
            > step back
            enter back 6 ROOT/M
            enter back 7 ROOT/M/R
              undo ROOT/M/R
            > M/R ok
            leave back 7 ROOT/M/R ok
            leave back 6 ROOT/M ok
            hold ROOT before ROOT/M (Step)
            > step back
            enter back 2 ROOT/L
            enter back 3 ROOT/L/R
            hold ROOT/L/R (Step)
            > step back
            enter back 5 ROOT/L/R/B
              undo ROOT/L/R/B
            > B ok
            leave back 5 ROOT/L/R/B ok
            hold ROOT/L/R before ROOT/L/R/B (Step)
            > step back
            enter back 4 ROOT/L/R/A
              undo ROOT/L/R/A
            > A ok
            leave back 4 ROOT/L/R/A ok
            leave back 3 ROOT/L/R ok
            leave back 2 ROOT/L ok
            hold ROOT before ROOT/L (Start)
            > step over
            enter ROOT/L
            enter ROOT/L/R
            enter ROOT/L/R/A
              run ROOT/L/R/A
            > A ok
            leave ROOT/L/R/A ok
            enter ROOT/L/R/B
              run ROOT/L/R/B
        "]],
    );
}

#[test]
fn a_library_that_is_missing_is_passed_over() {
    check(
        "
hierarchy ROOT
  outcome done
  start -> A ; A.ok -> L ; L.aborted -> B ; B.ok -> .done
  execution A
    outcome ok
  library L from \"gone\"
    missing \"it is gone\"
  execution B
    outcome ok
",
        "start hold; step over; A ok; step over; step back; step back; A ok",
        &expect![[r#"
            > start hold
            enter ROOT
            hold ROOT before ROOT/A (Start)
            > step over
            enter ROOT/A
              run ROOT/A
            > A ok
            leave ROOT/A ok
            hold ROOT before ROOT/L (Step)
            > step over
            enter ROOT/L
            error ROOT/L: missing library: it is gone
            leave ROOT/L aborted error="it is gone"
            hold ROOT before ROOT/B (Step)
            > step back
            enter back 3 ROOT/L
            leave back 3 ROOT/L aborted
            hold ROOT before ROOT/L (Step)
            > step back
            enter back 2 ROOT/A
              undo ROOT/A
            > A ok
            leave back 2 ROOT/A ok
            hold ROOT before ROOT/A (Start)
        "#]],
    );
}

#[test]
fn a_step_back_that_is_not_possible_is_refused() {
    check(
        NESTED,
        "start; step back; pause; step back; A ok; start hold at H/I/J; step back; step into; step back; step into; step into; stop; step back",
        &expect![[r"
            > start
            enter H
            enter H/A
              run H/A
            > step back
            refused: cannot step: the run is running; it can be paused, stepped from its next states on, or stopped
            > pause
            paused
              paused true
            > step back
            refused: nothing is held in this run; wait until a branch comes to its next state
            > A ok
            leave H/A ok
            hold H before H/I (Pause)
            > start hold at H/I/J
            goes on
            drop H
            enter H
            enter H/I
            hold H/I before H/I/J (Start)
              paused false
            > step back
            leave back 4 H/I preempted
            hold H before H/I (Start)
            > step into
            enter H/I
            hold H/I before H/I/J (Step)
            > step back
            leave back 5 H/I preempted
            hold H before H/I (Start)
            > step into
            enter H/I
            hold H/I before H/I/J (Step)
            > step into
            enter H/I/J
            hold H/I/J before H/I/J/P (Step)
            > stop
            stopping
            leave H/I/J preempted
            leave H/I preempted
            leave H preempted
            finished
              preempt H
              preempt H/I
              preempt H/I/J
              end of run: preempted (-2), 7 states
            > step back
            refused: cannot step: the run has finished; begin a new run
        "]],
    );
}

#[test]
fn a_stop_while_a_child_of_a_hierarchy_is_undone_ends_the_run() {
    check(
        NESTED,
        "start hold; step over; A ok; step back; stop; A ok",
        &expect![[r"
        > start hold
        enter H
        hold H before H/A (Start)
        > step over
        enter H/A
          run H/A
        > A ok
        leave H/A ok
        hold H before H/I (Step)
        > step back
        enter back 2 H/A
          undo H/A
        > stop
        stopping
          preempt H
          preempt H/A
        > A ok
        leave back 2 H/A ok
        leave H preempted
        finished
          end of run: preempted (-2), 2 states
    "]],
    );
}

#[test]
fn a_skipped_state_is_undone_without_running() {
    check(
        NESTED,
        "start hold; force H/A 0; step back; active; step over; A ok",
        &expect![[r"
        > start hold
        enter H
        hold H before H/A (Start)
        > force H/A 0
        force H/A ok
        hold H before H/I (Step)
        > step back
        hold H before H/A (Start)
        > active
        H Held (Start before H/A)
        Stepping, 1 states run
        > step over
        enter H/A
          run H/A
        > A ok
        leave H/A ok
        hold H before H/I (Step)
    "]],
    );
}

#[test]
fn what_waits_is_stepped_back() {
    check(
        "
hierarchy ROOT
  outcome done
  start -> A ; A.ok -> B
  execution A
    outcome ok
  execution B
    outcome ok
",
        "start; A ok; B ok; step back; step mode; step back; B ok; step back; A ok; step back; resume; A ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > A ok
            leave ROOT/A ok
            enter ROOT/B
              run ROOT/B
            > B ok
            leave ROOT/B ok
            wait ROOT: no transition from ROOT/B ok
            > step back
            refused: cannot step: the run is running; it can be paused, stepped from its next states on, or stopped
            > step mode
            > step back
            enter back 3 ROOT/B
              undo ROOT/B
            > B ok
            leave back 3 ROOT/B ok
            hold ROOT before ROOT/B (Step)
            > step back
            enter back 2 ROOT/A
              undo ROOT/A
            > A ok
            leave back 2 ROOT/A ok
            hold ROOT before ROOT/A (Start)
            > step back
            refused: 'ROOT' is held at its beginning, and nothing comes before; step forwards
            > resume
            enter ROOT/A
              run ROOT/A
            > A ok
            leave ROOT/A ok
            enter ROOT/B
              run ROOT/B
        "]],
    );
}

#[test]
fn a_pause_becomes_steps_back() {
    check(
        NESTED,
        "start; A ok; pause; X ok; step back; X ok; step back; A ok",
        &expect![[r"
        > start
        enter H
        enter H/A
          run H/A
        > A ok
        leave H/A ok
        enter H/I
        enter H/I/X
          run H/I/X
        > pause
        paused
          paused true
        > X ok
        leave H/I/X ok
        hold H/I before H/I/J (Pause)
        > step back
        goes on
        enter back 4 H/I/X
          paused false
          undo H/I/X
        > X ok
        leave back 4 H/I/X ok
        leave back 3 H/I preempted
        hold H before H/I (Step)
        > step back
        enter back 2 H/A
          undo H/A
        > A ok
        leave back 2 H/A ok
        hold H before H/A (Start)
    "]],
    );
}

#[test]
fn a_breakpoint_holds_again_after_a_step_back() {
    check(
        NESTED,
        "break 1 before H/I; start; A ok; step back; A ok; resume; A ok; unbreak 1; resume; X ok; P ok; Q ok",
        &expect![[r"
            > break 1 before H/I
            > start
            enter H
            enter H/A
              run H/A
            > A ok
            leave H/A ok
            hit 1 at H/I for the 1. time
            hold H before H/I (Breakpoint(1))
            > step back
            enter back 2 H/A
              undo H/A
            > A ok
            leave back 2 H/A ok
            hold H before H/A (Start)
            > resume
            enter H/A
              run H/A
            > A ok
            leave H/A ok
            hit 1 at H/I for the 2. time
            hold H before H/I (Breakpoint(1))
            > unbreak 1
            > resume
            enter H/I
            enter H/I/X
              run H/I/X
            > X ok
            leave H/I/X ok
            enter H/I/J
            enter H/I/J/P
              run H/I/J/P
            > P ok
            leave H/I/J/P ok
            enter H/I/J/Q
              run H/I/J/Q
            > Q ok
            leave H/I/J/Q ok
            leave H/I/J ok
            enter H/I/Y
              run H/I/Y
        "]],
    );
}

#[test]
fn a_run_without_history_is_not_stepped_back() {
    check(
        NESTED,
        "trail off; start hold; step over; A ok; step back",
        &expect![[r"
        > trail off
        > start hold
        enter H
        hold H before H/A (Start)
        > step over
        enter H/A
          run H/A
        > A ok
        leave H/A ok
        hold H before H/I (Step)
        > step back
        refused: this run keeps no history to step back in; start a run that keeps one
    "]],
    );
}

const RING: &str = "
hierarchy ROOT
  outcome done
  var n: int = 0
  start -> A ; A.ok -> A ; A.done -> .done
  flow .n -> A.x ; A.y -> .n
  execution A
    outcome ok
    outcome done
    in x: int = 0
    out y: int = 0
";

#[test]
fn the_oldest_steps_are_given_up() {
    let many = "A ok y=7; ".repeat(503);
    let script = format!(
        "trail 2; start; {many}step mode; A ok y=9; step back; A ok; step back; A ok; step back; A ok; step back"
    );
    let text = super::world::World::new(RING).play(&script);
    let end = text.rfind("> step mode").unwrap_or_default();
    expect![[r"
        > step mode
        > A ok y=9
        leave ROOT/A ok y=9
        set ROOT.n = 9
        hold ROOT before ROOT/A (Step)
        > step back
        enter back 505 ROOT/A x=9
          undo ROOT/A x=9
        > A ok
        leave back 505 ROOT/A ok y=None
        set ROOT.n = 7
        hold ROOT before ROOT/A (Step)
        > step back
        enter back 504 ROOT/A x=7
          undo ROOT/A x=7
        > A ok
        leave back 504 ROOT/A ok y=None
        set ROOT.n = 7
        hold ROOT before ROOT/A (Step)
        > step back
        enter back 503 ROOT/A x=7
          undo ROOT/A x=7
        > A ok
        leave back 503 ROOT/A ok y=None
        set ROOT.n = 7
        hold ROOT before ROOT/A (Step)
        > step back
        refused: cannot step back in 'ROOT': its data is lost, because it is too long ago, its states have changed since, or the run was resumed after it; start again at a moment of the history
    "]].assert_eq(&text[end..]);
}

#[test]
fn what_lies_too_deep_is_given_up() {
    let levels = 203;
    let level = |level: usize| {
        let (indent, below) = (" ".repeat(level), level + 1);
        format!(
            "{indent}hierarchy S{level}\n{indent} outcome done\n{indent} start -> S{below} ; S{below}.done -> .done\n"
        )
    };
    let floors = (0..levels).map(level).collect::<String>();
    let indent = " ".repeat(levels);
    let machine = format!("{floors}{indent}execution S{levels}\n{indent} outcome done\n")
        + " execution Z\n  outcome done\n";
    let machine = machine.replacen("S1.done -> .done", "S1.done -> Z ; Z.done -> .done", 1);
    let text = super::world::World::new(&machine)
        .play("start hold; step over; S203 done; step back; step back");
    let end = text.find("> step back").unwrap_or_default();
    expect![[r"
        > step back
        enter back 2 S0/S1
        hold S0/S1 (Step)
        > step back
        refused: cannot step back in 'S0/S1': its data is lost, because it is too long ago, its states have changed since, or the run was resumed after it; start again at a moment of the history
    "]].assert_eq(&text[end..]);
}

const CHANGED: &str = "
hierarchy ROOT
  outcome done
  var v: int = 1
  var w: int = 2
  start -> N ; N.ok -> H ; H.ok -> B ; B.ok -> C ; C.ok -> .done
  flow N.y -> .v ; B.y -> .w ; .w -> C.x
  hierarchy H
    outcome ok
    start -> X ; X.ok -> .ok
    execution X
      outcome ok
    execution Y
      outcome ok
  execution A
    outcome ok
  execution B
    outcome ok
    out y: int = 0
  execution C
    outcome ok
    in x: int = 0
  execution N
    outcome ok
    out y: int = 0
";

#[test]
fn steps_across_what_is_gone_are_refused() {
    let after = CHANGED
        .replace("start -> N ; N.ok -> H", "start -> H")
        .replace("flow N.y -> .v ; ", "flow ")
        .replace("  execution N\n    outcome ok\n    out y: int = 0\n", "");
    check_change(
        CHANGED,
        &after,
        "start hold; step over; N ok y=3; step over; X ok; step over; B ok y=4; change; step back; B ok; step back; step back; X ok; step back",
        &expect![[r"
            > start hold
            enter ROOT
            set ROOT.v = 1
            set ROOT.w = 2
            hold ROOT before ROOT/N (Start)
            > step over
            enter ROOT/N
              run ROOT/N
            > N ok y=3
            leave ROOT/N ok y=3
            set ROOT.v = 3
            hold ROOT before ROOT/H (Step)
            > step over
            enter ROOT/H
            enter ROOT/H/X
              run ROOT/H/X
            > X ok
            leave ROOT/H/X ok
            leave ROOT/H ok
            hold ROOT before ROOT/B (Step)
            > step over
            enter ROOT/B
              run ROOT/B
            > B ok y=4
            leave ROOT/B ok y=4
            set ROOT.w = 4
            hold ROOT before ROOT/C (Step)
            > change
            changed
            > step back
            enter back 5 ROOT/B
              undo ROOT/B
            > B ok
            leave back 5 ROOT/B ok y=None
            set ROOT.w = 2
            hold ROOT before ROOT/B (Step)
            > step back
            refused: cannot step back in 'ROOT': its data is lost, because it is too long ago, its states have changed since, or the run was resumed after it; start again at a moment of the history
            > step back
            refused: cannot step back in 'ROOT': its data is lost, because it is too long ago, its states have changed since, or the run was resumed after it; start again at a moment of the history
            > X ok
            refused: frame 77.0 runs no script; a result is given once, with the frame of its job
            > step back
            refused: cannot step back in 'ROOT': its data is lost, because it is too long ago, its states have changed since, or the run was resumed after it; start again at a moment of the history
        "]],
    );
}

#[test]
fn steps_into_what_holds_other_data_are_refused() {
    let after = CHANGED.replace("    execution Y\n      outcome ok\n", "");
    check_change(
        CHANGED,
        &after,
        "start hold; step over; N ok y=3; step over; X ok; step over; B ok y=4; change; step back; B ok; step back; step over; B ok",
        &expect![[r"
            > start hold
            enter ROOT
            set ROOT.v = 1
            set ROOT.w = 2
            hold ROOT before ROOT/N (Start)
            > step over
            enter ROOT/N
              run ROOT/N
            > N ok y=3
            leave ROOT/N ok y=3
            set ROOT.v = 3
            hold ROOT before ROOT/H (Step)
            > step over
            enter ROOT/H
            enter ROOT/H/X
              run ROOT/H/X
            > X ok
            leave ROOT/H/X ok
            leave ROOT/H ok
            hold ROOT before ROOT/B (Step)
            > step over
            enter ROOT/B
              run ROOT/B
            > B ok y=4
            leave ROOT/B ok y=4
            set ROOT.w = 4
            hold ROOT before ROOT/C (Step)
            > change
            changed
            > step back
            enter back 5 ROOT/B
              undo ROOT/B
            > B ok
            leave back 5 ROOT/B ok y=None
            set ROOT.w = 2
            hold ROOT before ROOT/B (Step)
            > step back
            refused: cannot step back in 'ROOT': its data is lost, because it is too long ago, its states have changed since, or the run was resumed after it; start again at a moment of the history
            > step over
            enter ROOT/B
              run ROOT/B
            > B ok
            leave ROOT/B ok y=0
            set ROOT.w = 0
            hold ROOT before ROOT/C (Step)
        "]],
    );
}

#[test]
fn a_change_of_variables_keeps_the_way_back() {
    let after = CHANGED.replace("  var w: int = 2\n", "  var w: int = 2\n  var a: int = 7\n");
    check_change(
        CHANGED,
        &after,
        "start hold; step over; N ok y=3; step over; X ok; step over; B ok y=4; change; step back; B ok; step back; step back; X ok; step back; N ok",
        &expect![[r"
            > start hold
            enter ROOT
            set ROOT.v = 1
            set ROOT.w = 2
            hold ROOT before ROOT/N (Start)
            > step over
            enter ROOT/N
              run ROOT/N
            > N ok y=3
            leave ROOT/N ok y=3
            set ROOT.v = 3
            hold ROOT before ROOT/H (Step)
            > step over
            enter ROOT/H
            enter ROOT/H/X
              run ROOT/H/X
            > X ok
            leave ROOT/H/X ok
            leave ROOT/H ok
            hold ROOT before ROOT/B (Step)
            > step over
            enter ROOT/B
              run ROOT/B
            > B ok y=4
            leave ROOT/B ok y=4
            set ROOT.w = 4
            hold ROOT before ROOT/C (Step)
            > change
            changed
            set ROOT.a = 7
            > step back
            enter back 5 ROOT/B
              undo ROOT/B
            > B ok
            leave back 5 ROOT/B ok y=None
            set ROOT.w = 2
            hold ROOT before ROOT/B (Step)
            > step back
            enter back 3 ROOT/H
            hold ROOT/H (Step)
            > step back
            enter back 4 ROOT/H/X
              undo ROOT/H/X
            > X ok
            leave back 4 ROOT/H/X ok
            leave back 3 ROOT/H ok
            hold ROOT before ROOT/H (Step)
            > step back
            enter back 2 ROOT/N
              undo ROOT/N
            > N ok
            leave back 2 ROOT/N ok y=None
            set ROOT.v = 1
            hold ROOT before ROOT/N (Start)
        "]],
    );
}

#[test]
fn a_root_of_a_library_that_was_skipped_is_not_entered_backwards() {
    check(
        LIBRARY,
        "start hold; run to ROOT/L/R; force ROOT/L/R 0; step back",
        &expect![[r"
            > start hold
            enter ROOT
            hold ROOT before ROOT/L (Start)
            > run to ROOT/L/R
            enter ROOT/L
            hold ROOT/L before ROOT/L/R (RunTo)
            > force ROOT/L/R 0
            force ROOT/L/R ok
            leave ROOT/L ok
            hold ROOT before ROOT/M (Step)
            > step back
            enter back 2 ROOT/L
            leave back 2 ROOT/L ok
            hold ROOT before ROOT/L (Start)
        "]],
    );
}
