//! Short runs of one robot, one after the other, more than its station can have open at a time: each arrives, is closed, and costs
//! nothing afterwards. `RAFCON_TEST_SHORT_RUNS` sets how many; `cargo xtask soak --station 100000` prints figures.

#![expect(clippy::unwrap_used, reason = "a test ends where it goes wrong")]

use rafcon_link::Profile;
use rafcon_protocol::api::{Control, ControlMove, ResumeRequest, Right, RobotAnswer, StartRequest};
use rafcon_protocol::{Command, Event, Outcome};
use rafcon_relay::{
    Answered, Authority, CommandListStore, ContactStore, MachineLists, Paired, Pairing, Projects,
    RequestBroker, RobotSettings, StationAddress, StationSettings, Stopper, ValueFetchBroker,
    relay_robot, relay_station,
};
use rafcon_storage::journal::{
    About, Batch, Journal, Options, Record, Retention, RunState, Summary, run_folders, size_of,
};
use std::fs;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::{Arc, mpsc};
use std::thread::{self, JoinHandle};

/// The runs without the variable: more than the 64 after which a station once kept runs open for ever.
const RUNS: usize = 100;
/// Runs before the robot deletes old ones and the test counts: of a test with few runs and of one with many.
const BATCH: usize = 20;
const LARGE_BATCH: usize = 250;
/// Runs between two restarts of both sides.
const RESTARTS: usize = 8_000;
/// The events of a run.
const EVENTS: u64 = 4;
/// The disk that a closed run of four events may take.
const RUN_BYTES: u64 = 64 << 10;
/// The open files of robot and station together after all runs.
const DESCRIPTORS: u32 = 200;

/// Nobody commands these runs.
#[derive(Debug)]
struct Nobody;

impl Authority for Nobody {
    fn command(&self, _: &str, _: &str, _: &str, _: u64) -> Result<(), String> {
        Err("nobody commands".to_owned())
    }

    fn refused(&self, _: &str, _: &str) {}

    fn right_of(&self, _: &Command) -> Right {
        Right::Command
    }

    fn move_control(&self, _: &str, _: &str, _: &ControlMove) -> Result<(), String> {
        Err("nobody commands".to_owned())
    }

    fn is_ready(&self) -> bool {
        true
    }

    fn resume(&self, _: ResumeRequest, _: Answered) -> Result<(), String> {
        Err("nobody resumes".to_owned())
    }

    fn fate_of_resume(&self, _: &str, _: &str, _: &str) -> RobotAnswer {
        RobotAnswer::Expired
    }

    fn start(&self, _: StartRequest, _: Answered) -> Result<(), String> {
        Err("nobody starts".to_owned())
    }

    fn fate_of_start(&self, _: &str, _: &str) -> RobotAnswer {
        RobotAnswer::Expired
    }

    fn present(&self, _: &str) {}

    fn control(&self, _: &str) -> Option<Control> {
        None
    }
}

/// A side that runs until it is stopped.
struct Side {
    stopper: Stopper,
    thread: JoinHandle<()>,
}

impl Side {
    fn begin(stopper: Stopper, run: impl FnOnce() + Send + 'static) -> Self {
        let thread = thread::Builder::new().spawn(run).unwrap();
        Self { stopper, thread }
    }

    fn end(self) {
        self.stopper.stop();
        self.thread.join().unwrap();
    }
}

struct World {
    folder: PathBuf,
    pairing: Pairing,
    address: SocketAddr,
    sides: Vec<Side>,
    made: usize,
}

