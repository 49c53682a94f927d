//! Preemptive concurrency states, and how a request to end passes through the machine.

use super::check;
use expect_test::expect;

const RACE: &str = "
preemptive ROOT
  outcome one
  outcome two
  out z: int = 0
  A.ok -> .one ; B.ok -> .two
  flow A.y -> .z ; B.y -> .z
  execution A
    outcome ok
    outcome lost
    out y: int
  execution B
    outcome ok
    out y: int
";

#[test]
fn the_first_to_end_preempts_the_others() {
    check(
        RACE,
        "start; B ok y=2; active; A ok y=1",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > B ok y=2
        leave ROOT/B ok y=2
          end 2
          preempt ROOT/A
        > active
        ROOT Inside
        ROOT/A Script preempted
        Running, 3 states run
        > A ok y=1
        leave ROOT/A preempted y=1
        leave ROOT two z=2
        finished
          end 1
          end of run: two (1) z=2, 3 states
    "]],
    );
}

#[test]
fn the_winners_outputs_win() {
    check(
        RACE,
        "start; A ok y=1; B ok y=2",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > A ok y=1
        leave ROOT/A ok y=1
          end 1
          preempt ROOT/B
        > B ok y=2
        leave ROOT/B preempted y=2
        leave ROOT one z=1
        finished
          end 2
          end of run: one (0) z=1, 3 states
    "]],
    );
}

#[test]
fn outputs_of_the_preempted_count_where_the_winner_gives_none() {
    check(
        RACE,
        "start; A ok -y; B ok y=2",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > A ok -y
        leave ROOT/A ok y=None
          end 1
          preempt ROOT/B
        > B ok y=2
        leave ROOT/B preempted y=2
        leave ROOT one z=2
        finished
          end 2
          end of run: one (0) z=2, 3 states
    "]],
    );
}

