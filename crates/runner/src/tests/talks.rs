//! Viewers: several at once, joining and leaving, with commands and questions.

use super::served::{RunFixture, Viewer};
use crate::Clock;
use expect_test::{Expect, expect};
use rafcon_protocol::{Answer, Command, Envelope, Expiry, Given, ToRunner, ToViewer};
use serde_json::json;
use std::io::Write as _;
use std::os::unix::net::{UnixListener, UnixStream};

const WAITS: &str = "
hierarchy ROOT
  outcome done
  in number: int = 4
  var kept: int = 7
  start -> A
  A.ok -> .done
  execution A \"wait\"
    outcome ok
";

const ASKS: &str = "
hierarchy ROOT
  outcome done
  start -> A
  A.yes -> .done
  A.no -> A
  execution A \"ask\"
    outcome yes
    outcome no
";

const LEADS_NOWHERE: &str = "
hierarchy ROOT
  outcome done
  start -> A
  execution A \"say\"
    outcome ok
";

/// A machine that runs until it is stopped, with an event every few microseconds.
const GOES_ON: &str = "
hierarchy ROOT
  outcome done
  start -> A
  A.ok -> A
  execution A \"go\"
    outcome ok
";

/// All events without those of commands, line by line.
fn check(viewer: Viewer, expect: &Expect) {
    let text = viewer.into_end();
    let lines = text.split_inclusive('\n').filter(|line| !line.contains(" by test: "));
    expect.assert_eq(&lines.collect::<String>());
}

