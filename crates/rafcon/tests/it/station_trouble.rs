//! What can go wrong between robots and stations: a disk that hangs, is full or was put back, one of two stations that dies, others'
//! keys and runs.

use crate::harness::{Place, Run, ticks};
use crate::station::{
    BadPath, history, in_background, machines, make_noise, pair, pair_with, robot, robot_with,
    station, station_of, wait_at, wait_at_station, wait_for_control,
};
use expect_test::expect;
use std::fs::OpenOptions;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

/// The folder of the only run.
fn only_run(place: &Place, runs: &str) -> PathBuf {
    std::fs::read_dir(place.path(runs)).unwrap().next().unwrap().unwrap().path()
}

fn copy(from: &Path, to: &Path) {
    assert!(Command::new("cp").arg("-r").args([from, to]).status().unwrap().success());
}

/// Waits until `rafcon link` says this; answers the line with it.
fn wait_for_link(place: &Place, state: &str, words: &str) -> String {
    loop {
        let said = place.call(&format!("link --state {state}")).stdout;
        if let Some(line) = said.lines().find(|line| line.contains(words)) {
            return line.trim().to_owned();
        }
        thread::yield_now();
    }
}

#[test]
fn commands_pass_while_the_disk_of_the_station_hangs_and_nothing_is_lost_by_it() {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let run = Run::start(&place, "--runs robot-runs");
    wait_at(&place, "robot", "Ticks  running");
    let folder =
        place.path("ground-runs").join(only_run(&place, "robot-runs").file_name().unwrap());
    std::fs::create_dir_all(&folder).unwrap();
    // Whoever opens a pipe to write waits until someone reads it: so does the thread that writes this file.
    let pipe = folder.join("about-parts");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let (_ground, address) = station(&place, "127.0.0.1:0");
    let _robot = robot(&place, address);
    let tell = |command: &str| place.call(&format!("tell last {command} --runs ground-runs"));
    while tell("pause").stdout != "applied\n" {
        thread::yield_now();
    }
    assert_eq!(history(&place, "ground-runs"), "");
    assert_eq!(tell("resume").stdout, "applied\n");
    assert_eq!(tell("stop").stdout, "applied\n");
    drop(run.end());
    assert_eq!(history(&place, "ground-runs"), "");
    let _read = OpenOptions::new().read(true).write(true).open(&pipe).unwrap();
    wait_at_station(&place, "Ticks  ended with");
    assert_eq!(history(&place, "ground-runs"), history(&place, "robot-runs"));
    assert_eq!(machines(&place, "ground-runs"), machines(&place, "robot-runs"));
}

