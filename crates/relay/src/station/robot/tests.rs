//! A robot at its station.

mod stored_commands;

use super::*;
use crate::command_lists::CommandListStore;
use crate::contacts::ContactStore;
use crate::inbox::Inbox;
use crate::machine_lists::MachineLists;
use crate::pairing::Pairing;
use crate::requests::RequestBroker;
use crate::station::disk::OpenRun;
use crate::station::received::StationRun;
use crate::station::viewers::Shared;
use crate::value_fetch_broker::ValueFetchBroker;
use rafcon_link::Profile;
use rafcon_protocol::api::RobotAnswer;
use rafcon_protocol::api::{ListRequest, Right};
use rafcon_protocol::{Command, ContactPlan, ListedCommand};
use rafcon_storage::journal::About;
use std::path::Path;
use std::sync::Arc;

pub(in crate::station) fn robot(folder: &Path) -> (StationRobot, Inbox<ToStation>) {
    let pairing = Pairing::generate("scout", None).unwrap();
    robot_of(folder, &pairing, SessionClock::begin())
}

fn robot_of(
    folder: &Path,
    pairing: &Pairing,
    clock: SessionClock,
) -> (StationRobot, Inbox<ToStation>) {
    let (file, next) = (folder.join("pairing"), folder.join("next"));
    let paired = Paired { pairing: pairing.clone(), file, next };
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
    let robot = StationRobot::begin(&settings, 0, &paired, inbox.sender(), clock).unwrap();
    (robot, inbox)
}

/// A session that has received nothing.
pub(super) fn session() -> StationSession {
    let pairing = Pairing::generate("scout", None).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let start = Start::begin(folder.path()).unwrap();
    StationSession::new(&start.identity(&pairing), Profile::LAN)
}

pub(in crate::station) fn stream(number: usize) -> StreamId {
    ids::events_of(&format!("run-{number}"))
}

#[test]
fn a_refused_run_and_its_reason_are_a_problem_of_the_link() {
    let folder = tempfile::tempdir().unwrap();
    let (mut robot, _inbox) = robot(folder.path());
    robot.on_disk_event(FromDisk::Refused(stream(0), "run-0 is bad".to_owned()));
    assert_eq!(robot.report().problems, ["not everything is kept: robot scout: run-0 is bad"]);
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
    let lists = robot.commands.lists.clone();
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
            robot.with_commands(StationCommands::answer_list_questions);
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
    let plan = robot.link.contacts().plan;
    assert!(robot.commands.open(None, &robot.session, &plan).is_empty());
}
