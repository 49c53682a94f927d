//! Any machine and any edits: documents hold everything, and changes lead from one to the next.

use super::{Document, Mirror, changes, leave};
use expect_test::{Expect, expect};
use proptest::prelude::*;
use rafcon_model::edit::apply;
use rafcon_model::{BuiltinTypes, Machine, State, StateId};
use rafcon_testkit::edits::{Dice, edit};
use rafcon_testkit::notation;
use std::sync::Arc;

pub(crate) const START: &str = "
    hierarchy ROOT
      outcome success
      in a: int
      out b: int
      var v: int
      start -> AAAAAA
      AAAAAA.success -> BBBBBB ; BBBBBB.success -> .success
      flow .a -> AAAAAA.x ; AAAAAA.y -> .v ; .v -> CCCCCC.x
      execution AAAAAA
        outcome success
        in x: int
        out y: int
        script \"x = 1\"
      barrier BBBBBB
        outcome success
        DDDDDD.success -> unique_decider_state_id
        execution DDDDDD
          outcome success
        decider unique_decider_state_id
          outcome success
      hierarchy CCCCCC
        outcome success
        in x: int
        var w: int
        start -> EEEEEE
        flow .x -> .w
        library EEEEEE from \"lib/one\"
          missing \"no folder\"
          in q: object
          set in 0 = 4
";

pub(crate) fn machine(text: &str) -> Machine {
    notation::parse(text).expect("a machine in the notation")
}

fn check(old: &str, new: &str, expect: &Expect) {
    let (old, new) = (machine(old), machine(new));
    let changes = changes(&old, &new);
    let lines = changes.iter().map(|change| serde_json::to_string(change).expect("JSON") + "\n");
    expect.assert_eq(&lines.collect::<String>());
    let mut mirror = Mirror::new(Document::of(&old));
    for change in changes {
        mirror.apply(change);
    }
    assert_eq!(mirror.document(), Document::of(&new));
}

#[test]
fn each_change_is_as_small_as_it_can_be() {
    check(
        "
        hierarchy ROOT
          start -> AAAAAA
          flow .a -> AAAAAA.x
          in a: int
          execution AAAAAA
            in x: int
          execution BBBBBB
        ",
        "
        hierarchy ROOT
          start -> AAAAAA ; AAAAAA.-1 -> CCCCCC
          in a: int
          execution AAAAAA \"Another\"
            in x: int
          hierarchy CCCCCC
            start -> DDDDDD
            execution DDDDDD
        ",
        &expect![[r#"
            {"change":"transition","path":"ROOT","id":2,"transition":{"id":2,"from_state":"AAAAAA","from_outcome":-1,"to_state":"CCCCCC"}}
            {"change":"data_flow","path":"ROOT","id":1}
            {"change":"state","state":{"path":"ROOT/AAAAAA","name":"Another","kind":"execution","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"}],"inputs":[{"id":0,"name":"x","data_type":"int"}]}}
            {"change":"state_removed","path":"ROOT/BBBBBB"}
            {"change":"state","state":{"path":"ROOT/CCCCCC","name":"CCCCCC","kind":"hierarchy","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"}]}}
            {"change":"transition","path":"ROOT/CCCCCC","id":1,"transition":{"id":1,"to_state":"DDDDDD"}}
            {"change":"state","state":{"path":"ROOT/CCCCCC/DDDDDD","name":"DDDDDD","kind":"execution","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"}]}}
        "#]],
    );
}