#[test]
fn two_stations_have_a_run_and_what_one_suffers_is_nothing_to_the_other() {
    let place = Place::with(&ticks(1_000_000));
    pair_with(&place, "scout --station ground", "ground");
    pair_with(&place, "scout --station moon", "moon");
    let (ground, at_ground) = station_of(&place, "ground", "127.0.0.1:0");
    let (moon, at_moon) = station_of(&place, "moon", "127.0.0.1:0");
    let robot =
        robot_with(&place, &format!("--station ground=udp://{at_ground} --station moon={at_moon}"));
    let run = Run::start(&place, "--runs robot-runs");
    wait_at(&place, "ground", "Ticks  running");
    wait_at(&place, "moon", "Ticks  running");
    let tell = |station: &str, command: &str| {
        let told = place.call(&format!("tell last {command} --runs {station}-runs"));
        let said = format!("{}{}", told.stdout, told.stderr);
        format!("{station} {command}: {}\n", said.split([':', '\n']).take(2).collect::<String>())
    };
    let control = |state: &str, url: &str, wanted: &str| {
        let said = place.call(&format!("control last {wanted} --server {url} --state {state}"));
        let first = said.stdout.split([',', ';', '\n']).next().unwrap_or_default().to_owned();
        format!("{state} {wanted}: {first}\n")
    };
    let mut said = vec![tell("ground", "step-mode"), tell("moon", "resume"), tell("moon", "pause")];
    wait_for_control(&place, "moon", &moon.url, "owner@ground is in control");
    said.push(control("robot", &robot.url, "show"));
    let report = ["ground", "moon"].map(|name| {
        wait_for_link(&place, "robot", &format!("scout: receiving from station {name}"))
    });
    said.extend(report.map(|line| format!("{}\n", line.split(", last signal").next().unwrap())));
    // One is flooded, then gone.
    in_background(move || make_noise(at_ground));
    drop(ground);
    said.extend(["override", "release"].map(|wanted| control("robot", &robot.url, wanted)));
    wait_for_control(&place, "moon", &moon.url, "no user");
    said.extend([tell("moon", "resume"), tell("moon", "stop")]);
    drop(run.end());
    wait_at(&place, "moon", "Ticks  ended with");
    let _back = station_of(&place, "ground", &at_ground.to_string());
    wait_at(&place, "ground", "Ticks  ended with");
    expect![[r"
        ground step-mode: applied
        moon resume: refused owner@ground holds control of this run
        moon pause: applied
        robot show: owner@ground is in control
        scout: receiving from station ground
        scout: receiving from station moon
        robot override: owner is in control
        robot release: no user is in control
        moon resume: applied
        moon stop: applied
    "]]
    .assert_eq(&said.concat());
    let journal = history(&place, "robot-runs");
    assert_eq!([history(&place, "ground-runs"), history(&place, "moon-runs")], [&*journal; 2]);
}

#[test]
fn a_robot_whose_disk_was_put_back_overwrites_nothing() {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let (ground, address) = station(&place, "127.0.0.1:0");
    let first = robot(&place, address);
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Ticks  running");
    let tell = |command: &str| {
        assert_eq!(
            place.call(&format!("tell last {command} --runs robot-runs")).stdout,
            "applied\n"
        );
    };
    tell("pause");
    let early = history(&place, "robot-runs");
    copy(&only_run(&place, "robot-runs"), &place.path("yesterday"));
    tell("resume");
    while history(&place, "ground-runs").lines().count() < early.lines().count() + 500 {
        thread::yield_now();
    }
    tell("stop");
    drop(run.end());
    wait_at_station(&place, "Ticks  ended with");
    let kept = history(&place, "ground-runs");
    drop(first);
    let folder = only_run(&place, "robot-runs");
    std::fs::remove_dir_all(&folder).unwrap();
    std::fs::rename(place.path("yesterday"), &folder).unwrap();
    let again = Run::of(place.command("resume last --output json --runs robot-runs"));
    while place.call("tell last stop --runs robot-runs").stdout != "applied\n" {
        thread::yield_now();
    }
    drop(again.end());
    let _second = robot(&place, address);
    let said = wait_for_link(&place, "ground", "other events");
    let (said, way_out) = said.split_once(", up to event ").unwrap();
    expect!["not everything is kept: robot scout: the robot has other events than this replica"]
        .assert_eq(said);
    assert!(
        way_out.contains("move PLACE/ground-runs/") && way_out.contains("start the station again")
    );
    assert_eq!(history(&place, "ground-runs"), kept);
    let listed = place.call("runs --runs ground-runs").stdout;
    assert!(listed.contains("Ticks  diverged: the robot has other events"), "{listed}");
    drop(ground);
    std::fs::rename(only_run(&place, "ground-runs"), place.path("before")).unwrap();
    let (_ground, _) = station(&place, &address.to_string());
    wait_at_station(&place, "Ticks  ended with");
    assert_eq!(history(&place, "ground-runs"), history(&place, "robot-runs"));
}

#[test]
fn runs_from_before_the_link_arrive_and_what_is_deleted_on_one_side_stays_as_it_is() {
    let place = Place::with(&ticks(20));
    pair(&place, "scout");
    for _ in 0..3 {
        assert_eq!(place.run("--runs robot-runs").code, Some(0));
    }
    let ids = || {
        let ids = std::fs::read_dir(place.path("ground-runs")).into_iter().flatten();
        let mut ids: Vec<_> = ids.map(|entry| entry.unwrap().file_name()).collect();
        ids.sort();
        ids
    };
    let complete = || place.call("runs --runs ground-runs").stdout.matches("ended with").count();
    let (ground, address) = station(&place, "127.0.0.1:0");
    let first = robot(&place, address);
    while complete() < 3 {
        thread::yield_now();
    }
    assert_eq!(history(&place, "ground-runs"), history(&place, "robot-runs"));
    assert_eq!(machines_of_all(&place, "ground-runs"), machines_of_all(&place, "robot-runs"));
    // One is deleted on the robot, another one at the station.
    let all = ids();
    std::fs::remove_dir_all(place.path("robot-runs").join(&all[0])).unwrap();
    std::fs::remove_dir_all(place.path("ground-runs").join(&all[1])).unwrap();
    drop((ground, first));
    let (_ground, _) = station(&place, &address.to_string());
    let _second = robot(&place, address);
    assert_eq!(place.run("--runs robot-runs").code, Some(0));
    while complete() < 3 {
        thread::yield_now();
    }
    assert_eq!([&ids()[0], &ids()[1]], [&all[0], &all[2]]);
}

/// How many machines all runs in a folder have kept.
fn machines_of_all(place: &Place, runs: &str) -> usize {
    let runs = std::fs::read_dir(place.path(runs)).unwrap();
    let packs = runs.map(|run| rafcon_storage::journal::Pack::read_after(&run.unwrap().path(), 0));
    packs.map(|packs| packs.unwrap().len()).sum()
}

#[test]
fn who_has_another_key_or_a_run_of_the_same_name_is_named() {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let (_ground, address) = station(&place, "127.0.0.1:0");
    std::fs::remove_file(place.path("robot/link/pairings/scout")).unwrap();
    drop(place.call("pair scout --state robot"));
    let stranger = robot(&place, address);
    let said = wait_for_link(&place, "ground", "not usable");
    let is_clear = ["pair the two sides again", "was not made by the other side"];
    assert!(is_clear.iter().any(|words| said.contains(words)), "{said}");
    drop(stranger);
    // A run of this computer has the id of one of the robot's.
    let (_moon, at_moon) = {
        pair_with(&place, "other --station moon", "moon");
        let run = Run::start(&place, "--runs robot-runs");
        wait_at(&place, "robot", "Ticks  running");
        copy(&only_run(&place, "robot-runs"), &place.path("moon-runs"));
        std::fs::create_dir(place.path("moon")).unwrap_or_default();
        std::fs::rename(place.path("moon-runs"), place.path("copied")).unwrap();
        std::fs::create_dir(place.path("moon-runs")).unwrap();
        let id = only_run(&place, "robot-runs").file_name().unwrap().to_owned();
        std::fs::rename(place.path("copied"), place.path("moon-runs").join(id)).unwrap();
        in_background(move || drop(run.end()));
        station_of(&place, "moon", "127.0.0.1:0")
    };
    let _robot = robot_with(&place, &format!("--robot other --station moon=udp://{at_moon}"));
    let said = wait_for_link(&place, "moon", "with this id");
    expect![
        "of this computer with this id here: move its folder away, and start the station again"
    ]
    .assert_eq(said.split_once("there is a run ").unwrap().1);
    drop(place.call("tell last stop --runs robot-runs"));
}

#[test]
fn a_full_disk_of_a_station_is_named_and_loses_nothing() {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let words = "station --state ground --runs ground-runs --bind 127.0.0.1:0 --listen 127.0.0.1:0 --link lan";
    let plain = place.command(words);
    let limited = place.command("");
    // Files are short; a signal that is ignored stays ignored in the program that follows.
    let shell = ["-c", "trap '' XFSZ; ulimit -S -f 1000; exec \"$0\" \"$@\""];
    let mut full = Command::new("sh");
    full.args(shell).arg(plain.get_program()).args(plain.get_args());
    full.current_dir(limited.get_current_dir().unwrap());
    full.envs(limited.get_envs().filter_map(|(name, value)| Some((name, value?))));
    let (ground, address, _) = crate::station::begin_station(full);
    let robot = robot(&place, address);
    let run = Run::start(&place, "--runs robot-runs");
    let said = wait_for_link(&place, "ground", "not everything is kept");
    assert!(said.contains("check that its disk has room") || said.contains("is full"), "{said}");
    assert_eq!(place.call("tell last stop --runs robot-runs").stdout, "applied\n");
    drop(run.end());
    drop(ground);
    let (_ground, _) = station(&place, &address.to_string());
    wait_at_station(&place, "Ticks  ended with");
    assert_eq!(history(&place, "ground-runs"), history(&place, "robot-runs"));
    drop(robot);
}

#[test]
fn a_key_is_renewed_over_the_link_whoever_dies_meanwhile() {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let keys = || {
        let key = |state: &str| {
            std::fs::read_to_string(place.path(&format!("{state}/link/pairings/scout"))).unwrap()
        };
        [key("robot"), key("ground")]
    };
    let [before, _] = keys();
    let (ground, address) = station(&place, "127.0.0.1:0");
    let first = robot(&place, address);
    let run = Run::start(&place, "--runs robot-runs");
    wait_at_station(&place, "Ticks  running");
    // Without a station there is nobody to take it.
    drop(ground);
    assert_eq!(place.call("pair scout --renew --state robot").code, Some(0));
    wait_for_link(&place, "robot", "the station does not use it yet");
    assert_eq!(keys(), [before.as_str(); 2]);
    drop(first);
    let (ground, _) = station(&place, &address.to_string());
    let second = robot(&place, address);
    let is_taken = || place.path("ground/link/new-keys/taken/scout").exists();
    while !is_taken() && keys().contains(&before) {
        thread::yield_now();
    }
    drop((ground, second));
    let (_ground, _) = station(&place, &address.to_string());
    let _third = robot(&place, address);
    while keys().contains(&before) {
        thread::yield_now();
    }
    let [robots, grounds] = keys();
    assert_eq!(robots, grounds);
    assert_eq!(place.call("tell last stop --runs ground-runs").stdout, "applied\n");
    drop(run.end());
    wait_at_station(&place, "Ticks  ended with");
    assert_eq!(history(&place, "ground-runs"), history(&place, "robot-runs"));
}

/// The robot knows what the station had, and cannot learn that it lost it.
#[test]
fn a_station_that_lost_its_runs_shows_a_run_of_the_robot_without_an_up_link() {
    let place = Place::with(&ticks(1_000_000));
    pair(&place, "scout");
    let run = Run::start(&place, "--runs robot-runs");
    wait_at(&place, "robot", "Ticks  running");
    let (ground, address) = station(&place, "127.0.0.1:0");
    let path = BadPath::to(address);
    let _robot = robot(&place, path.address);
    wait_at_station(&place, "Ticks  running");
    drop(ground);
    path.cut_up();
    std::fs::remove_dir_all(place.path("ground-runs")).unwrap();
    let (_ground, _) = station(&place, &address.to_string());
    wait_at_station(&place, "Ticks  running");
    assert_eq!(place.call("tell last stop --runs robot-runs").stdout, "applied\n");
    drop(run.end());
}
