//! Runs with a silent ground, on the real clock. Times are short, and tests wait for their effects.

use super::served::{RunFixture, Viewer};
use expect_test::{Expect, expect};
use rafcon_protocol::{Command, OnCrash, ToRunner};

/// The output of a run whose ground falls silent after this event.
fn check(machine: &str, event: &str, expect: &Expect) {
    let fixture = RunFixture::new(machine);
    let (mut viewer, runner) = fixture.begin(fixture.launch());
    viewer.until_text(event);
    viewer.send(&ToRunner::Ground { heard_ms_ago: Some(0) });
    expect.assert_eq(&viewer.into_end());
    runner.join().unwrap();
}

#[test]
fn a_state_gives_way_to_its_recovery_once_the_ground_is_silent() {
    check(
        r#"
hierarchy ROOT
  outcome done
  start -> DRIVE
  DRIVE.preempted -> HOME
  HOME.ok -> .done
  execution DRIVE "wait"
    outcome ok
    semantic {"lost_link": {"recover_s": 0.02}}
  execution HOME "go"
    outcome ok
"#,
        "+ROOT/DRIVE",
        &expect![[r"
            +ROOT
            +ROOT/DRIVE
            silence: link 0 ms, command 0 ms
            silence: link 20 ms, command 0 ms
            ROOT/DRIVE recovers: Link
            -ROOT/DRIVE=preempted
            +ROOT/HOME
            -ROOT/HOME=ok
            -ROOT=done
            finished done
        "]],
    );
}

#[test]
fn a_question_closes_once_the_ground_is_silent() {
    check(
        r#"
hierarchy ROOT
  outcome done
  start -> DRIVE
  DRIVE.ok -> .done
  execution DRIVE "consult"
    outcome ok
"#,
        "asked 1 by ROOT/DRIVE",
        &expect![[r#"
            +ROOT
            +ROOT/DRIVE
            asked 1 by ROOT/DRIVE
            silence: link 0 ms, command 0 ms
            silence: link 20 ms, command 0 ms
            closed 1 TimedOut {"button":0} by 
            -ROOT/DRIVE=ok
            -ROOT=done
            finished done
        "#]],
    );
}

/// A machine that waits for a command once the ground is silent.
const HELD: &str = r#"
hierarchy ROOT
  outcome done
  start -> DRIVE
  DRIVE.ok -> SAMPLE
  SAMPLE.ok -> .done
  DRIVE.aborted -> SAMPLE
  semantic {"lost_link": {"hold_s": 0.02}}
  execution DRIVE "consult"
    outcome ok
  execution SAMPLE "go"
    outcome ok
"#;

/// Waits until the run is held, releases it, and returns its output. Silences after the release are dropped, because a
/// busy machine may exceed the short time.
fn let_go(mut viewer: Viewer) -> String {
    viewer.until_text("ROOT is held before ROOT/SAMPLE by Loss { loss: Link }");
    assert_eq!(viewer.command("go", Command::Resume { branch: None }), "applied");
    let said = viewer.into_end();
    let (held, goes_on) = said.split_once("+ROOT/SAMPLE\n").unwrap_or((&said, ""));
    let lines = held.split_inclusive('\n').chain(["+ROOT/SAMPLE\n"]);
    let lines =
        lines.chain(goes_on.split_inclusive('\n').filter(|line| !line.starts_with("silence: ")));
    lines.filter(|line| !line.contains(" by test: ")).collect()
}

#[test]
fn whoever_commands_ends_the_silence() {
    let fixture = RunFixture::new(HELD);
    let (mut viewer, runner) = fixture.begin(fixture.launch());
    viewer.until_text("asked 1 by ROOT/DRIVE");
    viewer.send(&ToRunner::Ground { heard_ms_ago: None });
    expect![[r#"
        +ROOT
        +ROOT/DRIVE
        asked 1 by ROOT/DRIVE
        silence: link 0 ms, command 0 ms
        silence: link 20 ms, command 0 ms
        closed 1 TimedOut {"button":0} by 
        -ROOT/DRIVE=ok
        ROOT is held before ROOT/SAMPLE by Loss { loss: Link }
        silence: link 0 ms, command 0 ms
        +ROOT/SAMPLE
        -ROOT/SAMPLE=ok
        -ROOT=done
        finished done
    "#]]
    .assert_eq(&let_go(viewer));
    runner.join().unwrap();
}

#[test]
fn a_pause_is_a_command_too() {
    let fixture = RunFixture::new(&HELD.replace("lost_link", "lost_command"));
    let (mut viewer, runner) = fixture.begin(fixture.launch());
    viewer.until_text("asked 1 by ROOT/DRIVE");
    viewer.send(&ToRunner::Ground { heard_ms_ago: None });
    viewer.until_text("ROOT is held before ROOT/SAMPLE by Loss { loss: Command }");
    assert_eq!(viewer.command("pause", Command::Pause), "applied");
    viewer.until_text("silence: link 0 ms, command 0 ms");
    assert_eq!(viewer.command("stop", Command::Stop), "applied");
    viewer.into_end();
    runner.join().unwrap();
}

#[test]
fn a_run_that_dies_in_the_silence_is_resumed_in_it() {
    let machine = &HELD.replace("execution DRIVE \"consult\"", "execution DRIVE \"alone\"");
    let fixture = RunFixture::new(machine);
    fixture.die_alone("tests::ground::a_run_that_dies_in_the_silence_is_resumed_in_it");
    let (viewer, runner) = fixture.begin(fixture.resume(OnCrash::Abort, None));
    expect![[r"
        life 2 after a crash of ROOT/B: Abort
        +ROOT
        +ROOT/DRIVE
        -ROOT/DRIVE=aborted
        ROOT is held before ROOT/SAMPLE by Loss { loss: Link }
        silence: link 0 ms, command 0 ms
        +ROOT/SAMPLE
        -ROOT/SAMPLE=ok
        -ROOT=done
        finished done
    "]]
    .assert_eq(&let_go(viewer));
    runner.join().unwrap();
}

#[test]
fn a_run_without_a_ground_knows_no_silence() {
    let fixture = RunFixture::new(&HELD.replace("consult", "go"));
    let (viewer, runner) = fixture.begin(fixture.launch());
    expect![[r"
        +ROOT
        +ROOT/DRIVE
        -ROOT/DRIVE=ok
        +ROOT/SAMPLE
        -ROOT/SAMPLE=ok
        -ROOT=done
        finished done
    "]]
    .assert_eq(&viewer.into_end());
    runner.join().unwrap();
}
