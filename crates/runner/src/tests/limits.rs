//! Deadlines and grace periods on the real clock. They are short, and tests wait for their effects.

use super::served::RunFixture;
use expect_test::{Expect, expect};
use rafcon_protocol::Command;
use std::process;

fn check(machine: &str, expect: &Expect) {
    let fixture = RunFixture::new(machine);
    let (viewer, runner) = fixture.begin(fixture.launch());
    expect.assert_eq(&viewer.into_end());
    runner.join().unwrap();
}

#[test]
fn a_deadline_preempts_the_state_and_nothing_else() {
    check(
        "
hierarchy ROOT
  outcome done
  start -> A
  A.preempted -> B
  B.ok -> .done
  execution A \"wait\"
    outcome ok
    semantic {\"deadline_s\": 0.02}
  execution B \"go\"
    outcome ok
    semantic {\"deadline_s\": \"3600\"}
",
        &expect![[r"
            +ROOT
            +ROOT/A
            deadline ROOT/A 20 ms
            -ROOT/A=preempted
            +ROOT/B
            -ROOT/B=ok
            -ROOT=done
            finished done
        "]],
    );
}

#[test]
fn a_script_that_does_not_end_in_its_grace_period_ends_with_the_process() {
    const CHILD: &str = "RAFCON_TEST_CUT_OFF";
    if std::env::var_os(CHILD).is_some() {
        return be_cut_off();
    }
    let name =
        "tests::limits::a_script_that_does_not_end_in_its_grace_period_ends_with_the_process";
    let child = process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", name, "--nocapture"])
        .env(CHILD, "1")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&child.stdout);
    assert_eq!(child.status.code(), Some(86), "{said}");
}

fn be_cut_off() {
    let fixture = RunFixture::new(
        "
hierarchy ROOT
  outcome done
  start -> A
  A.ok -> .done
  semantic {\"grace_s\": 0.02}
  execution A \"stuck\"
    outcome ok
",
    );
    let (mut viewer, runner) = fixture.begin(fixture.launch());
    viewer.until_text("+ROOT/A");
    assert_eq!(viewer.command("stop", Command::Stop), "applied");
    runner.join().unwrap();
}
