//! Library states.

use super::check;
use expect_test::expect;

const LIBRARY: &str = "
define ASK
  execution R \"Ask\"
    outcome ok
    in question: str = \"?\"
    out answer: str = \"!\"
hierarchy ROOT
  outcome done
  start -> L
  L.ok -> M ; M.ok -> .done ; M.aborted -> .done
  flow L.answer -> M.question
  library L from \"generic/ask\"
    set in question = \"which way\"
    set out answer = \"left\"
    content ASK
  library M from \"generic/ask\"
    set in question = \"never\" unused
    content ASK
";

#[test]
fn a_library_is_a_state_around_its_root() {
    check(
        LIBRARY,
        "start; L/R ok; M/R ok answer=\"b\"",
        &expect![[r#"
        > start
        enter ROOT
        enter ROOT/L question="which way"
        enter ROOT/L/R question="which way"
          run ROOT/L/R
        > L/R ok
        leave ROOT/L/R ok answer="left"
        leave ROOT/L ok answer="left"
        enter ROOT/M question="left"
        enter ROOT/M/R question="left"
          run ROOT/M/R
        > M/R ok answer="b"
        leave ROOT/M/R ok answer="b"
        leave ROOT/M ok answer="b"
        leave ROOT done
        finished
          end of run: done (0), 3 states
    "#]],
    );
}

#[test]
fn runtime_values_go_before_defaults_and_flows_before_both() {
    check(
        LIBRARY,
        "start; L/R ok answer=\"from-L\"",
        &expect![[r#"
        > start
        enter ROOT
        enter ROOT/L question="which way"
        enter ROOT/L/R question="which way"
          run ROOT/L/R
        > L/R ok answer="from-L"
        leave ROOT/L/R ok answer="from-L"
        leave ROOT/L ok answer="from-L"
        enter ROOT/M question="from-L"
        enter ROOT/M/R question="from-L"
          run ROOT/M/R
    "#]],
    );
    let unconnected = LIBRARY.replace("flow L.answer -> M.question", "");
    check(
        &unconnected,
        "start; L/R ok",
        &expect![[r#"
        > start
        enter ROOT
        enter ROOT/L question="which way"
        enter ROOT/L/R question="which way"
          run ROOT/L/R
        > L/R ok
        leave ROOT/L/R ok answer="left"
        leave ROOT/L ok answer="left"
        enter ROOT/M question="?"
        enter ROOT/M/R question="?"
          run ROOT/M/R
    "#]],
    );
}

#[test]
fn a_library_ends_as_its_root_does_with_its_error() {
    check(
        LIBRARY,
        "start; L/R ok; M/R raises \"boom\"",
        &expect![[r#"
        > start
        enter ROOT
        enter ROOT/L question="which way"
        enter ROOT/L/R question="which way"
          run ROOT/L/R
        > L/R ok
        leave ROOT/L/R ok answer="left"
        leave ROOT/L ok answer="left"
        enter ROOT/M question="left"
        enter ROOT/M/R question="left"
          run ROOT/M/R
        > M/R raises "boom"
        leave ROOT/M/R aborted answer="!" error="boom"
        leave ROOT/M aborted answer="!" error="boom"
        leave ROOT done error="boom"
        finished
          end of run: done (0) error="boom", 3 states
    "#]],
    );
}

#[test]
fn an_error_reaches_the_script_of_a_library() {
    check(
        &LIBRARY.replace("L.ok -> M", "L.aborted -> M"),
        "start; L/R raises \"boom\"",
        &expect![[r#"
            > start
            enter ROOT
            enter ROOT/L question="which way"
            enter ROOT/L/R question="which way"
              run ROOT/L/R
            > L/R raises "boom"
            leave ROOT/L/R aborted answer="left" error="boom"
            leave ROOT/L aborted answer="left" error="boom"
            enter ROOT/M question="left"
            enter ROOT/M/R question="left"
              run ROOT/M/R error="boom"
        "#]],
    );
}

#[test]
fn a_missing_library_aborts_with_the_reason_as_error() {
    check(
        "
hierarchy ROOT
  outcome done
  start -> L
  L.aborted -> A
  A.ok -> .done
  library L from \"generic/gone\"
    outcome ok
    in x: int
    set in x = 3
    missing \"there is no folder generic/gone\"
  execution A
    outcome ok
",
        "start; A ok",
        &expect![[r#"
            > start
            enter ROOT
            enter ROOT/L x=3
            error ROOT/L: missing library: there is no folder generic/gone
            leave ROOT/L aborted error="there is no folder generic/gone"
            enter ROOT/A
              run ROOT/A error="there is no folder generic/gone"
            > A ok
            leave ROOT/A ok
            leave ROOT done
            finished
              end of run: done (0), 2 states
        "#]],
    );
}

#[test]
fn libraries_nest() {
    check(
        "
define INNER
  execution I
    outcome ok
    in x: int = 1
    out y: int = 2
define OUTER
  library R from \"inner\"
    set in x = 5
    content INNER
library ROOT from \"outer\"
  content OUTER
",
        "start; I ok y=7",
        &expect![[r"
            > start
            enter ROOT x=1
            enter ROOT/R x=1
            enter ROOT/R/I x=1
              run ROOT/R/I
            > I ok y=7
            leave ROOT/R/I ok y=7
            leave ROOT/R ok y=7
            leave ROOT ok y=7
            finished
              end of run: ok (0) y=7, 1 states
        "]],
    );
}

#[test]
fn ports_that_differ_from_those_of_the_library_are_matched_by_id() {
    check(
        "
library ROOT from \"x\"
  interface
  outcome ok
  in 1 b: int = 11
  out 3 d: int = 13
  content
    execution R
      outcome ok
      in 0 a: int = 1
      in 1 b: int = 2
      out 2 c: int = 3
      out 3 d: int = 4
",
        "start; R ok",
        &expect![[r"
            > start
            enter ROOT b=11
            enter ROOT/R a=1 b=11
              run ROOT/R
            > R ok
            leave ROOT/R ok c=3 d=13
            leave ROOT ok d=13
            finished
              end of run: ok (0) d=13, 1 states
        "]],
    );
}