#[test]
fn a_winner_that_aborts_takes_its_transition_with_its_error() {
    let machine = RACE.replace("A.ok ->", "A.aborted ->");
    check(
        &machine,
        "start; A raises \"boom\"; B ok",
        &expect![[r#"
        > start
        enter ROOT
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > A raises "boom"
        leave ROOT/A aborted y=None error="boom"
          end 1
          preempt ROOT/B
        > B ok
        leave ROOT/B preempted y=None
        leave ROOT one z=None error="boom"
        finished
          end 2
          end of run: one (0) z=None error="boom", 3 states
    "#]],
    );
}

#[test]
fn a_winner_that_aborts_unconnected_aborts_the_race() {
    check(
        RACE,
        "start; A raises \"boom\"; B ok",
        &expect![[r#"
        > start
        enter ROOT
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > A raises "boom"
        leave ROOT/A aborted y=None error="boom"
          end 1
          preempt ROOT/B
        > B ok
        leave ROOT/B preempted y=None
        leave ROOT aborted z=None error="boom"
        finished
          end 2
          end of run: aborted (-1) z=None error="boom", 3 states
    "#]],
    );
}

#[test]
fn an_error_of_a_loser_is_lost() {
    check(
        RACE,
        "start; A ok y=1; B raises \"late\"",
        &expect![[r#"
        > start
        enter ROOT
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > A ok y=1
        leave ROOT/A ok y=1
          end 1
          preempt ROOT/B
        > B raises "late"
        leave ROOT/B aborted y=None error="late"
        leave ROOT one z=1
        finished
          end 2
          end of run: one (0) z=1, 3 states
    "#]],
    );
}

#[test]
fn an_unconnected_outcome_of_the_winner_waits_until_it_is_stopped() {
    check(
        RACE,
        "start; A lost y=1; B ok y=2; stop",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > A lost y=1
        leave ROOT/A lost y=1
          end 1
          preempt ROOT/B
        > B ok y=2
        leave ROOT/B preempted y=2
        wait ROOT: no transition from ROOT/A lost
          end 2
        > stop
        stopping
        leave ROOT preempted z=1
        finished
          preempt ROOT
          end of run: preempted (-2) z=1, 3 states
    "]],
    );
}

#[test]
fn a_race_without_children_waits_until_it_is_stopped() {
    check(
        "preemptive ROOT\n  outcome one",
        "start; active; stop",
        &expect![[r"
        > start
        enter ROOT
        wait ROOT: no children
        > active
        ROOT Waiting(NoChildren)
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
fn a_winner_without_a_script_preempts_those_that_begin_after_it() {
    check(
        "
preemptive ROOT
  outcome one
  A.ok -> .one
  hierarchy A
    outcome ok
    start -> .ok
  execution B
    outcome ok
  hierarchy C
    outcome ok
    start -> D
    execution D
  barrier E
    execution F
    decider unique_decider_state_id
  library G from \"x\"
    content
      hierarchy R
        start -> S
        execution S
",
        "start; B ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
            leave ROOT/A ok
            enter ROOT/B
            enter ROOT/C
            leave ROOT/C preempted
            enter ROOT/E
            leave ROOT/E preempted
            enter ROOT/G
            enter ROOT/G/R
            leave ROOT/G/R preempted
            leave ROOT/G preempted
              fork 1
              end 1
              fork 2
              run ROOT/B on 2 preempted
              fork 3
              end 3
              fork 4
              end 4
              fork 5
              end 5
            > B ok
            leave ROOT/B preempted
            leave ROOT one
            finished
              end 2
              end of run: one (0), 6 states
        "]],
    );
}

#[test]
fn preemption_reaches_through_barriers_and_libraries() {
    check(
        "
preemptive ROOT
  outcome one
  A.ok -> .one
  execution A
    outcome ok
  barrier B
    library L from \"x/y\"
      content
        hierarchy R
          outcome ok
          start -> C
          execution C
            outcome ok
    execution D
      outcome ok
    decider unique_decider_state_id
      outcome ok
",
        "start; A ok; D ok; C ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
            enter ROOT/B
            enter ROOT/B/D
            enter ROOT/B/L
            enter ROOT/B/L/R
            enter ROOT/B/L/R/C
              fork 1
              run ROOT/A on 1
              fork 2
              fork 3
              run ROOT/B/D on 3
              fork 4
              run ROOT/B/L/R/C on 4
            > A ok
            leave ROOT/A ok
              end 1
              preempt ROOT/B
              preempt ROOT/B/D
              preempt ROOT/B/L
              preempt ROOT/B/L/R
              preempt ROOT/B/L/R/C
            > D ok
            leave ROOT/B/D preempted
              end 3
            > C ok
            leave ROOT/B/L/R/C preempted
            leave ROOT/B/L/R preempted
            leave ROOT/B/L preempted
            leave ROOT/B preempted
            leave ROOT one
            finished
              end 4
              end 2
              end of run: one (0), 6 states
        "]],
    );
}

const HANDLER: &str = "
hierarchy ROOT
  outcome done
  start -> A
  A.ok -> .done ; A.preempted -> H ; H.ok -> B ; H.preempted -> I
  execution A
    outcome ok
  execution B
    outcome ok
  execution H
    outcome ok
  execution I
    outcome ok
";

#[test]
fn one_handler_runs_after_preemption() {
    check(
        HANDLER,
        "start; stop; A ok; active; H ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > stop
        stopping
          preempt ROOT
          preempt ROOT/A
        > A ok
        leave ROOT/A preempted
        enter ROOT/H
          run ROOT/H
        > active
        ROOT Inside preempted
        ROOT/H Script
        Stopping, 3 states run
        > H ok
        leave ROOT/H ok
        leave ROOT preempted
        finished
          end of run: preempted (-2), 3 states
    "]],
    );
}

#[test]
fn a_handler_may_leave_to_another_handler() {
    check(
        HANDLER,
        "start; stop; A ok; H preempted; I ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > stop
        stopping
          preempt ROOT
          preempt ROOT/A
        > A ok
        leave ROOT/A preempted
        enter ROOT/H
          run ROOT/H
        > H preempted
        leave ROOT/H preempted
        enter ROOT/I
          run ROOT/I
        > I ok
        leave ROOT/I ok
        leave ROOT preempted
        finished
          end of run: preempted (-2), 4 states
    "]],
    );
}

#[test]
fn a_second_stop_preempts_the_handler_and_runs_no_other() {
    check(
        HANDLER,
        "start; stop; A ok; stop; H ok; I ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > stop
            stopping
              preempt ROOT
              preempt ROOT/A
            > A ok
            leave ROOT/A preempted
            enter ROOT/H
              run ROOT/H
            > stop
            stopping
              preempt ROOT/H
            > H ok
            leave ROOT/H preempted
            leave ROOT preempted
            finished
              end of run: preempted (-2), 3 states
            > I ok
            refused: frame 77.0 runs no script; a result is given once, with the frame of its job
        "]],
    );
}

#[test]
fn a_handler_that_leads_out_still_ends_preempted() {
    check(
        &HANDLER.replace("H.ok -> B", "H.ok -> .done"),
        "start; stop; A ok; H ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > stop
            stopping
              preempt ROOT
              preempt ROOT/A
            > A ok
            leave ROOT/A preempted
            enter ROOT/H
              run ROOT/H
            > H ok
            leave ROOT/H ok
            leave ROOT preempted
            finished
              end of run: preempted (-2), 3 states
        "]],
    );
}

#[test]
fn an_outcome_preempted_is_followed_without_preemption() {
    check(
        HANDLER,
        "start; A preempted; H ok; B ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > A preempted
        leave ROOT/A preempted
        enter ROOT/H
          run ROOT/H
        > H ok
        leave ROOT/H ok
        enter ROOT/B
          run ROOT/B
        > B ok
        leave ROOT/B ok
        wait ROOT: no transition from ROOT/B ok
    "]],
    );
}

#[test]
fn an_abort_while_preempted_runs_no_handler() {
    check(
        &HANDLER.replace("A.ok ->", "A.aborted -> B ; A.ok ->"),
        "start; stop; A raises \"boom\"",
        &expect![[r#"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > stop
            stopping
              preempt ROOT
              preempt ROOT/A
            > A raises "boom"
            leave ROOT/A aborted error="boom"
            leave ROOT preempted error="boom"
            finished
              end of run: preempted (-2) error="boom", 2 states
        "#]],
    );
}

#[test]
fn a_handler_may_be_a_hierarchy() {
    check(
        "
hierarchy ROOT
  outcome done
  start -> A
  A.preempted -> H
  execution A
  hierarchy H
    outcome ok
    start -> B ; B.ok -> C ; C.ok -> .ok
    execution B
      outcome ok
    execution C
      outcome ok
",
        "start; stop; A 0; B ok; C ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > stop
            stopping
              preempt ROOT
              preempt ROOT/A
            > A 0
            leave ROOT/A preempted
            enter ROOT/H
            enter ROOT/H/B
              run ROOT/H/B
            > B ok
            leave ROOT/H/B ok
            enter ROOT/H/C
              run ROOT/H/C
            > C ok
            leave ROOT/H/C ok
            leave ROOT/H ok
            leave ROOT preempted
            finished
              end of run: preempted (-2), 5 states
        "]],
    );
}

#[test]
fn what_waits_ends_when_it_is_preempted() {
    check(
        "
preemptive ROOT
  outcome one
  A.ok -> .one
  execution A
    outcome ok
  hierarchy B
    outcome ok
    start -> C
    execution C
      outcome ok
  hierarchy D
    outcome ok
",
        "start; C ok; A ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
            enter ROOT/B
            enter ROOT/B/C
            enter ROOT/D
            wait ROOT/D: no start
              fork 1
              run ROOT/A on 1
              fork 2
              run ROOT/B/C on 2
              fork 3
            > C ok
            leave ROOT/B/C ok
            wait ROOT/B: no transition from ROOT/B/C ok
            > A ok
            leave ROOT/A ok
            leave ROOT/B preempted
            leave ROOT/D preempted
            leave ROOT one
            finished
              end 1
              preempt ROOT/B
              preempt ROOT/D
              end 2
              end 3
              end of run: one (0), 5 states
        "]],
    );
}

#[test]
fn what_is_held_ends_when_it_is_preempted() {
    check(
        "
preemptive ROOT
  outcome one
  A.ok -> .one
  execution A
    outcome ok
  hierarchy B
    outcome ok
    start -> C ; C.ok -> D
    execution C
      outcome ok
    execution D
",
        "start; pause; C ok; A ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
            enter ROOT/B
            enter ROOT/B/C
              fork 1
              run ROOT/A on 1
              fork 2
              run ROOT/B/C on 2
            > pause
            paused
              paused true
            > C ok
            leave ROOT/B/C ok
            hold ROOT/B before ROOT/B/D (Pause)
            > A ok
            leave ROOT/A ok
            leave ROOT/B preempted
            leave ROOT one
            finished
              end 1
              preempt ROOT/B
              end 2
              end of run: one (0), 4 states
        "]],
    );
}

#[test]
fn a_held_handler_waits_for_the_end_of_the_pause() {
    check(
        "
preemptive ROOT
  outcome one
  A.ok -> .one
  execution A
    outcome ok
  hierarchy B
    start -> C ; C.preempted -> D
    execution C
    execution D
      outcome ok
",
        "start; pause; A ok; C 0; active; resume; D ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
            enter ROOT/B
            enter ROOT/B/C
              fork 1
              run ROOT/A on 1
              fork 2
              run ROOT/B/C on 2
            > pause
            paused
              paused true
            > A ok
            leave ROOT/A ok
              end 1
              preempt ROOT/B
              preempt ROOT/B/C
            > C 0
            leave ROOT/B/C preempted
            hold ROOT/B before ROOT/B/D (Pause)
            > active
            ROOT Inside
            ROOT/B Held preempted (Pause before ROOT/B/D)
            Paused, 4 states run
            > resume
            goes on
            enter ROOT/B/D
              paused false
              run ROOT/B/D on 2
            > D ok
            leave ROOT/B/D ok
            leave ROOT/B preempted
            leave ROOT one
            finished
              end 2
              end of run: one (0), 5 states
        "]],
    );
}

#[test]
fn a_handler_that_is_held_and_asked_for_twice_is_held_once() {
    let machine = "
preemptive ROOT
  outcome done
  A.done -> .done ; B.done -> .done
  hierarchy A
    outcome done
    start -> X
    execution X
      outcome done
  hierarchy B
    outcome done
    start -> Y ; Y.done -> .done ; Y.preempted -> C ; C.done -> .done
    execution C
      outcome done
    execution Y
      outcome done
";
    check(
        machine,
        "start; step; preempt ROOT/B; X done; Y done; preempt ROOT; resume; C done",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
            enter ROOT/A/X
            enter ROOT/B
            enter ROOT/B/Y
              fork 1
              run ROOT/A/X on 1
              fork 2
              run ROOT/B/Y on 2
            > step
            > preempt ROOT/B
              preempt ROOT/B
              preempt ROOT/B/Y
            > X done
            leave ROOT/A/X done
            wait ROOT/A: no transition from ROOT/A/X done
            > Y done
            leave ROOT/B/Y preempted
            hold ROOT/B before ROOT/B/C (Step)
            > preempt ROOT
            leave ROOT/A preempted
            hold ROOT/B before ROOT/B/C (Step)
              preempt ROOT
              preempt ROOT/A
              end 1
            > resume
            enter ROOT/B/C
              run ROOT/B/C on 2
            > C done
            leave ROOT/B/C done
            leave ROOT/B preempted
            leave ROOT preempted
            finished
              end 2
              end of run: preempted (-2), 6 states
        "]],
    );
}
