//! Commands over a restart of the station, against the session of a robot.

use super::*;
use crate::carrier::Carrier;
use crate::station::stored_command::{STORED_MAX, StoredCommands};
use crate::words::StationRequest;
use rafcon_link::{
    CommandId, CommandState, EventBlock, ReceivedCommand, RobotSession, RunSource, SenderStart,
};
use rafcon_protocol::{CommandStage, Expiry};
use rafcon_supervisor::clock;
use std::fs;
use std::net::UdpSocket;
use std::path::PathBuf;
use std::thread;
use std::time::Duration;

/// A robot without runs.
struct NoRuns;

impl RunSource for NoRuns {
    fn events(&mut self, _: StreamId, _: u64, _: u64, _: usize) -> Option<EventBlock> {
        None
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        None
    }
}

/// A robot and its station, which can be killed and started again.
struct Pair {
    folder: tempfile::TempDir,
    pairing: Pairing,
    clock: SessionClock,
    station: StationRobot,
    inbox: Inbox<ToStation>,
    robot: RobotSession,
    /// Sockets of the station and the robot.
    sockets: (Arc<UdpSocket>, UdpSocket),
    arrived: Vec<ReceivedCommand>,
}

fn robot_session(pairing: &Pairing, start: u32) -> RobotSession {
    let identity = rafcon_link::Identity {
        key_id: pairing.key_id,
        key: &pairing.key,
        robot: &pairing.robot,
        start: SenderStart::new(start, 0),
        heard: None,
    };
    let mut robot = RobotSession::new(&identity, Profile::LAN);
    robot.begin(StreamId(1), 0);
    robot
}

impl Pair {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (clock, pairing) = (SessionClock::begin(), Pairing::generate("scout", None).unwrap());
        let (station, inbox) = robot_of(folder.path(), &pairing, clock);
        let bind = || UdpSocket::bind("127.0.0.1:0").unwrap();
        let sockets = (Arc::new(bind()), bind());
        sockets.1.set_nonblocking(true).unwrap();
        let robot = robot_session(&pairing, 1);
        let arrived = Vec::new();
        let mut pair = Self { folder, pairing, clock, station, inbox, robot, sockets, arrived };
        pair.until(|pair| pair.station.session.reached_before(pair.clock.now()).is_some());
        pair
    }

    /// The station dies and starts again.
    fn restart_station(&mut self) {
        (self.station, self.inbox) = robot_of(self.folder.path(), &self.pairing, self.clock);
    }

    /// Carries datagrams and events of the disk until this is true.
    fn until(&mut self, mut is_done: impl FnMut(&mut Self) -> bool) {
        while !is_done(self) {
            self.hear_disk();
            let from =
                Carrier::Udp(Arc::clone(&self.sockets.0), self.sockets.1.local_addr().unwrap());
            while let Some(datagram) =
                self.robot.poll_transmit(self.clock.now(), &mut NoRuns).unwrap()
            {
                // A start of the station cannot open a short header before a full one.
                self.station.receive(&from, &datagram);
            }
            self.station.scan();
            self.station.send().unwrap();
            let mut datagram = vec![0; 65_535];
            while let Ok(length) = self.sockets.1.recv(&mut datagram) {
                let (arrived, now) = (&mut self.arrived, self.clock.now());
                // Datagrams of a dead start of the station are rejected.
                let received =
                    self.robot.handle_datagram(now, &mut datagram[..length], |it| arrived.push(it));
                received.unwrap_or_default();
            }
            thread::yield_now();
        }
    }

    fn hear_disk(&mut self) {
        while let Some(input) = self.inbox.wait(Duration::ZERO) {
            if let Input::Other(ToStation::Commands(_, event)) = input {
                self.station.on_command_disk_event(event);
            }
        }
    }

    /// Waits until the command is accepted; nothing is sent meanwhile.
    fn until_accepted(&mut self, id: &str) {
        while !self.station.commands.requests.is_open(ids::command(id)) {
            self.hear_disk();
            thread::yield_now();
        }
    }

    fn give(&mut self, id: &str, command: Command) {
        self.station.command(stream(0), &given(id, command));
    }

    fn set_state(&mut self, id: &str, state: CommandState) {
        self.robot.set_command_state(self.clock.now(), ids::command(id), state, "");
    }

    fn commands_folder(&self) -> PathBuf {
        self.folder.path().join("ground/scout/commands")
    }

    /// Ids of the requests on the disk.
    fn stored(&self) -> Vec<String> {
        let stored = StoredCommands::read(&self.commands_folder()).commands;
        stored.into_iter().map(|command| command.about.id).collect()
    }

    fn stage(&self, id: &str) -> Option<CommandStage> {
        let open = self.station.commands.open(None, &self.station.session, &ContactPlan::default());
        open.into_iter().find(|open| open.id == id).map(|open| open.stage)
    }

    /// Ids of the commands that the robot is to carry out.
    fn carried_out(&self) -> Vec<CommandId> {
        self.arrived.iter().filter(|it| !it.is_late).map(|it| it.id).collect()
    }
}

