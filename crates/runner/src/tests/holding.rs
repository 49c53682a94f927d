//! Runs that hold: from the start, by steps, by breakpoints with conditions, with and without viewers.

use super::served::RunFixture;
use expect_test::{Expect, expect};
use rafcon_protocol::{Afterwards, Breakpoint, Command, Launch, Scope, Unattended, When};
use rafcon_storage::journal::Reader;

const THREE: &str = "
hierarchy ROOT
  outcome done
  start -> A
  A.ok -> B
  B.ok -> C
  C.ok -> .done
  execution A
    outcome ok
  execution B
    outcome ok
  execution C
    outcome ok
";

fn breakpoint(path: &str, condition: Option<&str>) -> Breakpoint {
    Breakpoint {
        id: 1,
        path: path.to_owned(),
        when: When::Before,
        condition: condition.map(str::to_owned),
        hit_count: 0,
        scope: Scope::Branch,
        unattended: Unattended::Hold,
        lost_link_ms: None,
        enabled: true,
    }
}

/// A run with this launch and these commands, each sent after an event.
fn check(ask: impl FnOnce(&mut Launch), commands: &[(&str, Command)], expect: &Expect) {
    let fixture = RunFixture::new(THREE);
    let mut launch = fixture.launch();
    ask(&mut launch);
    let (mut viewer, runner) = fixture.begin(launch);
    for (number, (after, command)) in commands.iter().enumerate() {
        viewer.until_text(after);
        assert_eq!(viewer.command(&number.to_string(), command.clone()), "applied");
    }
    let text = viewer.into_end();
    let lines = text.split_inclusive('\n').filter(|line| !line.contains(" by test: "));
    expect.assert_eq(&lines.collect::<String>());
    runner.join().unwrap();
}

fn resume() -> Command {
    Command::Resume { branch: None }
}

