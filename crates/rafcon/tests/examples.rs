//! Each machine of `examples/` ends as its README says, and nothing is found in it. So does the mission that
//! `rafcon new` makes. Knows the `rafcon` program and its JSON lines only.

use expect_test::{Expect, expect};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
const LIBRARIES: [&str; 2] = ["--library-path", "examples=examples/libraries"];

/// Checks and runs a machine; the text is its outcome, its outputs and how the program ended.
#[track_caller]
fn check(machine: impl AsRef<Path>, arguments: &[&str], expect: &Expect) {
    let machine = machine.as_ref();
    let (found, code) = rafcon("check", machine, &["--format", "json"]);
    assert_eq!((found.as_str(), code), ("", 0), "check finds nothing");
    let (name, outputs, code) = run(machine, arguments);
    expect.assert_eq(&format!("{name} {outputs} exit {code}"));
}

/// Runs a machine: the name of its outcome, its outputs, and how the program ended.
#[track_caller]
fn run(machine: &Path, arguments: &[&str]) -> (String, Value, i32) {
    let (printed, code) = rafcon("run", machine, &[arguments, &["--output", "json"]].concat());
    let last: Value = serde_json::from_str(printed.lines().last().expect("a line")).expect("JSON");
    (last["outcome"]["name"].as_str().unwrap_or_default().to_owned(), last["outputs"].clone(), code)
}

#[track_caller]
fn rafcon(command: &str, machine: &Path, arguments: &[&str]) -> (String, i32) {
    let mut rafcon = Command::new(env!("CARGO_BIN_EXE_rafcon"));
    rafcon.current_dir(ROOT).arg(command).arg(machine).args(LIBRARIES).args(arguments);
    let output = rafcon.output().expect("the program starts");
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let errors = String::from_utf8_lossy(&output.stderr);
    (text, output.status.code().unwrap_or_else(|| panic!("killed: {errors}")))
}

#[test]
fn hierarchy_and_data() {
    check(
        "examples/hierarchy_and_data",
        &[],
        &expect![[r#"success {"label":"5 parts, 0.60 kg","packed":5} exit 0"#]],
    );
    check(
        "examples/hierarchy_and_data",
        &["--input", "wanted=2"],
        &expect![[r#"success {"label":"2 parts, 0.24 kg","packed":2} exit 0"#]],
    );
}

#[test]
fn barrier_with_decider() {
    check(
        "examples/barrier_with_decider",
        &[],
        &expect![[
            r#"degraded {"report":"Test the gripper: the gripper does not answer","temperature_c":41.5} exit 3"#
        ]],
    );
}

#[test]
fn preemptive_with_timer_finds_what_is_there() {
    check(
        "examples/preemptive_with_timer",
        &[],
        &expect![[r#"found {"arm":"out","bearing_deg":120} exit 0"#]],
    );
}

#[test]
fn preemptive_with_timer_gives_up_and_cleans_up() {
    let arguments = ["--input", "hidden_at_deg=45", "--input", "limit_s=0.3"];
    let (name, outputs, code) = run(Path::new("examples/preemptive_with_timer"), &arguments);
    assert_eq!((name.as_str(), outputs["arm"].as_str(), code), ("gave up", Some("folded"), 3));
}

#[test]
fn error_recovery() {
    check(
        "examples/error_recovery",
        &[],
        &expect![[
            r#"success {"attempts":3,"remedies":["turned the plug","reached again"]} exit 0"#
        ]],
    );
}

#[test]
fn global_variables() {
    check(
        "examples/global_variables",
        &[],
        &expect![[
            r#"success {"log":["the basket is empty","42 apples are in the basket"],"total":42} exit 0"#
        ]],
    );
}

#[test]
fn library_reuse() {
    check("examples/library_reuse", &[], &expect![[r#"success {"distance_m":14.0} exit 0"#]]);
}

#[test]
fn mission() {
    check(
        "examples/mission",
        &[],
        &expect![[
            r#"success {"fetched":["battery","mug"],"result":"assembled with a click"} exit 0"#
        ]],
    );
}

#[test]
fn libraries_run_by_themselves() {
    check(
        "examples/libraries/motion/drive_to",
        &["--input", "x_m=2.0"],
        &expect![[r#"success {"distance_m":2.0} exit 0"#]],
    );
    check(
        "examples/libraries/motion/drive_square",
        &[],
        &expect![[r#"success {"distance_m":4.0} exit 0"#]],
    );
    check(
        "examples/libraries/manipulation/grasp",
        &[],
        &expect![[r#"success {"attempt":1} exit 0"#]],
    );
    check("examples/libraries/speech/announce", &[], &expect!["success {} exit 0"]);
}

#[test]
fn a_generated_mission_fetches_both_things() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mission");
    let (said, code) = rafcon_new(&path);
    assert_eq!(code, Some(0), "{said}");
    check(
        &path,
        &["--input", "time_scale=0.0"],
        &expect![[
            r#"success {"fetched":["battery","mug"],"report":"41 waypoints seen, fetched: battery, mug"} exit 0"#
        ]],
    );
}

fn rafcon_new(path: &Path) -> (String, Option<i32>) {
    let mut new = Command::new(env!("CARGO_BIN_EXE_rafcon"));
    let output = new.arg("new").arg(path).args(["--template", "mission"]).output();
    let output = output.expect("the program starts");
    (String::from_utf8_lossy(&output.stderr).into_owned(), output.status.code())
}
