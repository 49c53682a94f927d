//! Scoped variables.

use super::check;
use expect_test::expect;

const SCOPED: &str = "
hierarchy ROOT
  outcome done
  in a: int = 7
  var v: int = 5
  out z: int
  start -> A
  A.ok -> .done
  flow .v -> A.x ; A.y -> .v ; .v -> .z
  execution A
    outcome ok
    in x: int = 9
    out y: int
";

#[test]
fn scoped_variables_begin_with_their_default_and_keep_what_is_put_in() {
    check(
        SCOPED,
        "start; A ok y=6",
        &expect![[r"
        > start
        enter ROOT a=7
        set ROOT.v = 5
        enter ROOT/A x=5
          run ROOT/A
        > A ok y=6
        leave ROOT/A ok y=6
        set ROOT.v = 6
        leave ROOT done z=6
        finished
          end of run: done (0) z=6 variables: v=6, 2 states
    "]],
    );
}

#[test]
fn none_overrides_a_scoped_variable() {
    check(
        SCOPED,
        "start; A ok y=None",
        &expect![[r"
        > start
        enter ROOT a=7
        set ROOT.v = 5
        enter ROOT/A x=5
          run ROOT/A
        > A ok y=None
        leave ROOT/A ok y=None
        set ROOT.v = None
        leave ROOT done z=None
        finished
          end of run: done (0) z=None variables: v=None, 2 states
    "]],
    );
}

#[test]
fn inputs_reach_scoped_variables_before_the_first_child() {
    let machine = SCOPED.replace("flow .v", "flow .a -> .v ; .v");
    check(
        &machine,
        "start",
        &expect![[r"
        > start
        enter ROOT a=7
        set ROOT.v = 5
        set ROOT.v = 7
        enter ROOT/A x=7
          run ROOT/A
    "]],
    );
    check(
        &machine,
        "start a=None",
        &expect![[r"
        > start a=None
        enter ROOT a=None
        set ROOT.v = 5
        set ROOT.v = None
        enter ROOT/A x=9
          run ROOT/A
    "]],
    );
}

#[test]
fn scoped_variables_begin_anew_at_each_entry() {
    check(
        "
hierarchy ROOT
  start -> H
  H.ok -> H
  hierarchy H
    outcome ok
    var v: int = 5
    start -> A
    A.ok -> .ok
    flow .v -> A.x ; A.y -> .v
    execution A
      outcome ok
      in x: int
      out y: int
",
        "start; A ok y=6",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/H
            set ROOT/H.v = 5
            enter ROOT/H/A x=5
              run ROOT/H/A
            > A ok y=6
            leave ROOT/H/A ok y=6
            set ROOT/H.v = 6
            leave ROOT/H ok
            enter ROOT/H
            set ROOT/H.v = 5
            enter ROOT/H/A x=5
              run ROOT/H/A
        "]],
    );
}

/// A hierarchy with this scoped variable, and a state that handles its abort.
fn with_variable(variable: &str) -> String {
    format!(
        "
hierarchy ROOT
  outcome saved
  start -> H
  H.aborted -> A ; A.ok -> .saved
  hierarchy H
    outcome ok
    var v: {variable}
    start -> B
    execution B
  execution A
    outcome ok
"
    )
}

#[test]
fn a_scoped_variable_that_cannot_be_made_aborts_its_container() {
    check(
        &with_variable("int = \"abc\""),
        "start; A ok",
        &expect![[r#"
            > start
            enter ROOT
            enter ROOT/H
            error ROOT/H: default of v: "abc" is not of the type int
            leave ROOT/H aborted error="scoped variable 'v' cannot be made: \"abc\" is not of the type int"
            enter ROOT/A
              run ROOT/A error="scoped variable 'v' cannot be made: \"abc\" is not of the type int"
            > A ok
            leave ROOT/A ok
            leave ROOT saved
            finished
              end of run: saved (0), 3 states
        "#]],
    );
    check(
        &with_variable("int = [1]"),
        "start",
        &expect![[r#"
            > start
            enter ROOT
            enter ROOT/H
            error ROOT/H: default of v: its default is of type list, not int; change one of them
            leave ROOT/H aborted error="scoped variable 'v' cannot be made: its default is of type list, not int; change one of them"
            enter ROOT/A
              run ROOT/A error="scoped variable 'v' cannot be made: its default is of type list, not int; change one of them"
        "#]],
    );
    check(
        &with_variable("int = \"$name\""),
        "start",
        &expect![[r#"
            > start
            enter ROOT
            enter ROOT/H
            error ROOT/H: default of v: its default is of type str, not int; change one of them
            leave ROOT/H aborted error="scoped variable 'v' cannot be made: its default is of type str, not int; change one of them"
            enter ROOT/A
              run ROOT/A error="scoped variable 'v' cannot be made: its default is of type str, not int; change one of them"
        "#]],
    );
    check(
        &with_variable("int = None"),
        "start",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/H
        set ROOT/H.v = None
        enter ROOT/H/B
          run ROOT/H/B
    "]],
    );
}
