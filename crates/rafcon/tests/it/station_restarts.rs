//! A station of several robots that is killed at any moment: after each start it shows every run as it is at its robot.
//! `RAFCON_TEST_ROBOTS` and `RAFCON_TEST_RESTARTS` set how many; the seed is that of the date, or `RAFCON_TEST_SEED`.

use crate::harness::{Place, Run, ticks};
use crate::station::{Program, station};
use crate::torture::{Dice, first_seed, number};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs::File;
use std::net::SocketAddr;
use std::process::Stdio;
use std::thread;

const ROBOTS: &str = "RAFCON_TEST_ROBOTS";
const RESTARTS: &str = "RAFCON_TEST_RESTARTS";

/// A robot with a run that does not end.
struct Robot {
    name: String,
    _server: Option<Program>,
    run: Run,
}

fn pair(place: &Place, name: &str) {
    let made = place.call(&format!("pair {name} --state {name}"));
    std::fs::write(place.path("line"), &made.stdout).unwrap();
    let mut paste = place.command("pair --paste --state ground");
    let line = File::open(place.path("line")).unwrap();
    assert!(paste.stdin(line).stdout(Stdio::null()).status().unwrap().success());
}

fn robot(place: &Place, name: &str, station: SocketAddr) -> Robot {
    let serve = format!(
        "serve --state {name} --runs {name}-runs --bind 127.0.0.1:0 --link lan --station udp://{station}"
    );
    let mut server = place.command(&serve);
    let server = server.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let run = Run::start(place, &format!("--runs {name}-runs"));
    Robot { name: name.to_owned(), _server: Some(Program::new(server)), run }
}

/// Each run at the station with its phase.
fn phases(ground: &Program) -> Vec<(String, String)> {
    let (_status, runs) = ground.door.answer("GET", "/api/v1/runs", None).unwrap();
    let runs: Vec<Value> = serde_json::from_str(&runs).unwrap();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    runs.iter().map(|run| (text(&run["id"]), text(&run["phase"]))).collect()
}

/// Asks for the phases until this many runs are live, and returns how many were shown as something else meanwhile.
#[expect(clippy::print_stderr, reason = "a failure names the runs")]
fn wrong_until(ground: &Program, live: usize) -> usize {
    let mut wrong = BTreeMap::new();
    loop {
        let phases = phases(ground);
        for (run, phase) in phases.iter().filter(|(_, phase)| phase != "live") {
            wrong.entry(run.clone()).or_insert_with(|| phase.clone());
        }
        if phases.iter().filter(|(_, phase)| phase == "live").count() >= live {
            break;
        }
        thread::yield_now();
    }
    if !wrong.is_empty() {
        eprintln!("shown as something else than live: {wrong:?}");
    }
    wrong.len()
}

#[test]
fn a_station_that_starts_again_never_shows_a_living_run_as_something_else() {
    let (robots, restarts) = (number(ROBOTS).unwrap_or(3), number(RESTARTS).unwrap_or(6));
    let place = Place::with(&ticks(100_000_000));
    let names: Vec<_> = (0..robots).map(|nth| format!("scout{nth}")).collect();
    for name in &names {
        pair(&place, name);
    }
    let (mut ground, address) = station(&place, "127.0.0.1:0");
    let robots: Vec<_> = names.iter().map(|name| robot(&place, name, address)).collect();
    wrong_until(&ground, robots.len());
    let (mut dice, mut wrong) = (Dice(first_seed()), 0);
    for _restart in 0..restarts {
        drop(ground);
        ground = station(&place, &address.to_string()).0;
        // Some of them are live again when the next one comes.
        let live = usize::try_from(dice.roll(robots.len() as u64 + 1)).unwrap();
        wrong += wrong_until(&ground, live);
    }
    wrong += wrong_until(&ground, robots.len());
    println!("{}", json!({ "name": "station_restart_wrong_runs", "value": wrong, "unit": "runs" }));
    for robot in &robots {
        let runs = format!("{}-runs", robot.name);
        let id = std::fs::read_dir(place.path(&runs)).unwrap().next().unwrap().unwrap();
        let id = id.file_name().into_string().unwrap();
        // Commands reach each of them.
        assert_eq!(place.call(&format!("tell {id} pause --runs ground-runs")).stdout, "applied\n");
        assert_eq!(place.call(&format!("tell {id} stop --runs {runs}")).stdout, "applied\n");
    }
    for robot in robots {
        drop(robot.run.end());
    }
    assert_eq!(wrong, 0);
}
