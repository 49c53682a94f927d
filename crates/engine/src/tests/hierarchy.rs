//! Hierarchy states: order, start, loops, pause.

use super::check;
use expect_test::expect;

const TWO: &str = "
hierarchy ROOT
  outcome success
  start -> A
  A.ok -> B
  B.ok -> .success
  execution A
    outcome ok
  execution B
    outcome ok
";

#[test]
fn children_run_one_after_the_other() {
    check(
        TWO,
        "start; A ok; B ok",
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
        leave ROOT success
        finished
          end of run: success (0), 3 states
    "]],
    );
}

#[test]
fn income_may_lead_straight_to_an_outcome() {
    check(
        "
hierarchy ROOT
  outcome done
  in x: int = 4
  out y: int
  start -> .done
  flow .x -> .y
",
        "start",
        &expect![[r"
            > start
            enter ROOT x=4
            leave ROOT done y=4
            finished
              end of run: done (0) y=4, 1 states
        "]],
    );
}

#[test]
fn a_loop_runs_a_state_again_at_the_same_place() {
    check(
        "
hierarchy ROOT
  outcome done
  var n: int = 0
  start -> A
  A.more -> A ; A.done -> .done
  flow .n -> A.n ; A.n -> .n
  execution A
    outcome more
    outcome done
    in n: int
    out n: int
",
        "start; A more n=1; A more n=2; A done n=3",
        &expect![[r"
            > start
            enter ROOT
            set ROOT.n = 0
            enter ROOT/A n=0
              run ROOT/A
            > A more n=1
            leave ROOT/A more n=1
            set ROOT.n = 1
            enter ROOT/A n=1
              run ROOT/A
            > A more n=2
            leave ROOT/A more n=2
            set ROOT.n = 2
            enter ROOT/A n=2
              run ROOT/A
            > A done n=3
            leave ROOT/A done n=3
            set ROOT.n = 3
            leave ROOT done
            finished
              end of run: done (0) variables: n=3, 4 states
        "]],
    );
}

#[test]
fn an_unconnected_outcome_waits_until_it_is_stopped() {
    check(
        "
hierarchy ROOT
  outcome success
  start -> A
  execution A
    outcome ok
",
        "start; A ok; active; stop",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > A ok
            leave ROOT/A ok
            wait ROOT: no transition from ROOT/A ok
            > active
            ROOT Waiting(NoTransition { child: PathId(1), outcome: OutcomeId(0) })
            Running, 2 states run
            > stop
            stopping
            leave ROOT preempted
            finished
              preempt ROOT
              end of run: preempted (-2), 2 states
        "]],
    );
}

#[test]
fn a_missing_start_waits_until_it_is_stopped() {
    check(
        "hierarchy ROOT\n  outcome success",
        "start; active; stop",
        &expect![[r"
        > start
        enter ROOT
        wait ROOT: no start
        > active
        ROOT Waiting(NoStart)
        Running, 1 states run
        > stop
        stopping
        leave ROOT preempted
        finished
          preempt ROOT
          end of run: preempted (-2), 1 states
    "]],
    );
}

#[test]
fn a_pause_holds_before_the_next_child() {
    check(
        TWO,
        "start; pause; A ok; active; resume; B ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > pause
            paused
              paused true
            > A ok
            leave ROOT/A ok
            hold ROOT before ROOT/B (Pause)
            > active
            ROOT Held (Pause before ROOT/B)
            Paused, 2 states run
            > resume
            goes on
            enter ROOT/B
              paused false
              run ROOT/B
            > B ok
            leave ROOT/B ok
            leave ROOT success
            finished
              end of run: success (0), 3 states
        "]],
    );
}

#[test]
fn a_pause_does_not_hold_the_end_of_a_hierarchy() {
    check(
        TWO,
        "start; A ok; pause; B ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > A ok
        leave ROOT/A ok
        enter ROOT/B
          run ROOT/B
        > pause
        paused
          paused true
        > B ok
        leave ROOT/B ok
        leave ROOT success
        finished
          end of run: success (0), 3 states
    "]],
    );
}

#[test]
fn a_stop_ends_a_pause() {
    check(
        TWO,
        "start; pause; A ok; stop",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > pause
            paused
              paused true
            > A ok
            leave ROOT/A ok
            hold ROOT before ROOT/B (Pause)
            > stop
            goes on
            stopping
            leave ROOT preempted
            finished
              paused false
              preempt ROOT
              end of run: preempted (-2), 2 states
        "]],
    );
}

const TWO_BRANCHES: &str = "
preemptive ROOT
  outcome won
  H.success -> .won ; I.success -> .won
  hierarchy H
    outcome success
    start -> A ; A.ok -> B ; B.ok -> .success
    execution A
      outcome ok
    execution B
      outcome ok
  hierarchy I
    outcome success
    start -> A ; A.ok -> B ; B.ok -> .success
    execution A
      outcome ok
    execution B
      outcome ok
";

#[test]
fn branches_are_held_one_by_one() {
    check(
        TWO_BRANCHES,
        "start; pause; H/A ok; active; I/A ok; active; resume; H/B ok; I/B ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/H
            enter ROOT/H/A
            enter ROOT/I
            enter ROOT/I/A
              fork 1
              run ROOT/H/A on 1
              fork 2
              run ROOT/I/A on 2
            > pause
            paused
              paused true
            > H/A ok
            leave ROOT/H/A ok
            hold ROOT/H before ROOT/H/B (Pause)
            > active
            ROOT Inside
            ROOT/H Held (Pause before ROOT/H/B)
            ROOT/I Inside
            ROOT/I/A Script
            Paused, 5 states run
            > I/A ok
            leave ROOT/I/A ok
            hold ROOT/I before ROOT/I/B (Pause)
            > active
            ROOT Inside
            ROOT/H Held (Pause before ROOT/H/B)
            ROOT/I Held (Pause before ROOT/I/B)
            Paused, 5 states run
            > resume
            goes on
            enter ROOT/H/B
            enter ROOT/I/B
              paused false
              run ROOT/H/B on 1
              run ROOT/I/B on 2
            > H/B ok
            leave ROOT/H/B ok
            leave ROOT/H success
              end 1
              preempt ROOT/I
              preempt ROOT/I/B
            > I/B ok
            leave ROOT/I/B preempted
            leave ROOT/I preempted
            leave ROOT won
            finished
              end 2
              end of run: won (0), 7 states
        "]],
    );
}

#[test]
fn nesting_of_ten_thousand_levels_is_no_matter() {
    super::deep::check_depth(10_000);
}

#[test]
fn a_circle_without_a_script_aborts() {
    check(
        "
hierarchy ROOT
  outcome saved
  start -> H
  H.ok -> I ; I.ok -> H
  hierarchy H
    outcome ok
    start -> .ok
  hierarchy I
    outcome ok
    start -> .ok
",
        "start",
        &expect![[r#"
            > start
            enter ROOT
            enter ROOT/H
            leave ROOT/H ok
            enter ROOT/I
            leave ROOT/I ok
            enter ROOT/H
            leave ROOT/H ok
            enter ROOT/I
            leave ROOT/I ok
            enter ROOT/H
            leave ROOT/H ok
            enter ROOT/I
            leave ROOT/I ok
            enter ROOT/H
            leave ROOT/H ok
            leave ROOT aborted error="its children run in a circle in which there is no script; break the circle"
            finished
              end of run: aborted (-1) error="its children run in a circle in which there is no script; break the circle", 8 states
        "#]],
    );
}
