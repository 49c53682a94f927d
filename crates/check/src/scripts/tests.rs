//! Scripts as text in, findings and what mends them as text out; Python reads them.

use crate::{Facts, SCRIPT_READER, ScriptFacts, of_scripts, read_facts, request, scripts};
use expect_test::{Expect, expect};
use rafcon_model::Machine;
use rafcon_testkit::notation;
use std::io::Write as _;
use std::process::{Command, Stdio};

fn facts(texts: &[&str]) -> Vec<Facts> {
    let mut python = Command::new("python3");
    python.args(["-I", "-c", SCRIPT_READER]).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = python.spawn().unwrap();
    child.stdin.take().unwrap().write_all(&request(texts).unwrap()).unwrap();
    read_facts(&child.wait_with_output().unwrap().stdout, texts.len()).unwrap()
}

fn found(machine: &Machine) -> String {
    let texts = scripts(machine);
    let facts = facts(&texts);
    let facts: ScriptFacts<'_> = texts.into_iter().zip(&facts).collect();
    let lines = of_scripts(machine, &facts).into_iter().map(|finding| {
        let repairs = finding.repairs.iter().map(|repair| format!("    {}\n", repair.name));
        format!(
            "{:?} {} {finding}\n{}",
            finding.severity,
            finding.rule,
            repairs.collect::<String>()
        )
    });
    lines.collect::<Vec<_>>().concat()
}

/// A state with the input `x`, the output `y`, the outcome `done` and this body of `execute`.
fn check(body: &str, expect: &Expect) {
    let lines = body.lines().map(str::trim_end).collect::<Vec<_>>().join("\n      ");
    let machine = format!(
        "execution ROOT\n  outcome done\n  in x: int\n  out y: int\n  script |\n    def execute(self, inputs, outputs, gvm):\n      {lines}"
    );
    expect.assert_eq(&found(&notation::parse(&machine).unwrap()));
}

#[test]
fn an_outcome_that_does_not_exist_can_be_added() {
    check(
        "return 'nope' if inputs['x'] else 'done'",
        &expect![[r#"
            Error ScriptOutcome ROOT, script.py:2: `execute` returns "nope", which is not an outcome of the state; return one of "done", or add the outcome
                Add the outcome "nope"
        "#]],
    );
}

#[test]
fn ports_that_do_not_exist_can_be_added() {
    check(
        "outputs['nope'] = inputs['missing'] + inputs['x']\noutputs['y'] = 1\nreturn 'done'",
        &expect![[r#"
            Error ScriptPort ROOT, script.py:2: `execute` reads the input "missing", but the state has no such input and aborts; use one of "x", or add the input
                Add the input "missing"
            Error ScriptPort ROOT, script.py:2: `execute` writes the output "nope", but the state has no such output, and the value is lost; use one of "y", or add the output
                Add the output "nope"
        "#]],
    );
}

#[test]
fn what_a_script_looks_after_itself_is_no_fault() {
    for body in [
        "if 'missing' in inputs:\n    inputs['missing']\nreturn 'done'",
        "try:\n    inputs['missing']\nexcept KeyError:\n    pass\nreturn 'done'",
        "inputs['missing'] = 1\ninputs['missing']\nreturn 'done'",
        "inputs = {'missing': 1}\ninputs['missing']\nreturn 'done'",
        "inputs.get('missing')\nname = 'z'\ninputs[name]\nreturn 'done'",
        "gvm.get_variable('speed', False, 1)\nreturn 'done'",
        "gvm.get_variable('speed', default=1)\nreturn 'done'",
        "if gvm.variable_exist('speed'):\n    gvm.get_variable('speed')\nreturn 'done'",
        "gvm.set_variable(inputs['x'], 1)\ngvm.get_variable('speed')\nreturn 'done'",
    ] {
        check(body, &expect![""]);
    }
}

#[test]
fn a_global_variable_that_nothing_sets_is_noted() {
    check(
        "gvm.set_variable('mode', 1)\ngvm.get_variable('mode')\ngvm.get_variable('speed')\nreturn 'done'",
        &expect![[r#"
            Note GlobalNeverSet ROOT, script.py:4: no script of the machine sets the global variable "speed", which is read here; set it in a script, or set it at the start of the machine
        "#]],
    );
}

#[test]
fn a_script_that_was_not_read_is_not_called_right() {
    let machine = notation::parse("execution ROOT\n  script |\n    x").unwrap();
    let lines: Vec<_> =
        of_scripts(&machine, &ScriptFacts::new()).iter().map(ToString::to_string).collect();
    expect![[r#"
        [
            ", scripts: 1 script could not be checked; make sure that Python starts, and check again",
        ]
    "#]]
    .assert_debug_eq(&lines);
}
