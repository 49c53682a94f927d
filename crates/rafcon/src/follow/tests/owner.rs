//! The life of a run whose process is ours, as text: causes in, actions and exit code out.

use crate::event_queue::Cause;
use crate::follow::{Action, RunFollower, RunRole, StopSignal};
use expect_test::{Expect, expect};
use rafcon_protocol::{
    ActiveState, Event, Hello, Outcome, Phase, RunStatus, Snapshot, Stream, ToRunner, ToViewer,
};
use rafcon_supervisor::Exit;
use std::fmt::Write as _;
use std::os::unix::process::ExitStatusExt as _;
use std::process::ExitStatus;
use std::time::Duration;

/// Runs a script of `seconds word argument`, with a timeout of ten seconds. The number of an event is that of its line.
fn check(script: &str, expect: &Expect) {
    let deadline = Some(Duration::from_secs(10));
    let mut run = RunFollower::new(RunRole::Owner, "ana", "run".to_owned(), deadline);
    let mut seen = String::new();
    let lines = script.lines().map(str::trim).filter(|line| !line.is_empty());
    for (number, line) in (1..).zip(lines) {
        let (seconds, what) = line.split_once(' ').unwrap();
        let now = Duration::from_secs_f64(seconds.parse().unwrap());
        let mut actions = Vec::new();
        run.handle(now, cause(number, what), &mut actions);
        for action in actions {
            writeln!(seen, "{seconds}: {}", shown(&action)).unwrap();
        }
        if let Some(end) = run.end(now) {
            writeln!(seen, "{seconds}: {end:?}, exit code {}", end.code()).unwrap();
        }
    }
    expect.assert_eq(&seen);
}

fn cause(number: u64, text: &str) -> Cause {
    let event = |event| message(ToViewer::Event { sequence: number, t_ns: 0, event });
    let (word, argument) = text.split_once(' ').unwrap_or((text, ""));
    match word {
        "hello" => Cause::Hello(Hello::ours()),
        "stranger" => Cause::Hello(Hello { protocol: 99, program: "9.9".to_owned() }),
        "loaded" => message(ToViewer::Loaded {
            name: "M".to_owned(),
            states: 2,
            problems: vec![],
            run: String::new(),
        }),
        "load-failed" => message(ToViewer::LoadFailed { reason: argument.to_owned() }),
        "entered" => {
            event(Event::Entered { path: argument.to_owned(), inputs: None, undoes: None })
        }
        "left" => event(Event::Left {
            path: argument.to_owned(),
            outcome: outcome(0),
            outputs: None,
            error: None,
            undoes: None,
        }),
        "finished" => event(Event::Finished {
            outcome: outcome(argument.parse().unwrap()),
            outputs: serde_json::Map::default(),
            globals: serde_json::Map::default(),
            scoped_variables: serde_json::Map::default(),
            states_run: 2,
        }),
        "snapshot" => {
            let (sequence, path) = argument.split_once(' ').unwrap();
            snapshot(sequence.parse().unwrap(), path)
        }
        "stderr" => Cause::Raw(Stream::Stderr, argument.to_owned()),
        "drained" => Cause::Drained(Stream::Stderr),
        "silence" => Cause::Silence,
        "exited" => Cause::Exited(Exit(ExitStatus::from_raw(argument.parse().unwrap()))),
        "interrupt" => Cause::Interrupt(StopSignal::CtrlC),
        "terminate" => Cause::Interrupt(StopSignal::Terminate),
        "tick" => Cause::Tick,
        other => panic!("no cause {other}"),
    }
}

fn message(message: ToViewer) -> Cause {
    Cause::Messages(vec![message])
}

/// A snapshot after event `sequence`, in which only a state is active.
fn snapshot(sequence: u64, path: &str) -> Cause {
    let state = ActiveState {
        path: path.to_owned(),
        name: String::new(),
        phase: Phase::Running,
        since_ms: 0,
        branch: String::new(),
        detail: None,
        held: vec![],
    };
    message(ToViewer::Snapshot(Snapshot {
        status: RunStatus::Running,
        active: vec![state],
        states_run: 0,
        elapsed_ms: 0,
        sequence,
        disk_safe: 0,
        journal_problem: None,
        breakpoints: vec![],
        questions: vec![],
    }))
}

fn outcome(id: i64) -> Outcome {
    Outcome { id, name: "done".to_owned() }
}

fn shown(action: &Action) -> String {
    match action {
        Action::Send(ToRunner::Command(envelope)) => format!("send {:?}", envelope.command),
        Action::Show(ToViewer::Event { event: Event::Finished { .. }, .. }) => {
            "show finished".to_owned()
        }
        Action::Show(ToViewer::Event { event, .. }) => format!("show {event:?}"),
        Action::Show(shown) => format!("{shown:?}"),
        other => format!("{other:?}"),
    }
}

