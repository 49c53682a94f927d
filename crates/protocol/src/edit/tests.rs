//! Edits survive the way to the wire and back. Invalid edits are refused with the field.

use super::Edit;
use crate::document::tests::{START, machine};
use expect_test::{Expect, expect};
use proptest::prelude::*;
use rafcon_model::edit::{
    ChildrenEdit, Edit as Model, HeaderEdit, LayoutEdit, LayoutElement, apply, copy,
};
use rafcon_model::{BuiltinTypes, Layout, PortId, PortKind, StateId, StatePath};
use rafcon_testkit::edits::{Dice, edit};

fn there_and_back(edit: &Model) -> (String, Model) {
    let wire = Edit::of(edit).expect("an edit to send");
    let text = serde_json::to_string(&wire).expect("JSON");
    let read: Edit = serde_json::from_str(&text).expect("an edit");
    assert_eq!(read, wire);
    (text, Model::try_from(&read).expect("an edit of the model"))
}

fn check(edit: &Model, expect: &Expect) {
    let (text, read) = there_and_back(edit);
    assert_eq!(read, *edit);
    expect.assert_eq(&text);
}

fn root() -> StatePath {
    StatePath::parse("ROOT")
}

#[test]
fn edits_read_well() {
    let place = LayoutElement::Port(PortKind::Input, PortId(0));
    check(
        &Model::Layout(root(), LayoutEdit::SetPosition(place, (1.0, 2.5))),
        &expect![[
            r#"{"edit":"set_position","path":"ROOT","element":{"input":0},"position":[1.0,2.5]}"#
        ]],
    );
    check(
        &Model::Layout(root(), LayoutEdit::Set(Layout::default())),
        &expect![[r#"{"edit":"set_layout","path":"ROOT","layout":null}"#]],
    );
    check(
        &Model::Header(HeaderEdit::SetVersion(Some("2".into()))),
        &expect![[r#"{"edit":"set_version","version":"2"}"#]],
    );
    let machine = machine(START);
    let states = ["AAAAAA", "BBBBBB"].map(StateId::new);
    let selection = copy(&machine.root, &states, &[PortId(2)]);
    let paste = ChildrenEdit::Paste { selection, ids: vec![StateId::new("NEWAAA")] };
    check(
        &Model::Children(root(), paste),
        &expect![[
            r#"{"edit":"paste","path":"ROOT","selection":{"container":"ROOT","states":[{"path":"AAAAAA","name":"AAAAAA","kind":"execution","script":"x = 1","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"},{"id":0,"name":"success"}],"inputs":[{"id":0,"name":"x","data_type":"int"}],"outputs":[{"id":1,"name":"y","data_type":"int"}]},{"path":"BBBBBB","name":"BBBBBB","kind":"barrier","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"},{"id":0,"name":"success"}],"transitions":[{"id":1,"from_state":"DDDDDD","from_outcome":0,"to_state":"unique_decider_state_id"}]},{"path":"BBBBBB/DDDDDD","name":"DDDDDD","kind":"execution","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"},{"id":0,"name":"success"}]},{"path":"BBBBBB/unique_decider_state_id","name":"unique_decider_state_id","kind":"decider","outcomes":[{"id":-2,"name":"preempted"},{"id":-1,"name":"aborted"},{"id":0,"name":"success"}]}],"scoped_variables":[{"id":2,"name":"v","data_type":"int"}],"transitions":[{"id":2,"from_state":"AAAAAA","from_outcome":0,"to_state":"BBBBBB"}],"data_flows":[{"id":2,"from_state":"AAAAAA","from_port":1,"to_state":"ROOT","to_port":2}]},"ids":["NEWAAA"]}"#
        ]],
    );
}

#[test]
fn what_is_no_edit_is_refused_with_the_field() {
    let refused = |text: &str| match serde_json::from_str::<Edit>(text) {
        Ok(edit) => Model::try_from(&edit).expect_err("refused").to_string() + "\n",
        Err(error) => error.to_string() + "\n",
    };
    let batch = |inner: &str| format!(r#"{{"edit":"batch","edits":[{inner}]}}"#);
    let nested = |levels: u8| {
        (0..levels).fold(r#"{"edit":"set_version"}"#.to_owned(), |inner, _| batch(&inner))
    };
    let most = serde_json::from_str::<Edit>(&nested(4)).expect("an edit");
    assert!(Model::try_from(&most).is_ok());
    expect![[r"
        unknown variant `explode`, expected one of `set_name`, `set_id`, `set_description`, `set_semantic_data`, `set_script`, `set_kind`, `add_outcome`, `rename_outcome`, `remove_outcome`, `add_port`, `rename_port`, `set_port_type`, `set_port_default`, `remove_port`, `add_transition`, `set_transition_origin`, `set_transition_target`, `remove_transition`, `add_data_flow`, `set_data_flow_source`, `set_data_flow_target`, `remove_data_flow`, `set_runtime_value`, `use_runtime_value`, `remove_runtime_value`, `set_position`, `set_size`, `set_waypoints`, `set_layout`, `add_state`, `remove_state`, `set_start`, `group`, `ungroup`, `substitute_state`, `move_states`, `paste`, `set_version`, `set_machine_layout`, `set_header`, `batch` at line 1 column 17
        missing field `name`
        unknown field `nam`, expected `path` or `name`
        `default` of the edit: `__int__`: x is no whole number
        `states` of the edit: an empty list, path: expected one state and its descendants, each after its parent
        `states` of the edit: X, library: a library state needs the path and name of its library
        a layout is an object
        `edits` of the edit: batches are nested deeper than 4 levels; join them
    "]].assert_eq(
        &[
            refused(r#"{"edit":"explode","path":"ROOT"}"#),
            refused(r#"{"edit":"set_name","path":"ROOT"}"#),
            refused(r#"{"edit":"set_name","path":"ROOT","name":"x","nam":"y"}"#),
            refused(r#"{"edit":"set_port_default","path":"ROOT","list":"input","port":0,"default":{"__int__":"x"}}"#),
            refused(r#"{"edit":"add_state","path":"ROOT","states":[]}"#),
            refused(r#"{"edit":"add_state","path":"ROOT","states":[{"path":"X","name":"X","kind":"library"}]}"#),
            refused(r#"{"edit":"set_layout","path":"ROOT","layout":[]}"#),
            refused(&nested(5)),
        ]
        .concat(),
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn any_edit_comes_back_as_it_was(numbers in proptest::collection::vec(any::<u16>(), 0..600)) {
        let mut machine = machine(START);
        let mut dice = Dice::new(numbers);
        while !dice.is_empty() {
            let edit = edit(&machine, &mut dice);
            prop_assert_eq!(&there_and_back(&edit).1, &edit);
            if let Ok(back) = apply(&mut machine, edit, &BuiltinTypes) {
                prop_assert_eq!(Edit::of(&back), None);
            }
        }
    }
}
