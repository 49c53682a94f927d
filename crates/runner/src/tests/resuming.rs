//! Runs that are resumed after their runner died, or restarted at an entry of their history.

use super::served::{Actors, RunFixture, Viewer};
use expect_test::{Expect, expect};
use rafcon_protocol::{Breakpoint, Command, Event, Launch, OnCrash, ToRunner, ToViewer};
use rafcon_storage::journal::folder::RECORDER_FILE;
use rafcon_storage::journal::{About, Journal, Options, Reader};
use std::os::unix::net::UnixStream;

/// Adds to a number twice. Between that, a script dies with its runner in the first life.
const DIES: &str = "
hierarchy ROOT
  outcome done
  outcome rescued
  out sum: int
  out why: object
  var total: int = 40
  start -> A
  A.ok -> B
  B.ok -> C
  B.aborted -> RESCUE
  C.ok -> .done
  RESCUE.ok -> .rescued
  flow .total -> A.number
  flow A.number -> .total
  flow .total -> B.number
  flow .total -> C.number
  flow C.number -> .total
  flow .total -> .sum
  flow RESCUE.why -> .why
  execution A \"add\"
    outcome ok
    in number: int
    out number: int
  execution B \"die\"
    outcome ok
    in number: int
  execution C \"add\"
    outcome ok
    in number: int
    out number: int
  execution RESCUE \"show\"
    outcome ok
    out why: object
";

fn died(machine: &str, test: &str) -> RunFixture {
    let fixture = RunFixture::new(machine);
    fixture.die(&format!("tests::resuming::{test}"));
    fixture
}

/// The number of the first entry of a state.
fn entry(fixture: &RunFixture, wanted: &str) -> u64 {
    let mut reader = Reader::open(&fixture.run_folder()).unwrap();
    let entries = reader.page(1, 100).unwrap();
    let entry = entries.iter().find(|entry| {
        matches!(reader.event(entry, false).unwrap(), Event::Entered { path, .. } if path == wanted)
    });
    entry.unwrap().sequence
}

/// The output of the run's next life, with these commands, each sent after an event.
fn check(
    fixture: &RunFixture,
    (policy, from): (OnCrash, Option<u64>),
    commands: &[(&str, Command)],
    expect: &Expect,
) {
    let (mut viewer, runner) = fixture.begin(fixture.resume(policy, from));
    for (after, command) in commands {
        viewer.until_text(after);
        assert_eq!(viewer.command(after, command.clone()), "applied");
    }
    expect.assert_eq(&without_commands(&viewer.into_end()));
    runner.join().unwrap();
}

/// Removes the records of commands, whose position among the events of scripts varies.
fn without_commands(text: &str) -> String {
    text.split_inclusive('\n').filter(|line| !line.contains(" by test: ")).collect()
}