impl World {
    fn new(folder: &Path) -> Self {
        let pairing = Pairing::generate("scout", None).unwrap();
        // An address of its own: the station binds its port again after each restart.
        let [.., high, low] = std::process::id().to_be_bytes();
        let address = SocketAddr::from(([127, 88, high, low], 0));
        let (folder, sides) = (folder.to_owned(), Vec::new());
        let mut world = Self { folder, pairing, address, sides, made: 0 };
        world.start();
        world
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    fn paired(&self, side: &str) -> Paired {
        let (file, next) = (format!("{side}.pairing"), format!("{side}.next"));
        Paired { pairing: self.pairing.clone(), file: self.path(&file), next: self.path(&next) }
    }

    /// Starts the station, then the robot.
    fn start(&mut self) {
        let (begun, address) = mpsc::sync_channel(1);
        let station = StationSettings {
            folder: self.path("ground"),
            runs: self.path("ground-runs"),
            pairings: Arc::new(vec![self.paired("ground")]),
            bind: self.address,
            tls: None,
            profile: Profile::LAN,
            value_fetches: ValueFetchBroker::default(),
            server_requests: RequestBroker::default(),
            contacts: ContactStore::default(),
            lists: CommandListStore::new(|_| Right::Command),
            machines: MachineLists::default(),
            tell: |problem| panic!("{problem}"),
        };
        let stopper = Stopper::default();
        let stop = stopper.clone();
        let run = move || relay_station(&station, &stop, |at| begun.send(at).unwrap()).unwrap();
        self.sides.push(Side::begin(stopper, run));
        self.address = address.recv().unwrap();
        let robot = RobotSettings {
            folder: self.path("robot"),
            runs: self.path("robot-runs"),
            projects: Projects::default(),
            paired: self.paired("robot"),
            station: StationAddress::Udp(self.address),
            profile: Profile::LAN,
            authority: Arc::new(Nobody),
            tell: |problem| panic!("{problem}"),
        };
        let stopper = Stopper::default();
        let stop = stopper.clone();
        self.sides.push(Side::begin(stopper, move || relay_robot(&robot, &stop).unwrap()));
    }

    fn end(&mut self) {
        self.sides.drain(..).for_each(Side::end);
    }

    /// Runs happen on the robot; answers their ids.
    fn run(&mut self, count: usize) -> Vec<String> {
        let first = self.made;
        self.made += count;
        let ids: Vec<_> = (first..self.made).map(|nth| format!("run-{nth:06}")).collect();
        fs::create_dir_all(self.path("robot-runs")).unwrap();
        for id in &ids {
            let about = About { id: id.clone(), name: "Short".to_owned(), ..About::default() };
            // The robot sees a run once it is whole.
            let hidden = self.path("hidden").join(id);
            let options = Options { recorder_bytes: 1 << 15, ..Options::default() };
            let journal = Journal::create(&hidden, &about, &options).unwrap();
            let mut batch = Batch::new(0);
            for t_ns in 1..EVENTS {
                batch.record(t_ns, &Record::Told(Box::new(Event::Stopping)));
            }
            batch.record(EVENTS, &Record::Told(Box::new(finished())));
            journal.append(&batch).unwrap();
            journal.close().unwrap();
            fs::rename(&hidden, self.path("robot-runs").join(id)).unwrap();
        }
        ids
    }

    /// Waits until each of these runs is closed at the station.
    fn wait(&self, ids: &[String]) {
        for id in ids {
            let folder = self.path("ground-runs").join(id);
            let is_closed = || {
                let is_open = ["socket", "recorder"].iter().any(|file| folder.join(file).exists());
                folder.join("run.json").exists() && !is_open
            };
            while !is_closed() {
                thread::yield_now();
            }
        }
    }
}

fn finished() -> Event {
    Event::Finished {
        outcome: Outcome { id: 0, name: "success".to_owned() },
        outputs: serde_json::Map::new(),
        globals: serde_json::Map::new(),
        scoped_variables: serde_json::Map::new(),
        states_run: 1,
    }
}

/// The memory of this process in MB, and its open files.
fn memory_and_descriptors() -> (f64, u32) {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    let kilobytes: f64 = line.trim().trim_end_matches(" kB").parse().unwrap();
    let descriptors = fs::read_dir("/proc/self/fd").unwrap().count();
    (kilobytes / 1_000.0, u32::try_from(descriptors).unwrap())
}

#[test]
fn every_short_run_arrives_and_costs_nothing_once_it_is_closed() {
    let runs = std::env::var_os("RAFCON_TEST_SHORT_RUNS")
        .map_or(RUNS, |runs| runs.to_str().unwrap().parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let mut world = World::new(folder.path());
    let batch_size = (runs / 100).clamp(BATCH, LARGE_BATCH);
    let (mut missing, mut open, mut largest) = (0_u32, 0_u32, 0_u32);
    let (robot_runs, ground_runs) = (world.path("robot-runs"), world.path("ground-runs"));
    for batch in 1..=runs.div_ceil(batch_size) {
        let ids = world.run(batch_size.min(runs - world.made));
        world.wait(&ids);
        for id in &ids {
            let summary = Summary::of(&ground_runs.join(id));
            missing += u32::from(summary.events != EVENTS);
            open += u32::from(!matches!(summary.state, RunState::Finished { .. }));
            largest = largest.max(u32::try_from(size_of(&summary.folder)).unwrap());
        }
        Retention { count: 2 * batch_size, ..Retention::default() }.prune(&robot_runs, 0).unwrap();
        // The disk of a test has no room for all: what is deleted at the station is not sent again.
        Retention { count: 20 * batch_size, ..Retention::default() }
            .prune(&ground_runs, 0)
            .unwrap();
        if batch % (RESTARTS / batch_size).max(2) == 1 {
            world.end();
            world.start();
        }
    }
    // The robot closes its journals after the station's report, some time after the station has closed its own.
    while memory_and_descriptors().1 > DESCRIPTORS {
        thread::yield_now();
    }
    let (memory, descriptors) = memory_and_descriptors();
    world.end();
    for (name, value, unit) in [
        ("station_runs_missing", f64::from(missing), ""),
        ("station_runs_open", f64::from(open), ""),
        ("station_memory_mb", memory, "MB"),
        ("station_descriptors", f64::from(descriptors), ""),
        ("station_run_bytes", f64::from(largest), "B"),
    ] {
        println!("{}", serde_json::json!({ "name": name, "value": value, "unit": unit }));
    }
    let kept = run_folders(&ground_runs).unwrap().len();
    assert_eq!((missing, open, kept), (0, 0, runs.min(20 * batch_size)));
    assert!(largest <= u32::try_from(RUN_BYTES).unwrap(), "a run takes {largest} bytes");
    assert!(memory <= 150.0, "{memory} MB");
}
