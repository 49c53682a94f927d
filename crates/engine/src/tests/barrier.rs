//! Barrier concurrency states.

use super::check;
use expect_test::expect;

const BARRIER: &str = "
barrier ROOT
  outcome good
  outcome bad
  out z: int = 0
  var v: int = 0
  A.ok -> unique_decider_state_id ; B.ok -> unique_decider_state_id
  unique_decider_state_id.yes -> .good ; unique_decider_state_id.no -> .bad
  flow A.y -> unique_decider_state_id.a ; B.y -> unique_decider_state_id.b
  flow A.y -> .v ; B.y -> .v ; .v -> unique_decider_state_id.last ; unique_decider_state_id.d -> .z
  execution A \"First\"
    outcome ok
    out y: int
  execution B \"Second\"
    outcome ok
    out y: int
  decider unique_decider_state_id \"Decider\"
    outcome yes
    outcome no
    outcome unsure
    in a: int
    in b: int
    in last: int
    out d: int
";

#[test]
fn the_decider_sees_outcomes_errors_and_data() {
    check(
        BARRIER,
        "start; B ok y=2; A raises \"boom\"; unique_decider_state_id no d=5",
        &expect![[r#"
            > start
            enter ROOT
            set ROOT.v = 0
            enter ROOT/A
            enter ROOT/B
              fork 1
              run ROOT/A on 1
              fork 2
              run ROOT/B on 2
            > B ok y=2
            leave ROOT/B ok y=2
            set ROOT.v = 2
              end 2
            > A raises "boom"
            leave ROOT/A aborted y=None error="boom"
            set ROOT.v = None
            enter ROOT/unique_decider_state_id a=None b=2 last=None
              end 1
              run ROOT/unique_decider_state_id [First aborted error="boom"] [Second ok]
            > unique_decider_state_id no d=5
            leave ROOT/unique_decider_state_id no d=5
            leave ROOT bad z=5
            finished
              end of run: bad (1) z=5 variables: v=None, 4 states
        "#]],
    );
}

#[test]
fn the_last_to_end_writes_last() {
    check(
        BARRIER,
        "start; A ok y=1; B ok y=2",
        &expect![[r"
        > start
        enter ROOT
        set ROOT.v = 0
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > A ok y=1
        leave ROOT/A ok y=1
        set ROOT.v = 1
          end 1
        > B ok y=2
        leave ROOT/B ok y=2
        set ROOT.v = 2
        enter ROOT/unique_decider_state_id a=1 b=2 last=2
          end 2
          run ROOT/unique_decider_state_id [First ok] [Second ok]
    "]],
    );
    check(
        BARRIER,
        "start; B ok y=2; A ok y=1",
        &expect![[r"
        > start
        enter ROOT
        set ROOT.v = 0
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > B ok y=2
        leave ROOT/B ok y=2
        set ROOT.v = 2
          end 2
        > A ok y=1
        leave ROOT/A ok y=1
        set ROOT.v = 1
        enter ROOT/unique_decider_state_id a=1 b=2 last=1
          end 1
          run ROOT/unique_decider_state_id [First ok] [Second ok]
    "]],
    );
}

#[test]
fn outcomes_of_children_never_decide() {
    let machine = BARRIER.replace("A.ok ->", "A.aborted -> .aborted ; A.ok ->");
    check(
        &machine,
        "start; A aborted; B ok",
        &expect![[r"
        > start
        enter ROOT
        set ROOT.v = 0
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > A aborted
        leave ROOT/A aborted y=None
        set ROOT.v = None
          end 1
        > B ok
        leave ROOT/B ok y=None
        set ROOT.v = None
        enter ROOT/unique_decider_state_id a=None b=None last=None
          end 2
          run ROOT/unique_decider_state_id [First aborted] [Second ok]
    "]],
    );
}

#[test]
fn a_decider_that_aborts_unconnected_aborts_the_barrier() {
    check(
        BARRIER,
        "start; A ok y=1; B ok y=2; unique_decider_state_id raises \"hm\"",
        &expect![[r#"
            > start
            enter ROOT
            set ROOT.v = 0
            enter ROOT/A
            enter ROOT/B
              fork 1
              run ROOT/A on 1
              fork 2
              run ROOT/B on 2
            > A ok y=1
            leave ROOT/A ok y=1
            set ROOT.v = 1
              end 1
            > B ok y=2
            leave ROOT/B ok y=2
            set ROOT.v = 2
            enter ROOT/unique_decider_state_id a=1 b=2 last=2
              end 2
              run ROOT/unique_decider_state_id [First ok] [Second ok]
            > unique_decider_state_id raises "hm"
            leave ROOT/unique_decider_state_id aborted d=None error="hm"
            leave ROOT aborted z=None error="hm"
            finished
              end of run: aborted (-1) z=None error="hm" variables: v=2, 4 states
        "#]],
    );
}

#[test]
fn a_decider_that_aborts_may_be_connected() {
    let machine = BARRIER.replace("unique_decider_state_id.no", "unique_decider_state_id.aborted");
    check(
        &machine,
        "start; A ok y=1; B ok y=2; unique_decider_state_id raises \"hm\"",
        &expect![[r#"
            > start
            enter ROOT
            set ROOT.v = 0
            enter ROOT/A
            enter ROOT/B
              fork 1
              run ROOT/A on 1
              fork 2
              run ROOT/B on 2
            > A ok y=1
            leave ROOT/A ok y=1
            set ROOT.v = 1
              end 1
            > B ok y=2
            leave ROOT/B ok y=2
            set ROOT.v = 2
            enter ROOT/unique_decider_state_id a=1 b=2 last=2
              end 2
              run ROOT/unique_decider_state_id [First ok] [Second ok]
            > unique_decider_state_id raises "hm"
            leave ROOT/unique_decider_state_id aborted d=None error="hm"
            leave ROOT bad z=None error="hm"
            finished
              end of run: bad (1) z=None error="hm" variables: v=2, 4 states
        "#]],
    );
}

#[test]
fn an_unconnected_outcome_of_the_decider_waits_until_it_is_stopped() {
    check(
        BARRIER,
        "start; A ok y=1; B ok y=2; unique_decider_state_id unsure d=3; stop",
        &expect![[r"
            > start
            enter ROOT
            set ROOT.v = 0
            enter ROOT/A
            enter ROOT/B
              fork 1
              run ROOT/A on 1
              fork 2
              run ROOT/B on 2
            > A ok y=1
            leave ROOT/A ok y=1
            set ROOT.v = 1
              end 1
            > B ok y=2
            leave ROOT/B ok y=2
            set ROOT.v = 2
            enter ROOT/unique_decider_state_id a=1 b=2 last=2
              end 2
              run ROOT/unique_decider_state_id [First ok] [Second ok]
            > unique_decider_state_id unsure d=3
            leave ROOT/unique_decider_state_id unsure d=3
            wait ROOT: no transition from ROOT/unique_decider_state_id unsure
            > stop
            stopping
            leave ROOT preempted z=3
            finished
              preempt ROOT
              end of run: preempted (-2) z=3 variables: v=2, 4 states
        "]],
    );
}

#[test]
fn a_preempted_barrier_skips_its_decider() {
    check(
        BARRIER,
        "start; A ok y=1; stop; B ok y=2",
        &expect![[r"
        > start
        enter ROOT
        set ROOT.v = 0
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > A ok y=1
        leave ROOT/A ok y=1
        set ROOT.v = 1
          end 1
        > stop
        stopping
          preempt ROOT
          preempt ROOT/B
        > B ok y=2
        leave ROOT/B preempted y=2
        set ROOT.v = 2
        leave ROOT preempted z=0
        finished
          end 2
          end of run: preempted (-2) z=0 variables: v=2, 3 states
    "]],
    );
}

#[test]
fn a_barrier_preempted_while_it_decides_ends_preempted() {
    check(
        BARRIER,
        "start; A ok y=1; B ok y=2; stop; unique_decider_state_id yes d=3",
        &expect![[r"
            > start
            enter ROOT
            set ROOT.v = 0
            enter ROOT/A
            enter ROOT/B
              fork 1
              run ROOT/A on 1
              fork 2
              run ROOT/B on 2
            > A ok y=1
            leave ROOT/A ok y=1
            set ROOT.v = 1
              end 1
            > B ok y=2
            leave ROOT/B ok y=2
            set ROOT.v = 2
            enter ROOT/unique_decider_state_id a=1 b=2 last=2
              end 2
              run ROOT/unique_decider_state_id [First ok] [Second ok]
            > stop
            stopping
              preempt ROOT
              preempt ROOT/unique_decider_state_id
            > unique_decider_state_id yes d=3
            leave ROOT/unique_decider_state_id preempted d=3
            leave ROOT preempted z=3
            finished
              end of run: preempted (-2) z=3 variables: v=2, 4 states
        "]],
    );
}

#[test]
fn a_barrier_without_children_decides_at_once() {
    check(
        "
barrier ROOT
  outcome good
  unique_decider_state_id.yes -> .good
  decider unique_decider_state_id
    outcome yes
",
        "start; unique_decider_state_id yes",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/unique_decider_state_id
              run ROOT/unique_decider_state_id
            > unique_decider_state_id yes
            leave ROOT/unique_decider_state_id yes
            leave ROOT good
            finished
              end of run: good (0), 2 states
        "]],
    );
}

#[test]
fn a_barrier_without_a_decider_aborts() {
    check(
        "barrier ROOT\n  execution A",
        "start",
        &expect![[r#"
            > start
            enter ROOT
            leave ROOT aborted error="the barrier has no decider; make it anew, or restore its decider's folder"
            finished
              end of run: aborted (-1) error="the barrier has no decider; make it anew, or restore its decider's folder", 1 states
        "#]],
    );
}

#[test]
fn children_get_their_inputs_at_the_start() {
    check(
        "
barrier ROOT
  in x: int = 3
  outcome good
  unique_decider_state_id.yes -> .good
  flow .x -> A.x ; .x -> B.x ; A.y -> B.x
  execution A
    in x: int
    out y: int
  execution B
    in x: int
  decider unique_decider_state_id
    outcome yes
",
        "start; A 0 y=5",
        &expect![[r"
            > start
            enter ROOT x=3
            enter ROOT/A x=3
            enter ROOT/B x=3
              fork 1
              run ROOT/A on 1
              fork 2
              run ROOT/B on 2
            > A 0 y=5
            error ROOT/A: 0 is no outcome
            leave ROOT/A aborted y=5
              end 1
        "]],
    );
}

#[test]
fn a_pause_does_not_hold_the_decider() {
    check(
        BARRIER,
        "start; pause; A ok y=1; B ok y=2",
        &expect![[r"
        > start
        enter ROOT
        set ROOT.v = 0
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > pause
        paused
          paused true
        > A ok y=1
        leave ROOT/A ok y=1
        set ROOT.v = 1
          end 1
        > B ok y=2
        leave ROOT/B ok y=2
        set ROOT.v = 2
        enter ROOT/unique_decider_state_id a=1 b=2 last=2
          end 2
          run ROOT/unique_decider_state_id [First ok] [Second ok]
    "]],
    );
}

#[test]
fn a_barrier_entered_again_forks_again() {
    check(
        "
hierarchy ROOT
  start -> W
  W.good -> W
  barrier W
    outcome good
    unique_decider_state_id.yes -> .good
    execution A
      outcome ok
    decider unique_decider_state_id
      outcome yes
",
        "start; A ok; unique_decider_state_id yes; A ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/W
            enter ROOT/W/A
              fork 1
              run ROOT/W/A on 1
            > A ok
            leave ROOT/W/A ok
            enter ROOT/W/unique_decider_state_id
              end 1
              run ROOT/W/unique_decider_state_id [A ok]
            > unique_decider_state_id yes
            leave ROOT/W/unique_decider_state_id yes
            leave ROOT/W good
            enter ROOT/W
            enter ROOT/W/A
              fork 1
              run ROOT/W/A on 1
            > A ok
            leave ROOT/W/A ok
            enter ROOT/W/unique_decider_state_id
              end 1
              run ROOT/W/unique_decider_state_id [A ok]
        "]],
    );
}
