//! What the WebSocket tells of a run in progress, with a real runner: whoever follows it is told what its journal has.

use crate::harness::{self, Place, assert_extension};
use crate::served::{Door, Line, Served};
use rafcon_protocol::api::{CommandAnswer, HistoryEntry, LinkState, RunNow, RunPhase};
use rafcon_protocol::socket::{ToClient, ToServer, Topic};
use rafcon_protocol::{Answer, Command, Envelope, Event};
use rafcon_storage::journal::{Reader, writer_of};
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::json;
use std::thread;

/// A server with a run that is paused before its first state.
struct Site {
    place: Place,
    served: Served,
    run: String,
}

impl Site {
    fn new() -> Self {
        assert_extension();
        let place = Place::empty();
        let machine = notation::parse(&harness::ticks(1500)).unwrap();
        save(&machine, &place.path("project/machine"), None, Naming::default()).unwrap();
        let words = "serve project --bind 127.0.0.1:0 --state state --runs runs";
        let served = Served::start(place.command(words)).unwrap();
        let projects = served.door().ask("GET", "/api/v1/projects", None).unwrap();
        let machine = json!({ "project": projects[0]["id"], "path": "machine" });
        let start = json!({ "id": "1", "machine": machine, "hold": true });
        let run = served.door().ask("POST", "/api/v1/runs", Some(&start)).unwrap();
        let run = run["id"].as_str().unwrap().to_owned();
        Self { place, served, run }
    }

    fn door(&self) -> &Door {
        self.served.door()
    }

    fn follow(&self, from: u64, values: bool) -> Line {
        let mut line = self.door().line().unwrap();
        let topic = Topic::RunHistory { run: self.run.clone(), from, values };
        line.say(&ToServer::Subscribe { subscription: 1, topic }).unwrap();
        line
    }

    /// The run's journal.
    fn history(&self, values: bool) -> Vec<HistoryEntry> {
        let mut reader = Reader::open(&self.place.path("runs").join(&self.run)).unwrap();
        let page = reader.page(1, usize::MAX).unwrap();
        let entries = page.iter().map(|entry| HistoryEntry {
            sequence: entry.sequence,
            t_ns: entry.t_ns,
            event: reader.event(entry, values).unwrap(),
        });
        entries.filter(|entry| values || !is_about_values(&entry.event)).collect()
    }

    fn command(&self, id: &str, command: Command) -> ToServer {
        let envelope = Envelope::new(id, "", command);
        ToServer::Command { run: self.run.clone(), envelope }
    }
}

/// A run outlives its server; none outlives its test.
impl Drop for Site {
    fn drop(&mut self) {
        let runner = writer_of(&self.place.path("runs").join(&self.run)).ok().flatten();
        if let Some(runner) = runner.and_then(|runner| Pid::from_raw(runner.cast_signed())) {
            kill_process(runner, Signal::KILL).unwrap_or_default();
        }
    }
}

fn is_about_values(event: &Event) -> bool {
    matches!(event, Event::Scoped { .. } | Event::Global { .. } | Event::Persistent { .. })
}

/// All that a client is told up to the end, and how often it was told that this is all so far.
fn all(mut line: Line) -> (Vec<HistoryEntry>, usize) {
    let (mut told, mut caught_up) = (Vec::new(), 0);
    loop {
        match line.hear().unwrap() {
            ToClient::Events { events, .. } => {
                caught_up += usize::from(events.is_empty());
                told.extend(events);
            }
            ToClient::Ended { refusal: None, .. } => return (told, caught_up),
            other => panic!("{other:?}"),
        }
    }
}

/// The same for a client that breaks off after so many frames, again and again.
fn in_pieces(site: &Site, frames: usize) -> Vec<HistoryEntry> {
    let (mut told, mut cursor) = (Vec::new(), 1);
    loop {
        let mut line = site.follow(cursor, true);
        for _ in 0..frames {
            match line.hear().unwrap() {
                ToClient::Events { events, next, .. } => {
                    told.extend(events);
                    cursor = next;
                }
                ToClient::Ended { refusal: None, .. } => return told,
                other => panic!("{other:?}"),
            }
        }
    }
}

#[test]
fn whoever_follows_a_run_is_told_what_its_journal_has() {
    let site = Site::new();
    let mut line = site.door().line().unwrap();
    let (with, without) = (site.follow(1, true), site.follow(1, false));
    thread::scope(|scope| {
        let pieces = [3, 7].map(|frames| (frames, &site));
        let pieces = pieces.map(|(frames, site)| scope.spawn(move || in_pieces(site, frames)));
        line.say(&site.command("go", Command::Resume { branch: None })).unwrap();
        let with = scope.spawn(|| all(with));
        let without = scope.spawn(|| all(without));
        let late = scope.spawn(|| all(site.follow(1, true)));
        let (with, without) = (with.join().unwrap(), without.join().unwrap());
        assert_eq!(with, (site.history(true), 1));
        assert_eq!(without, (site.history(false), 1));
        assert_eq!(late.join().unwrap(), with);
        for told in pieces {
            assert_eq!(told.join().unwrap(), with.0);
        }
    });
}

