//! Sources and targets of values.

use super::check;
use expect_test::expect;

#[test]
fn inputs_have_defaults_and_a_start_may_replace_them() {
    let machine = "
execution ROOT
  outcome ok
  in x: int = 1
  in s: str = \"a\"
";
    check(
        machine,
        "start",
        &expect![[r#"
        > start
        enter ROOT x=1 s="a"
          run ROOT
    "#]],
    );
    check(
        machine,
        "start x=5 nonsense=3",
        &expect![[r#"
            > start x=5 nonsense=3
            enter ROOT x=5 s="a"
            warning ROOT: no input nonsense
              run ROOT
        "#]],
    );
}

#[test]
fn raw_text_is_converted_to_the_type_of_its_port() {
    check(
        "execution ROOT\n  in x: int = \"41\"\n  in f: float = \"1.5\"\n  in l: list = \"[1]\"",
        "start",
        &expect![[r"
            > start
            enter ROOT x=41 f=1.5 l=[1]
              run ROOT
        "]],
    );
}

#[test]
fn a_default_of_another_type_passes_with_a_note() {
    check(
        "execution ROOT\n  in x: int = [1]\n  in y: float = 2",
        "start",
        &expect![[r"
            > start
            enter ROOT x=[1] y=2
            error ROOT: x is list, not int
              run ROOT
        "]],
    );
}

#[test]
fn a_default_that_cannot_be_made_is_none_with_a_note() {
    check(
        "execution ROOT\n  in x: int = \"abc\"\n  out y: int = \"z\"",
        "start",
        &expect![[r#"
            > start
            enter ROOT x=None
            error ROOT: default of x: "abc" is not of the type int
            error ROOT: default of y: "z" is not of the type int
              run ROOT
        "#]],
    );
}

#[test]
fn a_default_may_name_a_global_variable() {
    let machine = "execution ROOT\n  in x: int = \"$speed\"";
    check(
        machine,
        "global speed=3; start",
        &expect![[r"
        > global speed=3
        > start
        enter ROOT x=3
          run ROOT
    "]],
    );
    check(
        machine,
        "start",
        &expect![[r"
            > start
            enter ROOT x=None
            error ROOT: no global speed
              run ROOT
        "]],
    );
}

#[test]
fn a_global_variable_is_read_at_each_entry() {
    check(
        "
hierarchy ROOT
  start -> A
  A.ok -> A
  execution A
    outcome ok
    in x: int = \"$speed\"
",
        "global speed=3; start; global speed=4; A ok",
        &expect![[r"
            > global speed=3
            > start
            enter ROOT
            enter ROOT/A x=3
              run ROOT/A
            > global speed=4
            > A ok
            leave ROOT/A ok
            enter ROOT/A x=4
              run ROOT/A
        "]],
    );
}

#[test]
fn only_inputs_look_up_global_variables() {
    check(
        "
hierarchy ROOT
  out y: str = \"$speed\"
  var v: str = \"$speed\"
  outcome done
  start -> .done
",
        "global speed=3; start",
        &expect![[r#"
            > global speed=3
            > start
            enter ROOT
            set ROOT.v = "$speed"
            leave ROOT done y="$speed"
            finished
              end of run: done (0) y="$speed" variables: v="$speed", 1 states
        "#]],
    );
}

#[test]
fn outputs_flow_to_the_inputs_of_later_states() {
    check(
        "
hierarchy ROOT
  outcome done
  out z: int
  start -> A
  A.ok -> B ; B.ok -> .done
  flow A.y -> B.x ; B.y -> .z
  execution A
    outcome ok
    out y: int = 0
  execution B
    outcome ok
    in x: int = 9
    out y: int
",
        "start; A ok y=5; B ok y=6",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A
              run ROOT/A
            > A ok y=5
            leave ROOT/A ok y=5
            enter ROOT/B x=5
              run ROOT/B
            > B ok y=6
            leave ROOT/B ok y=6
            leave ROOT done z=6
            finished
              end of run: done (0) z=6, 3 states
        "]],
    );
}

const RACE: &str = "
hierarchy ROOT
  outcome done
  out z: int = 100
  start -> A
  A.ok -> B ; A.skip -> C ; B.ok -> C ; C.ok -> A ; C.done -> .done
  flow A.y -> C.x ; B.y -> C.x ; A.y -> .z ; B.y -> .z
  execution A
    outcome ok
    outcome skip
    out y: int
  execution B
    outcome ok
    out y: int
  execution C
    outcome ok
    outcome done
    in x: int = 9
";

#[test]
fn the_newest_value_wins() {
    check(
        RACE,
        "start; A ok y=1; B ok y=2; C ok; A skip y=3; C done",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > A ok y=1
        leave ROOT/A ok y=1
        enter ROOT/B
          run ROOT/B
        > B ok y=2
        leave ROOT/B ok y=2
        enter ROOT/C x=2
          run ROOT/C
        > C ok
        leave ROOT/C ok
        enter ROOT/A
          run ROOT/A
        > A skip y=3
        leave ROOT/A skip y=3
        enter ROOT/C x=3
          run ROOT/C
        > C done
        leave ROOT/C done
        leave ROOT done z=3
        finished
          end of run: done (0) z=3, 6 states
    "]],
    );
}

#[test]
fn none_never_reaches_an_input_over_a_data_flow() {
    check(
        RACE,
        "start; A ok y=1; B ok y=None; C ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > A ok y=1
        leave ROOT/A ok y=1
        enter ROOT/B
          run ROOT/B
        > B ok y=None
        leave ROOT/B ok y=None
        enter ROOT/C x=1
          run ROOT/C
        > C ok
        leave ROOT/C ok
        enter ROOT/A
          run ROOT/A
    "]],
    );
    check(
        RACE,
        "start; A ok y=None; B ok y=None",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > A ok y=None
        leave ROOT/A ok y=None
        enter ROOT/B
          run ROOT/B
        > B ok y=None
        leave ROOT/B ok y=None
        enter ROOT/C x=9
          run ROOT/C
    "]],
    );
}

#[test]
fn none_overrides_an_output_of_a_container() {
    check(
        RACE,
        "start; A ok y=1; B ok y=None; C done",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > A ok y=1
        leave ROOT/A ok y=1
        enter ROOT/B
          run ROOT/B
        > B ok y=None
        leave ROOT/B ok y=None
        enter ROOT/C x=1
          run ROOT/C
        > C done
        leave ROOT/C done
        leave ROOT done z=None
        finished
          end of run: done (0) z=None, 4 states
    "]],
    );
}

#[test]
fn an_output_without_a_value_keeps_its_default() {
    check(
        RACE,
        "start; A ok -y; B ok -y; C done",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > A ok -y
        leave ROOT/A ok y=None
        enter ROOT/B
          run ROOT/B
        > B ok -y
        leave ROOT/B ok y=None
        enter ROOT/C x=9
          run ROOT/C
        > C done
        leave ROOT/C done
        leave ROOT done z=100
        finished
          end of run: done (0) z=100, 4 states
    "]],
    );
}

#[test]
fn an_output_that_is_left_out_flows_nowhere() {
    check(
        RACE,
        "start; A ok y=1; B ok -y",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/A
          run ROOT/A
        > A ok y=1
        leave ROOT/A ok y=1
        enter ROOT/B
          run ROOT/B
        > B ok -y
        leave ROOT/B ok y=None
        enter ROOT/C x=1
          run ROOT/C
    "]],
    );
}

#[test]
fn an_input_may_flow_straight_to_an_output() {
    check(
        "hierarchy ROOT\n  outcome done\n  in x: int = 4\n  out y: int\n  start -> .done\n  flow .x -> .y",
        "start x=8",
        &expect![[r"
            > start x=8
            enter ROOT x=8
            leave ROOT done y=8
            finished
              end of run: done (0) y=8, 1 states
        "]],
    );
}

#[test]
fn a_state_may_feed_itself() {
    check(
        "
hierarchy ROOT
  start -> A
  A.ok -> A
  flow A.y -> A.x
  execution A
    outcome ok
    in x: int = 0
    out y: int
",
        "start; A ok y=1; A ok y=2",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A x=0
              run ROOT/A
            > A ok y=1
            leave ROOT/A ok y=1
            enter ROOT/A x=1
              run ROOT/A
            > A ok y=2
            leave ROOT/A ok y=2
            enter ROOT/A x=2
              run ROOT/A
        "]],
    );
}

#[test]
fn a_value_of_the_wrong_type_passes_with_a_note() {
    check(
        "
hierarchy ROOT
  outcome done
  var v: int = 3
  out z: float
  start -> A
  A.ok -> .done
  flow A.y -> .v ; A.y -> .z
  execution A
    outcome ok
    out y: float
",
        "start; A ok y=\"no\"",
        &expect![[r#"
            > start
            enter ROOT
            set ROOT.v = 3
            enter ROOT/A
              run ROOT/A
            > A ok y="no"
            error ROOT/A: y is str, not float
            leave ROOT/A ok y="no"
            error ROOT: v is str, not int
            set ROOT.v = "no"
            error ROOT: z is str, not float
            leave ROOT done z="no"
            finished
              end of run: done (0) z="no" variables: v="no", 2 states
        "#]],
    );
    check(
        "execution ROOT\n  in x: int = 1",
        "start x=\"no\"",
        &expect![[r#"
            > start x="no"
            enter ROOT x="no"
            error ROOT: x is str, not int
              run ROOT
        "#]],
    );
}

#[test]
fn int_and_float_pass_for_each_other() {
    check(
        "execution ROOT\n  outcome ok\n  in x: float = 0.0\n  out y: int",
        "start x=1; ROOT ok y=2.5",
        &expect![[r"
            > start x=1
            enter ROOT x=1
              run ROOT
            > ROOT ok y=2.5
            leave ROOT ok y=2.5
            finished
              end of run: ok (0) y=2.5, 1 states
        "]],
    );
}

#[test]
fn none_fits_every_type() {
    check(
        "execution ROOT\n  outcome ok\n  in x: float = 0.0\n  out y: int",
        "start x=None; ROOT ok y=None",
        &expect![[r"
            > start x=None
            enter ROOT x=None
              run ROOT
            > ROOT ok y=None
            leave ROOT ok y=None
            finished
              end of run: ok (0) y=None, 1 states
        "]],
    );
}

#[test]
fn flows_from_or_to_nothing_move_nothing() {
    check(
        "
hierarchy ROOT
  start -> A
  flow A.5 -> A.0 ; GONE.1 -> A.0 ; .3 -> A.0 ; A.1 -> GONE.2
  execution A
    outcome ok
    in x: int = 1
    out y: int
",
        "start; A ok y=5",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/A x=1
              run ROOT/A
            > A ok y=5
            leave ROOT/A ok y=5
            wait ROOT: no transition from ROOT/A ok
        "]],
    );
}
