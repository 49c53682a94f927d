//! Steps back through concurrency states: each branch to its own start, with its outputs removed.
#![expect(clippy::too_many_lines, reason = "what a run does, forwards and back, is long to tell")]

use super::check;
use expect_test::expect;

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
fn a_resume_during_a_step_back_lets_every_branch_continue() {
    check(
        BRANCHES,
        "start hold; step over; F/A ok; F/B ok; G/A ok; G/B ok; S ok; unique_decider_state_id ok; step back; step back; F/B ok; resume; S ok; G/B ok; active",
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
            > step back
            enter back 2 ROOT/C
            enter back 3 ROOT/C/F
            hold ROOT/C/F (Step)
            enter back 5 ROOT/C/G
            hold ROOT/C/G (Step)
            enter back 7 ROOT/C/S
              fork 3
              fork 2
              fork 1
              undo ROOT/C/S on 1
            > step back
            enter back 8 ROOT/C/F/B
            enter back 9 ROOT/C/G/B
              undo ROOT/C/F/B on 3
              undo ROOT/C/G/B on 2
            > F/B ok
            leave back 8 ROOT/C/F/B ok
            hold ROOT/C/F before ROOT/C/F/B (Step)
            > resume
            enter ROOT/C/F/B
              run ROOT/C/F/B on 3
            > S ok
            leave back 7 ROOT/C/S ok
            hold ROOT/C before ROOT/C/S (Start)
            enter ROOT/C/S
              run ROOT/C/S on 1
            > G/B ok
            leave back 9 ROOT/C/G/B ok
            hold ROOT/C/G before ROOT/C/G/B (Step)
            enter ROOT/C/G/B
              run ROOT/C/G/B on 2
            > active
            ROOT Inside
            ROOT/C Inside
            ROOT/C/F Inside
            ROOT/C/F/B Script
            ROOT/C/G Inside
            ROOT/C/G/B Script
            ROOT/C/S Script
            Running, 13 states run
        "]],
    );
}

