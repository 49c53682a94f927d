//! What `rafcon check` finds in scripts without running them.

use crate::harness::Place;
use expect_test::{Expect, expect};

/// A script of a state with the outcomes `success` (0) and `failure` (1) in, a line for each finding out.
fn check(script: &str, expect: &Expect) {
    let answer = Place::with_script(script).call("check MACHINE --format json");
    let finding = |line: &str| {
        let finding: serde_json::Value = serde_json::from_str(line).unwrap();
        let text = |key: &str| finding[key].as_str().unwrap().to_owned();
        format!("{} {}: {}\n", text("level"), text("part"), text("what"))
    };
    let findings: String = answer.stdout.lines().map(finding).collect();
    expect.assert_eq(&format!("{findings}{}", answer.stderr));
}

fn body(text: &str) -> String {
    format!("def execute(self, inputs, outputs, gvm):\n    {text}")
}

#[test]
fn a_script_is_read_and_never_run() {
    check(
        "import os\nos._exit(9)\n\ndef execute(self, inputs, outputs, gvm):\n    return 0",
        &expect![""],
    );
}

#[test]
fn names_numbers_and_choices_are_outcomes() {
    check(&body("return 'success' if inputs else -1"), &expect![""]);
    check(
        &body("return 'sucess' if inputs else -3"),
        &expect![[r#"
        error script.py:2: `execute` returns "sucess", which is not an outcome of the state
        error script.py:2: `execute` returns -3, which is not an outcome of the state
    "#]],
    );
    check(
        &body("return inputs['outcome']"),
        &expect![[r#"
        error script.py:2: `execute` reads the input "outcome", but the state has no such input and aborts
    "#]],
    );
    check(&body("return True"), &expect![""]);
}

#[test]
fn returns_of_inner_functions_do_not_count() {
    check(&body("f = lambda: 'x'\n    def g():\n        return 'y'\n    return g()"), &expect![""]);
}

#[test]
fn no_return_is_an_error_unless_it_raises() {
    check(
        &body("outputs['x'] = 1"),
        &expect![[r#"
            error script.py:1: `execute` never returns an outcome, so the state aborts
            error script.py:2: `execute` writes the output "x", but the state has no such output, and the value is lost
        "#]],
    );
    check(
        &body("raise ValueError"),
        &expect![[r"
        note script.py:1: `execute` never returns an outcome, so the state aborts
    "]],
    );
}

#[test]
fn execute_may_come_from_anywhere() {
    check("from somewhere import *", &expect![""]);
    check("from somewhere import run as execute", &expect![""]);
    check("if 1:\n    def execute(self, inputs, outputs, gvm):\n        return 7", &expect![""]);
    check("execute = lambda *four: 0", &expect![""]);
    check(
        "def other(self, inputs, outputs, gvm):\n    execute = 1",
        &expect![[r"
        error script.py: the script has no function `execute`
    "]],
    );
}

#[test]
fn the_arguments_are_counted() {
    check("def execute(*four):\n    return 0", &expect![""]);
    check("def execute(self, inputs, outputs, gvm, more=1):\n    return 0", &expect![""]);
    check(
        "def execute(self, inputs, outputs):\n    return 0",
        &expect![[r"
        error script.py:1: `execute` cannot be called with four arguments
    "]],
    );
    check(
        "def execute(self, inputs, outputs, gvm, *, more):\n    return 0",
        &expect![[r"
        error script.py:1: `execute` cannot be called with four arguments
    "]],
    );
}

#[test]
fn what_only_compiling_finds() {
    check(
        "return 1\n\ndef execute(self, inputs, outputs, gvm):\n    return 0",
        &expect![[r"
        error script.py:1: the script does not parse: 'return' outside function
    "]],
    );
    check(
        &body("nonlocal x"),
        &expect![[r"
        error script.py:2: the script does not parse: no binding for nonlocal 'x' found
    "]],
    );
}
