//! Runs that can only wait, where nobody watches them.

use crate::harness::Place;
use expect_test::{Expect, expect};

/// Exit code, end and error output of a run without a terminal; `check` names what it waits for.
fn check(machine: &str, expect: &Expect) {
    let place = Place::with(machine);
    let checked = place.call("check MACHINE");
    let found = checked.stdout.lines().find(|line| !line.starts_with(' ')).unwrap_or_default();
    expect.assert_eq(&format!("{found}\n{}", place.run("--keep off").ending()));
    assert_eq!(place.call("run MACHINE --keep off").code, Some(1));
}

#[test]
fn a_run_that_can_only_wait_ends_where_nobody_watches() {
    check(
        "hierarchy ROOT \"Nothing\"\n  outcome success\n",
        &expect![[r"
            error: Nothing: no state is in it
            1 finished preempted
            rafcon: the run can only wait for a start state, and nobody watches; stopping
            error: the run could only wait for a start state: add it to the machine
        "]],
    );
    check(
        "preemptive ROOT \"Nobody\"\n  outcome success\n",
        &expect![[r"
            error: Nobody: no state is in it
            1 finished preempted
            rafcon: the run can only wait for a child, and nobody watches; stopping
            error: the run could only wait for a child: add it to the machine
        "]],
    );
    check(
        r#"
        barrier ROOT "Both"
          outcome success
          CHILDX.success -> unique_decider_state_id
          execution CHILDX
            outcome success
            script |
              def execute(self, inputs, outputs, gvm):
                  return 0
          decider unique_decider_state_id "Decider"
            outcome success
            script |
              def execute(self, inputs, outputs, gvm):
                  return 0
        "#,
        &expect![[r#"
            note: Both/Decider: outcome 0: no transition begins at the outcome `success`
            1 finished preempted
            rafcon: the run can only wait for a transition from the outcome "success" of "Decider", and nobody watches; stopping
            error: the run could only wait for a transition from the outcome "success" of "Decider": add it to the machine
        "#]],
    );
}

/// One branch waits while the other runs; it waits, too, when that has ended.
#[test]
fn a_branch_that_waits_beside_one_that_runs_ends_nothing() {
    let place = Place::with(
        r#"
        preemptive ROOT "Race"
          outcome success
          WAITSX.success -> .success ; SCRIPT.success -> .success
          hierarchy WAITSX "Waits"
            outcome success
          execution SCRIPT "Runs"
            outcome success
            script |
              def execute(self, inputs, outputs, gvm):
                  self.preemptive_wait(0.5)
                  return 0
        "#,
    );
    assert_eq!(place.run("--keep off").code, Some(0));
}

#[test]
fn a_deadline_ends_the_waiting() {
    let place = Place::with(
        r#"
        hierarchy ROOT "Root"
          outcome success
          start -> WAITSX
          WAITSX.preempted -> .success
          hierarchy WAITSX "Waits"
            outcome success
            semantic {"deadline_s": 1}
        "#,
    );
    assert_eq!(place.run("--keep off").code, Some(0));
}

#[test]
fn a_new_empty_machine_says_what_it_lacks() {
    let place = Place::empty();
    assert_eq!(place.call("new MACHINE --template empty").code, Some(0));
    let checked = place.call("check MACHINE");
    assert_eq!(checked.code, Some(1));
    expect![[r"
        error: machine: no state is in it
            add a state; in a hierarchy, also connect the income with it
            at ROOTED
        machine: 1 state, 1 error, no notes
    "]]
    .assert_eq(&checked.stdout);
}
