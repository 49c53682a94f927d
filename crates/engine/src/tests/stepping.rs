//! Steps: into, over and out of states, to a state, on all branches or one.

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
fn steps_into_do_one_child_each() {
    check(
        NESTED,
        "start hold; step into; A ok; step into; step into; X ok; step into; step into; P ok; step into; Q ok; step into; Y ok; step into; B ok",
        &expect![[r"
        > start hold
        enter H
        hold H before H/A (Start)
        > step into
        enter H/A
          run H/A
        > A ok
        leave H/A ok
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
        > step into
        enter H/I/J
        hold H/I/J before H/I/J/P (Step)
        > step into
        enter H/I/J/P
          run H/I/J/P
        > P ok
        leave H/I/J/P ok
        hold H/I/J before H/I/J/Q (Step)
        > step into
        enter H/I/J/Q
          run H/I/J/Q
        > Q ok
        leave H/I/J/Q ok
        leave H/I/J ok
        hold H/I before H/I/Y (Step)
        > step into
        enter H/I/Y
          run H/I/Y
        > Y ok
        leave H/I/Y ok
        leave H/I ok
        hold H before H/B (Step)
        > step into
        enter H/B
          run H/B
        > B ok
        leave H/B ok
        leave H done
        finished
          end of run: done (0), 9 states
    "]],
    );
}

#[test]
fn steps_over_run_what_is_in_a_state() {
    check(
        NESTED,
        "start hold; step over; A ok; step over; X ok; P ok; Q ok; Y ok; step over; B ok",
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
        > step over
        enter H/B
          run H/B
        > B ok
        leave H/B ok
        leave H done
        finished
          end of run: done (0), 9 states
    "]],
    );
}

#[test]
fn steps_out_run_to_the_end_of_the_container() {
    check(
        NESTED,
        "start hold; step into; A ok; step into; step out; X ok; P ok; Q ok; Y ok; step out; B ok",
        &expect![[r"
        > start hold
        enter H
        hold H before H/A (Start)
        > step into
        enter H/A
          run H/A
        > A ok
        leave H/A ok
        hold H before H/I (Step)
        > step into
        enter H/I
        hold H/I before H/I/X (Step)
        > step out
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
        > step out
        enter H/B
          run H/B
        > B ok
        leave H/B ok
        leave H done
        finished
          end of run: done (0), 9 states
    "]],
    );
}

#[test]
fn steps_over_inside_a_container() {
    check(
        NESTED,
        "start hold; step into; A ok; step into; step into; X ok; step over; P ok; Q ok; step over; Y ok; step over; B ok",
        &expect![[r"
        > start hold
        enter H
        hold H before H/A (Start)
        > step into
        enter H/A
          run H/A
        > A ok
        leave H/A ok
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
        > step over
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
          end of run: done (0), 9 states
    "]],
    );
}

#[test]
fn step_mode_holds_before_the_next_state() {
    check(
        NESTED,
        "start; step mode; active; A ok; active; resume; active",
        &expect![[r"
        > start
        enter H
        enter H/A
          run H/A
        > step mode
        > active
        H Inside
        H/A Script
        Stepping, 2 states run
        > A ok
        leave H/A ok
        hold H before H/I (Step)
        > active
        H Held (Step before H/I)
        Stepping, 2 states run
        > resume
        enter H/I
        enter H/I/X
          run H/I/X
        > active
        H Inside
        H/I Inside
        H/I/X Script
        Running, 4 states run
    "]],
    );
}

#[test]
fn a_step_ends_a_pause() {
    check(
        NESTED,
        "start; pause; step into; A ok; step into; active",
        &expect![[r"
        > start
        enter H
        enter H/A
          run H/A
        > pause
        paused
          paused true
        > step into
        refused: nothing is held in this run; wait until a branch comes to its next state
        > A ok
        leave H/A ok
        hold H before H/I (Pause)
        > step into
        goes on
        enter H/I
        hold H/I before H/I/X (Step)
          paused false
        > active
        H Inside
        H/I Held (Step before H/I/X)
        Stepping, 3 states run
    "]],
    );
}

#[test]
fn a_pause_between_steps_keeps_what_is_held() {
    check(
        NESTED,
        "start hold; pause; step into; A ok; pause; resume; X ok",
        &expect![[r"
        > start hold
        enter H
        hold H before H/A (Start)
        > pause
        paused
          paused true
        > step into
        goes on
        enter H/A
          paused false
          run H/A
        > A ok
        leave H/A ok
        hold H before H/I (Step)
        > pause
        paused
          paused true
        > resume
        goes on
        enter H/I
        enter H/I/X
          paused false
          run H/I/X
        > X ok
        leave H/I/X ok
        enter H/I/J
        enter H/I/J/P
          run H/I/J/P
    "]],
    );
}

#[test]
fn a_run_to_a_state_holds_before_it() {
    check(
        NESTED,
        "start; run to H/I/J/Q; A ok; X ok; P ok; active; step into; Q ok",
        &expect![[r"
        > start
        enter H
        enter H/A
          run H/A
        > run to H/I/J/Q
        > A ok
        leave H/A ok
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
        hold H/I/J before H/I/J/Q (RunTo)
        > active
        H Inside
        H/I Inside
        H/I/J Held (RunTo before H/I/J/Q)
        Stepping, 6 states run
        > step into
        enter H/I/J/Q
          run H/I/J/Q
        > Q ok
        leave H/I/J/Q ok
        leave H/I/J ok
        hold H/I before H/I/Y (Step)
    "]],
    );
}

#[test]
fn a_run_to_a_state_may_begin_from_a_hold() {
    check(
        NESTED,
        "start hold; run to H/B; A ok; X ok; P ok; Q ok; Y ok; run to H/C",
        &expect![[r"
        > start hold
        enter H
        hold H before H/A (Start)
        > run to H/B
        enter H/A
          run H/A
        > A ok
        leave H/A ok
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
        hold H before H/B (RunTo)
        > run to H/C
        refused: there is no state at 'H/C': 'C' is not inside 'H'; paths are state ids from the root down, joined by '/'
    "]],
    );
}

#[test]
fn a_resume_forgets_where_it_was_to_run_to() {
    check(
        NESTED,
        "start; run to H/I/J/Q; pause; A ok; resume; X ok; P ok",
        &expect![[r"
        > start
        enter H
        enter H/A
          run H/A
        > run to H/I/J/Q
        > pause
        paused
          paused true
        > A ok
        leave H/A ok
        hold H before H/I (Pause)
        > resume
        goes on
        enter H/I
        enter H/I/X
          paused false
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
fn a_step_lets_each_branch_do_one_child() {
    check(
        BRANCHES,
        "start hold; step into; step into; F/A ok; G/A ok; step into; F/B ok; S ok; G/B ok; unique_decider_state_id ok; step into; Z ok",
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
        > step into
        enter ROOT/C/F/A
        enter ROOT/C/G/A
          run ROOT/C/F/A on 1
          run ROOT/C/G/A on 2
        > F/A ok
        leave ROOT/C/F/A ok
        hold ROOT/C/F before ROOT/C/F/B (Step)
        > G/A ok
        leave ROOT/C/G/A ok
        hold ROOT/C/G before ROOT/C/G/B (Step)
        > step into
        enter ROOT/C/F/B
        enter ROOT/C/G/B
          run ROOT/C/F/B on 1
          run ROOT/C/G/B on 2
        > F/B ok
        leave ROOT/C/F/B ok
        leave ROOT/C/F ok
          end 1
        > S ok
        leave ROOT/C/S ok
          end 3
        > G/B ok
        leave ROOT/C/G/B ok
        leave ROOT/C/G ok
        enter ROOT/C/unique_decider_state_id
          end 2
          run ROOT/C/unique_decider_state_id [F ok] [G ok] [S ok]
        > unique_decider_state_id ok
        leave ROOT/C/unique_decider_state_id ok
        leave ROOT/C done
        hold ROOT before ROOT/Z (Step)
        > step into
        enter ROOT/Z
          run ROOT/Z
        > Z ok
        leave ROOT/Z ok
        leave ROOT done
        finished
          end of run: done (0), 11 states
    "]],
    );
}

#[test]
fn a_branch_is_stepped_by_itself() {
    check(
        BRANCHES,
        "start hold; step into; step into ROOT/C/F; F/A ok; step into ROOT/C/F; active; step into ROOT/C/S; step into ROOT/C; step into ROOT/C/G; resume ROOT/C/F; active; F/B ok; active",
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
        > step into ROOT/C/F
        enter ROOT/C/F/A
          run ROOT/C/F/A on 1
        > F/A ok
        leave ROOT/C/F/A ok
        hold ROOT/C/F before ROOT/C/F/B (Step)
        > step into ROOT/C/F
        enter ROOT/C/F/B
          run ROOT/C/F/B on 1
        > active
        ROOT Inside
        ROOT/C Inside
        ROOT/C/F Inside
        ROOT/C/F/B Script
        ROOT/C/G Held (Step before ROOT/C/G/A)
        ROOT/C/S Script
        Stepping, 7 states run
        > step into ROOT/C/S
        refused: nothing is held on the branch 'ROOT/C/S'; wait until a branch comes to its next state
        > step into ROOT/C
        refused: 'ROOT/C' is not an active branch; a branch is named by an active child of a concurrency state
        > step into ROOT/C/G
        enter ROOT/C/G/A
          run ROOT/C/G/A on 2
        > resume ROOT/C/F
        > active
        ROOT Inside
        ROOT/C Inside
        ROOT/C/F Inside
        ROOT/C/F/B Script
        ROOT/C/G Inside
        ROOT/C/G/A Script
        ROOT/C/S Script
        Stepping, 8 states run
        > F/B ok
        leave ROOT/C/F/B ok
        leave ROOT/C/F ok
          end 1
        > active
        ROOT Inside
        ROOT/C Inside
        ROOT/C/G Inside
        ROOT/C/G/A Script
        ROOT/C/S Script
        Stepping, 8 states run
    "]],
    );
}

#[test]
fn a_step_over_a_concurrency_state_runs_all_of_it() {
    check(
        BRANCHES,
        "start hold; step over; F/A ok; F/B ok; S ok; G/A ok; G/B ok; unique_decider_state_id ok; active; resume",
        &expect![[r"
        > start hold
        enter ROOT
        hold ROOT before ROOT/C (Start)
        > step over
        enter ROOT/C
        enter ROOT/C/F
        enter ROOT/C/F/A
        enter ROOT/C/G
        enter ROOT/C/G/A
        enter ROOT/C/S
          fork 1
          run ROOT/C/F/A on 1
          fork 2
          run ROOT/C/G/A on 2
          fork 3
          run ROOT/C/S on 3
        > F/A ok
        leave ROOT/C/F/A ok
        enter ROOT/C/F/B
          run ROOT/C/F/B on 1
        > F/B ok
        leave ROOT/C/F/B ok
        leave ROOT/C/F ok
          end 1
        > S ok
        leave ROOT/C/S ok
          end 3
        > G/A ok
        leave ROOT/C/G/A ok
        enter ROOT/C/G/B
          run ROOT/C/G/B on 2
        > G/B ok
        leave ROOT/C/G/B ok
        leave ROOT/C/G ok
        enter ROOT/C/unique_decider_state_id
          end 2
          run ROOT/C/unique_decider_state_id [F ok] [G ok] [S ok]
        > unique_decider_state_id ok
        leave ROOT/C/unique_decider_state_id ok
        leave ROOT/C done
        hold ROOT before ROOT/Z (Step)
        > active
        ROOT Held (Step before ROOT/Z)
        Stepping, 10 states run
        > resume
        enter ROOT/Z
          run ROOT/Z
    "]],
    );
}

#[test]
fn a_step_out_of_a_branch_runs_it_to_its_end() {
    check(
        BRANCHES,
        "start hold; step into; step out ROOT/C/F; F/A ok; F/B ok; active; step over; G/A ok; step out; G/B ok; S ok; unique_decider_state_id ok",
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
        > step out ROOT/C/F
        enter ROOT/C/F/A
          run ROOT/C/F/A on 1
        > F/A ok
        leave ROOT/C/F/A ok
        enter ROOT/C/F/B
          run ROOT/C/F/B on 1
        > F/B ok
        leave ROOT/C/F/B ok
        leave ROOT/C/F ok
          end 1
        > active
        ROOT Inside
        ROOT/C Inside
        ROOT/C/G Held (Step before ROOT/C/G/A)
        ROOT/C/S Script
        Stepping, 7 states run
        > step over
        enter ROOT/C/G/A
          run ROOT/C/G/A on 2
        > G/A ok
        leave ROOT/C/G/A ok
        hold ROOT/C/G before ROOT/C/G/B (Step)
        > step out
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
    "]],
    );
}

#[test]
fn one_branch_resumes_and_the_others_are_stepped() {
    check(
        BRANCHES,
        "start; pause; F/A ok; G/A ok; resume ROOT/C/F; F/B ok; active; step into; G/B ok; S ok; unique_decider_state_id ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/C
        enter ROOT/C/F
        enter ROOT/C/F/A
        enter ROOT/C/G
        enter ROOT/C/G/A
        enter ROOT/C/S
          fork 1
          run ROOT/C/F/A on 1
          fork 2
          run ROOT/C/G/A on 2
          fork 3
          run ROOT/C/S on 3
        > pause
        paused
          paused true
        > F/A ok
        leave ROOT/C/F/A ok
        hold ROOT/C/F before ROOT/C/F/B (Pause)
        > G/A ok
        leave ROOT/C/G/A ok
        hold ROOT/C/G before ROOT/C/G/B (Pause)
        > resume ROOT/C/F
        goes on
        enter ROOT/C/F/B
          paused false
          run ROOT/C/F/B on 1
        > F/B ok
        leave ROOT/C/F/B ok
        leave ROOT/C/F ok
          end 1
        > active
        ROOT Inside
        ROOT/C Inside
        ROOT/C/G Held (Pause before ROOT/C/G/B)
        ROOT/C/S Script
        Stepping, 8 states run
        > step into
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
    "]],
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
fn a_library_state_and_its_root_are_one_step() {
    check(
        LIBRARY,
        "start hold; step into; active; step into; A ok; step out; B ok; step into; M/R ok; active",
        &expect![[r"
        > start hold
        enter ROOT
        hold ROOT before ROOT/L (Start)
        > step into
        enter ROOT/L
        enter ROOT/L/R
        hold ROOT/L/R before ROOT/L/R/A (Step)
        > active
        ROOT Inside
        ROOT/L Inside
        ROOT/L/R Held (Step before ROOT/L/R/A)
        Stepping, 2 states run
        > step into
        enter ROOT/L/R/A
          run ROOT/L/R/A
        > A ok
        leave ROOT/L/R/A ok
        hold ROOT/L/R before ROOT/L/R/B (Step)
        > step out
        enter ROOT/L/R/B
          run ROOT/L/R/B
        > B ok
        leave ROOT/L/R/B ok
        leave ROOT/L/R ok
        leave ROOT/L ok
        hold ROOT before ROOT/M (Step)
        > step into
        enter ROOT/M
        enter ROOT/M/R
          run ROOT/M/R
        > M/R ok
        leave ROOT/M/R ok
        leave ROOT/M ok
        hold ROOT before ROOT/Z (Step)
        > active
        ROOT Held (Step before ROOT/Z)
        Stepping, 5 states run
    "]],
    );
}

#[test]
fn a_handler_is_held_by_a_step() {
    check(
        "
hierarchy ROOT
  outcome done
  start -> H ; H.preempted -> .done
  hierarchy H
    start -> A ; A.preempted -> C ; C.ok -> .preempted
    execution A
    execution C
      outcome ok
",
        "start; step mode; preempt ROOT/H; A ok; step into; C ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/H
            enter ROOT/H/A
              run ROOT/H/A
            > step mode
            > preempt ROOT/H
              preempt ROOT/H
              preempt ROOT/H/A
            > A ok
            leave ROOT/H/A preempted
            hold ROOT/H before ROOT/H/C (Step)
            > step into
            enter ROOT/H/C
              run ROOT/H/C
            > C ok
            leave ROOT/H/C ok
            leave ROOT/H preempted
            leave ROOT done
            finished
              end of run: done (0), 4 states
        "]],
    );
}

#[test]
fn a_step_without_anything_held_is_refused() {
    check(
        NESTED,
        "start; step into; step mode; step into; stop; A ok",
        &expect![[r"
        > start
        enter H
        enter H/A
          run H/A
        > step into
        refused: cannot step: the run is running; it can be paused, stepped from its next states on, or stopped
        > step mode
        > step into
        refused: nothing is held in this run; wait until a branch comes to its next state
        > stop
        stopping
          preempt H
          preempt H/A
        > A ok
        leave H/A preempted
        leave H preempted
        finished
          end of run: preempted (-2), 2 states
    "]],
    );
}
