//! Steps that go back and forth.

use expect_test::expect;
use rafcon_model::History;
use rafcon_model::edit::{ChildrenEdit, Edit, StateEdit, apply};
use rafcon_model::{BuiltinTypes, Machine, StateId, StatePath};
use rafcon_testkit::notation;

fn rename(path: &str, name: &str) -> Edit {
    Edit::State(StatePath::parse(path), StateEdit::SetName(name.into()))
}

fn shown(machine: &Machine, history: &History) -> String {
    let (undo, redo) = (history.undo_name(), history.redo_name());
    format!("{} (undo {undo:?}, redo {redo:?})\n", machine.root.name)
}

#[test]
fn steps_go_back_and_forth_and_branch() {
    let mut machine = notation::parse("execution ROOT").expect("a machine");
    let mut history = History::default();
    let mut out = vec![shown(&machine, &history)];
    for step in ["one", "two", "<", "<", "<", ">", "three", "<", "<", ">", ">", ">", ""] {
        let done = match step {
            "<" => history.undo(&mut machine, &BuiltinTypes).map(|id| id.is_some()),
            ">" => history.redo(&mut machine, &BuiltinTypes).map(|id| id.is_some()),
            name => {
                let edit = rename("ROOT", name);
                history.apply(&mut machine, name, edit, &BuiltinTypes).map(|_| true)
            }
        };
        out.push(format!("{step}: {done:?} {}", shown(&machine, &history)));
    }
    let parents: Vec<_> = history.steps().map(|(_, step)| step.parent).collect();
    out.push(format!("{parents:?}"));
    expect![[r#"
        ROOT (undo None, redo None)
        one: Ok(true) one (undo Some("one"), redo None)
        two: Ok(true) two (undo Some("two"), redo None)
        <: Ok(true) one (undo Some("one"), redo Some("two"))
        <: Ok(true) ROOT (undo None, redo Some("one"))
        <: Ok(false) ROOT (undo None, redo Some("one"))
        >: Ok(true) one (undo Some("one"), redo Some("two"))
        three: Ok(true) three (undo Some("three"), redo None)
        <: Ok(true) one (undo Some("one"), redo Some("three"))
        <: Ok(true) ROOT (undo None, redo Some("one"))
        >: Ok(true) one (undo Some("one"), redo Some("three"))
        >: Ok(true) three (undo Some("three"), redo None)
        >: Ok(false) three (undo Some("three"), redo None)
        : Err(EditError { path: StatePath([StateId("ROOT")]), part: State, rule: StateName, what: "the name is empty" }) three (undo Some("three"), redo None)
        [None, Some(StepId(0)), Some(StepId(0))]"#]].assert_eq(&out.concat());
}

/// Someone else removed the state: the step stays, and can be undone when the state is back.
#[test]
fn an_undo_that_no_longer_fits_is_refused() {
    let mut machine = notation::parse("hierarchy ROOT\n  execution AAAAAA").expect("a machine");
    let mut history = History::default();
    let edit = rename("ROOT/AAAAAA", "New");
    history.apply(&mut machine, "Rename", edit, &BuiltinTypes).expect("applied");
    let remove = ChildrenEdit::Remove(StateId::new("AAAAAA"));
    let remove = Edit::Children(StatePath::parse("ROOT"), remove);
    let back = apply(&mut machine, remove, &BuiltinTypes).expect("applied");
    let refused = history.undo(&mut machine, &BuiltinTypes).expect_err("refused");
    expect![
        "ROOT/AAAAAA, state: there is no such state; check the machine again: it may have changed"
    ]
    .assert_eq(&refused.to_string());
    apply(&mut machine, back, &BuiltinTypes).expect("applied");
    history.undo(&mut machine, &BuiltinTypes).expect("undone");
    assert_eq!(history.undo_name(), None);
}
