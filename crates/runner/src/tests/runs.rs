//! Branches and their threads.

use super::players::Run;
use expect_test::{Expect, expect};
use rafcon_engine::Input;
use std::fmt::Write as _;

fn check(machine: &str, expect: &Expect) {
    let run = Run::new(machine, 1, 0);
    run.start();
    let report = run.end();
    let finish = &report.finish;
    let end = format!("{} after {} states", finish.outcome_name, finish.states_run);
    expect.assert_eq(&format!("{}\n{end}\n", report.steps.join("\n")));
}

/// A concurrency state that is entered again until its rounds are over.
fn rounds(kind: &str, children: &[&str]) -> String {
    let mut text = String::from(
        "hierarchy ROOT\n  outcome done\n  start -> CONC\n  CONC.done -> AGAIN\n  AGAIN.again -> CONC\n  AGAIN.enough -> .done\n  \
         execution AGAIN \"again\"\n    outcome again\n    outcome enough\n",
    );
    writeln!(text, "  {kind} CONC\n    outcome done").unwrap();
    for (number, child) in children.iter().enumerate() {
        if kind == "preemptive" {
            writeln!(text, "    CHILD{number}.ok -> .done").unwrap();
        }
        writeln!(text, "    execution CHILD{number} \"{child}\"\n      outcome ok").unwrap();
    }
    if kind == "barrier" {
        text.push_str("    unique_decider_state_id.ok -> .done\n");
        text.push_str("    decider unique_decider_state_id \"go\"\n      outcome ok\n");
    }
    text
}

#[test]
fn a_branch_goes_on_by_itself() {
    check(
        "
hierarchy ROOT
  outcome done
  start -> A
  A.ok -> B
  B.ok -> .done
  execution A \"go\"
    outcome ok
  execution B \"go\"
    outcome ok
",
        &expect![[r"
            +ROOT
            +ROOT/A
            -ROOT/A=ok
            +ROOT/B
            -ROOT/B=ok
            -ROOT=done
            done after 3 states
        "]],
    );
}

#[test]
fn a_defect_of_ours_becomes_the_states_error() {
    check(
        "
hierarchy ROOT
  outcome done
  start -> A
  A.ok -> .done
  execution A \"panic\"
    outcome ok
",
        &expect![[r"
            +ROOT
            +ROOT/A
            -ROOT/A=aborted
            -ROOT=aborted
            aborted after 2 states
        "]],
    );
}

#[test]
fn every_child_begins_before_any_has_to_end() {
    let run = Run::new(&rounds("barrier", &["meet"; 40]), 40, 0);
    run.start();
    let report = run.end();
    assert_eq!(report.finish.outcome_name, "done");
    assert_eq!(report.finish.states_run, 1 + 1 + 40 + 1 + 1);
}

#[test]
fn threads_are_used_again() {
    let run = Run::new(&rounds("barrier", &["go"; 8]), 1, 200);
    run.start();
    let report = run.end();
    assert_eq!(report.finish.outcome_name, "done");
    assert!(report.threads <= 10, "{} threads for nine branches at once", report.threads);
}

#[test]
fn a_preemption_is_never_lost() {
    let children = ["go", "wait", "wait", "wait", "wait", "wait", "wait"];
    let run = Run::new(&rounds("preemptive", &children), 1, 10_000);
    run.start();
    let report = run.end();
    assert_eq!(report.finish.outcome_name, "done");
    assert_eq!(report.steps.iter().filter(|step| *step == "-ROOT/CONC=done").count(), 10_001);
}

#[test]
fn a_stop_reaches_every_waiting_script() {
    let run = Run::new(&rounds("barrier", &["wait"; 20]), 1, 0);
    run.start();
    run.wait_for(|text| text == "+ROOT/CONC/CHILD7");
    run.driver.command(Input::Stop).unwrap();
    let report = run.end();
    assert_eq!(report.finish.outcome_name, "preempted");
    assert_eq!(report.steps.iter().filter(|step| step.ends_with("=preempted")).count(), 22);
}

#[test]
fn a_pause_holds_and_a_resume_goes_on() {
    let run = Run::new(&rounds("barrier", &["go"; 3]), 1, 10_000_000);
    run.start();
    run.driver.command(Input::Pause).unwrap();
    let held = run.driver.with_core(|core| core.engine.snapshot()).unwrap();
    assert!(!held.is_empty());
    run.driver.command(Input::Resume(None)).unwrap();
    run.wait_for(|text| text == "-ROOT/CONC=done");
    run.driver.command(Input::Stop).unwrap();
    assert_eq!(run.end().finish.outcome_name, "preempted");
}