#[test]
fn whoever_joins_is_told_what_it_asks_for_and_may_command() {
    let fixture = RunFixture::new(WAITS);
    let (mut first, runner) = fixture.begin(fixture.launch());
    let from = first.until_text("+ROOT/A");
    let mut second = fixture.join(from, false);
    let name = second.until(|message| match message {
        ToViewer::Loaded { name, run, .. } => Some(format!("{name} {run}")),
        _ => None,
    });
    assert_eq!(name, "ROOT run");
    assert_eq!(second.command("1", Command::Stop), "applied");
    check(
        second,
        &expect![[r"
            +ROOT/A
            stopping
            -ROOT/A=preempted
            -ROOT=preempted
            finished preempted
        "]],
    );
    drop(first);
    runner.join().unwrap();
}

#[test]
fn what_a_state_waits_for_is_told_by_names() {
    let fixture = RunFixture::new(LEADS_NOWHERE);
    let (mut first, runner) = fixture.begin(fixture.launch());
    let reason = "the outcome \"ok\" of \"say\" leads nowhere: connect it, or stop the run";
    first.until_text(&format!("ROOT waits: {reason}"));
    let mut second = fixture.look_on();
    let awaited = second.until(|message| match message {
        ToViewer::Snapshot(now) => now.active.iter().find_map(|state| state.detail.clone()),
        _ => None,
    });
    assert_eq!(awaited, "a transition from the outcome \"ok\" of \"say\"");
    assert_eq!(second.command("stop", Command::Stop), "applied");
    drop((first, second));
    runner.join().unwrap();
}

/// Number of events among which at least four snapshots come, however slowly a viewer reads on a busy computer.
const EVENTS_ENOUGH: u64 = 2_000_000;

#[test]
fn snapshots_come_while_events_come_faster_than_they_can_be_told() {
    let fixture = RunFixture::new(GOES_ON);
    let (mut viewer, runner) = fixture.begin(fixture.launch());
    let (mut snapshots, mut told) = (Vec::new(), 0);
    viewer.until(|message| {
        match message {
            ToViewer::Snapshot(now) => snapshots.push(now.sequence),
            ToViewer::Event { sequence, .. } => told = *sequence,
            _ => {}
        }
        (snapshots.len() == 4 || told > EVENTS_ENOUGH).then_some(())
    });
    // On a busy computer, no event may happen between two of them.
    assert!(snapshots.is_sorted() && snapshots.first() < snapshots.last(), "{snapshots:?}");
    assert_eq!(snapshots.len(), 4, "{snapshots:?}, and then nothing up to event {told}");
    assert_eq!(viewer.command("stop", Command::Stop), "applied");
    drop(viewer);
    runner.join().unwrap();
}

#[test]
fn an_id_counts_once_for_all_viewers() {
    let fixture = RunFixture::new(WAITS);
    let (mut first, runner) = fixture.begin(fixture.launch());
    first.until_text("+ROOT/A");
    let mut second = fixture.look_on();
    assert_eq!(first.command("pause", Command::Pause), "applied");
    assert_eq!(second.command("pause", Command::Pause), "applied");
    assert_eq!(
        second.command("pause", Command::Resume { branch: None }),
        "refused: the id pause came with another command before: choose a new id for each"
    );
    assert_eq!(second.command("stop", Command::Stop), "applied");
    assert_eq!(first.command("stop", Command::Stop), "applied");
    let text = first.into_end();
    let commands: Vec<&str> = text.lines().filter(|line| line.contains(" by test: ")).collect();
    assert_eq!(commands, ["pause by test: Applied", "stop by test: Applied"]);
    runner.join().unwrap();
}

#[test]
fn a_run_outlives_its_viewers_and_silent_ones_hold_up_nothing() {
    let fixture = RunFixture::new(ASKS);
    let (mut first, runner) = fixture.begin(fixture.launch());
    first.until_text("asked 1 by ROOT/A");
    drop(first);
    let path = fixture.run_folder().join("socket");
    let _silent = UnixStream::connect(&path).unwrap();
    let mut rude = UnixStream::connect(&path).unwrap();
    rude.write_all(b"GET / HTTP/1.1\r\n\r\n").unwrap();
    let mut second = fixture.join(1, false);
    let answer = |button| Command::AnswerQuestion { question: 1, value: json!({"button": button}) };
    assert_eq!(
        second.command("1", answer(5)),
        "refused: there is no button 5; the buttons are Yes, No, counted from 0"
    );
    assert_eq!(second.command("2", answer(0)), "applied");
    check(
        second,
        &expect![[r#"
            +ROOT
            +ROOT/A
            asked 1 by ROOT/A
            closed 1 Answered {"button":0} by test
            -ROOT/A=yes
            -ROOT=done
            finished done
        "#]],
    );
    runner.join().unwrap();
    assert!(!path.exists());
}

#[test]
fn the_first_answer_counts_and_a_stop_withdraws_the_question() {
    let fixture = RunFixture::new(ASKS);
    let (mut first, runner) = fixture.begin(fixture.launch());
    first.until_text("asked 1 by ROOT/A");
    let answer = |question| Command::AnswerQuestion { question, value: json!({"button": 1}) };
    assert_eq!(first.command("1", answer(1)), "applied");
    first.until_text("asked 2 by ROOT/A");
    assert_eq!(first.command("2", answer(1)), "refused: question 1 is closed already");
    assert_eq!(
        first.command("3", answer(9)),
        "refused: there is no question 9; a snapshot lists those that are open"
    );
    assert_eq!(first.command("4", Command::Stop), "applied");
    let text = first.into_end();
    assert!(text.contains("closed 2 Withdrawn by "), "{text}");
    runner.join().unwrap();
}

#[test]
fn what_an_active_state_holds_can_be_asked() {
    let fixture = RunFixture::new(WAITS);
    let (mut first, runner) = fixture.begin(fixture.launch());
    first.until_text("+ROOT/A");
    let mut held = |path: &str| {
        first.send(&ToRunner::Inspect { id: "i".to_owned(), path: path.to_owned() });
        first.until(|message| match message {
            ToViewer::Inspection { data, .. } => Some(serde_json::to_string(data).unwrap()),
            _ => None,
        })
    };
    expect![[r#"{"inputs":{"number":4},"outputs":{},"scoped_variables":{"kept":7}}"#]]
        .assert_eq(&held("ROOT"));
    expect!["null"].assert_eq(&held("ROOT/B"));
    assert_eq!(first.command("stop", Command::Stop), "applied");
    drop(first);
    runner.join().unwrap();
}

#[test]
fn what_is_no_command_is_answered_or_noted() {
    let fixture = RunFixture::new(WAITS);
    let (mut first, runner) = fixture.begin(fixture.launch());
    first.until_text("+ROOT/A");
    first.raw("{\"message\":\"command\",\"id\":\"x\",\"command\":{\"type\":\"dance\"}}\n");
    let answer = first.until(|message| match message {
        ToViewer::Answer { id, answer } => Some(format!("{id} {answer:?}")),
        _ => None,
    });
    assert!(answer.starts_with("x Refused { reason: \"this runner does not know the command: "));
    first.raw("nonsense\n");
    first
        .until_text("log : a viewer sent not a message of this protocol: nonsense; it was ignored");
    assert_eq!(first.command("stop", Command::Stop), "applied");
    drop(first);
    runner.join().unwrap();
}

#[test]
fn a_command_that_nobody_wants_any_more_is_not_carried_out() {
    let fixture = RunFixture::new(WAITS);
    let (mut first, runner) = fixture.begin(fixture.launch());
    first.until_text("+ROOT/A");
    let mut asked = |id: &str, expiry| {
        first.send(&ToRunner::Command(Envelope {
            decided_on: Some(1),
            expiry: Some(Expiry(expiry)),
            ..Envelope::new(id, "test", Command::Stop)
        }));
        first.until(|message| match message {
            ToViewer::Answer { id: answered, answer } if answered == id => Some(answer.clone()),
            _ => None,
        })
    };
    assert_eq!(asked("late", 1), Answer::Expired);
    assert_eq!(asked("late", u64::MAX), Answer::Expired);
    assert_eq!(asked("in time", u64::MAX), Answer::Applied);
    drop(first);
    runner.join().unwrap();
}

#[test]
fn a_command_that_comes_before_its_time_is_refused() {
    let fixture = RunFixture::new(WAITS);
    let (mut first, runner) = fixture.begin(fixture.launch());
    first.until_text("+ROOT/A");
    let mut asked = |id: &str, not_before| {
        first.send(&ToRunner::Command(Envelope {
            not_before: Some(not_before),
            ..Envelope::new(id, "test", Command::Stop)
        }));
        first.until(|message| match message {
            ToViewer::Answer { id: answered, answer } if answered == id => Some(answer.clone()),
            _ => None,
        })
    };
    let refused = asked("early", u64::MAX);
    assert!(
        matches!(&refused, Answer::Refused { reason } if reason.starts_with("it is for later"))
    );
    assert_eq!(asked("in time", 1), Answer::Applied);
    drop(first);
    runner.join().unwrap();
}

#[test]
fn a_runner_says_that_it_is_there_also_while_a_command_takes_its_time() {
    let fixture = RunFixture::new(WAITS);
    let (mut first, runner) = fixture.begin(fixture.launch());
    first.until_text("+ROOT/A");
    let socket = fixture.machine().with_file_name("slow");
    let listener = UnixListener::bind(&socket).unwrap();
    let value = json!(format!("until closed: {}", socket.display()));
    let given = Given { path: "ROOT".to_owned(), name: "number".to_owned(), value };
    first.order("slow", Command::Start { from: None, data: vec![given] });
    let (under_way, _) = listener.accept().unwrap();
    first.send(&ToRunner::Ping { id: 7 });
    let pong = first.until(|message| match message {
        ToViewer::Pong { id, now_ms, engine, .. } => Some((*id, *now_ms, *engine)),
        ToViewer::Answer { .. } => panic!("{message:?}"),
        _ => None,
    });
    assert_eq!(pong.0, 7);
    assert!((1..=Clock::epoch_ms()).contains(&pong.1), "{pong:?}");
    assert_eq!(pong.2.map(|engine| (engine.unreached_ms, engine.scripts)), Some((0, Some(1))));
    drop(under_way);
    let answer = first.answer("slow");
    assert!(answer.starts_with("refused: cannot start: "), "{answer}");
    assert_eq!(first.command("stop", Command::Stop), "applied");
    drop(first);
    runner.join().unwrap();
}
