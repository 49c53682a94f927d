//! The commands that do not run machines.

use crate::harness::Place;
use expect_test::{Expect, expect};
use std::io::Read as _;
use std::process::Stdio;

const MACHINE: &str = r#"
    hierarchy ROOT "Tea"
      outcome success
      outcome cold
      in cups: int = 2
      start -> BOILED
      BOILED.success -> BREWED ; BREWED.success -> .success ; BREWED.aborted -> .cold
      flow .cups -> BREWED.cups
      execution BOILED "Boil water"
        outcome success
        outcome "no water"
        script |
          def execute(self, inputs, outputs, gvm):
              if gvm.get_variable("dry"):
                  return "no watr"
              return 5
      barrier BREWED "Brew"
        outcome success
        in cups: int
        POURED.success -> unique_decider_state_id ; unique_decider_state_id.success -> .success
        execution POURED "Pour"
          outcome success
          script |
            async def execute(self, inputs, outputs, gvm):
                return "success"
        decider unique_decider_state_id "Decide"
          outcome success
          script |
            def execute(self, inputs):
                pass
"#;

fn check(words: &str, expect: &Expect) {
    let answer = Place::with(MACHINE).call(words);
    let code = answer.code.unwrap();
    expect.assert_eq(&format!("{code}\n{}{}", answer.stdout, answer.stderr));
}