#[test]
fn a_run_is_held_before_its_first_state_and_stepped() {
    check(
        |launch| launch.hold = true,
        &[
            ("ROOT is held before ROOT/A by Start", Command::StepInto { branch: None }),
            ("ROOT is held before ROOT/B by Step", Command::RunTo { path: "ROOT/C".to_owned() }),
            ("ROOT is held before ROOT/C by RunTo", resume()),
        ],
        &expect![[r"
            +ROOT
            ROOT is held before ROOT/A by Start
            +ROOT/A
            -ROOT/A=ok
            ROOT is held before ROOT/B by Step
            +ROOT/B
            -ROOT/B=ok
            ROOT is held before ROOT/C by RunTo
            +ROOT/C
            -ROOT/C=ok
            -ROOT=done
            finished done
        "]],
    );
}

#[test]
fn a_run_begins_at_a_state_and_is_held_or_stops_behind_it() {
    check(
        |launch| {
            launch.start_from = Some("ROOT/B".to_owned());
            launch.afterwards = Afterwards::Hold;
        },
        &[("ROOT is held before ROOT/C by Step", resume())],
        &expect![[r"
            +ROOT
            +ROOT/B
            -ROOT/B=ok
            ROOT is held before ROOT/C by Step
            +ROOT/C
            -ROOT/C=ok
            -ROOT=done
            finished done
        "]],
    );
    check(
        |launch| {
            launch.start_from = Some("ROOT/B".to_owned());
            launch.afterwards = Afterwards::Stop;
        },
        &[],
        &expect![[r"
            +ROOT
            +ROOT/B
            -ROOT/B=ok
            stopping
            -ROOT=preempted
            finished preempted
        "]],
    );
}

#[test]
fn a_breakpoint_holds_if_its_condition_is_true() {
    let held = "ROOT is held before ROOT/B by Breakpoint { id: 1 }";
    check(
        |launch| launch.breakpoints = vec![breakpoint("ROOT/B", Some("true"))],
        &[(held, resume())],
        &expect![[r#"
            BreakpointSet { breakpoint: Breakpoint { id: 1, path: "ROOT/B", when: Before, condition: Some("true"), hit_count: 0, scope: Branch, unattended: Hold, lost_link_ms: None, enabled: true } }
            +ROOT
            +ROOT/A
            -ROOT/A=ok
            Hit { breakpoint: 1, path: "ROOT/B", hits: 1, held: true }
            ROOT is held before ROOT/B by Breakpoint { id: 1 }
            +ROOT/B
            -ROOT/B=ok
            +ROOT/C
            -ROOT/C=ok
            -ROOT=done
            finished done
        "#]],
    );
    check(
        |launch| launch.breakpoints = vec![breakpoint("ROOT/B", Some("false"))],
        &[],
        &expect![[r#"
            BreakpointSet { breakpoint: Breakpoint { id: 1, path: "ROOT/B", when: Before, condition: Some("false"), hit_count: 0, scope: Branch, unattended: Hold, lost_link_ms: None, enabled: true } }
            +ROOT
            +ROOT/A
            -ROOT/A=ok
            +ROOT/B
            -ROOT/B=ok
            +ROOT/C
            -ROOT/C=ok
            -ROOT=done
            finished done
        "#]],
    );
}

#[test]
fn a_condition_that_cannot_be_told_holds_and_says_why() {
    let held = "ROOT is held before ROOT/B by Breakpoint { id: 1 }";
    check(
        |launch| launch.breakpoints = vec![breakpoint("ROOT/B", Some("1 +"))],
        &[(held, resume())],
        &expect![[r#"
            BreakpointSet { breakpoint: Breakpoint { id: 1, path: "ROOT/B", when: Before, condition: Some("1 +"), hit_count: 0, scope: Branch, unattended: Hold, lost_link_ms: None, enabled: true } }
            +ROOT
            +ROOT/A
            -ROOT/A=ok
            log ROOT/B: the condition of breakpoint 1 cannot be evaluated (cannot read 1 +); it holds as if the condition were true
            Hit { breakpoint: 1, path: "ROOT/B", hits: 1, held: true }
            ROOT is held before ROOT/B by Breakpoint { id: 1 }
            +ROOT/B
            -ROOT/B=ok
            +ROOT/C
            -ROOT/C=ok
            -ROOT=done
            finished done
        "#]],
    );
}

#[test]
fn a_breakpoint_lets_go_on_when_nobody_looks_any_more_if_it_says_so() {
    let fixture = RunFixture::new(THREE);
    let breakpoint = Breakpoint { unattended: Unattended::Continue, ..breakpoint("ROOT/B", None) };
    let launch = Launch { breakpoints: vec![breakpoint], ..fixture.launch() };
    let (mut viewer, runner) = fixture.begin(launch);
    viewer.until_text("ROOT is held before ROOT/B by Breakpoint { id: 1 }");
    drop(viewer);
    runner.join().unwrap();
}

#[test]
fn the_journal_knows_a_skipped_branch_as_ended() {
    let machine = "
barrier ROOT
  outcome done
  unique_decider_state_id.ok -> .done
  execution A \"wait\"
    outcome ok
  execution B
    outcome ok
  decider unique_decider_state_id
    outcome ok
";
    let fixture = RunFixture::new(machine);
    let breakpoints = vec![breakpoint("ROOT/B", None)];
    let (mut viewer, runner) = fixture.begin(Launch { breakpoints, ..fixture.launch() });
    viewer.until_text("ROOT is held before ROOT/B by Breakpoint { id: 1 }");
    let force = Command::ForceOutcome { path: "ROOT/B".to_owned(), outcome: 0 };
    assert_eq!(viewer.command("force", force), "applied");
    let mut second = fixture.join(1, false);
    second.until_text("force_outcome by test: Applied");
    let mut reader = Reader::open(&fixture.run_folder()).unwrap();
    let active = reader.moment(u64::MAX).unwrap().active();
    let ended: Vec<_> = active[0].ended.iter().map(|end| (end.state(), end.outcome)).collect();
    assert_eq!(ended, [("B", 0)]);
    assert_eq!(viewer.command("stop", Command::Stop), "applied");
    drop(viewer);
    runner.join().unwrap();
}