#[test]
fn commands_are_answered_in_their_order_and_the_status_ends_with_the_run() {
    let site = Site::new();
    let mut line = site.door().line().unwrap();
    let topic = Topic::RunStatus { run: site.run.clone() };
    for number in 0..20 {
        let step = Command::StepInto { branch: None };
        line.say(&site.command(&number.to_string(), step)).unwrap();
    }
    for number in 0..20 {
        match line.hear().unwrap() {
            ToClient::Answer(answer) => assert_eq!(answer.id, number.to_string()),
            other => panic!("{other:?}"),
        }
    }
    line.say(&ToServer::Subscribe { subscription: 1, topic }).unwrap();
    line.say(&site.command("end", Command::Stop)).unwrap();
    let mut is_stopped = false;
    loop {
        match line.hear().unwrap() {
            ToClient::Answer(answer) => is_stopped = answer.answer == Answer::Applied,
            ToClient::RunStatus { status, .. } => match status.run.phase {
                RunPhase::Finished { .. } => break,
                RunPhase::Live | RunPhase::Starting => {}
                phase => panic!("{phase:?}"),
            },
            other => panic!("{other:?}"),
        }
    }
    assert!(is_stopped);
}

/// A process that was stopped; it continues when this is dropped.
struct Stopped(Pid);

impl Stopped {
    fn new(process: u32) -> Self {
        let process = Pid::from_raw(i32::try_from(process).unwrap()).unwrap();
        kill_process(process, Signal::STOP).unwrap();
        // The signal is on its way: until a thread stops, it may still answer.
        while !are_threads_stopped(process) {
            thread::yield_now();
        }
        Self(process)
    }
}

/// Whether no thread of this process runs or waits.
fn are_threads_stopped(process: Pid) -> bool {
    let tasks = std::fs::read_dir(format!("/proc/{}/task", process.as_raw_nonzero())).unwrap();
    tasks.flatten().all(|task| {
        let stat = std::fs::read_to_string(task.path().join("stat")).unwrap_or_default();
        // A thread that has ended has none; the state follows the name, which is in brackets.
        stat.rsplit_once(") ").is_none_or(|(_, rest)| rest.starts_with('T'))
    })
}

impl Drop for Stopped {
    fn drop(&mut self) {
        kill_process(self.0, Signal::CONT).unwrap_or_default();
    }
}

#[test]
fn a_runner_that_hangs_is_told_from_one_that_has_nothing_to_say() {
    let site = Site::new();
    let mut line = site.door().line().unwrap();
    let topic = Topic::RunStatus { run: site.run.clone() };
    line.say(&ToServer::Subscribe { subscription: 1, topic }).unwrap();
    let held = status(&mut line, LinkState::Up, |now| now.snapshot.is_some());
    let runner = writer_of(&site.place.path("runs").join(&site.run)).unwrap().unwrap();
    let stopped = Stopped::new(runner);
    let silent = status(&mut line, LinkState::Silent, |_| true);
    assert!(silent.runner_heard_ms >= held.snapshot_ms, "{silent:?}");
    assert!(silent.runner_heard_ms < Some(silent.now_ms), "{silent:?}");
    assert_eq!((silent.run.phase, silent.snapshot), (RunPhase::Live, held.snapshot));
    line.say(&site.command("step", Command::StepInto { branch: None })).unwrap();
    drop(stopped);
    let (mut is_heard, mut is_answered) = (false, false);
    while !(is_heard && is_answered) {
        match line.hear().unwrap() {
            ToClient::Answer(CommandAnswer { id, answer }) => {
                assert_eq!((id.as_str(), answer), ("step", Answer::Applied));
                is_answered = true;
            }
            ToClient::RunStatus { status, .. } => {
                assert_eq!(status.link, LinkState::Up);
                assert!(status.runner_heard_ms > silent.runner_heard_ms, "{status:?}");
                is_heard = true;
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_runner_that_does_not_answer_a_stop_is_ended() {
    let site = Site::new();
    let mut line = site.door().line().unwrap();
    let topic = Topic::RunStatus { run: site.run.clone() };
    line.say(&ToServer::Subscribe { subscription: 1, topic }).unwrap();
    status(&mut line, LinkState::Up, |now| now.snapshot.is_some());
    let folder = site.place.path("runs").join(&site.run);
    let _stopped = Stopped::new(writer_of(&folder).unwrap().unwrap());
    line.say(&site.command("stop", Command::Stop)).unwrap();
    let (mut is_answered, mut is_crashed) = (false, false);
    while !(is_answered && is_crashed) {
        match line.hear().unwrap() {
            ToClient::Answer(CommandAnswer { answer, .. }) => {
                assert_eq!(answer, Answer::Applied);
                is_answered = true;
            }
            ToClient::RunStatus { status, .. } => {
                is_crashed = status.run.phase == RunPhase::Crashed;
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(!site.history(false).is_empty());
}

/// How the run stands, as soon as its link is like this and it is what is `wanted`; until then nothing but this is told.
fn status(line: &mut Line, link: LinkState, wanted: impl Fn(&RunNow) -> bool) -> RunNow {
    loop {
        match line.hear().unwrap() {
            ToClient::RunStatus { status, .. } if status.link == link && wanted(&status) => {
                return *status;
            }
            ToClient::RunStatus { .. } => {}
            other => panic!("{other:?}"),
        }
    }
}