#[test]
fn check_names_what_where_and_the_way_out() {
    check(
        "check MACHINE",
        &expect![[r#"
            1
            note: Tea/Boil water: outcome 1: no transition begins at the outcome `no water`
                connect the outcome if it can happen
                at ROOT/BOILED
            error: Tea/Boil water: script.py:3: `execute` returns "no watr", which is not an outcome of the state
                return one of "success", "no water", or add the outcome
                at ROOT/BOILED
            error: Tea/Boil water: script.py:4: `execute` returns 5, which is not an outcome of the state
                return one of "success", "no water", or add the outcome
                at ROOT/BOILED
            error: Tea/Brew/Pour: script.py:1: `execute` is a coroutine
                write `def execute`, and run coroutines with `asyncio.run(…)` inside; the state aborts until then
                at ROOT/BREWED/POURED
            error: Tea/Brew/Decide: script.py:1: `execute` cannot be called with four arguments
                write `def execute(self, inputs, outputs, gvm):`
                at ROOT/BREWED/unique_decider_state_id
            error: Tea/Brew/Decide: script.py:1: `execute` never returns an outcome, so the state aborts
                return one of "success"
                at ROOT/BREWED/unique_decider_state_id
            note: Tea/Boil water: script.py:2: no script of the machine sets the global variable "dry", which is read here
                set it in a script, or set it at the start of the machine
                at ROOT/BOILED
            Tea: 5 states, 5 errors, 2 notes
        "#]],
    );
}

#[test]
fn check_for_programs() {
    check(
        "check MACHINE --format json",
        &expect![[r#"
            1
            {"level":"note","path":"ROOT/BOILED","name":"Tea/Boil water","part":"outcome 1","file":"","what":"no transition begins at the outcome `no water`","remedy":"connect the outcome if it can happen"}
            {"level":"error","path":"ROOT/BOILED","name":"Tea/Boil water","part":"script.py:3","file":"","what":"`execute` returns \"no watr\", which is not an outcome of the state","remedy":"return one of \"success\", \"no water\", or add the outcome"}
            {"level":"error","path":"ROOT/BOILED","name":"Tea/Boil water","part":"script.py:4","file":"","what":"`execute` returns 5, which is not an outcome of the state","remedy":"return one of \"success\", \"no water\", or add the outcome"}
            {"level":"error","path":"ROOT/BREWED/POURED","name":"Tea/Brew/Pour","part":"script.py:1","file":"","what":"`execute` is a coroutine","remedy":"write `def execute`, and run coroutines with `asyncio.run(…)` inside; the state aborts until then"}
            {"level":"error","path":"ROOT/BREWED/unique_decider_state_id","name":"Tea/Brew/Decide","part":"script.py:1","file":"","what":"`execute` cannot be called with four arguments","remedy":"write `def execute(self, inputs, outputs, gvm):`"}
            {"level":"error","path":"ROOT/BREWED/unique_decider_state_id","name":"Tea/Brew/Decide","part":"script.py:1","file":"","what":"`execute` never returns an outcome, so the state aborts","remedy":"return one of \"success\""}
            {"level":"note","path":"ROOT/BOILED","name":"Tea/Boil water","part":"script.py:2","file":"","what":"no script of the machine sets the global variable \"dry\", which is read here","remedy":"set it in a script, or set it at the start of the machine"}
        "#]],
    );
}

#[test]
fn a_python_that_is_not_there() {
    check(
        "check MACHINE --python /nowhere/python",
        &expect![[r"
        1
        error: cannot start the Python interpreter `/nowhere/python`: --python or RAFCON_PYTHON must name a Python 3.9 or newer
          because: No such file or directory (os error 2)
    "]],
    );
    check(
        "run MACHINE --python /nowhere/python",
        &expect![[r"
        1
        error: cannot start the Python interpreter `/nowhere/python`: --python or RAFCON_PYTHON must name a Python 3.9 or newer
          because: No such file or directory (os error 2)
    "]],
    );
}

#[test]
fn show_a_tree() {
    check(
        "show MACHINE",
        &expect![[r"
        0
        Tea (ROOT) hierarchy in(cups: int = 2)
        ├─▸ Boil water (BOILED)  success → Brew  no water → ?
        └── Brew (BREWED) barrier concurrency in(cups: int)  success → ●success  aborted → ●cold
            ├── Pour (POURED)  success → Decide
            └── Decide (unique_decider_state_id) decider  success → ●success
    "]],
    );
}

#[test]
fn show_for_graphviz() {
    check(
        "show MACHINE --format dot",
        &expect![[r#"
            0
            digraph machine {
              compound=true; rankdir=LR; node [shape=box, style=rounded, fontname="sans-serif"];
              subgraph "cluster ROOT" {
                label="Tea"; "ROOT income" [shape=point, label=""];
                "ROOT outcome 0" [shape=circle, width=0.2, fixedsize=true, label="", xlabel="success"];
                "ROOT outcome 1" [shape=circle, width=0.2, fixedsize=true, label="", xlabel="cold"];
                "ROOT/BOILED" [label="Boil water"];
                subgraph "cluster ROOT/BREWED" {
                  label="Brew"; "ROOT/BREWED income" [shape=point, label=""];
                  "ROOT/BREWED outcome -1" [shape=circle, width=0.2, fixedsize=true, label="", xlabel="aborted"];
                  "ROOT/BREWED outcome 0" [shape=circle, width=0.2, fixedsize=true, label="", xlabel="success"];
                  "ROOT/BREWED/POURED" [label="Pour"];
                  "ROOT/BREWED/unique_decider_state_id" [label="Decide"];
                  "ROOT/BREWED/POURED" -> "ROOT/BREWED/unique_decider_state_id" [label="success"];
                  "ROOT/BREWED/unique_decider_state_id" -> "ROOT/BREWED outcome 0" [label="success"];
                }
                "ROOT income" -> "ROOT/BOILED" [label=""];
                "ROOT/BOILED" -> "ROOT/BREWED income" [label="success"];
                "ROOT/BREWED outcome 0" -> "ROOT outcome 0" [label="success"];
                "ROOT/BREWED outcome -1" -> "ROOT outcome 1" [label="aborted"];
              }
            }
        "#]],
    );
}

#[test]
fn show_for_mermaid() {
    check(
        "show MACHINE --format mermaid",
        &expect![[r#"
        0
        stateDiagram-v2
          state "Tea" as s1 {
            state "Boil water" as s2
            state "Brew" as s3 {
              state "Pour" as s4
              --
              state "Decide" as s5
            }
            [*] --> s2
            s2 --> s3 : success
            s3 --> [*] : success
            s3 --> [*] : aborted
          }
    "#]],
    );
}

#[test]
fn the_notation_is_read_back_as_the_same_machine() {
    let place = Place::with(MACHINE);
    let text = place.call("show MACHINE --format text-notation").stdout;
    let again = Place::with(&text).call("show MACHINE --format text-notation").stdout;
    assert_eq!(text, again);
}

#[test]
fn show_as_json_is_json() {
    let answer = Place::with(MACHINE).call("show MACHINE --format json");
    let document: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
    assert_eq!(document["root"]["states"][0]["name"], "Boil water");
    assert_eq!(document["root"]["transitions"][0]["to_state"], "BOILED");
}

#[test]
fn new_machines_are_right_and_left_alone_once_they_are_there() {
    let place = Place::empty();
    for template in ["hello", "empty"] {
        let path = place.path(template);
        let words = format!("{} --template {template}", path.display());
        assert_eq!(place.call(&format!("new {words}")).code, Some(0));
        let is_empty = i32::from(template == "empty");
        assert_eq!(place.call(&format!("check {}", path.display())).code, Some(is_empty));
        let again = place.call(&format!("new {words}"));
        assert_eq!(again.code, Some(1));
        assert!(again.stderr.contains("is not empty"), "{}", again.stderr);
    }
    assert_eq!(place.call("new x --template nothing").code, Some(2));
}

#[test]
fn fmt_tells_what_it_would_change_and_changes_it_once() {
    let place = Place::with(MACHINE);
    assert_eq!(place.call("fmt MACHINE --check").code, Some(0));
    let core = std::fs::read_to_string(place.machine().join("core_data.json")).unwrap();
    place.write("core_data.json", &core.replace(", \n", ",\n"));
    check_place(
        &place,
        "fmt MACHINE --check",
        &expect![[r"
        1
        would change core_data.json
    "]],
    );
    check_place(
        &place,
        "fmt MACHINE",
        &expect![[r"
        0
        changed core_data.json
    "]],
    );
    assert_eq!(place.call("fmt MACHINE --check").code, Some(0));
    assert_eq!(std::fs::read_to_string(place.machine().join("core_data.json")).unwrap(), core);
}

fn check_place(place: &Place, words: &str, expect: &Expect) {
    let answer = place.call(words);
    expect.assert_eq(&format!("{}\n{}{}", answer.code.unwrap(), answer.stdout, answer.stderr));
}

#[test]
fn shells_and_manuals() {
    let place = Place::empty();
    for shell in ["bash", "zsh", "fish"] {
        assert!(place.call(&format!("completions {shell}")).stdout.contains("start-from"));
    }
    let manual = place.call("man").stdout;
    assert!(manual.contains("library\\-path") && manual.contains("Exit codes"), "{manual}");
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let place = Place::with(MACHINE);
    let core = std::fs::read_to_string(place.machine().join("core_data.json")).unwrap();
    let long = format!("\"description\": \"{}\"", "long ".repeat(200_000));
    assert!(core.contains("\"description\": null"));
    place.write("core_data.json", &core.replace("\"description\": null", &long));
    let mut child = place
        .command("show MACHINE --format json")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = [0; 1];
    child.stdout.take().unwrap().read_exact(&mut first).unwrap();
    let answer = place.answer(&child.wait_with_output().unwrap());
    assert_eq!((answer.code, answer.stderr.as_str()), (Some(0), ""));
}
