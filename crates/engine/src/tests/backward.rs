//! Going back step by step: through hierarchies, libraries and branches, with the data as it was.

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
            refused: nothing is held on the branch 'ROOT/C/S'; wait until what runs there has come to its next state
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
            refused: nothing is held in this run; wait until what runs there has come to its next state
        "]],
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
            refused: nothing is held in this run; wait until what runs there has come to its next state
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
