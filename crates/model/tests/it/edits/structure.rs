//! Edits of which states stand where.

use super::{at, check, edited};
use expect_test::expect;
use rafcon_model::edit::{ChildrenEdit, Edit, StateEdit, apply, copy};
use rafcon_model::rules::MAX_NESTING;
use rafcon_model::{
    BuiltinTypes, KindName, OutcomeId, PortId, Rule, State, StateId, StatePath, Target, diff,
};
use rafcon_testkit::notation;
use std::sync::Arc;

fn children(path: &str, edit: ChildrenEdit) -> Edit {
    Edit::Children(at(path), edit)
}

fn state(text: &str) -> Arc<State> {
    notation::parse(text).expect("a state in the notation").root
}

fn ids(ids: &[&str]) -> Vec<StateId> {
    ids.iter().map(StateId::new).collect()
}

fn group(path: &str, states: &[&str], scoped_variables: &[i64]) -> Edit {
    let (states, id) = (ids(states), StateId::new("GROUPX"));
    let scoped_variables = scoped_variables.iter().map(|id| PortId(*id)).collect();
    children(path, ChildrenEdit::Group { states, scoped_variables, id, name: "Group".into() })
}

fn ungroup(path: &str, id: &str, fresh: &[&str]) -> Edit {
    children(path, ChildrenEdit::Ungroup { state: StateId::new(id), fresh: ids(fresh) })
}

