//! Keys in, wishes and lines out.

use super::{Console, Key, UserAction};
use crate::view::Paint;
use expect_test::{Expect, expect};
use rafcon_protocol::{ActiveState, Form, HeldBy, Hold, Phase, Question, RunStatus, Snapshot};

fn state(path: &str, phase: Phase, branch: &str, next: Option<&str>) -> ActiveState {
    let hold = |next: &str| Hold { next: Some(next.to_owned()), by: HeldBy::Step };
    ActiveState {
        path: path.to_owned(),
        name: path.rsplit('/').next().unwrap().to_owned(),
        phase,
        since_ms: 0,
        branch: branch.to_owned(),
        detail: None,
        held: next.map(hold).into_iter().collect(),
    }
}

fn snapshot(form: Option<Form>) -> Snapshot {
    let question = |form| Question {
        id: 7,
        path: "R/A/X".to_owned(),
        message: "Is the arm free?".to_owned(),
        form,
        timeout_ms: None,
        lost_link_ms: None,
        default: None,
    };
    Snapshot {
        status: RunStatus::Stepping,
        active: vec![
            state("R", Phase::Running, "", None),
            state("R/A", Phase::Held, "R/A", Some("R/A/X")),
            state("R/B", Phase::Held, "R/B", Some("R/B/Y")),
        ],
        states_run: 3,
        elapsed_ms: 0,
        sequence: 9,
        disk_safe: 9,
        journal_problem: None,
        breakpoints: Vec::new(),
        questions: form.map(question).into_iter().collect(),
    }
}

fn key(word: &str) -> Vec<Key> {
    match word {
        "enter" => vec![Key::Enter],
        "esc" => vec![Key::Escape],
        "up" => vec![Key::Up],
        "down" => vec![Key::Down],
        "rub" => vec![Key::Backspace],
        "space" => vec![Key::Char(' ')],
        text => text.chars().map(Key::Char).collect(),
    }
}

/// Presses keys, words apart, and shows what each wish was, and the lines at the end.
fn check(form: Option<Form>, keys: &str, expect: &Expect) {
    let (snapshot, mut console) = (snapshot(form), Console::new(true));
    let order = ["R/A", "R/B"];
    let mut said = Vec::new();
    for key in keys.split(' ').flat_map(key) {
        match console.key(key, &snapshot, &order) {
            None => {}
            Some(UserAction::Send(command)) => {
                said.push(serde_json::to_string(&command).unwrap());
            }
            Some(wish) => said.push(format!("{wish:?}")),
        }
    }
    let paint = Paint { colour: false, unicode: true };
    let lines = console.lines(&snapshot);
    said.extend(lines.iter().map(|line| format!("| {}", line.render(paint))));
    expect.assert_eq(&(said.join("\n") + "\n"));
}

#[test]
fn one_key_is_one_command() {
    check(
        None,
        "snob space S",
        &expect![[r#"
            {"type":"step_into","branch":null}
            {"type":"step_over","branch":null}
            {"type":"step_out","branch":null}
            {"type":"step_back","branch":null}
            {"type":"resume","branch":null}
            {"type":"step_into","branch":"R/B"}
            | s step   n over   o out   b back   c continue   i data   ? keys   q leave
        "#]],
    );
}

#[test]
fn the_arrows_select_the_state_that_keys_are_about() {
    check(
        None,
        "up up S i esc",
        &expect![[r#"
            {"type":"step_into","branch":"R/A"}
            Inspect("R/A")
            | s step   n over   o out   b back   c continue   i data   ? keys   q leave
        "#]],
    );
}

#[test]
fn a_breakpoint_is_written() {
    check(
        None,
        "k space if space n>1 enter",
        &expect![[r#"
            {"type":"set_breakpoint","breakpoint":{"id":1,"path":"R/B/Y","when":"before","condition":"n>1","hit_count":0,"scope":"branch","unattended":"hold","enabled":true}}
            | s step   n over   o out   b back   c continue   i data   ? keys   q leave
        "#]],
    );
    check(
        None,
        "up k space after enter",
        &expect![[r#"
            {"type":"set_breakpoint","breakpoint":{"id":1,"path":"R/A/X","when":"after","condition":null,"hit_count":0,"scope":"branch","unattended":"hold","enabled":true}}
            | s step   n over   o out   b back   c continue   i data   ? keys   q leave
        "#]],
    );
    check(
        None,
        "K x enter",
        &expect![[r"
        | write the number of a breakpoint
        | remove breakpoint: x_   Enter accepts, Escape cancels
    "]],
    );
}

#[test]
fn an_outcome_is_forced_on_what_is_next() {
    check(
        None,
        "up f -1 enter",
        &expect![[r#"
            {"type":"force_outcome","path":"R/A/X","outcome":-1}
            | s step   n over   o out   b back   c continue   i data   ? keys   q leave
        "#]],
    );
}

#[test]
fn buttons_are_chosen_by_number() {
    let form = Form::Buttons { buttons: vec!["Yes".to_owned(), "No".to_owned()] };
    check(
        Some(form.clone()),
        "a",
        &expect![[r"
        | Is the arm free?
        | 1 Yes   2 No   Escape leaves the question open
    "]],
    );
    check(
        Some(form),
        "a 3 2",
        &expect![[r#"
            {"type":"answer_question","question":7,"value":{"button":1}}
            | ? Is the arm free?
            | a answer   s step   n over   o out   b back   c continue   i data   ? keys   q leave
        "#]],
    );
}

#[test]
fn numbers_and_boxes_are_answered() {
    let ok = || vec!["OK".to_owned()];
    let number =
        Form::Number { buttons: ok(), minimum: None, maximum: None, initial: None, whole: true };
    check(
        Some(number),
        "a 4x enter rub 2 enter",
        &expect![[r#"
            {"type":"answer_question","question":7,"value":{"button":0,"number":42}}
            | ? Is the arm free?
            | a answer   s step   n over   o out   b back   c continue   i data   ? keys   q leave
        "#]],
    );
    let boxes = vec!["left".to_owned(), "right".to_owned()];
    let buttons = vec!["Take".to_owned(), "Leave".to_owned()];
    check(
        Some(Form::Checks { buttons, boxes, initial: vec![] }),
        "a 2 enter 1",
        &expect![[r#"
            {"type":"answer_question","question":7,"value":{"button":0,"checked":[false,true]}}
            | ? Is the arm free?
            | a answer   s step   n over   o out   b back   c continue   i data   ? keys   q leave
        "#]],
    );
}
