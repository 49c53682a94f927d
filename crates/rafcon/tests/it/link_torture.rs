//! Robots' servers, stations and runners killed at moments that no one chose, while commands are on their way over a path that
//! loses, doubles and damages datagrams: no command is carried out twice or too late, and the replica is the robot's journal.

use crate::harness::Place;
use crate::served::Served;
use crate::server_torture::{Journal, assert_in_time, now_ms};
use crate::station::{BadPath, history, pair};
use crate::torture::{Dice, Repeat, TREMBLES, first_seed, number, tremble};
use rafcon_protocol::socket::ToServer;
use rafcon_protocol::{Breakpoint, Command, Envelope, Expiry, Scope, Unattended, When};
use rafcon_storage::journal::{Reader, writer_of};
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::json;
use std::io::Write as _;
use std::net::{SocketAddr, UdpSocket};
use std::path::{Path, PathBuf};
use std::thread;

/// How often something is killed, where a few times are not enough.
const KILLS: &str = "RAFCON_TEST_KILLS";
/// So often in one run at most.
const KILLS_OF_RUN: u64 = 12;
/// Whoever dies more often is not resumed by itself.
const RUNNERS_OF_RUN: u32 = 2;

/// Counts slowly, whatever happens to its runner.
const MACHINE: &str = r#"
hierarchy ROOT "Count"
  outcome success
  start -> COUNTX
  COUNTX.success -> COUNTX ; COUNTX.aborted -> COUNTX
  execution COUNTX "Count"
    outcome success
    script |
      def execute(self, inputs, outputs, gvm):
          return "preempted" if self.preemptive_wait(0.02) else 0
"#;

#[test]
fn killed_robots_and_stations_carry_out_each_command_once_or_never() {
    let (kills, first) = (number(KILLS).unwrap_or(4), first_seed());
    let (mut tally, mut seed) = (Tally::default(), first);
    while tally.killed < kills {
        one_run(seed, KILLS_OF_RUN.min(kills - tally.killed), &mut tally);
        seed += 1;
    }
    assert!(tally.applied > 0, "no command was carried out: {tally:?}");
    writeln!(std::io::stdout(), "{} runs passed: {tally:?}", seed - first).unwrap();
}

/// What was tried.
#[derive(Debug, Default)]
struct Tally {
    killed: u64,
    robots: u64,
    stations: u64,
    runners: u64,
    commands: u64,
    applied: usize,
}

fn one_run(seed: u64, kills: u64, tally: &mut Tally) {
    let _repeat = Repeat { seed, options: "--link " };
    let place = Place::empty();
    let machine = notation::parse(MACHINE).unwrap();
    save(&machine, &place.path("project/machine"), None, Naming::default()).unwrap();
    pair(&place, "scout");
    let mut site = Site::new(&place, Dice(seed));
    for _ in 0..kills {
        site.command(tally);
        tremble(site.dice.roll(TREMBLES));
        site.kill(tally);
        site.catch_up();
    }
    site.command(tally);
    site.catch_up();
    let site = site.stop();
    let [robot, ground] = &site.runs;
    let journal = Journal::read(robot);
    for (id, times) in journal.applied() {
        assert_eq!(times, 1, "{id} was carried out {times} times");
    }
    assert_in_time(&journal, &site.deaths);
    tally.applied += journal.applied().len();
    assert_eq!(history(&place, "ground-runs"), history(&place, "robot-runs"));
    assert_eq!(last_event(ground), last_event(robot));
}

/// A robot with a run, its station, and the path between them.
struct Site<'p> {
    place: &'p Place,
    dice: Dice,
    robot: Served,
    station: Served,
    receives: SocketAddr,
    path: BadPath,
    run: String,
    /// The run's folder on the robot, and at the station.
    runs: [PathBuf; 2],
    /// When runners were killed, in ms since 1970.
    deaths: Vec<u64>,
    runners: u32,
    given: Vec<Envelope>,
}

impl<'p> Site<'p> {
    fn new(place: &'p Place, dice: Dice) -> Self {
        // Where no one else is given a port: it stays free while the station is dead.
        let receives = UdpSocket::bind("127.0.0.2:0").unwrap().local_addr().unwrap();
        let path = BadPath::to(receives);
        let (station, robot) = (station(place, receives), robot(place, &path));
        let projects = robot.door().ask("GET", "/api/v1/projects", None).unwrap();
        let machine = json!({ "project": projects[0]["id"], "path": "machine" });
        let start = json!({ "id": "torture", "machine": machine, "on_crash": "restart" });
        let run = robot.door().ask("POST", "/api/v1/runs", Some(&start)).unwrap();
        let run = run["id"].as_str().unwrap().to_owned();
        let runs = ["robot-runs", "ground-runs"].map(|runs| place.path(runs).join(&run));
        let site = Self {
            place,
            dice,
            robot,
            station,
            receives,
            path,
            run,
            runs,
            deaths: Vec::new(),
            runners: 0,
            given: Vec::new(),
        };
        site.catch_up();
        site
    }