#[test]
fn a_step_back_takes_back_the_forced_outcome_of_a_decider() {
    check(
        BRANCHES,
        "break 1 before ROOT/C/unique_decider_state_id; break 2 before ROOT/Z; start at ROOT/C; F/A ok; F/B ok; G/A ok; G/B ok; S ok; force ROOT/C/unique_decider_state_id 0; step back; S ok; resume; S ok",
        &expect![[r"
            > break 1 before ROOT/C/unique_decider_state_id
            > break 2 before ROOT/Z
            > start at ROOT/C
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
            > force ROOT/C/unique_decider_state_id 0
            force ROOT/C/unique_decider_state_id ok
            leave ROOT/C done
            hit 2 at ROOT/Z for the 1. time
            hold ROOT before ROOT/Z (Breakpoint(2))
            > step back
            enter back 2 ROOT/C
            enter back 3 ROOT/C/F
            hold ROOT/C/F (Step)
            enter back 5 ROOT/C/G
            hold ROOT/C/G (Step)
            enter back 7 ROOT/C/S
              fork 3
              fork 2
              fork 1
              undo ROOT/C/S on 1
            > S ok
            leave back 7 ROOT/C/S ok
            hold ROOT/C before ROOT/C/S (Start)
            > resume
            enter ROOT/C/S
            leave ROOT/C/F ok
            leave ROOT/C/G ok
              run ROOT/C/S on 1
              end 3
              end 2
            > S ok
            leave ROOT/C/S ok
            hit 1 at ROOT/C/unique_decider_state_id for the 2. time
            hold ROOT/C before ROOT/C/unique_decider_state_id (Breakpoint(1))
              end 1
        "]],
    );
}

#[test]
fn branches_step_back_to_their_own_starts() {
    check(
        BRANCHES,
        "start hold; step over; F/A ok; F/B ok; G/A ok; G/B ok; S ok; unique_decider_state_id ok; step back; active; step back; F/B ok; S ok; G/B ok; active; step back; F/A ok; active; G/A ok; active",
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
            > step back
            enter back 2 ROOT/C
            enter back 3 ROOT/C/F
            hold ROOT/C/F (Step)
            enter back 5 ROOT/C/G
            hold ROOT/C/G (Step)
            enter back 7 ROOT/C/S
              fork 3
              fork 2
              fork 1
              undo ROOT/C/S on 1
            > active
            ROOT Inside
            ROOT/C Inside
            ROOT/C/F Held (Step)
            ROOT/C/G Held (Step)
            ROOT/C/S Script
            Stepping, 10 states run
            > step back
            enter back 8 ROOT/C/F/B
            enter back 9 ROOT/C/G/B
              undo ROOT/C/F/B on 3
              undo ROOT/C/G/B on 2
            > F/B ok
            leave back 8 ROOT/C/F/B ok
            hold ROOT/C/F before ROOT/C/F/B (Step)
            > S ok
            leave back 7 ROOT/C/S ok
            hold ROOT/C before ROOT/C/S (Start)
            > G/B ok
            leave back 9 ROOT/C/G/B ok
            hold ROOT/C/G before ROOT/C/G/B (Step)
            > active
            ROOT Inside
            ROOT/C Inside (Start before ROOT/C/S)
            ROOT/C/F Held (Step before ROOT/C/F/B)
            ROOT/C/G Held (Step before ROOT/C/G/B)
            Stepping, 10 states run
            > step back
            enter back 4 ROOT/C/F/A
            enter back 6 ROOT/C/G/A
              undo ROOT/C/F/A on 3
              undo ROOT/C/G/A on 2
            > F/A ok
            leave back 4 ROOT/C/F/A ok
            leave back 3 ROOT/C/F ok
            hold ROOT/C before ROOT/C/F (Start)
            > active
            ROOT Inside
            ROOT/C Inside (Start before ROOT/C/S) (Start before ROOT/C/F)
            ROOT/C/G Inside
            ROOT/C/G/A Script
            Stepping, 10 states run
            > G/A ok
            leave back 6 ROOT/C/G/A ok
            leave back 5 ROOT/C/G ok
            hold ROOT/C before ROOT/C/G (Start)
            leave back 2 ROOT/C done
            hold ROOT before ROOT/C (Start)
              end 3
              end 2
              end 1
            > active
            ROOT Held (Start before ROOT/C)
            Stepping, 10 states run
        "]],
    );
}

#[test]
fn one_branch_steps_back() {
    check(
        BRANCHES,
        "start hold; step into; step over; F/A ok; G/A ok; S ok; step back ROOT/C/S; S ok; active; step back ROOT/C/S; step back ROOT/C/G; G/A ok; step back ROOT/C/F; active; F/A ok; active",
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
            > step over
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
            > S ok
            leave ROOT/C/S ok
              end 3
            > step back ROOT/C/S
            enter back 5 ROOT/C/S
              fork 3
              undo ROOT/C/S on 3
            > S ok
            leave back 5 ROOT/C/S ok
            hold ROOT/C before ROOT/C/S (Start)
            > active
            ROOT Inside
            ROOT/C Inside (Start before ROOT/C/S)
            ROOT/C/F Held (Step before ROOT/C/F/B)
            ROOT/C/G Held (Step before ROOT/C/G/B)
            Stepping, 7 states run
            > step back ROOT/C/S
            refused: 'ROOT/C/S' is held at its beginning, and nothing comes before; step forwards
            > step back ROOT/C/G
            enter back 7 ROOT/C/G/A
              undo ROOT/C/G/A on 2
            > G/A ok
            leave back 7 ROOT/C/G/A ok
            leave back 4 ROOT/C/G preempted
            hold ROOT/C before ROOT/C/G (Start)
            > step back ROOT/C/F
            enter back 6 ROOT/C/F/A
              undo ROOT/C/F/A on 1
            > active
            ROOT Inside
            ROOT/C Inside (Start before ROOT/C/S) (Start before ROOT/C/G)
            ROOT/C/F Inside
            ROOT/C/F/A Script
            Stepping, 7 states run
            > F/A ok
            leave back 6 ROOT/C/F/A ok
            leave back 3 ROOT/C/F preempted
            hold ROOT/C before ROOT/C/F (Start)
            leave back 2 ROOT/C preempted
            hold ROOT before ROOT/C (Start)
              end 1
              end 2
              end 3
            > active
            ROOT Held (Start before ROOT/C)
            Stepping, 7 states run
        "]],
    );
}

#[test]
fn a_branch_at_its_start_begins_anew() {
    check(
        BRANCHES,
        "start hold; step over; F/A ok; F/B ok; G/A ok; G/B ok; S ok; unique_decider_state_id ok; step back; S ok; step into ROOT/C/S; S ok; step over ROOT/C/F; step over ROOT/C/G; unique_decider_state_id ok; step back; S ok; active",
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
            > step back
            enter back 2 ROOT/C
            enter back 3 ROOT/C/F
            hold ROOT/C/F (Step)
            enter back 5 ROOT/C/G
            hold ROOT/C/G (Step)
            enter back 7 ROOT/C/S
              fork 3
              fork 2
              fork 1
              undo ROOT/C/S on 1
            > S ok
            leave back 7 ROOT/C/S ok
            hold ROOT/C before ROOT/C/S (Start)
            > step into ROOT/C/S
            enter ROOT/C/S
              run ROOT/C/S on 1
            > S ok
            leave ROOT/C/S ok
              end 1
            > step over ROOT/C/F
            leave ROOT/C/F ok
              end 3
            > step over ROOT/C/G
            leave ROOT/C/G ok
            enter ROOT/C/unique_decider_state_id
              end 2
              run ROOT/C/unique_decider_state_id [F ok] [G ok] [S ok]
            > unique_decider_state_id ok
            leave ROOT/C/unique_decider_state_id ok
            leave ROOT/C done
            hold ROOT before ROOT/Z (Step)
            > step back
            enter back 2 ROOT/C
            enter back 3 ROOT/C/F
            hold ROOT/C/F (Step)
            enter back 5 ROOT/C/G
            hold ROOT/C/G (Step)
            enter back 15 ROOT/C/S
              fork 2
              fork 3
              fork 1
              undo ROOT/C/S on 1
            > S ok
            leave back 15 ROOT/C/S ok
            hold ROOT/C before ROOT/C/S (Start)
            > active
            ROOT Inside
            ROOT/C Inside (Start before ROOT/C/S)
            ROOT/C/F Held (Step)
            ROOT/C/G Held (Step)
            Stepping, 12 states run
        "]],
    );
}

#[test]
fn a_held_decider_is_passed_over() {
    check(
        BRANCHES,
        "break 1 before ROOT/C/unique_decider_state_id; break 2 after ROOT/C/unique_decider_state_id; start; F/A ok; F/B ok; G/A ok; G/B ok; S ok; step back ROOT/C/S; active; S ok; step into; S ok; resume; unique_decider_state_id ok; step back; active",
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
            > step back ROOT/C/S
            enter back 7 ROOT/C/S
              fork 3
              undo ROOT/C/S on 3
            > active
            ROOT Inside
            ROOT/C Inside
            ROOT/C/S Script
            Stepping, 9 states run
            > S ok
            leave back 7 ROOT/C/S ok
            hold ROOT/C before ROOT/C/S (Start)
            > step into
            enter ROOT/C/S
              run ROOT/C/S on 3
            > S ok
            leave ROOT/C/S ok
            hit 1 at ROOT/C/unique_decider_state_id for the 2. time
            hold ROOT/C before ROOT/C/unique_decider_state_id (Breakpoint(1))
              end 3
            > resume
            enter ROOT/C/unique_decider_state_id
              run ROOT/C/unique_decider_state_id [F ok] [G ok] [S ok]
            > unique_decider_state_id ok
            leave ROOT/C/unique_decider_state_id ok
            hit 2 at ROOT/C/unique_decider_state_id for the 1. time
            hold ROOT/C (Breakpoint(2))
            > step back
            enter back 3 ROOT/C/F
            hold ROOT/C/F (Step)
            enter back 5 ROOT/C/G
            hold ROOT/C/G (Step)
            enter back 11 ROOT/C/S
              fork 3
              fork 2
              fork 1
              undo ROOT/C/S on 1
            > active
            ROOT Inside
            ROOT/C Inside
            ROOT/C/F Held (Step)
            ROOT/C/G Held (Step)
            ROOT/C/S Script
            Stepping, 11 states run
        "]],
    );
}

const VALUES: &str = "
hierarchy ROOT
  outcome done
  var v: int = 1
  start -> C ; C.done -> Z ; Z.ok -> .done
  flow C.z -> .v
  barrier C
    outcome done
    out z: int = 0
    var w: int = 2
    unique_decider_state_id.ok -> .done
    flow .w -> S.x ; .w -> T.x ; S.y -> .w ; T.y -> .w ; .w -> .z
    execution S
      outcome ok
      in x: int = 0
      out y: int = 0
    execution T
      outcome ok
      in x: int = 0
      out y: int = 0
    decider unique_decider_state_id
      outcome ok
  execution Z
    outcome ok
";

#[test]
fn what_branches_gave_is_taken_back() {
    check(
        VALUES,
        "start hold; step over; S ok y=3; T ok y=4; unique_decider_state_id ok; step back; S ok; active; T ok; active; step over; S ok y=5; T ok y=6; unique_decider_state_id ok",
        &expect![[r"
            > start hold
            enter ROOT
            set ROOT.v = 1
            hold ROOT before ROOT/C (Start)
            > step over
            enter ROOT/C
            set ROOT/C.w = 2
            enter ROOT/C/S x=2
            enter ROOT/C/T x=2
              fork 1
              run ROOT/C/S on 1
              fork 2
              run ROOT/C/T on 2
            > S ok y=3
            leave ROOT/C/S ok y=3
            set ROOT/C.w = 3
              end 1
            > T ok y=4
            leave ROOT/C/T ok y=4
            set ROOT/C.w = 4
            enter ROOT/C/unique_decider_state_id
              end 2
              run ROOT/C/unique_decider_state_id [S ok] [T ok]
            > unique_decider_state_id ok
            leave ROOT/C/unique_decider_state_id ok
            leave ROOT/C done z=4
            set ROOT.v = 4
            hold ROOT before ROOT/Z (Step)
            > step back
            enter back 2 ROOT/C
            set ROOT/C.w = 4
            enter back 3 ROOT/C/S x=4
            enter back 4 ROOT/C/T x=4
            set ROOT/C.w = 2
              fork 2
              undo ROOT/C/S on 2 x=4
              fork 1
              undo ROOT/C/T on 1 x=4
            > S ok
            leave back 3 ROOT/C/S ok y=None
            hold ROOT/C before ROOT/C/S (Start)
            > active
            ROOT Inside
            ROOT/C Inside (Start before ROOT/C/S)
            ROOT/C/T Script
            Stepping, 5 states run
            > T ok
            leave back 4 ROOT/C/T ok y=None
            hold ROOT/C before ROOT/C/T (Start)
            leave back 2 ROOT/C done z=None
            set ROOT.v = 1
            hold ROOT before ROOT/C (Start)
              end 2
              end 1
            > active
            ROOT Held (Start before ROOT/C)
            Stepping, 5 states run
            > step over
            enter ROOT/C
            set ROOT/C.w = 2
            enter ROOT/C/S x=2
            enter ROOT/C/T x=2
              fork 2
              run ROOT/C/S on 2
              fork 1
              run ROOT/C/T on 1
            > S ok y=5
            leave ROOT/C/S ok y=5
            set ROOT/C.w = 5
              end 2
            > T ok y=6
            leave ROOT/C/T ok y=6
            set ROOT/C.w = 6
            enter ROOT/C/unique_decider_state_id
              end 1
              run ROOT/C/unique_decider_state_id [S ok] [T ok]
            > unique_decider_state_id ok
            leave ROOT/C/unique_decider_state_id ok
            leave ROOT/C done z=6
            set ROOT.v = 6
            hold ROOT before ROOT/Z (Step)
        "]],
    );
}

#[test]
fn one_branch_keeps_what_the_other_gave() {
    check(
        VALUES,
        "start; step mode; S ok y=3; break 1 before ROOT/C/unique_decider_state_id; T ok y=4; step back ROOT/C/T; T ok; resume ROOT/C/T; T ok y=5",
        &expect![[r"
            > start
            enter ROOT
            set ROOT.v = 1
            enter ROOT/C
            set ROOT/C.w = 2
            enter ROOT/C/S x=2
            enter ROOT/C/T x=2
              fork 1
              run ROOT/C/S on 1
              fork 2
              run ROOT/C/T on 2
            > step mode
            > S ok y=3
            leave ROOT/C/S ok y=3
            set ROOT/C.w = 3
              end 1
            > break 1 before ROOT/C/unique_decider_state_id
            > T ok y=4
            leave ROOT/C/T ok y=4
            set ROOT/C.w = 4
            hit 1 at ROOT/C/unique_decider_state_id for the 1. time
            hold ROOT/C before ROOT/C/unique_decider_state_id (Breakpoint(1))
              end 2
            > step back ROOT/C/T
            enter back 4 ROOT/C/T x=4
            set ROOT/C.w = 3
              fork 2
              undo ROOT/C/T on 2 x=4
            > T ok
            leave back 4 ROOT/C/T ok y=None
            hold ROOT/C before ROOT/C/T (Start)
            > resume ROOT/C/T
            enter ROOT/C/T x=3
              run ROOT/C/T on 2
            > T ok y=5
            leave ROOT/C/T ok y=5
            set ROOT/C.w = 5
            hit 1 at ROOT/C/unique_decider_state_id for the 2. time
            hold ROOT/C before ROOT/C/unique_decider_state_id (Breakpoint(1))
              end 2
        "]],
    );
}

const RACE: &str = "
hierarchy ROOT
  outcome done
  var v: int = 0
  start -> R ; R.won -> Z ; Z.ok -> .done
  flow R.z -> .v
  preemptive R
    outcome won
    out z: int = 9
    A.ok -> .won ; N.ok -> .won
    flow A.y -> .z
    execution A
      outcome ok
      out y: int = 1
    barrier N
      outcome ok
      unique_decider_state_id.ok -> .ok
      hierarchy H
        outcome ok
        start -> P ; P.ok -> Q ; Q.ok -> .ok
        execution P
          outcome ok
        execution Q
          outcome ok
      execution S
        outcome ok
      decider unique_decider_state_id
        outcome ok
  execution Z
    outcome ok
";

#[test]
fn a_race_is_stepped_back_with_all_who_ran() {
    check(
        RACE,
        "start hold; step over; H/P ok; S ok; A ok y=5; H/Q ok; step back; active; A ok; step back; S ok; H/Q ok; active; step back; P ok; active",
        &expect![[r"
            > start hold
            enter ROOT
            set ROOT.v = 0
            hold ROOT before ROOT/R (Start)
            > step over
            enter ROOT/R
            enter ROOT/R/A
            enter ROOT/R/N
            enter ROOT/R/N/H
            enter ROOT/R/N/H/P
            enter ROOT/R/N/S
              fork 1
              run ROOT/R/A on 1
              fork 2
              fork 3
              run ROOT/R/N/H/P on 3
              fork 4
              run ROOT/R/N/S on 4
            > H/P ok
            leave ROOT/R/N/H/P ok
            enter ROOT/R/N/H/Q
              run ROOT/R/N/H/Q on 3
            > S ok
            leave ROOT/R/N/S ok
              end 4
            > A ok y=5
            leave ROOT/R/A ok y=5
              end 1
              preempt ROOT/R/N
              preempt ROOT/R/N/H
              preempt ROOT/R/N/H/Q
            > H/Q ok
            leave ROOT/R/N/H/Q preempted
            leave ROOT/R/N/H preempted
            leave ROOT/R/N preempted
            leave ROOT/R won z=5
            set ROOT.v = 5
            hold ROOT before ROOT/Z (Step)
              end 3
              end 2
            > step back
            enter back 2 ROOT/R
            enter back 3 ROOT/R/A
            enter back 4 ROOT/R/N
            enter back 5 ROOT/R/N/H
            hold ROOT/R/N/H (Step)
            enter back 7 ROOT/R/N/S
              fork 3
              undo ROOT/R/A on 3
              fork 2
              fork 1
              fork 4
              undo ROOT/R/N/S on 4
            > active
            ROOT Inside
            ROOT/R Inside
            ROOT/R/A Script
            ROOT/R/N Inside
            ROOT/R/N/H Held (Step)
            ROOT/R/N/S Script
            Stepping, 8 states run
            > A ok
            leave back 3 ROOT/R/A ok y=None
            hold ROOT/R before ROOT/R/A (Start)
            > step back
            enter back 8 ROOT/R/N/H/Q
              undo ROOT/R/N/H/Q on 1
            > S ok
            leave back 7 ROOT/R/N/S ok
            hold ROOT/R/N before ROOT/R/N/S (Start)
            > H/Q ok
            leave back 8 ROOT/R/N/H/Q preempted
            hold ROOT/R/N/H before ROOT/R/N/H/Q (Step)
            > active
            ROOT Inside
            ROOT/R Inside (Start before ROOT/R/A)
            ROOT/R/N Inside (Start before ROOT/R/N/S)
            ROOT/R/N/H Held (Step before ROOT/R/N/H/Q)
            Stepping, 8 states run
            > step back
            enter back 6 ROOT/R/N/H/P
              undo ROOT/R/N/H/P on 1
            > P ok
            leave back 6 ROOT/R/N/H/P ok
            leave back 5 ROOT/R/N/H preempted
            hold ROOT/R/N before ROOT/R/N/H (Start)
            leave back 4 ROOT/R/N preempted
            hold ROOT/R before ROOT/R/N (Start)
            leave back 2 ROOT/R won z=None
            set ROOT.v = 0
            hold ROOT before ROOT/R (Start)
              end 1
              end 4
              end 3
              end 2
            > active
            ROOT Held (Start before ROOT/R)
            Stepping, 8 states run
        "]],
    );
}

#[test]
fn nested_branches_are_held_each() {
    check(
        RACE,
        "start hold; step over; H/P ok; H/Q ok; S ok; unique_decider_state_id ok; A ok; step back; active; A ok; S ok; active; step back; Q ok; step back ROOT/R/N; P ok; step over; active",
        &expect![[r"
            > start hold
            enter ROOT
            set ROOT.v = 0
            hold ROOT before ROOT/R (Start)
            > step over
            enter ROOT/R
            enter ROOT/R/A
            enter ROOT/R/N
            enter ROOT/R/N/H
            enter ROOT/R/N/H/P
            enter ROOT/R/N/S
              fork 1
              run ROOT/R/A on 1
              fork 2
              fork 3
              run ROOT/R/N/H/P on 3
              fork 4
              run ROOT/R/N/S on 4
            > H/P ok
            leave ROOT/R/N/H/P ok
            enter ROOT/R/N/H/Q
              run ROOT/R/N/H/Q on 3
            > H/Q ok
            leave ROOT/R/N/H/Q ok
            leave ROOT/R/N/H ok
              end 3
            > S ok
            leave ROOT/R/N/S ok
            enter ROOT/R/N/unique_decider_state_id
              end 4
              run ROOT/R/N/unique_decider_state_id on 2 [H ok] [S ok]
            > unique_decider_state_id ok
            leave ROOT/R/N/unique_decider_state_id ok
            leave ROOT/R/N ok
              end 2
              preempt ROOT/R/A
            > A ok
            leave ROOT/R/A preempted y=1
            leave ROOT/R won z=1
            set ROOT.v = 1
            hold ROOT before ROOT/Z (Step)
              end 1
            > step back
            enter back 2 ROOT/R
            enter back 3 ROOT/R/A
            enter back 4 ROOT/R/N
            enter back 5 ROOT/R/N/H
            hold ROOT/R/N/H (Step)
            enter back 7 ROOT/R/N/S
              fork 1
              undo ROOT/R/A on 1
              fork 2
              fork 4
              fork 3
              undo ROOT/R/N/S on 3
            > active
            ROOT Inside
            ROOT/R Inside
            ROOT/R/A Script
            ROOT/R/N Inside
            ROOT/R/N/H Held (Step)
            ROOT/R/N/S Script
            Stepping, 9 states run
            > A ok
            leave back 3 ROOT/R/A preempted y=None
            hold ROOT/R before ROOT/R/A (Start)
            > S ok
            leave back 7 ROOT/R/N/S ok
            hold ROOT/R/N before ROOT/R/N/S (Start)
            > active
            ROOT Inside
            ROOT/R Inside (Start before ROOT/R/A)
            ROOT/R/N Inside (Start before ROOT/R/N/S)
            ROOT/R/N/H Held (Step)
            Stepping, 9 states run
            > step back
            enter back 8 ROOT/R/N/H/Q
              undo ROOT/R/N/H/Q on 4
            > Q ok
            leave back 8 ROOT/R/N/H/Q ok
            hold ROOT/R/N/H before ROOT/R/N/H/Q (Step)
            > step back ROOT/R/N
            enter back 6 ROOT/R/N/H/P
              undo ROOT/R/N/H/P on 4
            > P ok
            leave back 6 ROOT/R/N/H/P ok
            leave back 5 ROOT/R/N/H ok
            hold ROOT/R/N before ROOT/R/N/H (Start)
            leave back 4 ROOT/R/N ok
            hold ROOT/R before ROOT/R/N (Start)
            leave back 2 ROOT/R won z=None
            set ROOT.v = 0
            hold ROOT before ROOT/R (Start)
              end 4
              end 3
              end 1
              end 2
            > step over
            enter ROOT/R
            enter ROOT/R/A
            enter ROOT/R/N
            enter ROOT/R/N/H
            enter ROOT/R/N/H/P
            enter ROOT/R/N/S
              fork 4
              run ROOT/R/A on 4
              fork 3
              fork 1
              run ROOT/R/N/H/P on 1
              fork 2
              run ROOT/R/N/S on 2
            > active
            ROOT Inside
            ROOT/R Inside
            ROOT/R/A Script
            ROOT/R/N Inside
            ROOT/R/N/H Inside
            ROOT/R/N/H/P Script
            ROOT/R/N/S Script
            Stepping, 15 states run
        "]],
    );
}

#[test]
fn a_step_back_during_a_race_that_is_decided_is_refused() {
    check(
        RACE,
        "break 1 before ROOT/R/N/H/Q; start; H/P ok; A ok; step mode; step back",
        &expect![[r"
            > break 1 before ROOT/R/N/H/Q
            > start
            enter ROOT
            set ROOT.v = 0
            enter ROOT/R
            enter ROOT/R/A
            enter ROOT/R/N
            enter ROOT/R/N/H
            enter ROOT/R/N/H/P
            enter ROOT/R/N/S
              fork 1
              run ROOT/R/A on 1
              fork 2
              fork 3
              run ROOT/R/N/H/P on 3
              fork 4
              run ROOT/R/N/S on 4
            > H/P ok
            leave ROOT/R/N/H/P ok
            hit 1 at ROOT/R/N/H/Q for the 1. time
            hold ROOT/R/N/H before ROOT/R/N/H/Q (Breakpoint(1))
            > A ok
            leave ROOT/R/A ok y=1
            leave ROOT/R/N/H preempted
              end 1
              preempt ROOT/R/N
              preempt ROOT/R/N/H
              preempt ROOT/R/N/S
              end 3
            > step mode
            > step back
            refused: nothing is held in this run; wait until a branch comes to its next state
        "]],
    );
}

#[test]
fn a_stop_while_a_state_is_undone_ends_the_run() {
    check(
        BRANCHES,
        "start hold; step over; F/A ok; F/B ok; G/A ok; G/B ok; S ok; unique_decider_state_id ok; step back; stop; S ok",
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
            > step back
            enter back 2 ROOT/C
            enter back 3 ROOT/C/F
            hold ROOT/C/F (Step)
            enter back 5 ROOT/C/G
            hold ROOT/C/G (Step)
            enter back 7 ROOT/C/S
              fork 3
              fork 2
              fork 1
              undo ROOT/C/S on 1
            > stop
            stopping
            leave ROOT/C/F preempted
            leave ROOT/C/G preempted
              preempt ROOT
              preempt ROOT/C
              preempt ROOT/C/F
              preempt ROOT/C/G
              preempt ROOT/C/S
              end 3
              end 2
            > S ok
            leave back 7 ROOT/C/S ok
            leave ROOT/C preempted
            leave ROOT preempted
            finished
              end 1
              end of run: preempted (-2), 10 states
        "]],
    );
}

#[test]
fn the_root_of_a_library_stands_at_the_start_of_its_branches_if_none_of_them_ever_ran() {
    check(
        "
library ROOT from \"x\"
  outcome ok
  content
    barrier C
      outcome ok
      execution A
        outcome ok
      decider unique_decider_state_id
        outcome ok
",
        "break 1 after ROOT/C; start hold; preempt ROOT/C; step back; active; step into; A ok; unique_decider_state_id ok",
        &expect![[r"
            > break 1 after ROOT/C
            > start hold
            enter ROOT
            enter ROOT/C
            hold ROOT/C before ROOT/C/A (Start)
              fork 1
            > preempt ROOT/C
            leave ROOT/C preempted
            hit 1 at ROOT/C for the 1. time
            hold ROOT (Breakpoint(1))
              preempt ROOT/C
              end 1
            > step back
            enter back 2 ROOT/C
            hold ROOT/C before ROOT/C/A (Start)
              fork 1
            > active
            ROOT Inside
            ROOT/C Inside (Start before ROOT/C/A)
            Stepping, 1 states run
            > step into
            enter ROOT/C/A
              run ROOT/C/A on 1
            > A ok
            leave ROOT/C/A ok
            enter ROOT/C/unique_decider_state_id
              end 1
              run ROOT/C/unique_decider_state_id [A ok]
            > unique_decider_state_id ok
            leave ROOT/C/unique_decider_state_id ok
            wait ROOT/C: no transition from ROOT/C/unique_decider_state_id ok
        "]],
    );
}