#[test]
fn a_run_ends_by_its_outcome() {
    check(
        "0 hello
         0 loaded
         1 entered A
         1 left A
         2 finished 3
         2 silence
         2 exited 0",
        &expect![[r#"
            0: Loaded { name: "M", states: 2, problems: [], run: "" }
            1: show Entered { path: "A", inputs: None, undoes: None }
            1: show Left { path: "A", outcome: Outcome { id: 0, name: "done" }, outputs: None, error: None, undoes: None }
            2: show finished
            2: Finished { outcome: Outcome { id: 3, name: "done" }, timed_out: false }, exit code 3
        "#]],
    );
}

#[test]
fn ctrl_c_stops_and_a_second_one_kills() {
    check(
        "0 hello
         0 loaded
         1 interrupt
         3 interrupt
         3.001 interrupt
         3.001 silence
         3.001 exited 9",
        &expect![[r#"
            0: Loaded { name: "M", states: 2, problems: [], run: "" }
            1: Note("stopping; press Ctrl-C again after 2 s to kill")
            1: send Stop
            3: Note("press Ctrl-C again after 2 s to kill")
            3.001: Kill
            3.001: Killed { timed_out: false, has_begun: true, active: [] }, exit code 8
        "#]],
    );
}

#[test]
fn doubled_signals_leave_a_machine_its_recovery() {
    check(
        "0 hello
         0 loaded
         1 terminate
         1.3 terminate
         1.305 interrupt
         8 terminate
         9 finished -2
         9 silence
         9 terminate
         9 exited 0",
        &expect![[r#"
            0: Loaded { name: "M", states: 2, problems: [], run: "" }
            1: Note("stopping; press Ctrl-C again after 2 s to kill")
            1: send Stop
            1.305: Note("press Ctrl-C again after 2 s to kill")
            9: show finished
            9: Finished { outcome: Outcome { id: -2, name: "done" }, timed_out: false }, exit code 5
        "#]],
    );
}

#[test]
fn a_process_that_never_answers_is_killed_by_signal_or_time() {
    check(
        "1 terminate\n 1 exited 9\n 2 tick",
        &expect![[r"
            1: Kill
            2: Killed { timed_out: false, has_begun: false, active: [] }, exit code 5
        "]],
    );
    check(
        "10 tick\n 10 exited 9\n 11 tick",
        &expect![[r"
            10: Kill
            11: Killed { timed_out: true, has_begun: false, active: [] }, exit code 6
        "]],
    );
}

#[test]
fn a_machine_that_stops_after_ctrl_c_was_preempted() {
    check(
        "0 hello
         0 loaded
         1 interrupt
         2 finished -2
         2 exited 0
         3 tick",
        &expect![[r#"
            0: Loaded { name: "M", states: 2, problems: [], run: "" }
            1: Note("stopping; press Ctrl-C again after 2 s to kill")
            1: send Stop
            2: show finished
            3: Finished { outcome: Outcome { id: -2, name: "done" }, timed_out: false }, exit code 5
        "#]],
    );
}

#[test]
fn a_machine_that_hangs_is_stopped_when_its_time_is_over_and_then_killed() {
    check(
        "0 hello
         0 loaded
         9 tick
         10 tick
         12 tick
         13 tick
         13 silence
         13 exited 9",
        &expect![[r#"
            0: Loaded { name: "M", states: 2, problems: [], run: "" }
            10: Note("the time limit expired; stopping")
            10: send Stop
            13: Kill
            13: Killed { timed_out: true, has_begun: true, active: [] }, exit code 8
        "#]],
    );
}

#[test]
fn a_machine_that_stops_in_time_was_timed_out_all_the_same() {
    check(
        "0 hello
         0 loaded
         10 tick
         11 finished -2
         11 silence
         11 exited 0",
        &expect![[r#"
            0: Loaded { name: "M", states: 2, problems: [], run: "" }
            10: Note("the time limit expired; stopping")
            10: send Stop
            11: show finished
            11: Finished { outcome: Outcome { id: -2, name: "done" }, timed_out: true }, exit code 6
        "#]],
    );
}

#[test]
fn a_runner_that_dies_leaves_what_was_active_and_what_it_said() {
    check(
        "0 hello
         0 loaded
         1 entered A
         1 entered A/B
         1 entered A/C
         1 left A/B
         2 exited 11
         2 silence
         2 stderr Fatal Python error: Segmentation fault
         2 drained",
        &expect![[r#"
            0: Loaded { name: "M", states: 2, problems: [], run: "" }
            1: show Entered { path: "A", inputs: None, undoes: None }
            1: show Entered { path: "A/B", inputs: None, undoes: None }
            1: show Entered { path: "A/C", inputs: None, undoes: None }
            1: show Left { path: "A/B", outcome: Outcome { id: 0, name: "done" }, outputs: None, error: None, undoes: None }
            2: show Log { path: "", level: Error, stream: Stderr, message: "Fatal Python error: Segmentation fault" }
            2: Died(RunnerDeath { reason: "killed by signal 11 (SIGSEGV)", active: ["A", "A/C"], said: ["Fatal Python error: Segmentation fault"], is_cut_off: false, is_wanted: false }), exit code 7
        "#]],
    );
}

#[test]
fn a_snapshot_may_come_before_events_that_it_knows_and_after_events_that_it_does_not() {
    check(
        "0 hello
         0 loaded
         1 snapshot 5 A
         1 entered A
         1 stderr no event
         1 entered A/B
         1 snapshot 5 A
         2 exited 11
         2 silence
         2 drained",
        &expect![[r#"
            0: Loaded { name: "M", states: 2, problems: [], run: "" }
            1: Snapshot(Snapshot { status: Running, active: [ActiveState { path: "A", name: "", phase: Running, since_ms: 0, branch: "", detail: None, held: [] }], states_run: 0, elapsed_ms: 0, sequence: 5, disk_safe: 0, journal_problem: None, breakpoints: [], questions: [] })
            1: show Entered { path: "A", inputs: None, undoes: None }
            1: show Log { path: "", level: Error, stream: Stderr, message: "no event" }
            1: show Entered { path: "A/B", inputs: None, undoes: None }
            1: Snapshot(Snapshot { status: Running, active: [ActiveState { path: "A", name: "", phase: Running, since_ms: 0, branch: "", detail: None, held: [] }], states_run: 0, elapsed_ms: 0, sequence: 5, disk_safe: 0, journal_problem: None, breakpoints: [], questions: [] })
            2: Died(RunnerDeath { reason: "killed by signal 11 (SIGSEGV)", active: ["A", "A/B"], said: ["no event"], is_cut_off: false, is_wanted: false }), exit code 7
        "#]],
    );
}

#[test]
fn a_child_that_holds_the_socket_does_not_keep_us_waiting() {
    check(
        "0 hello
         0 loaded
         1 exited 256
         2 tick",
        &expect![[r#"
            0: Loaded { name: "M", states: 2, problems: [], run: "" }
            2: Died(RunnerDeath { reason: "exit status 1", active: [], said: [], is_cut_off: false, is_wanted: false }), exit code 7
        "#]],
    );
}

#[test]
fn an_interpreter_that_never_becomes_a_runner_is_a_run_that_did_not_begin() {
    check(
        "0 silence
         0 exited 256
         0 stderr No module named encodings
         0 drained",
        &expect![[r#"
            0: NotStarted { reason: "exit status 1", said: ["No module named encodings"] }, exit code 1
        "#]],
    );
}

#[test]
fn a_stranger_is_not_spoken_with() {
    check(
        "0 stranger
         0 silence
         0 exited 9",
        &expect![[r#"
            0: Kill
            0: NotStarted { reason: "the other side (version 9.9) speaks protocol 99, this one speaks 3: install the rafcon binary and its extension from the same build", said: [] }, exit code 1
        "#]],
    );
}

#[test]
fn a_machine_that_does_not_load() {
    check(
        "0 hello
         0 load-failed there is no machine in /x
         0 silence
         0 exited 0",
        &expect![[r#"
            0: LoadFailed { reason: "there is no machine in /x" }, exit code 1
        "#]],
    );
}

#[test]
fn a_runner_that_stays_after_its_end_is_killed() {
    check(
        "0 hello
         0 loaded
         1 finished 0
         2 tick
         4 tick
         4 silence
         4 exited 9",
        &expect![[r#"
            0: Loaded { name: "M", states: 2, problems: [], run: "" }
            1: show finished
            4: Kill
            4: Finished { outcome: Outcome { id: 0, name: "done" }, timed_out: false }, exit code 0
        "#]],
    );
}

#[test]
fn a_script_that_closes_the_connection_ends_the_run() {
    check(
        "0 hello
         0 loaded
         1 entered A
         1 silence
         4 tick
         4 exited 9",
        &expect![[r#"
            0: Loaded { name: "M", states: 2, problems: [], run: "" }
            1: show Entered { path: "A", inputs: None, undoes: None }
            4: Kill
            4: Died(RunnerDeath { reason: "the runner closed its control connection but did not end", active: ["A"], said: [], is_cut_off: false, is_wanted: false }), exit code 7
        "#]],
    );
}