    /// Gives a few commands at the station, new ones and ones that were given before.
    fn command(&mut self, tally: &mut Tally) {
        let Ok(mut line) = self.station.door().line() else { return };
        for _ in 0..=self.dice.roll(3) {
            let envelope = self.new_command();
            self.given.push(envelope);
            tally.commands += 1;
        }
        let again = usize::try_from(self.dice.roll(self.given.len() as u64)).unwrap();
        let newest = self.given.len().saturating_sub(3);
        for envelope in self.given[newest..].iter().chain([&self.given[again]]).cloned() {
            let command = ToServer::Command { run: self.run.clone(), envelope };
            // A station that is gone takes nothing.
            line.say(&command).unwrap_or_default();
        }
    }

    fn new_command(&mut self) -> Envelope {
        let number = self.given.len() as u64;
        let breakpoint = Breakpoint {
            id: number % 4,
            path: "ROOT/COUNTX".to_owned(),
            when: When::default(),
            condition: None,
            hit_count: 1_000_000,
            scope: Scope::default(),
            unattended: Unattended::default(),
            lost_link_ms: None,
            enabled: true,
        };
        let valid_ms = [50, 300, 1_000, 10_000][usize::try_from(self.dice.roll(4)).unwrap()];
        Envelope {
            id: format!("command-{number}"),
            author: String::new(),
            decided_on: None,
            epoch: None,
            not_before: None,
            expiry: Some(Expiry(now_ms() + valid_ms)),
            command: Command::SetBreakpoint { breakpoint },
        }
    }

    /// Kills a server, which begins again at once, or the runner, which the robot's server resumes.
    fn kill(&mut self, tally: &mut Tally) {
        tally.killed += 1;
        match self.dice.roll(5) {
            0 if self.runners < RUNNERS_OF_RUN => {
                tally.runners += 1;
                self.runners += 1;
                let runner = self.runner();
                self.deaths.push(now_ms());
                kill_process(runner, Signal::KILL).unwrap();
            }
            0..=2 => {
                tally.robots += 1;
                self.robot.kill();
                self.robot = robot(self.place, &self.path);
            }
            _ => {
                tally.stations += 1;
                self.station.kill();
                self.station = station(self.place, self.receives);
            }
        }
    }

    /// The process of the run. The last events of one that was killed may be seen before the next one has begun.
    fn runner(&self) -> Pid {
        loop {
            let writer = writer_of(&self.runs[0]).ok().flatten();
            if let Some(runner) = writer.and_then(|pid| Pid::from_raw(pid.cast_signed())) {
                return runner;
            }
            thread::yield_now();
        }
    }

    /// Waits until the station has what has happened on the robot since now.
    fn catch_up(&self) {
        let now = last_event(&self.runs[0]);
        while last_event(&self.runs[0]) <= now || last_event(&self.runs[1]) <= now {
            thread::yield_now();
        }
    }

    /// Ends the run, and waits until the station knows it.
    fn stop(self) -> Self {
        let stopped = self.place.call("tell last stop --runs robot-runs");
        assert_eq!(stopped.code, Some(0), "{}", stopped.stderr);
        while !self.place.call("runs --runs ground-runs").stdout.contains("Count  ended with") {
            thread::yield_now();
        }
        self
    }
}

impl Drop for Site<'_> {
    fn drop(&mut self) {
        self.robot.kill();
        self.station.kill();
        let runner = writer_of(&self.runs[0]).ok().flatten();
        if let Some(runner) = runner.and_then(|pid| Pid::from_raw(pid.cast_signed())) {
            kill_process(runner, Signal::KILL).unwrap_or_default();
        }
    }
}

fn last_event(folder: &Path) -> u64 {
    Reader::open(folder).and_then(|reader| reader.last_sequence()).unwrap_or_default()
}

fn robot(place: &Place, path: &BadPath) -> Served {
    let station = path.address;
    serve(
        place,
        &format!("serve project --state robot --runs robot-runs --station udp://{station}"),
    )
}

fn station(place: &Place, receives: SocketAddr) -> Served {
    serve(place, &format!("station --state ground --runs ground-runs --listen {receives}"))
}

fn serve(place: &Place, words: &str) -> Served {
    let mut command = place.command(&format!("{words} --link lan --bind 127.0.0.1:0 --keep-token"));
    let said = std::fs::OpenOptions::new().create(true).append(true).open(place.path("said"));
    command.stderr(said.unwrap());
    Served::start(command).unwrap()
}
