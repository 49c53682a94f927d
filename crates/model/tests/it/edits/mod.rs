//! Machines in the notation in, an edit, machines out; each edit is taken back and made again.

mod random;
mod structure;

use expect_test::{Expect, expect};
use rafcon_model::edit::{
    DataFlowEdit, Edit, HeaderEdit, LayoutEdit, LayoutElement, OutcomeEdit, PortEdit,
    RuntimeValueEdit, StateEdit, TransitionEdit, apply,
};
use rafcon_model::{
    BuiltinTypes, DataFlowId, DataType, Json, KindName, Machine, Origin, OutcomeId, PortId,
    PortKind, StateId, StatePath, Target, TransitionId, Value,
};
use rafcon_testkit::notation;

/// The machine after the edit, or the refusal. Holds that a refusal changes nothing, and that the edit can be taken back
/// and made again.
fn edited(machine: &Machine, edit: Edit) -> Result<Machine, String> {
    let mut now = machine.clone();
    match apply(&mut now, edit, &BuiltinTypes) {
        Ok(back) => {
            let after = now.clone();
            let again = apply(&mut now, back, &BuiltinTypes).expect("an edit is taken back");
            assert_eq!(now, *machine);
            apply(&mut now, again, &BuiltinTypes).expect("an edit is made again");
            assert_eq!(now, after);
            Ok(after)
        }
        Err(error) => {
            assert_eq!(now, *machine);
            Err(format!("refused: {error}"))
        }
    }
}

fn check(text: &str, edits: &[Edit], expect: &Expect) {
    let mut machine = notation::parse(text).expect("a machine in the notation");
    let mut out = String::new();
    for edit in edits {
        match edited(&machine, edit.clone()) {
            Ok(after) => machine = after,
            Err(refusal) => out.push_str(&(refusal + "\n")),
        }
    }
    expect.assert_eq(&(out + &notation::print(&machine)));
}

fn at(path: &str) -> StatePath {
    StatePath::parse(path)
}

fn end(state: &str, port: i64) -> (StateId, PortId) {
    (StateId::new(state), PortId(port))
}

fn outcome_of(state: &str, outcome: i64) -> Origin {
    Origin::Outcome(StateId::new(state), OutcomeId(outcome))
}

const TWO: &str = "
    hierarchy ROOT
      outcome success
      in a: int
      var v: int
      start -> FIRSTX
      FIRSTX.success -> SECOND
      SECOND.success -> .success
      flow .a -> FIRSTX.x
      flow FIRSTX.y -> .v
      execution FIRSTX
        outcome success
        in x: int
        out y: int
      execution SECOND
        outcome success
        in x: float
";

#[test]
fn an_id_has_no_control_characters() {
    let mut machine = notation::parse(TWO).unwrap();
    for id in ["NUL\0", "A\nB", "A/B"] {
        let edit = Edit::State(at("ROOT/FIRSTX"), StateEdit::SetId(StateId::new(id)));
        let refused = apply(&mut machine, edit, &BuiltinTypes).unwrap_err();
        assert!(refused.to_string().contains("or a control character"), "{refused}");
    }
}

