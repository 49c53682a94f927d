//! The records that a run keeps, the time when they are safe, and those that viewers receive.

use super::players::Run;
use super::served::{RunFixture, Viewer};
use crate::drive::due;
use crate::life::committer;
use crate::life::host::abandon;
use crate::record::blocks::Chunk;
use crate::record::recorder::{Read, Recorder};
use expect_test::{Expect, expect};
use rafcon_engine::{Input, Status};
use rafcon_protocol::{
    Answer, Command, Envelope, Event, Keeping, Launch, LogLevel, Stream, ToViewer,
};
use rafcon_storage::journal::folder::SPILL_FOLDER;
use rafcon_storage::journal::{About, Journal, Options, Reader, Record};
use std::fmt::Write as _;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::{fs, io, thread};

/// A hierarchy that increments a number three times, then runs another state.
fn counting(semantic: &str, last: &str) -> String {
    format!(
        r#"
hierarchy ROOT
  outcome done
  var now: int = 0
  start -> A
  A.ok -> B
  B.ok -> .done
  flow .now -> A.before
  flow A.after -> .now
  execution A "add"
    {semantic}
    outcome ok
    in before: int = 0
    out after: int = 0
  execution B "{last}"
    outcome ok
"#
    )
}

/// A state that writes more than memory holds, then one that waits.
fn shouting() -> String {
    let more = "B.ok -> C\n  C.ok -> .done\n  execution C \"wait\"\n    outcome ok";
    counting("", "shout").replace("B.ok -> .done", more)
}

/// All events of a journal in the viewers' format, with their numbers; `values` as a viewer requests.
fn journal(folder: &Path, values: bool) -> Vec<(u64, Event)> {
    let mut reader = Reader::open(folder).unwrap();
    let page = reader.page(1, usize::MAX).unwrap();
    page.iter().map(|entry| (entry.sequence, reader.event(entry, values).unwrap())).collect()
}

/// All events that the viewer receives until the end.
fn told(viewer: &mut Viewer) -> Vec<(u64, Event)> {
    let mut events = Vec::new();
    while let Some(message) = viewer.next() {
        if let ToViewer::Event { sequence, event, .. } = message {
            events.push((sequence, event));
        }
    }
    events
}

/// Runs the machine to its end and shows its journal, without roots and the end.
fn check(machine: &str, launch: impl FnOnce(Launch) -> Launch, expect: &Expect) {
    let fixture = RunFixture::new(machine);
    let (mut viewer, runner) = fixture.begin(launch(fixture.launch()));
    told(&mut viewer);
    runner.join().unwrap();
    let events = journal(&fixture.run_folder(), true);
    let shown = events
        .iter()
        .filter(|(_, event)| !matches!(event, Event::Root { .. } | Event::Finished { .. }));
    let line = |(_, event): &(u64, Event)| format!("{}\n", serde_json::to_string(event).unwrap());
    expect.assert_eq(&shown.map(line).collect::<Vec<_>>().concat());
}