fn given(id: &str, command: Command) -> PendingRequest {
    let word = StationRequest::Command(id.to_owned(), "ana".to_owned(), Some(4), command);
    let expiry = Some(Expiry(clock::since_1970_ms() + 3_600_000));
    PendingRequest { expiry, ..PendingRequest::soon(id.to_owned(), word) }
}

const RESUME: Command = Command::Resume { branch: None };

#[test]
fn a_command_that_was_accepted_is_sent_after_the_station_died_and_carried_out_once() {
    let mut pair = Pair::new();
    pair.give("ana/1", RESUME);
    // It is not accepted before it is durable.
    assert!(!pair.station.session.is_open(ids::command("ana/1")));
    pair.until_accepted("ana/1");
    assert_eq!(pair.stored(), ["ana/1"]);
    let sent = pair.station.session.sent(ids::command("ana/1")).unwrap();
    pair.restart_station();
    assert_eq!(pair.stage("ana/1"), Some(CommandStage::Sent));
    // A client that repeats it does not send it twice.
    pair.give("ana/1", RESUME);
    pair.until(|pair| !pair.arrived.is_empty());
    assert_eq!(pair.arrived[0].not_after_ms, sent.times.not_after);
    // The station dies again, and the robot has the command.
    pair.restart_station();
    pair.until(|pair| pair.stage("ana/1") == Some(CommandStage::Received));
    pair.set_state("ana/1", CommandState::Done);
    pair.until(|pair| pair.station.commands.storage.is_empty());
    assert_eq!(pair.carried_out(), [ids::command("ana/1")]);
    let answer = pair.station.commands.requests.known_answer(ids::command("ana/1"));
    assert!(matches!(answer, Some(RobotAnswer::Done { .. })), "{answer:?}");
    pair.station.end();
    assert_eq!(pair.stored(), [""; 0]);
    pair.restart_station();
    assert_eq!(pair.stage("ana/1"), None);
}

#[test]
fn a_command_expires_with_its_start_of_the_robot_and_is_unknown_until_the_robot_says_so() {
    let mut pair = Pair::new();
    pair.give("ana/1", RESUME);
    pair.until_accepted("ana/1");
    pair.restart_station();
    pair.robot = robot_session(&pair.pairing, 2);
    pair.until(|pair| pair.stage("ana/1") == Some(CommandStage::Overdue));
    pair.until(|pair| pair.stage("ana/1").is_none());
    assert_eq!(pair.carried_out(), []);
    let answer = pair.station.commands.requests.known_answer(ids::command("ana/1"));
    assert_eq!(answer, Some(RobotAnswer::Expired));
}