#[test]
fn interrupted_states_abort_and_recovery_takes_over() {
    let fixture = died(DIES, "interrupted_states_abort_and_recovery_takes_over");
    check(
        &fixture,
        (OnCrash::Abort, None),
        &[],
        &expect![[r#"
        life 2 after a crash of ROOT/B: Abort
        +ROOT
        +ROOT/B
        -ROOT/B=aborted
        +ROOT/RESCUE
        -ROOT/RESCUE=ok
        -ROOT=rescued
        finished rescued {"sum":41,"why":"the runner of this run ended in the middle of it: a crash; the scripts of ROOT/B were running"}
    "#]],
    );
}

#[test]
fn interrupted_states_run_again_with_the_data_they_had() {
    let fixture = died(DIES, "interrupted_states_run_again_with_the_data_they_had");
    check(
        &fixture,
        (OnCrash::Restart, None),
        &[],
        &expect![[r#"
        life 2 after a crash of ROOT/B: Restart
        +ROOT
        +ROOT/B
        -ROOT/B=ok
        +ROOT/C
        -ROOT/C=ok
        -ROOT=done
        finished done {"sum":42,"why":null}
    "#]],
    );
}

/// Adds to its input, unless it starts at its second state.
const GIVEN: &str = "
hierarchy ROOT
  outcome done
  in number: int
  out sum: int
  start -> A
  A.ok -> C
  C.ok -> .done
  flow .number -> C.number
  flow C.number -> .sum
  execution A \"show\"
    outcome ok
    in why: object
    out why: object
  execution C \"add\"
    outcome ok
    in number: int
    out number: int
";

/// Resumes a run that died before its first event. It continues after it was held with this text.
fn check_blank(change: impl FnOnce(Launch) -> Launch, held: Option<&str>, expect: &Expect) {
    let fixture = RunFixture::new(GIVEN);
    let number = ("number".to_owned(), 6.into());
    let launch = change(Launch { inputs: vec![number], ..fixture.launch() });
    let about = About {
        machine: fixture.machine(),
        config: launch.config.clone(),
        beginning: launch.beginning(),
        ..About::default()
    };
    drop(Journal::create(&fixture.run_folder(), &about, &Options::default()).unwrap());
    let commands = held.map(|held| (held, Command::Resume { branch: None }));
    check(&fixture, (OnCrash::Ask, None), commands.as_slice(), expect);
}

#[test]
fn a_run_that_died_before_anything_had_happened_begins_as_it_was_asked_to() {
    check_blank(
        |launch| launch,
        None,
        &expect![[r#"
            life 2 after a crash of ROOT/B: Ask
            +ROOT
            +ROOT/A
            -ROOT/A=ok
            +ROOT/C
            -ROOT/C=ok
            -ROOT=done
            finished done {"sum":7}
        "#]],
    );
    let start_from = Some("ROOT/C".to_owned());
    check_blank(
        |launch| Launch { start_from, ..launch },
        None,
        &expect![[r#"
            life 2 after a crash of ROOT/B: Ask
            +ROOT
            +ROOT/C
            -ROOT/C=ok
            -ROOT=done
            finished done {"sum":7}
        "#]],
    );
    let held = Some("ROOT is held before ROOT/A by Start");
    check_blank(
        |launch| Launch { hold: true, ..launch },
        held,
        &expect![[r#"
            life 2 after a crash of ROOT/B: Ask
            +ROOT
            ROOT is held before ROOT/A by Start
            +ROOT/A
            -ROOT/A=ok
            +ROOT/C
            -ROOT/C=ok
            -ROOT=done
            finished done {"sum":7}
        "#]],
    );
    let breakpoint = serde_json::json!({ "id": 1, "path": "ROOT/C" });
    let breakpoints: Vec<Breakpoint> = vec![serde_json::from_value(breakpoint).unwrap()];
    let held = Some("ROOT is held before ROOT/C by Breakpoint { id: 1 }");
    check_blank(
        |launch| Launch { breakpoints, ..launch },
        held,
        &expect![[r#"
            life 2 after a crash of ROOT/B: Ask
            BreakpointSet { breakpoint: Breakpoint { id: 1, path: "ROOT/C", when: Before, condition: None, hit_count: 0, scope: Branch, unattended: Hold, lost_link_ms: None, enabled: true } }
            +ROOT
            +ROOT/A
            -ROOT/A=ok
            Hit { breakpoint: 1, path: "ROOT/C", hits: 1, held: true }
            ROOT is held before ROOT/C by Breakpoint { id: 1 }
            +ROOT/C
            -ROOT/C=ok
            -ROOT=done
            finished done {"sum":7}
        "#]],
    );
}

#[test]
fn nothing_moves_until_somebody_decides() {
    let fixture = died(DIES, "nothing_moves_until_somebody_decides");
    let restart = Command::Recover { path: Some("ROOT/B".to_owned()), policy: OnCrash::Restart };
    let resume = Command::Resume { branch: None };
    check(
        &fixture,
        (OnCrash::Ask, None),
        &[
            (
                "ROOT/B waits: its script was interrupted by a crash: decide whether it aborts or runs again, or force an outcome",
                restart,
            ),
            ("ROOT is held before ROOT/C by Step", resume),
        ],
        &expect![[r#"
        life 2 after a crash of ROOT/B: Ask
        +ROOT
        +ROOT/B
        ROOT/B waits: its script was interrupted by a crash: decide whether it aborts or runs again, or force an outcome
        -ROOT/B=ok
        ROOT is held before ROOT/C by Step
        +ROOT/C
        -ROOT/C=ok
        -ROOT=done
        finished done {"sum":42,"why":null}
    "#]],
    );
}

#[test]
fn a_run_begins_again_at_an_entry_of_its_history() {
    let fixture = died(DIES, "a_run_begins_again_at_an_entry_of_its_history");
    let resume = Command::Resume { branch: None };
    let entry = entry(&fixture, "ROOT/A");
    check(
        &fixture,
        (OnCrash::Ask, Some(entry)),
        &[("ROOT is held before ROOT/A by Start", resume)],
        &expect![[r#"
            life 2 after a crash of ROOT/B: Ask
            WentBack { sequence: 4 }
            +ROOT
            ROOT is held before ROOT/A by Start
            +ROOT/A
            -ROOT/A=ok
            +ROOT/B
            -ROOT/B=ok
            +ROOT/C
            -ROOT/C=ok
            -ROOT=done
            finished done {"sum":42,"why":null}
        "#]],
    );
}

#[test]
fn a_run_whose_root_was_left_ends_as_it_did() {
    let machine = "
hierarchy ROOT \"brief\"
  outcome done
  out sum: int
  start -> A
  A.ok -> .done
  flow A.number -> .sum
  execution A \"add\"
    outcome ok
    in number: int = 1
    out number: int
";
    let fixture = died(machine, "a_run_whose_root_was_left_ends_as_it_did");
    check(
        &fixture,
        (OnCrash::Abort, None),
        &[],
        &expect![[r#"
            life 2 after a crash of ROOT/B: Abort
            finished done {"sum":2}
        "#]],
    );
}

/// Two branches, of which one dies. The decider's outcome depends on neither.
const FORKS: &str = "
barrier ROOT
  outcome done
  unique_decider_state_id.ok -> .done
  execution A \"wait\"
    outcome ok
  hierarchy C
    outcome ok
    start -> D
    D.ok -> E
    E.aborted -> F
    F.ok -> .ok
    execution D
      outcome ok
    execution E \"die\"
      outcome ok
    execution F
      outcome ok
  decider unique_decider_state_id
    outcome ok
";

#[test]
fn all_branches_are_resumed_where_they_were() {
    let fixture = died(FORKS, "all_branches_are_resumed_where_they_were");
    let (viewer, runner) = fixture.begin(fixture.resume(OnCrash::Abort, None));
    let text = viewer.into_end();
    let mut lines: Vec<&str> = text.lines().collect();
    lines.sort_unstable();
    expect![[r"
        +ROOT
        +ROOT/A
        +ROOT/C
        +ROOT/C/E
        +ROOT/C/F
        +ROOT/unique_decider_state_id
        -ROOT/A=aborted
        -ROOT/C/E=aborted
        -ROOT/C/F=ok
        -ROOT/C=ok
        -ROOT/unique_decider_state_id=ok
        -ROOT=done
        finished done
        life 2 after a crash of ROOT/B: Abort"]]
    .assert_eq(&lines.join("\n"));
    runner.join().unwrap();
}

/// Only one state needs the lost number.
const LOSES: &str = "
hierarchy ROOT
  outcome done
  in lost: str = \"lost\"
  start -> A
  A.ok -> B
  B.ok -> C
  C.aborted -> D
  D.ok -> .done
  flow .lost -> C.text
  execution A
    outcome ok
  execution B \"die\"
    outcome ok
  execution C
    outcome ok
    in text: str
  execution D
    outcome ok
";

#[test]
fn a_state_that_needs_a_lost_value_aborts_and_names_it() {
    let fixture = died(LOSES, "a_state_that_needs_a_lost_value_aborts_and_names_it");
    check(
        &fixture,
        (OnCrash::Restart, None),
        &[],
        &expect![[r#"
        life 2 after a crash of ROOT/B: Restart
        +ROOT
        +ROOT/B
        -ROOT/B=ok
        +ROOT/C
        log ROOT/C: the value of "lost" of ROOT cannot be made again: it was lost
        -ROOT/C=aborted
        +ROOT/D
        -ROOT/D=ok
        -ROOT=done
        finished done
    "#]],
    );
}

/// Three states in sequence.
const THREE: &str = "
hierarchy ROOT
  outcome done
  start -> A
  A.ok -> B
  B.ok -> C
  C.ok -> .done
  C.preempted -> A
  execution A
    outcome ok
  execution B
    outcome ok
  execution C \"wait\"
    outcome ok
";

#[test]
fn a_run_that_stands_still_goes_back_to_an_entry_of_its_history() {
    let fixture = RunFixture::new(THREE);
    let (mut viewer, runner) = fixture.begin(fixture.launch());
    viewer.until_text("+ROOT/C");
    let entry = entry(&fixture, "ROOT/B");
    let back = Command::StartFromHistory { sequence: entry };
    let refused = viewer.command("running", back.clone());
    assert!(refused.starts_with("refused: "), "{refused}");
    let preempt = Command::Preempt { path: "ROOT/C".to_owned() };
    assert_eq!(viewer.command("step", Command::StepMode), "applied");
    assert_eq!(viewer.command("preempt", preempt), "applied");
    viewer.until_text("-ROOT/C=preempted");
    assert_eq!(viewer.command("back", back), "applied");
    assert_eq!(viewer.command("on", Command::StepOver { branch: None }), "applied");
    viewer.until_text("-ROOT/B=ok");
    assert_eq!(viewer.command("stop", Command::Stop), "applied");
    let text = viewer.into_end();
    let after = text.split_once("-ROOT/C=preempted\n").unwrap().1;
    expect![[r#"
        ROOT is held before ROOT/A by Step
        WentBack { sequence: 5 }
        Dropped { path: "ROOT" }
        +ROOT
        ROOT is held before ROOT/B by Start
        +ROOT/B
        -ROOT/B=ok
        ROOT is held before ROOT/C by Step
        stopping
        -ROOT=preempted
        finished preempted
    "#]]
    .assert_eq(&without_commands(after));
    runner.join().unwrap();
}

#[test]
fn a_refused_way_back_leaves_global_variables_as_they_are() {
    let counts = THREE.replace("execution A", "execution A \"count\"");
    let fixture = RunFixture::new(&counts.replace("execution B", "execution B \"count\""));
    let (mut viewer, runner) = fixture.begin(fixture.launch());
    viewer.until_text("+ROOT/C");
    let back = Command::StartFromHistory { sequence: entry(&fixture, "ROOT/B") };
    assert!(viewer.command("back", back).starts_with("refused: "));
    assert_eq!(viewer.command("stop", Command::Stop), "applied");
    let count = viewer.until(|message| match message {
        ToViewer::Event { event: Event::Finished { globals, .. }, .. } => {
            globals.get("count").cloned()
        }
        _ => None,
    });
    // A follows the preemption of C.
    assert_eq!(count, serde_json::json!(3));
    drop(viewer);
    runner.join().unwrap();
}

#[test]
fn a_run_that_is_over_or_goes_on_is_not_resumed() {
    let fixture = RunFixture::new(THREE);
    let (mut viewer, runner) = fixture.begin(fixture.launch());
    viewer.until_text("+ROOT/C");
    let refused = refusal(&fixture);
    assert!(refused.contains("still active"), "{refused}");
    assert_eq!(viewer.command("stop", Command::Stop), "applied");
    drop(viewer);
    runner.join().unwrap();
    expect!["the run has come to its end; begin a new one, or choose an entry of its history to begin from"]
        .assert_eq(&refusal(&fixture));
    assert!(!fixture.run_folder().join(RECORDER_FILE).exists());
}

/// The reason why the run is not resumed.
fn refusal(fixture: &RunFixture) -> String {
    let (ours, theirs) = UnixStream::pair().unwrap();
    let runner = std::thread::Builder::new();
    let runner = runner.spawn(move || crate::serve(theirs, Actors)).unwrap();
    let mut viewer = Viewer::new(ours);
    viewer.send(&ToRunner::Launch(fixture.resume(OnCrash::Abort, None)));
    let reason = viewer.until(|message| match message {
        ToViewer::LoadFailed { reason } => Some(reason.clone()),
        _ => None,
    });
    runner.join().unwrap().unwrap_err();
    reason
}

/// A script that runs until it is asked to end.
const WAITS: &str = "
hierarchy ROOT
  outcome done
  start -> A
  A.ok -> .done
  execution A \"wait\"
    outcome ok
";

#[test]
fn a_command_is_carried_out_once_over_all_lives_of_a_run() {
    let fixture = RunFixture::new(WAITS);
    let nowhere = Command::RunTo { path: "ROOT/X".to_owned() };
    let commands = [("pause", Command::Pause), ("odd", nowhere)];
    let test = "tests::resuming::a_command_is_carried_out_once_over_all_lives_of_a_run";
    fixture.die_after(test, "+ROOT/A", &commands);
    let (mut viewer, runner) = fixture.begin(fixture.resume(OnCrash::Restart, None));
    viewer.until_text("+ROOT/A");
    assert_eq!(viewer.command("pause", Command::Stop), "applied");
    let refused = viewer.command("odd", Command::Stop);
    assert!(refused.starts_with("refused: there is no state at 'ROOT/X'"), "{refused}");
    assert_eq!(viewer.command("stop", Command::Stop), "applied");
    let text = viewer.into_end();
    let commands: Vec<&str> = text.lines().filter(|line| line.contains(" by test: ")).collect();
    assert_eq!(commands, ["stop by test: Applied"]);
    runner.join().unwrap();
}

#[test]
fn a_command_and_what_it_leads_to_are_kept_together() {
    let fixture = RunFixture::new(WAITS);
    let (mut viewer, runner) = fixture.begin(fixture.launch());
    viewer.until_text("+ROOT/A");
    assert_eq!(viewer.command("pause", Command::Pause), "applied");
    assert_eq!(viewer.command("stop", Command::Stop), "applied");
    drop(viewer.into_end());
    runner.join().unwrap();
    let mut reader = Reader::open(&fixture.run_folder()).unwrap();
    let entries = reader.page(1, 100).unwrap();
    let told = entries.iter().filter_map(|entry| match reader.event(entry, false).unwrap() {
        Event::Commanded { envelope, .. } => Some((entry.t_ns, envelope.id)),
        Event::Paused { paused: true } => Some((entry.t_ns, "paused".to_owned())),
        Event::Stopping => Some((entry.t_ns, "stopping".to_owned())),
        _ => None,
    });
    let told: Vec<_> = told.collect();
    let names: Vec<&str> = told.iter().map(|(_, name)| name.as_str()).collect();
    assert_eq!(names, ["paused", "pause", "stopping", "stop"]);
    assert!(told.chunks(2).all(|pair| pair[0].0 == pair[1].0), "{told:?}");
}

#[test]
fn a_run_that_was_stopping_when_its_script_was_cut_off_comes_to_its_end() {
    let machine = "
hierarchy ROOT
  outcome done
  start -> B
  B.ok -> .done
  execution B \"stuck\"
    outcome ok
";
    let fixture = RunFixture::new(machine);
    let test = "a_run_that_was_stopping_when_its_script_was_cut_off_comes_to_its_end";
    fixture.die_after(&format!("tests::resuming::{test}"), "+ROOT/B", &[("stop", Command::Stop)]);
    let (viewer, runner) = fixture.begin(fixture.resume(OnCrash::Abort, None));
    let text = viewer.into_end();
    runner.join().unwrap();
    assert!(text.contains("-ROOT/B=aborted\n") && text.contains("\nfinished "), "{text}");
}

/// The first script never ends. Another state follows its preemption.
const STUCK: &str = "
hierarchy ROOT
  outcome done
  start -> A
  A.ok -> .done
  A.preempted -> B
  B.ok -> .done
  execution A \"stuck\"
    outcome ok
  execution B
    outcome ok
";

#[test]
fn a_state_that_was_preempted_stays_so_when_it_is_resumed() {
    let fixture = RunFixture::new(STUCK);
    let test = "tests::resuming::a_state_that_was_preempted_stays_so_when_it_is_resumed";
    let preempt = Command::Preempt { path: "ROOT/A".to_owned() };
    fixture.die_after(test, "+ROOT/A", &[("preempt", preempt)]);
    let resume = Command::Resume { branch: None };
    check(
        &fixture,
        (OnCrash::Ask, None),
        &[("ROOT is held before ROOT/B by Start", resume)],
        &expect![[r"
            life 2 after a crash of ROOT/B: Ask
            +ROOT
            +ROOT/A
            -ROOT/A=preempted
            ROOT is held before ROOT/B by Start
            +ROOT/B
            -ROOT/B=ok
            -ROOT=done
            finished done
        "]],
    );
}

/// A machine without a start transition.
const STARTLESS: &str = "
hierarchy ROOT
  outcome done
  B.preempted -> C
  C.ok -> .done
  execution B \"wait\"
    outcome ok
  execution C
    outcome ok
";

#[test]
fn a_run_of_one_state_alone_still_stops_behind_it_when_it_is_resumed() {
    let fixture = RunFixture::new(STARTLESS);
    let test = "tests::resuming::a_run_of_one_state_alone_still_stops_behind_it_when_it_is_resumed";
    let only = Command::RunOnlySelected { path: "ROOT/B".to_owned(), data: Vec::new() };
    fixture.die_after(
        test,
        "ROOT waits: there is no start state: connect the income, or stop the run",
        &[("only", only)],
    );
    let preempt = Command::Preempt { path: "ROOT/B".to_owned() };
    check(
        &fixture,
        (OnCrash::Restart, None),
        &[("+ROOT/B", preempt)],
        &expect![[r"
        life 2 after a crash of ROOT/B: Restart
        +ROOT
        +ROOT/B
        -ROOT/B=preempted
        stopping
        +ROOT/C
        -ROOT/C=ok
        -ROOT=preempted
        finished preempted
    "]],
    );
}
