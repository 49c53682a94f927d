//! Mapping from a script's result to an outcome.

use super::check;
use expect_test::expect;

const LEAF: &str = "
execution ROOT
  outcome ok
  outcome 7 \"went well\"
  out y: int = 1
";

#[test]
fn an_outcome_by_id() {
    check(
        LEAF,
        "start; ROOT 7",
        &expect![[r"
        > start
        enter ROOT
          run ROOT
        > ROOT 7
        leave ROOT went well y=1
        finished
          end of run: went well (7) y=1, 1 states
    "]],
    );
}

#[test]
fn an_outcome_by_name() {
    check(
        LEAF,
        "start; ROOT ok y=2",
        &expect![[r"
        > start
        enter ROOT
          run ROOT
        > ROOT ok y=2
        leave ROOT ok y=2
        finished
          end of run: ok (0) y=2, 1 states
    "]],
    );
}

#[test]
fn mandatory_outcomes_may_be_returned() {
    check(
        LEAF,
        "start; ROOT aborted",
        &expect![[r"
        > start
        enter ROOT
          run ROOT
        > ROOT aborted
        leave ROOT aborted y=1
        finished
          end of run: aborted (-1) y=1, 1 states
    "]],
    );
    check(
        LEAF,
        "start; ROOT -2",
        &expect![[r"
        > start
        enter ROOT
          run ROOT
        > ROOT -2
        leave ROOT preempted y=1
        finished
          end of run: preempted (-2) y=1, 1 states
    "]],
    );
}

#[test]
fn an_unknown_outcome_aborts_without_an_error() {
    check(
        LEAF,
        "start; ROOT nonsense",
        &expect![[r"
            > start
            enter ROOT
              run ROOT
            > ROOT nonsense
            error ROOT: 'nonsense' is no outcome
            leave ROOT aborted y=1
            finished
              end of run: aborted (-1) y=1, 1 states
        "]],
    );
    check(
        LEAF,
        "start; ROOT 5",
        &expect![[r"
            > start
            enter ROOT
              run ROOT
            > ROOT 5
            error ROOT: 5 is no outcome
            leave ROOT aborted y=1
            finished
              end of run: aborted (-1) y=1, 1 states
        "]],
    );
    check(
        LEAF,
        "start; ROOT other \"None\"",
        &expect![[r#"
            > start
            enter ROOT
              run ROOT
            > ROOT other "None"
            error ROOT: None is no outcome
            leave ROOT aborted y=1
            finished
              end of run: aborted (-1) y=1, 1 states
        "#]],
    );
}

#[test]
fn an_exception_aborts_with_itself_as_error() {
    check(
        LEAF,
        "start; ROOT raises \"boom\"",
        &expect![[r#"
        > start
        enter ROOT
          run ROOT
        > ROOT raises "boom"
        leave ROOT aborted y=1 error="boom"
        finished
          end of run: aborted (-1) y=1 error="boom", 1 states
    "#]],
    );
}

#[test]
fn preempted_goes_before_what_the_script_returned() {
    check(
        LEAF,
        "start; stop; ROOT ok y=5",
        &expect![[r"
        > start
        enter ROOT
          run ROOT
        > stop
        stopping
          preempt ROOT
        > ROOT ok y=5
        leave ROOT preempted y=5
        finished
          end of run: preempted (-2) y=5, 1 states
    "]],
    );
}

#[test]
fn an_exception_goes_before_preempted() {
    check(
        LEAF,
        "start; stop; ROOT raises \"boom\"",
        &expect![[r#"
        > start
        enter ROOT
          run ROOT
        > stop
        stopping
          preempt ROOT
        > ROOT raises "boom"
        leave ROOT aborted y=1 error="boom"
        finished
          end of run: aborted (-1) y=1 error="boom", 1 states
    "#]],
    );
}
