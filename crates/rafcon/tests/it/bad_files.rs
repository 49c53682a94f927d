//! Machines whose files are broken: they load as far as they can, every fault is told, nothing panics.

use crate::harness::{Place, Run, one_script};
use expect_test::{Expect, expect};
use std::os::unix::ffi::OsStrExt as _;

const TWO: &str = r#"
    hierarchy ROOT "Root"
      outcome success
      start -> AAAAAA
      AAAAAA.success -> .success
      execution AAAAAA "First"
        outcome success
        script |
          def execute(self, inputs, outputs, gvm):
              return "success"
"#;

/// `rafcon check` and `rafcon run` of the machine in a place. Nobody watches the run: it ends where it can only wait.
fn check(place: &Place, expect: &Expect) {
    let checked = place.call("check MACHINE");
    let mut run = Run::start(place, "");
    let told = ["waiting", "finished", "load_failed"].map(|kind| format!("{{\"type\":\"{kind}\""));
    let told = run.wait_for_one_of(&told).unwrap();
    let (code, lines, _) = run.end();
    let last: serde_json::Value = serde_json::from_str(lines.last().unwrap_or(&told)).unwrap();
    let event: serde_json::Value = serde_json::from_str(&told).unwrap();
    let waited = event["reason"].as_str().map(|reason| format!(": {reason}")).unwrap_or_default();
    let waited = waited.replace(&place.path("").display().to_string(), "PLACE/");
    expect.assert_eq(&format!(
        "check: {}\n{}{}run: {}{waited}, {} {}\n",
        checked.code.unwrap(),
        checked.stdout,
        checked.stderr,
        event["type"].as_str().unwrap(),
        code.unwrap(),
        last["outcome"]["name"].as_str().unwrap_or_default(),
    ));
}

fn edit(place: &Place, file: &str, from: &str, to: &str) {
    let file = place.machine().join(file);
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains(from), "{text}");
    std::fs::write(file, text.replacen(from, to, 1)).unwrap();
}

const FIRST: &str = "First_AAAAAA/core_data.json";

