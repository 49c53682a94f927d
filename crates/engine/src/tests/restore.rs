//! Restores a run in another engine.

use super::{check, check_change};
use expect_test::expect;

const LINE: &str = "
hierarchy ROOT
  outcome done
  in x: int = 7
  var v: int = 1
  start -> A ; A.done -> B ; A.aborted -> C ; B.done -> .done ; C.done -> .done
  flow .x -> B.x ; A.y -> B.y ; A.y -> .v ; .v -> B.z
  execution A
    outcome done
    out y: int = 0
  execution B
    outcome done
    in x: int = 0
    in y: int = 0
    in z: int = 0
  execution C
    outcome done
    in error: object
";

#[test]
fn a_script_runs_again_with_the_inputs_that_it_had() {
    check(
        LINE,
        "start x=5; A done y=3; cut again; active; B done",
        &expect![[r"
        > start x=5
        enter ROOT x=5
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > A done y=3
        leave ROOT/A done y=3
        set ROOT.v = 3
        enter ROOT/B x=5 y=3 z=3
          run ROOT/B
        > cut again
        enter ROOT x=5
        set ROOT.v = 3
        enter ROOT/B x=5 y=3 z=3
          run ROOT/B
        > active
        ROOT Inside
        ROOT/B Script
        Running, 3 states run
        > B done
        leave ROOT/B done
        leave ROOT done
        finished
          end of run: done (0) variables: v=3, 3 states
    "]],
    );
}

#[test]
fn interrupted_scripts_wait_until_somebody_decides() {
    check(
        LINE,
        "start; cut wait; active; recover again; A done y=3; active",
        &expect![[r"
        > start
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > cut wait
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
        wait ROOT/A: interrupted
        > active
        ROOT Inside
        ROOT/A Waiting(Interrupted)
        Stepping, 2 states run
        > recover again
          run ROOT/A
        > A done y=3
        leave ROOT/A done y=3
        set ROOT.v = 3
        hold ROOT before ROOT/B (Step)
        > active
        ROOT Held (Step before ROOT/B)
        Stepping, 2 states run
    "]],
    );
    check(
        LINE,
        "start; cut wait; recover again at ROOT/B; recover abort at ROOT/A; stop",
        &expect![[r#"
        > start
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > cut wait
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
        wait ROOT/A: interrupted
        > recover again at ROOT/B
        refused: no script that a crash interrupted waits at 'ROOT/B'; the snapshot names those that do
        > recover abort at ROOT/A
        leave ROOT/A aborted y=None error="crash"
        hold ROOT before ROOT/C (Step)
        > stop
        stopping
        leave ROOT preempted error="crash"
        finished
          preempt ROOT
          end of run: preempted (-2) error="crash" variables: v=1, 2 states
    "#]],
    );
}

#[test]
fn interrupted_scripts_abort_with_the_crash_as_error() {
    check(
        LINE,
        "start; cut abort; C done",
        &expect![[r#"
        > start
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > cut abort
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
        leave ROOT/A aborted y=None error="crash"
        enter ROOT/C error="crash"
          run ROOT/C error="crash"
        > C done
        leave ROOT/C done
        leave ROOT done
        finished
          end of run: done (0) variables: v=1, 3 states
    "#]],
    );
}

#[test]
fn what_waits_as_interrupted_ends_when_the_run_stops() {
    check(
        LINE,
        "start; cut wait; stop",
        &expect![[r"
        > start
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > cut wait
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
        wait ROOT/A: interrupted
        > stop
        stopping
        leave ROOT/A preempted y=None
        leave ROOT preempted
        finished
          preempt ROOT
          preempt ROOT/A
          end of run: preempted (-2) variables: v=1, 2 states
    "]],
    );
}

#[test]
fn held_scripts_run_again_when_they_are_let_go() {
    check(
        LINE,
        "start; cut again held; active; resume; A done",
        &expect![[r"
        > start
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > cut again held
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
        hold ROOT/A (Start)
        > active
        ROOT Inside
        ROOT/A Held (Start)
        Stepping, 2 states run
        > resume
          run ROOT/A
        > A done
        leave ROOT/A done y=0
        set ROOT.v = 0
        enter ROOT/B x=7 y=0 z=0
          run ROOT/B
    "]],
    );
    check(
        LINE,
        "start; cut again held; stop",
        &expect![[r"
        > start
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > cut again held
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
        hold ROOT/A (Start)
        > stop
        stopping
        leave ROOT/A preempted y=None
        leave ROOT preempted
        finished
          preempt ROOT
          preempt ROOT/A
          end of run: preempted (-2) variables: v=1, 2 states
    "]],
    );
}

const BRANCHES: &str = "
hierarchy ROOT
  outcome done
  start -> P ; P.done -> .done
  barrier P
    outcome done
    flow A.y -> unique_decider_state_id.x
    unique_decider_state_id.done -> .done
    execution A
      outcome done
      out y: int = 0
    hierarchy H
      outcome done
      start -> X ; X.done -> Y ; Y.done -> .done
      execution X
        outcome done
      execution Y
        outcome done
    decider unique_decider_state_id
      outcome done
      in x: int = 0
";

#[test]
fn branches_begin_anew_and_ended_ones_stay_ended() {
    check(
        BRANCHES,
        "start; A done y=4; X done; cut again; active; Y done; unique_decider_state_id done",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/P
            enter ROOT/P/A
            enter ROOT/P/H
            enter ROOT/P/H/X
              fork 1
              run ROOT/P/A on 1
              fork 2
              run ROOT/P/H/X on 2
            > A done y=4
            leave ROOT/P/A done y=4
              end 1
            > X done
            leave ROOT/P/H/X done
            enter ROOT/P/H/Y
              run ROOT/P/H/Y on 2
            > cut again
            enter ROOT
            enter ROOT/P
            enter ROOT/P/H
            enter ROOT/P/H/Y
              fork 1
              run ROOT/P/H/Y on 1
            > active
            ROOT Inside
            ROOT/P Inside
            ROOT/P/H Inside
            ROOT/P/H/Y Script
            Running, 6 states run
            > Y done
            leave ROOT/P/H/Y done
            leave ROOT/P/H done
            enter ROOT/P/unique_decider_state_id x=4
              end 1
              run ROOT/P/unique_decider_state_id [A done] [H done]
            > unique_decider_state_id done
            leave ROOT/P/unique_decider_state_id done
            leave ROOT/P done
            leave ROOT done
            finished
              end of run: done (0), 7 states
        "]],
    );
}

#[test]
fn a_decider_knows_how_the_branches_ended() {
    check(
        BRANCHES,
        "start; A done y=4; X done; Y done; cut again; unique_decider_state_id done",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/P
            enter ROOT/P/A
            enter ROOT/P/H
            enter ROOT/P/H/X
              fork 1
              run ROOT/P/A on 1
              fork 2
              run ROOT/P/H/X on 2
            > A done y=4
            leave ROOT/P/A done y=4
              end 1
            > X done
            leave ROOT/P/H/X done
            enter ROOT/P/H/Y
              run ROOT/P/H/Y on 2
            > Y done
            leave ROOT/P/H/Y done
            leave ROOT/P/H done
            enter ROOT/P/unique_decider_state_id x=4
              end 2
              run ROOT/P/unique_decider_state_id [A done] [H done]
            > cut again
            enter ROOT
            enter ROOT/P
            enter ROOT/P/unique_decider_state_id x=4
              run ROOT/P/unique_decider_state_id [A done] [H done]
            > unique_decider_state_id done
            leave ROOT/P/unique_decider_state_id done
            leave ROOT/P done
            leave ROOT done
            finished
              end of run: done (0), 7 states
        "]],
    );
}

#[test]
fn losers_of_a_race_stay_asked_to_end() {
    let race = "
preemptive ROOT
  outcome done
  A.done -> .done ; B.done -> .done
  execution A
    outcome done
  execution B
    outcome done
";
    check(
        race,
        "start; B done; cut again; A done",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > B done
        leave ROOT/B done
          end 2
          preempt ROOT/A
        > cut again
        enter ROOT
        enter ROOT/A
          fork 1
          run ROOT/A on 1 preempted
        > A done
        leave ROOT/A preempted
        leave ROOT done
        finished
          end 1
          end of run: done (0), 3 states
    "]],
    );
}

#[test]
fn libraries_are_resumed_with_their_roots() {
    let machine = "
hierarchy ROOT
  outcome done
  start -> L ; L.done -> .done
  library L from \"some/library\"
    content
      execution E
        outcome done
        in x: int = 3
";
    check(
        machine,
        "start; cut again; E done",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/L x=3
        enter ROOT/L/E x=3
          run ROOT/L/E
        > cut again
        enter ROOT
        enter ROOT/L x=3
        enter ROOT/L/E x=3
          run ROOT/L/E
        > E done
        leave ROOT/L/E done
        leave ROOT/L done
        leave ROOT done
        finished
          end of run: done (0), 2 states
    "]],
    );
}

#[test]
fn a_run_goes_back_only_while_no_script_runs() {
    check(
        LINE,
        "start; keep; return; pause; A done y=4; return; resume; A done",
        &expect![[r"
        > start
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > keep
        > return
        refused: cannot restore the run: the script of 'ROOT/A' runs; hold the run and wait for its end, or preempt it
        > pause
        paused
          paused true
        > A done y=4
        leave ROOT/A done y=4
        set ROOT.v = 4
        hold ROOT before ROOT/B (Pause)
        > return
        drop ROOT
        goes on
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
        hold ROOT/A (Start)
          paused false
        > resume
          run ROOT/A
        > A done
        leave ROOT/A done y=0
        set ROOT.v = 0
        enter ROOT/B x=7 y=0 z=0
          run ROOT/B
    "]],
    );
}

#[test]
fn what_the_machine_has_no_more_is_refused() {
    let gone = LINE.replace('B', "D");
    check_change(
        LINE,
        &gone,
        "start; A done; cut again elsewhere",
        &expect![[r"
        > start
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > A done
        leave ROOT/A done y=0
        set ROOT.v = 0
        enter ROOT/B x=7 y=0 z=0
          run ROOT/B
        > cut again elsewhere
        refused: cannot restore the run there: 'ROOT/B' does not exist in the machine as it is now; choose another moment, or undo the change of the machine
    "]],
    );
    let other_port = LINE.replace("flow .x -> B.x ; ", "flow ");
    let other_port = other_port.replace("    in x: int = 0\n", "");
    check_change(
        LINE,
        &other_port,
        "start; A done; cut again elsewhere",
        &expect![[r"
        > start
        enter ROOT x=7
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > A done
        leave ROOT/A done y=0
        set ROOT.v = 0
        enter ROOT/B x=7 y=0 z=0
          run ROOT/B
        > cut again elsewhere
        refused: cannot restore the run there: 'ROOT/B' has no input 2 in the machine as it is now; choose another moment, or undo the change of the machine
    "]],
    );
}

const HANDLER: &str = "
hierarchy ROOT
  outcome done
  start -> H ; H.done -> .done ; H.preempted -> .done
  hierarchy H
    outcome done
    start -> A ; A.done -> .done ; A.preempted -> C ; C.done -> .done
    execution A
      outcome done
    execution C
      outcome done
";

#[test]
fn a_handler_is_not_asked_to_end_although_the_state_before_it_is_gone() {
    let gone = "
hierarchy ROOT
  outcome done
  start -> H ; H.done -> .done ; H.preempted -> .done
  hierarchy H
    outcome done
    start -> C ; C.done -> .done
    execution C
      outcome done
";
    check_change(
        HANDLER,
        gone,
        "start; preempt ROOT/H; A done; change; cut again elsewhere; active; C done",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/H
            enter ROOT/H/A
              run ROOT/H/A
            > preempt ROOT/H
              preempt ROOT/H
              preempt ROOT/H/A
            > A done
            leave ROOT/H/A preempted
            enter ROOT/H/C
              run ROOT/H/C
            > change
            changed
            > cut again elsewhere
            enter ROOT
            enter ROOT/H
            enter ROOT/H/C
              run ROOT/H/C
            > active
            ROOT Inside
            ROOT/H Inside preempted
            ROOT/H/C Script
            Running, 4 states run
            > C done
            leave ROOT/H/C done
            leave ROOT/H preempted
            leave ROOT done
            finished
              end of run: done (0), 4 states
        "]],
    );
}

#[test]
fn a_run_that_stops_goes_on_stopping() {
    check(
        HANDLER,
        "start; stop; A done; cut again; active; C done",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/H
            enter ROOT/H/A
              run ROOT/H/A
            > stop
            stopping
              preempt ROOT
              preempt ROOT/H
              preempt ROOT/H/A
            > A done
            leave ROOT/H/A preempted
            enter ROOT/H/C
              run ROOT/H/C
            > cut again
            enter ROOT
            enter ROOT/H
            enter ROOT/H/C
            stopping
              run ROOT/H/C
            > active
            ROOT Inside preempted
            ROOT/H Inside preempted
            ROOT/H/C Script
            Stopping, 4 states run
            > C done
            leave ROOT/H/C done
            leave ROOT/H preempted
            leave ROOT preempted
            finished
              end of run: preempted (-2), 4 states
        "]],
    );
}

#[test]
fn a_run_that_stops_is_resumed_twice_and_stopped_again() {
    check(
        HANDLER,
        "start; stop; cut again; A done; stop; cut again; C done",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/H
            enter ROOT/H/A
              run ROOT/H/A
            > stop
            stopping
              preempt ROOT
              preempt ROOT/H
              preempt ROOT/H/A
            > cut again
            enter ROOT
            enter ROOT/H
            enter ROOT/H/A
            stopping
              run ROOT/H/A preempted
            > A done
            leave ROOT/H/A preempted
            enter ROOT/H/C
              run ROOT/H/C
            > stop
            stopping
              preempt ROOT/H/C
            > cut again
            enter ROOT
            enter ROOT/H
            enter ROOT/H/C
            stopping
              run ROOT/H/C preempted
            > C done
            leave ROOT/H/C preempted
            leave ROOT/H preempted
            leave ROOT preempted
            finished
              end of run: preempted (-2), 4 states
        "]],
    );
}

#[test]
fn a_run_that_stops_ends_by_the_policy_abort() {
    check(
        HANDLER,
        "start; stop; cut abort",
        &expect![[r#"
            > start
            enter ROOT
            enter ROOT/H
            enter ROOT/H/A
              run ROOT/H/A
            > stop
            stopping
              preempt ROOT
              preempt ROOT/H
              preempt ROOT/H/A
            > cut abort
            enter ROOT
            enter ROOT/H
            enter ROOT/H/A
            stopping
            leave ROOT/H/A aborted error="crash"
            leave ROOT/H preempted error="crash"
            leave ROOT preempted
            finished
              end of run: preempted (-2), 3 states
        "#]],
    );
}

#[test]
fn what_was_asked_to_end_does_not_wait_as_interrupted() {
    check(
        HANDLER,
        "start; preempt ROOT/H; cut wait; active",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/H
            enter ROOT/H/A
              run ROOT/H/A
            > preempt ROOT/H
              preempt ROOT/H
              preempt ROOT/H/A
            > cut wait
            enter ROOT
            enter ROOT/H
            enter ROOT/H/A
            leave ROOT/H/A preempted
            hold ROOT/H before ROOT/H/C (Start)
            > active
            ROOT Inside
            ROOT/H Held preempted (Start before ROOT/H/C)
            Stepping, 3 states run
        "]],
    );
}

#[test]
fn a_branch_that_was_let_go_before_it_began_never_begins() {
    let machine = "
barrier ROOT
  outcome done
  unique_decider_state_id.done -> .done
  execution A
    outcome done
  execution B
    outcome done
  decider unique_decider_state_id
    outcome done
";
    check(
        machine,
        "start hold; resume ROOT/A; preempt ROOT; cut again; A done",
        &expect![[r"
            > start hold
            enter ROOT
            hold ROOT before ROOT/A (Start)
            hold ROOT before ROOT/B (Start)
              fork 1
              fork 2
            > resume ROOT/A
            enter ROOT/A
              run ROOT/A on 1
            > preempt ROOT
              preempt ROOT
              preempt ROOT/A
              end 2
            > cut again
            enter ROOT
            enter ROOT/A
              fork 1
              run ROOT/A on 1 preempted
            > A done
            leave ROOT/A preempted
            leave ROOT preempted
            finished
              end 1
              end of run: preempted (-2), 2 states
        "]],
    );
}

#[test]
fn a_race_without_children_that_was_asked_to_end_ends() {
    let machine = "
hierarchy ROOT
  outcome done
  start -> A ; A.done -> B ; A.preempted -> B ; B.done -> .done
  execution A
    outcome done
  execution B
    outcome done
";
    let race = machine.replacen("  execution A", "  preemptive A", 1);
    check_change(
        machine,
        &race,
        "start; preempt ROOT/A; keep; pause; A done; change; return; active",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > preempt ROOT/A
              preempt ROOT/A
            > keep
            > pause
            paused
              paused true
            > A done
            leave ROOT/A preempted
            hold ROOT before ROOT/B (Pause)
            > change
            changed
            > return
            drop ROOT
            goes on
            enter ROOT
            enter ROOT/A
            leave ROOT/A preempted
            hold ROOT before ROOT/B (Start)
              paused false
            > active
            ROOT Held (Start before ROOT/B)
            Stepping, 2 states run
        "]],
    );
}

#[test]
fn branches_that_were_resumed_are_not_stepped_back_into() {
    let machine = "
hierarchy ROOT
  outcome done
  start -> P ; P.done -> Z ; Z.done -> .done
  barrier P
    outcome done
    unique_decider_state_id.done -> .done
    execution A
      outcome done
    decider unique_decider_state_id
      outcome done
  execution Z
    outcome done
";
    check(
        machine,
        "start; cut again; pause; A done; unique_decider_state_id done; step back",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/P
            enter ROOT/P/A
              fork 1
              run ROOT/P/A on 1
            > cut again
            enter ROOT
            enter ROOT/P
            enter ROOT/P/A
              fork 1
              run ROOT/P/A on 1
            > pause
            paused
              paused true
            > A done
            leave ROOT/P/A done
            enter ROOT/P/unique_decider_state_id
              end 1
              run ROOT/P/unique_decider_state_id [A done]
            > unique_decider_state_id done
            leave ROOT/P/unique_decider_state_id done
            leave ROOT/P done
            hold ROOT before ROOT/Z (Pause)
            > step back
            refused: cannot step back in 'ROOT': its data is lost, because it is too long ago, its states have changed since, or the run was resumed after it; start again at a moment of the history
        "]],
    );
}
