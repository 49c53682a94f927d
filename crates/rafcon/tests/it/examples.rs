//! Each machine of `examples/` ends as its README says, and nothing is found in it. So does the mission that
//! `rafcon new` makes. Knows the `rafcon` program and its JSON lines only.

use crate::harness::{Answer, Place};
use expect_test::{Expect, expect};
use serde_json::Value;
use std::path::Path;

const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");

/// Checks an example, its files included, and runs it; the text is its outcome, its outputs and how the program ended.
#[track_caller]
fn check(example: &str, inputs: &str, expect: &Expect) {
    check_machine(&Path::new(EXAMPLES).join(example), inputs, expect);
}

#[track_caller]
fn check_machine(machine: &Path, inputs: &str, expect: &Expect) {
    let checked = call("check", machine, "--format json");
    assert_eq!((checked.stdout.as_str(), checked.code), ("", Some(0)), "check finds nothing");
    let written = Place::empty().call(&format!("fmt --check {}", machine.display()));
    assert_eq!(written.code, Some(0), "the files are as this program writes them");
    let (name, outputs, code) = run(machine, inputs);
    expect.assert_eq(&format!("{name} {outputs} exit {code}"));
}

/// Runs a machine: the name of its outcome, its outputs, and how the program ended.
#[track_caller]
fn run(machine: &Path, inputs: &str) -> (String, Value, i32) {
    let answer = call("run", machine, &format!("--output json {inputs}"));
    let last = answer.last();
    let name = last["outcome"]["name"].as_str().unwrap_or_default().to_owned();
    (name, last["outputs"].clone(), answer.code.unwrap_or(-1))
}

#[track_caller]
fn call(command: &str, machine: &Path, more: &str) -> Answer {
    let libraries = format!("--library-path examples={EXAMPLES}/libraries");
    Place::empty().call(&format!("{command} {} {libraries} {more}", machine.display()))
}

#[test]
fn hierarchy_and_data() {
    check(
        "hierarchy_and_data",
        "",
        &expect![[r#"success {"label":"5 parts, 0.60 kg","packed":5} exit 0"#]],
    );
    check(
        "hierarchy_and_data",
        "--input wanted=2",
        &expect![[r#"success {"label":"2 parts, 0.24 kg","packed":2} exit 0"#]],
    );
}

#[test]
fn barrier_with_decider() {
    check(
        "barrier_with_decider",
        "",
        &expect![[
            r#"degraded {"report":"Test the gripper: the gripper does not answer","temperature_c":41.5} exit 3"#
        ]],
    );
}

#[test]
fn preemptive_with_timer_finds_what_is_there() {
    check(
        "preemptive_with_timer",
        "",
        &expect![[r#"found {"arm":"out","bearing_deg":120} exit 0"#]],
    );
}

#[test]
fn preemptive_with_timer_gives_up_and_cleans_up() {
    let machine = Path::new(EXAMPLES).join("preemptive_with_timer");
    let (name, outputs, code) = run(&machine, "--input hidden_at_deg=45 --input limit_s=0.3");
    assert_eq!((name.as_str(), outputs["arm"].as_str(), code), ("gave up", Some("folded"), 3));
}

#[test]
fn error_recovery() {
    check(
        "error_recovery",
        "",
        &expect![[
            r#"success {"attempts":3,"remedies":["turned the plug","reached again"]} exit 0"#
        ]],
    );
}

#[test]
fn global_variables() {
    check(
        "global_variables",
        "",
        &expect![[
            r#"success {"log":["the basket is empty","42 apples are in the basket"],"total":42} exit 0"#
        ]],
    );
}

#[test]
fn library_reuse() {
    check("library_reuse", "", &expect![[r#"success {"distance_m":14.0} exit 0"#]]);
}

#[test]
fn mission() {
    check(
        "mission",
        "",
        &expect![[
            r#"success {"fetched":["battery","mug"],"result":"assembled with a click"} exit 0"#
        ]],
    );
}

#[test]
fn libraries_run_by_themselves() {
    check(
        "libraries/motion/drive_to",
        "--input x_m=2.0",
        &expect![[r#"success {"distance_m":2.0} exit 0"#]],
    );
    check("libraries/motion/drive_square", "", &expect![[r#"success {"distance_m":4.0} exit 0"#]]);
    check("libraries/manipulation/grasp", "", &expect![[r#"success {"attempt":1} exit 0"#]]);
    check("libraries/speech/announce", "", &expect!["success {} exit 0"]);
}

#[test]
fn a_generated_mission_fetches_both_things() {
    let place = Place::empty();
    let made = place.call("new MACHINE --template mission");
    assert_eq!(made.code, Some(0), "{}", made.stderr);
    let expect = expect![[
        r#"success {"fetched":["battery","mug"],"report":"41 waypoints seen, fetched: battery, mug"} exit 0"#
    ]];
    check_machine(&place.machine(), "--input time_scale=0.0", &expect);
}

#[test]
fn a_rover_that_plans_by_itself_is_made_without_fault() {
    let place = Place::empty();
    let made = place.call("new MACHINE --template rover");
    assert_eq!(made.code, Some(0), "{}", made.stderr);
    let roots =
        "--library-path examples=examples/libraries --library-path planning=libraries/planning";
    assert!(made.stdout.trim_end().ends_with(roots), "{}", made.stdout);
    let planning = "--library-path planning=".to_owned() + EXAMPLES + "/../libraries/planning";
    let checked = call("check", &place.machine(), &format!("{planning} --format json"));
    assert_eq!((checked.stdout.as_str(), checked.code), ("", Some(0)), "check finds nothing");
    let written = place.call("fmt --check MACHINE");
    assert_eq!(written.code, Some(0), "the files are as this program writes them");
}