#[test]
fn truncated_json() {
    let place = Place::with(TWO);
    place.write(FIRST, "{\"name\": \"First\", \"outco");
    check(
        &place,
        &expect![[r"
            check: 1
            error: Root/First: is not JSON: line 1, column 25: a string without end
                correct the file by hand or restore it; it stays as it is until this part of the state is changed
                at ROOT/AAAAAA, First_AAAAAA/core_data.json
            error: Root: transition 2: it begins at the outcome 0 of AAAAAA, which does not exist
                connect the beginning with an outcome that exists, or remove the transition
                at ROOT
            Root: 2 states, 2 errors, no notes
            run: finished, 4 aborted
        "]],
    );
}

/// A machine whose state has these files aborts, and the state, whose script prints, does nothing.
fn check_damage(damages: &[&str]) {
    for damage in damages {
        let place = Place::with(TWO);
        place.write(FIRST, damage);
        let script = "print('it runs')\ndef execute(self, inputs, outputs, gvm):\n    return 0\n";
        place.write("First_AAAAAA/script.py", script);
        let run = place.run("--keep off");
        assert_eq!(run.code, Some(4), "{damage}: {}", run.ending());
        assert!(!run.stdout.contains("it runs"), "{damage}: {}", run.stdout);
        assert!(run.log().contains("it aborts before it does anything"), "{damage}: {}", run.log());
    }
}

#[test]
fn a_state_whose_file_is_damaged_never_runs_its_script() {
    check_damage(&[
        "{\"name\": \"First\", \"outco",
        "\u{feff}{}",
        "<<<<<<< HEAD\n{}\n=======\n{}\n>>>>>>> other\n",
        r#"{"__jsonqualname__": "rafcon.core.states.unknown.StrangeState"}"#,
    ]);
}

#[test]
fn a_state_that_lost_a_part_by_damage_never_runs_its_script() {
    check_damage(&[
        "{}",
        r#"{"__jsonqualname__": "ExecutionState", "name": "First", "state_id": "AAAAAA", "outcomes": 7}"#,
        r#"{"__jsonqualname__": "ExecutionState", "name": "First", "state_id": "AAAAAA", "outcomes": {"0": {}}}"#,
    ]);
}

#[test]
fn conflict_markers_are_named() {
    let conflict = "<<<<<<< HEAD\nx = 1\n=======\nx = 2\n>>>>>>> other\n";
    for file in
        [FIRST, "First_AAAAAA/script.py", "First_AAAAAA/meta_data.json", "statemachine.json"]
    {
        let place = Place::with(TWO);
        place.write(file, conflict);
        let checked = place.call("check MACHINE");
        assert!(checked.stdout.contains("conflict markers of a merge"), "{file}: {checked:?}");
        assert!(checked.stdout.contains("remove the lines that begin with <<<<<<<"), "{checked:?}");
    }
    let place = Place::with(TWO);
    place.write("First_AAAAAA/script.py", conflict);
    let run = place.run("--keep off");
    assert_eq!(run.code, Some(4), "{}", run.ending());
    assert!(run.stdout.contains("the script has conflict markers of a merge"), "{}", run.stdout);
}

#[test]
fn a_truncated_root() {
    let place = Place::with(TWO);
    place.write("core_data.json", "{");
    check(
        &place,
        &expect![[r"
            check: 1
            error: UNREAD: is not JSON: line 1, column 2: expected a key in quotes
                correct the file by hand or restore it; it stays as it is until this part of the state is changed
                at UNREAD, core_data.json
            note: UNREAD/First: outcome 0: no transition begins at the outcome `success`
                connect the outcome if it can happen
                at UNREAD/AAAAAA
            UNREAD: 2 states, 1 error, 1 note
            run: load_failed: the root state cannot be read, so the machine does not run: core_data.json: is not JSON: line 1, column 2: expected a key in quotes; correct the file, or restore it, 1 
        "]],
    );
}

#[test]
fn a_truncated_header() {
    let place = Place::with(TWO);
    place.write("statemachine.json", "{");
    check(
        &place,
        &expect![[r"
            check: 1
            error: is not JSON: line 1, column 2: expected a key in quotes
                correct the file by hand or restore it; it stays as it is until this part of the state is changed
                at statemachine.json
            Root: 2 states, 1 error, no notes
            run: finished, 0 success
        "]],
    );
}

#[test]
fn wrong_types() {
    let place = Place::with(TWO);
    edit(&place, FIRST, "\"name\": \"First\"", "\"name\": [1]");
    edit(&place, "core_data.json", "\"transitions\": {", "\"transitions\": 7, \"old\": {");
    check(
        &place,
        &expect![[r"
            check: 1
            error: Root: `transitions` should be an object, not an integer
                correct the key in the file, or change the state and save it
                at ROOT, core_data.json
            error: Root/AAAAAA: `name` should be a string, not a list
                correct the key in the file, or change the state and save it
                at ROOT/AAAAAA, First_AAAAAA/core_data.json
            note: Root/AAAAAA: outcome 0: no transition begins at the outcome `success`
                connect the outcome if it can happen
                at ROOT/AAAAAA
            Root: 2 states, 2 errors, 1 note
            run: load_failed: the root state cannot be read, so the machine does not run: core_data.json: `transitions` should be an object, not an integer; correct the file, or restore it, 1 
        "]],
    );
}

#[test]
fn duplicate_ids() {
    let place = Place::with(TWO);
    let first = std::fs::read_to_string(place.machine().join(FIRST)).unwrap();
    place.write("Second/core_data.json", &first.replace("First", "Second"));
    check(
        &place,
        &expect![[r"
            check: 1
            error: Root/Second: the id AAAAAA is taken; the state is now JQZKMF
                save the machine to keep the new id, or give it another in its file
                at ROOT/JQZKMF, Second/core_data.json
            note: Root/Second: no way leads to it from the start
                lead a transition to the state, or remove it
                at ROOT/JQZKMF
            note: Root/Second: there is no script
                write a script
                at ROOT/JQZKMF
            note: Root/Second: outcome 0: no transition begins at the outcome `success`
                connect the outcome if it can happen
                at ROOT/JQZKMF
            Root: 3 states, 1 error, 3 notes
            run: finished, 0 success
        "]],
    );
}

#[test]
fn transitions_to_nowhere() {
    let place = Place::with(TWO);
    edit(&place, "core_data.json", "\"to_state\": \"AAAAAA\"", "\"to_state\": \"NOBODY\"");
    check(
        &place,
        &expect![[r"
            check: 1
            error: Root: transition 1: it leads to NOBODY, which does not exist
                connect the end with a child or an outcome of the container, or remove the transition
                at ROOT
            note: Root/First: no way leads to it from the start
                lead a transition to the state, or remove it
                at ROOT/AAAAAA
            Root: 2 states, 1 error, 1 note
            run: waiting: there is no start state: connect the income, or stop the run, 1 preempted
        "]],
    );
}

#[test]
fn a_missing_library() {
    let place = Place::with("library ROOT \"Gone\" from \"nowhere/gone\"\n  outcome success\n");
    let run = place.run("");
    assert_eq!(run.code, Some(4), "{run:?}");
    let last = run.stdout.lines().last().unwrap();
    let finished: serde_json::Value = serde_json::from_str(last).unwrap();
    expect![[r#"{"__exc__":"RuntimeError","msg":"no library root is named `nowhere`"}"#]]
        .assert_eq(&finished["outputs"]["error"].to_string());
}

#[test]
fn a_cycle_of_libraries() {
    let place = Place::with("library ROOT \"Loop\" from \"loops/machine\"\n  outcome success\n");
    let root = format!("--library-path loops={}", place.path("").display());
    let checked = place.call(&format!("check MACHINE {root}"));
    assert_eq!(checked.code, Some(1));
    assert!(checked.stdout.contains("contains itself"), "{checked:?}");
    let run = place.run(&root);
    assert_eq!(run.code, Some(4), "{run:?}");
}

#[test]
fn a_folder_without_core_data() {
    let place = Place::with(TWO);
    std::fs::create_dir(place.machine().join("notes")).unwrap();
    check(
        &place,
        &expect![[r"
            check: 0
            Root: 2 states, no errors, no notes
            run: finished, 0 success
        "]],
    );
    std::fs::remove_file(place.machine().join(FIRST)).unwrap();
    check(
        &place,
        &expect![[r"
            check: 1
            error: Root: transition 1: it leads to AAAAAA, which does not exist
                connect the end with a child or an outcome of the container, or remove the transition
                at ROOT
            error: Root: transition 2: it begins at AAAAAA, which does not exist
                connect the beginning with an outcome of a child, or remove the transition
                at ROOT
            Root: 1 state, 2 errors, no notes
            run: waiting: there is no start state: connect the income, or stop the run, 1 preempted
        "]],
    );
    std::fs::remove_file(place.machine().join("core_data.json")).unwrap();
    check(
        &place,
        &expect![[r"
            check: 1
            error: PLACE/machine has no root state: a folder with core_data.json is missing
            run: load_failed: PLACE/machine has no root state: a folder with core_data.json is missing, 1 
        "]],
    );
}

#[test]
fn not_a_machine() {
    let place = Place::empty();
    std::fs::create_dir(place.machine()).unwrap();
    check(
        &place,
        &expect![[r"
            check: 1
            error: PLACE/machine is not a state machine: it has no statemachine.json
            run: load_failed: PLACE/machine is not a state machine: it has no statemachine.json, 1 
        "]],
    );
}

#[test]
fn a_thousand_levels() {
    let place = Place::with(TWO);
    let level = std::fs::read_to_string(place.machine().join("core_data.json")).unwrap();
    let leaf = std::fs::read_to_string(place.machine().join(FIRST)).unwrap();
    let script = std::fs::read_to_string(place.machine().join("First_AAAAAA/script.py")).unwrap();
    std::fs::remove_dir_all(place.machine().join("First_AAAAAA")).unwrap();
    let mut folder = std::path::PathBuf::new();
    for depth in 0..1000 {
        let named = level.replace("ROOT", &format!("L{depth}"));
        let next = if depth == 999 { "AAAAAA".to_owned() } else { format!("L{}", depth + 1) };
        place.write(folder.join("core_data.json"), &named.replace("AAAAAA", &next));
        folder.push("d");
    }
    place.write(folder.join("core_data.json"), &leaf);
    place.write(folder.join("script.py"), &script);
    assert_eq!(place.call("check MACHINE").code, Some(0));
    for format in ["tree", "text-notation", "json", "dot", "mermaid"] {
        let mut show = place.command(&format!("show MACHINE --format {format}"));
        assert!(show.stdout(std::process::Stdio::null()).status().unwrap().success(), "{format}");
    }
    let run = place.run("");
    assert_eq!(run.code, Some(0), "{}", run.ending());
    assert_eq!(run.last()["states_run"], 1001);
}

#[test]
fn names_that_are_not_utf_8() {
    let place = Place::with(TWO);
    let strange = std::ffi::OsStr::from_bytes(b"Fir\xffst");
    std::fs::rename(place.machine().join("First_AAAAAA"), place.machine().join(strange)).unwrap();
    check(
        &place,
        &expect![[r"
            check: 0
            Root: 2 states, no errors, no notes
            run: finished, 0 success
        "]],
    );
    let other = place.path("").join(std::ffi::OsStr::from_bytes(b"mach\xffine"));
    std::fs::rename(place.machine(), &other).unwrap();
    let output = place.command("run").arg(&other).args(["--output", "json"]).output().unwrap();
    let answer = place.answer(&output);
    assert_eq!(answer.code, Some(1));
    expect![[r"
        error: the path PLACE/mach�ine is not UTF-8: rename the folder, or use a link to it
    "]]
    .assert_eq(&answer.stderr);
}

#[test]
fn a_script_that_is_not_utf_8() {
    let place = Place::with(&one_script("def execute(self, inputs, outputs, gvm):\n    return 0"));
    std::fs::write(place.machine().join("script.py"), b"# \xff\n").unwrap();
    check(
        &place,
        &expect![[r"
            check: 1
            error: Lonely: is not UTF-8 text
                correct the file by hand or restore it; it stays as it is until this part of the state is changed
                at LONELY, script.py
            error: Lonely: script.py: the script has no function `execute`
                write `def execute(self, inputs, outputs, gvm):`; the state aborts until then
                at LONELY
            Lonely: 1 state, 2 errors, no notes
            run: finished, 4 aborted
        "]],
    );
}
