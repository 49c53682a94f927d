//! Propagation of errors through the machine.

use super::check;
use expect_test::expect;

const RECOVERY: &str = "
hierarchy ROOT
  outcome done
  start -> A
  A.ok -> .done ; A.aborted -> B ; B.ok -> C ; C.ok -> .done
  execution A
    outcome ok
  execution B
    outcome ok
  execution C
    outcome ok
";

#[test]
fn an_error_reaches_the_next_state_only() {
    check(
        RECOVERY,
        "start; A raises \"boom\"; B ok; C ok",
        &expect![[r#"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > A raises "boom"
        leave ROOT/A aborted error="boom"
        enter ROOT/B
          run ROOT/B error="boom"
        > B ok
        leave ROOT/B ok
        enter ROOT/C
          run ROOT/C
        > C ok
        leave ROOT/C ok
        leave ROOT done
        finished
          end of run: done (0), 4 states
    "#]],
    );
}

#[test]
fn a_script_may_name_its_own_error() {
    check(
        RECOVERY,
        "start; A aborted error=\"mine\"",
        &expect![[r#"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > A aborted error="mine"
        leave ROOT/A aborted error="mine"
        enter ROOT/B
          run ROOT/B error="mine"
    "#]],
    );
}

#[test]
fn an_abort_without_an_error_hands_none_on() {
    check(
        RECOVERY,
        "start; A aborted",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > A aborted
        leave ROOT/A aborted
        enter ROOT/B
          run ROOT/B
    "]],
    );
}

#[test]
fn an_error_beside_another_outcome_goes_nowhere() {
    check(
        RECOVERY.replace("A.ok -> .done", "A.ok -> B").as_str(),
        "start; A ok error=\"mine\"",
        &expect![[r#"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > A ok error="mine"
            leave ROOT/A ok error="mine"
            enter ROOT/B
              run ROOT/B
        "#]],
    );
}

#[test]
fn an_unconnected_abort_climbs_with_its_error() {
    check(
        "
hierarchy ROOT
  outcome done
  start -> H
  H.ok -> .done ; H.aborted -> R ; R.ok -> .done
  hierarchy H
    outcome ok
    start -> A
    execution A
      outcome ok
  execution R
    outcome ok
",
        "start; A raises \"boom\"; R ok",
        &expect![[r#"
            > start
            enter ROOT
            enter ROOT/H
            enter ROOT/H/A
              run ROOT/H/A
            > A raises "boom"
            leave ROOT/H/A aborted error="boom"
            leave ROOT/H aborted error="boom"
            enter ROOT/R
              run ROOT/R error="boom"
            > R ok
            leave ROOT/R ok
            leave ROOT done
            finished
              end of run: done (0), 4 states
        "#]],
    );
}

#[test]
fn an_abort_that_leads_out_leaves_with_its_error() {
    check(
        "
hierarchy ROOT
  outcome done
  start -> A
  A.aborted -> .done
  execution A
",
        "start; A raises \"boom\"",
        &expect![[r#"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > A raises "boom"
            leave ROOT/A aborted error="boom"
            leave ROOT done error="boom"
            finished
              end of run: done (0) error="boom", 2 states
        "#]],
    );
}

#[test]
fn an_unconnected_preempted_climbs() {
    check(
        "
hierarchy ROOT
  outcome done
  start -> H
  H.preempted -> .done
  hierarchy H
    start -> A
    execution A
",
        "start; A preempted",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/H
            enter ROOT/H/A
              run ROOT/H/A
            > A preempted
            leave ROOT/H/A preempted
            leave ROOT/H preempted
            leave ROOT done
            finished
              end of run: done (0), 3 states
        "]],
    );
}

#[test]
fn an_error_enters_a_container_through_its_port() {
    check(
        "
hierarchy ROOT
  start -> A
  A.aborted -> H
  execution A
  hierarchy H
    in error: object
    start -> B
    flow .error -> B.what
    execution B
      in what: object
",
        "start; A raises \"boom\"",
        &expect![[r#"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > A raises "boom"
            leave ROOT/A aborted error="boom"
            enter ROOT/H error="boom"
            enter ROOT/H/B what="boom"
              run ROOT/H/B
        "#]],
    );
}

#[test]
fn without_a_port_an_error_ends_at_a_container() {
    check(
        "
hierarchy ROOT
  start -> A
  A.aborted -> H
  execution A
  hierarchy H
    start -> B
    execution B
",
        "start; A raises \"boom\"",
        &expect![[r#"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > A raises "boom"
            leave ROOT/A aborted error="boom"
            enter ROOT/H
            enter ROOT/H/B
              run ROOT/H/B
        "#]],
    );
}
