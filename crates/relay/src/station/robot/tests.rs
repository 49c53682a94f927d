//! The lists that a station has of a robot are bounded.

use super::*;
use crate::command_lists::CommandListStore;
use crate::contacts::ContactStore;
use crate::inbox::Inbox;
use crate::machine_lists::MachineLists;
use crate::requests::RequestBroker;
use crate::station::viewers::Shared;
use crate::value_fetch_broker::ValueFetchBroker;
use rafcon_protocol::api::{ListRequest, Right};
use rafcon_protocol::{Command, ListedCommand, WatchKind};
use rafcon_storage::journal::About;
use std::path::Path;
use std::sync::Arc;

fn robot(folder: &Path) -> (StationRobot, Inbox<ToStation>) {
    let pairing = Pairing::generate("scout", None).unwrap();
    let (file, next) = (folder.join("pairing"), folder.join("next"));
    let paired = Paired { pairing, file, next };
    let settings = StationSettings {
        folder: folder.join("ground"),
        runs: folder.join("runs"),
        pairings: Arc::new(vec![paired.clone()]),
        bind: ([127, 0, 0, 1], 0).into(),
        tls: None,
        profile: Profile::LAN,
        value_fetches: ValueFetchBroker::default(),
        server_requests: RequestBroker::default(),
        contacts: ContactStore::default(),
        lists: CommandListStore::new(|_| Right::Command),
        machines: MachineLists::default(),
        tell: |_| {},
    };
    let inbox = Inbox::new();
    let clock = SessionClock::begin();
    let robot = StationRobot::begin(&settings, 0, &paired, inbox.sender(), clock).unwrap();
    (robot, inbox)
}

fn stream(number: usize) -> StreamId {
    ids::events_of(&format!("run-{number}"))
}

#[test]
fn of_many_refused_runs_the_first_are_named_and_the_others_counted() {
    let folder = tempfile::tempdir().unwrap();
    let (mut robot, _inbox) = robot(folder.path());
    let mut refuse = |number: usize| {
        robot.on_disk_event(FromDisk::Refused(stream(number), format!("run-{number} is bad")));
        robot.report().problems
    };
    let named: Vec<_> = (0..REFUSED_MAX).map(&mut refuse).collect();
    assert_eq!(named.last().map(Vec::len), Some(REFUSED_MAX));
    assert_eq!(
        refuse(REFUSED_MAX).last().unwrap(),
        "not everything is kept: 1 more runs are refused"
    );
    let problems = refuse(REFUSED_MAX + 1);
    assert_eq!(problems.len(), REFUSED_MAX + 1);
    assert_eq!(problems.last().unwrap(), "not everything is kept: 2 more runs are refused");
    assert!(problems.iter().any(|it| it.ends_with("robot scout: run-0 is bad")), "{problems:?}");
}

#[test]
fn beyond_so_many_compared_hashes_all_are_forgotten_and_compared_again() {
    let folder = tempfile::tempdir().unwrap();
    let (mut robot, _inbox) = robot(folder.path());
    let chain = EventHash { last: 4, hash: 0 };
    (0..CHECKED_MAX).for_each(|number| robot.check(stream(number), 1, chain));
    assert_eq!(robot.checked.len(), CHECKED_MAX);
    // A known hash is not compared again.
    robot.check(stream(0), 1, chain);
    assert_eq!(robot.checked.len(), CHECKED_MAX);
    robot.check(stream(CHECKED_MAX), 1, chain);
    assert_eq!(robot.checked.keys().copied().collect::<Vec<_>>(), [stream(CHECKED_MAX)]);
    robot.check(stream(0), 1, chain);
    assert_eq!(robot.checked.len(), 2);
}

#[test]
fn the_robot_is_asked_for_as_many_runs_as_it_can_watch_and_for_another_once_it_forgets_one() {
    let folder = tempfile::tempdir().unwrap();
    let (mut robot, _inbox) = robot(folder.path());
    let target = WatchTarget {
        kind: WatchKind::State,
        path: "R".to_owned(),
        name: String::new(),
        priority: 0,
    };
    for number in 0..=watch_words::RUNS_MAX {
        let about = About::default();
        let shared = Shared::new(folder.path().to_owned(), &about, 0, LinkHealth::default());
        shared.watch(1, vec![target.clone()]);
        let open = OpenRun { id: String::new(), safe: 0, shared: Arc::new(shared) };
        robot.runs.insert(stream(number), StationRun::new(open));
    }
    robot.ask();
    let asked = |robot: &StationRobot| -> Vec<StreamId> {
        let asked = robot.watching.iter().filter(|(_, asked)| asked.is_any);
        asked.map(|(stream, _)| *stream).collect()
    };
    let first = asked(&robot);
    assert_eq!(first.len(), watch_words::RUNS_MAX);
    let last = *robot.runs.keys().find(|run| !first.contains(run)).unwrap();
    // The run is closed, and the robot does not know it yet.
    robot.runs.remove(&first[0]);
    robot.ask();
    assert_eq!(asked(&robot), first[1..]);
    robot.watching.get_mut(&first[0]).unwrap().watching.is_confirmed = true;
    robot.ask();
    assert!(asked(&robot).contains(&last));
    assert_eq!(asked(&robot).len(), watch_words::RUNS_MAX);
}

#[test]
fn a_list_is_not_sent_before_the_robot_is_heard_and_each_line_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let (mut robot, _inbox) = robot(folder.path());
    let shared = Shared::new(folder.path().to_owned(), &About::default(), 0, LinkHealth::default());
    let open = OpenRun { id: "here".to_owned(), safe: 0, shared: Arc::new(shared) };
    robot.runs.insert(stream(0), StationRun::new(open));
    let pause = |run: &str| {
        let run = run.to_owned();
        ListedCommand { run, command: Command::Pause, not_before: None, expiry: None }
    };
    let control = ListedCommand { command: Command::Control { holder: None }, ..pause("here") };
    let lists = robot.lists.clone();
    let list = std::thread::scope(|scope| {
        let list = vec![pause("here"), pause("gone")];
        let set = std::thread::Builder::new().spawn_scoped(scope, || {
            let before = lists.set("scout", list, None).unwrap();
            let revision = before.revision.clone();
            let request = ListRequest { revision, user: "ana".to_owned(), lines: Vec::new() };
            let refused = lists.release("scout", &request).unwrap_err();
            (before, refused.to_string(), lists.set("scout", vec![control], None).unwrap())
        });
        let set = set.unwrap();
        while !set.is_finished() {
            robot.answer_list_questions();
            std::thread::yield_now();
        }
        set.join().unwrap()
    });
    let (before, refused, control) = list;
    let heard = "the robot was never heard, so no time can be named until which the command is valid: wait until it is heard";
    let open =
        "the station has no open run of this robot with this id: write an id of `rafcon runs`";
    let faults = format!("line 1 (pause of run here): {heard}\nline 2 (pause of run gone): {open}");
    assert_eq!(before.faults().join("\n"), faults);
    assert_eq!(refused, format!("nothing was sent, because of these faults:\n{faults}"));
    assert!(before.lines.iter().all(|line| line.effect_ms.is_none()));
    let fault = control.lines[0].fault.as_deref();
    assert_eq!(fault, Some("control is requested, handed over and released, not set"));
    assert!(robot.requests.commands(None, &robot.session, &robot.contacts().plan, 0).is_empty());
}