#[test]
fn a_state_is_changed() {
    let edit = |edit| Edit::State(at("ROOT/FIRSTX"), edit);
    check(
        TWO,
        &[
            edit(StateEdit::SetName("a/b".into())),
            edit(StateEdit::SetName("Go".into())),
            edit(StateEdit::SetDescription(Some("".into()))),
            edit(StateEdit::SetSemanticData(Some(Json::object().into()))),
            edit(StateEdit::SetScript(Some("pass\n".into()))),
            edit(StateEdit::SetId(StateId::new("SECOND"))),
            edit(StateEdit::SetId(StateId::new("ROOT"))),
            edit(StateEdit::SetId(StateId::new("THIRDX"))),
            Edit::State(at("ROOT"), StateEdit::SetId(StateId::new("MAINXX"))),
            Edit::State(at("MAINXX"), StateEdit::SetScript(None)),
            Edit::State(at("MAINXX/NOPEXX"), StateEdit::SetName("x".into())),
        ],
        &expect![[r#"
            refused: ROOT/FIRSTX, state: the name `a/b` contains a `/`; take the `/` out of the name
            refused: ROOT/FIRSTX, state: something else has this id; take another id
            refused: ROOT/FIRSTX, state: something else has this id; take another id
            refused: MAINXX, state: a state of the kind hierarchy has no script; change the kind of the state first
            refused: MAINXX/NOPEXX, state: there is no such state; check the machine again: it may have changed
            hierarchy MAINXX "ROOT"
              outcome success
              in a: int
              var v: int
              start -> THIRDX
              THIRDX.success -> SECOND
              SECOND.success -> .success
              flow .a -> THIRDX.x
              flow THIRDX.y -> .v
              execution SECOND
                outcome success
                in x: float
              execution THIRDX "Go"
                outcome success
                in x: int
                out y: int
                semantic {}
                script |
                  pass
        "#]],
    );
}

#[test]
fn outcomes_go_with_their_transitions() {
    let outcome = |path: &str, id, edit| Edit::Outcome(at(path), OutcomeId(id), edit);
    check(
        TWO,
        &[
            outcome("ROOT", 0, OutcomeEdit::Remove),
            outcome("ROOT/FIRSTX", 0, OutcomeEdit::Remove),
            outcome("ROOT/FIRSTX", 0, OutcomeEdit::Remove),
            outcome("ROOT/FIRSTX", -1, OutcomeEdit::Remove),
            outcome("ROOT/FIRSTX", -1, OutcomeEdit::Rename("failed".into())),
            outcome("ROOT/FIRSTX", 3, OutcomeEdit::Add("failed".into())),
            outcome("ROOT/FIRSTX", 3, OutcomeEdit::Add("other".into())),
            outcome("ROOT/FIRSTX", 3, OutcomeEdit::Add("more".into())),
        ],
        &expect![[r"
            refused: ROOT/FIRSTX, outcome 0: it does not exist; check the machine again: it may have changed
            refused: ROOT/FIRSTX, outcome -1: every state has this outcome; rename the outcome, or leave it unconnected
            refused: ROOT/FIRSTX, outcome 3: the outcome -1 has the name `failed`, too; rename one of the outcomes
            refused: ROOT/FIRSTX, outcome 3: something else has this id; take another id
            hierarchy ROOT
              in a: int
              var v: int
              start -> FIRSTX
              flow .a -> FIRSTX.x
              flow FIRSTX.y -> .v
              execution FIRSTX
                outcome -1 failed
                outcome 3 other
                in x: int
                out y: int
              execution SECOND
                outcome success
                in x: float
        "]],
    );
}

#[test]
fn ports_go_with_their_data_flows() {
    let port = |path: &str, kind, id, edit| Edit::Port(at(path), kind, PortId(id), edit);
    let add = |name: &str, default| PortEdit::Add {
        name: name.into(),
        data_type: DataType::Int,
        default,
    };
    check(
        TWO,
        &[
            port("ROOT", PortKind::Input, 0, PortEdit::SetType(DataType::Str)),
            port("ROOT", PortKind::Input, 0, PortEdit::SetType(DataType::Bool)),
            port("ROOT", PortKind::ScopedVariable, 1, PortEdit::SetDefault(Value::str("x"))),
            port("ROOT", PortKind::ScopedVariable, 1, PortEdit::Rename("w".into())),
            port("ROOT/FIRSTX", PortKind::Input, 1, add("z", Value::None)),
            port("ROOT/FIRSTX", PortKind::Input, 2, add("x", Value::None)),
            port("ROOT/FIRSTX", PortKind::Input, 2, add("z", Value::str("7"))),
            port("ROOT/FIRSTX", PortKind::ScopedVariable, 3, add("z", Value::None)),
            port("ROOT/FIRSTX", PortKind::Input, 0, PortEdit::Remove),
            port("ROOT", PortKind::ScopedVariable, 1, PortEdit::Remove),
            port("ROOT", PortKind::ScopedVariable, 1, PortEdit::Remove),
        ],
        &expect![[r#"
            refused: ROOT, data flow 1: the types do not fit from `a` (str) to `x` (int); change one of the types, or use object
            refused: ROOT, scoped variable 1: the default: "x" is not of the type int; change the default or the type
            refused: ROOT/FIRSTX, input 1: something else has this id; take another id
            refused: ROOT/FIRSTX, input 2: the input 0 has the name `x`, too; rename one of the ports
            refused: ROOT/FIRSTX, scoped variable 3: a state of the kind execution has no scoped variables; change the kind of the state first
            refused: ROOT, scoped variable 1: it does not exist; check the machine again: it may have changed
            hierarchy ROOT
              outcome success
              in a: bool
              start -> FIRSTX
              FIRSTX.success -> SECOND
              SECOND.success -> .success
              execution FIRSTX
                outcome success
                in 2 z: int = "7"
                out 1 y: int
              execution SECOND
                outcome success
                in x: float
        "#]],
    );
}

#[test]
fn transitions_are_drawn_and_moved() {
    let transition = |id, edit| Edit::Transition(at("ROOT"), TransitionId(id), edit);
    let to = |id: &str| Target::State(StateId::new(id));
    let add = |from, to| TransitionEdit::Add { from, to };
    check(
        TWO,
        &[
            transition(3, add(outcome_of("SECOND", -1), to("FIRSTX"))),
            transition(4, add(outcome_of("SECOND", 0), to("FIRSTX"))),
            transition(4, add(Origin::Income, to("FIRSTX"))),
            transition(4, add(outcome_of("SECOND", -1), Target::Outcome(OutcomeId(-1)))),
            transition(2, TransitionEdit::SetTarget(to("NOPEXX"))),
            transition(2, TransitionEdit::SetTarget(to("FIRSTX"))),
            transition(2, TransitionEdit::SetOrigin(outcome_of("FIRSTX", -2))),
            transition(3, TransitionEdit::SetOrigin(outcome_of("FIRSTX", -2))),
            transition(1, TransitionEdit::Remove),
            transition(1, TransitionEdit::Remove),
            Edit::Transition(at("ROOT/FIRSTX"), TransitionId(1), TransitionEdit::Remove),
        ],
        &expect![[r"
            refused: ROOT, transition 3: something else has this id; take another id
            refused: ROOT, transition 4: the transition 3 begins at the outcome `success` of SECOND, too; remove one of the transitions
            refused: ROOT, transition 4: the transition 1 begins at the income, too; remove one of the start transitions
            refused: ROOT, transition 2: it leads to NOPEXX, which does not exist; connect the end with a child or an outcome of the container, or remove the transition
            refused: ROOT, transition 3: the transition 2 begins at the outcome `preempted` of FIRSTX, too; remove one of the transitions
            refused: ROOT, transition 1: it does not exist; check the machine again: it may have changed
            refused: ROOT/FIRSTX, state: it is a state of the kind execution, which has no children; change the kind of the state first
            hierarchy ROOT
              outcome success
              in a: int
              var v: int
              FIRSTX.preempted -> FIRSTX as 2
              SECOND.success -> .success
              SECOND.aborted -> .aborted
              flow .a -> FIRSTX.x
              flow FIRSTX.y -> .v
              execution FIRSTX
                outcome success
                in x: int
                out y: int
              execution SECOND
                outcome success
                in x: float
        "]],
    );
}

#[test]
fn data_flows_are_drawn_and_moved() {
    let flow = |id, edit| Edit::DataFlow(at("ROOT"), DataFlowId(id), edit);
    let add = |from, to| DataFlowEdit::Add { from, to };
    check(
        TWO,
        &[
            flow(3, add(end("ROOT", 0), end("FIRSTX", 0))),
            flow(3, add(end("FIRSTX", 1), end("SECOND", 0))),
            flow(3, add(end("ROOT", 1), end("FIRSTX", 0))),
            flow(3, DataFlowEdit::SetSource(end("ROOT", 0))),
            flow(3, DataFlowEdit::SetTarget(end("ROOT", 1))),
            flow(3, DataFlowEdit::SetSource(end("FIRSTX", 1))),
            flow(1, DataFlowEdit::Remove),
            flow(1, DataFlowEdit::Remove),
        ],
        &expect![[r"
            refused: ROOT, data flow 3: the data flow 1 already connects these ports; remove one of the data flows
            refused: ROOT, data flow 3: the types do not fit from `y` (int) to `x` (float); change one of the types, or use object
            refused: ROOT, data flow 3: the data flow 1 already connects these ports; remove one of the data flows
            refused: ROOT, data flow 3: it leads to the port where it begins; connect the two ends with different ports
            refused: ROOT, data flow 1: it does not exist; check the machine again: it may have changed
            hierarchy ROOT
              outcome success
              in a: int
              var v: int
              start -> FIRSTX
              FIRSTX.success -> SECOND
              SECOND.success -> .success
              flow FIRSTX.y -> .v as 2
              flow FIRSTX.y -> FIRSTX.x
              execution FIRSTX
                outcome success
                in x: int
                out y: int
              execution SECOND
                outcome success
                in x: float
        "]],
    );
}

#[test]
fn libraries_take_runtime_values_and_keep_their_interface() {
    let value = |kind, id, edit| Edit::RuntimeValue(at("ROOT/LIBRAR"), kind, PortId(id), edit);
    check(
        "
        hierarchy ROOT
          library LIBRAR from \"lib/one\"
            content
              execution INNERX
                in x: int = 1
        ",
        &[
            value(PortKind::Input, 0, RuntimeValueEdit::Set(Value::str("five"))),
            value(PortKind::Input, 0, RuntimeValueEdit::SetUsed(true)),
            value(PortKind::Input, 1, RuntimeValueEdit::Set(Value::Int(5))),
            value(PortKind::Input, 0, RuntimeValueEdit::Set(Value::Int(5))),
            value(PortKind::Input, 0, RuntimeValueEdit::SetUsed(false)),
            Edit::Outcome(at("ROOT/LIBRAR"), OutcomeId(0), OutcomeEdit::Add("x".into())),
            Edit::State(at("ROOT/LIBRAR/INNERX"), StateEdit::SetName("x".into())),
            Edit::State(at("ROOT/LIBRAR"), StateEdit::SetName("Ask".into())),
        ],
        &expect![[r#"
            refused: ROOT/LIBRAR, runtime value of input 0: the runtime value of `x`: "five" is not of the type int; change the runtime value or do not use it
            refused: ROOT/LIBRAR, runtime value of input 0: it does not exist; check the machine again: it may have changed
            refused: ROOT/LIBRAR, runtime value of input 1: there is no input with the id 1; remove the runtime value
            refused: ROOT/LIBRAR, state: its outcomes and ports are those of its library; open the library and change it there, or replace the state by a copy of its content
            refused: ROOT/LIBRAR/INNERX, state: it is inside the library state LIBRAR; open the library and change it there, or replace the state by a copy of its content
            hierarchy ROOT
              library LIBRAR "Ask" from "lib/one"
                set in x = 5 unused
                content
                  execution INNERX
                    in x: int = 1
        "#]],
    );
}

#[test]
fn layout_and_header() {
    let layout = |edit| Edit::Layout(at("ROOT"), edit);
    let transition = LayoutElement::Transition(TransitionId(3));
    check(
        "
        hierarchy ROOT
          layout {\"gui\":{\"other\":1}}
        ",
        &[
            layout(LayoutEdit::SetPosition(LayoutElement::State, (1.5, 2.0))),
            layout(LayoutEdit::SetSize(LayoutElement::Name, (10.0, 20.0))),
            layout(LayoutEdit::SetPosition(LayoutElement::Outcome(OutcomeId(-1)), (0.0, 1.0))),
            layout(LayoutEdit::SetWaypoints(transition, vec![(1.0, 2.0), (3.0, 4.0)])),
            Edit::Header(HeaderEdit::SetVersion(Some("2".into()))),
        ],
        &expect![[r#"
            machine
              version "2"
            hierarchy ROOT
              layout {"gui":{"editor_gaphas":{"name":{"size":{"__jsonqualname__":"__builtin__.tuple","items":[10.0,20.0]}},"rel_pos":{"__jsonqualname__":"__builtin__.tuple","items":[1.5,2.0]}},"other":1},"outcome-1":{"gui":{"editor_gaphas":{"rel_pos":{"__jsonqualname__":"__builtin__.tuple","items":[0.0,1.0]}}}},"transition3":{"gui":{"editor_gaphas":{"waypoints":[{"__jsonqualname__":"__builtin__.tuple","items":[1.0,2.0]},{"__jsonqualname__":"__builtin__.tuple","items":[3.0,4.0]}]}}}}
        "#]],
    );
    let machine = notation::parse("execution A").expect("a machine");
    let placed = edited(
        &machine,
        Edit::Layout(at("A"), LayoutEdit::SetWaypoints(transition, vec![(1.0, 2.0)])),
    );
    let document = placed.expect("a machine").root.layout.json();
    assert_eq!(transition.waypoints(&document), [(1.0, 2.0)]);
    assert_eq!(LayoutElement::State.position(&document), None);
}

#[test]
fn a_batch_is_all_or_nothing() {
    let rename = |name: &str| Edit::State(at("ROOT"), StateEdit::SetName(name.into()));
    let port = |edit| Edit::Port(at("ROOT/FIRSTX"), PortKind::Input, PortId(0), edit);
    check(
        TWO,
        &[
            Edit::Batch(vec![rename("Fine"), rename("")]),
            Edit::Batch(vec![
                rename("Main"),
                port(PortEdit::SetType(DataType::Object)),
                port(PortEdit::SetDefault(Value::str("x"))),
            ]),
        ],
        &expect![[r#"
            refused: ROOT, state: the name is empty; give the state a name
            hierarchy ROOT "Main"
              outcome success
              in a: int
              var v: int
              start -> FIRSTX
              FIRSTX.success -> SECOND
              SECOND.success -> .success
              flow .a -> FIRSTX.x
              flow FIRSTX.y -> .v
              execution FIRSTX
                outcome success
                in x: object = "x"
                out y: int
              execution SECOND
                outcome success
                in x: float
        "#]],
    );
}

#[test]
fn what_was_wrong_before_stays_editable() {
    let faulty = "
        hierarchy ROOT
          start -> GONE
          execution FIRSTX
            in x: int = \"five\"
    ";
    let transition = |edit| Edit::Transition(at("ROOT"), TransitionId(1), edit);
    check(
        faulty,
        &[
            Edit::Port(at("ROOT/FIRSTX"), PortKind::Input, PortId(0), PortEdit::Rename("y".into())),
            transition(TransitionEdit::Remove),
            transition(TransitionEdit::Add {
                from: Origin::Income,
                to: Target::State(StateId::new("GONE")),
            }),
        ],
        &expect![[r#"
            refused: ROOT, transition 1: it leads to GONE, which does not exist; connect the end with a child or an outcome of the container, or remove the transition
            hierarchy ROOT
              execution FIRSTX
                in y: int = "five"
        "#]],
    );
}

#[test]
fn what_goes_takes_its_place_on_the_screen_along() {
    let text = "
        hierarchy ROOT
          outcome success
          in x: int
          var v: int
          layout {\"gui\":{},\"transition1\":1,\"transition2\":1,\"data_flow1\":1,\"outcome0\":1,\"scoped_variable1\":1}
          start -> AAAAAA
          AAAAAA.success -> .success
          flow .x -> .v
          execution AAAAAA
            outcome success
    ";
    let outcome = Edit::Outcome(at("ROOT/AAAAAA"), OutcomeId(0), OutcomeEdit::Remove);
    check(
        text,
        &[outcome],
        &expect![[r#"
        hierarchy ROOT
          outcome success
          in x: int
          var v: int
          layout {"data_flow1":1,"gui":{},"outcome0":1,"scoped_variable1":1,"transition1":1}
          start -> AAAAAA
          flow .x -> .v
          execution AAAAAA
    "#]],
    );
    check(
        text,
        &[Edit::State(at("ROOT"), StateEdit::SetKind(KindName::Preemptive))],
        &expect![[r#"
        preemptive ROOT
          outcome success
          in x: int
          var v: int
          layout {"data_flow1":1,"gui":{},"outcome0":1,"scoped_variable1":1}
          flow .x -> .v
          execution AAAAAA
            outcome success
    "#]],
    );
    check(
        text,
        &[Edit::State(at("ROOT"), StateEdit::SetKind(KindName::Execution))],
        &expect![[r#"
        execution ROOT
          outcome success
          in x: int
          layout {"gui":{},"outcome0":1}
    "#]],
    );
}
