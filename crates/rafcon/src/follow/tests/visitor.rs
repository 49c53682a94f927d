//! Visits to a run that is another process's, as text: causes in, actions and exit code out.

use crate::console::UserAction;
use crate::event_queue::Cause;
use crate::follow::{Action, RunFollower, RunRole, StopSignal};
use expect_test::{Expect, expect};
use rafcon_protocol::{
    Answer, Command, EnginePulse, Event, Hello, Join, LinkHealth, ToRunner, ToViewer,
};
use std::time::Duration;

fn visit(role: RunRole, deadline: Option<Duration>) -> RunFollower {
    RunFollower::new(role, "ana", "attach".to_owned(), deadline).joining(Join::default())
}

fn shown(actions: &[Action]) -> Vec<String> {
    actions.iter().map(|action| format!("{action:?}")).collect()
}

/// A cause every three seconds.
fn check(role: RunRole, causes: Vec<Cause>, expect: &Expect) {
    let mut visit = visit(role, None);
    let mut actions = Vec::new();
    for (number, cause) in (0..).zip(causes) {
        visit.handle(Duration::from_secs(3 * number), cause, &mut actions);
    }
    let mut lines = shown(&actions);
    let end = visit.end(Duration::ZERO);
    lines.extend(end.map(|end| format!("{end:?}, exit code {}", end.code())));
    expect.assert_eq(&lines.join("\n"));
}

/// `c` is Ctrl-C, a number lets so many seconds pass.
fn check_manners(role: RunRole, seconds: Option<u64>, script: &str, expect: &Expect) {
    let mut visit = visit(role, seconds.map(Duration::from_secs));
    let (mut now, mut text) = (Duration::ZERO, String::new());
    for word in script.split(' ') {
        let cause = word.parse().map_or(Cause::Interrupt(StopSignal::CtrlC), |seconds| {
            now += Duration::from_secs(seconds);
            Cause::Tick
        });
        let mut actions = Vec::new();
        visit.handle(now, cause, &mut actions);
        let end = visit.end(now).map(|end| format!("{end:?}"));
        let seen = actions.iter().map(|action| match action {
            Action::Send(ToRunner::Command(envelope)) => format!("{:?}", envelope.command),
            other => format!("{other:?}"),
        });
        let seen: Vec<_> = seen.chain(end).collect();
        text.extend([format!("{word}: {}", seen.join(", ")).trim_end(), "\n"]);
    }
    expect.assert_eq(&text);
}

fn entered(path: &str) -> Cause {
    let event = Event::Entered { path: path.to_owned(), inputs: None, undoes: None };
    Cause::Messages(vec![ToViewer::Event { sequence: 1, t_ns: 0, event }])
}

