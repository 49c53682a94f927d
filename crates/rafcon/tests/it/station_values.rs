//! Values of a robot's run as people at its station get them: large ones when someone wants them, watched ones ahead of the history.

use crate::harness::{Place, Run};
use crate::served::Line;
use crate::station::{pair, robot_over, station_over, wait_at_station};
use rafcon_protocol::socket::{ToClient, ToServer, Topic};
use rafcon_protocol::{WatchKind, WatchTarget};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread;

/// A run whose first state gives a value of two megabytes, and whose second one waits until it is stopped.
const SCAN: &str = r#"
hierarchy ROOT "Scan"
  outcome success
  start -> LOOKXX
  LOOKXX.seen -> WAITXX
  WAITXX.over -> .success
  flow LOOKXX.pose -> WAITXX.pose
  execution LOOKXX "Look"
    outcome seen
    out cloud: object
    out pose: list
    script |
      def execute(self, inputs, outputs, gvm):
          outputs["cloud"] = bytes(range(256)) * 8000
          outputs["pose"] = [1.5, 2.5]
          return "seen"
  execution WAITXX "Wait"
    outcome over
    in pose: list
    script |
      def execute(self, inputs, outputs, gvm):
          self.preemptive_wait(600)
          return "over"
"#;

/// The number of the event by which the first state ended, at the station; 0 before it is there.
fn look_ended(place: &Place) -> u64 {
    let history = place.call("history last --json --runs ground-runs").stdout;
    let events = history.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let mut left = events.filter(|event| event["event"]["type"] == "left");
    left.next().map_or(0, |event| event["sequence"].as_u64().unwrap())
}

/// The only run in a folder.
fn run_in(runs: &Path) -> PathBuf {
    fs::read_dir(runs).unwrap().next().unwrap().unwrap().path()
}

/// The names and sizes of the large values that a run has in files of their own.
fn files(run: &Path) -> Vec<(String, usize)> {
    let files = fs::read_dir(run.join("values")).into_iter().flatten().map(Result::unwrap);
    let size = |path: PathBuf| fs::read(path).unwrap().len();
    files.map(|it| (it.file_name().into_string().unwrap(), size(it.path()))).collect()
}

#[test]
fn a_large_value_comes_when_someone_wants_it_and_goes_on_after_restarts() {
    let place = Place::with(SCAN);
    pair(&place, "scout");
    let (ground, address) = station_over(&place, "127.0.0.1:0", "wifi");
    let robot = robot_over(&place, address, "wifi");
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Scan  running");
    let mut event = 0;
    while event == 0 {
        event = look_ended(&place);
    }
    let fetch = |url: &str, more: &str| {
        let said = place.call(&format!("fetch last {event} {more} --server {url} --state ground"));
        format!("{}{}", said.stdout, said.stderr)
    };
    let listed = fetch(&ground.url, "");
    assert!(listed.starts_with("cloud: bytes, 2.0 MB on the robot; costs "), "{listed}");
    assert!(listed.ends_with(" at its rate now\n") && !listed.contains("pose"), "{listed}");
    let no_file = fetch(&ground.url, "nothing");
    assert!(no_file.starts_with("error: event "), "{no_file}");
    let asked = fetch(&ground.url, "cloud --no-wait");
    assert!(asked.contains("the rest is on its way"), "{asked}");
    while fetch(&ground.url, "").contains("; 0 B are here") {
        thread::yield_now();
    }
    drop((ground, robot));
    let replica = run_in(&place.path("ground-runs"));
    assert!(files(&replica).iter().all(|(name, _)| name.starts_with('.')), "{:?}", files(&replica));
    let (ground, _) = station_over(&place, &address.to_string(), "wifi");
    let _robot = robot_over(&place, address, "wifi");
    while fetch(&ground.url, "") != "cloud: bytes, 2.0 MB here\n" {
        thread::yield_now();
    }
    assert_eq!(files(&replica), files(&run_in(&place.path("robot-runs"))));
    place.call("tell last stop --runs robot-runs");
    drop(run.end());
    wait_at_station(&place, "Scan  ended");
    let whole = place.call("history last --json --values --runs ground-runs").stdout;
    assert_eq!(whole, place.call("history last --json --values --runs robot-runs").stdout);
}

fn watches(line: &mut Line, run: &str, subscription: u32, paths: &[&str]) {
    let target = |path: &&str| {
        let (kind, path, name) = (WatchKind::State, (*path).to_owned(), String::new());
        WatchTarget { kind, path, name, priority: 0 }
    };
    let targets = paths.iter().map(target).collect();
    let topic = Topic::RunWatched { run: run.to_owned(), targets };
    line.say(&ToServer::Subscribe { subscription, topic }).unwrap();
}

/// Waits until the robot knows what is watched.
fn wait_until_known(line: &mut Line, subscription: u32) {
    loop {
        if let ToClient::RunWatched { subscription: of, watching: Some(watching), .. } =
            line.hear().unwrap()
            && of == subscription
            && watching.is_confirmed
        {
            return;
        }
    }
}

/// How many bytes the station has sent of what is watched, and the robot as answers to that.
fn wishes(place: &Place) -> (u64, u64) {
    let report = place.call("link --json --state ground").stdout;
    let report: Value = serde_json::from_str(report.lines().next().unwrap()).unwrap();
    let bytes = |side: &str, kind: &str| report[side]["by_kind"][kind].as_u64().unwrap_or(0);
    (bytes("sent", "wishes"), bytes("received", "watched values"))
}

#[test]
fn five_operators_cost_the_link_what_one_does() {
    let place = Place::with(SCAN);
    pair(&place, "scout");
    let (ground, address) = station_over(&place, "127.0.0.1:0", "lan");
    let _robot = robot_over(&place, address, "lan");
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Scan  running");
    let id = run_in(&place.path("ground-runs")).file_name().unwrap().to_str().unwrap().to_owned();
    let mut lines: Vec<Line> = (0..5).map(|_| ground.door.line().unwrap()).collect();
    let (first, others) = lines.split_first_mut().unwrap();
    watches(first, &id, 1, &["ROOT/LOOKXX", "ROOT/WAITXX"]);
    wait_until_known(first, 1);
    // The report is a second old at most.
    let mut one = wishes(&place);
    while one.0 == 0 || one.1 == 0 {
        one = wishes(&place);
    }
    for line in others.iter_mut() {
        watches(line, &id, 1, &["ROOT/WAITXX", "ROOT/LOOKXX"]);
        wait_until_known(line, 1);
    }
    // What only one of them watches beside that is asked for once more, and then of all.
    watches(first, &id, 2, &["ROOT"]);
    wait_until_known(first, 2);
    let mut more = wishes(&place);
    while more.0 == one.0 {
        more = wishes(&place);
    }
    assert!(more.0 <= one.0 * 2 + 40, "{more:?} after {one:?}");
    let state = ground.door.ask("GET", &format!("/api/v1/runs/{id}/state?path=ROOT/WAITXX"), None);
    assert_eq!(state.unwrap()["inputs"]["pose"], serde_json::json!([1.5, 2.5]));
    place.call("tell last stop --runs robot-runs");
    drop(run.end());
}
