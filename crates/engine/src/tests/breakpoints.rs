//! Breakpoints: their places, scopes and conditions, and their actions while no viewer is connected.

use super::check;
use expect_test::expect;

const LOOP: &str = "
hierarchy ROOT
  outcome done
  in x: int = 1
  var v: int = 2
  start -> A ; A.again -> A ; A.ok -> B ; B.ok -> .done
  flow .x -> A.n ; A.m -> .v
  execution A
    outcome ok
    outcome again
    in n: int = 0
    out m: int = 0
  execution B
    outcome ok
";

#[test]
fn a_breakpoint_holds_before_a_state() {
    check(
        LOOP,
        "break 1 before ROOT/B; start; A again; A ok; active; step into; B ok",
        &expect![[r"
        > break 1 before ROOT/B
        > start
        enter ROOT x=1
        set ROOT.v = 2
        enter ROOT/A n=1
          run ROOT/A
        > A again
        leave ROOT/A again m=0
        set ROOT.v = 0
        enter ROOT/A n=1
          run ROOT/A
        > A ok
        leave ROOT/A ok m=0
        set ROOT.v = 0
        hit 1 at ROOT/B for the 1. time
        hold ROOT before ROOT/B (Breakpoint(1))
        > active
        ROOT Held (Breakpoint(1) before ROOT/B)
        Stepping, 3 states run
        > step into
        enter ROOT/B
          run ROOT/B
        > B ok
        leave ROOT/B ok
        leave ROOT done
        finished
          end of run: done (0) variables: v=0, 4 states
    "]],
    );
}

#[test]
fn a_breakpoint_holds_after_a_state() {
    check(
        LOOP,
        "break 1 after ROOT/A; start; A again m=5; active; resume; A ok; step into; B ok",
        &expect![[r"
            > break 1 after ROOT/A
            > start
            enter ROOT x=1
            set ROOT.v = 2
            enter ROOT/A n=1
              run ROOT/A
            > A again m=5
            leave ROOT/A again m=5
            set ROOT.v = 5
            hit 1 at ROOT/A for the 1. time
            hold ROOT before ROOT/A (Breakpoint(1))
            > active
            ROOT Held (Breakpoint(1) before ROOT/A)
            Stepping, 2 states run
            > resume
            enter ROOT/A n=1
              run ROOT/A
            > A ok
            leave ROOT/A ok m=0
            set ROOT.v = 0
            hit 1 at ROOT/A for the 2. time
            hold ROOT before ROOT/B (Breakpoint(1))
            > step into
            enter ROOT/B
              run ROOT/B
            > B ok
            leave ROOT/B ok
            leave ROOT done
            finished
              end of run: done (0) variables: v=0, 4 states
        "]],
    );
}

#[test]
fn after_and_before_are_two_breakpoints() {
    check(
        LOOP,
        "break 1 after ROOT/A; break 2 before ROOT/B; start; A ok; resume; resume; B ok",
        &expect![[r"
        > break 1 after ROOT/A
        > break 2 before ROOT/B
        > start
        enter ROOT x=1
        set ROOT.v = 2
        enter ROOT/A n=1
          run ROOT/A
        > A ok
        leave ROOT/A ok m=0
        set ROOT.v = 0
        hit 1 at ROOT/A for the 1. time
        hold ROOT before ROOT/B (Breakpoint(1))
        > resume
        hit 2 at ROOT/B for the 1. time
        hold ROOT before ROOT/B (Breakpoint(2))
        > resume
        enter ROOT/B
          run ROOT/B
        > B ok
        leave ROOT/B ok
        leave ROOT done
        finished
          end of run: done (0) variables: v=0, 3 states
    "]],
    );
}

#[test]
fn a_breakpoint_counts_how_often_it_is_passed() {
    check(
        LOOP,
        "break 1 before ROOT/A count 3; start; A again; A again; resume; A again",
        &expect![[r"
        > break 1 before ROOT/A count 3
        > start
        enter ROOT x=1
        set ROOT.v = 2
        hit 1 at ROOT/A for the 1. time, goes on
        enter ROOT/A n=1
          run ROOT/A
        > A again
        leave ROOT/A again m=0
        set ROOT.v = 0
        hit 1 at ROOT/A for the 2. time, goes on
        enter ROOT/A n=1
          run ROOT/A
        > A again
        leave ROOT/A again m=0
        set ROOT.v = 0
        hit 1 at ROOT/A for the 3. time
        hold ROOT before ROOT/A (Breakpoint(1))
        > resume
        enter ROOT/A n=1
          run ROOT/A
        > A again
        leave ROOT/A again m=0
        set ROOT.v = 0
        hit 1 at ROOT/A for the 4. time
        hold ROOT before ROOT/A (Breakpoint(1))
    "]],
    );
}

#[test]
fn a_disabled_breakpoint_does_nothing_and_one_with_the_same_id_replaces_it() {
    check(
        LOOP,
        "break 1 before ROOT/A off; start; A again; break 1 before ROOT/A; A again; unbreak 1; resume; A again; unbreak 1",
        &expect![[r"
        > break 1 before ROOT/A off
        > start
        enter ROOT x=1
        set ROOT.v = 2
        enter ROOT/A n=1
          run ROOT/A
        > A again
        leave ROOT/A again m=0
        set ROOT.v = 0
        enter ROOT/A n=1
          run ROOT/A
        > break 1 before ROOT/A
        > A again
        leave ROOT/A again m=0
        set ROOT.v = 0
        hit 1 at ROOT/A for the 1. time
        hold ROOT before ROOT/A (Breakpoint(1))
        > unbreak 1
        > resume
        enter ROOT/A n=1
          run ROOT/A
        > A again
        leave ROOT/A again m=0
        set ROOT.v = 0
        enter ROOT/A n=1
          run ROOT/A
        > unbreak 1
        refused: there is no breakpoint 1; the snapshot lists all breakpoints
    "]],
    );
}

#[test]
fn a_path_need_not_exist() {
    check(
        LOOP,
        "break 1 before ROOT/NOWHERE; break 2 after OTHER; break 3 before ROOT/A/B; start; A ok; B ok; break 1 before ROOT; unbreak 1",
        &expect![[r"
        > break 1 before ROOT/NOWHERE
        > break 2 after OTHER
        > break 3 before ROOT/A/B
        > start
        enter ROOT x=1
        set ROOT.v = 2
        enter ROOT/A n=1
          run ROOT/A
        > A ok
        leave ROOT/A ok m=0
        set ROOT.v = 0
        enter ROOT/B
          run ROOT/B
        > B ok
        leave ROOT/B ok
        leave ROOT done
        finished
          end of run: done (0) variables: v=0, 3 states
        > break 1 before ROOT
        refused: cannot set a breakpoint: the run has finished; begin a new run
        > unbreak 1
        refused: cannot remove a breakpoint: the run has finished; begin a new run
    "]],
    );
}

#[test]
fn a_condition_is_evaluated_with_the_data_of_the_state() {
    check(
        LOOP,
        "break 1 before ROOT/A if n>1; start x=7; active; check false; A again m=4; check true; active; resume; A again",
        &expect![[r"
        > break 1 before ROOT/A if n>1
        > start x=7
        enter ROOT x=7
        set ROOT.v = 2
          check 1 at ROOT/A: n>1 n=7 v=2
        > active
        ROOT Checking
        Running, 1 states run
        > check false
        enter ROOT/A n=7
          run ROOT/A
        > A again m=4
        leave ROOT/A again m=4
        set ROOT.v = 4
          check 2 at ROOT/A: n>1 n=7 v=4
        > check true
        hit 1 at ROOT/A for the 1. time
        hold ROOT before ROOT/A (Breakpoint(1))
        > active
        ROOT Held (Breakpoint(1) before ROOT/A)
        Stepping, 2 states run
        > resume
        enter ROOT/A n=7
          run ROOT/A
        > A again
        leave ROOT/A again m=0
        set ROOT.v = 0
          check 3 at ROOT/A: n>1 n=7 v=0
    "]],
    );
}

#[test]
fn a_condition_after_a_state_sees_what_it_gave() {
    check(
        LOOP,
        "break 1 after ROOT/A if m>1; start x=7; A again m=4; check true; resume; A ok m=5; check false; B ok",
        &expect![[r"
        > break 1 after ROOT/A if m>1
        > start x=7
        enter ROOT x=7
        set ROOT.v = 2
        enter ROOT/A n=7
          run ROOT/A
        > A again m=4
        leave ROOT/A again m=4
        set ROOT.v = 4
          check 1 at ROOT/A: m>1 n=7 left again m=4 v=4
        > check true
        hit 1 at ROOT/A for the 1. time
        hold ROOT before ROOT/A (Breakpoint(1))
        > resume
        enter ROOT/A n=7
          run ROOT/A
        > A ok m=5
        leave ROOT/A ok m=5
        set ROOT.v = 5
          check 2 at ROOT/A: m>1 n=7 left ok m=5 v=5
        > check false
        enter ROOT/B
          run ROOT/B
        > B ok
        leave ROOT/B ok
        leave ROOT done
        finished
          end of run: done (0) variables: v=5, 4 states
    "]],
    );
}

#[test]
fn a_condition_that_cannot_be_evaluated_counts_as_true() {
    check(
        LOOP,
        "break 1 before ROOT/B if nonsense; start; A ok; check it is nonsense; resume",
        &expect![[r"
        > break 1 before ROOT/B if nonsense
        > start
        enter ROOT x=1
        set ROOT.v = 2
        enter ROOT/A n=1
          run ROOT/A
        > A ok
        leave ROOT/A ok m=0
        set ROOT.v = 0
          check 1 at ROOT/B: nonsense v=0
        > check it is nonsense
        warning ROOT/B: bad condition of 1: it is nonsense
        hit 1 at ROOT/B for the 1. time
        hold ROOT before ROOT/B (Breakpoint(1))
        > resume
        enter ROOT/B
          run ROOT/B
    "]],
    );
}

#[test]
fn several_conditions_are_evaluated_one_after_the_other() {
    check(
        LOOP,
        "break 1 before ROOT/B if a; break 2 before ROOT/B if b; break 3 before ROOT/B; start; A ok; check false; check true; resume; B ok",
        &expect![[r"
        > break 1 before ROOT/B if a
        > break 2 before ROOT/B if b
        > break 3 before ROOT/B
        > start
        enter ROOT x=1
        set ROOT.v = 2
        enter ROOT/A n=1
          run ROOT/A
        > A ok
        leave ROOT/A ok m=0
        set ROOT.v = 0
          check 1 at ROOT/B: a v=0
        > check false
          check 2 at ROOT/B: b v=0
        > check true
        hit 2 at ROOT/B for the 1. time
        hit 3 at ROOT/B for the 1. time
        hold ROOT before ROOT/B (Breakpoint(2))
        > resume
        enter ROOT/B
          run ROOT/B
        > B ok
        leave ROOT/B ok
        leave ROOT done
        finished
          end of run: done (0) variables: v=0, 3 states
    "]],
    );
}

#[test]
fn a_condition_during_a_pause_holds_all_the_same() {
    check(
        LOOP,
        "break 1 before ROOT/B if a; start; A ok; pause; check false; active; resume; B ok",
        &expect![[r"
        > break 1 before ROOT/B if a
        > start
        enter ROOT x=1
        set ROOT.v = 2
        enter ROOT/A n=1
          run ROOT/A
        > A ok
        leave ROOT/A ok m=0
        set ROOT.v = 0
          check 1 at ROOT/B: a v=0
        > pause
        paused
          paused true
        > check false
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
        leave ROOT done
        finished
          end of run: done (0) variables: v=0, 3 states
    "]],
    );
}

#[test]
fn a_stop_ends_a_condition() {
    check(
        LOOP,
        "break 1 before ROOT/B if a; start; A ok; stop; check true",
        &expect![[r"
        > break 1 before ROOT/B if a
        > start
        enter ROOT x=1
        set ROOT.v = 2
        enter ROOT/A n=1
          run ROOT/A
        > A ok
        leave ROOT/A ok m=0
        set ROOT.v = 0
          check 1 at ROOT/B: a v=0
        > stop
        stopping
        leave ROOT preempted
        finished
          preempt ROOT
          end of run: preempted (-2) variables: v=0, 2 states
        > check true
        refused: condition 1 is not being evaluated; its answer is given once, with the number of its check
    "]],
    );
}

#[test]
fn a_breakpoint_of_the_root_holds_the_run() {
    check(
        LOOP,
        "break 1 before ROOT if c; break 2 after ROOT if d; start; check true; resume; A ok; B ok; check true; active; resume",
        &expect![[r"
        > break 1 before ROOT if c
        > break 2 after ROOT if d
        > start
          check 1 at ROOT: c x=1
        > check true
        hit 1 at ROOT for the 1. time
        hold ROOT before ROOT (Breakpoint(1))
        > resume
        enter ROOT x=1
        set ROOT.v = 2
        enter ROOT/A n=1
          run ROOT/A
        > A ok
        leave ROOT/A ok m=0
        set ROOT.v = 0
        enter ROOT/B
          run ROOT/B
        > B ok
        leave ROOT/B ok
        leave ROOT done
          check 2 at ROOT: d x=1 left done
        > check true
        hit 2 at ROOT for the 1. time
        hold ROOT (Breakpoint(2))
        > active
        Stepping, 3 states run
        > resume
        finished
          end of run: done (0) variables: v=0, 3 states
    "]],
    );
}

#[test]
fn a_stop_ends_a_hold_outside_of_the_root() {
    check(
        LOOP,
        "break 1 before ROOT; start; stop",
        &expect![[r"
        > break 1 before ROOT
        > start
        hit 1 at ROOT for the 1. time
        hold ROOT before ROOT (Breakpoint(1))
        > stop
        stopping
        finished
          end of run: preempted (-2), 0 states
    "]],
    );
}

#[test]
fn a_stop_ends_a_hold_after_the_root() {
    check(
        LOOP,
        "break 1 after ROOT; start; A ok; B ok; stop",
        &expect![[r"
        > break 1 after ROOT
        > start
        enter ROOT x=1
        set ROOT.v = 2
        enter ROOT/A n=1
          run ROOT/A
        > A ok
        leave ROOT/A ok m=0
        set ROOT.v = 0
        enter ROOT/B
          run ROOT/B
        > B ok
        leave ROOT/B ok
        leave ROOT done
        hit 1 at ROOT for the 1. time
        hold ROOT (Breakpoint(1))
        > stop
        stopping
        finished
          end of run: done (0) variables: v=0, 3 states
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
fn a_breakpoint_holds_one_branch() {
    check(
        BRANCHES,
        "break 1 before ROOT/C/F/B; start; F/A ok; G/A ok; G/B ok; active; resume ROOT/C/F; F/B ok; S ok; unique_decider_state_id ok; Z ok",
        &expect![[r"
        > break 1 before ROOT/C/F/B
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
        > F/A ok
        leave ROOT/C/F/A ok
        hit 1 at ROOT/C/F/B for the 1. time
        hold ROOT/C/F before ROOT/C/F/B (Breakpoint(1))
        > G/A ok
        leave ROOT/C/G/A ok
        enter ROOT/C/G/B
          run ROOT/C/G/B on 2
        > G/B ok
        leave ROOT/C/G/B ok
        leave ROOT/C/G ok
          end 2
        > active
        ROOT Inside
        ROOT/C Inside
        ROOT/C/F Held (Breakpoint(1) before ROOT/C/F/B)
        ROOT/C/S Script
        Stepping, 8 states run
        > resume ROOT/C/F
        enter ROOT/C/F/B
          run ROOT/C/F/B on 1
        > F/B ok
        leave ROOT/C/F/B ok
        leave ROOT/C/F ok
          end 1
        > S ok
        leave ROOT/C/S ok
        enter ROOT/C/unique_decider_state_id
          end 3
          run ROOT/C/unique_decider_state_id [F ok] [G ok] [S ok]
        > unique_decider_state_id ok
        leave ROOT/C/unique_decider_state_id ok
        leave ROOT/C done
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
fn a_breakpoint_may_hold_the_whole_run() {
    check(
        BRANCHES,
        "break 1 before ROOT/C/F/B run; start; F/A ok; G/A ok; active; resume; F/B ok; G/B ok",
        &expect![[r"
        > break 1 before ROOT/C/F/B run
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
        > F/A ok
        leave ROOT/C/F/A ok
        hit 1 at ROOT/C/F/B for the 1. time
        paused
        hold ROOT/C/F before ROOT/C/F/B (Breakpoint(1))
          paused true
        > G/A ok
        leave ROOT/C/G/A ok
        hold ROOT/C/G before ROOT/C/G/B (Pause)
        > active
        ROOT Inside
        ROOT/C Inside
        ROOT/C/F Held (Breakpoint(1) before ROOT/C/F/B)
        ROOT/C/G Held (Pause before ROOT/C/G/B)
        ROOT/C/S Script
        Paused, 7 states run
        > resume
        goes on
        enter ROOT/C/F/B
        enter ROOT/C/G/B
          paused false
          run ROOT/C/F/B on 1
          run ROOT/C/G/B on 2
        > F/B ok
        leave ROOT/C/F/B ok
        leave ROOT/C/F ok
          end 1
        > G/B ok
        leave ROOT/C/G/B ok
        leave ROOT/C/G ok
          end 2
    "]],
    );
}

#[test]
fn a_branch_is_held_before_it_begins_and_after_it_ended() {
    check(
        BRANCHES,
        "break 1 before ROOT/C/F; break 2 after ROOT/C/S; start; S ok; active; G/A ok; G/B ok; resume ROOT/C/S; resume; F/A ok; F/B ok; unique_decider_state_id ok",
        &expect![[r"
        > break 1 before ROOT/C/F
        > break 2 after ROOT/C/S
        > start
        enter ROOT
        enter ROOT/C
        hit 1 at ROOT/C/F for the 1. time
        hold ROOT/C before ROOT/C/F (Breakpoint(1))
        enter ROOT/C/G
        enter ROOT/C/G/A
        enter ROOT/C/S
          fork 1
          fork 2
          run ROOT/C/G/A on 2
          fork 3
          run ROOT/C/S on 3
        > S ok
        leave ROOT/C/S ok
        hit 2 at ROOT/C/S for the 1. time
        hold ROOT/C (Breakpoint(2))
        > active
        ROOT Inside
        ROOT/C Inside (Breakpoint(1) before ROOT/C/F) (Breakpoint(2))
        ROOT/C/G Inside
        ROOT/C/G/A Script
        Stepping, 5 states run
        > G/A ok
        leave ROOT/C/G/A ok
        enter ROOT/C/G/B
          run ROOT/C/G/B on 2
        > G/B ok
        leave ROOT/C/G/B ok
        leave ROOT/C/G ok
          end 2
        > resume ROOT/C/S
          end 3
        > resume
        enter ROOT/C/F
        enter ROOT/C/F/A
          run ROOT/C/F/A on 1
        > F/A ok
        leave ROOT/C/F/A ok
        enter ROOT/C/F/B
          run ROOT/C/F/B on 1
        > F/B ok
        leave ROOT/C/F/B ok
        leave ROOT/C/F ok
        enter ROOT/C/unique_decider_state_id
          end 1
          run ROOT/C/unique_decider_state_id [F ok] [G ok] [S ok]
        > unique_decider_state_id ok
        leave ROOT/C/unique_decider_state_id ok
        leave ROOT/C done
        enter ROOT/Z
          run ROOT/Z
    "]],
    );
}

#[test]
fn a_decider_is_held() {
    check(
        BRANCHES,
        "break 1 before ROOT/C/unique_decider_state_id; break 2 after ROOT/C/unique_decider_state_id; start; F/A ok; F/B ok; G/A ok; G/B ok; S ok; active; resume; unique_decider_state_id ok; active; resume",
        &expect![[r"
        > break 1 before ROOT/C/unique_decider_state_id
        > break 2 after ROOT/C/unique_decider_state_id
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
        > F/A ok
        leave ROOT/C/F/A ok
        enter ROOT/C/F/B
          run ROOT/C/F/B on 1
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
        hit 1 at ROOT/C/unique_decider_state_id for the 1. time
        hold ROOT/C before ROOT/C/unique_decider_state_id (Breakpoint(1))
          end 3
        > active
        ROOT Inside
        ROOT/C Held (Breakpoint(1) before ROOT/C/unique_decider_state_id)
        Stepping, 9 states run
        > resume
        enter ROOT/C/unique_decider_state_id
          run ROOT/C/unique_decider_state_id [F ok] [G ok] [S ok]
        > unique_decider_state_id ok
        leave ROOT/C/unique_decider_state_id ok
        hit 2 at ROOT/C/unique_decider_state_id for the 1. time
        hold ROOT/C (Breakpoint(2))
        > active
        ROOT Inside
        ROOT/C Held (Breakpoint(2))
        Stepping, 10 states run
        > resume
        leave ROOT/C done
        enter ROOT/Z
          run ROOT/Z
    "]],
    );
}

#[test]
fn a_stop_ends_branches_that_are_held() {
    check(
        BRANCHES,
        "break 1 before ROOT/C/F if a; break 2 after ROOT/C/S; break 3 before ROOT/C/G; start; S ok; active; stop; check true",
        &expect![[r"
        > break 1 before ROOT/C/F if a
        > break 2 after ROOT/C/S
        > break 3 before ROOT/C/G
        > start
        enter ROOT
        enter ROOT/C
        hit 3 at ROOT/C/G for the 1. time
        hold ROOT/C before ROOT/C/G (Breakpoint(3))
        enter ROOT/C/S
          fork 1
          check 1 at ROOT/C/F on 1: a
          fork 2
          fork 3
          run ROOT/C/S on 3
        > S ok
        leave ROOT/C/S ok
        hit 2 at ROOT/C/S for the 1. time
        hold ROOT/C (Breakpoint(2))
        > active
        ROOT Inside
        ROOT/C Inside (Breakpoint(3) before ROOT/C/G) (Breakpoint(2))
        Stepping, 3 states run
        > stop
        stopping
        leave ROOT/C preempted
        leave ROOT preempted
        finished
          preempt ROOT
          preempt ROOT/C
          end 1
          end 2
          end 3
          end of run: preempted (-2), 3 states
        > check true
        refused: condition 1 is not being evaluated; its answer is given once, with the number of its check
    "]],
    );
}

const RACE: &str = "
preemptive ROOT
  outcome won
  A.ok -> .won ; B.ok -> .won ; L.ok -> .won
  execution A
    outcome ok
  execution B
    outcome ok
  library L from \"some/library\"
    content
      execution R
        outcome ok
";

#[test]
fn a_winner_that_is_held_wins_when_it_is_let_go() {
    check(
        RACE,
        "break 1 after ROOT/A; break 2 before ROOT/B; start; A ok; active; resume ROOT/A; R ok",
        &expect![[r"
        > break 1 after ROOT/A
        > break 2 before ROOT/B
        > start
        enter ROOT
        enter ROOT/A
        hit 2 at ROOT/B for the 1. time
        hold ROOT before ROOT/B (Breakpoint(2))
        enter ROOT/L
        enter ROOT/L/R
          fork 1
          run ROOT/A on 1
          fork 2
          fork 3
          run ROOT/L/R on 3
        > A ok
        leave ROOT/A ok
        hit 1 at ROOT/A for the 1. time
        hold ROOT (Breakpoint(1))
        > active
        ROOT Inside (Breakpoint(2) before ROOT/B) (Breakpoint(1))
        ROOT/L Inside
        ROOT/L/R Script
        Stepping, 3 states run
        > resume ROOT/A
          end 1
          preempt ROOT/L
          preempt ROOT/L/R
          end 2
        > R ok
        leave ROOT/L/R preempted
        leave ROOT/L preempted
        leave ROOT won
        finished
          end 3
          end of run: won (0), 3 states
    "]],
    );
}

#[test]
fn a_library_is_held_around_its_root() {
    check(
        RACE,
        "break 1 before ROOT/L/R; break 2 after ROOT/L/R; break 3 after ROOT/L; start; active; resume ROOT/L; L/R ok; active; step into ROOT/L; resume ROOT/L; A ok; B ok",
        &expect![[r"
        > break 1 before ROOT/L/R
        > break 2 after ROOT/L/R
        > break 3 after ROOT/L
        > start
        enter ROOT
        enter ROOT/A
        enter ROOT/B
        enter ROOT/L
        hit 1 at ROOT/L/R for the 1. time
        hold ROOT/L before ROOT/L/R (Breakpoint(1))
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
          fork 3
        > active
        ROOT Inside
        ROOT/A Script
        ROOT/B Script
        ROOT/L Held (Breakpoint(1) before ROOT/L/R)
        Stepping, 3 states run
        > resume ROOT/L
        enter ROOT/L/R
          run ROOT/L/R on 3
        > L/R ok
        leave ROOT/L/R ok
        hit 2 at ROOT/L/R for the 1. time
        hold ROOT/L (Breakpoint(2))
        > active
        ROOT Inside
        ROOT/A Script
        ROOT/B Script
        ROOT/L Held (Breakpoint(2))
        Stepping, 4 states run
        > step into ROOT/L
        leave ROOT/L ok
        hit 3 at ROOT/L for the 1. time
        hold ROOT (Breakpoint(3))
        > resume ROOT/L
          end 3
          preempt ROOT/A
          preempt ROOT/B
        > A ok
        leave ROOT/A preempted
          end 1
        > B ok
        leave ROOT/B preempted
        leave ROOT won
        finished
          end 2
          end of run: won (0), 4 states
    "]],
    );
}

#[test]
fn a_library_that_is_held_ends_when_it_is_preempted() {
    check(
        RACE,
        "break 1 before ROOT/L/R; start; A ok; B ok",
        &expect![[r"
        > break 1 before ROOT/L/R
        > start
        enter ROOT
        enter ROOT/A
        enter ROOT/B
        enter ROOT/L
        hit 1 at ROOT/L/R for the 1. time
        hold ROOT/L before ROOT/L/R (Breakpoint(1))
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
          fork 3
        > A ok
        leave ROOT/A ok
        leave ROOT/L preempted
          end 1
          preempt ROOT/B
          preempt ROOT/L
          end 3
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
fn a_breakpoint_goes_on_while_nobody_is_connected() {
    check(
        LOOP,
        "break 1 before ROOT/A continue; attended false; start; A again; attended true; A again; attended false; A ok",
        &expect![[r"
        > break 1 before ROOT/A continue
        > attended false
        > start
        enter ROOT x=1
        set ROOT.v = 2
        hit 1 at ROOT/A for the 1. time, goes on
        enter ROOT/A n=1
          run ROOT/A
        > A again
        leave ROOT/A again m=0
        set ROOT.v = 0
        hit 1 at ROOT/A for the 2. time, goes on
        enter ROOT/A n=1
          run ROOT/A
        > attended true
        > A again
        leave ROOT/A again m=0
        set ROOT.v = 0
        hit 1 at ROOT/A for the 3. time
        hold ROOT before ROOT/A (Breakpoint(1))
        > attended false
        enter ROOT/A n=1
          run ROOT/A
        > A ok
        leave ROOT/A ok m=0
        set ROOT.v = 0
        enter ROOT/B
          run ROOT/B
    "]],
    );
}

#[test]
fn a_pause_by_a_breakpoint_ends_when_the_last_viewer_is_lost() {
    check(
        BRANCHES,
        "break 1 before ROOT/C/F/B run continue; start; F/A ok; G/A ok; attended false; F/B ok",
        &expect![[r"
        > break 1 before ROOT/C/F/B run continue
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
        > F/A ok
        leave ROOT/C/F/A ok
        hit 1 at ROOT/C/F/B for the 1. time
        paused
        hold ROOT/C/F before ROOT/C/F/B (Breakpoint(1))
          paused true
        > G/A ok
        leave ROOT/C/G/A ok
        hold ROOT/C/G before ROOT/C/G/B (Pause)
        > attended false
        goes on
        enter ROOT/C/F/B
        enter ROOT/C/G/B
          paused false
          run ROOT/C/F/B on 1
          run ROOT/C/G/B on 2
        > F/B ok
        leave ROOT/C/F/B ok
        leave ROOT/C/F ok
          end 1
    "]],
    );
}

#[test]
fn a_breakpoint_stops_the_run_while_nobody_is_connected() {
    check(
        LOOP,
        "break 1 before ROOT/B stop; attended false; start; A ok",
        &expect![[r"
        > break 1 before ROOT/B stop
        > attended false
        > start
        enter ROOT x=1
        set ROOT.v = 2
        enter ROOT/A n=1
          run ROOT/A
        > A ok
        leave ROOT/A ok m=0
        set ROOT.v = 0
        hit 1 at ROOT/B for the 1. time, goes on
        stopping
        leave ROOT preempted
        finished
          preempt ROOT
          end of run: preempted (-2) variables: v=0, 2 states
    "]],
    );
}

#[test]
fn a_held_breakpoint_stops_the_run_when_the_last_viewer_is_lost() {
    check(
        LOOP,
        "break 1 before ROOT/B stop; start; A ok; attended false",
        &expect![[r"
        > break 1 before ROOT/B stop
        > start
        enter ROOT x=1
        set ROOT.v = 2
        enter ROOT/A n=1
          run ROOT/A
        > A ok
        leave ROOT/A ok m=0
        set ROOT.v = 0
        hit 1 at ROOT/B for the 1. time
        hold ROOT before ROOT/B (Breakpoint(1))
        > attended false
        stopping
        leave ROOT preempted
        finished
          preempt ROOT
          end of run: preempted (-2) variables: v=0, 2 states
    "]],
    );
}

#[test]
fn a_breakpoint_may_hold_although_nobody_is_connected() {
    check(
        LOOP,
        "break 1 before ROOT/B; attended false; start; A ok; active; attended true; attended false; resume",
        &expect![[r"
        > break 1 before ROOT/B
        > attended false
        > start
        enter ROOT x=1
        set ROOT.v = 2
        enter ROOT/A n=1
          run ROOT/A
        > A ok
        leave ROOT/A ok m=0
        set ROOT.v = 0
        hit 1 at ROOT/B for the 1. time
        hold ROOT before ROOT/B (Breakpoint(1))
        > active
        ROOT Held (Breakpoint(1) before ROOT/B)
        Stepping, 2 states run
        > attended true
        > attended false
        > resume
        enter ROOT/B
          run ROOT/B
    "]],
    );
}
