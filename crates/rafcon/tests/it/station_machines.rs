//! Machines at a station: there before a run has them, once by the hash of their files.

use crate::harness::{Place, Run};
use crate::station::{in_background, pair, robot_with, station};
use rafcon_storage::journal::Pack;
use rafcon_supervisor::clock;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::net::{SocketAddr, UdpSocket};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

/// The names of what lies in a folder; nothing while it is not there.
fn names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().map(Result::unwrap);
    entries.map(|entry| entry.file_name().into_string().unwrap()).collect()
}

/// The hashes of the parcels in a folder; one that is coming is none.
fn parcels(folder: &Path) -> BTreeSet<String> {
    let names = names(folder).into_iter();
    names.filter_map(|name| Some(name.split_once('-')?.1.to_owned())).collect()
}

/// Waits until the station has parcels of this many machines and the list of them, the same as the robot.
fn wait_for_parcels(place: &Place, machines: usize) {
    let count = machines + 1;
    let at = |folder: &str| parcels(&place.path(folder));
    let both = || (at("robot/link/robot/machines"), at("ground/link/station/scout/machines"));
    while !matches!(both(), (robots, stations) if robots.len() == count && robots == stations) {
        thread::yield_now();
    }
}

/// A machine of two scripts, of which one has many bytes that cannot be deflated much.
fn two_scripts(place: &Place) {
    let next = |number: &u32| Some(number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let noise: Vec<u32> = std::iter::successors(Some(1), next).take(4_500).collect();
    let noise = format!("      # {noise:x?}\n");
    let script = |name: &str, more: &str| {
        format!(
            "  execution {name} \"{name}\"\n    outcome done\n    script |\n      def execute(self, inputs, outputs, gvm):\n          return \"done\"\n{more}"
        )
    };
    let machine = format!(
        "hierarchy ROOT \"Two\"\n  outcome success\n  start -> FIRSTX\n  FIRSTX.done -> SECOND\n  SECOND.done -> .success\n{}{}",
        script("FIRSTX", ""),
        script("SECOND", &noise)
    );
    put(place, &Place::with(&machine).machine(), "two");
}

/// Copies a machine into the project.
fn put(place: &Place, machine: &Path, name: &str) {
    fs::create_dir_all(place.path("project")).unwrap();
    let to = place.path("project").join(name);
    let copied = Command::new("cp").arg("-r").arg(machine).arg(to).status();
    assert!(copied.unwrap().success());
}

/// Runs a machine, and waits until the station has all of it; answers the machines of the run on both sides.
fn run(place: &Place, machine: &str) -> [Vec<Pack>; 2] {
    let before = names(&place.path("robot-runs"));
    let run =
        Run::of(place.command(&format!("run project/{machine} --output json --runs robot-runs")));
    assert_eq!(run.end().0, Some(0));
    let new = &names(&place.path("robot-runs")) - &before;
    let id = new.first().unwrap();
    let at_station = place.path("ground-runs").join(id);
    while !place
        .call("runs --runs ground-runs --json")
        .stdout
        .lines()
        .any(|line| line.contains(id.as_str()) && line.contains("finished"))
    {
        thread::yield_now();
    }
    [place.path("robot-runs").join(id), at_station].map(|run| Pack::read_after(&run, 0).unwrap())
}

/// How many bytes of machines the robot has sent since its start, once it says from now on that the station has everything.
fn machine_bytes(place: &Place) -> u64 {
    let now_ms = clock::since_1970_ms();
    loop {
        let said = place.call("link --json --state robot").stdout;
        let report: Value = serde_json::from_str(said.lines().next().unwrap()).unwrap();
        let runs = report["runs"].as_array().unwrap();
        let is_new = report["now_ms"].as_u64().is_some_and(|at_ms| at_ms > now_ms);
        if is_new && runs.iter().all(|run| run["missing"] == 0) {
            return report["sent"]["by_kind"]["machines"].as_u64().unwrap_or(0);
        }
        thread::yield_now();
    }
}

#[test]
fn a_machine_is_at_the_station_before_any_run_and_an_edit_sends_what_was_edited() {
    let place = Place::empty();
    two_scripts(&place);
    pair(&place, "scout");
    let (ground, address) = station(&place, "127.0.0.1:0");
    let stations = format!("--station udp://{address} project");
    let first = robot_with(&place, &stations);
    wait_for_parcels(&place, 1);
    drop((ground, first));
    let (ground, _) = station(&place, &address.to_string());
    let second = robot_with(&place, &stations);
    let [robots, stations_own] = run(&place, "two");
    assert_eq!((robots.len(), &robots), (1, &stations_own));
    assert_eq!(machine_bytes(&place), 0);
    let states = fs::read_dir(place.path("project/two")).unwrap().map(Result::unwrap);
    let mut scripts = states.map(|state| state.path().join("script.py"));
    let is_short = |path: &PathBuf| fs::read(path).is_ok_and(|text| text.len() < 1_000);
    let script = scripts.find(is_short).unwrap();
    let text = fs::read_to_string(&script).unwrap();
    fs::write(&script, format!("{text}# edited\n")).unwrap();
    // The robot looks at its projects now and then. A run that begins before that brings the edit itself.
    wait_for_parcels(&place, 2);
    let [robots, stations_own] = run(&place, "two");
    assert_eq!((robots.len(), &robots), (1, &stations_own));
    let sent = machine_bytes(&place);
    assert!((1..1_500).contains(&sent), "{sent} bytes of an edit");
    drop((ground, second));
}

/// Where a robot sends whatever is to reach a station that it never hears.
fn one_way_to(station: SocketAddr) -> SocketAddr {
    let [near, far] = [(); 2].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
    let address = near.local_addr().unwrap();
    in_background(move || {
        let mut buffer = [0; 2_000];
        while let Ok(length) = near.recv(&mut buffer) {
            far.send_to(&buffer[..length], station).unwrap_or_default();
        }
    });
    address
}

#[test]
fn machines_reach_a_station_that_the_robot_never_hears_also_one_that_lost_its_disk() {
    let place = Place::empty();
    two_scripts(&place);
    pair(&place, "scout");
    let (ground, address) = station(&place, "127.0.0.1:0");
    let stations = format!("--station udp://{} project", one_way_to(address));
    let robot = robot_with(&place, &stations);
    wait_for_parcels(&place, 1);
    drop((ground, robot));
    fs::remove_dir_all(place.path("ground/link/station/scout/machines")).unwrap();
    let (_ground, _) = station(&place, &address.to_string());
    let _robot = robot_with(&place, &stations);
    wait_for_parcels(&place, 1);
}

#[test]
fn a_machine_is_sent_with_its_libraries_and_the_run_needs_nothing_more() {
    let place = Place::empty();
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    put(&place, &examples.join("library_reuse"), "reuse");
    pair(&place, "scout");
    let (_ground, address) = station(&place, "127.0.0.1:0");
    let libraries = format!("--library-path examples={}", examples.join("libraries").display());
    let _robot = robot_with(&place, &format!("--station udp://{address} project {libraries}"));
    wait_for_parcels(&place, 1);
    let [robots, stations_own] = run(&place, &format!("reuse {libraries}"));
    assert!(robots[0].manifest.files().iter().any(|(path, _)| path.starts_with("libraries/")));
    assert_eq!(robots, stations_own);
    wait_for_parcels(&place, 1);
}
