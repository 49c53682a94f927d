//! Starts of a run: held, inside, with values, once or again.

use super::check;
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
fn a_start_may_hold_before_the_first_child() {
    check(
        NESTED,
        "start hold; active; resume",
        &expect![[r"
        > start hold
        enter H
        hold H before H/A (Start)
        > active
        H Held (Start before H/A)
        Stepping, 1 states run
        > resume
        enter H/A
          run H/A
    "]],
    );
}

#[test]
fn a_start_inside_may_hold_there() {
    check(
        NESTED,
        "start hold at H/I/J/Q; active; step into; Q ok; active",
        &expect![[r"
            > start hold at H/I/J/Q
            enter H
            enter H/I
            enter H/I/J
            hold H/I/J before H/I/J/Q (Start)
            > active
            H Inside
            H/I Inside
            H/I/J Held (Start before H/I/J/Q)
            Stepping, 3 states run
            > step into
            enter H/I/J/Q
              run H/I/J/Q
            > Q ok
            leave H/I/J/Q ok
            leave H/I/J ok
            hold H/I before H/I/Y (Step)
            > active
            H Inside
            H/I Held (Step before H/I/Y)
            Stepping, 4 states run
        "]],
    );
}

#[test]
fn a_start_holds_before_a_root_that_is_a_script() {
    check(
        "execution ROOT
  outcome ok",
        "start hold; active; resume; ROOT ok",
        &expect![[r"
      > start hold
      hold ROOT before ROOT (Start)
      > active
      Stepping, 0 states run
      > resume
      enter ROOT
        run ROOT
      > ROOT ok
      leave ROOT ok
      finished
        end of run: ok (0), 1 states
  "]],
    );
}

#[test]
fn a_start_holds_before_the_branches_of_a_root() {
    check(
        "
preemptive ROOT
  outcome won
  A.ok -> .won ; B.ok -> .won
  execution A
    outcome ok
  execution B
    outcome ok
",
        "start hold; active; step into ROOT/B; step over; A ok; B ok",
        &expect![[r"
    > start hold
    enter ROOT
    hold ROOT before ROOT/A (Start)
    hold ROOT before ROOT/B (Start)
      fork 1
      fork 2
    > active
    ROOT Inside (Start before ROOT/A) (Start before ROOT/B)
    Stepping, 1 states run
    > step into ROOT/B
    enter ROOT/B
      run ROOT/B on 2
    > step over
    enter ROOT/A
      run ROOT/A on 1
    > A ok
    leave ROOT/A ok
      end 1
      preempt ROOT/B
    > B ok
    leave ROOT/B preempted
    leave ROOT won
    finished
      end 2
      end of run: won (0), 3 states
"]],
    );
}

#[test]
fn a_start_may_hold_behind_its_state() {
    check(
        NESTED,
        "start at H/I/J/P then hold; P ok; active; resume",
        &expect![[r"
            > start at H/I/J/P then hold
            enter H
            enter H/I
            enter H/I/J
            enter H/I/J/P
              run H/I/J/P
            > P ok
            leave H/I/J/P ok
            hold H/I/J before H/I/J/Q (Step)
            > active
            H Inside
            H/I Inside
            H/I/J Held (Step before H/I/J/Q)
            Stepping, 4 states run
            > resume
            enter H/I/J/Q
              run H/I/J/Q
        "]],
    );
}

#[test]
fn a_start_may_stop_behind_its_state() {
    check(
        NESTED,
        "start at H/I/J then stop; P ok; Q ok",
        &expect![[r"
        > start at H/I/J then stop
        enter H
        enter H/I
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
        stopping
        leave H/I preempted
        leave H preempted
        finished
          preempt H
          preempt H/I
          end of run: preempted (-2), 5 states
    "]],
    );
}

#[test]
fn a_start_that_stops_behind_the_last_state_ends_as_it_does() {
    check(
        NESTED,
        "start at H/B then stop; B ok",
        &expect![[r"
        > start at H/B then stop
        enter H
        enter H/B
          run H/B
        > B ok
        leave H/B ok
        leave H done
        finished
          end of run: done (0), 2 states
    "]],
    );
}

const BRANCHES: &str = "
hierarchy ROOT
  outcome done
  start -> C ; C.done -> Z ; Z.ok -> .done
  barrier C
    outcome done
    unique_decider_state_id.ok -> .done
    hierarchy F
      outcome ok
      start -> A ; A.ok -> B ; B.ok -> .ok
      execution A
        outcome ok
      execution B
        outcome ok
    hierarchy G
      outcome ok
      start -> A ; A.ok -> B ; B.ok -> .ok
      execution A
        outcome ok
      execution B
        outcome ok
    execution S
      outcome ok
    decider unique_decider_state_id
      outcome ok
  execution Z
    outcome ok
";

#[test]
fn of_a_start_inside_a_concurrency_state_the_outermost_counts() {
    check(
        BRANCHES,
        "start at ROOT/C/F/B then hold; F/B ok; G/A ok; G/B ok; S ok; unique_decider_state_id ok; active",
        &expect![[r"
            > start at ROOT/C/F/B then hold
            enter ROOT
            enter ROOT/C
            enter ROOT/C/F
            enter ROOT/C/F/B
            enter ROOT/C/G
            enter ROOT/C/G/A
            enter ROOT/C/S
              fork 1
              run ROOT/C/F/B on 1
              fork 2
              run ROOT/C/G/A on 2
              fork 3
              run ROOT/C/S on 3
            > F/B ok
            leave ROOT/C/F/B ok
            leave ROOT/C/F ok
              end 1
            > G/A ok
            leave ROOT/C/G/A ok
            enter ROOT/C/G/B
              run ROOT/C/G/B on 2
            > G/B ok
            leave ROOT/C/G/B ok
            leave ROOT/C/G ok
              end 2
            > S ok
            leave ROOT/C/S ok
            enter ROOT/C/unique_decider_state_id
              end 3
              run ROOT/C/unique_decider_state_id [F ok] [G ok] [S ok]
            > unique_decider_state_id ok
            leave ROOT/C/unique_decider_state_id ok
            leave ROOT/C done
            hold ROOT before ROOT/Z (Step)
            > active
            ROOT Held (Step before ROOT/Z)
            Stepping, 9 states run
        "]],
    );
}

const DATA: &str = "
hierarchy ROOT
  outcome done
  in x: int = 1
  var v: int = 2
  flow .x -> H.a
  start -> H ; H.ok -> .done
  hierarchy H
    outcome ok
    in a: int = 3
    var w: int = 4
    start -> A ; A.ok -> A
    flow .a -> .w ; .w -> A.n
    execution A
      outcome ok
      in n: int = 5
";

#[test]
fn a_start_gives_values_to_states_on_the_way() {
    check(
        DATA,
        "start at ROOT/H/A ROOT.v=9 ROOT/H.w=8; A ok",
        &expect![[r"
        > start at ROOT/H/A ROOT.v=9 ROOT/H.w=8
        enter ROOT x=1
        set ROOT.v = 2
        set ROOT.v = 9
        enter ROOT/H a=1
        set ROOT/H.w = 4
        set ROOT/H.w = 1
        set ROOT/H.w = 8
        enter ROOT/H/A n=8
          run ROOT/H/A
        > A ok
        leave ROOT/H/A ok
        enter ROOT/H/A n=8
          run ROOT/H/A
    "]],
    );
}

#[test]
fn a_value_counts_at_the_first_entry_only() {
    check(
        DATA,
        "start at ROOT/H/A ROOT.x=7 ROOT/H.a=6 ROOT/H/A.n=5; A ok",
        &expect![[r"
        > start at ROOT/H/A ROOT.x=7 ROOT/H.a=6 ROOT/H/A.n=5
        enter ROOT x=7
        set ROOT.v = 2
        enter ROOT/H a=6
        set ROOT/H.w = 4
        set ROOT/H.w = 6
        enter ROOT/H/A n=5
          run ROOT/H/A
        > A ok
        leave ROOT/H/A ok
        enter ROOT/H/A n=6
          run ROOT/H/A
    "]],
    );
}

#[test]
fn a_value_for_something_else_is_refused() {
    check(
        DATA,
        "start at ROOT/H ROOT/H/A.n=1; start at ROOT/H ROOT/H.zz=1; start ROOT/H.a=1; start ROOT.x=8",
        &expect![[r"
        > start at ROOT/H ROOT/H/A.n=1
        refused: cannot start with a value for 'n' of 'ROOT/H/A': values are for input ports and scoped variables of the state that is begun at, and of those around it
        > start at ROOT/H ROOT/H.zz=1
        refused: cannot start with a value for 'zz' of 'ROOT/H': values are for input ports and scoped variables of the state that is begun at, and of those around it
        > start ROOT/H.a=1
        refused: cannot start with a value for 'a' of 'ROOT/H': values are for input ports and scoped variables of the state that is begun at, and of those around it
        > start ROOT.x=8
        enter ROOT x=8
        set ROOT.v = 2
        enter ROOT/H a=8
        set ROOT/H.w = 4
        set ROOT/H.w = 8
        enter ROOT/H/A n=8
          run ROOT/H/A
    "]],
    );
}

#[test]
fn a_run_begins_again_while_everything_is_held() {
    check(
        NESTED,
        "start; start at H/B; pause; A ok; start at H/I/Y; Y ok; active",
        &expect![[r"
        > start
        enter H
        enter H/A
          run H/A
        > start at H/B
        refused: cannot start: the script of 'H/A' runs; hold the run and wait for its end, or preempt it
        > pause
        paused
          paused true
        > A ok
        leave H/A ok
        hold H before H/I (Pause)
        > start at H/I/Y
        goes on
        drop H
        enter H
        enter H/I
        enter H/I/Y
          paused false
          run H/I/Y
        > Y ok
        leave H/I/Y ok
        leave H/I ok
        enter H/B
          run H/B
        > active
        H Inside
        H/B Script
        Running, 6 states run
    "]],
    );
}

#[test]
fn a_run_begins_again_with_all_its_branches() {
    check(
        BRANCHES,
        "start hold; step into; S ok; start hold; step into; start at ROOT/Z; S ok; start at ROOT/Z; Z ok",
        &expect![[r"
        > start hold
        enter ROOT
        hold ROOT before ROOT/C (Start)
        > step into
        enter ROOT/C
        enter ROOT/C/F
        hold ROOT/C/F before ROOT/C/F/A (Step)
        enter ROOT/C/G
        hold ROOT/C/G before ROOT/C/G/A (Step)
        enter ROOT/C/S
          fork 1
          fork 2
          fork 3
          run ROOT/C/S on 3
        > S ok
        leave ROOT/C/S ok
          end 3
        > start hold
        drop ROOT
        drop ROOT/C
        drop ROOT/C/F
        drop ROOT/C/G
        enter ROOT
        hold ROOT before ROOT/C (Start)
          end 2
          end 1
        > step into
        enter ROOT/C
        enter ROOT/C/F
        hold ROOT/C/F before ROOT/C/F/A (Step)
        enter ROOT/C/G
        hold ROOT/C/G before ROOT/C/G/A (Step)
        enter ROOT/C/S
          fork 2
          fork 1
          fork 3
          run ROOT/C/S on 3
        > start at ROOT/Z
        refused: cannot start: the script of 'ROOT/C/S' runs; hold the run and wait for its end, or preempt it
        > S ok
        leave ROOT/C/S ok
          end 3
        > start at ROOT/Z
        drop ROOT
        drop ROOT/C
        drop ROOT/C/F
        drop ROOT/C/G
        enter ROOT
        enter ROOT/Z
          end 1
          end 2
          run ROOT/Z
        > Z ok
        leave ROOT/Z ok
        leave ROOT done
        finished
          end of run: done (0), 12 states
    "]],
    );
}

#[test]
fn a_run_begins_again_while_it_waits_or_is_held_outside() {
    check(
        LOST,
        "start; A ok; break 1 before ROOT; start; start; unbreak 1; start x=3; A ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > A ok
        leave ROOT/A ok
        wait ROOT: no transition from ROOT/A ok
        > break 1 before ROOT
        > start
        drop ROOT
        hit 1 at ROOT for the 1. time
        hold ROOT before ROOT (Breakpoint(1))
        > start
        hit 1 at ROOT for the 2. time
        hold ROOT before ROOT (Breakpoint(1))
        > unbreak 1
        > start x=3
        enter ROOT
        warning ROOT: no input x
        enter ROOT/A
          run ROOT/A
        > A ok
        leave ROOT/A ok
        wait ROOT: no transition from ROOT/A ok
    "]],
    );
}

const LOST: &str = "
hierarchy ROOT
  outcome done
  start -> A
  execution A
    outcome ok
";

#[test]
fn a_run_that_stops_already_is_not_stopped_behind_its_state() {
    let machine = "
hierarchy ROOT
  outcome done
  start -> A ; A.done -> .done ; A.preempted -> R ; R.done -> .done
  execution A
    outcome done
  preemptive R
    outcome done
";
    check(
        machine,
        "start at ROOT/A then stop; stop; A done; active; stop",
        &expect![[r"
        > start at ROOT/A then stop
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > stop
        stopping
          preempt ROOT
          preempt ROOT/A
        > A done
        leave ROOT/A preempted
        enter ROOT/R
        wait ROOT/R: no children
        > active
        ROOT Inside preempted
        ROOT/R Waiting(NoChildren)
        Stopping, 3 states run
        > stop
        stopping
        leave ROOT/R preempted
        leave ROOT preempted
        finished
          preempt ROOT/R
          end of run: preempted (-2), 3 states
    "]],
    );
}

#[test]
fn a_run_that_is_lost_before_the_state_it_was_begun_at_still_begins_there() {
    check(
        NESTED,
        "start hold at H/I/J/Q; cut again; Q ok; Y ok",
        &expect![[r"
            > start hold at H/I/J/Q
            enter H
            enter H/I
            enter H/I/J
            hold H/I/J before H/I/J/Q (Start)
            > cut again
            enter H
            enter H/I
            enter H/I/J
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
            enter H/B
              run H/B
        "]],
    );
}

#[test]
fn a_run_that_is_lost_still_holds_behind_the_state_it_was_begun_at() {
    check(
        NESTED,
        "start at H/I/J/P then hold; cut again; P ok; resume",
        &expect![[r"
        > start at H/I/J/P then hold
        enter H
        enter H/I
        enter H/I/J
        enter H/I/J/P
          run H/I/J/P
        > cut again
        enter H
        enter H/I
        enter H/I/J
        enter H/I/J/P
          run H/I/J/P
        > P ok
        leave H/I/J/P ok
        hold H/I/J before H/I/J/Q (Step)
        > resume
        enter H/I/J/Q
          run H/I/J/Q
    "]],
    );
}

#[test]
fn a_run_that_is_lost_still_stops_behind_the_state_it_was_begun_at() {
    check(
        NESTED,
        "start at H/I/J then stop; P ok; cut again; Q ok",
        &expect![[r"
        > start at H/I/J then stop
        enter H
        enter H/I
        enter H/I/J
        enter H/I/J/P
          run H/I/J/P
        > P ok
        leave H/I/J/P ok
        enter H/I/J/Q
          run H/I/J/Q
        > cut again
        enter H
        enter H/I
        enter H/I/J
        enter H/I/J/Q
          run H/I/J/Q
        > Q ok
        leave H/I/J/Q ok
        leave H/I/J ok
        stopping
        leave H/I preempted
        leave H preempted
        finished
          preempt H
          preempt H/I
          end of run: preempted (-2), 5 states
    "]],
    );
}

#[test]
fn a_run_that_was_lost_behind_the_state_it_was_begun_at_forgets_it() {
    check(
        NESTED,
        "start at H/I/J/P then hold; P ok; resume; cut again; Q ok",
        &expect![[r"
        > start at H/I/J/P then hold
        enter H
        enter H/I
        enter H/I/J
        enter H/I/J/P
          run H/I/J/P
        > P ok
        leave H/I/J/P ok
        hold H/I/J before H/I/J/Q (Step)
        > resume
        enter H/I/J/Q
          run H/I/J/Q
        > cut again
        enter H
        enter H/I
        enter H/I/J
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
fn a_branch_that_a_run_was_begun_at_is_begun_at_when_the_run_is_resumed() {
    check(
        "
preemptive B
  outcome ok
  L.ok -> .ok ; R.ok -> .ok
  hierarchy L
    outcome ok
    start -> X ; X.ok -> Y ; Y.ok -> .ok
    execution X
      outcome ok
    execution Y
      outcome ok
  execution R
    outcome ok
",
        "start hold at B/L/Y; cut again",
        &expect![[r"
            > start hold at B/L/Y
            enter B
            enter B/L
            hold B/L before B/L/Y (Start)
            hold B before B/R (Start)
              fork 1
              fork 2
            > cut again
            enter B
            enter B/L
            enter B/R
            enter B/L/Y
              fork 1
              fork 2
              run B/R on 2
              run B/L/Y on 1
        "]],
    );
}
