//! Changes of the machine during a run.

use super::check_change;
use expect_test::expect;

const BEFORE: &str = "
hierarchy ROOT
  outcome done
  var v: int = 1
  start -> A ; A.done -> B ; B.done -> .done
  flow A.y -> B.x
  execution A
    outcome done
    out y: int = 0
  execution B
    outcome done
    in x: int = 0
";

#[test]
fn what_is_not_active_is_free() {
    let after = "
hierarchy ROOT
  outcome done
  var v: int = 1
  var w: int = 2
  start -> A ; A.done -> N ; N.done -> .done
  flow A.y -> N.x ; .w -> N.w
  execution A
    outcome done
    out y: int = 0
  execution N
    outcome done
    in x: int = 0
    in w: int = 0
";
    check_change(
        BEFORE,
        after,
        "start; change; A done y=3; N done",
        &expect![[r"
        > start
        enter ROOT
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > change
        changed
        set ROOT.w = 2
        > A done y=3
        leave ROOT/A done y=3
        enter ROOT/N x=3 w=2
          run ROOT/N
        > N done
        leave ROOT/N done
        leave ROOT done
        finished
          end of run: done (0) variables: v=1 w=2, 3 states
    "]],
    );
}

#[test]
fn a_container_without_data_gets_its_first() {
    let machine = |lines: &str| {
        format!(
            "
hierarchy ROOT
  outcome done
  {lines}
  start -> A ; A.done -> B ; B.done -> .done
  execution A
    outcome done
    out y: int = 0
  execution B
    outcome done
    in x: int = 0
"
        )
    };
    check_change(
        &machine(""),
        &machine("var v: int = 7\n  flow A.y -> B.x"),
        "start; change; A done y=3; B done",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > change
            changed
            set ROOT.v = 7
            > A done y=3
            leave ROOT/A done y=3
            enter ROOT/B x=3
              run ROOT/B
            > B done
            leave ROOT/B done
            leave ROOT done
            finished
              end of run: done (0) variables: v=7, 3 states
        "]],
    );
}

const WITH_MORE_DATA: &str = "
hierarchy ROOT
  outcome done
  var v: int = 1
  var u: int = 5
  start -> A ; A.done -> B ; B.done -> C ; C.done -> .done
  flow A.z -> C.x ; A.y -> B.x
  execution A
    outcome done
    out y: int = 0
    out z: int = 9
  execution B
    outcome done
    in x: int = 0
  execution C
    outcome done
    in x: int = 0
";

#[test]
fn values_stay_where_their_names_do() {
    check_change(
        BEFORE,
        WITH_MORE_DATA,
        "start; A done y=3; change; B done; C done",
        &expect![[r"
        > start
        enter ROOT
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > A done y=3
        leave ROOT/A done y=3
        enter ROOT/B x=3
          run ROOT/B
        > change
        changed
        set ROOT.u = 5
        > B done
        leave ROOT/B done
        enter ROOT/C x=0
          run ROOT/C
        > C done
        leave ROOT/C done
        leave ROOT done
        finished
          end of run: done (0) variables: v=1 u=5, 4 states
    "]],
    );
}

#[test]
fn values_stay_also_while_their_hierarchy_is_held() {
    check_change(
        BEFORE,
        WITH_MORE_DATA,
        "start; pause; A done y=3; change; resume; B done",
        &expect![[r"
        > start
        enter ROOT
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > pause
        paused
          paused true
        > A done y=3
        leave ROOT/A done y=3
        hold ROOT before ROOT/B (Pause)
        > change
        changed
        set ROOT.u = 5
        > resume
        goes on
        enter ROOT/B x=3
          paused false
          run ROOT/B
        > B done
        leave ROOT/B done
        enter ROOT/C x=0
          run ROOT/C
    "]],
    );
}

const WITHOUT_A: &str = "
hierarchy ROOT
  outcome done
  start -> B ; B.done -> .done
  execution B
    outcome done
    in x: int = 0
";

#[test]
fn a_change_that_touches_what_is_active_is_refused() {
    check_change(
        BEFORE,
        WITHOUT_A,
        "start; change; active; A done",
        &expect![[r"
        > start
        enter ROOT
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > change
        refused: cannot change the machine now: 'ROOT/A' is active and would be gone; let the change wait until the state has ended, or stop the run
        > active
        ROOT Inside
        ROOT/A Script
        Running, 2 states run
        > A done
        leave ROOT/A done y=0
        enter ROOT/B x=0
          run ROOT/B
    "]],
    );
    check_change(
        BEFORE,
        WITHOUT_A,
        "start; pause; A done; change",
        &expect![[r"
        > start
        enter ROOT
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > pause
        paused
          paused true
        > A done
        leave ROOT/A done y=0
        hold ROOT before ROOT/B (Pause)
        > change
        refused: cannot change the machine now: 'ROOT/A' has just ended and would be gone, or its outcome would; let the change wait until the state has ended, or stop the run
    "]],
    );
}

#[test]
fn a_change_may_wait_until_nothing_stands_in_its_way() {
    check_change(
        BEFORE,
        WITHOUT_A,
        "start; change or wait; A done y=3; active; B done",
        &expect![[r"
        > start
        enter ROOT
        set ROOT.v = 1
        enter ROOT/A
          run ROOT/A
        > change or wait
        change waits for ROOT/A
        > A done y=3
        leave ROOT/A done y=3
        enter ROOT/B x=3
        changed
          run ROOT/B
        > active
        ROOT Inside
        ROOT/B Script
        Running, 3 states run
        > B done
        leave ROOT/B done
        leave ROOT done
        finished
          end of run: done (0), 3 states
    "]],
    );
}

#[test]
fn a_change_is_taken_between_two_runs_of_one_state() {
    let before = "
hierarchy ROOT
  outcome done
  start -> A ; A.again -> A ; A.done -> .done
  execution A
    outcome done
    outcome again
";
    let after = "
hierarchy ROOT
  outcome done
  start -> A ; A.again -> A ; A.done -> .done ; A.third -> .done
  execution A
    outcome done
    outcome again
    outcome third
    in n: int = 4
";
    check_change(
        before,
        after,
        "start; change or wait; A again; A third",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > change or wait
        change waits for ROOT/A
        > A again
        leave ROOT/A again
        changed
        enter ROOT/A n=4
          run ROOT/A
        > A third
        leave ROOT/A third
        leave ROOT done
        finished
          end of run: done (0), 3 states
    "]],
    );
}

#[test]
fn a_hierarchy_that_waits_goes_on_when_its_transition_appears() {
    let waits = "
hierarchy ROOT
  outcome done
  execution A
    outcome done
  start -> A
";
    let goes = "
hierarchy ROOT
  outcome done
  execution A
    outcome done
  start -> A ; A.done -> .done
";
    check_change(
        waits,
        goes,
        "start; A done; change",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > A done
        leave ROOT/A done
        wait ROOT: no transition from ROOT/A done
        > change
        changed
        leave ROOT done
        finished
          end of run: done (0), 2 states
    "]],
    );
    check_change(
        "hierarchy ROOT\n  outcome done\n",
        goes,
        "start; change; A done",
        &expect![[r"
        > start
        enter ROOT
        wait ROOT: no start
        > change
        changed
        enter ROOT/A
          run ROOT/A
        > A done
        leave ROOT/A done
        leave ROOT done
        finished
          end of run: done (0), 2 states
    "]],
    );
}

const RACE: &str = "
preemptive ROOT
  outcome done
  A.done -> .done ; B.done -> .done
  execution A
    outcome done
  execution B
    outcome done
";

#[test]
fn the_branches_of_an_active_concurrency_state_stay() {
    let more = "
preemptive ROOT
  outcome done
  A.done -> .done ; B.done -> .done ; C.done -> .done
  execution A
    outcome done
  execution B
    outcome done
  execution C
    outcome done
";
    check_change(
        RACE,
        more,
        "start; change; A done; B done",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
        enter ROOT/B
          fork 1
          run ROOT/A on 1
          fork 2
          run ROOT/B on 2
        > change
        refused: cannot change the machine now: 'ROOT' is active and would have other branches; let the change wait until the state has ended, or stop the run
        > A done
        leave ROOT/A done
          end 1
          preempt ROOT/B
        > B done
        leave ROOT/B preempted
        leave ROOT done
        finished
          end 2
          end of run: done (0), 3 states
    "]],
    );
}

#[test]
fn what_is_active_inside_a_library_goes_on() {
    let library = |inside: &str| {
        format!(
            "
hierarchy ROOT
  outcome done
  start -> L ; L.done -> L
  library L from \"some/library\"
    content
      hierarchy H
        outcome done
        start -> Z ; Z.done -> .done
{inside}        execution Z
          outcome done
"
        )
    };
    let more = library("        execution Y\n          outcome done\n");
    check_change(
        &library(""),
        &more,
        "start; change; Z done; active",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/L
        enter ROOT/L/H
        enter ROOT/L/H/Z
          run ROOT/L/H/Z
        > change
        changed
        > Z done
        leave ROOT/L/H/Z done
        leave ROOT/L/H done
        leave ROOT/L done
        enter ROOT/L
        enter ROOT/L/H
        enter ROOT/L/H/Z
          run ROOT/L/H/Z
        > active
        ROOT Inside
        ROOT/L Inside
        ROOT/L/H Inside
        ROOT/L/H/Z Script
        Running, 5 states run
    "]],
    );
}

#[test]
fn a_decider_begins_once_when_a_change_ends_the_last_branch_beside_one_that_just_ended() {
    let before = "
barrier ROOT
  outcome done
  unique_decider_state_id.ok -> .done
  hierarchy A
    outcome ok
    start -> X ; X.ok -> .ok
    execution X
      outcome ok
  hierarchy W
    outcome ok
  decider unique_decider_state_id
    outcome ok
";
    let after = "
barrier ROOT
  outcome done
  unique_decider_state_id.ok -> .done
  hierarchy A
    outcome ok
    start -> .ok
  hierarchy W
    outcome ok
    start -> .ok
  decider unique_decider_state_id
    outcome ok
";
    check_change(
        before,
        after,
        "start; change or wait; X ok; unique_decider_state_id ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
        enter ROOT/A/X
        enter ROOT/W
        wait ROOT/W: no start
          fork 1
          run ROOT/A/X on 1
          fork 2
        > change or wait
        change waits for ROOT/A/X
        > X ok
        leave ROOT/A/X ok
        leave ROOT/A ok
        changed
        leave ROOT/W ok
        enter ROOT/unique_decider_state_id
          end 1
          end 2
          run ROOT/unique_decider_state_id [A ok] [W ok]
        > unique_decider_state_id ok
        leave ROOT/unique_decider_state_id ok
        leave ROOT done
        finished
          end of run: done (0), 5 states
    "]],
    );
}

#[test]
fn what_an_ended_child_of_a_barrier_gave_flows_along_a_new_flow() {
    let before = "
barrier ROOT
  outcome done
  out y: int = 1
  out z: int = 1
  execution A
    outcome ok
    out y: int = 2
  decider unique_decider_state_id
    outcome ok
    outcome lost
    out y: int = 2
  unique_decider_state_id.ok -> .done
";
    let after = "
barrier ROOT
  outcome done
  out y: int = 1
  out z: int = 1
  flow A.y -> .y ; unique_decider_state_id.y -> .z
  execution A
    outcome ok
    out y: int = 2
  decider unique_decider_state_id
    outcome ok
    outcome lost
    out y: int = 2
  unique_decider_state_id.ok -> .done
  unique_decider_state_id.lost -> .done
";
    check_change(
        before,
        after,
        "start; A ok y=7; unique_decider_state_id lost y=8; change",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
              fork 1
              run ROOT/A on 1
            > A ok y=7
            leave ROOT/A ok y=7
            enter ROOT/unique_decider_state_id
              end 1
              run ROOT/unique_decider_state_id [A ok]
            > unique_decider_state_id lost y=8
            leave ROOT/unique_decider_state_id lost y=8
            wait ROOT: no transition from ROOT/unique_decider_state_id lost
            > change
            changed
            leave ROOT done y=7 z=8
            finished
              end of run: done (0) y=7 z=8, 3 states
        "]],
    );
}