#[test]
fn a_run_is_kept_with_all_values() {
    check(
        &counting("", "go"),
        |launch| launch,
        &expect![[r#"
        {"type":"entered","path":"ROOT","inputs":{}}
        {"type":"scoped","path":"ROOT","name":"now","value":0}
        {"type":"entered","path":"ROOT/A","inputs":{"before":0}}
        {"type":"left","path":"ROOT/A","outcome":{"id":0,"name":"ok"},"outputs":{"after":1}}
        {"type":"scoped","path":"ROOT","name":"now","value":1}
        {"type":"entered","path":"ROOT/B","inputs":{}}
        {"type":"left","path":"ROOT/B","outcome":{"id":0,"name":"ok"},"outputs":{}}
        {"type":"left","path":"ROOT","outcome":{"id":0,"name":"done"},"outputs":{}}
    "#]],
    );
}

#[test]
fn of_a_run_that_asks_for_it_only_the_status_is_kept() {
    let status = |launch| Launch { keeping: Keeping::Status, ..launch };
    check(
        &counting("", "go"),
        status,
        &expect![[r#"
        {"type":"entered","path":"ROOT","inputs":{}}
        {"type":"entered","path":"ROOT/A"}
        {"type":"left","path":"ROOT/A","outcome":{"id":0,"name":"ok"}}
        {"type":"entered","path":"ROOT/B","inputs":{}}
        {"type":"left","path":"ROOT/B","outcome":{"id":0,"name":"ok"},"outputs":{}}
        {"type":"left","path":"ROOT","outcome":{"id":0,"name":"done"},"outputs":{}}
    "#]],
    );
}

#[test]
fn a_state_can_give_up_its_values() {
    let machine = counting(r#"semantic {"journal": "status"}"#, "go");
    check(
        &machine,
        |launch| launch,
        &expect![[r#"
        {"type":"entered","path":"ROOT","inputs":{}}
        {"type":"scoped","path":"ROOT","name":"now","value":0}
        {"type":"entered","path":"ROOT/A"}
        {"type":"left","path":"ROOT/A","outcome":{"id":0,"name":"ok"}}
        {"type":"scoped","path":"ROOT","name":"now","value":1}
        {"type":"entered","path":"ROOT/B","inputs":{}}
        {"type":"left","path":"ROOT/B","outcome":{"id":0,"name":"ok"},"outputs":{}}
        {"type":"left","path":"ROOT","outcome":{"id":0,"name":"done"},"outputs":{}}
    "#]],
    );
}

#[test]
fn what_a_state_prints_is_left_out_if_it_asks_for_that() {
    let machine = r#"
execution ROOT "say"
  semantic {"journal": "off"}
  outcome done
"#;
    check(
        machine,
        |launch| launch,
        &expect![[r#"
        {"type":"entered","path":"ROOT","inputs":{}}
        {"type":"log","path":"ROOT","level":"error","stream":"logger","message":"help"}
        {"type":"left","path":"ROOT","outcome":{"id":0,"name":"done"},"outputs":{}}
    "#]],
    );
}

#[test]
fn a_run_that_is_not_kept_leaves_no_journal() {
    let fixture = RunFixture::new(&counting("", "go"));
    let (mut viewer, runner) = fixture.begin(Launch { keeping: Keeping::Off, ..fixture.launch() });
    assert_eq!(told(&mut viewer).len(), 7);
    runner.join().unwrap();
    assert!(Reader::open(&fixture.run_folder()).is_err());
}

#[test]
fn viewers_are_told_what_the_journal_has() {
    let fixture = RunFixture::new(&counting("", "wait"));
    let (mut first, runner) = fixture.begin(fixture.launch());
    first.until_text("+ROOT/B");
    let mut second = fixture.join(1, true);
    assert_eq!(first.command("stop", Command::Stop), "applied");
    let seen = told(&mut second);
    runner.join().unwrap();
    assert_eq!(seen, journal(&fixture.run_folder(), true));
}

#[test]
fn errors_are_told_without_values_too_whatever_the_outcome_and_in_few_words() {
    let machine = r#"
hierarchy ROOT
  outcome lost
  start -> A
  A.aborted -> .lost
  execution A "fail"
    out way: int = 0
"#;
    let fixture = RunFixture::new(machine);
    let (mut first, runner) =
        fixture.begin(Launch { every_event: true, hold: true, ..fixture.launch() });
    first.until_text("ROOT is held before ROOT/A by Start");
    let mut second = fixture.join(1, false);
    assert_eq!(first.command("go", Command::Resume { branch: None }), "applied");
    let seen = told(&mut second);
    runner.join().unwrap();
    let ends = seen.iter().filter_map(|(_, event)| match event {
        Event::Left { path, outcome, outputs: None, error: Some(error), .. } => {
            let text = error.as_str().unwrap();
            Some(format!("{path} {} {} {}", outcome.name, &text[..6], text.chars().count()))
        }
        _ => None,
    });
    assert_eq!(ends.collect::<Vec<_>>(), ["ROOT/A aborted no way 200", "ROOT lost no way 200"]);
    let kept = journal(&fixture.run_folder(), false);
    assert!(seen.iter().all(|told| kept.contains(told)));
}

#[test]
fn what_memory_gave_up_is_read_from_the_journal() {
    let fixture = RunFixture::new(&shouting());
    let (mut first, runner) = fixture.begin(fixture.launch());
    first.until_text("+ROOT/C");
    let mut second = fixture.join(1, false);
    // The run does not end before the second viewer has joined it.
    let first_event = loop {
        if let Some(ToViewer::Event { sequence, .. }) = second.next() {
            break sequence;
        }
    };
    assert_eq!(first.command("stop", Command::Stop), "applied");
    let rest = told(&mut second).into_iter().map(|(number, _)| number);
    let numbers: Vec<u64> = std::iter::once(first_event).chain(rest).collect();
    runner.join().unwrap();
    let kept = journal(&fixture.run_folder(), false);
    let scoped = |event: &Event| matches!(event, Event::Scoped { .. });
    let wanted = kept.iter().filter(|(_, event)| !scoped(event)).map(|(number, _)| *number);
    assert_eq!(numbers, wanted.collect::<Vec<u64>>());
}

#[test]
fn with_the_strict_rule_a_script_begins_once_its_entry_is_safe() {
    let mut machine = String::from("hierarchy ROOT\n  outcome done\n  start -> S0\n");
    for number in 0..20 {
        let next = if number == 19 { ".done".to_owned() } else { format!("S{}", number + 1) };
        writeln!(machine, "  S{number}.ok -> {next}").unwrap();
        writeln!(machine, "  execution S{number} \"safe\"\n    outcome ok").unwrap();
    }
    let fixture = RunFixture::new(&machine);
    let (viewer, runner) = fixture.begin(Launch { strict: true, ..fixture.launch() });
    let text = viewer.into_end();
    runner.join().unwrap();
    assert!(text.trim_end().ends_with("finished done"), "{text}");
}

/// A recorder with a journal in a new folder, without a committer.
fn recorder(folder: &Path) -> Recorder {
    let journal = Journal::create(folder, &About::default(), &Options::default()).unwrap();
    Recorder::with_journal(journal, None, Keeping::Full, false)
}

fn line(message: &str) -> Record {
    let message = message.to_owned();
    Record::Log { place: None, level: LogLevel::Info, stream: Stream::Stdout, message }
}

#[test]
fn only_what_is_safe_is_told() {
    let home = tempfile::tempdir().unwrap();
    let recorder = recorder(&home.path().join("run"));
    let told = |from| {
        let mut chunk = Chunk::default();
        recorder.read(from, false, &mut chunk);
        chunk.blocks().flat_map(|block| block.items()).count()
    };
    recorder.push(0, [line("one"), line("two")]);
    assert_eq!((recorder.last(), told(1)), (2, 0));
    let committed = recorder.journal().unwrap().commit().unwrap();
    recorder.push(0, [line("three")]);
    recorder.safe_until(committed.sequence);
    assert_eq!((recorder.last(), told(1)), (3, 2));
}

#[test]
fn while_the_disk_refuses_the_run_is_paused() {
    let home = tempfile::tempdir().unwrap();
    let machine = "
hierarchy ROOT
  outcome done
  start -> A
  A.ok -> .done
  execution A \"wait\"
    outcome ok
";
    let run = Run::recorded(machine, (1, 0), recorder(&home.path().join("run")));
    run.start();
    let safety = run.driver.recorder().safety();
    thread::scope(|scope| {
        scope.spawn(|| committer::attend(&run.driver));
        safety.failed("there is no room");
        run.wait_for_status(Status::Paused);
        assert_eq!(safety.state().1.as_deref(), Some("there is no room"));
        safety.committed(run.driver.recorder().last(), safety.backlog());
        run.wait_for_status(Status::Running);
        safety.closed();
    });
    run.driver.command(Input::Stop).unwrap();
    assert_eq!(run.end().finish.outcome_name, "preempted");
}

#[test]
fn a_run_that_somebody_holds_while_the_disk_refuses_stays_held_when_there_is_room_again() {
    let home = tempfile::tempdir().unwrap();
    let machine = "execution ROOT \"wait\"\n  outcome done\n";
    let run = Run::recorded(machine, (1, 0), recorder(&home.path().join("run")));
    run.start();
    let safety = run.driver.recorder().safety();
    thread::scope(|scope| {
        scope.spawn(|| committer::attend(&run.driver));
        safety.failed("there is no room");
        run.wait_for_status(Status::Paused);
        assert_eq!(run.driver.obey(&pause()), Answer::Applied);
        safety.committed(run.driver.recorder().last(), safety.backlog());
        safety.closed();
    });
    assert_eq!(run.driver.with_core(|core| core.engine.status()), Some(Status::Paused));
    run.driver.command(Input::Stop).unwrap();
    run.end();
}

fn pause() -> Envelope {
    Envelope::new("1", "test", Command::Pause)
}

/// A line that is too large for the recorder. A file blocks the path to which it would be written.
fn refused_line(folder: &Path) -> Record {
    fs::write(folder.join(SPILL_FOLDER), "").unwrap();
    line(&"x".repeat(2 << 20))
}

#[test]
fn a_run_ends_though_its_record_waits_for_a_disk_that_refuses() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path().join("run");
    let machine = "execution ROOT \"wait\"\n  outcome done\n";
    let run = Run::recorded(machine, (1, 0), recorder(&folder));
    run.start();
    let recorder = run.driver.recorder();
    thread::scope(|scope| {
        scope.spawn(|| recorder.push(0, [refused_line(&folder)]));
        while recorder.safety().state().1.is_none() {
            thread::yield_now();
        }
        run.driver.command(Input::Stop).unwrap();
    });
    assert_eq!(run.end().finish.outcome_name, "preempted");
}

#[test]
fn what_memory_gave_up_before_it_was_safe_is_not_missed() {
    let home = tempfile::tempdir().unwrap();
    let recorder = recorder(&home.path().join("run"));
    (0..3).for_each(|_| recorder.push(0, [line(&"x".repeat(1 << 20))]));
    let read = |from| recorder.read(from, false, &mut Chunk::default());
    assert_eq!(read(1), Read { next: 1, missed: 0, closed: false });
    let committed = recorder.journal().unwrap().commit().unwrap();
    recorder.safe_until(committed.sequence);
    assert!(read(1).missed > 0);
}

#[test]
fn a_run_that_lacks_a_thread_ends_with_those_it_has() {
    let home = tempfile::tempdir().unwrap();
    let machine = "execution ROOT \"wait\"\n  outcome done\n";
    let run = Run::recorded(machine, (1, 0), recorder(&home.path().join("run")));
    run.start();
    thread::scope(|scope| {
        committer::start(scope, &run.driver).unwrap();
        scope.spawn(|| due::serve(&run.driver));
        let _flow = abandon(&run.driver, &io::Error::other("none is left"));
    });
    assert_eq!(run.end().finish.outcome_name, "preempted");
}

#[test]
fn what_a_run_leaves_is_for_its_owner_only() {
    let fixture = RunFixture::new(&counting("", "shout"));
    let (viewer, runner) = fixture.begin(fixture.launch());
    viewer.into_end();
    runner.join().unwrap();
    for file in fs::read_dir(fixture.run_folder()).unwrap().map(Result::unwrap) {
        let metadata = file.metadata().unwrap();
        let others = metadata.permissions().mode() & 0o077;
        assert!(metadata.is_dir() || others == 0, "{:?}: {others:o}", file.file_name());
    }
}