#[test]
fn a_visitor_joins_commands_and_leaves() {
    let refused = Answer::Refused { reason: "the run is running".to_owned() };
    check(
        RunRole::Guest,
        vec![
            Cause::Hello(Hello::ours()),
            Cause::UserAction(UserAction::Send(Command::Pause)),
            Cause::Messages(vec![ToViewer::Answer { id: "1".to_owned(), answer: refused }]),
            Cause::UserAction(UserAction::Inspect("A".to_owned())),
            Cause::UserAction(UserAction::Leave),
        ],
        &expect![[r#"
            Send(Join(Join { from: 0, every_event: false }))
            Send(Command(Envelope { id: "attach-1", author: "ana", decided_on: None, expiry: None, not_before: None, epoch: None, command: Pause }))
            Note("refused: the run is running")
            Send(Inspect { id: "attach-2", path: "A" })
            Left, exit code 0"#]],
    );
}

#[test]
fn a_runner_that_dies_is_told_with_the_way_out() {
    check(
        RunRole::Guest,
        vec![Cause::Hello(Hello::ours()), entered("A"), Cause::Silence],
        &expect![[r#"
            Send(Join(Join { from: 0, every_event: false }))
            Show(Event { sequence: 1, t_ns: 0, event: Entered { path: "A", inputs: None, undoes: None } })
            Died(RunnerDeath { reason: "the runner died", active: ["A"], said: [], is_cut_off: false, is_wanted: false }), exit code 7"#]],
    );
}

#[test]
fn a_run_that_was_asked_for_is_stopped_and_killed() {
    check(
        RunRole::Host,
        vec![
            Cause::Hello(Hello::ours()),
            entered("A"),
            Cause::Interrupt(StopSignal::CtrlC),
            Cause::Interrupt(StopSignal::CtrlC),
            Cause::Silence,
        ],
        &expect![[r#"
            Send(Join(Join { from: 0, every_event: false }))
            Show(Event { sequence: 1, t_ns: 0, event: Entered { path: "A", inputs: None, undoes: None } })
            Note("stopping; press Ctrl-C again after 2 s to kill")
            Send(Command(Envelope { id: "attach-1", author: "ana", decided_on: None, expiry: None, not_before: None, epoch: None, command: Stop }))
            Note("killing; press Ctrl-C again after 2 s to leave the run as it is")
            Send(Command(Envelope { id: "attach-2", author: "ana", decided_on: None, expiry: None, not_before: None, epoch: None, command: Kill }))
            Killed { timed_out: false, has_begun: true, active: ["A"] }, exit code 8"#]],
    );
}

#[test]
fn a_connection_that_breaks_is_shown_and_ends_nothing() {
    check(
        RunRole::Guest,
        vec![Cause::Cut("the runner died".to_owned()), Cause::Mended("it is back".to_owned())],
        &expect![[r#"
            Heard(Some(0ns))
            Note("the runner died")
            Heard(None)
            Note("it is back")"#]],
    );
}

#[test]
fn an_engine_that_takes_no_inputs_is_told_and_so_is_its_return() {
    let mut visit = visit(RunRole::Guest, None).asking_for_the_engine();
    let pong = |unreached_ms| {
        let engine = Some(EnginePulse { unreached_ms, still_ms: unreached_ms, scripts: None });
        Cause::Messages(vec![ToViewer::Pong { id: 1, now_ms: 0, engine, link: None }])
    };
    let causes = [Cause::Hello(Hello::ours()), pong(0), pong(2_900), pong(3_900), pong(0)];
    let mut actions = Vec::new();
    for (second, cause) in (0..).zip(causes) {
        visit.handle(Duration::from_secs(second), cause, &mut actions);
    }
    expect![[r#"
        Send(Join(Join { from: 0, every_event: false }))
        Send(Ping { id: 1 })
        Send(Ping { id: 2 })
        Send(Ping { id: 3 })
        Heard(Some(0ns))
        Note("the run hangs: its process answers, but its engine takes no inputs; a stop ends the process if necessary")
        Send(Ping { id: 4 })
        Heard(None)
        Note("the run answers again")
        Send(Ping { id: 5 })"#]].assert_eq(&shown(&actions).join("\n"));
}

#[test]
fn a_robot_that_is_not_heard_is_told_with_the_age_of_what_is_shown() {
    let mut visit = visit(RunRole::Guest, None);
    let pong = |is_heard, heard_ms| {
        let link =
            LinkHealth { robot: "scout".to_owned(), is_heard, heard_ms, ..LinkHealth::default() };
        let pong =
            ToViewer::Pong { id: 0, now_ms: 200_000, engine: None, link: Some(Box::new(link)) };
        Cause::Messages(vec![pong])
    };
    let causes = [
        pong(true, Some(199_900)),
        pong(false, Some(100_000)),
        pong(false, Some(100_000)),
        pong(true, Some(200_000)),
        pong(false, None),
    ];
    let mut actions = Vec::new();
    for cause in causes {
        visit.handle(Duration::from_secs(1), cause, &mut actions);
    }
    expect![[r#"
        Heard(Some(100s))
        Note("no contact with scout for 1:40: this view is that old")
        Heard(None)
        Note("scout responds again")
        Heard(Some(0ns))
        Note("no contact with scout since its station started")"#]]
    .assert_eq(&shown(&actions).join("\n"));
}

#[test]
fn another_version_is_refused() {
    let hello = Hello { protocol: 0, program: "0.0.1".to_owned() };
    check(
        RunRole::Guest,
        vec![Cause::Hello(hello)],
        &expect![[r#"
        LoadFailed { reason: "the other side (version 0.0.1) speaks protocol 0, this one speaks 3: install the rafcon binary and its extension from the same build" }, exit code 1"#]],
    );
}

#[test]
fn a_guest_leaves() {
    check_manners(
        RunRole::Guest,
        None,
        "100 c",
        &expect![[r"
            100:
            c: Left
        "]],
    );
}

#[test]
fn the_host_stops_kills_and_leaves() {
    check_manners(
        RunRole::Host,
        None,
        "c c 9 c c 3 c",
        &expect![[r#"
            c: Note("stopping; press Ctrl-C again after 2 s to kill"), Stop
            c: Note("press Ctrl-C again after 2 s to kill")
            9:
            c: Note("killing; press Ctrl-C again after 2 s to leave the run as it is"), Kill
            c: Note("press Ctrl-C again after 2 s to leave the run as it is")
            3:
            c: Left
        "#]],
    );
}

#[test]
fn when_the_time_is_over_it_is_stopped_and_then_killed() {
    check_manners(
        RunRole::Host,
        Some(5),
        "4 1 2 1 9",
        &expect![[r#"
            4:
            1: Note("the time limit expired; stopping"), Stop
            2:
            1: Note("the run did not stop; killing"), Kill
            9:
        "#]],
    );
}