#[test]
fn commands_are_sent_although_the_disk_hangs_and_a_stop_and_a_pause_at_once() {
    let mut pair = Pair::new();
    pair.station.commands.storage.hang();
    pair.give("ana/1", RESUME);
    pair.give("ana/2", Command::Pause);
    pair.give("ana/3", Command::Stop);
    assert_eq!(["ana/1", "ana/2", "ana/3"].map(|id| pair.stage(id).is_some()), [false, true, true]);
    pair.until(|pair| pair.arrived.len() == 3);
    let mut arrived = pair.carried_out();
    let mut expected = ["ana/1", "ana/2", "ana/3"].map(ids::command);
    arrived.sort_unstable();
    expected.sort_unstable();
    assert_eq!(arrived, expected);
    let problems = pair.station.report().problems;
    let resume = "resume (ana/1) is sent, and a restart of the station would drop it: the disk does not answer";
    assert!(problems.iter().any(|problem| problem == resume), "{problems:?}");
}

#[test]
fn a_full_disk_refuses_no_command_and_is_reported_for_each_that_is_not_durable() {
    let mut pair = Pair::new();
    // A file is in the place of the folder.
    fs::write(pair.commands_folder(), []).unwrap();
    pair.give("ana/1", Command::Stop);
    pair.give("ana/2", RESUME);
    pair.until(|pair| pair.arrived.len() == 2);
    pair.until(|pair| pair.station.report().problems.len() == 2);
    let problems = pair.station.report().problems;
    for words in ["stop (ana/1) is sent, and a restart", "resume (ana/2) is sent, and a restart"] {
        assert!(problems.iter().any(|problem| problem.starts_with(words)), "{problems:?}");
    }
    // There is room again.
    fs::remove_file(pair.commands_folder()).unwrap();
    pair.until(|pair| pair.station.report().problems.is_empty());
    let mut stored = pair.stored();
    stored.sort_unstable();
    assert_eq!(stored, ["ana/1", "ana/2"]);
}

#[test]
fn a_command_that_expired_while_the_station_was_down_is_unknown_until_the_robot_answers() {
    let mut pair = Pair::new();
    pair.give("ana/1", RESUME);
    pair.until_accepted("ana/1");
    // The station comes back after the expiry.
    let mut stored = StoredCommands::read(&pair.commands_folder()).commands.remove(0);
    (stored.about.expires_ms, stored.about.robot_not_after_ms) = (Some(1), 0);
    stored.write(&pair.commands_folder()).unwrap();
    pair.restart_station();
    assert_eq!(pair.stage("ana/1"), Some(CommandStage::Overdue));
    pair.until(|pair| pair.stage("ana/1").is_none());
    assert_eq!(pair.carried_out(), []);
    assert!(pair.arrived.iter().all(|command| command.is_late));
}

#[test]
fn a_damaged_command_is_a_problem_of_the_link_and_costs_no_other() {
    let mut pair = Pair::new();
    for id in ["ana/1", "ana/2"] {
        pair.give(id, RESUME);
        pair.until_accepted(id);
    }
    let files = || fs::read_dir(pair.commands_folder()).unwrap();
    let file = files().next().unwrap().unwrap().path();
    fs::write(file, "damaged").unwrap();
    pair.restart_station();
    let stages = ["ana/1", "ana/2"].map(|id| pair.stage(id));
    assert_eq!(stages.iter().flatten().count(), 1);
    let problems = pair.station.report().problems;
    assert!(problems[0].contains("is not sent again, because the file is damaged"), "{problems:?}");
}

#[test]
fn requests_wait_for_the_disk_up_to_the_bound_of_the_session() {
    let mut pair = Pair::new();
    pair.station.commands.storage.hang();
    for nth in 0..=STORED_MAX {
        pair.give(&format!("ana/{nth}"), RESUME);
    }
    assert_eq!(pair.station.commands.storage.storing_count(), STORED_MAX);
    let last = ids::command(&format!("ana/{STORED_MAX}"));
    assert!(!pair.station.commands.storage.is_storing(last));
}