#[test]
fn a_document_says_everything_and_leaves_out_what_is_empty() {
    let document = Document::of(&machine(START));
    let lines = document.states.iter().map(|s| serde_json::to_string(s).expect("JSON") + "\n");
    expect![[r#"
        {"path":"ROOT","name":"ROOT","kind":"hierarchy","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"},{"id":0,"name":"success"}],"inputs":[{"id":0,"name":"a","data_type":"int"}],"outputs":[{"id":1,"name":"b","data_type":"int"}],"scoped_variables":[{"id":2,"name":"v","data_type":"int"}],"transitions":[{"id":1,"to_state":"AAAAAA"},{"id":2,"from_state":"AAAAAA","from_outcome":0,"to_state":"BBBBBB"},{"id":3,"from_state":"BBBBBB","from_outcome":0,"to_state":"ROOT","to_outcome":0}],"data_flows":[{"id":1,"from_state":"ROOT","from_port":0,"to_state":"AAAAAA","to_port":0},{"id":2,"from_state":"AAAAAA","from_port":1,"to_state":"ROOT","to_port":2},{"id":3,"from_state":"ROOT","from_port":2,"to_state":"CCCCCC","to_port":0}]}
        {"path":"ROOT/AAAAAA","name":"AAAAAA","kind":"execution","script":"x = 1","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"},{"id":0,"name":"success"}],"inputs":[{"id":0,"name":"x","data_type":"int"}],"outputs":[{"id":1,"name":"y","data_type":"int"}]}
        {"path":"ROOT/BBBBBB","name":"BBBBBB","kind":"barrier","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"},{"id":0,"name":"success"}],"transitions":[{"id":1,"from_state":"DDDDDD","from_outcome":0,"to_state":"unique_decider_state_id"}]}
        {"path":"ROOT/BBBBBB/DDDDDD","name":"DDDDDD","kind":"execution","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"},{"id":0,"name":"success"}]}
        {"path":"ROOT/BBBBBB/unique_decider_state_id","name":"unique_decider_state_id","kind":"decider","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"},{"id":0,"name":"success"}]}
        {"path":"ROOT/CCCCCC","name":"CCCCCC","kind":"hierarchy","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"},{"id":0,"name":"success"}],"inputs":[{"id":0,"name":"x","data_type":"int"}],"scoped_variables":[{"id":1,"name":"w","data_type":"int"}],"transitions":[{"id":1,"to_state":"EEEEEE"}],"data_flows":[{"id":1,"from_state":"CCCCCC","from_port":0,"to_state":"CCCCCC","to_port":1}]}
        {"path":"ROOT/CCCCCC/EEEEEE","name":"EEEEEE","kind":"library","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"}],"inputs":[{"id":0,"name":"q","data_type":"object"}],"library":{"path":"lib","name":"one","inputs":[{"port":0,"value":4,"used":true}],"missing":"no folder"}}
    "#]].assert_eq(&lines.collect::<String>());
    let text = serde_json::to_string(&document).expect("JSON");
    assert_eq!(serde_json::from_str::<Document>(&text).expect("a document"), document);
    assert_eq!(document.read(&mut leave), Ok(machine(START)));
}

#[test]
fn what_is_no_machine_is_refused_with_state_and_field() {
    let refused = |change: &dyn Fn(&mut Document)| {
        let mut document = Document::of(&machine(START));
        change(&mut document);
        document.read(&mut leave).expect_err("refused").to_string()
    };
    expect![[r"
        an empty list, path: expected one state and its descendants, each after its parent
        GONE/AAAAAA, path: its parent GONE does not precede it
        ROOT/AAAAAA, path: it occurs twice
        ROOT/BBBBBB/DDDDDD, path: its parent ROOT/BBBBBB does not precede it
        ROOT, script: a state of the kind hierarchy has none; leave it out
        ROOT, inputs, port 0, default: `__int__`: x is no whole number
        ROOT/CCCCCC/EEEEEE, library: a library state needs the path and name of its library"]]
    .assert_eq(
        &[
            refused(&|d| d.states.clear()),
            refused(&|d| d.states[1].path = "GONE/AAAAAA".into()),
            refused(&|d| d.states[2].path = "ROOT/AAAAAA".into()),
            refused(&|d| d.states[2].path = "ROOT/AAAAAA/BBBBBB".into()),
            refused(&|d| d.states[0].script = Some("x".into())),
            refused(&|d| d.states[0].inputs[0].default = serde_json::json!({"__int__": "x"})),
            refused(&|d| d.states[6].library = None),
        ]
        .join("\n"),
    );
}

#[test]
fn what_is_nested_too_deep_is_refused() {
    let mut document = Document::of(&machine("hierarchy ROOT"));
    for level in 0..1100 {
        let mut inner = document.states[level].clone();
        inner.path += "/X";
        document.states.push(inner);
    }
    let refused = document.read(&mut leave).expect_err("refused");
    assert_eq!(refused.what, "it is nested deeper than 1024 levels; take levels out");
}

/// Ids that a path cannot express are stored beside it, and deep machines are safe.
#[test]
fn faulty_ids_and_deep_machines_come_back() {
    let mut deep = machine("hierarchy ROOT\n  execution AAAAAA");
    for level in 0..1000 {
        let id =
            if level % 2 == 0 { StateId::new("a/b") } else { StateId::new(format!("S{level}")) };
        let inner = Arc::new(State { id: id.clone(), ..(*deep.root).clone() });
        let mut root = (*machine("hierarchy ROOT").root).clone();
        root.container_mut().expect("a container").states.insert(id, inner);
        deep.root = Arc::new(root);
    }
    let document = Document::of(&deep);
    assert_eq!(document.read(&mut leave), Ok(deep));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn changes_lead_from_any_machine_to_the_next(numbers in proptest::collection::vec(any::<u16>(), 0..600)) {
        let mut machine = machine(START);
        let mut mirror = Mirror::new(Document::of(&machine));
        let mut dice = Dice::new(numbers);
        while !dice.is_empty() {
            let before = machine.clone();
            let edit = edit(&machine, &mut dice);
            if apply(&mut machine, edit, &BuiltinTypes).is_ok() {
                for change in changes(&before, &machine) {
                    let text = serde_json::to_string(&change).expect("JSON");
                    mirror.apply(serde_json::from_str(&text).expect("a change"));
                }
            }
        }
        let document = Document::of(&machine);
        prop_assert_eq!(mirror.document(), document.clone());
        prop_assert_eq!(document.read(&mut leave), Ok(machine));
    }
}
