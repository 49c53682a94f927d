//! Machines that change during a run: by their folder, by commands, by their own scripts.

use super::served::{RunFixture, Viewer};
use expect_test::{Expect, expect};
use rafcon_protocol::Command;

fn machine(children: &str) -> String {
    format!("\nhierarchy ROOT\n  outcome done\n{children}")
}

const OLD: &str = "  start -> A
  A.preempted -> B
  B.ok -> .done
  execution A \"wait\"
    outcome ok
  execution B
    outcome ok
";

const LONGER: &str = "  start -> A
  A.preempted -> B
  B.ok -> C
  C.ok -> .done
  execution A \"wait\"
    outcome ok
  execution B
    outcome ok
  execution C
    outcome ok
";

const WITHOUT_A: &str = "  start -> B
  B.ok -> .done
  execution B
    outcome ok
";

const MORE_OF_A: &str = "  start -> A
  A.preempted -> C
  C.ok -> .done
  execution A \"wait\"
    outcome ok
    outcome more
  execution C
    outcome ok
";

/// Changes the folder of a run whose first state waits, reloads it, and lets the run continue.
fn check(new: &str, wait: bool, answer: &str, expect: &Expect) {
    let fixture = RunFixture::new(&machine(OLD));
    let (mut viewer, runner) = fixture.begin(fixture.launch());
    viewer.until_text("+ROOT/A");
    fixture.build(&machine(new));
    assert_eq!(viewer.command("reload", Command::Reload { wait }), answer);
    let go_on = Command::Preempt { path: "ROOT/A".to_owned() };
    assert_eq!(viewer.command("go on", go_on), "applied");
    expect.assert_eq(&without_commands(viewer));
    runner.join().unwrap();
}

fn without_commands(viewer: Viewer) -> String {
    let text = viewer.into_end();
    text.split_inclusive('\n').filter(|line| !line.contains(" by test: ")).collect()
}

#[test]
fn what_is_new_in_the_folder_is_run() {
    check(
        LONGER,
        false,
        "applied",
        &expect![[r"
        +ROOT
        +ROOT/A
        -ROOT/A=preempted
        +ROOT/B
        -ROOT/B=ok
        +ROOT/C
        -ROOT/C=ok
        -ROOT=done
        finished done
    "]],
    );
}

#[test]
fn the_ground_is_not_pulled_from_under_an_active_state() {
    let refused = "refused: cannot change the machine now: 'ROOT/A' is active and would be gone; let the change wait until the state has ended, or stop the run";
    check(
        WITHOUT_A,
        false,
        refused,
        &expect![[r"
        +ROOT
        +ROOT/A
        -ROOT/A=preempted
        +ROOT/B
        -ROOT/B=ok
        -ROOT=done
        finished done
    "]],
    );
}

#[test]
fn a_change_waits_until_it_can_be_made() {
    check(
        MORE_OF_A,
        true,
        "applied",
        &expect![[r#"
        +ROOT
        +ROOT/A
        ChangeWaits { path: "ROOT/A", change: "its folder was read again" }
        -ROOT/A=preempted
        +ROOT/C
        -ROOT/C=ok
        -ROOT=done
        finished done
    "#]],
    );
}

#[test]
fn scripts_change_the_machine_that_they_run_in() {
    let fixture = RunFixture::new(
        "
barrier ROOT
  outcome done
  unique_decider_state_id.ok -> .done
  execution A \"grow\"
    outcome ok
  execution B \"grow\"
    outcome ok
  hierarchy C
    outcome ok
    start -> D
    execution D \"grow\"
      outcome ok
  decider unique_decider_state_id
    outcome ok
",
    );
    let (viewer, runner) = fixture.begin(fixture.launch());
    let text = viewer.into_end();
    for grown in ["ROOT/C/GROWN_A", "ROOT/C/GROWN_B", "ROOT/C/GROWN_D"] {
        assert!(text.contains(&format!("grew {grown}")), "{text}");
    }
    assert!(text.contains("-ROOT/C/GROWN_D=ok\n-ROOT/C=ok"), "{text}");
    assert!(text.ends_with("finished done\n"), "{text}");
    runner.join().unwrap();
}