#[test]
fn states_come_and_go() {
    check(
        "
        hierarchy ROOT
          outcome success
          start -> AAAAAA
          AAAAAA.success -> .success
          flow AAAAAA.y -> AAAAAA.x
          execution AAAAAA
            outcome success
            in x: int
            out y: int
        ",
        &[
            children("ROOT", ChildrenEdit::Add(state("execution AAAAAA"))),
            children("ROOT", ChildrenEdit::Add(state("hierarchy BBBBBB\n  start -> GONE"))),
            children("ROOT", ChildrenEdit::Add(state("decider BBBBBB"))),
            children("ROOT", ChildrenEdit::Add(state("barrier BBBBBB"))),
            children(
                "ROOT/BBBBBB",
                ChildrenEdit::Add(state("execution CCCCCC\n  outcome a\n  outcome b")),
            ),
            children("ROOT/BBBBBB", ChildrenEdit::Remove(StateId::new("unique_decider_state_id"))),
            children("ROOT", ChildrenEdit::SetStart(Some(Target::State(StateId::new("BBBBBB"))))),
            children("ROOT", ChildrenEdit::SetStart(Some(Target::Outcome(OutcomeId(3))))),
            children(
                "ROOT/BBBBBB",
                ChildrenEdit::SetStart(Some(Target::State(StateId::new("CCCCCC")))),
            ),
            children("ROOT", ChildrenEdit::Remove(StateId::new("AAAAAA"))),
            children("ROOT", ChildrenEdit::Remove(StateId::new("AAAAAA"))),
            children("ROOT/BBBBBB/CCCCCC", ChildrenEdit::Remove(StateId::new("AAAAAA"))),
            children("ROOT", ChildrenEdit::SetStart(None)),
        ],
        &expect![[r#"
            refused: ROOT/AAAAAA, state: something else has this id; take another id
            refused: ROOT/BBBBBB, transition 1: it leads to GONE, which does not exist; connect the end with a child or an outcome of the container, or remove the transition
            refused: ROOT/BBBBBB, state: a decider is outside of a barrier; make it an execution state with an id of its own
            refused: ROOT/BBBBBB/unique_decider_state_id, state: it is the decider of a barrier; remove or change the barrier as a whole
            refused: ROOT, transition 1: it leads to the outcome 3 of the container, which does not exist; connect the end with an outcome that exists, or remove the transition
            refused: ROOT/BBBBBB, transition 3: it begins at the income of a barrier concurrency state; remove the start transition
            refused: ROOT/AAAAAA, state: there is no such state; check the machine again: it may have changed
            refused: ROOT/BBBBBB/CCCCCC, state: it is a state of the kind execution, which has no children; change the kind of the state first
            hierarchy ROOT
              outcome success
              barrier BBBBBB
                CCCCCC.a -> unique_decider_state_id
                CCCCCC.b -> unique_decider_state_id
                execution CCCCCC
                  outcome a
                  outcome b
                decider unique_decider_state_id "Decider"
                  outcome success
        "#]],
    );
}

const CHAIN: &str = "
    hierarchy ROOT
      outcome success
      var sv: int
      start -> AAAAAA
      AAAAAA.success -> BBBBBB
      BBBBBB.success -> CCCCCC
      CCCCCC.success -> DDDDDD
      CCCCCC.aborted -> .aborted
      DDDDDD.success -> .success
      flow AAAAAA.o -> BBBBBB.i
      flow AAAAAA.o -> CCCCCC.i
      flow .sv -> BBBBBB.i
      flow CCCCCC.o -> DDDDDD.i
      flow CCCCCC.o -> .sv
      execution AAAAAA
        outcome success
        out o: int
      execution BBBBBB
        outcome success
        in i: int
      execution CCCCCC
        outcome success
        in i: int
        out o: int
      execution DDDDDD
        outcome success
        in i: int
";

#[test]
fn a_group_takes_over_what_crosses_its_border() {
    check(
        CHAIN,
        &[group("ROOT", &["BBBBBB", "CCCCCC"], &[])],
        &expect![[r#"
        hierarchy ROOT
          outcome success
          var sv: int
          start -> AAAAAA
          AAAAAA.success -> GROUPX
          GROUPX.success -> DDDDDD as 4
          GROUPX.aborted -> .aborted
          DDDDDD.success -> .success
          flow AAAAAA.o -> GROUPX.i
          flow AAAAAA.o -> GROUPX.i_0
          flow .sv -> GROUPX.i
          flow GROUPX.o -> DDDDDD.i
          flow GROUPX.o -> .sv
          execution AAAAAA
            outcome success
            out o: int
          execution DDDDDD
            outcome success
            in i: int
          hierarchy GROUPX "Group"
            outcome success
            in i: int
            in i_0: int
            out o: int
            start -> BBBBBB as 2
            BBBBBB.success -> CCCCCC
            CCCCCC.success -> .success
            CCCCCC.aborted -> .aborted
            flow .i -> BBBBBB.i
            flow .i_0 -> CCCCCC.i
            flow CCCCCC.o -> .o as 4
            execution BBBBBB
              outcome success
              in i: int
            execution CCCCCC
              outcome success
              in i: int
              out o: int
    "#]],
    );
}

#[test]
fn a_group_takes_scoped_variables_along() {
    check(
        CHAIN,
        &[group("ROOT", &["AAAAAA", "BBBBBB"], &[0])],
        &expect![[r#"
        hierarchy ROOT
          outcome success
          start -> GROUPX
          GROUPX.success -> CCCCCC as 3
          CCCCCC.success -> DDDDDD
          CCCCCC.aborted -> .aborted
          DDDDDD.success -> .success
          flow GROUPX.o -> CCCCCC.i as 2
          flow CCCCCC.o -> DDDDDD.i as 4
          flow CCCCCC.o -> GROUPX.sv
          execution CCCCCC
            outcome success
            in i: int
            out o: int
          execution DDDDDD
            outcome success
            in i: int
          hierarchy GROUPX "Group"
            outcome success
            in 2 sv: int
            out 1 o: int
            var sv: int
            start -> AAAAAA
            AAAAAA.success -> BBBBBB
            BBBBBB.success -> .success
            flow AAAAAA.o -> BBBBBB.i
            flow AAAAAA.o -> .o
            flow .0 -> BBBBBB.i
            flow .sv -> .sv as 5
            execution AAAAAA
              outcome success
              out o: int
            execution BBBBBB
              outcome success
              in i: int
    "#]],
    );
}

#[test]
fn a_group_with_two_entries_is_refused() {
    check(
        CHAIN,
        &[
            group("ROOT", &["BBBBBB", "DDDDDD"], &[]),
            group("ROOT", &[], &[]),
            group("ROOT", &["NOPEXX"], &[]),
            group("ROOT", &["AAAAAA"], &[7]),
        ],
        &expect![[r"
            refused: ROOT, transition 4: transitions lead to both BBBBBB and DDDDDD in the group; group states that are entered at one state only, or remove transitions first
            refused: ROOT, state: there is no state to group; check the machine again: it may have changed
            refused: ROOT/NOPEXX, state: there is no such state; check the machine again: it may have changed
            refused: ROOT, scoped variable 7: it does not exist; check the machine again: it may have changed
            hierarchy ROOT
              outcome success
              var sv: int
              start -> AAAAAA
              AAAAAA.success -> BBBBBB
              BBBBBB.success -> CCCCCC
              CCCCCC.success -> DDDDDD
              CCCCCC.aborted -> .aborted
              DDDDDD.success -> .success
              flow AAAAAA.o -> BBBBBB.i
              flow AAAAAA.o -> CCCCCC.i
              flow .sv -> BBBBBB.i
              flow CCCCCC.o -> DDDDDD.i
              flow CCCCCC.o -> .sv
              execution AAAAAA
                outcome success
                out o: int
              execution BBBBBB
                outcome success
                in i: int
              execution CCCCCC
                outcome success
                in i: int
                out o: int
              execution DDDDDD
                outcome success
                in i: int
        "]],
    );
}

#[test]
fn ungrouping_is_the_way_back() {
    check(
        CHAIN,
        &[group("ROOT", &["BBBBBB", "CCCCCC"], &[0]), ungroup("ROOT", "GROUPX", &[])],
        &expect![[r"
            hierarchy ROOT
              outcome success
              var sv: int
              start -> AAAAAA
              AAAAAA.success -> BBBBBB
              DDDDDD.success -> .success as 6
              BBBBBB.success -> CCCCCC
              CCCCCC.success -> DDDDDD
              CCCCCC.aborted -> .aborted
              flow AAAAAA.o -> BBBBBB.i as 5
              flow AAAAAA.o -> CCCCCC.i
              flow .sv -> BBBBBB.i
              flow CCCCCC.o -> DDDDDD.i
              flow CCCCCC.o -> .sv
              execution AAAAAA
                outcome success
                out o: int
              execution BBBBBB
                outcome success
                in i: int
              execution CCCCCC
                outcome success
                in i: int
                out o: int
              execution DDDDDD
                outcome success
                in i: int
        "]],
    );
}

const NESTED: &str = "
        hierarchy ROOT
          outcome success
          in a: int
          out b: int
          var v: int
          start -> GROUPX
          GROUPX.done -> .success
          GROUPX.again -> GROUPX
          flow .a -> GROUPX.x
          flow .v -> GROUPX.x
          flow GROUPX.y -> .b
          flow GROUPX.y -> GROUPX.x
          execution AAAAAA
          barrier BARRIE
            outcome done
            EEEEEE.done -> unique_decider_state_id
            unique_decider_state_id.done -> .done
            execution EEEEEE
              outcome done
            decider unique_decider_state_id
              outcome done
          hierarchy GROUPX
            outcome done
            outcome again
            in x: int
            out y: int
            var v: int
            start -> AAAAAA
            AAAAAA.done -> .done
            AAAAAA.again -> .again
            flow .x -> AAAAAA.x
            flow .x -> .v
            flow .x -> .y
            flow .v -> .y
            flow AAAAAA.y -> .y
            execution AAAAAA
              outcome done
              outcome again
              in x: int
              out y: int
        ";

#[test]
fn ungrouping_makes_room() {
    check(
        NESTED,
        &[
            ungroup("ROOT", "GROUPX", &[]),
            ungroup("ROOT", "GROUPX", &["BARRIE", "FRESHX"]),
            ungroup("ROOT", "BARRIE", &[]),
            ungroup("ROOT", "AAAAAA", &[]),
        ],
        &expect![[r#"
            refused: ROOT/GROUPX/AAAAAA, state: the id AAAAAA is taken outside, and no fresh id was given; take another id
            refused: ROOT/AAAAAA, state: a state of the kind execution has no children; change the kind of the state first
            hierarchy ROOT
              outcome success
              in a: int
              out b: int
              var v: int
              var GROUPX_v: int
              start -> FRESHX
              FRESHX.done -> .success as 4
              FRESHX.again -> FRESHX
              flow .a -> FRESHX.x as 5
              flow .v -> FRESHX.x
              flow .GROUPX_v -> FRESHX.x
              flow FRESHX.y -> FRESHX.x
              flow .a -> .GROUPX_v
              flow FRESHX.y -> .GROUPX_v
              flow .GROUPX_v -> .b
              flow FRESHX.y -> .b
              execution AAAAAA
              execution EEEEEE
                outcome done
              execution FRESHX "AAAAAA"
                outcome done
                outcome again
                in x: int
                out y: int
        "#]],
    );
}

fn kind(path: &str, kind: KindName) -> Edit {
    Edit::State(at(path), StateEdit::SetKind(kind))
}

#[test]
fn kinds_change_and_keep_what_they_can() {
    check(
        CHAIN,
        &[kind("ROOT", KindName::Barrier)],
        &expect![[r#"
        barrier ROOT
          outcome success
          var sv: int
          flow AAAAAA.o -> BBBBBB.i
          flow AAAAAA.o -> CCCCCC.i
          flow .sv -> BBBBBB.i
          flow CCCCCC.o -> DDDDDD.i
          flow CCCCCC.o -> .sv
          execution AAAAAA
            outcome success
            out o: int
          execution BBBBBB
            outcome success
            in i: int
          execution CCCCCC
            outcome success
            in i: int
            out o: int
          execution DDDDDD
            outcome success
            in i: int
          decider unique_decider_state_id "Decider"
            outcome success
    "#]],
    );
    check(
        CHAIN,
        &[kind("ROOT", KindName::Execution)],
        &expect![[r"
        execution ROOT
          outcome success
    "]],
    );
}

#[test]
fn a_barrier_loses_its_decider_when_it_becomes_something_else() {
    check(
        "
        barrier ROOT
          outcome success
          in a: int
          var v: int
          AAAAAA.success -> unique_decider_state_id
          flow .v -> AAAAAA.x
          flow .v -> unique_decider_state_id.x
          execution AAAAAA
            outcome success
            in x: int
            script \"\"
          decider unique_decider_state_id
            in x: int
        ",
        &[
            kind("ROOT/unique_decider_state_id", KindName::Execution),
            kind("ROOT/AAAAAA", KindName::Decider),
            kind("ROOT", KindName::Library),
            kind("ROOT/AAAAAA", KindName::Preemptive),
            kind("ROOT", KindName::Hierarchy),
        ],
        &expect![[r"
            refused: ROOT/unique_decider_state_id, state: it is the decider of a barrier; remove or change the barrier as a whole
            refused: ROOT/AAAAAA, state: only the decider of a barrier is a decider; make it an execution state with an id of its own
            refused: ROOT, state: a library state is put in the place of another state; change the kind of the state first
            hierarchy ROOT
              outcome success
              in a: int
              var v: int
              flow .v -> AAAAAA.x
              preemptive AAAAAA
                outcome success
                in x: int
        "]],
    );
}

#[test]
fn a_substitute_takes_over_what_fits() {
    let library = state(
        "
        library LIBRAR from \"lib/one\"
          content
            execution INNERX
              outcome other
              outcome success
              in 5 i: int = 7
              out o: str
        ",
    );
    let substitute = |by: &Arc<State>| {
        let (state, by) = (StateId::new("CCCCCC"), Arc::clone(by));
        children("ROOT", ChildrenEdit::Substitute { state, by })
    };
    let with_default = CHAIN.replace("in i: int", "in i: int = 3");
    check(
        &with_default,
        &[substitute(&library), substitute(&library)],
        &expect![[r#"
        refused: ROOT/CCCCCC, state: there is no such state; check the machine again: it may have changed
        hierarchy ROOT
          outcome success
          var sv: int
          start -> AAAAAA
          AAAAAA.success -> BBBBBB
          BBBBBB.success -> LIBRAR
          LIBRAR.success -> DDDDDD
          LIBRAR.aborted -> .aborted
          DDDDDD.success -> .success
          flow AAAAAA.o -> BBBBBB.i
          flow AAAAAA.o -> LIBRAR.i
          flow .sv -> BBBBBB.i
          execution AAAAAA
            outcome success
            out o: int
          execution BBBBBB
            outcome success
            in i: int = 3
          execution DDDDDD
            outcome success
            in i: int = 3
          library LIBRAR from "lib/one"
            set in i = 3
            content
              execution INNERX
                outcome other
                outcome success
                in 5 i: int = 7
                out o: str
    "#]],
    );
}

#[test]
fn a_substitute_takes_over_runtime_values() {
    let library = |id: &str, default: i64| {
        state(&format!(
            "
            library {id} from \"lib/{default}\"
              content
                execution INNERX
                  in 5 i: int = {default}
                  in j: int = {default}
            "
        ))
    };
    let substitute = |old: &str, by: Arc<State>| {
        children("ROOT", ChildrenEdit::Substitute { state: StateId::new(old), by })
    };
    let plain = state("execution FOURTH\n  in i: int = 1\n  in j: int = 2");
    check(
        "
        hierarchy ROOT
          library FIRSTX from \"lib/7\"
            set in i = 3
            set in j = 4 unused
            content
              execution INNERX
                in i: int = 7
                in j: int = 7
        ",
        &[substitute("FIRSTX", library("SECOND", 8))],
        &expect![[r#"
            hierarchy ROOT
              library SECOND from "lib/8"
                set in j = 4 unused
                set in i = 3
                content
                  execution INNERX
                    in j: int = 8
                    in 5 i: int = 8
        "#]],
    );
    check(
        "
        hierarchy ROOT
          library FIRSTX from \"lib/7\"
            set in i = 3
            set in j = 4 unused
            content
              execution INNERX
                in i: int = 7
                in j: int = 7
        ",
        &[substitute("FIRSTX", plain)],
        &expect![[r"
            hierarchy ROOT
              execution FOURTH
                in i: int = 3
                in j: int = 2
        "]],
    );
}

#[test]
fn a_substitute_has_an_id_of_its_own() {
    let (state, by) = (StateId::new("CCCCCC"), state("execution AAAAAA"));
    let edit = children("ROOT", ChildrenEdit::Substitute { state, by });
    check(
        CHAIN,
        &[edit],
        &expect![[r"
        refused: ROOT/AAAAAA, state: something else has this id; take another id
        hierarchy ROOT
          outcome success
          var sv: int
          start -> AAAAAA
          AAAAAA.success -> BBBBBB
          BBBBBB.success -> CCCCCC
          CCCCCC.success -> DDDDDD
          CCCCCC.aborted -> .aborted
          DDDDDD.success -> .success
          flow AAAAAA.o -> BBBBBB.i
          flow AAAAAA.o -> CCCCCC.i
          flow .sv -> BBBBBB.i
          flow CCCCCC.o -> DDDDDD.i
          flow CCCCCC.o -> .sv
          execution AAAAAA
            outcome success
            out o: int
          execution BBBBBB
            outcome success
            in i: int
          execution CCCCCC
            outcome success
            in i: int
            out o: int
          execution DDDDDD
            outcome success
            in i: int
    "]],
    );
}

#[test]
fn a_substitute_in_a_barrier_leads_to_the_decider() {
    let by = state("execution NEWXXX\n  outcome success\n  outcome more");
    check(
        "
        barrier ROOT
          AAAAAA.success -> unique_decider_state_id
          execution AAAAAA
            outcome success
          decider unique_decider_state_id
        ",
        &[children("ROOT", ChildrenEdit::Substitute { state: StateId::new("AAAAAA"), by })],
        &expect![[r"
            barrier ROOT
              NEWXXX.success -> unique_decider_state_id
              NEWXXX.more -> unique_decider_state_id
              execution NEWXXX
                outcome success
                outcome more
              decider unique_decider_state_id
        "]],
    );
}

#[test]
fn states_move_with_what_is_between_them() {
    let move_to = |states: &[&str], to: &str, new: &[&str]| {
        let (states, to, ids) = (ids(states), at(to), ids(new));
        children("ROOT", ChildrenEdit::Move { states, to, ids })
    };
    let text = format!(
        "{CHAIN}      hierarchy EEEEEE\n        hierarchy AAAAAA\n      barrier FFFFFF\n        decider unique_decider_state_id\n"
    );
    check(
        &text,
        &[
            move_to(&["EEEEEE"], "ROOT/EEEEEE/AAAAAA", &[]),
            move_to(&["AAAAAA", "BBBBBB"], "ROOT/EEEEEE", &[]),
            move_to(&["AAAAAA", "BBBBBB"], "ROOT/EEEEEE", &["GGGGGG"]),
            move_to(&["CCCCCC", "DDDDDD"], "ROOT/FFFFFF", &[]),
        ],
        &expect![[r#"
            refused: ROOT/EEEEEE, state: it would contain itself; choose a container outside the state
            refused: ROOT/EEEEEE/AAAAAA, state: something else has this id; take another id
            hierarchy ROOT
              outcome success
              var sv: int
              hierarchy EEEEEE
                GGGGGG.success -> BBBBBB
                flow GGGGGG.o -> BBBBBB.i
                hierarchy AAAAAA
                execution BBBBBB
                  outcome success
                  in i: int
                execution GGGGGG "AAAAAA"
                  outcome success
                  out o: int
              barrier FFFFFF
                CCCCCC.success -> unique_decider_state_id
                DDDDDD.success -> unique_decider_state_id
                flow CCCCCC.o -> DDDDDD.i
                execution CCCCCC
                  outcome success
                  in i: int
                  out o: int
                execution DDDDDD
                  outcome success
                  in i: int
                decider unique_decider_state_id
        "#]],
    );
}

#[test]
fn copies_are_pasted_under_fresh_ids() {
    let machine = notation::parse(CHAIN).expect("a machine");
    let selection = copy(&machine.root, &ids(&["BBBBBB", "CCCCCC"]), &[PortId(0)]);
    let paste = |new: &[&str]| {
        let (selection, ids) = (selection.clone(), ids(new));
        children("ROOT", ChildrenEdit::Paste { selection, ids })
    };
    check(
        CHAIN,
        &[paste(&[]), paste(&["XXXXXX", "YYYYYY"])],
        &expect![[r#"
        refused: ROOT/BBBBBB, state: something else has this id; take another id
        hierarchy ROOT
          outcome success
          var sv: int
          var sv_0: int
          start -> AAAAAA
          AAAAAA.success -> BBBBBB
          BBBBBB.success -> CCCCCC
          CCCCCC.success -> DDDDDD
          CCCCCC.aborted -> .aborted
          DDDDDD.success -> .success
          XXXXXX.success -> YYYYYY
          flow AAAAAA.o -> BBBBBB.i
          flow AAAAAA.o -> CCCCCC.i
          flow .sv -> BBBBBB.i
          flow CCCCCC.o -> DDDDDD.i
          flow CCCCCC.o -> .sv
          flow .sv_0 -> XXXXXX.i
          flow YYYYYY.o -> .sv_0
          execution AAAAAA
            outcome success
            out o: int
          execution BBBBBB
            outcome success
            in i: int
          execution CCCCCC
            outcome success
            in i: int
            out o: int
          execution DDDDDD
            outcome success
            in i: int
          execution XXXXXX "BBBBBB"
            outcome success
            in i: int
          execution YYYYYY "CCCCCC"
            outcome success
            in i: int
            out o: int
    "#]],
    );
}

/// A machine as deep as allowed can be built, compared and taken apart; one level more is refused.
#[test]
fn the_deepest_machine_is_no_danger() {
    let mut machine = notation::parse("hierarchy S0").expect("a machine");
    let mut path = at("S0");
    let mut add = |path: &StatePath, level: usize| {
        let child = state(&format!("hierarchy S{level}"));
        let edit = Edit::Children(path.clone(), ChildrenEdit::Add(child));
        apply(&mut machine, edit, &BuiltinTypes)
            .map(|_| path.child(StateId::new(format!("S{level}"))))
    };
    for level in 1..MAX_NESTING {
        path = add(&path, level).expect("a level more");
    }
    let refused = add(&path, MAX_NESTING).expect_err("too deep");
    assert_eq!(refused.rule, Rule::Nesting);
    let copy = notation::parse(&notation::print(&machine)).expect("the same machine");
    assert_eq!((copy.count(), &copy), (MAX_NESTING, &machine));
    assert!(diff(&copy, &machine).is_empty());
    let group = edited(&machine, group("S0", &["S1"], &[])).expect_err("too deep");
    assert!(group.contains("nested deeper"), "{group}");
}
